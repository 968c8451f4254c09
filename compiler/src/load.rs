//! Reads the entry file and everything that it uses.
//!
//! In: a name and a loader. Out: every file as a tree, which files each one sees, and diagnostics about syntax and
//! `use`. [`MAX_FILES`] limits the work. No path may leave the entry's
//! folder, except into a folder `lib` beside it.

use crate::diag::{Code, Diagnostic, MAX_FINDINGS, Report, Reported};
use crate::loader::{LoadError, Loader};
use crate::path;
use crate::syntax;
use fab_grammar::ast::{Experts, File, Material, Task};
use fab_grammar::{FileId, Kind, Node, Sources, Span, Tree};
use fab_program::invisible::{is_hidden, turns_writing};
use std::collections::{BTreeMap, BTreeSet};

/// The most files in one compilation.
pub const MAX_FILES: usize = 64;

/// The parsed texts of a compilation, in the order in which they were first read.
#[derive(Default)]
pub(crate) struct Texts {
    pub sources: Sources,
    parsed: Vec<Parsed>,
}

/// One parsed text.
struct Parsed {
    tree: Tree,
    /// Its path relative to the entry's folder, so it is the same on every machine.
    portable_name: String,
    /// Itself and the files that it uses, directly or through others.
    reach: BTreeSet<FileId>,
    /// Whether something in it does not parse or is invisible, or a file that it uses cannot be read.
    is_malformed: bool,
}

/// Every file of a compilation, and which files each one sees.
pub(crate) struct Loaded<'a> {
    texts: &'a Texts,
    pub files: Vec<File<'a>>,
    /// The first declaration of each name in each file, by its kind.
    declared: BTreeMap<(FileId, Kind, &'a str), Node<'a>>,
    /// The tasks that others extend, by the spans of their names.
    extended: BTreeSet<Span>,
    /// The words of all files that use a name; those that only declare a constant, a keypoint or a material are left out.
    used: BTreeSet<&'a str>,
    pub loader: &'a dyn Loader,
}

impl<'a> Loaded<'a> {
    /// Views the files of `texts`.
    pub fn of(texts: &'a Texts, loader: &'a dyn Loader) -> Loaded<'a> {
        let files: Vec<File<'a>> = { texts.parsed.iter() }.map(|it| it.tree.view()).collect();
        let mut declared = BTreeMap::new();
        for node in files.iter().flat_map(|file| file.node().children()) {
            let head = node.child(Kind::Head);
            if let Some(name) = head.and_then(|head| head.child(Kind::Name)) {
                let key = (node.span().file, node.kind(), name.text());
                declared.entry(key).or_insert(node);
            }
        }
        let mut loaded = Loaded {
            texts,
            files,
            declared,
            extended: BTreeSet::new(),
            loader,
            used: { texts.parsed.iter() }
                .flat_map(|it| used(&it.tree))
                .collect(),
        };
        let tasks = loaded.files.iter().flat_map(|file| file.tasks());
        let bases = tasks.filter_map(Task::extends);
        let bases = bases.filter_map(|base| loaded.task(base.span().file, base.text()));
        loaded.extended = bases.map(|task| task.name().span()).collect();
        loaded
    }

    /// Finds the first task of this name that `file` sees.
    pub fn task(&self, file: FileId, name: &str) -> Option<Task<'a>> {
        self.declared(file, Kind::Task, name).and_then(Task::cast)
    }

    /// Finds the first list of experts of this name that `file` sees.
    pub fn experts(&self, file: FileId, name: &str) -> Option<Experts<'a>> {
        self.declared(file, Kind::Experts, name)
            .and_then(Experts::cast)
    }

    /// Finds the first material of this name that `file` sees.
    pub fn material(&self, file: FileId, name: &str) -> Option<Material<'a>> {
        self.declared(file, Kind::Material, name)
            .and_then(Material::cast)
    }

    fn declared(&self, file: FileId, kind: Kind, name: &str) -> Option<Node<'a>> {
        let mut seen = self.parsed(file).reach.iter();
        seen.find_map(|seen| self.declared.get(&(*seen, kind, name)).copied())
    }

    /// Returns whether another task extends this one.
    pub fn is_extended(&self, task: Task<'a>) -> bool {
        self.extended.contains(&task.name().span())
    }

    /// Returns whether any file uses a constant, a keypoint or a material of this name.
    pub fn is_used(&self, name: &str) -> bool {
        self.used.contains(name)
    }

    /// Returns the files whose declarations `file` sees, in the order in which they were read.
    pub fn visible_from(&self, file: FileId) -> impl Iterator<Item = File<'a>> {
        let seen = self.parsed(file).reach.iter();
        seen.map(|seen| self.files[seen.index()])
    }

    /// Returns the files whose names and types are checked.
    pub fn well_formed(&self) -> impl Iterator<Item = File<'a>> {
        let files = self.files.iter().copied();
        files.filter(|file| !self.is_malformed(file.span().file))
    }

    /// Returns the entry file.
    pub fn entry(&self) -> File<'a> {
        self.files[0]
    }

    /// Returns whether `file` sees a file with an error of form, itself or another, or lacks one. Its names and types are
    /// not checked.
    pub fn is_malformed(&self, file: FileId) -> bool {
        let mut seen = self.parsed(file).reach.iter();
        seen.any(|seen| self.parsed(*seen).is_malformed)
    }

    /// Returns the name and the text of every file; names are relative to the entry's folder.
    pub fn portable_texts(&self) -> impl Iterator<Item = (&'a str, &'a str)> {
        let sources = self.texts.sources.iter().zip(&self.texts.parsed);
        sources.map(|(source, parsed)| (parsed.portable_name.as_str(), source.text.as_str()))
    }

    /// Returns the path of a file, relative to the entry's folder.
    pub fn portable_name(&self, file: FileId) -> &'a str {
        &self.parsed(file).portable_name
    }

    /// Returns the name of a file, as the caller knows it.
    pub fn name(&self, file: FileId) -> &'a str {
        &self.texts.sources.get(file).name
    }

    /// Returns the text of a span.
    pub fn written(&self, span: Span) -> &'a str {
        self.texts.sources.text(span)
    }

    /// Returns the path of a file, relative to the entry's folder, and the line of a byte.
    pub fn place(&self, file: FileId, byte: usize) -> (String, u32) {
        let (line, _) = self.texts.sources.get(file).line_and_column(byte);
        (self.portable_name(file).to_owned(), line as u32)
    }

    fn parsed(&self, file: FileId) -> &'a Parsed {
        &self.texts.parsed[file.index()]
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
        read: BTreeMap::new(),
        open: Vec::new(),
    };
    let file = reading.add(entry.to_owned(), path::file_name(entry).to_owned(), text);
    reading.follow(file);
    let mut texts = reading.texts;
    close(&mut texts.parsed);
    Ok(texts)
}

/// Adds to each file the files that it sees through others.
fn close(parsed: &mut [Parsed]) {
    // Circular `use` is an error, but its files still see each other, so repeat until nothing changes.
    loop {
        let mut grown = false;
        for file in 0..parsed.len() {
            let seen = parsed[file].reach.iter();
            let further = seen.flat_map(|seen| parsed[seen.index()].reach.iter().copied());
            let further: BTreeSet<FileId> = further.collect();
            grown |= further.len() > parsed[file].reach.len();
            parsed[file].reach.extend(further);
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
    /// The files that were read, by their normalised names.
    read: BTreeMap<String, FileId>,
    /// The files between the entry and the one being read.
    open: Vec<FileId>,
}

impl Reading<'_> {
    fn add(&mut self, name: String, portable_name: String, text: String) -> FileId {
        let key = path::beside("", &name);
        let file = self.texts.sources.add(name, text);
        self.read.insert(key, file);
        let text = &self.texts.sources.get(file).text;
        let parsed = fab_grammar::parse(file, text);
        // A hidden character is reported by itself.
        let is_hidden_at = |at: usize| text[at..].starts_with(is_hidden);
        let faults = parsed.faults.iter().take(MAX_FINDINGS);
        for fault in
            faults.filter(|fault| !is_hidden_at(fault.span.start) && !is_hidden_at(fault.span.end))
        {
            self.report.error(syntax::diagnose(fault, text));
        }
        let further = parsed.faults.len().saturating_sub(MAX_FINDINGS);
        self.report.count_further(further, file);
        hidden_characters(text, file, self.report);
        let is_malformed = self.report.error_in(file).is_some();
        self.texts.parsed.push(Parsed {
            tree: parsed.tree,
            portable_name,
            reach: BTreeSet::from([file]),
            is_malformed,
        });
        file
    }

    /// Reads the files that a file uses; recursion is bounded by [`MAX_FILES`].
    fn follow(&mut self, file: FileId) {
        self.open.push(file);
        let uses = self.texts.parsed[file.index()].tree.view().uses();
        let paths = uses.map(|used| (used.path().span(), used.path().plain()));
        let paths: Vec<(Span, Option<String>)> = paths.collect();
        let mut first_uses: BTreeMap<Option<String>, Span> = BTreeMap::new();
        for (span, path) in paths {
            let first = *first_uses.entry(path.clone()).or_insert(span);
            if first != span {
                let diagnostic = Diagnostic::new(Code::Repeated, span, "this file is used twice");
                let diagnostic = diagnostic.also(first, "used here first");
                self.report.error(diagnostic.help("drop this line"));
                continue;
            }
            // A file that cannot be read is reported; the others are read all the same.
            match self.target(file, span, path) {
                Ok(target) => {
                    self.texts.parsed[file.index()].reach.insert(target);
                }
                Err(_) => self.texts.parsed[file.index()].is_malformed = true,
            }
        }
        self.open.pop();
    }

    /// Returns the file that a `use` names; reads it if it was not read before.
    fn target(
        &mut self,
        file: FileId,
        span: Span,
        path: Option<String>,
    ) -> Result<FileId, Reported> {
        let bad = |message: String| Diagnostic::new(Code::BadPath, span, message);
        let Some(written) = path else {
            let message = "the path of a `use` has a placeholder".to_owned();
            return self.refuse(bad(message).help("write the path itself"));
        };
        if let Some(fault) = path::fault(&written) {
            return self.refuse(bad(format!("the path `{written}` {fault}")));
        }
        let here = &self.texts.parsed[file.index()].portable_name;
        let Some(portable_name) = path::within_or_library(here, &written) else {
            let message = format!("the path `{written}` leads out of the folder of the first file");
            return self.refuse(bad(message).help(
                "move the file into the first file's folder or below, or into a folder `lib` next to that folder; or check a file higher up",
            ));
        };
        let name = path::beside(&self.texts.sources.get(file).name, &written);
        if let Some(target) = self.read.get(&name).copied() {
            if self.open.contains(&target) {
                let message = format!("`{written}` is used in a circle");
                let diagnostic = Diagnostic::new(Code::CircularUse, span, message);
                self.report
                    .error(diagnostic.label("leads back to this file"));
            }
            return Ok(target);
        }
        if self.read.len() >= MAX_FILES {
            let message =
                format!("`{written}` is not read: there may be at most {MAX_FILES} files");
            return self.refuse(Diagnostic::new(Code::TooManyFiles, span, message));
        }
        let text = match self.loader.load(&name) {
            Ok(text) => text,
            Err(error) => {
                let has_ending = written.ends_with(".fab");
                let help = if !has_ending && self.loader.load(&format!("{name}.fab")).is_ok() {
                    format!("did you mean `{written}.fab`?")
                } else {
                    format!(
                        "paths are relative to the file that contains them: this one is `{name}`"
                    )
                };
                let diagnostic = Diagnostic::new(Code::UnreadableUse, span, error.message);
                return self.refuse(diagnostic.help(help));
            }
        };
        let target = self.add(name, portable_name, text);
        self.follow(target);
        Ok(target)
    }

    fn refuse(&mut self, diagnostic: Diagnostic) -> Result<FileId, Reported> {
        Err(self.report.error(diagnostic))
    }
}

/// Reports the characters of a file that a reader does not see.
fn hidden_characters(text: &str, file: FileId, report: &mut Report) {
    let hidden = || text.char_indices().filter(|(_, it)| is_hidden(*it));
    for (at, character) in hidden().take(MAX_FINDINGS) {
        let shown = character.escape_unicode();
        let what = if turns_writing(character) {
            "turns the direction of writing"
        } else {
            "is not visible"
        };
        let message = format!("the character `{shown}` {what}");
        let span = Span::new(file, at..at + character.len_utf8());
        let diagnostic = Diagnostic::new(Code::ControlCharacter, span, message);
        report.error(diagnostic.help("remove it"));
    }
    report.count_further(hidden().count().saturating_sub(MAX_FINDINGS), file);
}

/// Returns the names of a file, except where one declares a constant, a keypoint or a material.
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
