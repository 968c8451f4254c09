//! The rollouts beside which the best is shown: its own actions again, the expert, random actions, the stand-in.
//!
//! In: a search. Out: a row each. Rollouts are kept in run folders; a finished one is not run again.

use crate::exit::Failure;
use crate::io::Io;
use fab_agent::best::{Aim, Choice, Found, Measure, Search, unless_stopped};
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::{Expert, Following, MakePolicy, Prompted, Random};
use fab_agent::record::{RECORD_FILE, Report};
use fab_agent::rollout::{self, Job, RunError};
use fab_base::cache::Cache;
use fab_base::parallel::in_parallel;
use fab_bench::record::{self, FolderContents, Identity, Rollout};
use fab_model::Models;
use fab_model::calls::Budget;
use fab_program::Metric;
use fab_standins::Geometric;
use fab_world::{World, WorldError};
use serde::Serialize;
use std::path::Path;

/// How many rollouts of random actions there are.
const DRAWS: u32 = 5;

/// One kind of rollouts.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    #[serde(rename = "row")]
    pub name: &'static str,
    /// Whether it may look at the true state of the cloth, which no camera shows.
    pub oracle: bool,
    /// The measure at the end of each rollout, however it ended; empty if there is none.
    pub values: Vec<f64>,
    /// Whether each rollout reached the goal; empty without one.
    pub reached: Vec<bool>,
    /// Why each rollout that has no score, and is measured where it ended, has none.
    pub unscored: Vec<String>,
    /// Why there is no value.
    pub none: Option<String>,
}

impl Row {
    fn new(name: &'static str, oracle: bool) -> Row {
        Row {
            name,
            oracle,
            values: Vec::new(),
            reached: Vec::new(),
            unscored: Vec::new(),
            none: None,
        }
    }
}

/// The rollouts beside one search.
pub struct Playing<'a> {
    pub search: &'a Search<'a>,
    pub examples: &'a Examples,
    pub folder: &'a Path,
    pub io: &'a Io,
}

/// One rollout to be played.
struct Play<'p> {
    row: usize,
    folder: String,
    make_policy: &'p (dyn MakePolicy + 'p),
    repetition: u32,
}

impl Playing<'_> {
    /// Plays the policies; returns a row each, and what they decided, the best first. What was interrupted has no value.
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
        let makers: [(&'static str, bool, &dyn MakePolicy, u32); 3] = [
            ("expert", true, &Expert, 1),
            ("random", false, &random, DRAWS),
            ("stand-in", false, &stand_in, 1),
        ];
        let mut rows = Vec::new();
        let mut plays: Vec<Play<'_>> = Vec::new();
        for (name, oracle, make_policy, repetitions) in makers {
            let mut row = Row::new(name, oracle);
            match make_policy.make().prepare(self.search.program) {
                Err(error) => row.none = Some(error.to_string()),
                Ok(_) => plays.extend((0..repetitions).map(|repetition| Play {
                    row: rows.len(),
                    folder: format!("{name}-{}", repetition + 1),
                    make_policy,
                    repetition,
                })),
            }
            rows.push(row);
        }
        let show = |done: usize| {
            let what = format!("{done} of {} rollouts beside it", plays.len());
            self.io.progress(&what);
        };
        let play = |index: usize| self.play(&plays[index]);
        let played = in_parallel(plays.len(), self.search.limits.threads, play, show)?;
        let measure = Measure::of(self.search.program)?;
        let mut decided = Vec::new();
        for (play, rollout) in plays.iter().zip(played) {
            self.add(&mut rows[play.row], rollout.as_ref(), measure)?;
            let steps = rollout.iter().flat_map(|rollout| &rollout.steps);
            let choices: Vec<Choice> = steps.map_while(|step| Choice::of(&step.line)).collect();
            let scored = rollout.filter(|rollout| rollout.report.outcome.is_scored());
            let end = scored.and_then(|rollout| value(&rollout.report, measure.metric));
            let loss = end.map_or(f64::INFINITY, |end| measure.loss(end));
            decided.push((loss, choices));
        }
        // However few the trials are, the best policy is followed to its end.
        decided.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok((rows, decided.into_iter().map(|(_, it)| it).collect()))
    }

    /// Adds a rollout to its row; `None` was interrupted. One without a score is measured where it ended.
    fn add(&self, row: &mut Row, rollout: Option<&Rollout>, of: Measure) -> Result<(), Failure> {
        let Some(rollout) = rollout else {
            row.none = Some("interrupted".to_owned());
            return Ok(());
        };
        let report = &rollout.report;
        let measured = value(report, of.metric);
        if report.outcome.is_scored() && measured.is_some() {
            row.values.extend(measured);
            row.reached.extend(report.goal_reached);
            return Ok(());
        }
        let why = report.stopped.as_deref();
        let why = why.unwrap_or(report.outcome.name()).to_owned();
        let ended = match measured {
            Some(value) => Some(value),
            None => {
                let aim = unless_stopped(Aim::of(self.search))?;
                let last = rollout.last.as_ref();
                let last = last.unwrap_or(&self.search.start.positions);
                aim.and_then(|aim| aim.value(last))
            }
        };
        match ended {
            Some(value) => {
                row.values.push(value);
                let has_goal = self.search.program.goal.is_some();
                row.reached.extend(has_goal.then_some(false));
                row.unscored.push(why);
            }
            None => row.none = Some(why),
        }
        Ok(())
    }

    /// Executes the best actions in a rollout of their own, and returns the row.
    ///
    /// Fails if it ends elsewhere than the search found, or without a measure.
    pub fn best(&self, found: &Found) -> Result<Row, Failure> {
        let mut row = Row::new("best", true);
        let Some((best, expected)) = found.best.as_ref().zip(found.value()) else {
            row.none = Some("no rollout ended yet".to_owned());
            return Ok(row);
        };
        let following = Following {
            name: "best actions found".to_owned(),
            choices: best.iter().map(|taken| taken.choice.clone()).collect(),
        };
        // The folder's name differs for different actions.
        let name = Cache::key([format!("{:?}", following.choices).as_str()]);
        let rollout = self.play(&Play {
            row: 0,
            folder: format!("best-{}", &name[..8]),
            make_policy: &following,
            repetition: 0,
        })?;
        let Some(rollout) = rollout else {
            // The search measured the same state.
            row.none = Some("interrupted".to_owned());
            row.values.push(expected);
            return Ok(row);
        };
        self.add(&mut row, Some(&rollout), found.measure)?;
        match row.values.first() {
            // The same bits, but for metres that were written as millimetres.
            Some(again) if (expected - again).abs() <= 1e-9 && row.unscored.is_empty() => Ok(row),
            again => Err(Failure::environment(format!(
                "the rollout of the best actions ends at {}, and the search found {expected}: the simulator did not repeat itself",
                again.map_or("no measure".to_owned(), f64::to_string)
            ))),
        }
    }

    /// Plays one rollout, or reads it if it is finished; `None` if it was interrupted.
    fn play(&self, play: &Play<'_>) -> Result<Option<Rollout>, Failure> {
        let search = self.search;
        if search.interrupt.is_raised() {
            return Ok(None);
        }
        let make_world =
            || -> Result<Box<dyn World>, WorldError> { Ok(Box::new((search.make_world)()?)) };
        let job = Job {
            program: search.program,
            start: search.start,
            subgoals: search.subgoals,
            examples: self.examples,
            make_policy: play.make_policy,
            budget: &Budget::default(),
            recorder: None,
            make_world: &make_world,
            make_expert_world: &make_world,
            cache: search.cache,
            interrupt: search.interrupt,
            horizon: search.horizon,
            early_stop: true,
            operator: None,
            repetition: play.repetition,
            start_number: None,
        };
        let world = make_world()?;
        let identity = Identity {
            program: search.program.hash(),
            vary: world.variation(),
            params: world.parameters(),
            code: world.code(),
            start: search.start.digest(),
            policy: play.make_policy.make().description(),
            horizon: job.horizon(),
            early_stop: job.early_stop,
            repetition: job.repetition,
            drawn_for: job.drawn_for(),
        };
        let folder = self.folder.join(&play.folder);
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
