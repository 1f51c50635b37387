//! The source read as modules: which file names which other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Keywords before the name of an item.
const ITEMS: [&str; 9] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union", "macro_rules"];

/// Path of a module from the root of the crate: `["script", "host"]`.
pub type ModulePath = Vec<String>;

/// One file of a package, without comments, texts and tests.
#[derive(Debug)]
pub struct Module {
    tokens: Vec<String>,
    imports: Vec<Import>,
}

/// One name that a `use` brings into a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    /// As written: it may begin with `crate`, `super`, `self`, or a module inside.
    path: Vec<String>,
    /// Its name here; `*` of all that a module has.
    name: String,
    /// Whether it is passed on: `pub use`.
    is_public: bool,
}

/// All modules of a crate.
#[derive(Debug, Default)]
pub struct Crate {
    pub modules: BTreeMap<ModulePath, Module>,
}

impl Crate {
    /// The crate whose sources lie in `folder`, without packages in it.
    pub fn read(folder: &Path) -> Crate {
        let mut files = Vec::new();
        collect(folder, &mut files);
        let sources = files.into_iter().map(|file| {
            let text = fs::read_to_string(&file).expect("a source file");
            (file.strip_prefix(folder).expect("a file of the folder").to_owned(), text)
        });
        Crate::of(sources)
    }

    /// The crate of files, by their paths in its folder, with their texts.
    pub fn of(sources: impl IntoIterator<Item = (PathBuf, String)>) -> Crate {
        let mut found = Crate::default();
        let mut tests = BTreeSet::new();
        for (file, text) in sources {
            let path = module_path(&file);
            let (tokens, test_modules) = without_tests(tokens(&text));
            tests.extend(test_modules.into_iter().map(|name| joined(&path, name)));
            let (tokens, imports) = without_imports(tokens);
            found.modules.insert(path, Module { tokens, imports });
        }
        found.modules.retain(|path, _| !(1..=path.len()).any(|length| tests.contains(&path[..length])));
        found
    }

    /// The modules whose items the module at `path` names, each with one of these names.
    pub fn named_by(&self, path: &ModulePath) -> BTreeMap<ModulePath, String> {
        let mut named = BTreeMap::new();
        for full in self.mentions(path) {
            if let Some(module) = self.owner(&full, 0).filter(|module| module != path) {
                named.entry(module).or_insert_with(|| full.join("::"));
            }
        }
        named
    }

    /// Full paths of what the module at `path` names. A `pub use` of what lies inside passes it on without naming it.
    pub fn mentions(&self, path: &ModulePath) -> Vec<ModulePath> {
        let module = &self.modules[path];
        let mut found = Vec::new();
        for import in &module.imports {
            let Some(full) = self.full(path, &import.path) else { continue };
            let passed_on = import.is_public && full.starts_with(path);
            let is_used = || module.tokens.contains(&import.name);
            if !self.modules.contains_key(&full) && (!passed_on || is_used()) {
                found.push(full);
            }
        }
        for written in paths(&module.tokens) {
            let alias = module.imports.iter().find(|import| import.name == written[0]);
            let full = match alias {
                Some(import) => self.full(path, &import.path).map(|full| [&full[..], &written[1..]].concat()),
                None => self.full(path, &written),
            };
            found.extend(full);
        }
        found
    }

    /// `written` in the module at `path`, from the root of the crate; none of what another crate has.
    fn full(&self, path: &ModulePath, written: &[String]) -> Option<ModulePath> {
        let mut base = path.clone();
        let mut rest = written;
        match rest.first()?.as_str() {
            "crate" => (base, rest) = (vec![], &rest[1..]),
            "self" => rest = &rest[1..],
            "super" => {}
            name if self.modules.contains_key(&joined(path, name.to_owned())) => {}
            _ => return None,
        }
        while rest.first().is_some_and(|name| name == "super") {
            base.pop();
            rest = &rest[1..];
        }
        Some([&base[..], rest].concat())
    }

    /// The module that defines what `full` names, through every `use` that passes it on.
    fn owner(&self, full: &[String], depth: usize) -> Option<ModulePath> {
        let length = (1..=full.len()).rev().find(|length| self.modules.contains_key(&full[..*length]))?;
        let (path, rest) = (full[..length].to_vec(), &full[length..]);
        let Some(item) = rest.first().filter(|_| depth < 8) else { return Some(path) };
        let module = &self.modules[&path];
        let passed_on = module.imports.iter().find(|import| import.name == *item);
        let from = passed_on.and_then(|import| self.full(&path, &import.path));
        if let Some(from) = from.filter(|from| from != full) {
            return self.owner(&from, depth + 1).or(Some(path));
        }
        let globs = module.imports.iter().filter(|import| import.name == "*");
        let mut globs = globs.filter_map(|import| self.full(&path, &import.path));
        let defines = |glob: &ModulePath| self.modules.get(glob).is_some_and(|module| module.defines(item));
        globs.find(defines).or(Some(path))
    }
}

impl Module {
    fn defines(&self, item: &str) -> bool {
        self.tokens.windows(2).any(|pair| ITEMS.contains(&pair[0].as_str()) && pair[1] == item)
    }
}

/// Every Rust file below `folder`.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for path in fs::read_dir(folder).expect("a folder of src").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            if !path.join("Cargo.toml").exists() {
                collect(&path, files);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// `script/mod.rs` and `script.rs` are `["script"]`, `lib.rs` is the root.
fn module_path(file: &Path) -> ModulePath {
    let stem = file.with_extension("");
    let names = stem.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
    names.filter(|name| !["mod", "lib"].contains(&name.as_str())).collect()
}

fn joined(path: &[String], name: String) -> ModulePath {
    path.iter().cloned().chain([name]).collect()
}

/// Words, `::` and single signs; comments, texts, letters and lifetimes are left out.
fn tokens(text: &str) -> Vec<String> {
    let letters: Vec<char> = text.chars().collect();
    let at = |place: usize| letters.get(place).copied().unwrap_or('\n');
    let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut found = Vec::new();
    let mut place = 0;
    while place < letters.len() {
        match (at(place), at(place + 1)) {
            ('/', '/') => place += letters[place..].iter().take_while(|letter| **letter != '\n').count(),
            ('/', '*') => place = after(&letters, place + 2, "*/"),
            ('r', '"') => place = after(&letters, place + 2, "\""),
            ('r', '#') if at(place + 2) == '"' => place = after(&letters, place + 3, "\"#"),
            ('"', _) => place = closing(&letters, place + 1, '"'),
            ('\'', '\\') => place = closing(&letters, place + 1, '\''),
            ('\'', _) if at(place + 2) == '\'' => place += 3,
            (':', ':') => {
                found.push("::".into());
                place += 2;
            }
            (letter, _) if is_word(letter) => {
                let word: String = letters[place..].iter().take_while(|letter| is_word(**letter)).collect();
                place += word.chars().count();
                found.push(word);
            }
            (letter, _) => {
                if !letter.is_whitespace() && letter != '\'' {
                    found.push(letter.into());
                }
                place += 1;
            }
        }
    }
    found
}

/// The place behind the next `end`.
fn after(letters: &[char], from: usize, end: &str) -> usize {
    let end: Vec<char> = end.chars().collect();
    let found = letters[from..].windows(end.len()).position(|window| window == end);
    found.map_or(letters.len(), |place| from + place + end.len())
}

/// The place behind the next `end` that no backslash precedes.
fn closing(letters: &[char], mut place: usize, end: char) -> usize {
    while place < letters.len() && letters[place] != end {
        place += if letters[place] == '\\' { 2 } else { 1 };
    }
    place + 1
}

/// The tokens without items under `#[cfg(test)]`, and the names of the files among those items.
fn without_tests(tokens: Vec<String>) -> (Vec<String>, Vec<String>) {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut files) = (Vec::new(), Vec::new());
    let mut rest = &tokens[..];
    while !rest.is_empty() {
        if !rest.iter().take(MARK.len()).eq(MARK.iter()) {
            kept.push(rest[0].clone());
            rest = &rest[1..];
            continue;
        }
        let item = &rest[MARK.len()..][..length_of_item(&rest[MARK.len()..])];
        if let [.., keyword, name, end] = item
            && keyword == "mod"
            && end == ";"
        {
            files.push(name.clone());
        }
        rest = &rest[MARK.len() + item.len()..];
    }
    (kept, files)
}

/// Tokens up to a `;` outside of brackets, or the end of the first block.
fn length_of_item(tokens: &[String]) -> usize {
    let mut depth = 0_usize;
    for (place, token) in tokens.iter().enumerate() {
        match token.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 && (token == ";" || token == "}") {
            return place + 1;
        }
    }
    tokens.len()
}

/// The tokens without `use …;`, and what these bring in.
fn without_imports(tokens: Vec<String>) -> (Vec<String>, Vec<Import>) {
    let (mut kept, mut imports): (Vec<String>, Vec<Import>) = (Vec::new(), Vec::new());
    let mut rest = tokens.into_iter();
    while let Some(token) = rest.next() {
        if token != "use" {
            kept.push(token);
            continue;
        }
        let is_public = match kept.last().map(String::as_str) {
            Some("pub") => true,
            Some(")") => kept.iter().rev().take(4).any(|token| token == "pub"),
            _ => false,
        };
        let tree: Vec<String> = rest.by_ref().take_while(|token| token != ";").collect();
        read_tree(&[], &tree, is_public, &mut imports);
    }
    (kept, imports)
}

/// `a::b`, `a::{b, c::d}`, `a::{self}`, `a as b`, `a::*`.
fn read_tree(base: &[String], tree: &[String], is_public: bool, imports: &mut Vec<Import>) {
    let group = tree.iter().position(|token| token == "{");
    if let Some(start) = group {
        let base: Vec<String> =
            base.iter().chain(tree[..start].iter().filter(|token| *token != "::")).cloned().collect();
        branches(&tree[start + 1..tree.len() - 1]).for_each(|branch| read_tree(&base, branch, is_public, imports));
        return;
    }
    let (written, alias) = match tree {
        [path @ .., word, alias] if word == "as" => (path, Some(alias.clone())),
        path => (path, None),
    };
    let mut path: Vec<String> = base.iter().chain(written.iter().filter(|token| *token != "::")).cloned().collect();
    let is_all = path.last().is_some_and(|name| name == "*");
    if is_all || path.len() > 1 && path.last().is_some_and(|name| name == "self") {
        path.pop();
    }
    let own = if is_all { "*".into() } else { path.last().cloned().unwrap_or_default() };
    imports.push(Import { path, name: alias.unwrap_or(own), is_public });
}

/// What commas outside of inner groups separate.
fn branches(group: &[String]) -> impl Iterator<Item = &[String]> {
    let mut depth = 0_i32;
    let separated = group.split(move |token| {
        depth += i32::from(token == "{") - i32::from(token == "}");
        token == "," && depth == 0
    });
    separated.filter(|branch| !branch.is_empty())
}

/// Every `a::b::c` of the tokens; generic arguments end one.
fn paths(tokens: &[String]) -> Vec<Vec<String>> {
    let is_word = |token: &String| token.chars().next().is_some_and(|first| first.is_alphabetic() || first == '_');
    let mut found = Vec::new();
    let mut place = 0;
    while place < tokens.len() {
        if !is_word(&tokens[place]) || place > 0 && tokens[place - 1] == "::" {
            place += 1;
            continue;
        }
        let mut path = vec![tokens[place].clone()];
        while tokens.get(place + 1).is_some_and(|sign| sign == "::") && tokens.get(place + 2).is_some_and(is_word) {
            path.push(tokens[place + 2].clone());
            place += 2;
        }
        if path.len() > 1 {
            found.push(path);
        }
        place += 1;
    }
    found
}
