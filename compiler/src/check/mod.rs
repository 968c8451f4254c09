//! Decides whether tasks are right, and builds the programs of those that are.
//!
//! In: every file as written. Out: programs of the entry file's runnable tasks, and diagnostics. Every task
//! of every file is checked, bases too; only [`check`] makes a [`Program`], so that one is right by
//! construction. One file per section; each gives its part of the program or nothing.

mod actions;
mod arguments;
mod camera;
mod cloth;
mod conditions;
mod constants;
mod demos;
mod examples;
mod extractors;
mod files;
mod folds;
mod goal;
mod keypoints;
mod layers;
mod masks;
mod measures;
mod model;
mod names;
mod picker;
mod pictures;
mod points;
mod quantity;
mod reads;
mod said;
mod shown;
mod stages;
mod subgoals;
mod task;
mod templates;
mod trials;
mod untouched;
mod uses;
mod values;
mod verification;

use crate::ast::{self, Ident};
use crate::diag::{Code, Diagnostic, Report, among, nearest};
use crate::load::Loaded;
use crate::merge;
use crate::source::Span;
use fab_program::{ActionField, Camera, Cloth, Layer, Program, Test};
use names::Names;
use std::collections::{BTreeMap, BTreeSet};
use templates::Variables;

/// What the checks of one task share.
pub(crate) struct Context<'a> {
    pub loaded: &'a Loaded,
    pub report: &'a mut Report,
    pub names: Names<'a>,
    pub constants: BTreeMap<&'a str, &'a ast::Keypoint>,
    /// Each known once its section is checked; later sections depend on it.
    pub cloth: Option<Cloth>,
    /// The grid that takes the place of every declared one, where there is one.
    pub grid: Option<[u32; 2]>,
    pub camera: Option<Camera>,
    pub actions: Vec<ActionField>,
    pub layers: Vec<Layer>,
    /// Every layer that is declared, rightly or not.
    pub declared_layers: BTreeSet<&'a str>,
    /// Layers that need the action before.
    pub last_layers: BTreeSet<String>,
    /// Layers that the texts of the stage under way name.
    pub named_layers: Vec<(String, Span)>,
    pub variables: Variables,
}

impl<'a> Context<'a> {
    /// Returns what is known outside of tasks: nothing.
    fn empty(loaded: &'a Loaded, report: &'a mut Report) -> Context<'a> {
        Context {
            loaded,
            report,
            names: Names::none(loaded),
            constants: BTreeMap::new(),
            cloth: None,
            grid: None,
            camera: None,
            actions: Vec::new(),
            layers: Vec::new(),
            declared_layers: BTreeSet::new(),
            last_layers: BTreeSet::new(),
            named_layers: Vec::new(),
            variables: Variables::default(),
        }
    }
}

impl Context<'_> {
    /// Returns what stands at a place, cut to a length that fits a message.
    pub fn written(&self, span: Span) -> String {
        const MOST: usize = 40;
        let text = self.loaded.sources.text(span);
        match text.char_indices().nth(MOST) {
            None => text.to_owned(),
            Some((end, _)) => format!("{}…", &text[..end]),
        }
    }

    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.report.push(diagnostic);
    }

    /// Reports a name that nothing of `kind` has, unless it may be declared where something did not fit.
    pub fn unknown<'c>(
        &mut self,
        kind: &str,
        name: &Ident,
        candidates: impl IntoIterator<Item = &'c str>,
    ) {
        if self.names.may_be_declared(&name.text) {
            return;
        }
        let candidates: Vec<&str> = candidates.into_iter().collect();
        let diagnostic = Diagnostic::new(
            Code::UnknownName,
            name.span,
            format!("there is no {kind} `{}`", name.text),
        );
        self.push(match nearest(&name.text, candidates.iter().copied()) {
            Some(meant) => diagnostic.meant(name.span, meant),
            None if candidates.is_empty() => diagnostic,
            None => diagnostic.help(format!("there is {}", among(candidates))),
        });
    }
}

/// What comes of checking.
#[derive(Default)]
pub(crate) struct Checked {
    /// The tasks and variants of the entry that can run.
    pub programs: Vec<Program>,
    /// Their tests.
    pub tests: Vec<Test>,
}

/// What all tasks of a compilation may inherit together, bytes: each is checked with all that it inherits.
pub const MAX_INHERITED_BYTES: usize = 64 << 20;

/// Checks every task of every file; returns the programs of the entry's.
///
/// - `grid`: particles along X and Y of the cloth that takes the place of each task's own, where one does.
pub(crate) fn check(loaded: &Loaded, grid: Option<[u32; 2]>, report: &mut Report) -> Checked {
    merge::unique(
        loaded
            .files
            .iter()
            .flat_map(|file| &file.tasks)
            .map(|task| &task.name),
        "task",
        report,
    );
    merge::unique(
        loaded
            .files
            .iter()
            .flat_map(|file| &file.experts)
            .map(|experts| &experts.name),
        "list of experts",
        report,
    );
    let mut context = Context::empty(loaded, report);
    for experts in loaded.files.iter().flat_map(|file| &file.experts) {
        folds::experts(experts, &mut context);
    }
    let faulty_files = report.files_with_errors();
    let stamps = task::stamps(loaded);
    let mut checked = Checked::default();
    let mut merged_bytes = 0;
    for file in &loaded.files {
        let is_entry = file.id == loaded.entry().id;
        let sees_faults = loaded
            .visible_from(file.id)
            .any(|seen| faulty_files.contains(&seen.id));
        for task in &file.tasks {
            // Each task has its own report: what it inherits must count against it, though it is shown once.
            let mut variants = vec![None];
            let mut number = 0;
            while number < variants.len() {
                let mut own = Report::default();
                let mut merged = merge::merge(task, variants[number].take(), loaded, &mut own);
                merged.sees_faults = sees_faults;
                merged_bytes += merged.bytes
                    + merged.experts.map_or(0, |experts| {
                        let name = &experts.name;
                        let list = loaded.experts(name.span.file, &name.text);
                        list.map_or(0, |list| loaded.size(&list.name))
                    });
                if merged_bytes > MAX_INHERITED_BYTES {
                    report.absorb(own);
                    report.push(too_large(&task.name));
                    return checked;
                }
                // Variants of tasks in other files are checked where those are compiled.
                if number == 0 && is_entry {
                    variants.extend(merged.applicable_variants().map(Some));
                }
                let built = task::check(&merged, &stamps, grid, loaded, &mut own);
                let is_right = own.errors() == 0 && !sees_faults;
                report.absorb(own);
                if is_right
                    && is_entry
                    && let Some((program, tests)) = built
                {
                    checked.programs.push(program);
                    checked.tests.extend(tests);
                }
                number += 1;
            }
        }
    }
    checked
}

fn too_large(name: &Ident) -> Diagnostic {
    let message = format!(
        "with `{}` the tasks come to more than {} MiB, counting what each inherits",
        name.text,
        MAX_INHERITED_BYTES >> 20
    );
    Diagnostic::new(Code::TasksTooLarge, name.span, message)
        .help("nothing further is checked; extend smaller tasks, or compile the files one by one")
}
