//! Brings the cloth to a step of a task, and takes a picture.
//!
//! In: a program, a start, a step's number. Out: what the camera sees then, and the previous action. Earlier steps are
//! executed as demonstrated; without a demonstration, the embedded stand-in decides them.

use crate::exit::Failure;
use crate::io::Io;
use fab_agent::action::Action;
use fab_agent::examples::Examples;
use fab_agent::pictures::Pictures;
use fab_agent::policy::{Asking, Decision, Exchange, Policy, Prompted, StepView};
use fab_agent::scene::Scene;
use fab_agent::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_picture::camera::Camera;
use fab_picture::observation::Observation;
use fab_program::facts::ExecutedAction;
use fab_program::{Fold, PixelPoint, Program, Proposal, Subgoals, Value};
use fab_standins::Geometric;
use fab_world::start::Start;
use fab_world::{Grip, World, expert};

/// What the camera sees at a step, and the previous action.
pub struct StepScene {
    /// The keypoints.
    pub scene: Scene,
    /// The picture in which they were found.
    pub observation: Observation,
    /// The previous action.
    pub last: Option<ExecutedAction>,
}

/// Lays the cloth, executes the steps before `step`, which is counted from 1, and takes a picture.
///
/// Fails if the cloth cannot be laid, nothing is found in the picture, or the stand-in gives no answer.
pub fn scene_at_step(
    program: &Program,
    start: &Start,
    step: u32,
    subgoals: &SubgoalSet,
    world: &mut dyn World,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<StepScene, Failure> {
    let folds = match &program.subgoals {
        Some(Subgoals::Demonstrate { folds }) => folds.as_slice(),
        _ => &[],
    };
    if step > 1 && folds.is_empty() {
        io.talk(&format!(
            "note: what is done before step {step} is decided by `geometric`, the embedded stand-in"
        ));
    }
    world.reset(start)?;
    let mut seen = observe(program, None, None, world)?;
    let mut first: Option<Scene> = None;
    for earlier in 1..step {
        let (grip, done) = match folds.get(earlier as usize - 1) {
            Some(fold) => demonstrated(program, fold, start, &seen.observation.camera, world)?,
            None => stand_in_action(program, &seen, earlier, subgoals)?,
        };
        world.act(&grip.into(), interrupt)?;
        let first = first.get_or_insert_with(|| seen.scene.clone());
        seen = observe(program, Some(first), done, world)?;
    }
    Ok(seen)
}

fn observe(
    program: &Program,
    first: Option<&Scene>,
    last: Option<ExecutedAction>,
    world: &mut dyn World,
) -> Result<StepScene, Failure> {
    let observation = world.observe()?;
    let scene = Scene::of(program, &observation, first)?;
    Ok(StepScene {
        scene,
        observation,
        last,
    })
}

/// Returns a demonstrated fold's grip and, if its ends are in the picture, the corresponding action.
fn demonstrated(
    program: &Program,
    fold: &Fold,
    start: &Start,
    camera: &Camera,
    world: &mut dyn World,
) -> Result<(Grip, Option<ExecutedAction>), Failure> {
    let grip = expert::grip(fold, start, world)?.with_manner(program.manner);
    let pixel = |point| {
        let [column, row]: [f64; 2] = camera.pixel_from_world(point)?;
        Some(PixelPoint::new(column.floor() as i32, row.floor() as i32))
    };
    let ends = pixel(grip.pick).zip(pixel(grip.place));
    let done = ends.map(|(pick, place)| {
        let field = |name: &str, point| (name.to_owned(), Value::Point(point));
        ExecutedAction {
            proposal: Proposal {
                fields: vec![field("pick", pick), field("place", place)],
            },
            pick,
            place,
        }
    });
    Ok((grip, done))
}

/// Lets the stand-in decide a step.
fn stand_in_action(
    program: &Program,
    seen: &StepScene,
    step: u32,
    subgoals: &SubgoalSet,
) -> Result<(Grip, Option<ExecutedAction>), Failure> {
    let StepScene {
        scene,
        observation,
        last,
    } = seen;
    let last = last.as_ref();
    let subgoals = subgoals.step(step as usize - 1)?;
    let examples = Examples::default();
    let pictures = Pictures::of(program, scene, observation, last, subgoals, examples)?;
    let view = StepView::without_rollout(program, scene, observation, step, last, &pictures);
    let models = Models {
        vision: &Geometric,
        text: &Geometric,
    };
    let mut exchange = Exchange {
        asking: &mut Asking::unrecorded(),
        record: &mut |_| Ok(()),
        interrupt: &Interrupt::default(),
    };
    let decision = Prompted::new(models).decide(&view, &mut exchange);
    let action = match decision? {
        Decision::Act { mut grips, .. } => grips.pop().and_then(|proposal| {
            let action = Action::lower(program, &proposal, scene, observation);
            action.map(|action| (action, proposal))
        }),
        Decision::Skip(_) | Decision::Stop { .. } => None,
    };
    let Some((action, proposal)) = action else {
        return Err(Failure::environment(format!(
            "`geometric`, the embedded stand-in, finds no action for step {step} of `{}`; `fabc render` takes the points from `--scene FILE.json`",
            program.title()
        )));
    };
    let done = ExecutedAction {
        proposal,
        pick: action.pick_on_cloth_px,
        place: action.place_px,
    };
    Ok((action.grip, Some(done)))
}
