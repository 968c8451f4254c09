//! Joins a task with the tasks that it extends, and with one of its variants.
//!
//! Each body is read once into its [`Sections`]. They are joined as the rows of `SECTIONS` state:
//! - A section that is inherited whole is replaced whole.
//! - A constant, a keypoint, a stage or a variant replaces the one of the same name; new ones go last. New keypoints
//!   above a replaced one go directly before it, so it may use them.
//! - A component, or a single check beside an inherited `verify`, is added, or replaced with `override`.
//! - `without` leaves out an inherited component, check or variant, and `say NAME in STAGE after NAME` adds a component
//!   to what an inherited stage says.
//!
//! A variant is joined like a task that extends the one that contains it.

mod lists;
mod parts;
mod said;
mod sections;

use crate::diag::{Code, Diagnostic, Report, Reported};
use crate::lang::sections::{Inheritance, inheritance};
use crate::load::Loaded;
use fab_grammar::ast::{
    Actions, AddedSay, Body, Check, Component, Declares, Demos, ExpertsUsed, Expr, File, Keypoints,
    Name, NamedValue, Rehearse, ResultCheck, Stage, Statement, Subgoals, Task, Verify,
};
use fab_grammar::{Node, Span};
pub(crate) use lists::{declared_twice, once, repeated, unique};
pub(crate) use parts::{Parts, Site};
pub(crate) use said::{Line, Said};
use sections::Sections;
pub(crate) use sections::VariantChange;
use std::collections::{BTreeMap, BTreeSet};

/// The longest chain of `extends`, in tasks.
pub const MAX_EXTENDS_DEPTH: usize = 16;

/// The sections of every task and variant, by the spans of their bodies.
pub(crate) struct Bodies<'a>(BTreeMap<Span, Sections<'a>>);

impl<'a> Bodies<'a> {
    /// Reads the sections of all bodies.
    pub fn of(loaded: &Loaded<'a>, report: &mut Report) -> Bodies<'a> {
        let mut bodies = BTreeMap::new();
        for file in loaded.well_formed() {
            for task in file.tasks() {
                let variants = task.variants().map(|variant| variant.body());
                for body in variants.chain([task.body()]) {
                    bodies.insert(body.span(), Sections::of(body, report));
                }
            }
        }
        Bodies(bodies)
    }

    fn sections(&self, body: Body<'a>) -> &Sections<'a> {
        &self.0[&body.span()]
    }
}

/// A task with everything that it inherits.
pub(crate) struct Merged<'a> {
    pub task: Task<'a>,
    /// The variant, if this is one.
    pub variant: Option<Site<'a, VariantChange<'a>>>,
    /// The sections without a name, by the words that they begin with.
    single: BTreeMap<&'a str, Node<'a>>,
    pub constants: Parts<'a, NamedValue<'a>>,
    pub keypoints: Parts<'a, NamedValue<'a>>,
    pub components: Parts<'a, Component<'a>>,
    pub stages: Parts<'a, Stage<'a>>,
    /// What each stage says, by its name.
    pub said: BTreeMap<&'a str, Said<'a>>,
    /// The inherited stages that were stated again.
    pub replaced_stages: BTreeSet<&'a str>,
    /// The checks of `verify`, and those beside it.
    pub checks: Parts<'a, Check<'a>>,
    /// What the task's own `verify` drops without a `without check`.
    pub dropped: Dropped,
    /// The variants that the task and those it extends declare.
    pub variants: Parts<'a, VariantChange<'a>>,
    /// The proof of an error in how its parts were joined, if there is one.
    pub joined: Result<(), Reported>,
}

/// The inherited checks that a `verify` neither states again nor leaves out.
#[derive(Default)]
pub(crate) struct Dropped {
    /// Their names, and where they are declared.
    pub checks: Vec<(String, Span)>,
    /// Whether it also drops how results are judged.
    pub has_result: bool,
}

/// Merges `task` with those it extends, and then with `variant`; fails if one that it extends is missing.
pub(crate) fn merge<'a>(
    task: Task<'a>,
    variant: Option<Site<'a, VariantChange<'a>>>,
    bodies: &Bodies<'a>,
    loaded: &Loaded<'a>,
    report: &mut Report,
) -> Result<Merged<'a>, Reported> {
    let chain = chain(task, loaded, report)?;
    let mut merged = Merged {
        task,
        variant: None,
        single: BTreeMap::new(),
        constants: Parts::of("constant"),
        keypoints: Parts::of("keypoint"),
        components: Parts::of("component"),
        stages: Parts::of("stage"),
        said: BTreeMap::new(),
        replaced_stages: BTreeSet::new(),
        checks: Parts::of("check"),
        dropped: Dropped::default(),
        variants: Parts::of("variant"),
        joined: Ok(()),
    };
    for task in chain.into_iter().rev() {
        let is_inherited = |word: &str| inheritance(word) != Inheritance::Never;
        merged.single.retain(|word, _| is_inherited(word));
        merged.join(bodies.sections(task.body()), report);
    }
    let change = variant.as_ref().map(|site| site.part);
    merged.variant = variant;
    match change {
        Some(VariantChange::Body(body)) => merged.join(bodies.sections(body), report),
        Some(VariantChange::Without(name)) => {
            let unfit = merged.components.remove(&[name]);
            merged.unfit(unfit, report);
        }
        None => {}
    }
    Ok(merged)
}

/// Returns the task and those it extends.
fn chain<'a>(
    task: Task<'a>,
    loaded: &Loaded<'a>,
    report: &mut Report,
) -> Result<Vec<Task<'a>>, Reported> {
    let mut chain = vec![task];
    let mut above = task;
    while let Some(base) = above.extends() {
        let Some(found) = loaded.task(base.span().file, base.text()) else {
            return Err(report.error(unknown_task(task, base, loaded)));
        };
        let is_known = |seen: &Task<'_>| seen.name().span() == found.name().span();
        if chain.iter().any(is_known) {
            let message = format!("`{}` extends itself", base.text());
            let diagnostic = Diagnostic::new(Code::CircularExtends, base.span(), message);
            return Err(report.error(diagnostic.label("leads back here")));
        }
        if chain.len() > MAX_EXTENDS_DEPTH {
            let message = format!("the chain of `extends` is longer than {MAX_EXTENDS_DEPTH}");
            let diagnostic = Diagnostic::new(Code::ExtendsTooDeep, base.span(), message);
            return Err(report.error(diagnostic));
        }
        chain.push(found);
        above = found;
    }
    Ok(chain)
}

fn unknown_task(task: Task<'_>, base: Name<'_>, loaded: &Loaded<'_>) -> Diagnostic {
    let message = format!("there is no task `{}`", base.text());
    let diagnostic = Diagnostic::new(Code::UnknownName, base.span(), message);
    let mut files = loaded.files.iter();
    if let Some(file) = files.find(|file| loaded.task(file.span().file, base.text()).is_some()) {
        return diagnostic.help(format!(
            "it is declared in `{}`; add a `use` of that file",
            loaded.name(file.span().file)
        ));
    }
    let seen = loaded.visible_from(base.span().file);
    let seen = seen.flat_map(File::tasks).map(|it| it.name().text());
    let others = seen.filter(|name| *name != task.name().text());
    diagnostic.suggest(
        base.text(),
        others,
        "declare it, or write `use` with the file that declares it",
    )
}

impl<'a> Merged<'a> {
    /// Returns what the task adds to those it extends, or the variant to its task; `None` if that is only left out.
    pub fn own_body(&self) -> Option<Body<'a>> {
        match self.variant.as_ref().map(|variant| variant.part) {
            None => Some(self.task.body()),
            Some(VariantChange::Body(body)) => Some(body),
            Some(VariantChange::Without(_)) => None,
        }
    }

    /// Returns the variants that change something: a component that is absent cannot be ablated.
    pub fn applicable_variants(&self) -> impl Iterator<Item = Site<'a, VariantChange<'a>>> {
        let changes = |it: &&Site<'a, VariantChange<'a>>| match it.part {
            VariantChange::Body(_) => true,
            VariantChange::Without(name) => !self.components.is_removed(name.text()),
        };
        self.variants.sites().filter(changes).cloned()
    }

    /// Returns the section without a name that begins with `word`.
    pub fn section(&self, word: &str) -> Option<Node<'a>> {
        self.single.get(word).copied()
    }

    /// Returns the statement that begins with `word`.
    pub fn statement(&self, word: &str) -> Option<Statement<'a>> {
        Statement::cast(self.section(word)?)
    }

    pub fn subgoals(&self) -> Option<Subgoals<'a>> {
        Subgoals::cast(self.section("subgoals")?)
    }

    pub fn experts(&self) -> Option<ExpertsUsed<'a>> {
        ExpertsUsed::cast(self.section("experts")?)
    }

    pub fn demos(&self) -> Option<Demos<'a>> {
        Demos::cast(self.section("demos")?)
    }

    pub fn annotate(&self) -> Option<Keypoints<'a>> {
        Keypoints::cast(self.section("annotate")?)
    }

    pub fn actions(&self) -> Option<Actions<'a>> {
        Actions::cast(self.section("actions")?)
    }

    pub fn rehearse(&self) -> Option<Rehearse<'a>> {
        Rehearse::cast(self.section("rehearse")?)
    }

    /// Returns the section that states attempts and results; the checks are in `checks`.
    pub fn verify(&self) -> Option<Verify<'a>> {
        Verify::cast(self.section("verify")?)
    }

    /// Returns whether a rollout needs subgoals: a stage shows one, or results are compared with them.
    pub fn needs_subgoals(&self) -> bool {
        let lines = self.stages.iter().flat_map(|stage| stage.show());
        let mut pictures = lines.flat_map(|show| show.pictures());
        let is_scene =
            |value: Expr<'_>| matches!(value, Expr::Name(name) if name.text() == "scene");
        self.result().is_some() || pictures.any(|picture| !is_scene(picture.value()))
    }

    fn result(&self) -> Option<ResultCheck<'a>> {
        self.verify()?.results().next()
    }
}

// ---- joining -------------------------------------------------------------------------------------

impl<'a> Merged<'a> {
    /// Joins the sections of one body with those that it inherits, and reports those that do not fit.
    fn join(&mut self, own: &Sections<'a>, report: &mut Report) {
        self.joined = self.joined.and(own.fault);
        self.constants.put(&own.constants);
        self.keypoints.put_block(&own.keypoints);
        let mut unfit = self.components.remove(&own.without_components);
        unfit.extend(self.components.change(&own.components));
        unfit.extend(self.variants.remove(&own.without_variants));
        self.unfit(unfit, report);
        self.variants.put(&own.variants);
        for stage in own.stages.iter().map(|site| site.part) {
            let name = stage.name().text();
            if self.said.insert(name, Said::of(stage)).is_some() {
                self.replaced_stages.insert(name);
            }
        }
        self.stages.put(&own.stages);
        self.join_checks(own, report);
        self.single.extend(&own.single);
        self.add_sayings(own, report);
    }

    /// Takes over the checks of a `verify`, or changes inherited ones.
    fn join_checks(&mut self, own: &Sections<'a>, report: &mut Report) {
        self.dropped = Dropped::default();
        let verify = own.single.get("verify");
        let Some(verify) = verify.and_then(|node| Verify::cast(*node)) else {
            let mut unfit = self.checks.remove(&own.without_checks);
            unfit.extend(self.checks.change(&own.checks));
            return self.unfit(unfit, report);
        };
        let is_restated = |name: &str| own.verified.iter().any(|site| site.name == name);
        let (beside, left_out): (Vec<Name<'_>>, Vec<Name<'_>>) =
            { own.without_checks.iter() }.partition(|name| is_restated(name.text()));
        let restated = "change the check in that `verify`, and drop this line";
        let added = "move the check into that `verify`; outside of it, a check is added to an inherited `verify`";
        let added = own.checks.iter().map(|it| {
            let is_new = it.declares == Declares::New && !is_restated(&it.name);
            (it.part.name(), if is_new { added } else { restated })
        });
        for (name, help) in beside.into_iter().map(|it| (it, restated)).chain(added) {
            self.joined = Err(report.error(beside_verify(name, verify).help(help)));
        }
        let unfit = self.checks.remove(&left_out);
        self.unfit(unfit, report);
        let inherited = self.checks.sites();
        let dropped = inherited.filter(|site| !is_restated(&site.name));
        self.dropped = Dropped {
            checks: dropped
                .map(|site| (site.name.to_string(), site.span))
                .collect(),
            has_result: self.result().is_some() && verify.results().next().is_none(),
        };
        self.checks.restate(&own.verified);
        // A misplaced check stays, so that nothing that refers to it is reported as well.
        self.checks.put(&own.checks);
    }

    /// Adds components to what inherited stages say.
    fn add_sayings(&mut self, own: &Sections<'a>, report: &mut Report) {
        for (line, part) in &own.added_sayings {
            if let Some(diagnostic) = unsayable(*line, *part, own, self) {
                self.joined = Err(report.error(diagnostic));
                continue;
            }
            let said = self.said.entry(line.stage().text()).or_default();
            said.add(*part, *line);
        }
    }

    /// Reports changes that do not fit what is inherited.
    fn unfit(&mut self, found: Vec<Diagnostic>, report: &mut Report) {
        for mut diagnostic in found {
            let name = diagnostic.about.clone().unwrap_or_default();
            let kinds = [
                ("component", self.components.get(&name).is_some()),
                ("check", self.checks.get(&name).is_some()),
            ];
            if diagnostic.code == Code::NothingToRemove
                && let Some((kind, _)) = kinds.iter().find(|(_, has_name)| *has_name)
            {
                let help = format!("`{name}` is a {kind}: write `without {kind} {name}`");
                diagnostic.help = vec![help];
            }
            if let Some(variant) = &self.variant
                && !self.task.body().span().contains(diagnostic.span)
            {
                // An inherited variant is in order where it is declared.
                let name = &variant.name;
                diagnostic.message = format!("in the variant `{name}`, {}", diagnostic.message);
                diagnostic = diagnostic.caused_at(self.task.name().span()).help(format!(
                    "leave out the variant too: `without variant {name}`"
                ));
            }
            self.joined = Err(report.error(diagnostic));
        }
    }
}

/// Returns why a component cannot be added to what a stage says, if it cannot.
fn unsayable<'a>(
    line: AddedSay<'a>,
    part: Name<'a>,
    own: &Sections<'a>,
    merged: &Merged<'a>,
) -> Option<Diagnostic> {
    let (stage, beside) = (line.stage(), line.beside());
    let unknown =
        |name: Name<'_>, message: String| Diagnostic::new(Code::UnknownName, name.span(), message);
    let (to, name) = (stage.text(), part.text());
    if let Some(own) = own.stages.iter().find(|it| it.name == to) {
        let message = format!("the stage `{to}` is stated in this task");
        let diagnostic = Diagnostic::new(Code::Repeated, stage.span(), message);
        let help = format!("list `{name}` in that stage's `say` or `system`, and drop this line");
        return Some(diagnostic.also(own.span, "stated here").help(help));
    }
    let Some(said) = merged.said.get(to) else {
        let none = "this is only for a stage of an extended task, and this task inherits none; state `stage NAME { … }`";
        let diagnostic = unknown(stage, format!("there is no stage `{to}` to add to"));
        return Some(diagnostic.suggest(to, merged.said.keys().copied(), none));
    };
    if merged.components.get(name).is_none() {
        let declare = format!("declare it: `component {name} \"…\"`");
        if merged.components.is_removed(name) {
            let message = format!("the component `{name}` is left out");
            return Some(unknown(part, message).help(declare));
        }
        let diagnostic = unknown(part, format!("there is no component `{name}`"));
        let names = merged.components.names();
        return Some(diagnostic.suggest(name, names, "").help(declare));
    }
    if said.says(name) {
        let message = format!("the stage `{to}` says `{name}` already");
        let diagnostic = Diagnostic::new(Code::Repeated, part.span(), message);
        return Some(diagnostic.help(format!(
            "drop this line; to change the text, write `override component {name}`; to move it, state `stage {to}` again"
        )));
    }
    if said.says(beside.text()) {
        return None;
    }
    let message = format!("the stage `{to}` does not say `{}`", beside.text());
    let none = format!(
        "nothing can be added beside a text without a name; to change that, state `stage {to}` again"
    );
    Some(unknown(beside, message).suggest(beside.text(), said.names(), &none))
}

/// Makes the diagnostic for a change to one check next to a `verify` that states all of them.
fn beside_verify(name: Name<'_>, verify: Verify<'_>) -> Diagnostic {
    let message = format!(
        "the check `{}` is beside this task's own `verify`, which states all checks",
        name.text()
    );
    Diagnostic::new(Code::Repeated, name.span(), message).also(verify.head_span(), "stated here")
}
