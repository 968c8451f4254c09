//! There are no circular imports: files that import each other are one concept cut in two.
//!
//! A file imports another if a `use`, or a path in its code, refers to something that the other defines; a re-export
//! is followed to the file that defines it. Tests inside the files are left out, and so are paths inside macros whose
//! arguments are not a list of expressions.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, Item, ItemUse, Macro, Token, UseTree, Visibility};

#[test]
fn no_file_lies_in_a_circle_of_imports() {
    for folder in ["src", "program/src", "emit/src", "../grammar/src"] {
        let circles = circles(&imports(folder));
        assert!(circles.is_empty(), "{folder}: {circles:#?}");
    }
}

/// A module as its path, `["reply", "action"]`; the crate's root is empty.
type Module = Vec<String>;

/// The paths that one file names, and the names that it re-exports.
#[derive(Default)]
struct Names {
    module: Module,
    children: BTreeSet<String>,
    paths: Vec<Vec<String>>,
    re_exports: BTreeMap<String, Vec<String>>,
}

/// Returns, for each file of a crate, the files that it imports from.
fn imports(folder: &str) -> BTreeMap<Module, BTreeSet<Module>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut texts = BTreeMap::new();
    read(&root, &[], &mut texts);
    let mut all: BTreeMap<Module, Names> = BTreeMap::new();
    for (module, text) in &texts {
        let is_child = |it: &&Module| it.len() == module.len() + 1 && it.starts_with(module);
        let mut names = Names {
            module: module.clone(),
            children: texts
                .keys()
                .filter(is_child)
                .filter_map(|it| it.last().cloned())
                .collect(),
            ..Names::default()
        };
        names.visit_file(&syn::parse_file(text).unwrap());
        all.insert(module.clone(), names);
    }
    let imported = |(module, names): (&Module, &Names)| {
        let defined = names.paths.iter().map(|path| definer(path, &all, 0));
        let others = defined.filter(|it| it != module).collect();
        (module.clone(), others)
    };
    all.iter().map(imported).collect()
}

/// Reads every `.rs` file below a folder.
fn read(folder: &Path, above: &[String], texts: &mut BTreeMap<Module, String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let module = [above, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            read(&path, &module, texts);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let is_folders_own = matches!(name.as_str(), "mod" | "lib");
            let module = if is_folders_own {
                above.to_vec()
            } else {
                module
            };
            texts.insert(module, std::fs::read_to_string(path).unwrap());
        }
    }
}

/// Returns the module that defines the item at a path from the crate's root.
fn definer(path: &[String], all: &BTreeMap<Module, Names>, depth: usize) -> Module {
    assert!(depth < 32, "`{}` is passed on in a circle", path.join("::"));
    let is_module = |length: &usize| all.contains_key(&path[..*length]);
    let length = (0..=path.len()).rev().find(is_module).unwrap_or(0);
    let (module, rest) = path.split_at(length);
    match rest
        .split_first()
        .and_then(|(name, rest)| Some((all[module].re_exports.get(name)?, rest)))
    {
        Some((target, rest)) => definer(&[target, rest].concat(), all, depth + 1),
        None => module.to_vec(),
    }
}

impl Names {
    /// Returns a path from the crate's root; `None` for one that leads out of the crate, or to an item of the file
    /// itself.
    fn absolute(&self, path: &[String]) -> Option<Vec<String>> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => Some([&self.module, rest].concat()),
            "super" => {
                let n_up = path.iter().take_while(|part| *part == "super").count();
                let base = self.module.len().checked_sub(n_up)?;
                Some([&self.module[..base], &path[n_up..]].concat())
            }
            first if self.children.contains(first) => Some([&self.module, path].concat()),
            _ => None,
        }
    }

    fn add_tree(&mut self, tree: &UseTree, above: &[String], is_public: bool) {
        let below = |name: &dyn ToString| [above, &[name.to_string()]].concat();
        let (path, known_as) = match tree {
            UseTree::Path(it) => return self.add_tree(&it.tree, &below(&it.ident), is_public),
            UseTree::Group(it) => {
                return it
                    .items
                    .iter()
                    .for_each(|tree| self.add_tree(tree, above, is_public));
            }
            UseTree::Name(it) if it.ident == "self" => (above.to_vec(), above.last().cloned()),
            UseTree::Name(it) => (below(&it.ident), Some(it.ident.to_string())),
            UseTree::Rename(it) => (below(&it.ident), Some(it.rename.to_string())),
            UseTree::Glob(_) => (above.to_vec(), None),
        };
        let Some(path) = self.absolute(&path) else {
            return;
        };
        self.paths.push(path.clone());
        if let (true, Some(name)) = (is_public, known_as) {
            self.re_exports.insert(name, path);
        }
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast Item) {
        let attributes: &[Attribute] = match item {
            Item::Mod(it) => &it.attrs,
            Item::Fn(it) => &it.attrs,
            Item::Use(it) => &it.attrs,
            _ => &[],
        };
        let is_test = |it: &Attribute| {
            it.path().is_ident("cfg") && it.parse_args::<syn::Ident>().is_ok_and(|it| it == "test")
        };
        if !attributes.iter().any(is_test) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.add_tree(&item.tree, &[], !matches!(item.vis, Visibility::Inherited));
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let parts: Vec<String> = path
            .segments
            .iter()
            .map(|it| it.ident.to_string())
            .collect();
        if parts.len() > 1 {
            self.paths.extend(self.absolute(&parts));
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast Macro) {
        if let Ok(parts) = item.parse_body_with(Punctuated::<Expr, Token![,]>::parse_terminated) {
            // The expressions live no longer than this call, so a separate visitor collects their paths.
            let mut inner = Names {
                module: self.module.clone(),
                children: self.children.clone(),
                ..Names::default()
            };
            parts.iter().for_each(|part| inner.visit_expr(part));
            self.paths.append(&mut inner.paths);
        }
        visit::visit_macro(self, item);
    }
}

/// Returns the largest sets of files in which each leads to every other.
fn circles(imports: &BTreeMap<Module, BTreeSet<Module>>) -> Vec<BTreeSet<String>> {
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = imports
        .keys()
        .map(|from| {
            let mut seen = BTreeSet::new();
            let mut open: Vec<&Module> = imports[from].iter().collect();
            while let Some(module) = open.pop() {
                if seen.insert(module) {
                    open.extend(&imports[module]);
                }
            }
            (from, seen)
        })
        .collect();
    let name = |module: &Module| match module.is_empty() {
        true => "lib".to_owned(),
        false => module.join("::"),
    };
    let circle = |(from, seen): (&&Module, &BTreeSet<&Module>)| {
        let back = seen.iter().filter(|to| reached[**to].contains(from));
        back.map(|to| name(to)).collect::<BTreeSet<String>>()
    };
    let all: BTreeSet<BTreeSet<String>> = reached.iter().map(circle).collect();
    all.into_iter()
        .filter(|circle| !circle.is_empty())
        .collect()
}
