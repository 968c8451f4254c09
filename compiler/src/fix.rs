//! Applies the edits that are certain, and demotes those that turn out not to be.
//!
//! In: the name of a file, a loader, and which files may change. Out: the new texts, and the findings that remain.
//! Nothing is written.
//!
//! A certain edit passes two tests. `diag/spelling.rs` looks at the edit alone, and runs in every compilation: the edit
//! may change how something is written, but no number, name or text. [`fix`] looks at the effect: it compiles the
//! edited text, which must lack the finding and have no new one. An edit that fails either test becomes likely.

use crate::diag::{Code, Diagnostic, Edit, Severity};
use crate::{Compiled, Listed, LoadError, Loader, Wanted, compile};
use fab_grammar::Span;
use std::cell::Cell;
use std::collections::BTreeMap;

/// The most rounds. One finding may hide another of the same line, so few files need more than three.
const MAX_ROUNDS: usize = 8;

/// The most text that one round compiles, bytes: a task of 8 kB is compiled 256 times. Edits that are not tried by
/// then are not made.
const MAX_ROUND_BYTES: usize = 2 << 20;

/// The most findings that an edit may uncover, one after another, if each has a certain edit of its own.
const MAX_CHAIN: usize = 8;

/// The result of [`fix`].
#[derive(Clone, Debug)]
pub struct Fixed {
    /// Each file that changes, by its name.
    pub files: BTreeMap<String, FixedFile>,
    /// The compilation of the new texts. Of its edits, those that are still certain belong to files that may not
    /// change.
    pub compiled: Compiled,
}

/// The new text of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FixedFile {
    /// The whole text.
    pub text: String,
    /// The number of findings that were repaired.
    pub n_repaired: usize,
}

/// Applies every certain edit to the files that may change.
///
/// Fails only if the entry itself cannot be loaded. Fixing the new texts again changes nothing.
///
/// - `may_change`: told the name of a file, as the loader is.
pub fn fix(
    entry: &str,
    loader: &dyn Loader,
    may_change: &dyn Fn(&str) -> bool,
) -> Result<Fixed, LoadError> {
    let mut files: BTreeMap<String, FixedFile> = BTreeMap::new();
    let mut compiled = compile(entry, loader)?;
    for _ in 0..MAX_ROUNDS {
        let texts = texts(&files);
        let round = Round::of(entry, loader, &texts, &compiled);
        let accepted = round.accepted(round.certain(may_change));
        let Some(trial) = accepted.trial else {
            break;
        };
        for (name, (text, n_repaired)) in trial.files {
            let file = files.entry(name).or_insert(FixedFile {
                text: String::new(),
                n_repaired: 0,
            });
            file.text = text;
            file.n_repaired += n_repaired;
        }
        compiled = trial.compiled;
    }
    demote_failing(entry, loader, &texts(&files), &mut compiled);
    Ok(Fixed { files, compiled })
}

/// Demotes the edits of a compilation that repair nothing, or make something else wrong.
///
/// Compiling does not: it would have to compile once more for each edit.
pub fn demote(entry: &str, loader: &dyn Loader, compiled: &mut Compiled) {
    demote_failing(entry, loader, &BTreeMap::new(), compiled);
}

fn demote_failing(entry: &str, loader: &dyn Loader, texts: &Texts, compiled: &mut Compiled) {
    let round = Round::of(entry, loader, texts, compiled);
    let accepted = round.accepted(round.certain(&|_| true)).indices;
    for (index, diagnostic) in compiled.diagnostics.iter_mut().enumerate() {
        if diagnostic.is_certain() && !accepted.contains(&index) {
            diagnostic.make_likely();
        }
    }
}

/// Texts that replace those of a loader, by name.
type Texts = BTreeMap<String, String>;

fn texts(files: &BTreeMap<String, FixedFile>) -> Texts {
    let text = |(name, file): (&String, &FixedFile)| (name.clone(), file.text.clone());
    files.iter().map(text).collect()
}

struct Overlay<'a> {
    texts: &'a Texts,
    loader: &'a dyn Loader,
}

impl Loader for Overlay<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        match self.texts.get(name) {
            Some(text) => Ok(text.clone()),
            None => self.loader.load(name),
        }
    }

    fn look(&self, path: &str, wanted: Wanted) -> Listed {
        self.loader.look(path, wanted)
    }

    fn trial(&self, title: &str) -> Option<fab_program::Trial> {
        self.loader.trial(title)
    }

    fn refuses_cloth(&self, material: &fab_program::Material, spacing_m: f64) -> Option<String> {
        self.loader.refuses_cloth(material, spacing_m)
    }
}

/// Tries of the edits of one compilation.
struct Round<'a> {
    entry: &'a str,
    loader: &'a dyn Loader,
    texts: &'a Texts,
    compiled: &'a Compiled,
    /// How often it may still compile.
    n_left: Cell<usize>,
}

/// Edited texts, compiled.
struct Trial {
    /// Each edited file: its text and how many findings were repaired in it.
    files: BTreeMap<String, (String, usize)>,
    compiled: Compiled,
}

/// The edits that passed, together.
#[derive(Default)]
struct Accepted {
    /// Indices of diagnostics.
    indices: Vec<usize>,
    /// The trial of all of them; `None` if there are none.
    trial: Option<Trial>,
}

impl<'a> Round<'a> {
    fn of(
        entry: &'a str,
        loader: &'a dyn Loader,
        texts: &'a Texts,
        compiled: &'a Compiled,
    ) -> Round<'a> {
        let n_bytes: usize = compiled.sources.iter().map(|it| it.text.len()).sum();
        Round {
            entry,
            loader,
            texts,
            compiled,
            n_left: Cell::new((MAX_ROUND_BYTES / n_bytes.max(1)).max(1)),
        }
    }

    /// Returns the diagnostics whose edits may be tried; none if findings are left out, since one of those could be
    /// taken for a new one.
    fn certain(&self, may_change: &dyn Fn(&str) -> bool) -> Vec<usize> {
        if self.compiled.left_out > 0 {
            return Vec::new();
        }
        let sources = &self.compiled.sources;
        let may = |edit: &Edit| may_change(&sources.get(edit.span.file).name);
        let diagnostics = self.compiled.diagnostics.iter().enumerate();
        diagnostics
            .filter(|(_, it)| it.is_certain() && it.edits.iter().all(may))
            .map(|(index, _)| index)
            .collect()
    }

    /// Returns the edits that pass: all together if they can, otherwise found by halving.
    fn accepted(&self, candidates: Vec<usize>) -> Accepted {
        let mut accepted = Accepted::default();
        let mut untried = vec![candidates];
        while let Some(group) = untried.pop() {
            if group.is_empty() || self.n_left.get() == 0 {
                continue;
            }
            let together = [accepted.indices.as_slice(), &group].concat();
            if let Some(trial) = self.attempt(&together) {
                accepted = Accepted {
                    indices: together,
                    trial: Some(trial),
                };
            } else if let (first, second @ [_, ..]) = group.split_at(group.len().div_ceil(2)) {
                untried.push(second.to_vec());
                untried.push(first.to_vec());
            }
        }
        accepted
    }

    /// Applies edits and compiles; `None` if a finding stays or is added.
    ///
    /// One finding of a line hides the others. What an edit uncovers is repaired too if it has a certain edit.
    fn attempt(&self, indices: &[usize]) -> Option<Trial> {
        let mut trial = self.applied(self.compiled, indices, BTreeMap::new())?;
        let mut allowed = counts(&self.compiled.diagnostics);
        for index in indices {
            let diagnostic = &self.compiled.diagnostics[*index];
            if let Some(count) = allowed.get_mut(&key(diagnostic)) {
                *count -= 1;
            }
        }
        for _ in 0..MAX_CHAIN {
            let added = added(&trial.compiled, &allowed, self.compiled.has_errors());
            if added.is_empty() {
                return (trial.compiled.left_out == 0).then_some(trial);
            }
            let may_follow = |index: &usize| {
                let diagnostic = &trial.compiled.diagnostics[*index];
                let sources = &trial.compiled.sources;
                diagnostic.is_certain()
                    && diagnostic
                        .edits
                        .iter()
                        .all(|edit| trial.files.contains_key(&sources.get(edit.span.file).name))
            };
            if !added.iter().all(may_follow) {
                return None;
            }
            let files = std::mem::take(&mut trial.files);
            trial = self.applied(&trial.compiled, &added, files)?;
        }
        None
    }

    /// Applies the edits of some diagnostics; `None` if two of them touch, or the entry cannot be loaded.
    ///
    /// - `files`: what was edited before.
    fn applied(
        &self,
        compiled: &Compiled,
        indices: &[usize],
        mut files: BTreeMap<String, (String, usize)>,
    ) -> Option<Trial> {
        let sources = &compiled.sources;
        let mut edits: Vec<&Edit> = Vec::new();
        for index in indices {
            let own = &compiled.diagnostics[*index].edits;
            edits.extend(own);
            let name = &sources.get(own.first()?.span.file).name;
            let file = files
                .entry(name.clone())
                .or_insert_with(|| (String::new(), 0));
            file.1 += 1;
        }
        edits.sort_by_key(|edit| edit.span);
        if edits
            .windows(2)
            .any(|pair| meet(pair[0].span, pair[1].span))
        {
            return None;
        }
        let mut texts = self.texts.clone();
        for (name, (text, _)) in &files {
            texts.insert(name.clone(), text.clone());
        }
        for source in sources.iter() {
            if let Some((text, _)) = files.get_mut(&source.name) {
                text.clone_from(&source.text);
            }
        }
        // From the end, so earlier positions stay valid.
        for edit in edits.iter().rev() {
            let (text, _) = files.get_mut(&sources.get(edit.span.file).name)?;
            text.replace_range(edit.span.range(), &edit.replacement);
        }
        for (name, (text, _)) in &files {
            texts.insert(name.clone(), text.clone());
        }
        let overlay = Overlay {
            texts: &texts,
            loader: self.loader,
        };
        self.n_left.set(self.n_left.get().checked_sub(1)?);
        let compiled = compile(self.entry, &overlay).ok()?;
        Some(Trial { files, compiled })
    }
}

/// What makes two findings the same although an edit moved them.
type Key<'d> = (Code, &'d str);

fn key(diagnostic: &Diagnostic) -> Key<'_> {
    (diagnostic.code, &diagnostic.message)
}

fn counts(diagnostics: &[Diagnostic]) -> BTreeMap<Key<'_>, usize> {
    let mut counts = BTreeMap::new();
    for diagnostic in diagnostics {
        *counts.entry(key(diagnostic)).or_default() += 1;
    }
    counts
}

/// Returns the indices of the findings beyond the allowed counts; of equal ones, the last.
///
/// - `errors_only`: whether warnings count. They do not where errors kept them from being looked for before.
fn added<'d>(
    compiled: &'d Compiled,
    allowed: &BTreeMap<Key<'d>, usize>,
    errors_only: bool,
) -> Vec<usize> {
    let mut left = allowed.clone();
    let mut added = Vec::new();
    for (index, diagnostic) in compiled.diagnostics.iter().enumerate() {
        match left.get_mut(&key(diagnostic)) {
            Some(count) if *count > 0 => *count -= 1,
            _ if errors_only && diagnostic.severity != Severity::Error => {}
            _ => added.push(index),
        }
    }
    added
}

/// Returns whether two changes overlap or touch.
fn meet(a: Span, b: Span) -> bool {
    a.file == b.file && a.start <= b.end && b.start <= a.end
}
