//! Compiles a suite's tasks, and finds its starts and models.

use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::bench::{BenchArguments, Shard};
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::model_arguments::{ModelArguments, Purpose};
use crate::verbs::runtime::setting::models::Answering;
use crate::verbs::runtime::setting::policies::Deciding;
use crate::{shipped, sources};
use fab_agent::examples::Examples;
use fab_agent::policy::MakePolicy;
use fab_base::interrupt::Interrupt;
use fab_base::wording::quoted;
use fab_bench::suite::{Method, Suite};
use fab_bench::vary::Variation;
use fab_bench::{Entry, Task, starts};
use fab_program::Program;
use fab_providers::remote::settings::Parameter;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A task with all its variants, for its own cloth and for the cloths of its starts.
pub struct Prepared {
    pub task: Task,
    folder: PathBuf,
    file: String,
    /// The task and its variants, for the declared cloth.
    declared: Vec<Program>,
    /// The same for the cloths of starts, by grid.
    by_grid: BTreeMap<[u32; 2], Vec<Program>>,
}

/// The policy of each method, keyed by the policy and model that the method names; `None` means the command line's.
pub type DecidingBy = BTreeMap<[Option<String>; 2], Deciding>;

pub fn named_by(method: &Method) -> [Option<String>; 2] {
    [method.policy.clone(), method.model.clone()]
}

pub fn deciding(
    suite: &Suite,
    arguments: &BenchArguments,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<DecidingBy, Failure> {
    let (policy, models) = (&arguments.policy, &arguments.model);
    let purpose = arguments.spend.purpose();
    let mut deciding = DecidingBy::new();
    for method in &suite.methods {
        let key = named_by(method);
        if deciding.contains_key(&key) {
            continue;
        }
        // A method that names a model asks that model; `--model` does not apply to a method that names a policy.
        let (policy, model) = match &key {
            [None, None] => (policy.clone(), models.model.clone()),
            [None, Some(model)] => (policy.named("prompted".to_owned()), vec![model.clone()]),
            [Some(own), None] if own == "prompted" => {
                (policy.named(own.clone()), models.model.clone())
            }
            [Some(own), model] => (policy.named(own.clone()), model.iter().cloned().collect()),
        };
        let mut models = ModelArguments {
            model,
            ..models.clone()
        };
        if !suite.structured {
            models.reach.omit.push(Parameter::Schema.name().to_owned());
        }
        // A policy of a method's own asks no model: an estimate counts the other methods.
        let purpose = match &key {
            [Some(own), _] if own != "prompted" => Purpose::Asking,
            _ => purpose,
        };
        deciding.insert(key, Deciding::of(&policy, &models, purpose, interrupt, io)?);
    }
    Ok(deciding)
}

/// Compiles the tasks and lists their starts; reports tasks without recorded starts and leaves them out.
pub fn prepare(
    suite: &Suite,
    folder: &Path,
    arguments: &BenchArguments,
    io: &Io,
) -> Result<Vec<Prepared>, Failure> {
    let mut tasks = Vec::new();
    for file in &suite.tasks {
        let file = shipped::find_beside(folder, file, io)?;
        let declared = sources::compile_tasks(&file, None, None, io)?;
        let mut bare = declared.iter().filter(|program| program.variant.is_none());
        let (Some(program), None) = (bare.next(), bare.next()) else {
            return Err(Failure::environment(format!(
                "`{file}` declares several tasks; a suite needs one a file"
            )));
        };
        let program = program.clone();
        let mut points = starts::generated(suite.starts_of(&program.task), &program.cloth);
        if let Some(recorded) = &arguments.starts {
            points = starts::recorded(recorded, &program.task)?;
            for point in &points {
                let start = format!("{} of `{}`", point.number, recorded.display());
                setting::check_spacing(&start, point.cloth.spacing_m, &program)?;
            }
        }
        let points = chosen(points, arguments.limit, arguments.shard);
        let name = program.task.clone();
        if points.is_empty() {
            io.talk(&format!(
                "`{name}` is left out: there is no start for it here"
            ));
            continue;
        }
        let grids: BTreeSet<[u32; 2]> = points.iter().map(|it| it.grid()).collect();
        let mut by_grid = BTreeMap::new();
        for grid in grids {
            let programs = if grid == [program.cloth.dimx, program.cloth.dimy] {
                declared.clone()
            } else {
                sources::compile_tasks(&file, None, Some(grid), io)?
            };
            by_grid.insert(grid, programs);
        }
        tasks.push(Prepared {
            task: Task {
                name,
                program,
                starts: points,
            },
            folder: sources::folder_of(&file),
            file,
            declared,
            by_grid,
        });
    }
    let is_unknown = |name: &&String| !tasks.iter().any(|it| it.task.name == **name);
    if let Some(unknown) = suite.own_starts.keys().find(is_unknown) {
        return Err(Failure::environment(format!(
            "the suite states starts of a task `{unknown}`, and has {}",
            quoted(tasks.iter().map(|it| &it.task.name))
        )));
    }
    if tasks.is_empty() {
        return Err(Failure::environment(
            "no task of the suite has a start; `--starts` names recorded ones, `--shard` a part of them",
        ));
    }
    Ok(tasks)
}

/// Keeps the first `limit` starts, and of those the ones of one part.
fn chosen<T>(points: Vec<T>, limit: Option<u32>, shard: Option<Shard>) -> Vec<T> {
    let limit = limit.map_or(usize::MAX, |limit| limit as usize);
    let Shard { part, of } = shard.unwrap_or(Shard { part: 1, of: 1 });
    let first = points.into_iter().take(limit);
    first.skip(part as usize - 1).step_by(of as usize).collect()
}

/// Pairs tasks with methods and kinds of worlds.
pub fn entries<'a>(
    suite: &'a Suite,
    prepared: &[Prepared],
    deciding: &'a DecidingBy,
    arguments: &BenchArguments,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<Vec<Entry<'a>>, Failure> {
    let mut entries = Vec::new();
    for (number, prepared) in prepared.iter().enumerate() {
        for method in &suite.methods {
            let Some(shown) = variant_of(&prepared.declared, method) else {
                let variant = method.variant.as_deref().unwrap_or_default();
                if !method.optional {
                    let why = sources::no_variant(&prepared.file, variant, &prepared.declared);
                    return Err(Failure::environment(why));
                }
                io.talk(&format!(
                    "`{}` has no variant `{variant}`: its row `{}` is left out",
                    prepared.task.name, method.name
                ));
                continue;
            };
            let mut world = setting::world(shown)?;
            let subgoals = setting::subgoals(shown, &prepared.folder, world.as_mut(), interrupt)?;
            let reasoning = arguments.model.reach.reasoning.or(method.reasoning);
            let programs = prepared.by_grid.iter().filter_map(|(grid, programs)| {
                let program = variant_of(programs, method)?.clone();
                Some((*grid, program.with_reasoning(reasoning)))
            });
            let Some(deciding) = deciding.get(&named_by(method)) else {
                continue;
            };
            let policy = deciding.make();
            if let Err(error) = policy.prepare(shown) {
                if !method.optional {
                    return Err(Failure::environment(error));
                }
                io.talk(&format!("{error}: its row `{}` is left out", method.name));
                continue;
            }
            let repeats = arguments.repeats.or(method.repeats);
            let own = Entry {
                task: number,
                method,
                variation: Variation::default(),
                make_policy: deciding,
                policy: policy.description(),
                models: deciding.answering().map(Answering::models),
                programs: programs.collect(),
                subgoals,
                examples: Examples::load(shown, &prepared.folder)?,
                varies: policy.varies(),
                repeats: if policy.varies() {
                    repeats.unwrap_or(suite.repeats)
                } else {
                    1
                },
            };
            entries.push(own.clone());
            entries.extend(suite.variations().into_iter().map(|variation| Entry {
                variation,
                ..own.clone()
            }));
        }
    }
    if entries.is_empty() {
        return Err(Failure::environment(
            "no task of the suite has a variant that its methods name",
        ));
    }
    Ok(entries)
}

fn variant_of<'p>(programs: &'p [Program], method: &Method) -> Option<&'p Program> {
    let mut programs = programs.iter();
    programs.find(|program| program.variant == method.variant)
}
