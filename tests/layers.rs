//! Tests the layers of docs/architecture.md: a module imports from lower layers only, and no files import each other in
//! a circle.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::buffer::{Cursor, TokenBuffer};
use syn::visit::{self, Visit};
use walkdir::WalkDir;

/// The path of a module below the crate's root, such as `["gltf", "json"]`.
type ModulePath = Vec<String>;

/// The folders of the crates whose modules the table lists. Lower crates are imported with the names that they have
/// there.
const CRATES: [&str; 3] = ["crates/core/src", "crates/pipeline/src", "src"];

/// The folders of the crates that the table does not list. Each is a tree of modules of its own.
const CODEC_CRATES: [&str; 2] = ["crates/uastc/src", "crates/simd/src"];

/// What one source file imports and re-exports.
#[derive(Default)]
struct Imports {
    /// Absolute paths that the file names, each below the crate's root.
    paths: BTreeSet<ModulePath>,
    /// Names that the file re-exports, with the absolute paths that they stand for.
    re_exports: BTreeMap<String, ModulePath>,
    /// First names of the paths in the file's own items.
    used: BTreeSet<String>,
    /// Modules of the standard library that reach outside the process.
    outside: BTreeSet<String>,
}

/// Collects the imports of one file. Tests may import from anywhere and are left out.
struct Collector<'m> {
    /// The module that is read, with its inline modules.
    module: ModulePath,
    modules: &'m BTreeSet<ModulePath>,
    imports: Imports,
}

impl Collector<'_> {
    /// Records modules of the standard library that reach outside the process.
    fn note_outside(&mut self, segments: &[String]) {
        if let [root, module, ..] = segments
            && root == "std"
            && ["env", "fs", "net", "process"].contains(&module.as_str())
        {
            self.imports.outside.insert(module.clone());
        }
    }

    /// Records a path in the file's own items.
    fn note_path(&mut self, segments: &[String]) {
        self.note_outside(segments);
        self.imports.used.extend(segments.first().cloned());
        if segments.len() > 1
            && let Some(path) = self.absolute(segments)
        {
            self.imports.paths.insert(path);
        }
    }

    /// Records the paths among the tokens of a macro. Names after a single dot are fields and methods.
    fn note_tokens(&mut self, mut cursor: Cursor<'_>) {
        let mut dots = 0;
        while !cursor.eof() {
            if let Some((first, mut rest)) = cursor.ident() {
                let mut segments = vec![first.to_string()];
                while let Some((segment, after)) = next_segment(rest) {
                    segments.push(segment);
                    rest = after;
                }
                if dots != 1 {
                    self.note_path(&segments);
                }
                (dots, cursor) = (0, rest);
            } else if let Some((inner, _, _, rest)) = cursor.any_group() {
                self.note_tokens(inner);
                (dots, cursor) = (0, rest);
            } else if let Some((_, rest)) = cursor.punct().filter(|(punct, _)| punct.as_char() == '.') {
                (dots, cursor) = (dots + 1, rest);
            } else if let Some((_, rest)) = cursor.token_tree() {
                (dots, cursor) = (0, rest);
            }
        }
    }

    /// Makes a path absolute: `crate::`, `super::` and `self::` are resolved, and so are the module's own children.
    fn absolute(&self, segments: &[String]) -> Option<ModulePath> {
        let (first, rest) = segments.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => Some([&self.module[..], rest].concat()),
            "super" => {
                let ups = segments.iter().take_while(|segment| *segment == "super").count();
                let kept = self.module.len().checked_sub(ups)?;
                Some([&self.module[..kept], &segments[ups..]].concat())
            }
            _ => {
                let child = [&self.module[..], std::slice::from_ref(first)].concat();
                self.modules.contains(&child).then(|| [&self.module[..], segments].concat())
            }
        }
    }

    fn leaves(tree: &syn::UseTree, prefix: &[String], out: &mut Vec<(Vec<String>, String)>) {
        let with = |ident: &syn::Ident| [prefix, &[ident.to_string()]].concat();
        match tree {
            syn::UseTree::Path(path) => Self::leaves(&path.tree, &with(&path.ident), out),
            syn::UseTree::Name(name) if name.ident == "self" => {
                out.push((prefix.to_vec(), prefix.last().cloned().unwrap_or_default()));
            }
            syn::UseTree::Name(name) => out.push((with(&name.ident), name.ident.to_string())),
            syn::UseTree::Rename(rename) => out.push((with(&rename.ident), rename.rename.to_string())),
            syn::UseTree::Glob(_) => out.push((prefix.to_vec(), "*".to_owned())),
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| Self::leaves(tree, prefix, out)),
        }
    }
}

/// Reads `::` and a name.
fn next_segment(cursor: Cursor<'_>) -> Option<(String, Cursor<'_>)> {
    let (_, rest) = cursor.punct().filter(|(punct, _)| punct.as_char() == ':')?;
    let (_, rest) = rest.punct().filter(|(punct, _)| punct.as_char() == ':')?;
    let (segment, rest) = rest.ident()?;
    Some((segment.to_string(), rest))
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    let is_test = |attribute: &syn::Attribute| {
        attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    };
    attributes.iter().any(is_test)
}

impl<'ast> Visit<'ast> for Collector<'_> {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if is_test(&item.attrs) {
            return;
        }
        let mut leaves = Vec::new();
        Self::leaves(&item.tree, &[], &mut leaves);
        for (segments, name) in leaves {
            self.note_outside(&segments);
            let Some(path) = self.absolute(&segments) else { continue };
            let is_own_child = path.starts_with(&self.module) && path.len() > self.module.len();
            if !matches!(item.vis, syn::Visibility::Inherited) {
                self.imports.re_exports.insert(name, path.clone());
                // A module that re-exports names of its files does not depend on them, unless its items use the names.
                if is_own_child {
                    continue;
                }
            }
            self.imports.paths.insert(path);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.note_path(&segments);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        visit::visit_macro(self, item);
        self.note_tokens(TokenBuffer::new2(item.tokens.clone()).begin());
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) && item.content.is_some() {
            self.module.push(item.ident.to_string());
            visit::visit_item_mod(self, item);
            self.module.pop();
        }
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_test(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        if !is_test(&item.attrs) {
            visit::visit_item_impl(self, item);
        }
    }
}

/// Returns the imports of every source file of the crates in `folders` except tests, by module. The roots of several
/// crates are left out, because the crates share one tree of modules. The root of a single crate is the empty path.
fn imports(folders: &[&str]) -> BTreeMap<ModulePath, Imports> {
    let mut files = BTreeMap::new();
    let entries = folders.iter().flat_map(|folder| {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        WalkDir::new(&root).into_iter().map(move |entry| (root.clone(), entry))
    });
    for (root, entry) in entries {
        let entry = entry.expect("an entry of src");
        let path = entry.path();
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let below = path.strip_prefix(&root).expect("a path below src").with_extension("");
        let mut module: ModulePath = below.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        let is_test = |part: &String| part == "tests" || part == "test_files";
        let is_root = ["main", "lib"].iter().any(|root| module == [*root]);
        if module.iter().any(is_test) || (is_root && folders.len() > 1) {
            continue;
        }
        if is_root || module.last().is_some_and(|last| last == "mod") {
            module.pop();
        }
        files.insert(module, fs::read_to_string(path).expect("a source file"));
    }
    let modules: BTreeSet<ModulePath> = files.keys().cloned().collect();
    let read = |(module, text): (ModulePath, String)| {
        let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{module:?}: {error}"));
        let mut collector = Collector { module: module.clone(), modules: &modules, imports: Imports::default() };
        collector.visit_file(&file);
        let mut imports = collector.imports;
        let used = imports.re_exports.iter().filter(|(name, _)| imports.used.contains(*name));
        imports.paths.extend(used.map(|(_, path)| path.clone()));
        (module, imports)
    };
    files.into_iter().map(read).collect()
}

/// Returns the module whose file defines what `path` names, through any number of re-exports.
fn defining(files: &BTreeMap<ModulePath, Imports>, path: &[String], depth: usize) -> ModulePath {
    let known = (0..=path.len()).rev().find(|length| files.contains_key(&path[..*length])).unwrap_or(0);
    let (module, rest) = path.split_at(known);
    match rest.first().and_then(|name| files.get(module)?.re_exports.get(name)) {
        Some(target) if depth > 0 => defining(files, &[target, &rest[1..]].concat(), depth - 1),
        _ => module.to_vec(),
    }
}

/// Returns, for each file of the crates in `folders`, the files that define what it imports.
fn edges(folders: &[&str]) -> BTreeMap<ModulePath, BTreeSet<ModulePath>> {
    let files = imports(folders);
    let targets = |module: &ModulePath, imports: &Imports| {
        let targets = imports.paths.iter().map(|path| defining(&files, path, 8));
        targets.filter(|target| target != module && files.contains_key(target)).collect()
    };
    files.iter().map(|(module, imports)| (module.clone(), targets(module, imports))).collect()
}

/// Reads the layer of each module from the table of docs/architecture.md.
fn layers() -> BTreeMap<String, u32> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/architecture.md");
    let text = fs::read_to_string(path).expect("docs/architecture.md");
    let mut layers = BTreeMap::new();
    for line in text.lines() {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        let (Some(layer), Some(modules)) = (cells.next().and_then(|cell| cell.parse().ok()), cells.next()) else {
            continue;
        };
        for module in modules.split(',').map(|module| module.trim().trim_matches('`')) {
            assert!(layers.insert(module.to_owned(), layer).is_none(), "{module} stands twice in the table");
        }
    }
    layers
}

#[test]
fn modules_import_from_lower_layers_only() {
    let layers = layers();
    let mut wrong = Vec::new();
    for (module, targets) in edges(&CRATES) {
        let Some(top) = module.first() else { continue };
        let Some(layer) = layers.get(top) else {
            wrong.push(format!("module {top} is not in the table of docs/architecture.md"));
            continue;
        };
        for target in targets.iter().filter(|target| target[0] != *top) {
            if layers.get(&target[0]).is_none_or(|other| other >= layer) {
                wrong.push(format!("{} (layer {layer}) imports {}", module.join("::"), target.join("::")));
            }
        }
    }
    assert!(wrong.is_empty(), "{} imports break the table of docs/architecture.md:\n{}", wrong.len(), wrong.join("\n"));
}

/// Returns the modules of the crate that is built without the feature `cli`.
fn core_modules() -> BTreeSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/core/src/lib.rs");
    let root = syn::parse_file(&fs::read_to_string(path).expect("lib.rs")).expect("Rust");
    let modules =
        root.items.into_iter().filter_map(|item| if let syn::Item::Mod(item) = item { Some(item) } else { None });
    let is_core = |item: &syn::ItemMod| !item.attrs.iter().any(|attribute| attribute.path().is_ident("cfg"));
    modules.filter(is_core).map(|item| item.ident.to_string()).collect()
}

#[test]
fn the_core_touches_no_file_system() {
    let core = core_modules();
    assert!(core.contains("bake") && !core.contains("output"), "{core:?}");
    let is_core = |module: &ModulePath| module.first().is_some_and(|top| core.contains(top));
    let outside =
        imports(&CRATES).into_iter().filter(|(module, imports)| is_core(module) && !imports.outside.is_empty());
    let outside: Vec<String> =
        outside.map(|(module, imports)| format!("{} uses {:?}", module.join("::"), imports.outside)).collect();
    assert!(outside.is_empty(), "modules without the feature `cli` reach outside the process:\n{}", outside.join("\n"));
}

#[test]
fn every_module_of_the_table_exists() {
    let tops: BTreeSet<String> = edges(&CRATES).into_keys().filter_map(|module| module.first().cloned()).collect();
    let table: BTreeSet<String> = layers().into_keys().collect();
    assert_eq!(table, tops);
}

/// docs/architecture.md says which files to change for what.
#[test]
fn every_source_file_that_the_architecture_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/architecture.md")).expect("docs/architecture.md");
    let folders = ["src", "crates", "tests", "benches/studies", "examples"];
    let files: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| WalkDir::new(root.join(folder)))
        .map(|entry| entry.expect("a file").into_path())
        .collect();
    // Text in backticks is every second part.
    let named = text.split('`').skip(1).step_by(2).filter(|name| name.ends_with(".rs"));
    let missing: Vec<&str> = named.filter(|name| !files.iter().any(|file| file.ends_with(name))).collect();
    assert!(missing.is_empty(), "docs/architecture.md names files that do not exist: {missing:?}");
}

/// Returns the modules that `start` reaches by one or more imports.
fn reached<'e>(
    edges: &'e BTreeMap<ModulePath, BTreeSet<ModulePath>>,
    start: &'e ModulePath,
) -> BTreeSet<&'e ModulePath> {
    let (mut reached, mut next) = (BTreeSet::new(), vec![start]);
    while let Some(module) = next.pop() {
        let targets = edges.get(module).into_iter().flatten();
        next.extend(targets.filter(|target| reached.insert(*target)));
    }
    reached
}

/// Returns the circles of files that import each other in the crates in `folders`.
fn circles(folders: &[&str]) -> BTreeSet<String> {
    let edges = edges(folders);
    let reached: BTreeMap<&ModulePath, BTreeSet<&ModulePath>> =
        edges.keys().map(|module| (module, reached(&edges, module))).collect();
    let name = |module: &ModulePath| if module.is_empty() { "the root".to_owned() } else { module.join("::") };
    let mut circles = BTreeSet::new();
    for (module, targets) in &reached {
        if targets.contains(module) {
            let is_mutual = |other: &&&ModulePath| reached.get(**other).is_some_and(|back| back.contains(*module));
            let circle: Vec<String> = targets.iter().filter(is_mutual).map(|module| name(module)).collect();
            circles.insert(format!("{}: {}", folders.join(", "), circle.join(", ")));
        }
    }
    circles
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let codecs = CODEC_CRATES.iter().flat_map(|folder| circles(&[folder]));
    let circles: Vec<String> = circles(&CRATES).into_iter().chain(codecs).collect();
    assert!(circles.is_empty(), "these files import each other in circles:\n{}", circles.join("\n"));
}
