//! Joins a task with those that it extends, and with one of its variants.
//!
//! A section of the task replaces the extended task's whole section. Only five merge by name: a constant, a
//! keypoint or a stage of the same name takes the old one's place, others come after (new keypoints directly before the
//! replaced one that they stand above, so that it may use them); a component is
//! replaced with `override`, added without, and left out with `without`; single checks of an inherited
//! `verify` are replaced and left out likewise. A variant is joined like a task that extends the one it
//! stands in.

mod checks;
mod components;
mod lists;
mod variants;

pub(crate) use lists::{Indexed, once, unique};
pub(crate) use variants::{Change, VariantOf};

use crate::ast::{
    Actions, Body, Check, Component, Demos, ExprKind, Ident, Keypoint, Keypoints, Reference, Stage,
    Statement, Subgoals, Task, Verify,
};
use crate::diag::{Code, Diagnostic, Report, among, nearest};
use crate::load::Loaded;
use crate::source::{FileId, Span};
use std::collections::BTreeSet;

/// The most tasks below one.
pub const MAX_EXTENDS_DEPTH: usize = 16;

/// A task with everything that it inherits.
pub(crate) struct Merged<'a> {
    pub task: &'a Task,
    /// The variant that it is, where it is one.
    pub variant: Option<VariantOf<'a>>,
    pub constants: Indexed<'a, Keypoint>,
    pub cloth: Option<&'a Statement>,
    pub camera: Option<&'a Statement>,
    pub picker: Option<&'a Statement>,
    pub goal: Option<&'a Statement>,
    pub horizon: Option<&'a Statement>,
    pub subgoals: Option<&'a Subgoals>,
    pub experts: Option<&'a Reference>,
    pub demos: Option<&'a Demos>,
    pub keypoints: Indexed<'a, Keypoint>,
    pub annotate: Option<&'a Keypoints>,
    pub actions: Option<&'a Actions>,
    pub components: Indexed<'a, Component>,
    /// Components that were there and are left out.
    pub removed: BTreeSet<&'a str>,
    pub stages: Indexed<'a, Stage>,
    /// Where attempts and results are stated; what is checked, `checks` says.
    pub verify: Option<&'a Verify>,
    pub checks: Indexed<'a, Check>,
    /// Checks that `verify` declares and that are left out.
    pub removed_checks: BTreeSet<&'a str>,
    /// The variants that the task and those below it declare.
    pub variants: Vec<VariantOf<'a>>,
    /// The length of everything in it, bytes.
    pub bytes: usize,
    /// Whether something of it is missing because of an error that is already reported.
    pub has_faults: bool,
    /// Whether a file that it sees has an error of form, so that what follows from its parts says little.
    pub sees_faults: bool,
    /// Whether a task below it is missing, so that an unknown name may be declared there.
    pub is_broken: bool,
}

/// Finds the task of that name that `file` sees.
pub(crate) fn find_task<'a>(loaded: &'a Loaded, file: FileId, name: &str) -> Option<&'a Task> {
    loaded.task(file, name)
}

/// Joins `task` with those below it, and `variant` on top.
pub(crate) fn merge<'a>(
    task: &'a Task,
    variant: Option<VariantOf<'a>>,
    loaded: &'a Loaded,
    report: &mut Report,
) -> Merged<'a> {
    let (chain, is_broken) = chain(task, loaded, report);
    let mut merged = Merged {
        task,
        variant,
        constants: Indexed::default(),
        cloth: None,
        camera: None,
        picker: None,
        goal: None,
        horizon: None,
        subgoals: None,
        experts: None,
        demos: None,
        keypoints: Indexed::default(),
        annotate: None,
        actions: None,
        components: Indexed::default(),
        removed: BTreeSet::new(),
        stages: Indexed::default(),
        verify: None,
        checks: Indexed::default(),
        removed_checks: BTreeSet::new(),
        variants: Vec::new(),
        bytes: 0,
        has_faults: false,
        sees_faults: false,
        is_broken,
    };
    for task in chain.into_iter().rev() {
        merged.add(&task.body, report);
        merged.add_variants(task, report);
    }
    match merged.variant.as_ref().map(|variant| variant.change) {
        Some(Change::Body(body)) => merged.add(body, report),
        Some(Change::Without(name)) => merged.leave_out(name, report),
        None => {}
    }
    merged
}

/// Returns the task and those below it, and whether one of them is missing.
fn chain<'a>(task: &'a Task, loaded: &'a Loaded, report: &mut Report) -> (Vec<&'a Task>, bool) {
    let mut chain = vec![task];
    let mut above = task;
    while let Some(base) = &above.extends {
        let Some(found) = find_task(loaded, base.span.file, &base.text) else {
            report.push(unknown_task(base, loaded));
            return (chain, true);
        };
        if chain.iter().any(|known| known.name.span == found.name.span) {
            let message = format!("`{}` extends itself", base.text);
            let through = if chain.len() > 1 {
                "leads back here"
            } else {
                "this is the task itself"
            };
            report.push(Diagnostic::new(Code::CircularExtends, base.span, message).label(through));
            return (chain, true);
        }
        if chain.len() > MAX_EXTENDS_DEPTH {
            let message = format!("more than {MAX_EXTENDS_DEPTH} tasks extend each other");
            report.push(Diagnostic::new(Code::ExtendsTooDeep, base.span, message));
            return (chain, true);
        }
        chain.push(found);
        above = found;
    }
    (chain, false)
}

fn unknown_task(base: &Ident, loaded: &Loaded) -> Diagnostic {
    let diagnostic = Diagnostic::new(
        Code::UnknownName,
        base.span,
        format!("there is no task `{}`", base.text),
    );
    let seen = || {
        loaded
            .visible_from(base.span.file)
            .flat_map(|file| &file.tasks)
            .map(|task| task.name.text.as_str())
    };
    let unseen = loaded
        .files
        .iter()
        .find(|file| loaded.task(file.id, &base.text).is_some());
    match (nearest(&base.text, seen()), unseen) {
        (_, Some(file)) => diagnostic.help(format!(
            "it is declared in `{}`; add a `use` of that file",
            loaded.sources.get(file.id).name
        )),
        (Some(meant), _) => diagnostic.meant(base.span, meant),
        _ => diagnostic.help(format!("this file sees {}", among(seen()))),
    }
}

impl<'a> Merged<'a> {
    fn add(&mut self, body: &'a Body, report: &mut Report) {
        let statement = |statement: &Statement| statement.span;
        self.cloth = once(&body.cloth, "`cloth`", statement, report).or(self.cloth);
        self.camera = once(&body.camera, "`camera`", statement, report).or(self.camera);
        self.picker = once(&body.picker, "`picker`", statement, report).or(self.picker);
        self.goal = once(&body.goal, "`goal`", statement, report).or(self.goal);
        self.horizon = once(&body.horizon, "`horizon`", statement, report).or(self.horizon);
        self.subgoals =
            once(&body.subgoals, "`subgoals`", |part| part.span, report).or(self.subgoals);
        self.experts = once(&body.experts, "`experts`", |part| part.span, report).or(self.experts);
        self.demos = once(&body.demos, "`demos`", |part| part.span, report).or(self.demos);
        self.annotate =
            once(&body.annotate, "`annotate`", |part| part.span, report).or(self.annotate);
        self.actions = once(&body.actions, "`actions`", |part| part.span, report).or(self.actions);
        let keypoints = once(&body.keypoints, "`keypoints`", |part| part.span, report)
            .map_or(&[][..], |part| &part.list);
        let names = |list: &'a [Keypoint]| list.iter().map(|part| &part.name);
        unique(names(&body.constants), "constant", report);
        unique(names(keypoints), "keypoint", report);
        unique(body.stages.iter().map(|stage| &stage.name), "stage", report);
        for constant in &body.constants {
            self.constants.put(&constant.name.text, constant);
        }
        self.keypoints
            .put_block(keypoints, |keypoint| &keypoint.name.text);
        for stage in &body.stages {
            self.stages.put(&stage.name.text, stage);
        }
        self.add_components(body, report);
        self.add_checks(body, report);
        self.has_faults |= body.has_faults;
        self.bytes += body.bytes;
    }

    /// Returns the variants that make a difference: what is not there cannot be ablated.
    pub fn applicable_variants(&self) -> impl Iterator<Item = VariantOf<'a>> {
        self.variants
            .iter()
            .filter(|variant| match variant.change {
                Change::Body(_) => true,
                Change::Without(name) => !self.removed.contains(name.text.as_str()),
            })
            .cloned()
    }

    /// Returns whether one of the task's own components is declared at a place.
    pub fn is_own_component(&self, span: Span) -> bool {
        let own = &self.task.body.components;
        // They are in source order.
        own.binary_search_by_key(&span, |component| component.name.span)
            .is_ok()
    }

    /// Returns whether a rollout needs subgoals: where a stage shows one, or results are compared with them.
    pub fn needs_subgoals(&self) -> bool {
        let compares = self.verify.is_some_and(|verify| !verify.results.is_empty());
        compares || self.stages.iter().flat_map(|stage| &stage.show).any(|show| {
            show.list.iter().any(|(picture, _)| !matches!(&picture.kind, ExprKind::Name(name) if name == "scene"))
        })
    }
}
