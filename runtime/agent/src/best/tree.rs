//! The states that a search has reached, and the order in which it tries their actions.
//!
//! In: a search. Out: states by depth, each with the actions that led to it. A pass with a width goes through all depths:
//! the most promising states of each are expanded, and share the remaining trials with the depths that follow.

use super::aim::Aim;
use super::offers::Offers;
use super::{Choice, Found, Search, Stop, Taken};
use crate::error::RunError;
use crate::policy::Ground;
use crate::result::StepResult;
use crate::rollout::Tries;
use crate::scene::{Scene, SceneError};
use fab_base::chance::Chance;
use fab_base::parallel::in_parallel;
use fab_program::Exhausted;
use fab_program::facts::Facts;
use fab_program::pointing::Pointing;
use fab_world::{Fork, World, WorldError};
use std::time::Instant;

/// States of one depth whose worlds are kept; any other state is reached again from the start.
const KEPT_WORLDS: usize = 64;

/// A tree of states; the first one is the start.
pub(super) struct Tree<'a> {
    search: &'a Search<'a>,
    aim: &'a Aim<'a>,
    nodes: Vec<Node>,
    /// The scene of the start.
    first: Scene,
    stop: Option<Stop>,
}

/// A state.
struct Node {
    /// The steps from the start to here.
    path: Vec<Taken>,
    tries: Tries,
    world: Option<Fork>,
    value: f64,
    behind: f64,
    end: End,
    /// What can be done here; `None` until it is listed.
    offers: Option<Offers>,
    /// How many of these were tried, from the first on.
    tried: usize,
}

/// Whether a rollout ends in a state.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// It goes on.
    Open,
    Scored,
    /// Without a score: the camera shows nothing to choose from.
    Lost,
}

impl Node {
    fn is_tried_out(&self) -> bool {
        let offers = self.offers.as_ref();
        self.end != End::Open || offers.is_some_and(|it| self.tried == it.choices.len())
    }
}

impl<'a> Tree<'a> {
    /// Begins at the start of a rollout.
    ///
    /// Fails if the start gives nothing to choose from.
    pub fn at_start(search: &'a Search<'a>, aim: &'a Aim<'a>) -> Result<Tree<'a>, RunError> {
        let job = search.job;
        let mut world = (job.make_world)()?;
        world.reset(job.start)?;
        let positions = &job.start.positions;
        let start = Node {
            path: Vec::new(),
            tries: Tries::default(),
            world: world.fork(),
            value: aim.value(positions)?,
            behind: aim.behind(positions, 0)?,
            end: End::Open,
            offers: None,
            tried: 0,
        };
        Ok(Tree {
            search,
            aim,
            first: Scene::of(job.program, &world.observe()?, None)?,
            nodes: vec![start],
            stop: None,
        })
    }

    /// Tries the actions of another rollout, as far as there are trials left.
    pub fn follow(&mut self, hint: &[Choice]) -> Result<(), RunError> {
        for choice in hint {
            let node = self.nodes.len() - 1;
            if self.nodes[node].end != End::Open || self.stop.is_some() || self.trials_left() == 0 {
                break;
            }
            self.list(&[node])?;
            if let Some(Offers { choices, .. }) = &mut self.nodes[node].offers {
                // A pixel of a mask may not have been drawn.
                choices.retain(|offered| offered.action.grip != choice.action.grip);
                choices.insert(0, choice.clone());
                self.make(&[(node, 0)])?;
            }
        }
        Ok(())
    }

    /// Goes through all depths with more and more states, until everything was tried or a limit is reached.
    pub fn widen(&mut self) -> Result<(), RunError> {
        let mut width = 1;
        while self.stop.is_none() && !self.nodes.iter().all(Node::is_tried_out) {
            if self.trials_left() == 0 {
                self.stop = Some(Stop::Trials);
                break;
            }
            self.pass(width)?;
            width *= 2;
        }
        Ok(())
    }

    /// Goes through all depths once.
    fn pass(&mut self, width: usize) -> Result<(), RunError> {
        let job = self.search.job;
        let depths = job.horizon() * job.program.actions_per_step();
        for depth in 0..depths {
            // The remaining trials are shared with the depths that follow.
            let share = self.trials_left().div_ceil(depths - depth) as usize;
            let mut beam = self.ranked(depth);
            beam.retain(|&node| self.nodes[node].end == End::Open);
            beam.truncate(width);
            beam.retain(|&node| !self.nodes[node].is_tried_out());
            // No more actions are listed than can be tried.
            beam.truncate(share);
            self.list(&beam)?;
            // The first choice of each state, then the second, and so on.
            let untried = beam.into_iter().flat_map(|node| {
                let it = &self.nodes[node];
                let choices = it.offers.as_ref().map_or(0, |offers| offers.choices.len());
                (it.tried..choices).map(move |choice| (node, choice))
            });
            let mut due: Vec<_> = untried.collect();
            due.sort_by_key(|&(_, choice)| choice);
            due.truncate(share);
            self.make(&due)?;
            if self.stop.is_some() {
                break;
            }
            for node in self.ranked(depth + 1).into_iter().skip(KEPT_WORLDS) {
                self.nodes[node].world = None;
            }
        }
        Ok(())
    }

    /// Returns the states after `depth` actions, the most promising first: those with most steps done, since a retry must
    /// act again on a step that may be good already.
    fn ranked(&self, depth: u32) -> Vec<usize> {
        let nodes = 0..self.nodes.len();
        let at_depth = nodes.filter(|&node| self.nodes[node].tries.number == depth);
        let mut ranked: Vec<usize> = at_depth.collect();
        ranked.sort_by(|&a, &b| {
            let [a, b] = [&self.nodes[a], &self.nodes[b]];
            let by_steps = b.tries.done.cmp(&a.tries.done);
            by_steps.then(a.behind.total_cmp(&b.behind))
        });
        ranked
    }

    /// Makes trials, and adds the states that they lead to; a stop leaves some of them out.
    ///
    /// - `due`: the index of a state, and that of one of its choices.
    fn make(&mut self, due: &[(usize, usize)]) -> Result<(), RunError> {
        let made = self.n_trials();
        let progress = |done| (self.search.progress)(made + done as u32);
        let reached = self.until_stopped(due, |due| self.reach(*due), progress)?;
        for ((parent, _), node) in due.iter().zip(reached) {
            if let Some(node) = node {
                self.nodes[*parent].tried += 1;
                self.nodes.push(node);
            }
        }
        self.stop = self.requested_stop();
        Ok(())
    }

    /// Lists what can be done in states, where that is not done yet; a stop leaves some of them out.
    fn list(&mut self, nodes: &[usize]) -> Result<(), RunError> {
        let is_new = |node: &usize| self.nodes[*node].offers.is_none();
        let new: Vec<usize> = nodes.iter().copied().filter(is_new).collect();
        let listed = self.until_stopped(&new, |node| self.offers(*node), |_| {})?;
        for (node, offers) in new.into_iter().zip(listed) {
            self.nodes[node].offers = offers;
        }
        self.stop = self.requested_stop();
        Ok(())
    }

    /// Does something with each of these, side by side; a stop leaves some of them out.
    fn until_stopped<I: Sync, T: Send>(
        &self,
        items: &[I],
        job: impl Fn(&I) -> Result<T, RunError> + Sync,
        progress: impl Fn(usize) + Sync,
    ) -> Result<Vec<Option<T>>, RunError> {
        let one = |index: usize| match self.requested_stop() {
            Some(_) => Ok(None),
            None => match job(&items[index]) {
                Err(RunError::World(WorldError::Interrupted)) => Ok(None),
                done => done.map(Some),
            },
        };
        in_parallel(items.len(), self.search.limits.threads, one, progress)
    }

    fn requested_stop(&self) -> Option<Stop> {
        let until = self.search.limits.until;
        if self.search.job.interrupt.is_raised() {
            return Some(Stop::Interrupt);
        }
        let is_over = until.is_some_and(|until| Instant::now() >= until);
        is_over.then_some(Stop::Time)
    }

    /// Tries one choice on a copy of a state's world.
    fn reach(&self, (parent, number): (usize, usize)) -> Result<Node, RunError> {
        let (job, aim, it) = (self.search.job, self.aim, &self.nodes[parent]);
        let program = job.program;
        let offers = it.offers.as_ref().expect("only listed actions are tried");
        let choice = offers.choices[number].clone();
        let mut world = self.world_at(it)?;
        world.act(&choice.action.grip.into(), job.interrupt)?;
        let positions = world.particles().unwrap_or_default();
        let (step, after) = (self.step_of(&it.tries), world.observe()?);
        let (value, behind) = (aim.value(&positions)?, aim.behind(&positions, step)?);
        let result = StepResult::of(program, job.subgoals, step, &self.first, &after)?;
        let mut tries = it.tries;
        tries.number += 1;
        tries.after(program.actions_per_step(), result);
        let has_ended = tries.step(job.horizon()).is_none() || aim.is_reached(value);
        let end = if has_ended {
            End::Scored
        } else {
            match Scene::of(program, &after, Some(&self.first)) {
                Err(SceneError::OutOfView { .. } | SceneError::NoCandidates { .. }) => End::Lost,
                scene => scene.map(|_| End::Open)?,
            }
        };
        let mut path = it.path.clone();
        path.push(Taken::of(program, step, Some(choice), [value, behind]));
        Ok(Node {
            path,
            tries,
            world: world.fork().filter(|_| end == End::Open),
            value,
            behind,
            end,
            offers: None,
            tried: 0,
        })
    }

    /// Lists what can be done in a state.
    fn offers(&self, node: usize) -> Result<Offers, RunError> {
        let (job, it) = (self.search.job, &self.nodes[node]);
        let mut world = self.world_at(it)?;
        let observation = world.observe()?;
        let last = it.path.last().map(|taken| taken.choice.as_ref());
        let scene = Scene::of(job.program, &observation, last.map(|_| &self.first))?;
        let positions = world.particles().unwrap_or_default();
        let step = self.step_of(&it.tries);
        let experts = self.aim.expert_grips(&positions, step - 1);
        let ground = Ground {
            program: job.program,
            scene: &scene,
            observation: &observation,
            reach: &|point| world.out_of_reach(point),
            refuses: &|motion| world.refuses(motion),
        };
        let pointing = Pointing::of_camera(&job.program.camera);
        let last = last
            .flatten()
            .map(|it| it.action.executed(it.proposal.clone()));
        let facts = Facts {
            last: last.as_ref(),
            ..Facts::of(&scene, step, pointing)
        };
        let chance = Chance::of(&format!(
            "offered actions {} {node}",
            self.search.limits.seed
        ));
        Offers::of(ground, facts, &experts, chance, job.interrupt)
    }

    /// Returns the world of a state; where no copy of it is kept, the actions that lead to it are executed again.
    fn world_at(&self, node: &Node) -> Result<Box<dyn World>, RunError> {
        if let Some(copy) = node.world.as_ref().and_then(|world| world.fork()) {
            return Ok(copy);
        }
        let job = self.search.job;
        let mut world = (job.make_world)()?;
        world.reset(job.start)?;
        for choice in node.path.iter().filter_map(|taken| taken.choice.as_ref()) {
            world.act(&choice.action.grip.into(), job.interrupt)?;
        }
        Ok(world)
    }

    /// Returns the task's step that is due, from 1.
    fn step_of(&self, tries: &Tries) -> u32 {
        let horizon = self.search.job.horizon();
        tries.step(horizon).unwrap_or(horizon)
    }

    fn n_trials(&self) -> u32 {
        self.nodes.len() as u32 - 1
    }

    fn trials_left(&self) -> u32 {
        self.search.limits.trials.saturating_sub(self.n_trials())
    }

    /// Returns what was found so far.
    pub fn found(&self) -> Found {
        let loss = |node: &Node| self.aim.loss(node.value);
        // A rollout whose steps were all skipped has no score, so one action at least is taken.
        let may_skip = self.search.job.program.verify.exhausted == Exhausted::Skips;
        let ends = self.nodes.iter().skip(1).filter(|it| match it.end {
            End::Scored => true,
            End::Open => may_skip,
            End::Lost => false,
        });
        let end = ends.min_by(|a, b| loss(a).total_cmp(&loss(b)));
        let deepest = self.nodes.iter().map(|node| node.tries.number).max();
        let promising = self.ranked(deepest.unwrap_or_default());
        let is_left = |node: &&Node| {
            let are_drawn = node.offers.as_ref().is_some_and(|it| it.are_drawn);
            node.end == End::Open && (are_drawn || !node.is_tried_out())
        };
        let left = self.nodes.iter().filter(is_left).count();
        let best = match end {
            Some(end) => self.to_the_end(end),
            None => self.nodes[promising[0]].path.clone(),
        };
        Found {
            metric: self.aim.metric,
            untouched: self.nodes[0].value,
            value: end.map(|end| end.value),
            limiting: end.and_then(|_| self.limiting(&best)),
            best,
            trials: self.n_trials(),
            exhausted: left == 0,
            left,
            stop: self.stop,
        }
    }

    /// Returns the steps of a rollout that ends in a state; those after it are skipped.
    fn to_the_end(&self, node: &Node) -> Vec<Taken> {
        let job = self.search.job;
        let program = job.program;
        let (mut path, mut tries) = (node.path.clone(), node.tries);
        while let (Some(step), End::Open) = (tries.step(job.horizon()), node.end) {
            path.push(Taken::of(program, step, None, [node.value, node.behind]));
            tries.after(program.actions_per_step(), None);
        }
        path
    }

    /// Returns the index of the step after which the cloth lags behind most: the one that loses most against the experts,
    /// or gains least. A skipped step limits nothing.
    fn limiting(&self, best: &[Taken]) -> Option<usize> {
        let before = std::iter::once(self.nodes[0].behind).chain(best.iter().map(|it| it.behind));
        let steps = best.iter().zip(before).enumerate();
        let acted = steps.filter(|(_, (taken, _))| taken.choice.is_some());
        let lost = acted.map(|(index, (taken, before))| (index, taken.behind - before));
        let worst = lost.reduce(|worst, it| if it.1 > worst.1 { it } else { worst });
        worst.map(|(index, _)| index)
    }
}
