//! Joins a task with the tasks that it extends, and with one of its variants.
//!
//! A section of the task replaces the whole section of the extended task. Six kinds of parts merge by name instead:
//! - A constant, a keypoint or a stage replaces the one of the same name; new ones go last. New keypoints above a
//!   replaced one go directly before it, so it may use them.
//! - A component, or a single check beside an inherited `verify`, is added, replaced with `override`, or removed with
//!   `without`.
//! - A variant replaces the one of the same name, or is removed with `without`.
//!
//! `say NAME in STAGE after NAME` adds a component to what an inherited stage says.
//!
//! A variant is merged like a task that extends the one that contains it.

mod lists;
mod said;

pub(crate) use lists::{
    DuplicateNames, FirstStatement, Indexed, declared_twice, left_out_once, once, repeated, unique,
};

use crate::diag::{Code, Diagnostic, Report, Reported, among, nearest};
use crate::lang::sections::{Inheritance, SECTIONS};
use crate::load::Loaded;
use fab_grammar::Span;
pub(crate) use said::Said;

use fab_grammar::ast::{
    Actions, AddedSay, Body, Check, Component, Declares, Demos, ExpertsUsed, Expr, Keypoints,
    Material, Name, NamedValue, Rehearse, ResultCheck, Stage, Statement, Subgoals, Task, Verify,
};
use lists::{LEAVE_OUT, OVERRIDE};
use std::collections::{BTreeMap, BTreeSet};

/// The longest chain of `extends`, in tasks.
pub const MAX_EXTENDS_DEPTH: usize = 16;

/// The most components that one task adds to what its stages say.
const MAX_ADDED: usize = 256;

/// The most variants of a task; each is checked like a task.
pub(crate) const MAX_VARIANTS: usize = 64;

/// A task with everything that it inherits.
pub(crate) struct Merged<'a> {
    pub task: Task<'a>,
    /// The variant, if this is one.
    pub variant: Option<VariantOf<'a>>,
    pub constants: Indexed<'a, NamedValue<'a>>,
    /// Sections of one value, by their words.
    pub statements: BTreeMap<&'a str, Statement<'a>>,
    pub subgoals: Option<Subgoals<'a>>,
    pub experts: Option<ExpertsUsed<'a>>,
    pub demos: Option<Demos<'a>>,
    pub keypoints: Indexed<'a, NamedValue<'a>>,
    pub annotate: Option<Keypoints<'a>>,
    pub actions: Option<Actions<'a>>,
    pub components: Indexed<'a, Component<'a>>,
    /// The inherited components that are removed.
    pub removed: BTreeSet<&'a str>,
    pub stages: Indexed<'a, Stage<'a>>,
    pub rehearse: Option<Rehearse<'a>>,
    /// What each stage says, by its name.
    pub said: BTreeMap<&'a str, Said<'a>>,
    /// The stages that were stated again, and what they said before.
    pub replaced_stages: BTreeMap<&'a str, (Stage<'a>, Said<'a>)>,
    /// The section that states attempts and results; the checks are in `checks`.
    pub verify: Option<Verify<'a>>,
    pub checks: Indexed<'a, Check<'a>>,
    /// The inherited checks that are removed.
    pub removed_checks: BTreeSet<&'a str>,
    /// What the last `verify` that states checks again replaces.
    pub replaced: Replaced<'a>,
    /// The variants that the task and those it extends declare.
    pub variants: Vec<VariantOf<'a>>,
    /// The inherited variants that are removed.
    removed_variants: BTreeSet<&'a str>,
    /// The length of all its parts, bytes.
    pub bytes: usize,
    /// The proof that a task it extends is missing, if one is: an unknown name may be declared there.
    pub missing_base: Option<Reported>,
    /// The constants and keypoints that one body declares twice.
    pub twice: DuplicateNames<'a>,
    /// The proof of an error in how its parts were joined, if there is one.
    pub joined: Result<(), Reported>,
}

/// The inherited part of a task that its own `verify` replaces.
#[derive(Default)]
pub(crate) struct Replaced<'a> {
    /// The names of its checks.
    pub checks: Vec<Name<'a>>,
    /// How it judged results.
    pub result: Option<ResultCheck<'a>>,
}

/// A variant of a task.
#[derive(Clone)]
pub(crate) struct VariantOf<'a> {
    /// Its name.
    pub name: String,
    /// How it changes the task.
    pub change: VariantChange<'a>,
    /// Where it is declared.
    pub span: Span,
}

/// How a variant changes a task.
#[derive(Clone, Copy)]
pub(crate) enum VariantChange<'a> {
    /// It replaces and adds sections, under its own name.
    Body(Body<'a>),
    /// It removes a component.
    Without(Name<'a>),
}

/// Merges `task` with those it extends, and then with `variant`.
pub(crate) fn merge<'a>(
    task: Task<'a>,
    variant: Option<VariantOf<'a>>,
    loaded: &Loaded<'a>,
    report: &mut Report,
) -> Merged<'a> {
    let (chain, missing_base) = chain(task, loaded, report);
    let mut merged = Merged {
        task,
        variant,
        constants: Indexed::default(),
        statements: BTreeMap::new(),
        subgoals: None,
        experts: None,
        demos: None,
        keypoints: Indexed::default(),
        annotate: None,
        actions: None,
        components: Indexed::default(),
        removed: BTreeSet::new(),
        stages: Indexed::default(),
        rehearse: None,
        said: BTreeMap::new(),
        replaced_stages: BTreeMap::new(),
        verify: None,
        checks: Indexed::default(),
        removed_checks: BTreeSet::new(),
        replaced: Replaced::default(),
        variants: Vec::new(),
        removed_variants: BTreeSet::new(),
        bytes: 0,
        missing_base,
        twice: DuplicateNames::default(),
        joined: missing_base.map_or(Ok(()), Err),
    };
    for task in chain.into_iter().rev() {
        merged.forget_what_is_not_inherited();
        merged.add(task.body(), loaded, report);
        merged.add_variants(task, loaded, report);
    }
    match merged.variant.as_ref().map(|variant| variant.change) {
        Some(VariantChange::Body(body)) => merged.add(body, loaded, report),
        Some(VariantChange::Without(name)) => merged.leave_out(name, loaded, report),
        None => {}
    }
    merged
}

/// Returns the task and those it extends, and the proof that one of them is missing, if one is.
fn chain<'a>(
    task: Task<'a>,
    loaded: &Loaded<'a>,
    report: &mut Report,
) -> (Vec<Task<'a>>, Option<Reported>) {
    let mut chain = vec![task];
    let mut above = task;
    while let Some(base) = above.extends() {
        let file = base.span().file;
        let Some(found) = loaded.task(file, base.text()) else {
            let hidden = loaded.unread(file);
            let reported = hidden.unwrap_or_else(|| report.error(unknown_task(task, base, loaded)));
            return (chain, Some(reported));
        };
        let is_known = |seen: &Task<'_>| seen.name().span() == found.name().span();
        if chain.iter().any(is_known) {
            let message = format!("`{}` extends itself", base.text());
            let through = if chain.len() > 1 {
                "leads back here"
            } else {
                "this is the task itself"
            };
            let diagnostic = Diagnostic::new(Code::CircularExtends, base.span(), message);
            return (chain, Some(report.error(diagnostic.label(through))));
        }
        if chain.len() > MAX_EXTENDS_DEPTH {
            let message = format!("the chain of `extends` is longer than {MAX_EXTENDS_DEPTH}");
            let diagnostic = Diagnostic::new(Code::ExtendsTooDeep, base.span(), message);
            return (chain, Some(report.error(diagnostic)));
        }
        chain.push(found);
        above = found;
    }
    (chain, None)
}

fn unknown_task(task: Task<'_>, base: Name<'_>, loaded: &Loaded<'_>) -> Diagnostic {
    let message = format!("there is no task `{}`", base.text());
    let diagnostic = Diagnostic::new(Code::UnknownName, base.span(), message);
    let seen = || {
        loaded
            .visible_from(base.span().file)
            .flat_map(|file| &file.tasks)
            .map(|seen| seen.name().text())
            .filter(|name| *name != task.name().text())
    };
    let mut files = loaded.files.iter();
    let unseen = files.find(|file| loaded.task(file.id, base.text()).is_some());
    match (nearest(base.text(), seen()), unseen) {
        (_, Some(file)) => diagnostic.help(format!(
            "it is declared in `{}`; add a `use` of that file",
            loaded.texts.sources.get(file.id).name
        )),
        (Some(meant), _) => diagnostic.meant(base.span(), meant),
        _ if seen().next().is_none() => {
            diagnostic.help("declare it, or write `use` with the file that declares it")
        }
        _ => diagnostic.help(format!("this file sees {}", among(seen()))),
    }
}

impl<'a> Merged<'a> {
    /// Drops the statements of an extended task that are not inherited; a variant keeps its task's.
    fn forget_what_is_not_inherited(&mut self) {
        let never = |word: &str| {
            let mut rows = SECTIONS.iter();
            rows.any(|row| row.word == word && row.merges == Inheritance::Never)
        };
        self.statements.retain(|word, _| !never(word));
    }

    fn add(&mut self, body: Body<'a>, loaded: &Loaded<'a>, report: &mut Report) {
        let mut statements: BTreeMap<&str, Statement<'_>> = BTreeMap::new();
        for statement in body.statements() {
            let word = statement.word().text();
            let first = *statements.entry(word).or_insert(statement);
            if first.span() != statement.span() {
                let diagnostic = repeated(word, first.span(), statement.span());
                self.joined = Err(report.error(diagnostic));
            }
        }
        self.statements.append(&mut statements);
        let subgoals = once(body.subgoals(), "subgoals", |it| it.head_span(), report);
        self.subgoals = self.only(subgoals).or(self.subgoals);
        let experts = once(body.experts(), "experts", |it| it.span(), report);
        self.experts = self.only(experts).or(self.experts);
        let demos = once(body.demos(), "demos", |it| it.span(), report);
        self.demos = self.only(demos).or(self.demos);
        let annotate = once(body.annotate(), "annotate", |it| it.head_span(), report);
        self.annotate = self.only(annotate).or(self.annotate);
        let actions = once(body.actions(), "actions", |it| it.head_span(), report);
        self.actions = self.only(actions).or(self.actions);
        let rehearse = once(body.rehearsals(), "rehearse", |it| it.head_span(), report);
        self.rehearse = self.only(rehearse).or(self.rehearse);
        let keypoints = once(body.keypoints(), "keypoints", |it| it.head_span(), report);
        let keypoints = self.only(keypoints);
        let keypoints = || keypoints.into_iter().flat_map(|part| part.list());
        let mut constants = unique(body.constants().map(|it| it.name()), "constant", report);
        let mut points = unique(keypoints().map(|it| it.name()), "keypoint", report);
        self.twice.0.append(&mut constants.0);
        self.twice.0.append(&mut points.0);
        self.distinct(body.stages().map(|it| it.name()), "stage", report);
        for constant in body.constants() {
            self.constants.put(constant.name().text(), constant);
        }
        self.keypoints
            .put_block(keypoints(), |keypoint| keypoint.name().text());
        for stage in body.stages() {
            let name = stage.name().text();
            let said = self.said.insert(name, Said::of(stage));
            if let (Some(before), Some(said)) = (self.stages.get(name), said) {
                self.replaced_stages.insert(name, (before, said));
            }
            self.stages.put(name, stage);
        }
        for names in [
            body.without().collect::<Vec<Name<'_>>>(),
            body.without_checks().collect(),
        ] {
            self.joined = self.joined.and(left_out_once(names, report));
        }
        self.add_components(body, loaded, report);
        self.add_sayings(body, report);
        self.add_checks(body, loaded, report);
        self.bytes += body.bytes();
    }

    /// Returns the material that the cloth names, if a file that it sees declares it.
    pub fn material(&self, loaded: &Loaded<'a>) -> Option<Material<'a>> {
        let Expr::Call(call) = self.statement("cloth")?.value() else {
            return None;
        };
        let mut given = call.arguments();
        let stated = given.find(|it| it.label().is_some_and(|label| label.text() == "material"))?;
        match stated.value() {
            Expr::Name(name) => loaded.material(name.span().file, name.text()),
            _ => None,
        }
    }

    /// Returns the first of a section, and records the proof of an error if there are more.
    fn only<T>(&mut self, section: FirstStatement<T>) -> Option<T> {
        self.joined = self.joined.and(section.alone);
        section.first
    }

    /// Reports names that appear twice.
    fn distinct(
        &mut self,
        names: impl IntoIterator<Item = Name<'a>>,
        kind: &str,
        report: &mut Report,
    ) {
        self.joined = self.joined.and(unique(names, kind, report).any());
    }

    // ---- components ----------------------------------------------------------------------------

    /// Adds and replaces components.
    fn add_components(&mut self, body: Body<'a>, loaded: &Loaded<'a>, report: &mut Report) {
        self.distinct(body.components().map(|it| it.name()), "component", report);
        let inherited = self.component_names();
        let left_out = self.removed.clone();
        for name in body.without() {
            self.leave_out(name, loaded, report);
            if left_out.contains(name.text()) {
                self.left_out_already("component", name, report);
            }
        }
        for component in body.components() {
            let name = component.name();
            let is_inherited =
                inherited.contains(name.text()) && !self.removed.contains(name.text());
            match component.declares() {
                Declares::New if is_inherited => {
                    let before = self.components.get(name.text()).map(Component::name);
                    let help = "write `override component` to replace its text, or choose another name to add a component";
                    self.joined = Err(report.error(unmarked("component", name, before, help)));
                }
                Declares::Override if !is_inherited && self.missing_base.is_none() => {
                    let is_left_out = left_out.contains(name.text());
                    let reported = self.not_overridden(
                        "component",
                        name,
                        is_left_out,
                        &inherited,
                        loaded,
                        report,
                    );
                    self.joined = Err(reported);
                    // One that may be inherited stays, so that its uses are not reported too.
                    if loaded.unread(name.span().file).is_none() {
                        continue;
                    }
                }
                Declares::New | Declares::Override => {}
            }
            self.removed.remove(name.text());
            self.components.put(name.text(), component);
        }
    }

    /// Removes a component; reports an error if there is none of this name.
    fn leave_out(&mut self, name: Name<'a>, loaded: &Loaded<'a>, report: &mut Report) {
        if self.components.remove(name.text()).is_some() {
            self.removed.insert(name.text());
        } else if !self.removed.contains(name.text()) {
            let inherited = self.component_names();
            self.not_left_out("component", name, &inherited, loaded, report);
        }
    }

    fn component_names(&self) -> BTreeSet<&'a str> {
        self.components
            .iter()
            .map(|component| component.name().text())
            .collect()
    }

    // ---- what stages say -----------------------------------------------------------------------

    /// Adds components to what inherited stages say.
    fn add_sayings(&mut self, body: Body<'a>, report: &mut Report) {
        let own: BTreeMap<&str, Stage<'_>> = body
            .stages()
            .map(|stage| (stage.name().text(), stage))
            .collect();
        let mut lines = body
            .added_sayings()
            .flat_map(|line| line.parts().map(move |part| (line, part)));
        for (line, part) in lines.by_ref().take(MAX_ADDED) {
            // What did not parse may declare what seems to be missing; its own error was reported.
            let may_be_hidden = self.missing_base.is_some();
            match self.unsayable(line, part, &own) {
                Some(diagnostic) if may_be_hidden && diagnostic.code == Code::UnknownName => {}
                Some(diagnostic) => self.joined = Err(report.error(diagnostic)),
                None => {
                    let said = self.said.entry(line.stage().text()).or_default();
                    said.add(part, line.side(), line.beside().text());
                }
            }
        }
        if let Some((_, part)) = lines.next() {
            let message = format!("a task adds at most {MAX_ADDED} components to its stages");
            let diagnostic = Diagnostic::new(Code::OutOfRange, part.span(), message)
                .help("declare them as one component, or state the stage again");
            self.joined = Err(report.error(diagnostic));
        }
    }

    /// Returns why a component cannot be added to what a stage says, if it cannot.
    fn unsayable(
        &self,
        line: AddedSay<'a>,
        part: Name<'a>,
        own: &BTreeMap<&str, Stage<'a>>,
    ) -> Option<Diagnostic> {
        let (stage, beside) = (line.stage(), line.beside());
        let unknown = |name: Name<'_>, message: String| {
            Diagnostic::new(Code::UnknownName, name.span(), message)
        };
        if let Some(own) = own.get(stage.text()) {
            let message = format!("the stage `{}` is stated in this task", stage.text());
            let diagnostic = Diagnostic::new(Code::Repeated, stage.span(), message);
            let help = format!(
                "list `{}` in that stage's `say` or `system`, and drop this line",
                part.text()
            );
            return Some(diagnostic.also(own.head_span(), "stated here").help(help));
        }
        let Some(said) = self.said.get(stage.text()) else {
            let stages = || self.said.keys().copied();
            let message = format!("there is no stage `{}` to add to", stage.text());
            let diagnostic = unknown(stage, message);
            return Some(match nearest(stage.text(), stages()) {
                Some(meant) => diagnostic.meant(stage.span(), meant),
                None if self.said.is_empty() => {
                    diagnostic.help("this is only for a stage of an extended task, and this task inherits none; state `stage NAME { … }`")
                }
                None => diagnostic.help(format!("it inherits {}", among(stages()))),
            });
        };
        if self.removed.contains(part.text()) {
            let message = format!("the component `{}` is left out", part.text());
            return Some(unknown(part, message).help(format!(
                "declare it again, `component {} \"…\"`; a stage that said it says it again in its place",
                part.text()
            )));
        }
        if self.components.get(part.text()).is_none() {
            let message = format!("there is no component `{}`", part.text());
            let diagnostic = unknown(part, message);
            let declare = format!("declare it: `component {} \"…\"`", part.text());
            return Some(match nearest(part.text(), self.component_names()) {
                Some(meant) => diagnostic
                    .meant(part.span(), meant)
                    .help(format!("or {declare}")),
                None => diagnostic.help(declare),
            });
        }
        if said.says(part.text()) {
            let message = format!(
                "the stage `{}` says `{}` already",
                stage.text(),
                part.text()
            );
            let diagnostic = Diagnostic::new(Code::Repeated, part.span(), message);
            return Some(diagnostic.help(format!(
                "drop this line; to change the text, write `override component {}`; to move it, state `stage {}` again",
                part.text(),
                stage.text()
            )));
        }
        if said.says(beside.text()) {
            return None;
        }
        let message = format!(
            "the stage `{}` does not say `{}`",
            stage.text(),
            beside.text()
        );
        let diagnostic = unknown(beside, message);
        if let Some(meant) = nearest(beside.text(), said.names()) {
            return Some(diagnostic.meant(beside.span(), meant));
        }
        let diagnostic = match said.names().next() {
            None => diagnostic,
            Some(_) => diagnostic.help(format!("it says {}", among(said.names()))),
        };
        let can_come_first = said.names().next().is_some();
        if can_come_first && self.components.get(beside.text()).is_some() {
            return Some(diagnostic.help(format!(
                "add `{}` to the stage on a line above this one, or choose another place",
                beside.text()
            )));
        }
        Some(match said.says_text {
            false => diagnostic,
            true => diagnostic.help(format!(
                "nothing can be added beside a text without a name; to change that, state `stage {}` again",
                stage.text()
            )),
        })
    }

    // ---- checks --------------------------------------------------------------------------------

    /// Takes over the checks of a `verify`, or changes inherited ones.
    fn add_checks(&mut self, body: Body<'a>, loaded: &Loaded<'a>, report: &mut Report) {
        let verify = once(body.verify(), "verify", |it| it.head_span(), report);
        match self.only(verify) {
            Some(verify) => self.restate_checks(body, verify, loaded, report),
            None => self.change_checks(body, loaded, report),
        }
    }

    /// Takes over the checks of a `verify` of the body's own, and drops the inherited ones.
    fn restate_checks(
        &mut self,
        body: Body<'a>,
        verify: Verify<'a>,
        loaded: &Loaded<'a>,
        report: &mut Report,
    ) {
        for check in body.override_checks() {
            self.joined = Err(report.error(not_inherited(check.name(), verify)));
        }
        for check in body.checks() {
            self.joined = Err(report.error(beside_verify(check.name(), verify)));
        }
        self.distinct(verify.checks().map(|check| check.name()), "check", report);
        let restated: BTreeSet<&str> = verify.checks().map(|check| check.name().text()).collect();
        let inherited: BTreeSet<&str> = self.check_names().collect();
        let mut left_out = BTreeSet::new();
        for name in body.without_checks() {
            if restated.contains(name.text()) {
                self.joined = Err(report.error(not_inherited(name, verify)));
            } else if inherited.contains(name.text()) {
                left_out.insert(name.text());
            } else {
                self.not_left_out("check", name, &inherited, loaded, report);
            }
        }
        self.replaced = Replaced {
            checks: self.checks.iter().map(Check::name).collect(),
            result: self.verify.and_then(|verify| verify.results().next()),
        };
        self.verify = Some(verify);
        self.checks = Indexed::default();
        self.removed_checks = left_out;
        // A misplaced check stays, so that nothing that refers to it is reported as well.
        let misplaced = body
            .checks()
            .filter(|it| !restated.contains(it.name().text()));
        for check in verify.checks().chain(misplaced) {
            self.checks.put(check.name().text(), check);
        }
    }

    /// Adds, replaces and removes single checks.
    fn change_checks(&mut self, body: Body<'a>, loaded: &Loaded<'a>, report: &mut Report) {
        let stated = body.checks().chain(body.override_checks());
        self.distinct(stated.map(|check| check.name()), "check", report);
        let inherited: BTreeSet<&str> = self.check_names().collect();
        let mut left_out = self.removed_checks.clone();
        if self.variant.is_some() {
            // A `verify` that drops checks was warned of.
            left_out.extend({ self.replaced.checks.iter() }.map(|name| name.text()));
        }
        for name in body.without_checks() {
            if self.checks.remove(name.text()).is_some() {
                self.removed_checks.insert(name.text());
            } else if !self.removed_checks.contains(name.text()) && !left_out.contains(name.text())
            {
                self.not_left_out("check", name, &inherited, loaded, report);
            }
            if left_out.contains(name.text()) {
                self.left_out_already("check", name, report);
            }
        }
        let left: BTreeSet<&str> = self.check_names().collect();
        for check in body.override_checks() {
            if left.contains(check.name().text()) {
                self.checks.put(check.name().text(), check);
            } else if self.missing_base.is_none() {
                let is_left_out = left_out.contains(check.name().text());
                let reported =
                    self.not_overridden("check", check.name(), is_left_out, &left, loaded, report);
                self.joined = Err(reported);
            }
        }
        for check in body.checks() {
            let name = check.name();
            if left.contains(name.text()) {
                let before = self.checks.get(name.text()).map(Check::name);
                let help =
                    "write `override check` to replace it, or choose another name to add a check";
                self.joined = Err(report.error(unmarked("check", name, before, help)));
            }
            self.removed_checks.remove(name.text());
            self.checks.put(name.text(), check);
        }
    }

    /// Reports something to override that is not inherited; a variant may override what its task leaves out.
    fn not_overridden(
        &self,
        kind: &str,
        name: Name<'a>,
        is_left_out: bool,
        inherited: &BTreeSet<&str>,
        loaded: &Loaded<'a>,
        report: &mut Report,
    ) -> Reported {
        let Some(variant) = self.variant.as_ref().filter(|_| is_left_out) else {
            return OVERRIDE.impossible(kind, name, inherited, loaded, report);
        };
        let (task, name_of) = (self.task.name().text(), &variant.name);
        let message = format!(
            "`{task}` leaves out the {kind} `{}`, which its variant `{name_of}` overrides",
            name.text()
        );
        // An inherited variant is in order where it is declared.
        let is_inherited = !self.task.body().span().contains(name.span());
        let diagnostic = match is_inherited {
            true => Diagnostic::new(Code::NothingToOverride, self.task.name().span(), message)
                .also(name.span(), "overridden here"),
            false => Diagnostic::new(Code::NothingToOverride, name.span(), message),
        };
        report.error(diagnostic.help(format!(
            "leave out the variant too: `without variant {name_of}`"
        )))
    }

    /// Reports something to leave out that is not inherited, unless the task that has it is missing.
    fn not_left_out(
        &mut self,
        kind: &str,
        name: Name<'a>,
        inherited: &BTreeSet<&str>,
        loaded: &Loaded<'a>,
        report: &mut Report,
    ) {
        if self.missing_base.is_some() {
            return;
        }
        let text = name.text();
        let kinds = [
            ("component", self.components.get(text).is_some()),
            ("check", self.checks.get(text).is_some()),
            ("variant", self.variants.iter().any(|it| it.name == text)),
        ];
        self.joined = Err(match kinds.iter().find(|(_, has)| *has) {
            Some((other, _)) => {
                let message = format!("there is no {kind} `{text}` to leave out");
                let diagnostic = Diagnostic::new(Code::NothingToRemove, name.span(), message);
                report.error(diagnostic.help(format!(
                    "`{text}` is a {other}: write `without {other} {text}`"
                )))
            }
            None => LEAVE_OUT.impossible(kind, name, inherited, loaded, report),
        });
    }

    /// Reports something to leave out that an extended task leaves out already.
    ///
    /// A variant may leave out what its task leaves out: an inherited one cannot know.
    fn left_out_already(&mut self, kind: &str, name: Name<'a>, report: &mut Report) {
        if self.variant.is_none() {
            let message = format!(
                "an extended task leaves out the {kind} `{}` already",
                name.text()
            );
            let diagnostic = Diagnostic::new(Code::NothingToRemove, name.span(), message);
            self.joined = Err(report.error(diagnostic.help("drop this name")));
        }
    }

    /// Returns the names of all checks, in their order.
    pub fn check_names(&self) -> impl Iterator<Item = &'a str> {
        self.checks.iter().map(|check| check.name().text())
    }

    // ---- variants ------------------------------------------------------------------------------

    /// Removes inherited variants of one task.
    fn leave_out_variants(&mut self, task: Task<'a>, loaded: &Loaded<'a>, report: &mut Report) {
        let left_out: Vec<Name<'a>> = task.without_variants().collect();
        let names: BTreeSet<String> = self.variants.iter().map(|it| it.name.clone()).collect();
        let inherited: BTreeSet<&str> = names.iter().map(String::as_str).collect();
        self.joined = self
            .joined
            .and(left_out_once(left_out.iter().copied(), report));
        for name in &left_out {
            if inherited.contains(name.text()) {
                self.removed_variants.insert(name.text());
            } else if !self.removed_variants.contains(name.text()) {
                self.not_left_out("variant", *name, &inherited, loaded, report);
            } else {
                self.left_out_already("variant", *name, report);
            }
        }
        let removed: BTreeSet<&str> = left_out.iter().map(|name| name.text()).collect();
        self.variants
            .retain(|variant| !removed.contains(variant.name.as_str()));
    }

    /// Adds the variants of one task; a later one replaces an earlier one of the same name.
    fn add_variants(&mut self, task: Task<'a>, loaded: &Loaded<'a>, report: &mut Report) {
        self.leave_out_variants(task, loaded, report);
        let declared = task.variants().map(|variant| VariantOf {
            name: variant.name().text().to_owned(),
            change: VariantChange::Body(variant.body()),
            span: variant.name().span(),
        });
        let ablated = task.ablated().map(|name| VariantOf {
            name: format!("without_{}", name.text()),
            change: VariantChange::Without(name),
            span: name.span(),
        });
        let mut own: Vec<VariantOf<'a>> = Vec::new();
        for variant in declared.chain(ablated) {
            if let Some(first) = own.iter().find(|known| known.name == variant.name) {
                let diagnostic = declared_twice("variant", &variant.name, first.span, variant.span);
                self.joined = Err(report.error(diagnostic));
                continue;
            }
            if own.len() >= MAX_VARIANTS {
                let message = format!("a task has at most {MAX_VARIANTS} variants");
                let diagnostic = Diagnostic::new(Code::OutOfRange, variant.span, message);
                self.joined = Err(report.error(diagnostic));
                break;
            }
            own.push(variant);
        }
        for variant in own {
            match self
                .variants
                .iter_mut()
                .find(|known| known.name == variant.name)
            {
                Some(known) => *known = variant,
                None => self.variants.push(variant),
            }
        }
    }

    /// Returns the variants that change something: a component that is absent cannot be ablated.
    pub fn applicable_variants(&self) -> impl Iterator<Item = VariantOf<'a>> {
        self.variants
            .iter()
            .filter(|variant| match variant.change {
                VariantChange::Body(_) => true,
                VariantChange::Without(name) => !self.removed.contains(name.text()),
            })
            .cloned()
    }

    // ---- queries ---------------------------------------------------------------------------------

    /// Returns what the task adds to those it extends, or the variant to its task; `None` if that is only left out.
    pub fn own_body(&self) -> Option<Body<'a>> {
        match self.variant.as_ref().map(|variant| variant.change) {
            None => Some(self.task.body()),
            Some(VariantChange::Body(body)) => Some(body),
            Some(VariantChange::Without(_)) => None,
        }
    }

    /// Returns the statement that begins with `word`.
    pub fn statement(&self, word: &str) -> Option<Statement<'a>> {
        self.statements.get(word).copied()
    }

    /// Returns whether a rollout needs subgoals: a stage shows one, or results are compared with them.
    pub fn needs_subgoals(&self) -> bool {
        let compares = self
            .verify
            .is_some_and(|verify| verify.results().next().is_some());
        let lines = self.stages.iter().flat_map(|stage| stage.show());
        let mut pictures = lines.flat_map(|show| show.pictures());
        let is_scene =
            |value: Expr<'_>| matches!(value, Expr::Name(name) if name.text() == "scene");
        compares || pictures.any(|picture| !is_scene(picture.value()))
    }
}

/// Makes the diagnostic for a part that replaces an inherited one without `override`.
fn unmarked(kind: &str, name: Name<'_>, before: Option<Name<'_>>, help: &str) -> Diagnostic {
    let message = format!("`{}` replaces a {kind} of an extended task", name.text());
    let diagnostic = Diagnostic::new(Code::NotMarkedAsOverride, name.span(), message).help(help);
    match before {
        Some(before) => diagnostic.also(before.span(), "declared here"),
        None => diagnostic,
    }
}

/// Makes the diagnostic for a change to one check next to a `verify` that states all of them again.
fn not_inherited(name: Name<'_>, verify: Verify<'_>) -> Diagnostic {
    let message = format!(
        "`{}` is not inherited, because this task has its own `verify`",
        name.text()
    );
    Diagnostic::new(Code::Repeated, name.span(), message)
        .also(verify.head_span(), "stated here")
        .help("change the check in that `verify`, and drop this line")
}

/// Makes the diagnostic for a check that is added next to a `verify` that states all of them.
fn beside_verify(name: Name<'_>, verify: Verify<'_>) -> Diagnostic {
    let message = format!(
        "the check `{}` is not in this task's own `verify`",
        name.text()
    );
    Diagnostic::new(Code::Repeated, name.span(), message)
        .also(verify.head_span(), "stated here")
        .help("move the check into that `verify`; outside of it, a check is added to an inherited `verify`")
}
