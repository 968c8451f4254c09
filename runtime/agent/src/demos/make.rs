//! Makes demonstrations of a task: the scripted expert folds, and the answers that a model would have given are
//! recorded.
//!
//! In: a program and a world. Out: whole demonstrations, each from its own start. Every answer is one that the program
//! offers and its verifier accepts; a start without such answers is discarded and another one drawn.

use super::words::{self, NamedPoint};
use super::{DEMOS_FORMAT, Demo, DemoStep, Header};
use crate::action::Action;
use crate::scene::Scene;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_picture::observation::Observation;
use fab_program::Proposal;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::scene::SceneView;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{Choices, Fold, PixelPoint, Program, Read, Subgoals, Value};
use fab_world::expert;
use fab_world::expert::MakeWorld;
use fab_world::start::{RESTING_HEIGHT_M, Start};
use fab_world::{World, WorldError, WorldPoint};
use std::collections::BTreeMap;

/// Most starts tried for each requested demonstration.
const TRIES: u32 = 10;

/// The longer side of demonstrated cloths, particles; the paper tests with 50 to 59, and a larger cloth leaves the
/// picture when turned.
const SIDES: std::ops::RangeInclusive<u32> = 44..=59;

/// An offered point stands for the expert's point if closer than this share of the picture's side.
const NEAR: f64 = 0.05;

/// What to make.
pub struct DemoRequest<'a> {
    /// The task; it names the stage that shows the demonstrations.
    pub program: &'a Program,
    /// How many demonstrations to make.
    pub count: u32,
    /// Draws the starts.
    pub seed: u64,
    /// Makes the world in which the expert folds.
    pub make_world: &'a MakeWorld<'a>,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
}

/// Why there are no demonstrations.
#[derive(Debug, thiserror::Error)]
pub enum MakeError {
    /// The task cannot be demonstrated.
    #[error("{0}")]
    Task(String),
    /// Too few starts led to accepted answers.
    #[error(
        "only {made} of {wanted} demonstrations were made from {tried} starts; the last failed because {why}"
    )]
    TooFew {
        /// How many were made.
        made: usize,
        /// How many were requested.
        wanted: u32,
        /// Number of starts tried.
        tried: u32,
        /// What was wrong with the last one.
        why: String,
    },
    /// The world failed, or a stop was requested.
    #[error(transparent)]
    World(#[from] WorldError),
}

/// Makes demonstrations; `announce` is told of each discarded start, with the reason.
///
/// Starts are flat cloths of the task's proportions in other sizes, turned by whole degrees that are not multiples of
/// 15: the paper's tests turn by 0, 30, 45 and 60 (protocol, section 6).
pub fn make(
    making: &DemoRequest<'_>,
    announce: &mut dyn FnMut(&str),
) -> Result<(Header, Vec<Demo>), MakeError> {
    let program = making.program;
    let task_error = |why: &str| MakeError::Task(format!("`{}` {why}", program.title()));
    let Some(demos) = &program.demos else {
        return Err(task_error(
            "names no demonstrations: write `demos STAGE from \"FILE\"`, or choose the variant that does with `--variant`",
        ));
    };
    let Some(Subgoals::Demonstrate { folds }) = &program.subgoals else {
        return Err(task_error(
            "brings its subgoals as images, so that there is no fold to demonstrate",
        ));
    };
    for field in &program.actions {
        let is_point = matches!(field.choices, Choices::Points { .. });
        if !(is_point && ["pick", "place"].contains(&field.name.as_str())) {
            let why = format!(
                "asks for `{}`, and an expert knows only where to pick and to place",
                field.name
            );
            return Err(task_error(&why));
        }
    }
    let reads = program.stages.iter().filter_map(|stage| match &stage.read {
        Read::Text { name, .. } => Some(name.clone()),
        Read::Action => None,
    });
    let reads: Vec<String> = reads.collect();
    if reads.len() > 1 {
        let why = format!(
            "reads several texts before the action (`{}`), and an expert can write one instruction",
            reads.join("`, `")
        );
        return Err(task_error(&why));
    }
    let expert = Expert {
        making,
        folds,
        instruction: reads.into_iter().next(),
    };
    let mut world = (making.make_world)()?;
    let header = Header {
        format: DEMOS_FORMAT,
        task: program.task.clone(),
        stage: demos.stage.clone(),
        params: world.parameters(),
        seed: making.seed,
    };
    let mut chance = Chance::seeded(making.seed);
    let mut made = Vec::new();
    let most = making.count.saturating_mul(TRIES);
    let mut last = String::from("none was tried");
    for _ in 0..most {
        if made.len() == making.count as usize {
            break;
        }
        let (dims, turned_deg) = draw(program, &mut chance);
        match expert.demonstrate(dims, turned_deg, world.as_mut())? {
            Ok(demo) => made.push(demo),
            Err(why) => {
                announce(&format!(
                    "left out a cloth of {} by {} particles, turned by {turned_deg} degrees: {why}",
                    dims[0], dims[1]
                ));
                last = why;
            }
        }
    }
    if made.len() < making.count as usize {
        return Err(MakeError::TooFew {
            made: made.len(),
            wanted: making.count,
            tried: most,
            why: last,
        });
    }
    Ok((header, made))
}

/// Draws the size and the rotation of a cloth.
fn draw(program: &Program, chance: &mut Chance) -> ([u32; 2], f64) {
    let sides = SIDES.end() - SIDES.start() + 1;
    let long = SIDES.start() + chance.below(sides as usize) as u32;
    let cloth = &program.cloth;
    let (most, least) = (cloth.dimx.max(cloth.dimy), cloth.dimx.min(cloth.dimy));
    let short = (f64::from(long) * f64::from(least) / f64::from(most)).round() as u32;
    let dims = if cloth.dimx >= cloth.dimy {
        [long, short]
    } else {
        [short, long]
    };
    // 1 to 14 beyond one of the six multiples of 15 below 90.
    let turned = 15 * chance.below(6) + 1 + chance.below(14);
    (dims, turned as f64)
}

struct Expert<'a> {
    making: &'a DemoRequest<'a>,
    folds: &'a [Fold],
    /// The text that fills the instruction, if the task reads one.
    instruction: Option<String>,
}

impl Expert<'_> {
    /// Folds from one start; fails with the reason if an answer would not have been accepted.
    fn demonstrate(
        &self,
        dims: [u32; 2],
        turned_deg: f64,
        world: &mut dyn World,
    ) -> Result<Result<Demo, String>, WorldError> {
        let mut demo = Demo {
            dims,
            turned_deg,
            steps: Vec::with_capacity(self.folds.len()),
        };
        let start = match super::start_of(self.making.program, &demo) {
            Ok(start) => start,
            Err(why) => return Ok(Err(why)),
        };
        world.reset(&start)?;
        let mut first = None;
        let mut last = None;
        for (fold, number) in self.folds.iter().zip(1..) {
            let observation = world.observe()?;
            let seen = Scene::of(self.making.program, &observation, first.as_ref());
            let scene = match seen {
                Ok(scene) => scene,
                Err(why) => return Ok(Err(format!("in step {number} {why}"))),
            };
            let found = self.choose(fold, number, &start, world, &observation, &scene, &last)?;
            let (step, proposal) = match found {
                Ok(chosen) => chosen,
                Err(why) => return Ok(Err(format!("in step {number} {why}"))),
            };
            let lowered = Action::lower(self.making.program, &proposal, &scene, &observation);
            let Some(action) = lowered else {
                return Ok(Err(format!("step {number} has no place on the table")));
            };
            let done = world.act(&action.grip.into(), self.making.interrupt)?;
            if done.has_missed() {
                return Ok(Err(format!("in step {number} nothing was grasped")));
            }
            last = Some(ExecutedAction {
                proposal,
                pick: action.pick_on_cloth_px,
                place: action.place_px,
            });
            demo.steps.push(step);
            first.get_or_insert(scene);
        }
        Ok(Ok(demo))
    }

    /// Finds the offered points that stand for a fold, and records the step.
    #[allow(clippy::too_many_arguments)] // one step's situation, used once
    fn choose(
        &self,
        fold: &Fold,
        number: u32,
        start: &Start,
        world: &dyn World,
        observation: &Observation,
        scene: &Scene,
        last: &Option<ExecutedAction>,
    ) -> Result<Result<(DemoStep, Proposal), String>, WorldError> {
        let program = self.making.program;
        let grip = expert::grip(fold, start, world)?;
        let [center_x, center_y] = start.center_m();
        let middle = WorldPoint::new(center_x, center_y, RESTING_HEIGHT_M);
        let pixel = |point: WorldPoint| {
            let [column, row] = observation.camera.pixel_from_world(point)?;
            Some(PixelPoint::new(column.floor() as i32, row.floor() as i32))
        };
        let Some(center) = pixel(middle) else {
            return Ok(Err("the camera does not see the table".to_owned()));
        };
        let named = |name: &str, point: WorldPoint, of| {
            let offered = verify::offered(program, scene, name);
            match pixel(point).and_then(|wanted| nearest(wanted, &offered, program)) {
                Some(at) => Ok(NamedPoint { point: of, at }),
                None => Err(format!(
                    "no offered point is near the expert's {name} point"
                )),
            }
        };
        let pick = named("pick", grip.pick, &fold.pick);
        let (pick, place) = match (pick, named("place", grip.place, &fold.place)) {
            (Ok(pick), Ok(place)) => (pick, place),
            (Err(why), _) | (_, Err(why)) => return Ok(Err(why)),
        };
        let proposal = Proposal {
            fields: program
                .actions
                .iter()
                .map(|field| {
                    let named = if field.name == "pick" { pick } else { place };
                    (field.name.clone(), Value::Point(named.at))
                })
                .collect(),
        };
        let instruction = words::instruction(pick, place, center);
        let texts: BTreeMap<String, String> = self
            .instruction
            .iter()
            .map(|name| (name.clone(), instruction.clone()))
            .collect();
        let facts = Facts {
            scene,
            texts: &texts,
            step: number,
            last: last.as_ref(),
            proposal: None,
            pointing: Pointing::of_camera(&program.camera),
        };
        match verify::verdict(program, facts, &proposal, Strictness::Full) {
            Ok(Verdict::Accept) => {}
            Ok(Verdict::Reject { check, .. }) => {
                return Ok(Err(format!(
                    "the check `{check}` refuses the expert's answer"
                )));
            }
            Err(why) => return Ok(Err(why.to_string())),
        }
        let points = program
            .keypoints
            .iter()
            .filter_map(|keypoint| Some((keypoint.name.clone(), scene.points(&keypoint.name)?)));
        let step = DemoStep {
            points: points.collect(),
            texts,
            chosen: proposal.fields.iter().cloned().collect(),
            reason: words::reason(pick, place, center),
        };
        Ok(Ok((step, proposal)))
    }
}

/// Returns the offered point nearest to a pixel, if near enough to stand for it.
fn nearest(wanted: PixelPoint, offered: &[Value], program: &Program) -> Option<PixelPoint> {
    let limit_px = NEAR * f64::from(program.camera.image_px);
    let points = offered.iter().filter_map(|value| match value {
        Value::Point(point) => Some(*point),
        _ => None,
    });
    points
        .map(|point| (point.distance_px(wanted), point))
        .filter(|(distance_px, _)| *distance_px <= limit_px)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, point)| point)
}
