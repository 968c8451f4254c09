//! The rollouts beside which the best is shown: the expert, random actions, the stand-in.
//!
//! In: a search. Out: a row each. Rollouts are kept in run folders; a finished one is not run again.

use crate::exit::Failure;
use crate::io::Io;
use fab_agent::best::{Aim, Choice, Found, Search, unless_stopped};
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::{Expert, MakePolicy, Prompted, Random};
use fab_agent::record::RECORD_FILE;
use fab_agent::rollout::{self, Job, RunError};
use fab_base::parallel::in_parallel;
use fab_bench::record::{self, FolderContents, Identity, Rollout};
use fab_model::Models;
use fab_model::calls::Budget;
use fab_program::Goal;
use fab_standins::Geometric;
use fab_world::{World, WorldError};
use serde::Serialize;
use std::path::Path;

/// How many rollouts of random actions there are.
const DRAWS: usize = 5;

/// One kind of rollouts.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    #[serde(rename = "row")]
    pub name: &'static str,
    /// Whether it may look at the true state of the cloth, which no camera shows.
    pub oracle: bool,
    /// The measure at the end of each rollout, however it ended.
    pub values: Vec<f64>,
    /// Whether each of these reached the goal; empty without one.
    pub reached: Vec<bool>,
    /// Why each rollout without a score has none.
    pub unscored: Vec<String>,
}

impl Row {
    fn new(name: &'static str, oracle: bool) -> Row {
        Row {
            name,
            oracle,
            values: Vec::new(),
            reached: Vec::new(),
            unscored: Vec::new(),
        }
    }

    /// Returns the row of the best actions that were found.
    pub fn best(found: &Found, goal: Option<&Goal>) -> Row {
        let value = found.value();
        let reached = goal.zip(value).map(|(goal, value)| goal.is_met(value));
        Row {
            values: value.into_iter().collect(),
            reached: reached.into_iter().collect(),
            ..Row::new("best", true)
        }
    }

    /// Adds a rollout; returns its loss and what was decided in it.
    fn add(&mut self, rollout: &Rollout, search: &Search<'_>, aim: &Aim) -> (f64, Vec<Choice>) {
        let report = &rollout.report;
        let is_scored = report.outcome.is_scored();
        let last = rollout.last.as_ref().unwrap_or(&search.start.positions);
        let value = aim.value(last);
        self.values.extend(value);
        let goal = search.program.goal.as_ref().zip(value);
        self.reached
            .extend(goal.map(|(goal, value)| is_scored && goal.is_met(value)));
        if !is_scored {
            let why = report.stopped.as_deref();
            self.unscored
                .push(why.unwrap_or(report.outcome.name()).to_owned());
        }
        let steps = rollout.steps.iter();
        let choices = steps.map_while(|step| Choice::of(&step.line)).collect();
        let value = value.filter(|_| is_scored);
        let loss = value.map_or(f64::INFINITY, |value| aim.measure.loss(value));
        (loss, choices)
    }
}

/// The rollouts beside one search.
pub struct Playing<'a> {
    pub search: &'a Search<'a>,
    pub examples: &'a Examples,
    pub folder: &'a Path,
    pub io: &'a Io,
}

impl Playing<'_> {
    /// Plays the policies; returns a row each, and what they decided, the best first.
    pub fn policies(&self) -> Result<(Vec<Row>, Vec<Vec<Choice>>), Failure> {
        let random = Random {
            seed: self.search.limits.seed,
        };
        let stand_in = Prompted {
            models: Models {
                vision: &Geometric,
                text: &Geometric,
            },
        };
        let makers: [(&'static str, bool, &dyn MakePolicy, usize); 3] = [
            ("expert", true, &Expert, 1),
            ("random", false, &random, DRAWS),
            ("stand-in", false, &stand_in, 1),
        ];
        let aim = unless_stopped(Aim::of(self.search))?.ok_or_else(Failure::interrupted)?;
        let (mut rows, mut decided) = (Vec::new(), Vec::new());
        for (name, oracle, make_policy, count) in makers {
            self.io.progress(&format!("rollouts beside it: {name}"));
            let mut row = Row::new(name, oracle);
            if let Err(error) = make_policy.make().prepare(self.search.program) {
                row.unscored.push(error.to_string());
            } else {
                let play = |index| self.play(name, make_policy, index);
                let played = in_parallel(count, self.search.limits.threads, play, |_| {})?;
                if played.iter().all(Option::is_none) {
                    row.unscored.push("interrupted".to_owned());
                }
                let played = played.iter().flatten();
                decided.extend(played.map(|rollout| row.add(rollout, self.search, &aim)));
            }
            rows.push(row);
        }
        // However few the trials are, the best policy is followed to its end.
        decided.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok((rows, decided.into_iter().map(|(_, it)| it).collect()))
    }

    /// Plays one rollout, or reads it if it is finished; `None` if it was interrupted.
    fn play(
        &self,
        name: &str,
        make_policy: &dyn MakePolicy,
        index: usize,
    ) -> Result<Option<Rollout>, Failure> {
        let search = self.search;
        let make_world =
            || -> Result<Box<dyn World>, WorldError> { Ok(Box::new((search.make_world)()?)) };
        let job = Job {
            program: search.program,
            start: search.start,
            subgoals: search.subgoals,
            examples: self.examples,
            make_policy,
            budget: &Budget::default(),
            make_world: &make_world,
            make_expert_world: &make_world,
            cache: search.cache,
            interrupt: search.interrupt,
            horizon: search.horizon,
            early_stop: true,
            operator: None,
            repetition: index as u32,
            start_number: None,
        };
        let world = make_world()?;
        let identity = Identity {
            program: search.program.hash(),
            vary: world.variation(),
            params: world.parameters(),
            code: world.code(),
            start: search.start.digest(),
            policy: make_policy.make().description(),
            horizon: job.horizon(),
            early_stop: job.early_stop,
            repetition: job.repetition,
            drawn_for: job.drawn_for(),
        };
        let folder = self.folder.join(format!("{name}-{}", index + 1));
        let finished = || match record::find(&folder, &identity) {
            FolderContents::Finished(rollout) => Ok(Some(*rollout)),
            FolderContents::Unfinished => Ok(None),
            FolderContents::Other(why) => Err(Failure::environment(format!(
                "`{}` holds another rollout: {why}; name another `--out`, nothing is overwritten",
                folder.display()
            ))),
        };
        if let Some(rollout) = finished()? {
            return Ok(Some(rollout));
        }
        let open = if folder.join(RECORD_FILE).is_file() {
            RunFolder::reopen(&folder)
        } else {
            RunFolder::create(&folder)
        }?;
        match rollout::run(&job, open, &mut |_| {}) {
            Err(RunError::World(WorldError::Interrupted)) => Ok(None),
            Err(error) => Err(Failure::environment(error)),
            Ok(ended) if ended.outcome == Outcome::Interrupted => Ok(None),
            Ok(_) => finished(),
        }
    }
}
