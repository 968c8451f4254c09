//! The rollouts beside which the best is shown: the expert, random actions, the stand-in.
//!
//! In: a search. Out: a row each. Rollouts are kept in run folders; a finished one is not run again.

use crate::exit::Failure;
use crate::io::Io;
use fab_agent::best::{Choice, Found, Measure, Search};
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::{Expert, MakePolicy, Prompted, Random};
use fab_agent::record::{RECORD_FILE, Report};
use fab_agent::rollout::{self, Job, RunError};
use fab_base::parallel::in_parallel;
use fab_bench::record::{self, FolderContents, Identity, Rollout};
use fab_model::Models;
use fab_model::calls::Budget;
use fab_program::{Goal, Metric};
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
    /// The measure at the end of each rollout that has a score.
    pub values: Vec<f64>,
    /// Whether each of these reached the goal; empty without one.
    pub reached: Vec<bool>,
    /// Why each of the other rollouts has no score.
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
    fn add(&mut self, rollout: &Rollout, measure: Measure) -> (f64, Vec<Choice>) {
        let report = &rollout.report;
        let is_scored = report.outcome.is_scored();
        let value = value(report, measure.metric).filter(|_| is_scored);
        if let Some(value) = value {
            self.values.push(value);
            self.reached.extend(report.goal_reached);
        } else {
            let why = report.stopped.as_deref();
            let why = why.unwrap_or(report.outcome.name());
            self.unscored.push(why.to_owned());
        }
        let steps = rollout.steps.iter();
        let choices = steps.map_while(|step| Choice::of(&step.line)).collect();
        let loss = value.map_or(f64::INFINITY, |value| measure.loss(value));
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
        let measure = Measure::of(self.search.program)?;
        let (mut rows, mut decided) = (Vec::new(), Vec::new());
        for (name, oracle, make_policy, count) in makers {
            self.io.progress(&format!("rollouts beside it: {name}"));
            let mut row = Row::new(name, oracle);
            if let Err(error) = make_policy.make().prepare(self.search.program) {
                row.unscored.push(error.to_string());
            } else {
                let play = |index| self.play(name, make_policy, index);
                let played = in_parallel(count, self.search.limits.threads, play, |_| {})?;
                let played = played.iter().flatten();
                decided.extend(played.map(|rollout| row.add(rollout, measure)));
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
            recorder: None,
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

/// Returns the measure at the end of a rollout: metres of distance, or a fraction.
fn value(report: &Report, metric: Metric) -> Option<f64> {
    match metric {
        Metric::ParticleDistance => Some(report.mean_particle_distance_mm? / 1000.0),
        Metric::Coverage => report.coverage,
        Metric::NormalizedImprovement => report.normalized_improvement,
    }
}
