//! The house: how the crates' modules may import each other.
//!
//! Read from the sources themselves. At every level, modules that stand side by side import each other one way only:
//! no circle, through however many of them. A module and what is inside it are one room, so a child may use its
//! parent. Tests are left out: they may use whatever they like.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use syn::visit::Visit;

/// Most modules at the top of a crate.
const MOST_TOP_MODULES: usize = 12;

/// A module by its path in the crate; the crate's root is the empty path.
type Module = Vec<String>;
/// A name with the path that it stands for.
type Alias = (String, Module);

#[derive(Default)]
struct Crate {
    modules: BTreeSet<Module>,
    /// Paths that a module names, from the crate's root on: `[module]`.
    named: BTreeMap<Module, BTreeSet<Module>>,
    /// Names that a module hands on (`pub use`) or only renames: `[module]`.
    aliases: BTreeMap<Module, Vec<Alias>>,
}

/// Folders of all crates' sources.
fn crates() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut sources: Vec<_> = ["shared", "firmware", "host", "hil-tests"].map(|name| root.join(name)).into();
    let inside = fs::read_dir(root.join("host")).unwrap().map(|entry| entry.unwrap().path());
    sources.extend(inside.filter(|path| path.join("Cargo.toml").is_file() && !path.ends_with("fuzz")));
    sources.into_iter().map(|path| path.join("src")).collect()
}

impl Crate {
    /// The library of a package and its program, as far as it has them: crates of their own.
    fn of_package(source: &Path) -> Vec<Self> {
        let roots =
            ["lib.rs", "main.rs"].map(|name| source.join(name)).into_iter().filter(|path| path.is_file());
        let read = |root: PathBuf| {
            let mut found = Self::default();
            found.read_module(&root, source, Vec::new());
            found
        };
        roots.map(read).collect()
    }

    fn read_module(&mut self, file: &Path, folder: &Path, module: Module) {
        let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.read_items(&parsed.items, folder, &module);
        self.modules.insert(module);
    }

    fn read_items(&mut self, items: &[syn::Item], folder: &Path, module: &Module) {
        for item in items {
            match item {
                syn::Item::Mod(inner) if is_test(&inner.attrs) => {}
                syn::Item::Mod(inner) => self.read_inner(inner, folder, module),
                _ => Names { module, found: self }.visit_item(item),
            }
        }
    }

    fn read_inner(&mut self, inner: &syn::ItemMod, folder: &Path, module: &Module) {
        let name = inner.ident.to_string();
        let path: Module = module.iter().cloned().chain([name.clone()]).collect();
        if let Some((_, items)) = &inner.content {
            self.modules.insert(path.clone());
            return self.read_items(items, &folder.join(name), &path);
        }
        let (alone, inside) = (folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs"));
        let file = if alone.is_file() { alone } else { inside };
        // Of modules that are chosen (`#[path]`) the one by their own name is read.
        self.read_module(&file, &folder.join(&name), path);
    }

    /// The module that a path from the root leads into, through names that modules hand on.
    fn target(&self, path: &[String], depth: usize) -> Module {
        let mut module = Module::new();
        for (at, name) in path.iter().enumerate() {
            let longer: Module = module.iter().cloned().chain([name.clone()]).collect();
            if self.modules.contains(&longer) {
                module = longer;
                continue;
            }
            let aliases = self.aliases.get(&module).into_iter().flatten();
            let handed_on =
                aliases.filter(|(alias, _)| alias == name || alias == "*").map(|(alias, path)| {
                    if alias == "*" {
                        path.iter().cloned().chain([name.clone()]).collect()
                    } else {
                        path.clone()
                    }
                });
            let further = |start: Module| -> Module {
                start.into_iter().chain(path[at + 1..].iter().cloned()).collect()
            };
            let mut ends =
                handed_on.filter(|_| depth > 0).map(|start| self.target(&further(start), depth - 1));
            return ends.find(|end| !module.starts_with(end) || end.len() > module.len()).unwrap_or(module);
        }
        module
    }

    /// Imports between siblings: (parent, from, to) with the modules that need them.
    fn sibling_imports(&self) -> BTreeMap<Module, BTreeSet<(String, String, String)>> {
        let mut imports: BTreeMap<Module, BTreeSet<(String, String, String)>> = BTreeMap::new();
        for (from, paths) in &self.named {
            for path in paths {
                let to = self.target(path, 8);
                let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
                if let (Some(a), Some(b)) = (from.get(shared), to.get(shared)) {
                    let why = format!("{} -> {}", from.join("::"), path.join("::"));
                    imports.entry(from[..shared].to_vec()).or_default().insert((a.clone(), b.clone(), why));
                }
            }
        }
        imports
    }
}

/// Collects the paths that a module's items name.
struct Names<'a> {
    module: &'a Module,
    found: &'a mut Crate,
}

impl Names<'_> {
    /// A path from the crate's root, if it does not lead out of the crate.
    fn absolute(&self, path: &[String]) -> Option<Module> {
        let supers = path.iter().take_while(|name| *name == "super").count();
        let up = self.module.len().checked_sub(supers)?;
        match path.first()?.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some(self.module.iter().chain(&path[1..]).cloned().collect()),
            "super" => Some(self.module[..up].iter().chain(&path[supers..]).cloned().collect()),
            // A child of this module, or another crate: of no concern here, but for names that are handed on.
            _ => Some(self.module.iter().chain(path).cloned().collect()),
        }
    }

    fn name(&mut self, path: &[String]) {
        if matches!(path.first().map(String::as_str), Some("crate" | "self" | "super"))
            && let Some(path) = self.absolute(path)
        {
            self.found.named.entry(self.module.clone()).or_default().insert(path);
        }
    }

    fn hand_on(&mut self, alias: String, path: &[String]) {
        if let Some(path) = self.absolute(path) {
            self.found.aliases.entry(self.module.clone()).or_default().push((alias, path));
        }
    }

    fn use_tree(&mut self, tree: &syn::UseTree, before: &[String]) {
        let with = |name: &syn::Ident| before.iter().cloned().chain([name.to_string()]).collect::<Vec<_>>();
        match tree {
            syn::UseTree::Path(path) => self.use_tree(&path.tree, &with(&path.ident)),
            syn::UseTree::Group(group) => group.items.iter().for_each(|item| self.use_tree(item, before)),
            syn::UseTree::Glob(_) => {
                self.name(before);
                self.hand_on("*".to_owned(), before);
            }
            syn::UseTree::Name(name) if name.ident == "self" => {
                self.name(before);
                self.hand_on(before.last().cloned().unwrap_or_default(), before);
            }
            syn::UseTree::Name(name) => {
                let path = with(&name.ident);
                self.name(&path);
                self.hand_on(name.ident.to_string(), &path);
            }
            syn::UseTree::Rename(rename) => {
                let path = if rename.ident == "self" { before.to_vec() } else { with(&rename.ident) };
                self.name(&path);
                self.hand_on(rename.rename.to_string(), &path);
            }
        }
    }
}

impl<'ast> Visit<'ast> for Names<'_> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        let attributes = match item {
            syn::Item::Fn(item) => &item.attrs[..],
            syn::Item::Impl(item) => &item.attrs,
            syn::Item::Use(item) => &item.attrs,
            _ => &[],
        };
        if !is_test(attributes) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.use_tree(&item.tree, &[]);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.name(&path.segments.iter().map(|segment| segment.ident.to_string()).collect::<Vec<_>>());
        syn::visit::visit_path(self, path);
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    let text = |attribute: &syn::Attribute| match &attribute.meta {
        syn::Meta::List(list) if list.path.is_ident("cfg") => list.tokens.to_string(),
        _ => String::new(),
    };
    attributes.iter().any(|attribute| text(attribute).split([' ', '(', ')', ',']).any(|word| word == "test"))
}

/// Modules that lie on a circle of imports, if there is one.
fn circle(imports: &BTreeSet<(String, String, String)>) -> BTreeSet<String> {
    let mut left: BTreeSet<&str> =
        imports.iter().flat_map(|(from, to, _)| [from.as_str(), to.as_str()]).collect();
    loop {
        // Whoever imports nobody left, or is imported by nobody left, lies on no circle.
        let within = |a: &str, b: &str| left.contains(a) && left.contains(b) && a != b;
        let imports_some: BTreeSet<&str> =
            imports.iter().filter(|(a, b, _)| within(a, b)).map(|(a, _, _)| a.as_str()).collect();
        let is_imported: BTreeSet<&str> =
            imports.iter().filter(|(a, b, _)| within(a, b)).map(|(_, b, _)| b.as_str()).collect();
        let kept: BTreeSet<&str> = imports_some.intersection(&is_imported).copied().collect();
        if kept.len() == left.len() {
            return kept.into_iter().map(str::to_owned).collect();
        }
        left = kept;
    }
}

fn circles(source: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for (parent, imports) in Crate::of_package(source).iter().flat_map(Crate::sibling_imports) {
        let on_circle = circle(&imports);
        let tied =
            imports.iter().filter(|(a, b, _)| a != b && on_circle.contains(a) && on_circle.contains(b));
        let why: Vec<_> = tied.map(|(_, _, why)| format!("    {why}")).collect();
        if !why.is_empty() {
            let place = parent.join("::");
            found.push(format!("{}: in crate::{place}: {on_circle:?}\n{}", source.display(), why.join("\n")));
        }
    }
    found
}

#[test]
fn no_modules_import_each_other_in_a_circle() {
    let found: Vec<_> = crates().iter().flat_map(|source| circles(source)).collect();
    assert!(found.is_empty(), "{} circles of imports:\n{}", found.len(), found.join("\n"));
}

#[test]
fn no_crate_has_more_than_a_dozen_modules_at_its_top() {
    for source in crates() {
        for package in Crate::of_package(&source) {
            let tops = package.modules.iter().filter(|module| module.len() == 1).count();
            assert!(tops <= MOST_TOP_MODULES, "{} has {tops} modules at its top", source.display());
        }
    }
}

#[test]
fn a_circle_is_found_through_names_that_a_parent_hands_on() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("lib.rs", "mod a; mod b; mod c; pub use b::B;");
    write("a.rs", "use crate::B; pub struct A;");
    write("b.rs", "pub struct B; fn f() { crate::c::g(); }");
    write("c.rs", "pub fn g() {} #[cfg(test)] mod tests { use crate::b::B; }");
    assert_eq!(circles(folder.path()), Vec::<String>::new());
    write("c.rs", "use super::a::A; pub fn g() {}");
    let found = circles(folder.path());
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains(r#"{"a", "b", "c"}"#) && found[0].contains("a -> B"), "{found:?}");
}
