//! The states that a search has reached, and how it goes on from them.
//!
//! In: a search. Out: states by depth, each with what led to it. A pass with a width goes through all depths: the most
//! promising states of each are gone on from, and share the trials that are left with the depths that follow.

use super::aim::Aim;
use super::journal::TrialRecord;
use super::offers::{self, Offers, Situation};
use super::{BestError, Choice, Found, Search, Taken, key_of, unless_stopped};
use crate::result::StepResult;
use crate::rollout::Tries;
use crate::scene::{Scene, SceneError};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_base::parallel::in_parallel;
use fab_picture::observation::Observation;
use fab_program::facts::ExecutedAction;
use fab_program::{Exhausted, Metric};
use fab_world::simulated::trials::{Snapshot, Trial, TrialEnd, try_motions};
use fab_world::{Grasp, SimulatedWorld, World};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// A tree of states; the first one is the start.
#[derive(Debug)]
pub struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) aim: Arc<Aim>,
    /// The scene of the rollout's start.
    pub(super) first: Scene,
    pub(super) trials: u32,
    known: u32,
    interrupted: bool,
}

/// A state.
#[derive(Debug)]
pub(super) struct Node {
    pub parent: Option<usize>,
    /// How the parent led here; `None` at the start.
    pub choice: Option<Choice>,
    pub grasp: Option<Grasp>,
    /// Tells the motions from the start on.
    pub key: String,
    pub tries: Tries,
    pub last: Option<ExecutedAction>,
    /// `None` where it can be computed again, to save memory.
    pub state: Option<Snapshot>,
    pub value: f64,
    pub behind: f64,
    /// Whether the rollout ends here.
    pub ended: bool,
    /// What can be done here; `None` until somebody looks.
    pub offers: Option<Offers>,
    /// How many of these were tried.
    pub tried: usize,
}

/// A trial that is due: which state it begins at, and which of the choices there.
#[derive(Clone, Copy)]
struct Due {
    node: usize,
    choice: usize,
}

impl Tree {
    /// Begins at the start of a rollout.
    ///
    /// Fails if the task has nothing to measure, or the start gives nothing to choose from.
    pub(super) fn at_start(search: &Search<'_>) -> Result<Tree, BestError> {
        let aim = Arc::new(Aim::of(search)?);
        let mut world = (search.make_world)()?;
        world.reset(search.start)?;
        let observation = world.observe()?;
        let first = Scene::of(search.program, &observation, None)?;
        let positions = &search.start.positions;
        let measured = aim.value(positions).zip(aim.behind(positions, 0));
        let Some((value, behind)) = measured else {
            return Err(BestError::Unmeasured {
                start: search.start.name.clone(),
                why: match aim.measure.metric {
                    Metric::NormalizedImprovement => {
                        "it covers as much as the flat cloth, so that nothing can be gained"
                    }
                    _ => "its particles are not those of the experts",
                }
                .to_owned(),
            });
        };
        let root = Node {
            parent: None,
            choice: None,
            grasp: None,
            key: String::new(),
            tries: Tries::default(),
            last: None,
            state: Some(world.state()?),
            value,
            behind,
            ended: aim.ends(search, value),
            offers: None,
            tried: 0,
        };
        Ok(Tree::from(root, aim, first))
    }

    /// Begins at a state within a rollout.
    pub(super) fn from(root: Node, aim: Arc<Aim>, first: Scene) -> Tree {
        Tree {
            nodes: vec![root],
            aim,
            first,
            trials: 0,
            known: 0,
            interrupted: false,
        }
    }

    /// Makes the trials of a known rollout, as far as there are trials left.
    pub(super) fn follow(&mut self, search: &Search<'_>, hint: &[Choice]) -> Result<(), BestError> {
        let mut node = 0;
        for choice in hint {
            if self.interrupted || self.nodes[node].ended {
                break;
            }
            if let Some(next) = self.child(node, choice) {
                node = next;
                continue;
            }
            if *choice != Choice::Skip && self.trials >= search.limits.trials {
                break;
            }
            self.look(search, &[node])?;
            let it = &mut self.nodes[node];
            let Some(offers) = &mut it.offers else {
                break;
            };
            let place = match offers.choices.iter().position(|other| other.does(choice)) {
                Some(place) => place,
                // Where the camera finds nothing, a rollout ends without a score.
                None if *choice == Choice::Skip => break,
                None => {
                    offers.choices.push(choice.clone());
                    offers.choices.len() - 1
                }
            };
            if place >= it.tried {
                offers.choices[it.tried..=place].rotate_right(1);
                let choice = it.tried;
                self.make(search, &[Due { node, choice }])?;
            }
            let Some(next) = self.child(node, choice) else {
                break;
            };
            node = next;
        }
        Ok(())
    }

    /// Returns the state that a choice led to from another.
    fn child(&self, node: usize, choice: &Choice) -> Option<usize> {
        let is_next = |next: &Node| {
            next.parent == Some(node) && next.choice.as_ref().is_some_and(|it| it.does(choice))
        };
        self.nodes.iter().position(is_next)
    }

    /// Returns the choices that lead to the best state of all and then skip all steps, where the task skips steps: a cloth
    /// that more actions would spoil can be left as it is.
    fn best_and_then_skipped(&self, search: &Search<'_>) -> Option<Vec<Choice>> {
        if search.program.verify.exhausted != Exhausted::Skips {
            return None;
        }
        let best = self.best_of(&mut (0..self.nodes.len()).filter(|&node| self.has_acted(node)))?;
        let path = self.path(best).into_iter();
        let taken = path.filter_map(|node| self.nodes[node].choice.clone());
        let skipped = std::iter::repeat_n(Choice::Skip, search.steps() as usize);
        Some(taken.chain(skipped).collect())
    }

    /// Goes through all depths with more and more states, until everything was tried, as many as the beam is wide, or
    /// `trials` more trials were made. Then it skips what is left after the best state, where the task skips steps.
    pub(super) fn widen(&mut self, search: &Search<'_>, trials: u32) -> Result<(), BestError> {
        let most = self.trials.saturating_add(trials);
        let mut width = 1;
        loop {
            self.pass(search, width, most)?;
            let is_widest = width >= search.limits.beam;
            if self.interrupted || is_widest || self.trials >= most || self.is_exhausted() {
                break;
            }
            width = (width * 2).min(search.limits.beam);
        }
        let Some(choices) = self.best_and_then_skipped(search) else {
            return Ok(());
        };
        // It tries nothing and only lists what could be, so it is done after an interrupt too: the best state that was found
        // is the result.
        let was_interrupted = std::mem::take(&mut self.interrupted);
        let search = Search {
            interrupt: &Interrupt::default(),
            ..*search
        };
        let followed = self.follow(&search, &choices);
        self.interrupted |= was_interrupted;
        followed
    }

    /// Goes through all depths once.
    fn pass(&mut self, search: &Search<'_>, width: u32, most: u32) -> Result<(), BestError> {
        let actions = search
            .steps()
            .saturating_mul(search.program.actions_per_step());
        let first = self.nodes[0].tries.number;
        for depth in first..actions {
            let left = most.saturating_sub(self.trials);
            // What is left is shared with the depths that follow. No more states are looked at than can get a trial.
            let share = left.div_ceil(actions - depth);
            let mut beam = self.beam(depth, width);
            if left == 0 || beam.is_empty() {
                return Ok(());
            }
            beam.retain(|&node| !self.nodes[node].is_tried_out());
            beam.truncate(share as usize);
            self.look(search, &beam)?;
            let due = self.due(&beam, share as usize);
            self.make(search, &due)?;
            self.forget(depth + 1, search.limits.beam);
            if self.interrupted {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Returns the most promising states of a depth that do not end a rollout.
    fn beam(&self, depth: u32, width: u32) -> Vec<usize> {
        let mut beam = self.ranked(depth);
        beam.retain(|&node| !self.nodes[node].ended);
        beam.truncate(width as usize);
        beam
    }

    /// Returns the states of a depth, the most promising first: those with most steps done, since a retry must act again
    /// on a step that may be good already.
    fn ranked(&self, depth: u32) -> Vec<usize> {
        let at_depth = |node: &usize| self.nodes[*node].tries.number == depth;
        let mut nodes: Vec<usize> = (0..self.nodes.len()).filter(at_depth).collect();
        nodes.sort_by(|&a, &b| {
            let [a, b] = [a, b].map(|node| &self.nodes[node]);
            let done = b.tries.done.cmp(&a.tries.done);
            done.then(a.behind.total_cmp(&b.behind))
        });
        nodes
    }

    /// Lists what can be done in states.
    fn look(&mut self, search: &Search<'_>, nodes: &[usize]) -> Result<(), BestError> {
        let unseen: Vec<usize> = nodes
            .iter()
            .copied()
            .filter(|&node| self.nodes[node].offers.is_none())
            .collect();
        let tree = &*self;
        let looked = in_parallel(
            unseen.len(),
            search.limits.threads,
            |index| unless_stopped(tree.offers_at(search, unseen[index])),
            |_| {},
        )?;
        for (node, looked) in unseen.into_iter().zip(looked) {
            match looked {
                Some((offers, state)) => {
                    self.nodes[node].offers = Some(offers);
                    self.nodes[node].state = Some(state);
                }
                None => self.interrupted = true,
            }
        }
        Ok(())
    }

    fn offers_at(&self, search: &Search<'_>, node: usize) -> Result<(Offers, Snapshot), BestError> {
        let (mut world, state) = self.world_at(search, node)?;
        let view = match self.scene_at(search, node, &mut world) {
            Ok(view) => view,
            // The rollout would end here, without a score.
            Err(BestError::Scene(
                SceneError::OutOfView { .. } | SceneError::NoCandidates { .. },
            )) if self.nodes[node].tries.number > 0 => {
                return Ok((Offers::default(), state));
            }
            Err(error) => return Err(error),
        };
        let (scene, observation) = view;
        let at = &self.nodes[node];
        let step = self.step_of(search, node);
        let situation = Situation {
            program: search.program,
            scene: &scene,
            observation: &observation,
            step,
            last: at.last.as_ref(),
            wanted: self.aim.wanted(&state.positions, step - 1),
            draw: format!("offered actions {} {}", search.limits.seed, at.key),
            interrupt: search.interrupt,
        };
        Ok((offers::offers(&situation)?, state))
    }

    /// Returns the scene of a state, as a rollout finds it there, and what the camera shows.
    pub(super) fn scene_at(
        &self,
        search: &Search<'_>,
        node: usize,
        world: &mut SimulatedWorld,
    ) -> Result<(Scene, Observation), BestError> {
        let observation = world.observe()?;
        let first = (self.nodes[node].tries.number > 0).then_some(&self.first);
        let scene = Scene::of(search.program, &observation, first)?;
        Ok((scene, observation))
    }

    /// Returns the task's step that is due in a state, from 1.
    pub(super) fn step_of(&self, search: &Search<'_>, node: usize) -> u32 {
        let step = self.nodes[node].tries.step(search.steps());
        step.unwrap_or(search.steps())
    }

    /// Lays the cloth as it is in a state; where that is not kept, its actions are executed again.
    pub(super) fn world_at(
        &self,
        search: &Search<'_>,
        node: usize,
    ) -> Result<(SimulatedWorld, Snapshot), BestError> {
        let mut again = Vec::new();
        let mut at = node;
        let state = loop {
            let it = &self.nodes[at];
            if let Some(state) = &it.state {
                break state;
            }
            if let Some(Choice::Act { action, .. }) = &it.choice {
                again.push(action.grip);
            }
            at = it.parent.expect("the start's state is always kept");
        };
        let mut world = (search.make_world)()?;
        world.go_to(search.start, state)?;
        for grip in again.into_iter().rev() {
            world.act(&grip.into(), search.interrupt)?;
        }
        let state = world.state()?;
        Ok((world, state))
    }

    /// Lists the trials of a beam that are due: the first choice of each state, then the second, and so on.
    fn due(&self, beam: &[usize], most: usize) -> Vec<Due> {
        let untried = |node: usize| {
            let it = &self.nodes[node];
            let count = it.offers.as_ref().map_or(0, |offers| offers.choices.len());
            it.tried..count
        };
        let mut due = Vec::new();
        let ranks = beam.iter().map(|&node| untried(node).end).max();
        for choice in 0..ranks.unwrap_or_default() {
            let with_it = beam.iter().filter(|&&node| untried(node).contains(&choice));
            due.extend(with_it.map(|&node| Due { node, choice }));
        }
        due.truncate(most);
        due
    }

    /// Makes the trials that are due, and adds the states that they lead to.
    fn make(&mut self, search: &Search<'_>, due: &[Due]) -> Result<(), BestError> {
        let moves = |due: &&Due| {
            let offers = self.nodes[due.node].offers.as_ref();
            offers.is_some_and(|offers| offers.choices[due.choice] != Choice::Skip)
        };
        let mut begun: Vec<usize> = due.iter().filter(moves).map(|due| due.node).collect();
        begun.sort_unstable();
        begun.dedup();
        let worlds = begun
            .iter()
            .map(|&node| Ok(self.world_at(search, node)?.0))
            .collect::<Result<Vec<_>, BestError>>();
        let Some(worlds) = unless_stopped(worlds)? else {
            self.interrupted = true;
            return Ok(());
        };
        let mut planned: Vec<Planned> = due.iter().map(|&due| self.planned(search, due)).collect();
        let mut trials = Vec::new();
        for (index, planned) in planned.iter().enumerate() {
            if let (None, Choice::Act { action, .. }) = (&planned.record, &planned.choice) {
                let world = begun.binary_search(&planned.due.node).unwrap_or_default();
                trials.push((
                    index,
                    Trial {
                        from: &worlds[world],
                        grip: action.grip,
                    },
                ));
            }
        }
        let so_far = AtomicU32::new(self.trials + (due.len() - trials.len()) as u32);
        let (indices, trials): (Vec<usize>, Vec<Trial<'_>>) = trials.into_iter().unzip();
        let tree = &*self;
        let done = try_motions(
            &trials,
            search.limits.threads,
            search.interrupt,
            |index, end| {
                let judged = tree.judged(search, &planned[indices[index]], end);
                (search.progress)(so_far.fetch_add(1, Ordering::Relaxed) + 1);
                judged
            },
        )?;
        for (index, done) in indices.into_iter().zip(done) {
            if let Some((record, state)) = done {
                planned[index].record = Some(record);
                planned[index].state = Some(state);
            }
        }
        for planned in planned {
            self.add(search, planned);
        }
        Ok(())
    }

    /// Looks a due trial up; what was skipped needs no trial.
    fn planned(&self, search: &Search<'_>, due: Due) -> Planned {
        let node = &self.nodes[due.node];
        let offers = node
            .offers
            .as_ref()
            .expect("only states that were looked at have trials due");
        let choice = offers.choices[due.choice].clone();
        let step = match &choice {
            Choice::Act { action, .. } => key_of(&action.grip),
            Choice::Skip => "skip".to_owned(),
        };
        let key = Cache::key([node.key.as_str(), step.as_str()])[..32].to_owned();
        let known = search.journal.and_then(|journal| journal.known(&key));
        Planned {
            record: known.cloned(),
            is_known: known.is_some(),
            state: None,
            due,
            choice,
            key,
        }
    }

    /// Measures what a trial led to, and keeps it in the journal.
    fn judged(
        &self,
        search: &Search<'_>,
        planned: &Planned,
        end: TrialEnd,
    ) -> Result<(TrialRecord, Snapshot), BestError> {
        let step = self.step_of(search, planned.due.node);
        let positions = &end.state.positions;
        let result = self.result(search, step, &end.state)?;
        let record = TrialRecord {
            grasp: end.executed.grips[0].grasp,
            value: self.aim.value(positions),
            behind: self.aim.behind(positions, step),
            result,
        };
        if let Some(journal) = search.journal {
            journal.keep(&planned.key, &record)?;
        }
        Ok((record, end.state))
    }

    /// Compares a state with the subgoal of its step, as a rollout does.
    pub(super) fn result(
        &self,
        search: &Search<'_>,
        step: u32,
        state: &Snapshot,
    ) -> Result<Option<StepResult>, BestError> {
        if search.program.verify.result.is_none() {
            return Ok(None);
        }
        let mut world = (search.make_world)()?;
        world.go_to(search.start, state)?;
        let after = world.observe()?;
        let result = StepResult::of(search.program, search.subgoals, step, &self.first, &after);
        Ok(result?)
    }

    /// Adds the state that a trial led to; none where it was stopped, or cannot be measured.
    fn add(&mut self, search: &Search<'_>, planned: Planned) {
        let Planned {
            due,
            choice,
            key,
            record,
            is_known,
            state,
        } = planned;
        let parent = &self.nodes[due.node];
        let mut tries = parent.tries;
        tries.number += 1;
        let most = search.program.actions_per_step();
        let node = match (&choice, record) {
            (Choice::Act { .. }, None) => {
                self.interrupted = true;
                return;
            }
            (Choice::Skip, _) => {
                tries.after(most, None);
                Some((parent.value, parent.behind, parent.last.clone(), None))
            }
            (
                Choice::Act {
                    proposal, action, ..
                },
                Some(record),
            ) => {
                tries.after(most, record.result);
                self.trials += 1;
                self.known += u32::from(is_known);
                let last = ExecutedAction {
                    proposal: proposal.clone(),
                    pick: action.pick_on_cloth_px,
                    place: action.place_px,
                };
                let measured = record.value.zip(record.behind);
                measured.map(|(value, behind)| (value, behind, Some(last), Some(record.grasp)))
            }
        };
        // Choices are tried in their order; after a stop, none is tried any more.
        self.nodes[due.node].tried = due.choice + 1;
        let Some((value, behind, last, grasp)) = node else {
            return;
        };
        self.nodes.push(Node {
            parent: Some(due.node),
            grasp,
            key,
            last,
            state,
            value,
            behind,
            ended: tries.step(search.steps()).is_none() || self.aim.ends(search, value),
            offers: None,
            tried: 0,
            choice: Some(choice),
            tries,
        });
    }

    /// Forgets the cloths of a depth that no pass will go on from, since others are more promising.
    fn forget(&mut self, depth: u32, beam: u32) {
        let mut kept = 0;
        for node in self.ranked(depth) {
            let it = &mut self.nodes[node];
            if it.ended || kept == beam {
                it.state = None;
            } else {
                kept += 1;
            }
        }
    }

    fn is_exhausted(&self) -> bool {
        !self.interrupted && self.nodes.iter().all(|node| node.is_exhausted())
    }

    /// Returns what was found so far.
    pub(super) fn found(&self, search: &Search<'_>) -> Found {
        let all = 0..self.nodes.len();
        let best = self.best_end();
        let deepest = self.nodes.iter().map(|node| node.tries.number).max();
        let deepest = deepest.unwrap_or_default();
        let after = (self.nodes[0].tries.number + 1..=deepest).filter_map(|actions| {
            let is_there = |node: &usize| {
                let it = &self.nodes[*node];
                let number = it.tries.number;
                number == actions || it.ended && number < actions
            };
            let has_acted = |node: &usize| is_there(node) && self.has_acted(*node);
            let best = self.best_of(&mut all.clone().filter(has_acted));
            let best = best.or_else(|| self.best_of(&mut all.clone().filter(is_there)))?;
            Some(self.nodes[best].value)
        });
        let after = after.collect();
        let under_way = match best {
            Some(_) => None,
            None => self.ranked(deepest).first().copied(),
        };
        let offers = self.nodes.iter().filter_map(|node| node.offers.as_ref());
        let mut sampled: Vec<String> = offers
            .clone()
            .flat_map(|offers| offers.sampled.iter().cloned())
            .collect();
        sampled.sort();
        sampled.dedup();
        Found {
            measure: self.aim.measure,
            untouched: self.nodes[0].value,
            best: best.map(|node| self.taken(search, node)),
            after,
            under_way: under_way.map_or(Vec::new(), |node| self.taken(search, node)),
            trials: self.trials,
            known: self.known,
            exhausted: self.is_exhausted(),
            sampled,
            refused: offers.clone().map(|offers| offers.refused).sum(),
            unreadable: offers.map(|offers| offers.unreadable).sum(),
            interrupted: self.interrupted,
        }
    }

    /// Returns the best state that ends a rollout.
    pub(super) fn best_end(&self) -> Option<usize> {
        // A rollout whose steps were all skipped has no score.
        let is_end =
            |node: &usize| self.nodes[*node].ended && (*node == 0 || self.has_acted(*node));
        self.best_of(&mut (0..self.nodes.len()).filter(is_end))
    }

    /// Returns whether an action led to a state.
    fn has_acted(&self, node: usize) -> bool {
        self.nodes[node].last.is_some()
    }

    /// Returns the best of some states; of equals, the one that was found first.
    fn best_of(&self, nodes: &mut dyn Iterator<Item = usize>) -> Option<usize> {
        let loss = |node: usize| self.aim.measure.loss(self.nodes[node].value);
        nodes.reduce(|best, node| if loss(node) < loss(best) { node } else { best })
    }

    /// Returns the steps from the start to a state.
    fn taken(&self, search: &Search<'_>, node: usize) -> Vec<Taken> {
        let steps = self.path(node).into_iter().filter_map(|node| {
            let it = &self.nodes[node];
            Some(Taken {
                step: self.step_of(search, it.parent?),
                choice: it.choice.clone()?,
                grasp: it.grasp,
                value: it.value,
                behind: it.behind,
            })
        });
        steps.collect()
    }

    /// Returns the states from the start to one, both included.
    pub(super) fn path(&self, node: usize) -> Vec<usize> {
        let mut path: Vec<usize> =
            std::iter::successors(Some(node), |&node| self.nodes[node].parent).collect();
        path.reverse();
        path
    }
}

/// A trial that is due, and what is known of it.
struct Planned {
    due: Due,
    choice: Choice,
    key: String,
    /// What it led to; `None` until it is known.
    record: Option<TrialRecord>,
    /// Whether the journal knew that.
    is_known: bool,
    state: Option<Snapshot>,
}

impl Node {
    fn is_exhausted(&self) -> bool {
        let is_sampled = |offers: &Offers| !offers.sampled.is_empty();
        self.ended || self.is_tried_out() && !self.offers.as_ref().is_some_and(is_sampled)
    }

    /// Returns whether every choice that is listed was tried.
    fn is_tried_out(&self) -> bool {
        let offers = self.offers.as_ref();
        offers.is_some_and(|offers| self.tried == offers.choices.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::best::Limits;
    use crate::subgoals::SubgoalSet;
    use fab_compiler::{LoadError, Loader};
    use fab_world::start::Start;

    const PULLS: &str = r#"
task pulls {
    cloth  grid(8, 8)
    goal   coverage > 1
    horizon 2
    camera top_down(height: 650mm, fov: 45deg, image: 224px)
    picker drop
    keypoints { cloth = mask(depth < 649mm) }
    actions {
        pick:      any of cloth
        direction: one of 0deg
        distance:  one of 0.25edge
    }
    stage act {
        model vision
        show  scene
        say   "Pull {{ pick.choices }}. {{ actions.format }}"
        read  action
    }
    verify { attempts 2, else skip }
}
"#;

    struct Text;

    impl Loader for Text {
        fn load(&self, _: &str) -> Result<String, LoadError> {
            Ok(PULLS.to_owned())
        }
    }

    #[test]
    fn decisions_are_followed_only_where_a_rollout_goes_on_and_trials_are_left() {
        let compiled = fab_compiler::compile("pulls.fab", &Text).expect("a task that compiles");
        let program = compiled.programs.first().expect("a task");
        let make_world = || SimulatedWorld::of(program);
        let search = Search {
            program,
            start: &Start::flat(&program.cloth),
            subgoals: &SubgoalSet::none(),
            make_world: &make_world,
            cache: &Cache::none(),
            horizon: None,
            limits: Limits {
                trials: 1,
                beam: 1,
                seed: 0,
                threads: 1,
            },
            hints: &[],
            journal: None,
            interrupt: &Interrupt::default(),
            progress: &|_| {},
        };
        let mut tree = Tree::at_start(&search).expect("a search that works");
        // As if it was not flat enough.
        tree.nodes[0].ended = false;
        tree.look(&search, &[0]).expect("a search that works");
        let offers = tree.nodes[0].offers.take().expect("a state that was seen");
        let pull = offers.choices[0].clone();

        // The camera finds nothing.
        tree.nodes[0].offers = Some(Offers::default());
        tree.follow(&search, &[Choice::Skip])
            .expect("a search that works");
        assert_eq!(tree.nodes.len(), 1);

        // The second pull is one more than the trials.
        tree.nodes[0].offers = Some(offers);
        tree.follow(&search, std::slice::from_ref(&pull))
            .expect("a search that works");
        tree.nodes[1].ended = false;
        tree.follow(&search, &[pull.clone(), pull])
            .expect("a search that works");
        assert_eq!((tree.nodes.len(), tree.trials), (2, 1));
        assert!(tree.nodes[1].offers.is_none());

        // A search that begins anywhere ends with skipped steps.
        tree.widen(&search, 0).expect("a search that works");
        assert!(tree.best_end().is_some());
    }
}
