//! Reads the entry file and everything that it uses.
//!
//! In: a name and a loader. Out: every file as a tree, which files each one sees, and diagnostics about syntax and
//! `use`. [`MAX_FILES`], [`MAX_USE_DEPTH`] and [`MAX_TOTAL_BYTES`] limit the work. No path may leave the entry's
//! folder, except into a folder `lib` beside it.

use crate::diag::{Code, Diagnostic, MAX_FINDINGS, Report, Reported};
use crate::loader::{Listed, LoadError, Loader, Wanted};
use crate::path;
use crate::syntax;
use fab_grammar::ast::{Experts, Material, Name, Task};
use fab_grammar::{FileId, Kind, Node, Sources, Span, Tree};
use fab_program::invisible::{is_hidden, turns_writing};
use fab_program::{self as program, Trial};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// The most files in one compilation.
pub const MAX_FILES: usize = 64;

/// The most `use`s between the entry and a file.
pub const MAX_USE_DEPTH: usize = 16;

/// The most text in one compilation, bytes.
pub const MAX_TOTAL_BYTES: usize = 4 << 20;

/// The parsed texts of a compilation, in the order in which they were first read.
#[derive(Default)]
pub(crate) struct Texts {
    pub sources: Sources,
    trees: Vec<Tree>,
    /// For each file, its path relative to the entry's folder, so it is the same on every machine.
    pub portable_names: Vec<String>,
    /// For each file, itself and the files that it uses, directly or through others.
    reach: Vec<BTreeSet<FileId>>,
    /// For each file, whether something in it does not parse, or is invisible.
    malformed: Vec<bool>,
    /// For each file, the proof that a file that it uses cannot be read, if so.
    unread: Vec<Option<Reported>>,
}

/// The views of one file.
pub(crate) struct LoadedFile<'a> {
    pub id: FileId,
    pub experts: Vec<Experts<'a>>,
    pub materials: Vec<Material<'a>>,
    pub tasks: Vec<Task<'a>>,
    /// The index of the first task of each name.
    task_index: BTreeMap<&'a str, usize>,
    /// The same for lists of experts.
    experts_index: BTreeMap<&'a str, usize>,
    /// The same for materials.
    materials_index: BTreeMap<&'a str, usize>,
}

/// Every file of a compilation, and which files each one sees.
pub(crate) struct Loaded<'a> {
    pub texts: &'a Texts,
    pub files: Vec<LoadedFile<'a>>,
    /// The bytes from each name of a task, list of experts or material to the next name, by the name's span.
    sizes: BTreeMap<Span, usize>,
    /// The tasks that others extend, by the spans of their names.
    extended: BTreeSet<Span>,
    /// The words of all files that use a name; those that only declare a constant, a keypoint or a material are left out.
    used: BTreeSet<&'a str>,
    loader: &'a dyn Loader,
    /// What [`Loaded::materials_to_use`] found for a file.
    libraries: RefCell<BTreeMap<FileId, Option<LibraryOfMaterials>>>,
}

/// The path of a file in a `use`, and the names of its materials.
type LibraryOfMaterials = (&'static str, Vec<String>);

impl<'a> Loaded<'a> {
    /// Views the files of `texts`.
    pub fn of(texts: &'a Texts, loader: &'a dyn Loader) -> Loaded<'a> {
        let mut sizes = BTreeMap::new();
        let mut files = Vec::with_capacity(texts.trees.len());
        for tree in &texts.trees {
            let file = tree.view();
            let (tasks, experts): (Vec<_>, Vec<_>) =
                (file.tasks().collect(), file.experts().collect());
            let materials: Vec<_> = file.materials().collect();
            let names = tasks.iter().map(|task| task.name());
            let lists = experts.iter().map(|list| list.name());
            let made_of = materials.iter().map(|material| material.name());
            sizes.extend(self::sizes(
                names.clone().chain(lists.clone()).chain(made_of.clone()),
                tree.text().len(),
            ));
            files.push(LoadedFile {
                id: file.span().file,
                task_index: first_of_each_name(names),
                experts_index: first_of_each_name(lists),
                materials_index: first_of_each_name(made_of),
                tasks,
                experts,
                materials,
            });
        }
        let mut loaded = Loaded {
            texts,
            files,
            sizes,
            extended: BTreeSet::new(),
            loader,
            libraries: RefCell::default(),
            used: texts.trees.iter().flat_map(used).collect(),
        };
        let tasks = loaded.files.iter().flat_map(|file| &file.tasks);
        let bases = tasks.filter_map(|task| task.extends());
        loaded.extended = bases
            .filter_map(|base| loaded.task(base.span().file, base.text()))
            .map(|task| task.name().span())
            .collect();
        loaded
    }

    /// Finds the first task of this name that `file` sees.
    pub fn task(&self, file: FileId, name: &str) -> Option<Task<'a>> {
        self.visible_from(file)
            .find_map(|seen| Some(seen.tasks[*seen.task_index.get(name)?]))
    }

    /// Finds the first list of experts of this name that `file` sees.
    pub fn experts(&self, file: FileId, name: &str) -> Option<Experts<'a>> {
        self.visible_from(file)
            .find_map(|seen| Some(seen.experts[*seen.experts_index.get(name)?]))
    }

    /// Finds the first material of this name that `file` sees.
    pub fn material(&self, file: FileId, name: &str) -> Option<Material<'a>> {
        self.visible_from(file)
            .find_map(|seen| Some(seen.materials[*seen.materials_index.get(name)?]))
    }

    /// Returns roughly how many bytes of text the item of this name has.
    pub fn size(&self, name: Name<'a>) -> usize {
        self.sizes.get(&name.span()).copied().unwrap_or(0)
    }

    /// Returns whether another task extends this one.
    pub fn is_extended(&self, task: Task<'a>) -> bool {
        self.extended.contains(&task.name().span())
    }

    /// Returns what lies where a task names a file.
    ///
    /// - `path`: relative to the entry's folder.
    pub fn look(&self, path: &str, wanted: Wanted) -> Listed {
        self.loader.look(path, wanted)
    }

    /// Returns what the steps of a task's demonstration did when it was last executed; see [`Loader::trial`].
    pub fn trial(&self, title: &str) -> Option<Trial> {
        self.loader.trial(title)
    }

    /// Returns why a cloth cannot be laid in the caller's simulator; see [`Loader::refuses_cloth`].
    pub fn refuses_cloth(&self, material: &program::Material, spacing_m: f64) -> Option<String> {
        self.loader.refuses_cloth(material, spacing_m)
    }

    /// Returns a path that `file` may use to read the library of materials, and the names that it declares, if it lies in a
    /// folder `lib` beside the file or beside the file's folder.
    pub fn materials_to_use(&self, file: FileId) -> Option<LibraryOfMaterials> {
        let mut libraries = self.libraries.borrow_mut();
        let library = libraries.entry(file);
        library.or_insert_with(|| self.find_materials(file)).clone()
    }

    fn find_materials(&self, file: FileId) -> Option<LibraryOfMaterials> {
        let here = &self.texts.portable_names[file.index()];
        let name = &self.texts.sources.get(file).name;
        let paths = ["lib/materials.fab", "../lib/materials.fab"].into_iter();
        let mut allowed = paths.filter(|path| path::within_or_library(here, path).is_some());
        allowed.find_map(|path| {
            let text = self.loader.load(&path::beside(name, path)).ok()?;
            let tree = fab_grammar::parse(file, &text).tree;
            let declared = tree.view().materials();
            let names = declared.map(|material| material.name().text().to_owned());
            Some((path, names.collect()))
        })
    }

    /// Returns whether any file uses a constant, a keypoint or a material of this name.
    pub fn is_used(&self, name: &str) -> bool {
        self.used.contains(name)
    }

    /// Returns the files whose declarations `file` sees, in the order in which they were read.
    pub fn visible_from(&self, file: FileId) -> impl Iterator<Item = &LoadedFile<'a>> {
        self.texts.reach[file.index()]
            .iter()
            .map(|seen| &self.files[seen.index()])
    }

    /// Returns the entry file.
    pub fn entry(&self) -> &LoadedFile<'a> {
        &self.files[0]
    }

    /// Returns whether `file` sees a file with a syntax error, itself or another. Its names and types are not checked.
    pub fn is_malformed(&self, file: FileId) -> bool {
        let mut seen = self.texts.reach[file.index()].iter();
        seen.any(|seen| self.texts.malformed[seen.index()])
    }

    /// Returns the proof that a file that `file` uses cannot be read; it may declare any unknown name.
    pub fn unread(&self, file: FileId) -> Option<Reported> {
        let mut seen = self.visible_from(file);
        seen.find_map(|seen| self.texts.unread[seen.id.index()])
    }

    /// Returns the text of a span.
    pub fn written(&self, span: Span) -> &'a str {
        self.texts.sources.text(span)
    }

    /// Returns the path of a file, relative to the entry's folder, and the line of a byte.
    pub fn place(&self, file: FileId, byte: usize) -> (String, u32) {
        let (line, _) = self.texts.sources.get(file).line_and_column(byte);
        (self.texts.portable_names[file.index()].clone(), line as u32)
    }
}

/// Reads `entry` and what it uses; fails only if the entry cannot be loaded.
pub(crate) fn read(
    entry: &str,
    loader: &dyn Loader,
    report: &mut Report,
) -> Result<Texts, LoadError> {
    let text = loader.load(entry)?;
    let mut reading = Reading {
        loader,
        report,
        texts: Texts::default(),
        keys: Vec::new(),
        unreadable: BTreeMap::new(),
        total_bytes: 0,
        open: Vec::new(),
    };
    let file = reading.add(entry.to_owned(), path::file_name(entry).to_owned(), text);
    reading.follow(file);
    let mut texts = reading.texts;
    close(&mut texts.reach);
    Ok(texts)
}

/// Adds to each file the files that it sees through others.
fn close(reach: &mut [BTreeSet<FileId>]) {
    // Circular `use` is an error, but its files still see each other, so repeat until nothing changes.
    loop {
        let mut grown = false;
        for file in 0..reach.len() {
            let further: BTreeSet<FileId> = reach[file]
                .iter()
                .flat_map(|seen| reach[seen.index()].iter().copied())
                .collect();
            grown |= further.len() > reach[file].len();
            reach[file].extend(further);
        }
        if !grown {
            return;
        }
    }
}

struct Reading<'a> {
    loader: &'a dyn Loader,
    report: &'a mut Report,
    texts: Texts,
    /// Each file's normalised name, which tells whether it was read before.
    keys: Vec<String>,
    /// Files that could not be read, and why. The loader is asked only once for each.
    unreadable: BTreeMap<String, LoadError>,
    total_bytes: usize,
    /// The files between the entry and the one being read.
    open: Vec<FileId>,
}

impl Reading<'_> {
    fn add(&mut self, name: String, portable_name: String, text: String) -> FileId {
        self.total_bytes += text.len();
        self.keys.push(path::beside("", &name));
        let file = self.texts.sources.add(name, text);
        let text = &self.texts.sources.get(file).text;
        let parsed = fab_grammar::parse(file, text);
        let n_reported = parsed.faults.len().min(MAX_FINDINGS);
        self.report
            .count_further(parsed.faults.len() - n_reported, file);
        for fault in &parsed.faults[..n_reported] {
            // A hidden character is reported by itself.
            let ends = [fault.span.start, fault.span.end];
            if !ends.iter().any(|end| text[*end..].starts_with(is_hidden)) {
                self.report.error(syntax::diagnose(fault, text));
            }
        }
        self.hidden_characters(file);
        let is_malformed = self.report.error_in(file).is_some();
        self.texts.malformed.push(is_malformed);
        self.texts.unread.push(None);
        self.texts.trees.push(parsed.tree);
        self.texts.portable_names.push(portable_name);
        self.texts.reach.push(BTreeSet::from([file]));
        file
    }

    /// Reports the characters of a file that a reader does not see.
    fn hidden_characters(&mut self, file: FileId) {
        let text = &self.texts.sources.get(file).text;
        let hidden = || text.char_indices().filter(|(_, it)| is_hidden(*it));
        for (at, character) in hidden().take(MAX_FINDINGS) {
            let shown = character.escape_unicode();
            let message = if turns_writing(character) {
                format!("the character `{shown}` turns the direction of writing")
            } else {
                format!("the character `{shown}` is not visible")
            };
            let span = Span::new(file, at..at + character.len_utf8());
            let diagnostic = Diagnostic::new(Code::ControlCharacter, span, message);
            self.report.error(diagnostic.help("remove it"));
        }
        let further = hidden().count().saturating_sub(MAX_FINDINGS);
        self.report.count_further(further, file);
    }

    /// Reads the files that a file uses; recursion is bounded by [`MAX_USE_DEPTH`].
    fn follow(&mut self, file: FileId) {
        self.open.push(file);
        let uses = self.texts.trees[file.index()].view().uses();
        let paths: Vec<_> = uses
            .map(|used| (used.path().span(), used.path().plain()))
            .collect();
        let mut used: BTreeMap<String, Span> = BTreeMap::new();
        for (span, path) in paths {
            let first = match &path {
                Some(path) => *used.entry(path.clone()).or_insert(span),
                None => span,
            };
            if first != span {
                let diagnostic = Diagnostic::new(Code::Repeated, span, "this file is used twice");
                let diagnostic = diagnostic.also(first, "used here first");
                self.report.error(diagnostic.help("drop this line"));
                continue;
            }
            // A file that cannot be read was reported; go on with the others.
            match self.reach(file, span, path) {
                Ok(target) => {
                    self.texts.reach[file.index()].insert(target);
                }
                Err(reported) => self.texts.unread[file.index()] = Some(reported),
            }
        }
        self.open.pop();
    }

    fn reach(
        &mut self,
        file: FileId,
        span: Span,
        path: Option<String>,
    ) -> Result<FileId, Reported> {
        let Some(written) = path else {
            let message = "the path of a `use` has a placeholder";
            let diagnostic = Diagnostic::new(Code::BadPath, span, message);
            return Err(self.report.error(diagnostic.help("write the path itself")));
        };
        if let Some(fault) = path::fault(&written) {
            let message = format!("the path `{written}` {fault}");
            return Err(self
                .report
                .error(Diagnostic::new(Code::BadPath, span, message)));
        }
        let here = &self.texts.portable_names[file.index()];
        let Some(portable_name) = path::within_or_library(here, &written) else {
            let message = format!("the path `{written}` leads out of the folder of the first file");
            return Err(self.report.error(Diagnostic::new(Code::BadPath, span, message).help(
                "move the file into the first file's folder or below, or into a folder `lib` next to that folder; or check a file higher up",
            )));
        };
        let name = path::beside(&self.texts.sources.get(file).name, &written);
        if let Some(index) = self.keys.iter().position(|key| *key == name) {
            let target = self.texts.trees[index].root().span().file;
            if self.open.contains(&target) {
                let message = format!("`{written}` is used in a circle");
                let label = if target == file {
                    "this is the file itself"
                } else {
                    "leads back to this file"
                };
                self.report
                    .error(Diagnostic::new(Code::CircularUse, span, message).label(label));
            }
            return Ok(target);
        }
        let is_unreadable = self.unreadable.contains_key(&name);
        let n_asked = self.keys.len() + self.unreadable.len();
        if !is_unreadable && (n_asked >= MAX_FILES || self.open.len() > MAX_USE_DEPTH) {
            let message = format!(
                "`{written}` is not read: there may be at most {MAX_FILES} files, each at most {MAX_USE_DEPTH} `use`s deep"
            );
            return Err(self
                .report
                .error(Diagnostic::new(Code::TooManyFiles, span, message)));
        }
        match self.read(&name) {
            Ok(text) if self.total_bytes + text.len() > MAX_TOTAL_BYTES => {
                let message = format!(
                    "`{written}` is not read: with it the files would have more than {MAX_TOTAL_BYTES} bytes"
                );
                Err(self
                    .report
                    .error(Diagnostic::new(Code::TooManyFiles, span, message)))
            }
            Ok(text) => {
                let target = self.add(name, portable_name, text);
                self.follow(target);
                Ok(target)
            }
            Err(error) => {
                let diagnostic = Diagnostic::new(Code::UnreadableUse, span, error.message);
                let has_ending = written.ends_with(".fab");
                let help = match !has_ending && self.loader.load(&format!("{name}.fab")).is_ok() {
                    true => format!("did you mean `{written}.fab`?"),
                    false => format!(
                        "paths are relative to the file that contains them: this one is `{name}`"
                    ),
                };
                Err(self.report.error(diagnostic.help(help)))
            }
        }
    }

    fn read(&mut self, name: &str) -> Result<String, LoadError> {
        if let Some(error) = self.unreadable.get(name) {
            return Err(error.clone());
        }
        self.loader.load(name).inspect_err(|error| {
            self.unreadable.insert(name.to_owned(), error.clone());
        })
    }
}

/// Returns the names of a file, except where one declares a constant or a keypoint.
fn used(tree: &Tree) -> impl Iterator<Item = &str> {
    let names = tree.nodes().filter(|node| match node.kind() {
        Kind::Path => true,
        Kind::Name => !declares(*node),
        _ => false,
    });
    names.flat_map(|node| node.text().split('.'))
}

/// Returns whether a name is the one that a constant, a keypoint or a material declares, or a material's property.
fn declares(name: Node<'_>) -> bool {
    let declaration = name.parent().filter(|parent| match parent.kind() {
        Kind::Constant | Kind::Keypoint | Kind::Property => true,
        Kind::Head => parent.parent().map(Node::kind) == Some(Kind::Material),
        _ => false,
    });
    let declared = declaration.and_then(|declaration| declaration.child(Kind::Name));
    declared.is_some_and(|declared| declared.range() == name.range())
}

fn first_of_each_name<'a>(names: impl Iterator<Item = Name<'a>>) -> BTreeMap<&'a str, usize> {
    let mut index = BTreeMap::new();
    for (at, name) in names.enumerate() {
        index.entry(name.text()).or_insert(at);
    }
    index
}

/// Returns the number of bytes from each name to the next, or to the end.
fn sizes<'a>(
    names: impl Iterator<Item = Name<'a>>,
    end: usize,
) -> impl Iterator<Item = (Span, usize)> {
    let mut spans: Vec<Span> = names.map(|name| name.span()).collect();
    spans.sort();
    let ends: Vec<usize> = spans
        .iter()
        .skip(1)
        .map(|span| span.start)
        .chain([end])
        .collect();
    spans
        .into_iter()
        .zip(ends)
        .map(|(span, end)| (span, end - span.start))
}
