//! Names in a script and their places.

use rhai::{AST, ASTNode, Expr, Position, Stmt};

/// The place of the key `name` of a map among the arguments of the call at `call`; none where the map was built before.
pub(super) fn place_of_key(program: &AST, name: &str, call: Position) -> Option<Position> {
    let is_call = |node: &ASTNode| match node {
        ASTNode::Expr(Expr::FnCall(_, position) | Expr::MethodCall(_, position))
        | ASTNode::Stmt(Stmt::FnCall(_, position)) => *position == call,
        _ => false,
    };
    let mut found: Vec<Position> = Vec::new();
    program.walk(&mut |path: &[ASTNode]| {
        if let Some(ASTNode::Expr(Expr::Map(map, _))) = path.last()
            && path.iter().any(is_call)
        {
            found.extend(map.0.iter().filter(|(key, _)| key.name == name).map(|(key, _)| key.pos));
        }
        true
    });
    found.into_iter().min_by_key(|position| (position.line(), position.position()))
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

/// Whether `program` reads the argument `name` with one of these methods of `args`.
pub(super) fn reads_with(program: &AST, methods: &[&str], name: &str) -> bool {
    let mut found = false;
    program.walk(&mut |path: &[ASTNode]| {
        if let Some(ASTNode::Expr(Expr::MethodCall(call, _))) = path.last() {
            let is_name = |argument: &Expr| matches!(argument, Expr::StringConstant(text, _) if text == name);
            found |= methods.contains(&call.name.as_str()) && call.args.first().is_some_and(is_name);
        }
        !found
    });
    found
}
