//! Names in a script and their places.

use rhai::{AST, ASTNode, Expr, Position};

/// The place of the key `name` of a map in `program`, the first one from `after` on.
pub(super) fn place_of_key(program: &AST, name: &str, after: Position) -> Option<Position> {
    let place = |position: Position| (position.line(), position.position());
    let mut found: Vec<Position> = Vec::new();
    program.walk(&mut |path: &[ASTNode]| {
        if let Some(ASTNode::Expr(Expr::Map(map, _))) = path.last() {
            found.extend(map.0.iter().filter(|(key, _)| key.name == name).map(|(key, _)| key.pos));
        }
        true
    });
    found.into_iter().filter(|position| place(*position) >= place(after)).min_by_key(|position| place(*position))
}

/// The property that stands at `place`, or whose dot does.
pub(super) fn property_at(program: &AST, place: Position) -> Option<String> {
    let mut found = None;
    program.walk(&mut |path: &[ASTNode]| {
        if let Some(ASTNode::Expr(Expr::Property(property, position))) = path.last()
            && *position == place
        {
            found = Some(property.2.to_string());
        }
        true
    });
    found
}

/// Whether `program` reads a property `name`, has it as a text, or reads the keys of something.
pub(super) fn mentions(program: &AST, name: &str) -> bool {
    let mut found = false;
    program.walk(&mut |path: &[ASTNode]| {
        found |= match path.last() {
            Some(ASTNode::Expr(Expr::Property(property, _))) => property.2 == name,
            Some(ASTNode::Expr(Expr::StringConstant(text, _))) => text == name,
            Some(ASTNode::Expr(Expr::MethodCall(call, _))) => call.name == "keys",
            _ => false,
        };
        !found
    });
    found
}
