//! Joins a task with those that it extends.
//!
//! A section of the task replaces the extended task's whole section. Only three merge by name: a keypoint
//! or a stage of the same name takes the old one's place, others come after; a component is replaced
//! with `override`, added without, and left out with `without`.

use crate::ast::{
    Actions, Component, Declares, Ident, Keypoint, Reference, Stage, Statement, Subgoals, Task,
    Verify,
};
use crate::diag::{Code, Diagnostic, Report, among, nearest};
use crate::load::Loaded;
use crate::source::{FileId, Span};
use std::collections::{BTreeMap, BTreeSet};

/// The most tasks below one.
pub const MAX_EXTENDS_DEPTH: usize = 16;

/// The most keypoints, and the most components, of one task with what it inherits.
pub const MAX_PARTS: usize = 500;

/// What merges by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Keypoint,
    Stage,
    Component,
}

/// A task with everything that it inherits.
pub(crate) struct Merged<'a> {
    pub task: &'a Task,
    pub cloth: Option<&'a Statement>,
    pub camera: Option<&'a Statement>,
    pub goal: Option<&'a Statement>,
    pub horizon: Option<&'a Statement>,
    pub subgoals: Option<&'a Subgoals>,
    pub experts: Option<&'a Reference>,
    pub keypoints: Vec<&'a Keypoint>,
    pub actions: Option<&'a Actions>,
    pub components: Vec<&'a Component>,
    /// Components that were there and are left out.
    pub removed: BTreeSet<&'a str>,
    /// Where each keypoint, stage and component stands in its list.
    places: BTreeMap<(Part, &'a str), usize>,
    pub stages: Vec<&'a Stage>,
    pub verify: Option<&'a Verify>,
    /// Whether something of it is missing because of an error that is already reported.
    pub has_faults: bool,
    /// Whether a task below it is missing, so that an unknown name may be declared there.
    pub is_broken: bool,
}

/// Finds the task of that name that `file` sees.
pub(crate) fn find_task<'a>(loaded: &'a Loaded, file: FileId, name: &str) -> Option<&'a Task> {
    loaded.task(file, name)
}

/// Returns about how many bytes of text `task` has with what it inherits; that much has to be checked.
pub(crate) fn size(task: &Task, loaded: &Loaded) -> usize {
    let mut bytes = 0;
    let mut above = task;
    for _ in 0..=MAX_EXTENDS_DEPTH {
        bytes += loaded.size(&above.name);
        let experts = above.experts.first().map(|part| &part.name);
        bytes += experts
            .and_then(|name| loaded.experts(name.span.file, &name.text))
            .map_or(0, |experts| loaded.size(&experts.name));
        let base = above.extends.as_ref();
        match base.and_then(|base| loaded.task(base.span.file, &base.text)) {
            Some(below) => above = below,
            None => break,
        }
    }
    bytes
}

/// Joins `task` with those below it.
pub(crate) fn merge<'a>(task: &'a Task, loaded: &'a Loaded, report: &mut Report) -> Merged<'a> {
    let (chain, is_broken) = chain(task, loaded, report);
    let mut merged = Merged {
        task,
        cloth: None,
        camera: None,
        goal: None,
        horizon: None,
        subgoals: None,
        experts: None,
        keypoints: Vec::new(),
        actions: None,
        components: Vec::new(),
        removed: BTreeSet::new(),
        places: BTreeMap::new(),
        stages: Vec::new(),
        verify: None,
        has_faults: false,
        is_broken,
    };
    for task in chain.into_iter().rev() {
        merged.add(task, report);
    }
    merged.limit(report);
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
        (Some(meant), _) => diagnostic
            .help(format!("did you mean `{meant}`?"))
            .edit(base.span, meant),
        _ => diagnostic.help(format!("this file sees {}", among(seen()))),
    }
}

/// Returns the one statement there should be, and reports further ones.
pub(crate) fn once<'a, T>(
    list: &'a [T],
    what: &str,
    span: impl Fn(&T) -> Span,
    report: &mut Report,
) -> Option<&'a T> {
    let first = list.first()?;
    for again in &list[1..] {
        report.push(
            Diagnostic::new(
                Code::Repeated,
                span(again),
                format!("{what} is stated twice"),
            )
            .also(span(first), "stated here first"),
        );
    }
    Some(first)
}

impl<'a> Merged<'a> {
    fn add(&mut self, task: &'a Task, report: &mut Report) {
        let statement = |statement: &Statement| statement.span;
        self.cloth = once(&task.cloth, "`cloth`", statement, report).or(self.cloth);
        self.camera = once(&task.camera, "`camera`", statement, report).or(self.camera);
        self.goal = once(&task.goal, "`goal`", statement, report).or(self.goal);
        self.horizon = once(&task.horizon, "`horizon`", statement, report).or(self.horizon);
        self.subgoals =
            once(&task.subgoals, "`subgoals`", |part| part.span, report).or(self.subgoals);
        self.experts = once(&task.experts, "`experts`", |part| part.span, report).or(self.experts);
        self.actions = once(&task.actions, "`actions`", |part| part.span, report).or(self.actions);
        self.verify = once(&task.verify, "`verify`", |part| part.span, report).or(self.verify);
        let keypoints: Vec<&Keypoint> =
            once(&task.keypoints, "`keypoints`", |part| part.span, report)
                .map_or(Vec::new(), |part| part.list.iter().collect());
        unique(
            keypoints.iter().map(|keypoint| &keypoint.name),
            "keypoint",
            report,
        );
        unique(task.stages.iter().map(|stage| &stage.name), "stage", report);
        unique(
            task.components.iter().map(|component| &component.name),
            "component",
            report,
        );
        for keypoint in keypoints {
            let key = (Part::Keypoint, keypoint.name.text.as_str());
            put(&mut self.keypoints, &mut self.places, key, keypoint);
        }
        for stage in &task.stages {
            let key = (Part::Stage, stage.name.text.as_str());
            put(&mut self.stages, &mut self.places, key, stage);
        }
        self.add_components(task, report);
        self.has_faults |= task.has_faults;
    }

    /// Finds a component by its name.
    pub fn component(&self, name: &str) -> Option<&'a Component> {
        let place = self.places.get(&(Part::Component, name))?;
        self.components.get(*place).copied()
    }

    /// Drops the components that are left out.
    fn leave_out(&mut self) {
        let Merged {
            components,
            removed,
            places,
            ..
        } = self;
        components.retain(|component| !removed.contains(component.name.text.as_str()));
        places.retain(|(part, _), _| *part != Part::Component);
        for (place, component) in components.iter().enumerate() {
            places.insert((Part::Component, &component.name.text), place);
        }
    }

    /// Reports more parts than are accepted, and drops those beyond.
    fn limit(&mut self, report: &mut Report) {
        let keypoints = self.keypoints.get(MAX_PARTS).map(|part| &part.name);
        let components = self.components.get(MAX_PARTS).map(|part| &part.name);
        for (kind, beyond, count) in [
            ("keypoints", keypoints, self.keypoints.len()),
            ("components", components, self.components.len()),
        ] {
            if let Some(beyond) = beyond {
                let message = format!("there are {count} {kind}, at most {MAX_PARTS} are accepted");
                report.push(Diagnostic::new(Code::OutOfRange, beyond.span, message));
                // What is dropped must not be reported as unknown.
                self.is_broken = true;
            }
        }
        self.keypoints.truncate(MAX_PARTS);
        self.components.truncate(MAX_PARTS);
    }

    fn add_components(&mut self, task: &'a Task, report: &mut Report) {
        let inherited: BTreeSet<&str> = self
            .components
            .iter()
            .map(|component| component.name.text.as_str())
            .collect();
        for name in &task.without {
            if inherited.contains(name.text.as_str()) {
                self.removed.insert(&name.text);
            } else if !self.is_broken {
                report.push(absent(Code::NothingToRemove, "leave out", name, &inherited));
            }
        }
        if !task.without.is_empty() {
            self.leave_out();
        }
        for component in &task.components {
            let name = &component.name;
            let is_inherited = inherited.contains(name.text.as_str())
                && !self.removed.contains(name.text.as_str());
            match component.declares {
                Declares::New if is_inherited => {
                    let before = self.component(&name.text);
                    let message =
                        format!("`{}` replaces a component of an extended task", name.text);
                    let mut diagnostic =
                        Diagnostic::new(Code::NotMarkedAsOverride, name.span, message)
                            .help("write `override component` to replace its text");
                    if let Some(before) = before {
                        diagnostic = diagnostic.also(before.name.span, "declared here");
                    }
                    report.push(diagnostic);
                }
                Declares::Override if !is_inherited && !self.is_broken => {
                    report.push(absent(
                        Code::NothingToOverride,
                        "override",
                        name,
                        &inherited,
                    ));
                    continue;
                }
                Declares::New | Declares::Override => {}
            }
            self.removed.remove(name.text.as_str());
            let key = (Part::Component, component.name.text.as_str());
            put(&mut self.components, &mut self.places, key, component);
        }
    }
}

fn absent(code: Code, doing: &str, name: &Ident, inherited: &BTreeSet<&str>) -> Diagnostic {
    let message = format!("there is no component `{}` to {doing}", name.text);
    let diagnostic = Diagnostic::new(code, name.span, message);
    match nearest(&name.text, inherited.iter().copied()) {
        Some(meant) => diagnostic
            .help(format!("did you mean `{meant}`?"))
            .edit(name.span, meant),
        None if inherited.is_empty() => diagnostic
            .help("only components of an extended task can be meant; this one inherits none"),
        None => diagnostic.help(format!("it inherits {}", among(inherited.iter().copied()))),
    }
}

/// Replaces the part of the same name in its place, or adds one.
fn put<'a, T>(
    list: &mut Vec<&'a T>,
    places: &mut BTreeMap<(Part, &'a str), usize>,
    key: (Part, &'a str),
    part: &'a T,
) {
    match places.get(&key).and_then(|place| list.get_mut(*place)) {
        Some(known) => *known = part,
        None => {
            places.insert(key, list.len());
            list.push(part);
        }
    }
}

/// Reports names that appear twice.
pub(crate) fn unique<'a>(names: impl Iterator<Item = &'a Ident>, kind: &str, report: &mut Report) {
    let mut seen: BTreeMap<&str, &Ident> = BTreeMap::new();
    for name in names {
        match seen.get(name.text.as_str()) {
            Some(first) => report.push(
                Diagnostic::new(
                    Code::DuplicateName,
                    name.span,
                    format!("the {kind} `{}` is declared twice", name.text),
                )
                .also(first.span, "declared here first"),
            ),
            None => {
                seen.insert(&name.text, name);
            }
        }
    }
}
