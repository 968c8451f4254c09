//! Tries actions that the action space leaves out, to find one that would have led to a better end.
//!
//! In: a finished search. Out: a pick or place on a named point of the cloth that no field offers there, with the end
//! that it leads to when the task's own actions follow. The points are the corners, middles and quarters of the flat
//! cloth, and the table's middle; they are tried in tasks that are scored against experts and name a pick and a place.
//! In tasks that name directions and lengths, values between the offered ones are tried. The task's checks hold for all of it.

use super::aim::Aim;
use super::between::between;
use super::offers::{self, Situation};
use super::tree::{Node, Tree};
use super::{BestError, Choice, Found, Limits, Search, key_of, unless_stopped};
use crate::action::candidate;
use crate::scene::Scene;
use fab_base::cache::Cache;
use fab_picture::observation::Observation;
use fab_program::facts::ExecutedAction;
use fab_program::scene::SceneView;
use fab_program::{Choices, ClothPoint, Fold, Metric, PixelPoint, Proposal, Value, space, verify};
use fab_world::simulated::trials::{Trial, TrialEnd, try_motions};
use fab_world::{Motion, SimulatedWorld, WorldPoint, expert};
use serde::Serialize;
use std::sync::Arc;

/// How far a point must be from every offered one to count as not offered, pixels of a 224 px picture.
const NEAR_PX: f64 = 12.0;
/// The most actions tried in one step.
const MOST_A_STEP: usize = 24;
/// How many of them are followed to the end.
const FOLLOWED: usize = 2;
/// How many states of a depth are gone on from after such an action.
const BEAM: u32 = 2;
/// Where named points lie along a side of the flat cloth.
const ALONG: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// An action that is not offered and better than the best offered one.
#[derive(Clone, Debug)]
pub struct Better {
    /// Index of the action that it replaces.
    pub index: usize,
    /// The task's step, from 1.
    pub step: u32,
    /// What would have to be offered.
    pub lacking: Lacking,
    /// What it leads to: at the end, the measure of results; after the step, the distance to the experts' state then, or
    /// the measure of results where nobody demonstrates the way.
    pub value: f64,
    /// The same at that time with the best offered action.
    pub instead_of: f64,
    /// When both are measured.
    pub measured: Measured,
}

/// What an action space lacks.
#[derive(Clone, Debug)]
pub enum Lacking {
    /// A point.
    Point {
        /// The field that does not offer it: `pick` or `place`.
        field: &'static str,
        /// The point on the cloth.
        point: ClothPoint,
        /// Where it is in the picture.
        at: PixelPoint,
        /// The scene in which it is not offered.
        scene: Box<Scene>,
    },
    /// A direction, a length, or both: each field with all that it would offer then.
    Values(Vec<(String, Choices)>),
}

/// When something is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measured {
    /// After the step itself.
    AfterStep,
    /// At the end of the rollout, with the task's own actions in the steps that follow.
    AtEnd,
}

/// What came of trying.
#[derive(Clone, Debug, Default)]
pub struct Unoffered {
    /// The best one, if any is better than the best offered actions.
    pub better: Option<Better>,
    /// Trials of actions that are not offered, and of those that follow.
    pub trials: u32,
    /// Whether an interrupt ended the trials.
    pub interrupted: bool,
}

/// Counts these trials, up to a limit.
#[derive(Debug)]
pub(super) struct Allowance {
    made: u32,
    most: u32,
}

impl Allowance {
    /// Returns how many more may be made.
    pub fn left(&self) -> usize {
        self.most.saturating_sub(self.made) as usize
    }

    /// Notes that so many were made, at most [`Allowance::left`], and reports it.
    pub fn spend(&mut self, trials: usize, search: &Search<'_>) {
        self.made = self.made.saturating_add(trials as u32);
        (search.progress)(self.made);
    }

    /// Returns whether no more are to be made.
    pub fn ends(&self, search: &Search<'_>) -> bool {
        self.left() == 0 || search.interrupt.is_raised()
    }
}

/// A point of the cloth where it lies in a state.
#[derive(Clone, Copy)]
struct Named {
    point: ClothPoint,
    at: PixelPoint,
    world: WorldPoint,
}

/// An action to be tried.
struct Candidate {
    motion: Motion,
    proposal: Proposal,
    ends_px: [PixelPoint; 2],
    field: &'static str,
    named: Named,
}

/// Tries actions that are not offered in the steps of the best actions, with at most `trials` trials.
///
/// After an interrupt, what was found until then is returned. `search.progress` is called with the number of these trials.
pub fn unoffered(
    search: &Search<'_>,
    tree: &Tree,
    found: &Found,
    trials: u32,
) -> Result<Unoffered, BestError> {
    let mut allowance = Allowance {
        made: 0,
        most: trials,
    };
    let has = |field: &str| search.program.field(field).is_some();
    let better = match has("direction") && has("distance") {
        true => between(search, tree, found, &mut allowance)?,
        false => points(search, tree, found, &mut allowance)?,
    };
    Ok(Unoffered {
        better,
        trials: allowance.made,
        interrupted: search.interrupt.is_raised(),
    })
}

/// Tries points that are not offered, and returns the best action with one.
fn points(
    search: &Search<'_>,
    tree: &Tree,
    found: &Found,
    allowance: &mut Allowance,
) -> Result<Option<Better>, BestError> {
    let has_field = |name: &str| search.program.field(name).is_some();
    let by_points = has_field("pick") && has_field("place");
    if found.measure.metric != Metric::ParticleDistance || !by_points {
        return Ok(None);
    }
    let (Some(best), Some(end)) = (found.value(), tree.best_end()) else {
        return Ok(None);
    };
    let path = tree.path(end);
    let mut steps = Vec::new();
    for index in 0..path.len() - 1 {
        let step = StepAt {
            search,
            tree,
            node: path[index],
            offered: &tree.nodes[path[index + 1]],
            index,
        };
        match unless_stopped(step.look())? {
            Some(look) => steps.extend(look.map(|look| (step, look))),
            None => break,
        }
    }
    // First where what is not offered is most nearer to what an expert would do.
    steps.sort_by(|a, b| b.1.nearer_m.total_cmp(&a.1.nearer_m));
    let mut best_step: Option<Better> = None;
    for (step, look) in &steps {
        if allowance.ends(search) {
            break;
        }
        let better = unless_stopped(step.better(look, best, allowance))?.flatten();
        let least = best_step
            .as_ref()
            .map_or(best - found.measure.least_gain(), |better| better.value);
        if let Some(better) = better.filter(|better| better.value < least) {
            best_step = Some(better);
        }
    }
    Ok(best_step)
}

/// What could be tried in a step.
struct Look {
    world: SimulatedWorld,
    scene: Scene,
    /// Those nearest to what an expert would do first.
    candidates: Vec<Candidate>,
    /// How much nearer the first is to that than the best offered action, metres.
    nearer_m: f64,
}

/// A step of the best actions.
struct StepAt<'s> {
    search: &'s Search<'s>,
    tree: &'s Tree,
    /// The state before it.
    node: usize,
    /// The state after the best offered action.
    offered: &'s Node,
    index: usize,
}

impl StepAt<'_> {
    /// Lists what is not offered in the step; `None` if nothing could be tried.
    fn look(&self) -> Result<Option<Look>, BestError> {
        let StepAt { search, tree, .. } = *self;
        let step = tree.step_of(search, self.node);
        let (mut world, state) = tree.world_at(search, self.node)?;
        let (scene, observation) = tree.scene_at(search, self.node, &mut world)?;
        let wanted = tree.aim.wanted(&state.positions, step - 1);
        let at = Situation {
            program: search.program,
            scene: &scene,
            observation: &observation,
            step,
            last: tree.nodes[self.node].last.as_ref(),
            wanted: Vec::new(),
            draw: String::new(),
            interrupt: search.interrupt,
        };
        let Some(Choice::Act { action, .. }) = &self.offered.choice else {
            return Ok(None);
        };
        let mut candidates = Vec::new();
        for candidate in self.candidates(&wanted, &state.positions, &scene, &observation) {
            if candidates.len() == MOST_A_STEP || search.interrupt.is_raised() {
                break;
            }
            if offers::refusing(&at, &candidate.proposal, verify::checks)?.is_some() {
                candidates.push(candidate);
            }
        }
        let Some(first) = candidates.first() else {
            return Ok(None);
        };
        let nearer_m = Aim::off(&wanted, &action.motion) - Aim::off(&wanted, &first.motion);
        Ok(Some(Look {
            world,
            scene,
            candidates,
            nearer_m,
        }))
    }

    /// Tries what is not offered, and follows the best of it to the end.
    fn better(
        &self,
        look: &Look,
        best: f64,
        allowance: &mut Allowance,
    ) -> Result<Option<Better>, BestError> {
        let StepAt { search, tree, .. } = *self;
        let step = tree.step_of(search, self.node);
        // Half of the trials are for what follows the best of them.
        let first = look.candidates.len().min(allowance.left().div_ceil(2));
        let candidates = &look.candidates[..first];
        let due: Vec<Trial<'_>> = candidates
            .iter()
            .map(|candidate| Trial {
                from: &look.world,
                motion: candidate.motion,
            })
            .collect();
        let done = try_motions(
            &due,
            search.limits.threads,
            search.interrupt,
            |_, end| -> Result<_, BestError> {
                Ok((tree.aim.behind(&end.state.positions, step), end))
            },
        )?;
        allowance.spend(done.iter().flatten().count(), search);
        let least_gain = tree.aim.measure.least_gain();
        let mut promising: Vec<(f64, usize, TrialEnd)> = done
            .into_iter()
            .enumerate()
            .filter_map(|(index, done)| {
                let (behind, end) = done?;
                Some((behind?, index, end))
            })
            .filter(|(behind, ..)| *behind < self.offered.behind - least_gain)
            .collect();
        promising.sort_by(|a, b| a.0.total_cmp(&b.0));
        promising.truncate(FOLLOWED);
        let mut better: Option<Better> = None;
        for (behind, index, end) in promising {
            let candidate = &candidates[index];
            let Some(value) = self.end_of(candidate, behind, end, allowance)? else {
                continue;
            };
            if better.as_ref().is_none_or(|better| value < better.value) {
                better = Some(Better {
                    index: self.index,
                    step,
                    lacking: Lacking::Point {
                        field: candidate.field,
                        point: candidate.named.point,
                        at: candidate.named.at,
                        scene: Box::new(look.scene.clone()),
                    },
                    value,
                    instead_of: best,
                    measured: Measured::AtEnd,
                });
            }
        }
        Ok(better)
    }

    /// Returns the measure at the end when the task's own actions follow; `None` if no rollout ends.
    fn end_of(
        &self,
        candidate: &Candidate,
        behind: f64,
        after: TrialEnd,
        allowance: &mut Allowance,
    ) -> Result<Option<f64>, BestError> {
        let StepAt { search, tree, .. } = *self;
        let before = &tree.nodes[self.node];
        let step = tree.step_of(search, self.node);
        let result = tree.result(search, step, &after.state)?;
        let mut tries = before.tries;
        tries.number += 1;
        tries.after(search.program.actions_per_step(), result);
        let Some(value) = tree.aim.value(&after.state.positions) else {
            return Ok(None);
        };
        let [pick, place] = candidate.ends_px;
        let motion = key_of(&candidate.motion);
        let root = Node {
            parent: None,
            choice: None,
            grasp: Some(after.executed.grasp),
            key: Cache::key([before.key.as_str(), "not offered", &motion])[..32].to_owned(),
            last: Some(ExecutedAction {
                proposal: candidate.proposal.clone(),
                pick,
                place,
            }),
            state: Some(after.state),
            value,
            behind,
            ended: tries.step(search.steps()).is_none(),
            tries,
            offers: None,
            tried: 0,
        };
        if root.ended {
            return Ok(Some(value));
        }
        let follow = Search {
            limits: Limits {
                beam: BEAM,
                ..search.limits
            },
            progress: &|_| {},
            ..*search
        };
        let mut tree = Tree::from(root, Arc::clone(&tree.aim), tree.first.clone());
        tree.widen(&follow, allowance.left() as u32)?;
        allowance.spend(tree.trials as usize, search);
        Ok(tree.best_end().map(|end| tree.nodes[end].value))
    }

    /// Lists actions with one end that is not offered, those nearest to what an expert would do first.
    fn candidates(
        &self,
        wanted: &[(f64, [WorldPoint; 2])],
        positions: &[[f32; 3]],
        scene: &Scene,
        observation: &Observation,
    ) -> Vec<Candidate> {
        let program = self.search.program;
        let limit_px = NEAR_PX * f64::from(program.camera.image_px) / 224.0;
        let offered = |name: &str| -> Vec<(PixelPoint, WorldPoint)> {
            let field = program.field(name);
            let values = field.map_or(Vec::new(), |field| space::choices(field, scene));
            let points = values.iter().filter_map(|value| match value {
                Value::Point(pixel) => Some(*pixel),
                _ => None,
            });
            points
                .filter_map(|pixel| Some((pixel, candidate(name, pixel, scene, observation)?)))
                .collect()
        };
        let [mut picks, mut places] = ["pick", "place"].map(offered);
        // The pixels of a mask are not listed: the best of them stands for all.
        if let Some(Choice::Act { action, .. }) = &self.offered.choice {
            if picks.is_empty() {
                picks.push((action.pick_px, action.motion.pick));
            }
            if places.is_empty() {
                places.push((action.place_px, action.motion.place));
            }
        }
        let named = self.named(positions, observation);
        // Of the other fields, the best offered action's values stay.
        let manner = match &self.offered.choice {
            Some(Choice::Act { action, .. }) => action.motion.manner,
            _ => program.manner,
        };
        let chosen = match &self.offered.choice {
            Some(Choice::Act { proposal, .. }) => proposal.fields.as_slice(),
            _ => &[],
        };
        let is_point = |name: &str| name == "pick" || name == "place";
        let others = chosen.iter().filter(|(name, _)| !is_point(name));
        let others: Vec<(String, Value)> = others.cloned().collect();
        let is_offered = |name: &str, at: PixelPoint, offered: &[(PixelPoint, WorldPoint)]| {
            let nearest_px = match program.field(name).map(|field| &field.choices) {
                Some(Choices::Region { mask }) => scene.distance_px(mask, at),
                _ => {
                    let all = offered.iter().map(|(pixel, _)| pixel.distance_px(at));
                    all.reduce(f64::min)
                }
            };
            nearest_px.is_some_and(|nearest_px| nearest_px <= limit_px)
        };
        let mut all = Vec::new();
        let mut add = |field,
                       named: Named,
                       pick: (PixelPoint, WorldPoint),
                       place: (PixelPoint, WorldPoint)| {
            let points = [("pick", pick.0), ("place", place.0)]
                .map(|(name, pixel)| (name.to_owned(), Value::Point(pixel)));
            all.push(Candidate {
                motion: Motion::new(pick.1, place.1).with_manner(manner),
                proposal: Proposal {
                    fields: points.into_iter().chain(others.iter().cloned()).collect(),
                },
                ends_px: [pick.0, place.0],
                field,
                named,
            });
        };
        for point in &named {
            let own = (point.at, point.world);
            if !is_offered("place", point.at, &places) {
                picks
                    .iter()
                    .for_each(|&pick| add("place", *point, pick, own));
            }
            if !is_offered("pick", point.at, &picks) {
                places
                    .iter()
                    .for_each(|&place| add("pick", *point, own, place));
            }
        }
        let off = |candidate: &Candidate| Aim::off(wanted, &candidate.motion);
        all.retain(|candidate| candidate.motion.pick != candidate.motion.place);
        all.sort_by(|a, b| off(a).total_cmp(&off(b)));
        all
    }

    /// Returns the named points of the cloth that the camera could see.
    fn named(&self, positions: &[[f32; 3]], observation: &Observation) -> Vec<Named> {
        let start = self.search.start;
        let particles = ALONG.iter().flat_map(|&right| {
            let point = move |&front: &f64| ClothPoint::Particle { right, front };
            ALONG.iter().map(point)
        });
        let all = particles.chain([ClothPoint::Center]);
        let named = all.filter_map(|point| {
            // The pick of a fold from the point to itself is where the point is.
            let fold = Fold {
                pick: point,
                place: point,
                fraction: 1.0,
            };
            let world = expert::motion_of(&fold, start, positions)?.pick;
            let [column, row] = observation.camera.pixel_from_world(world)?;
            let at = PixelPoint::new(column.floor() as i32, row.floor() as i32);
            Some(Named { point, at, world })
        });
        named.collect()
    }
}
