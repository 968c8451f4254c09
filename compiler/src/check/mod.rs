//! Checks tasks, and builds the programs of those without errors.
//!
//! In: the views of every file. Out: the programs of the entry file's runnable tasks, and diagnostics. Every task
//! of every file is checked, including bases. Only [`check`] makes a [`Program`], so every program is free of errors.
//! There is one file per section, one per concept that sections share, and some that only warn. Those of
//! sections return their part of the program, or the proof that an error was reported.

mod actions;
mod annotate;
mod arguments;
mod camera;
mod certainty;
mod choices;
mod cloth;
mod conditions;
mod context;
mod demos;
mod effect;
mod examples;
mod experts;
mod expressions;
mod files;
mod folds;
mod goal;
mod horizon;
mod keypoints;
mod material;
mod names;
mod picker;
mod placeholders;
mod quantity;
mod rehearse;
mod short_text;
mod stage;
mod subgoals;
mod task;
mod test;
mod unspoken;
mod untouched_score;
mod unused;
mod variables;
mod verify;

use crate::diag::{Code, Diagnostic, Report};
use crate::load::Loaded;
use crate::merge::{self, Bodies, Merged, Site, VariantChange};
use context::{Context, Outside, Result};
use fab_grammar::Span;
use fab_grammar::ast::{Body, File, Task};
use fab_program::{Material, Program, SourceStamp, Test};
use std::collections::{BTreeMap, BTreeSet};

/// The result of checking.
#[derive(Default)]
pub(crate) struct Checked {
    /// The tasks and variants of the entry that can run.
    pub programs: Vec<Program>,
    /// The task and the name of each variant of the entry that has errors.
    pub broken_variants: Vec<(String, String)>,
    /// The tests of those that can run.
    pub tests: Vec<Test>,
    /// The materials that the entry declares or sees.
    pub materials: Vec<Material>,
}

/// Checks every task of every file, and returns the programs of the entry's tasks.
///
/// - `grid`: particles along X and Y; if given, it replaces the grid of every task's cloth.
pub(crate) fn check(loaded: &Loaded<'_>, grid: Option<[u32; 2]>, report: &mut Report) -> Checked {
    let outside = outside_of_tasks(loaded, report);
    // Only an error outside of tasks counts against every task that sees the file.
    let forms = loaded.well_formed().map(|file| {
        let mut seen = loaded.visible_from(file.span().file);
        let wrong = seen.find_map(|seen| report.error_in(seen.span().file));
        (file, wrong.map_or(Ok(()), Err))
    });
    let forms: Vec<(File<'_>, Result<()>)> = forms.collect();
    let bodies = Bodies::of(loaded, report);
    let mut tasks = Tasks {
        loaded,
        bodies: &bodies,
        outside: &outside,
        stamps: task::stamps(loaded),
        grid,
        running: BTreeSet::new(),
        idle: Vec::new(),
        checked: Checked {
            materials: outside.materials.values().flatten().cloned().collect(),
            ..Checked::default()
        },
        report,
    };
    for (file, form) in forms {
        for task in file.tasks() {
            tasks.check(task, form);
        }
    }
    let Tasks {
        checked,
        running,
        idle,
        ..
    } = tasks;
    unused::names(loaded, &running, report);
    for (change, diagnostic) in idle {
        // What was found in the variant may be why it changes nothing.
        if !change.is_some_and(|change| report.finds_within(change)) {
            report.remark(diagnostic);
        }
    }
    unused::outside_of_tasks(loaded, report);
    checked
}

/// Checks what files declare outside of tasks, even lists and materials that no task names.
fn outside_of_tasks(loaded: &Loaded<'_>, report: &mut Report) -> Outside {
    let tasks = || loaded.well_formed().flat_map(File::tasks).map(Task::name);
    let lists = || loaded.well_formed().flat_map(File::experts);
    let materials = || loaded.well_formed().flat_map(File::materials);
    let distinct = [
        merge::unique(tasks(), "task", report),
        merge::unique(lists().map(|it| it.name()), "list of experts", report),
        merge::unique(materials().map(|it| it.name()), "material", report),
    ];
    // The errors count against every task that sees the file.
    let _: Result<()> = distinct.into_iter().collect();
    let names = tasks().map(|name| (name.text(), name.span()));
    differ_by_more_than_case("task", names, report);
    let nothing = Outside::default();
    let mut context = Context::new(loaded, &nothing, report);
    let lists = lists().map(|it| (it.span(), experts::check(it, &mut context)));
    let experts = lists.collect();
    let materials = materials().map(|it| (it.span(), material::check(it, &mut context)));
    Outside {
        experts,
        materials: materials.collect(),
    }
}

/// Reports names that many file systems do not keep apart: runs and snapshots are stored by them.
fn differ_by_more_than_case<'n>(
    kind: &str,
    names: impl Iterator<Item = (&'n str, Span)>,
    report: &mut Report,
) {
    let mut seen = BTreeMap::new();
    for (name, span) in names {
        let (first, place) = *seen.entry(name.to_lowercase()).or_insert((name, span));
        if first != name {
            let message = format!("the {kind}s `{first}` and `{name}` differ only by case");
            let diagnostic = Diagnostic::new(Code::DuplicateName, span, message)
                .also(place, "declared here first")
                .help("choose another name: folders of runs and snapshots are named after it, and many file systems ignore case");
            report.error(diagnostic);
        }
    }
}

/// Checks tasks with their variants.
struct Tasks<'a, 'r> {
    loaded: &'r Loaded<'a>,
    bodies: &'r Bodies<'a>,
    outside: &'r Outside,
    stamps: Vec<SourceStamp>,
    grid: Option<[u32; 2]>,
    /// The bodies of tasks and variants that can run.
    running: BTreeSet<Span>,
    /// The variants that change nothing, each with its body.
    idle: Vec<(Option<Span>, Diagnostic)>,
    checked: Checked,
    report: &'r mut Report,
}

impl<'a> Tasks<'a, '_> {
    /// Checks a task and, in the entry, its variants; those of other files are checked when these are compiled.
    fn check(&mut self, task: Task<'a>, form: Result<()>) {
        let file = task.name().span().file;
        let whole = self.checked.programs.len();
        let Some(merged) = self.one(task, None, form) else {
            return;
        };
        if file != self.loaded.entry().span().file {
            return;
        }
        let variants = || merged.variants.sites();
        differ_by_more_than_case(
            "variant",
            variants().map(|site| (site.name.as_ref(), site.span)),
            self.report,
        );
        let is_whole = self.checked.programs.len() > whole;
        for variant in merged.applicable_variants() {
            self.one(task, Some((variant, is_whole.then_some(whole))), form);
        }
        if is_whole {
            let certain = certainty::check(&self.checked.programs[whole..], &merged);
            certain.into_iter().for_each(|it| self.report.remark(it));
        }
    }

    /// Checks a task, or one of its variants.
    ///
    /// - `variant`: with the place of the task's program, if there is one.
    fn one(
        &mut self,
        task: Task<'a>,
        variant: Option<(Site<'a, VariantChange<'a>>, Option<usize>)>,
        form: Result<()>,
    ) -> Option<Merged<'a>> {
        let (variant, whole) = variant.map_or((None, None), |(it, whole)| (Some(it), whole));
        // Each has its own report: an inherited error counts against every task that inherits it, but is shown once.
        let mut own = Report::default();
        let loaded = self.loaded;
        let Ok(merged) = merge::merge(task, variant, self.bodies, loaded, &mut own) else {
            self.report.absorb(own);
            return None;
        };
        let mut context = Context::new(loaded, self.outside, &mut own);
        context.grid = self.grid;
        let built = task::check(&merged, &self.stamps, form, &mut context);
        let is_entry = task.name().span().file == loaded.entry().span().file;
        match (built, &merged.variant) {
            (Ok(Some((program, tests))), variant) if is_entry => {
                let change = merged.own_body().map(Body::span);
                if let (Some(variant), Some(whole)) = (variant, whole)
                    && program.runs_as(&self.checked.programs[whole])
                {
                    self.idle.push((change, changes_nothing(variant, task)));
                }
                self.running.extend(change);
                self.checked.programs.push(program);
                self.checked.tests.extend(tests);
            }
            (Err(_), Some(variant)) if is_entry => {
                let names = (task.name().text().to_owned(), variant.name.to_string());
                self.checked.broken_variants.push(names);
            }
            _ => {}
        }
        self.report.absorb(own);
        Some(merged)
    }
}

/// Makes the warning for a variant whose program is that of its task.
fn changes_nothing(variant: &Site<'_, VariantChange<'_>>, task: Task<'_>) -> Diagnostic {
    let (name, base) = (&variant.name, task.name().text());
    let message = format!("the variant `{name}` changes nothing: it runs as `{base}` does");
    let new = |span| Diagnostic::new(Code::VariantChangesNothing, span, message);
    if task.body().span().contains(variant.span) {
        new(variant.span).help("state in it what it changes, or remove it")
    } else {
        new(task.name().span())
            .also(variant.span, "declared here")
            .help(format!("leave it out: `without variant {name}`"))
    }
}
