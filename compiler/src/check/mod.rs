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
mod missing_action;
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
mod unused;
mod variables;
mod verify;

use crate::diag::{Code, Diagnostic, Report, Reported};
use crate::load::Loaded;
use crate::merge;
use context::Context;
use fab_grammar::FileId;
use fab_grammar::ast::{Body, Name, Task};
use fab_program::{Material, Program, Test};

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

/// The most text that all tasks of a compilation may inherit together, bytes. Each task is checked with all of it.
pub const MAX_INHERITED_BYTES: usize = 64 << 20;

/// Checks every task of every file, and returns the programs of the entry's tasks.
///
/// - `grid`: particles along X and Y; if given, it replaces the grid of every task's cloth.
pub(crate) fn check(loaded: &Loaded<'_>, grid: Option<[u32; 2]>, report: &mut Report) -> Checked {
    let files = || loaded.files.iter();
    let whole = || files().filter(|file| !loaded.is_malformed(file.id));
    let tasks = whole().flat_map(|file| &file.tasks);
    let lists = whole().flat_map(|file| &file.experts);
    // An error outside of tasks counts against every task that sees the file, so this proof is not needed here.
    merge::unique(tasks.map(|task| task.name()), "task", report);
    merge::unique(
        lists.clone().map(|list| list.name()),
        "list of experts",
        report,
    );
    let materials = whole().flat_map(|file| &file.materials);
    merge::unique(materials.clone().map(|it| it.name()), "material", report);
    let mut context = Context::outside(loaded, report);
    // This reports errors in every material, even in one that no cloth is made of.
    let materials = materials.filter_map(|declared| material::check(*declared, &mut context).ok());
    let materials = materials.collect();
    for list in lists {
        // This reports errors in every list, even in one that no task names.
        let _: Result<_, _> = experts::check(*list, &mut context);
    }
    let form_of = |file: FileId| {
        let mut seen = loaded.visible_from(file);
        seen.find_map(|seen| context.report.error_in(seen.id))
            .map_or(Ok(()), Err)
    };
    let forms: Vec<Result<(), Reported>> = files().map(|file| form_of(file.id)).collect();
    if !loaded.is_malformed(loaded.entry().id) {
        material::unused(loaded, report);
    }
    let stamps = task::stamps(loaded);
    let mut checked = Checked {
        materials,
        ..Checked::default()
    };
    let mut merged_bytes = 0;
    for (file, form) in files().zip(forms) {
        // What is found in it may only follow from what does not parse.
        if loaded.is_malformed(file.id) {
            continue;
        }
        let is_entry = file.id == loaded.entry().id;
        for task in &file.tasks {
            // Each task has its own report: an inherited error counts against every task that inherits it, but is
            // shown once.
            let mut variants = vec![None];
            let mut whole_task = None;
            let mut number = 0;
            while number < variants.len() {
                let mut own = Report::default();
                let merged = merge::merge(*task, variants[number].take(), loaded, &mut own);
                let experts = merged.experts.and_then(|experts| {
                    loaded.experts(experts.name().span().file, experts.name().text())
                });
                merged_bytes += merged.bytes
                    + experts.map_or(0, |list| loaded.size(list.name()))
                    + merged
                        .material(loaded)
                        .map_or(0, |it| loaded.size(it.name()));
                if merged_bytes > MAX_INHERITED_BYTES {
                    report.absorb(own);
                    report.error(too_large(task.name()));
                    return checked;
                }
                // Variants of tasks in other files are checked when those files are compiled.
                if number == 0 && is_entry {
                    variants.extend(merged.applicable_variants().map(Some));
                }
                let built = task::check(&merged, &stamps, grid, form, loaded, &mut own);
                if let (Some(place), Some(variant), Ok(Some((program, _)))) =
                    (whole_task, &merged.variant, &built)
                {
                    let change = merged.own_body().map(Body::span);
                    // What was found in it may be why.
                    let is_explained = change.is_some_and(|change| own.finds_within(change));
                    let task_program = checked.programs.get(place);
                    if !is_explained && task_program.is_some_and(|it| program.runs_as(it)) {
                        own.remark(changes_nothing(variant, *task));
                    }
                }
                report.absorb(own);
                if let (true, Some(variant), Err(_)) = (is_entry, &merged.variant, &built) {
                    let name = task.name().text().to_owned();
                    checked.broken_variants.push((name, variant.name.clone()));
                }
                if let (true, Ok(Some((program, tests)))) = (is_entry, built) {
                    if number == 0 {
                        whole_task = Some(checked.programs.len());
                    }
                    checked.programs.push(program);
                    checked.tests.extend(tests);
                }
                number += 1;
            }
        }
    }
    // Otherwise an error may be why.
    if report.has_errors().is_ok() {
        experts::unused(loaded, report);
    }
    checked
}

/// Makes the warning for a variant whose program is that of its task.
fn changes_nothing(variant: &merge::VariantOf<'_>, task: Task<'_>) -> Diagnostic {
    let (name, base) = (&variant.name, task.name().text());
    let message = format!("the variant `{name}` changes nothing: it runs as `{base}` does");
    let whole = task.body().span();
    match whole.contains(variant.span) {
        true => Diagnostic::new(Code::VariantChangesNothing, variant.span, message)
            .help("state in it what it changes, or remove it"),
        false => Diagnostic::new(Code::VariantChangesNothing, task.name().span(), message)
            .also(variant.span, "declared here")
            .help(format!("leave it out: `without variant {name}`")),
    }
}

fn too_large(name: Name<'_>) -> Diagnostic {
    let message = format!(
        "with `{}` the tasks have more than {} MiB together, counting everything that each inherits",
        name.text(),
        MAX_INHERITED_BYTES >> 20
    );
    Diagnostic::new(Code::TasksTooLarge, name.span(), message)
        .help("nothing further is checked; extend smaller tasks, or compile the files one by one")
}
