//! Imports run one way: the library's modules are layers, and no folder's modules import each other in a circle.
//!
//! A module may use what its parent defines, and a parent its children: a folder's `mod.rs` is its face. What is followed is
//! paths that begin with `crate`, `super` or `self`, and names that a `mod.rs` passes on from its children.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The library's top-level modules; each imports only those before it.
const LAYERS: [&str; 23] = [
    "geometry",
    "sets",
    "progress",
    "surface",
    "sizes",
    "compute",
    "gpu",
    "solver",
    "field",
    "parametrize",
    "mosaic",
    "mesh",
    "symmetry",
    "pipeline",
    "report",
    "mesher",
    "options",
    "export",
    "warnings",
    "picture",
    "page",
    "study",
    "cli",
];

type Module = Vec<String>;

/// A module, and its source without comments and strings.
struct Source {
    module: Module,
    code: String,
}

/// The sources below a folder.
fn sources(folder: &Path, module: &[String]) -> Vec<Source> {
    let mut found = Vec::new();
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let own = if ["mod", "lib"].contains(&stem.as_str()) { module.to_vec() } else { [module, &[stem]].concat() };
        if path.is_dir() {
            found.extend(sources(&path, &own));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(Source { module: own, code: code_of(&fs::read_to_string(&path).unwrap()) });
        }
    }
    found
}

/// The library's sources; the program, `main.rs` and `cli`, is another crate.
fn library() -> Vec<Source> {
    let mut all = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &[]);
    all.retain(|source| !["main", "cli"].contains(&source.module.first().map_or("", String::as_str)));
    all
}

/// The program's sources.
fn program() -> Vec<Source> {
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/cli"), &[])
}

/// A source without comments, strings and characters.
fn code_of(text: &str) -> String {
    let mut code = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if first == '"' {
            end_of_string(rest)
        } else if let Some(quoted) = rest.strip_prefix('\'').filter(|quoted| is_character(quoted)) {
            2 + quoted[1..].find('\'').unwrap()
        } else {
            code.push(first);
            rest = &rest[first.len_utf8()..];
            continue;
        };
        rest = &rest[skipped.min(rest.len())..];
    }
    code
}

/// Whether a character, not a lifetime, follows a quote.
fn is_character(quoted: &str) -> bool {
    quoted.starts_with('\\') || quoted.chars().nth(1) == Some('\'')
}

fn end_of_string(text: &str) -> usize {
    let mut escaped = false;
    for (i, character) in text.char_indices().skip(1) {
        match character {
            '"' if !escaped => return i + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// The code outside and inside of the block of tests.
fn without_tests(code: &str) -> (&str, &str) {
    code.split_at(code.find("mod tests {").unwrap_or(code.len()))
}

/// All paths of a tree as `use` has it: `a::{b, c::d}` is `a::b` and `a::c::d`.
fn expanded(tree: &str) -> Vec<Module> {
    let Some(open) = tree.find('{') else {
        let path = tree.split(" as ").next().unwrap_or(tree);
        return vec![path.split("::").map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()];
    };
    let prefix = &expanded(&tree[..open])[0];
    let mut paths = Vec::new();
    let (mut depth, mut start) = (0, open + 1);
    for (i, character) in tree.char_indices().skip(open) {
        match character {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if (character == ',' && depth == 1) || (character == '}' && depth == 0) {
            let part = tree[start..i].trim();
            let parts = if part.is_empty() { Vec::new() } else { expanded(part) };
            paths.extend(parts.iter().map(|path| [prefix.as_slice(), path].concat()));
            start = i + 1;
        }
    }
    paths
}

/// The trees of the `use` items, and all other paths that begin with one of these names.
fn paths(code: &str, roots: &[&str]) -> Vec<Module> {
    let mut found = Vec::new();
    for root in roots {
        for (at, _) in code.match_indices(&format!("{root}::")) {
            if code[..at]
                .chars()
                .next_back()
                .is_some_and(|before| before.is_alphanumeric() || before == '_' || before == ':')
            {
                continue;
            }
            let statement = code[..at].rfind([';', '}', '{']).map_or(0, |end| end + 1);
            let is_use = code[statement..at].split_whitespace().any(|word| word == "use");
            let end = if is_use {
                code[at..].find(';').map_or(code.len(), |end| at + end)
            } else {
                let is_path = |character: char| character.is_alphanumeric() || "_:".contains(character);
                code[at..].find(|character| !is_path(character)).map_or(code.len(), |end| at + end)
            };
            found.extend(expanded(&code[at..end]));
        }
    }
    found
}

/// Which module uses which; unit tests count if asked.
fn imports(sources: &[Source], with_tests: bool) -> BTreeSet<(Module, Module)> {
    let modules: BTreeSet<&Module> = sources.iter().map(|source| &source.module).collect();
    // Names that a module passes on from its children.
    let mut passed: BTreeMap<Module, Module> = BTreeMap::new();
    for Source { module, code } in sources {
        for item in without_tests(code).0.split(';').filter_map(|item| item.split_once("use ").map(|(_, tree)| tree)) {
            for path in expanded(item) {
                let child = [module.as_slice(), &path[..1.min(path.len())]].concat();
                if path.len() > 1 && modules.contains(&child) {
                    passed.insert(
                        [module.as_slice(), &path[path.len() - 1..]].concat(),
                        [module.as_slice(), &path].concat(),
                    );
                }
            }
        }
    }
    let resolved = |mut path: Module| {
        for _ in 0..3 {
            if let Some(longer) = passed.get(&path) {
                path.clone_from(longer);
            }
        }
        (0..=path.len()).rev().map(|length| path[..length].to_vec()).find(|prefix| modules.contains(prefix))
    };
    let mut edges = BTreeSet::new();
    for Source { module, code } in sources {
        let (own, tests) = without_tests(code);
        let absolute = |path: Module| {
            let mut base: &[String] = if path[0] == "crate" { &[] } else { module };
            let supers = path.iter().take_while(|name| *name == "super").count();
            base = &base[..base.len() - supers.min(base.len())];
            let named = supers.max(usize::from(path[0] != "super"));
            // Of a name with what is below it, the name itself may be passed on.
            [base, &path[named..]].concat()
        };
        let of_tests = if with_tests { paths(tests, &["crate"]) } else { Vec::new() };
        for path in paths(own, &["crate", "super", "self"]).into_iter().chain(of_tests).map(absolute) {
            let target = (0..=path.len()).rev().find_map(|length| {
                let whole = path[..length].to_vec();
                (passed.contains_key(&whole) || modules.contains(&whole)).then(|| resolved(whole)).flatten()
            });
            edges.extend(target.filter(|target| target != module).map(|target| (module.clone(), target)));
        }
    }
    edges
}

/// The edges between the modules of each folder: a pair of names, and an example of each.
fn between_siblings(edges: &BTreeSet<(Module, Module)>) -> BTreeMap<Module, BTreeMap<(String, String), String>> {
    let mut folders: BTreeMap<Module, BTreeMap<(String, String), String>> = BTreeMap::new();
    for (from, to) in edges {
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        if common < from.len() && common < to.len() {
            let example = format!("{} uses {}", from.join("::"), to.join("::"));
            let pair = (from[common].clone(), to[common].clone());
            folders.entry(from[..common].to_vec()).or_default().entry(pair).or_insert(example);
        }
    }
    folders
}

/// The edges of a circle; none where there is none.
fn circle(edges: &BTreeMap<(String, String), String>) -> Vec<String> {
    let mut left: Vec<(&(String, String), &String)> = edges.iter().collect();
    loop {
        let ends: BTreeSet<&String> = left.iter().map(|edge| &edge.0.0).collect();
        let starts: BTreeSet<&String> = left.iter().map(|edge| &edge.0.1).collect();
        let before = left.len();
        // An edge to a module that uses nothing, or from one that nothing uses, is in no circle.
        left.retain(|edge| ends.contains(&edge.0.1) && starts.contains(&edge.0.0));
        if left.len() == before {
            return left.into_iter().map(|edge| edge.1.clone()).collect();
        }
    }
}

/// The edges that lead upward.
fn upward(edges: &BTreeMap<(String, String), String>, layers: &[&str]) -> Vec<String> {
    let layer =
        |name: &String| layers.iter().position(|layer| layer == name).unwrap_or_else(|| panic!("{name} has no layer"));
    edges.iter().filter(|((from, to), _)| layer(from) <= layer(to)).map(|(_, example)| example.clone()).collect()
}

#[test]
fn the_library_s_modules_are_layers() {
    let folders = between_siblings(&imports(&library(), true));
    let top = &folders[&Module::new()];
    assert!(top.len() > 40, "the parser sees the imports: {}", top.len());
    assert_eq!(upward(top, &LAYERS), Vec::<String>::new());
    let of_gpu: Vec<&String> = top.keys().filter(|(from, _)| from == "gpu").map(|(_, to)| to).collect();
    assert_eq!(of_gpu, ["compute"], "the device knows plain records alone");
}

#[test]
fn no_folder_has_a_circle() {
    for sources in [library(), program()] {
        // A unit test may make its subject of whatever the folder has.
        for (folder, edges) in between_siblings(&imports(&sources, false)) {
            assert_eq!(circle(&edges), Vec::<String>::new(), "{}", folder.join("::"));
        }
    }
}

/// Made-up modules.
fn made_up(sources: &[(&str, &str)]) -> Vec<Source> {
    let source = |&(path, text): &(&str, &str)| Source { module: expanded(path).remove(0), code: code_of(text) };
    sources.iter().map(source).collect()
}

#[test]
fn a_circle_and_an_import_upward_are_seen() {
    let good = [
        ("", "pub mod low; pub mod high;"),
        (
            "low",
            "mod a; mod b; pub use b::Thing; // use crate::high::Other;\nconst TEXT: &str = \"crate::high::Other\";",
        ),
        ("low::a", "use super::Thing; fn f<'a>(x: &'a str) -> char { '\"' }"),
        ("low::b", "pub struct Thing;"),
        ("high", "use crate::{low::{Thing, c as d}, x}; fn g() { crate::low::a::f(); }"),
    ];
    let check = |sources: &[(&str, &str)]| {
        let none = BTreeMap::new();
        let [all, own] = [true, false].map(|with_tests| between_siblings(&imports(&made_up(sources), with_tests)));
        let top = all.get(&Module::new()).unwrap_or(&none);
        let [outer, inner] = [Module::new(), expanded("low").remove(0)].map(|folder| own.get(&folder).unwrap_or(&none));
        (upward(top, &["low", "high"]), circle(outer), circle(inner))
    };
    let none = Vec::<String>::new();
    assert_eq!(check(&good), (none.clone(), none.clone(), none.clone()));
    let with = |changed: (&'static str, &'static str)| {
        let mut sources = good;
        let place = sources.iter().position(|source| source.0 == changed.0).unwrap();
        sources[place] = changed;
        check(&sources)
    };
    // In the folder `low`, by a name that is passed on one way.
    let inner = vec!["low::a uses low::b".to_owned(), "low::b uses low::a".to_owned()];
    assert_eq!(with(("low::b", "pub struct Thing; fn g() { super::a::f(\"\") }")), (none.clone(), none.clone(), inner));
    let up = "low::b uses high".to_owned();
    let (upward, outer, _) = with(("low::b", "use crate::{\n    high::{self, g},\n};"));
    assert_eq!((upward, outer.contains(&up)), (vec![up.clone()], true));
    // A unit test may not look upward, but it closes no circle.
    let (upward, outer, _) = with(("low::b", "mod tests { use crate::high::g; }"));
    assert_eq!((upward, outer), (vec![up], none));
}
