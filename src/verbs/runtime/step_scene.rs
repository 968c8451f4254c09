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
use fab_agent::record::SentFiles;
use fab_agent::scene::Scene;
use fab_agent::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::{Budget, Ledger};
use fab_picture::SubpixelPoint;
use fab_picture::camera::Camera;
use fab_picture::observation::Observation;
use fab_program::facts::ExecutedAction;
use fab_program::{Fold, Program, Proposal, Subgoals, Value};
use fab_standins::Geometric;
use fab_world::start::Start;
use fab_world::{Grip, World, expert};

/// What the camera sees at a step, and the previous action.
pub struct StepScene {
    pub scene: Scene,
    /// The picture in which they were found.
    pub observation: Observation,
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
    let (mut first, mut last) = (None, None);
    for number in 1.. {
        let observation = world.observe()?;
        let scene = Scene::of(program, &observation, first.as_ref())?;
        let seen = StepScene {
            scene,
            observation,
            last,
        };
        if number >= step {
            return Ok(seen);
        }
        let (grip, done) = match folds.get(number as usize - 1) {
            Some(fold) => demonstrated(program, fold, start, &seen.observation.camera, world)?,
            None => stand_in_action(program, &seen, number, subgoals)?,
        };
        world.act(&grip.into(), interrupt)?;
        last = done;
        first.get_or_insert(seen.scene);
    }
    unreachable!("the loop ends with the step that is asked for")
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
    let pixel = |point| Some(SubpixelPoint::at(camera.pixel_from_world(point)?).pixel);
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
    let (scene, observation, last) = (&seen.scene, &seen.observation, seen.last.as_ref());
    let subgoals = subgoals.step(step as usize - 1)?;
    let examples = Examples::default();
    let pictures = Pictures::of(program, scene, observation, last, subgoals, examples)?;
    let view = StepView::without_rollout(program, scene, observation, step, last, &pictures);
    let models = Models {
        vision: &Geometric,
        text: &Geometric,
    };
    let budget = Budget::default();
    let mut exchange = Exchange {
        asking: &mut Asking::of(Ledger::unwritten(&budget)),
        record: &mut |_| Ok(SentFiles::default()),
        interrupt: &Interrupt::default(),
    };
    let decision = Prompted::new(models).decide(&view, &mut exchange)?;
    let proposal = match decision {
        Decision::Act { mut grips, .. } => grips.pop(),
        Decision::Skip(_) | Decision::Stop { .. } => None,
    };
    let lowered = proposal.and_then(|proposal| {
        let action = Action::lower(program, &proposal, scene, observation)?;
        Some((action, proposal))
    });
    let (action, proposal) = lowered.ok_or_else(|| {
        Failure::environment(format!(
            "`geometric`, the embedded stand-in, finds no action for step {step} of `{}`",
            program.title()
        ))
    })?;
    Ok((action.grip, Some(action.executed(proposal))))
}
