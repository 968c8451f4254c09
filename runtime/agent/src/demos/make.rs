//! Makes demonstrations of a task: the scripted expert folds, and the answers that a model would have given are
//! recorded.
//!
//! In: a program and a world. Out: whole demonstrations, each from its own start. Every answer is one that the program
//! offers and its verifier accepts; a start without such answers is discarded and another one drawn.

use super::words::{self, NamedPoint};
use super::{DEMOS_FORMAT, Demo, DemoStep, Header};
use crate::error::RunError;
use crate::policy::{Aim, Ground};
use crate::scene::Scene;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_base::wording::quoted;
use fab_picture::SubpixelPoint;
use fab_program::facts::Facts;
use fab_program::pointing::Pointing;
use fab_program::scene::SceneView;
use fab_program::verify::{Strictness, Verdict};
use fab_program::{Choices, Fold, Program, Read, Subgoals};
use fab_world::expert;
use fab_world::expert::MakeWorld;
use fab_world::start::RESTING_HEIGHT_M;
use fab_world::{World, WorldPoint};
use std::collections::BTreeMap;

/// Most starts tried for each requested demonstration.
const TRIES: u32 = 10;

/// The longer side of demonstrated cloths, particles; the paper tests with 50 to 59, and a larger cloth leaves the
/// picture when turned.
const SIDES: std::ops::RangeInclusive<u32> = 44..=59;

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

/// Makes demonstrations; `announce` is told of each discarded start, with the reason.
///
/// Starts are flat cloths of the task's proportions in other sizes, turned by whole degrees that are not multiples of
/// 15: the paper's tests turn by 0, 30, 45 and 60 (protocol, section 6).
pub fn make(
    making: &DemoRequest<'_>,
    announce: &mut dyn FnMut(&str),
) -> Result<(Header, Vec<Demo>), RunError> {
    let program = making.program;
    let task_error = |why: &str| RunError::Unfit(format!("`{}` {why}", program.title()));
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
            return Err(task_error(&format!(
                "asks for `{}`, and an expert knows only where to pick and to place",
                field.name
            )));
        }
    }
    let reads = program.stages.iter().filter_map(|stage| match &stage.read {
        Read::Text { name, .. } => Some(name.as_str()),
        Read::Action => None,
    });
    let reads: Vec<&str> = reads.collect();
    if reads.len() > 1 {
        return Err(task_error(&format!(
            "reads several texts before the action ({}), and an expert can write one instruction",
            quoted(&reads)
        )));
    }
    let mut world = (making.make_world)()?;
    let header = Header {
        format: DEMOS_FORMAT,
        task: program.task.clone(),
        stage: demos.stage.clone(),
        params: world.parameters(),
        seed: making.seed,
    };
    let mut chance = Chance::seeded(making.seed);
    let (mut made, wanted) = (Vec::new(), making.count as usize);
    let most = making.count.saturating_mul(TRIES);
    let mut last = String::from("none was tried");
    for _ in 0..most {
        if made.len() == wanted {
            break;
        }
        let mut demo = draw(program, &mut chance);
        let text = reads.first().copied();
        match demonstrate(making, folds, text, &mut demo, world.as_mut()) {
            Ok(()) => made.push(demo),
            Err(error @ RunError::World(_)) => return Err(error),
            Err(why) => {
                last = why.to_string();
                let Demo {
                    dims: [dimx, dimy],
                    turned_deg,
                    ..
                } = demo;
                announce(&format!(
                    "left out a cloth of {dimx} by {dimy} particles, turned by {turned_deg} degrees: {last}"
                ));
            }
        }
    }
    if made.len() < wanted {
        return Err(RunError::Failed(format!(
            "only {} of {wanted} demonstrations were made from {most} starts; the last failed because {last}",
            made.len()
        )));
    }
    Ok((header, made))
}

/// Draws the size and the rotation of a cloth.
fn draw(program: &Program, chance: &mut Chance) -> Demo {
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
    Demo {
        dims,
        turned_deg: turned as f64,
        steps: Vec::new(),
    }
}

/// Folds from one start, and records each step; fails if an answer would not have been accepted.
///
/// - `text`: the text that the instruction fills, if the task reads one.
fn demonstrate(
    making: &DemoRequest<'_>,
    folds: &[Fold],
    text: Option<&str>,
    demo: &mut Demo,
    world: &mut dyn World,
) -> Result<(), RunError> {
    let program = making.program;
    let start = super::start_of(program, demo).map_err(RunError::Failed)?;
    let [center_x, center_y] = start.center_m();
    let middle = WorldPoint::new(center_x, center_y, RESTING_HEIGHT_M);
    world.reset(&start)?;
    let mut first = None;
    let mut last = None;
    for (fold, number) in folds.iter().zip(1..) {
        let in_step = |why: &str| RunError::Failed(format!("in step {number} {why}"));
        let observation = world.observe()?;
        let scene = Scene::of(program, &observation, first.as_ref());
        let scene = scene.map_err(|why| in_step(&why.to_string()))?;
        let ground = Ground::of(program, &scene, &observation);
        let camera = &observation.camera;
        let center = camera.pixel_from_world(middle);
        let center = center.ok_or_else(|| in_step("the camera does not see the table"))?;
        let center = SubpixelPoint::at(center).pixel;
        let grip = expert::grip(fold, &start, world)?;
        let aim = Aim::of(grip, &observation).map_err(|why| in_step(&why))?;
        let nearest = aim.nearest(ground, &[]);
        let (proposal, action) = nearest.ok_or_else(|| in_step("no action is offered"))?;
        if let Some(end) = aim.far_ends(program, &action).first() {
            let why = format!("no offered point is near the expert's {end} point");
            return Err(in_step(&why));
        }
        let named = |point, at| NamedPoint { point, at };
        let pick = named(&fold.pick, action.pick_px);
        let place = named(&fold.place, action.place_px);
        let instruction = words::instruction(pick, place, center);
        let texts = text
            .iter()
            .map(|name| ((*name).to_owned(), instruction.clone()));
        let texts: BTreeMap<String, String> = texts.collect();
        let facts = Facts {
            texts: &texts,
            last: last.as_ref(),
            ..Facts::of(&scene, number, Pointing::of_camera(&program.camera))
        };
        if let Verdict::Reject { check, .. } = ground.verdict(facts, &proposal, Strictness::Full)? {
            let why = format!("the check `{check}` refuses the expert's answer");
            return Err(in_step(&why));
        }
        let keypoints = program.keypoints.iter();
        let points = keypoints.filter_map(|it| Some((it.name.clone(), scene.points(&it.name)?)));
        demo.steps.push(DemoStep {
            points: points.collect(),
            texts,
            chosen: proposal.fields.iter().cloned().collect(),
            reason: words::reason(pick, place, center),
        });
        if world
            .act(&action.grip.into(), making.interrupt)?
            .has_missed()
        {
            return Err(in_step("nothing was grasped"));
        }
        last = Some(action.executed(proposal));
        first.get_or_insert(scene);
    }
    Ok(())
}
