//! Reads the entry file and everything that it uses.
//!
//! In: a name and a loader. Out: every file as it is written, who reaches whom, and diagnostics of form
//! and of `use`. Bounded by [`MAX_FILES`], [`MAX_USE_DEPTH`] and [`MAX_TOTAL_BYTES`]; no path leads out of the
//! entry's folder, but into a folder `lib` that lies beside it.

use crate::ast::{self, Text};
use crate::diag::{Code, Diagnostic, MAX_FINDINGS, Report};
use crate::form;
use crate::path;
use crate::source::{FileId, Sources, Span};
use crate::{LoadError, Loader};
use std::collections::{BTreeMap, BTreeSet};

/// The most files in one compilation.
pub const MAX_FILES: usize = 64;

/// The most `use`s between the entry and a file.
pub const MAX_USE_DEPTH: usize = 16;

/// The most text in one compilation, bytes.
pub const MAX_TOTAL_BYTES: usize = 4 << 20;

/// Every file of a compilation, in the order in which they were first read.
pub(crate) struct Loaded {
    pub sources: Sources,
    pub files: Vec<ast::File>,
    /// For each file, its path as seen from the entry's folder: the same wherever the folder lies.
    pub portable_names: Vec<String>,
    /// For each file, itself and those that it uses, directly or through others.
    reach: Vec<BTreeSet<FileId>>,
    /// For each file, where the first task of each name stands in it; names are looked up once per task.
    task_index: Vec<BTreeMap<String, usize>>,
    /// Likewise for lists of experts.
    experts_index: Vec<BTreeMap<String, usize>>,
    /// For each task and list of experts, by its name's place, the bytes from there to the next one.
    sizes: BTreeMap<Span, usize>,
    /// The names' places of the tasks that others extend.
    extended: BTreeSet<Span>,
}

impl Loaded {
    /// Finds the first task of that name that `file` sees.
    pub fn task(&self, file: FileId, name: &str) -> Option<&ast::Task> {
        self.reach[file.0].iter().find_map(|seen| {
            let at = self.task_index[seen.0].get(name)?;
            Some(&self.files[seen.0].tasks[*at])
        })
    }

    /// Finds the first list of experts of that name that `file` sees.
    pub fn experts(&self, file: FileId, name: &str) -> Option<&ast::Experts> {
        self.reach[file.0].iter().find_map(|seen| {
            let at = self.experts_index[seen.0].get(name)?;
            Some(&self.files[seen.0].experts[*at])
        })
    }

    /// Returns about how many bytes of text the item of that name has.
    pub fn size(&self, name: &ast::Ident) -> usize {
        self.sizes.get(&name.span).copied().unwrap_or(0)
    }

    /// Returns whether another task extends this one.
    pub fn is_extended(&self, task: &ast::Task) -> bool {
        self.extended.contains(&task.name.span)
    }

    /// Returns the files whose declarations `file` sees, in the order in which they were read.
    pub fn visible_from(&self, file: FileId) -> impl Iterator<Item = &ast::File> {
        self.reach[file.0].iter().map(|seen| &self.files[seen.0])
    }

    /// Returns the entry file.
    pub fn entry(&self) -> &ast::File {
        &self.files[0]
    }
}

/// Reads `entry` and what it uses; fails only where the entry cannot be loaded.
pub(crate) fn load(
    entry: &str,
    loader: &dyn Loader,
    report: &mut Report,
) -> Result<Loaded, LoadError> {
    let text = loader.load(entry)?;
    let loaded = Loaded {
        sources: Sources::default(),
        files: Vec::new(),
        portable_names: Vec::new(),
        reach: Vec::new(),
        task_index: Vec::new(),
        experts_index: Vec::new(),
        sizes: BTreeMap::new(),
        extended: BTreeSet::new(),
    };
    let mut reading = Reading {
        loader,
        report,
        loaded,
        keys: Vec::new(),
        unreadable: BTreeMap::new(),
        total_bytes: 0,
        open: Vec::new(),
    };
    let file = reading.add(entry.to_owned(), path::file_name(entry).to_owned(), text);
    reading.follow(file);
    let mut loaded = reading.loaded;
    close(&mut loaded.reach);
    loaded.extended = loaded
        .files
        .iter()
        .flat_map(|file| &file.tasks)
        .filter_map(|task| task.extends.as_ref())
        .filter_map(|base| loaded.task(base.span.file, &base.text))
        .map(|task| task.name.span)
        .collect();
    Ok(loaded)
}

/// Adds to each file's reach what the files in it reach.
fn close(reach: &mut [BTreeSet<FileId>]) {
    // A circle of files is an error, but its members still see each other: repeat until nothing is new.
    loop {
        let mut grown = false;
        for file in 0..reach.len() {
            let further: BTreeSet<FileId> = reach[file]
                .iter()
                .flat_map(|seen| reach[seen.0].iter().copied())
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
    loaded: Loaded,
    /// Each file's normalised name, by which it is known again.
    keys: Vec<String>,
    /// Files that could not be read, and why; none is asked for twice.
    unreadable: BTreeMap<String, LoadError>,
    total_bytes: usize,
    /// The files between the entry and the one being read.
    open: Vec<FileId>,
}

impl Reading<'_> {
    fn add(&mut self, name: String, portable_name: String, text: String) -> FileId {
        let parsed = fab_grammar::parse(&text);
        self.total_bytes += text.len();
        self.keys.push(path::beside("", &name));
        let file = self.loaded.sources.add(name, text);
        let told = parsed.faults.len().min(MAX_FINDINGS);
        self.report.pass_over(parsed.faults.len() - told, file);
        for fault in &parsed.faults[..told] {
            self.report.push(form::diagnose(
                fault,
                file,
                &self.loaded.sources.get(file).text,
            ));
        }
        let lowered = ast::lower(file, &parsed.tree);
        let tasks = || lowered.tasks.iter().map(|task| &task.name);
        let experts = || lowered.experts.iter().map(|experts| &experts.name);
        self.loaded.task_index.push(first_of_each_name(tasks()));
        self.loaded
            .experts_index
            .push(first_of_each_name(experts()));
        let end = self.loaded.sources.get(file).text.len();
        self.loaded
            .sizes
            .extend(sizes(tasks().chain(experts()), end));
        self.loaded.files.push(lowered);
        self.loaded.portable_names.push(portable_name);
        self.loaded.reach.push(BTreeSet::from([file]));
        file
    }

    /// Reads what a file uses; recursion is bounded by [`MAX_USE_DEPTH`].
    fn follow(&mut self, file: FileId) {
        self.open.push(file);
        for used in self.loaded.files[file.0].uses.clone() {
            if let Some(target) = self.reach(file, &used) {
                self.loaded.reach[file.0].insert(target);
            }
        }
        self.open.pop();
    }

    fn reach(&mut self, file: FileId, used: &Text) -> Option<FileId> {
        let Some(written) = used.plain() else {
            let message = "the path of a `use` has a placeholder";
            self.report.push(
                Diagnostic::new(Code::BadPath, used.span, message).help("write the path itself"),
            );
            return None;
        };
        if let Some(fault) = path::fault(&written) {
            self.report.push(Diagnostic::new(
                Code::BadPath,
                used.span,
                format!("the path `{written}` {fault}"),
            ));
            return None;
        }
        let here = &self.loaded.portable_names[file.0];
        let Some(portable_name) = path::within_or_library(here, &written) else {
            let message = format!("the path `{written}` leads out of the folder of the first file");
            self.report
                .push(Diagnostic::new(Code::BadPath, used.span, message).help(
                    "move the file beside the first one or below, or into a folder `lib` beside the first one's; or check a file higher up",
                ));
            return None;
        };
        let name = path::beside(&self.loaded.sources.get(file).name, &written);
        if let Some(known) = self.keys.iter().position(|key| *key == name).map(FileId) {
            if self.open.contains(&known) {
                let message = format!("`{written}` is used in a circle");
                let label = if known == file {
                    "this is the file itself"
                } else {
                    "leads back to this file"
                };
                self.report
                    .push(Diagnostic::new(Code::CircularUse, used.span, message).label(label));
            }
            return Some(known);
        }
        let is_known_bad = self.unreadable.contains_key(&name);
        let n_asked = self.keys.len() + self.unreadable.len();
        if !is_known_bad && (n_asked >= MAX_FILES || self.open.len() > MAX_USE_DEPTH) {
            let message = format!(
                "`{written}` is not read: at most {MAX_FILES} files are, each at most {MAX_USE_DEPTH} `use`s deep"
            );
            self.report
                .push(Diagnostic::new(Code::TooManyFiles, used.span, message));
            return None;
        }
        match self.read(&name) {
            Ok(text) if self.total_bytes + text.len() > MAX_TOTAL_BYTES => {
                let message = format!(
                    "`{written}` is left out: with it the files have more than {MAX_TOTAL_BYTES} bytes"
                );
                self.report
                    .push(Diagnostic::new(Code::TooManyFiles, used.span, message));
                None
            }
            Ok(text) => {
                let target = self.add(name, portable_name, text);
                self.follow(target);
                Some(target)
            }
            Err(error) => {
                self.report.push(
                    Diagnostic::new(Code::UnreadableUse, used.span, error.message).help(format!(
                        "paths are relative to the file that they stand in: this one is `{name}`"
                    )),
                );
                None
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

fn first_of_each_name<'a>(names: impl Iterator<Item = &'a ast::Ident>) -> BTreeMap<String, usize> {
    let mut index = BTreeMap::new();
    for (at, name) in names.enumerate() {
        index.entry(name.text.clone()).or_insert(at);
    }
    index
}

/// Returns the bytes from each name to the next, or to the end.
fn sizes<'a>(
    names: impl Iterator<Item = &'a ast::Ident>,
    end: usize,
) -> impl Iterator<Item = (Span, usize)> {
    let mut spans: Vec<Span> = names.map(|name| name.span).collect();
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
