//! What every world promises, as checks that anybody can run on their own world.
//!
//! In: a way to make a world. Out: for each promise, whether it is kept. The project's own tests run all of them on its
//! worlds; `fabc world check` runs them on a user's program.

use crate::metrics::coverage;
use crate::start::Start;
use crate::{About, Grasp, Grip, Motion, World, WorldError, WorldPoint};
use fab_base::interrupt::Interrupt;
use fab_program::{Camera, Cloth, ClothStart, ImageUp, Manner};
use std::time::{Duration, Instant};

/// How long a world may take to stop after an interrupt.
const LONGEST_HALT: Duration = Duration::from_millis(4500);

/// An action faster than this cannot be interrupted.
const INSTANT: Duration = Duration::from_millis(500);

/// A promise of every world.
pub struct Promise {
    /// What is promised.
    pub name: &'static str,
    check: Check,
}

type Check = fn(&MakeWorld<'_>) -> Result<Conformance, Violation>;

/// Makes worlds that are all equal.
pub type MakeWorld<'a> = dyn Fn() -> Result<Box<dyn World>, WorldError> + 'a;

/// How a promise was kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Conformance {
    /// It was kept.
    Whole,
    /// The world says that it cannot do what was promised, which is allowed.
    Refused(String),
}

/// How a promise was broken.
#[derive(Debug, thiserror::Error)]
pub enum Violation {
    /// A result broke the promise.
    #[error("{0}")]
    Promise(String),
    /// The world failed.
    #[error(transparent)]
    World(#[from] WorldError),
}

impl Promise {
    /// Returns whether a world keeps the promise.
    pub fn check(&self, make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
        (self.check)(make)
    }
}

/// All promises.
pub const PROMISES: [Promise; 11] = [
    promise(
        "equal worlds have equal parameters and code",
        equal_worlds_say_the_same,
    ),
    promise(
        "nothing is seen or done before a reset",
        looks_only_after_a_reset,
    ),
    promise(
        "two pictures without an action between them are equal",
        two_looks_are_equal,
    ),
    promise(
        "a fold moves the cloth, and a reset brings it back",
        a_fold_moves_the_cloth_and_a_reset_brings_it_back,
    ),
    promise(
        "equal actions have equal results",
        equal_actions_have_equal_results,
    ),
    promise(
        "a pick beside the cloth grasps nothing and moves nothing",
        a_pick_beside_the_cloth_grasps_nothing,
    ),
    promise(
        "a motion for another number of grippers is refused, and moves nothing",
        a_motion_for_other_grippers_is_refused,
    ),
    promise("an interrupt ends an action", an_interrupt_ends_an_action),
    promise(
        "a start that cannot be laid is refused",
        a_broken_start_is_refused,
    ),
    promise(
        "crumpling depends on the seed alone",
        crumpling_depends_on_the_seed_alone,
    ),
    promise(
        "a manner is followed or refused by its field's name",
        a_manner_is_followed_or_refused,
    ),
];

const fn promise(name: &'static str, check: Check) -> Promise {
    Promise { name, check }
}

/// Returns the camera for the checks' pictures: the one of the shipped folds.
pub fn camera() -> Camera {
    Camera {
        height_m: 0.65,
        fov_rad: std::f64::consts::FRAC_PI_4,
        image_px: 224,
        up: ImageUp::Y,
    }
}

fn demand(holds: bool, otherwise: &str) -> Result<(), Violation> {
    if holds {
        Ok(())
    } else {
        Err(Violation::Promise(otherwise.to_owned()))
    }
}

fn start() -> Start {
    Start::flat(&Cloth {
        dimx: 24,
        dimy: 20,
        spacing_m: 0.00625,
        start: ClothStart::Flat,
        material: None,
    })
}

fn laid(make: &MakeWorld<'_>) -> Result<Box<dyn World>, WorldError> {
    let mut world = make()?;
    world.reset(&start())?;
    Ok(world)
}

/// A start that no world can lay.
fn broken() -> Start {
    let mut broken = start();
    broken.positions[3][2] = f32::NAN;
    broken
}

fn refused(why: &str) -> Result<Conformance, Violation> {
    Ok(Conformance::Refused(why.to_owned()))
}

fn corner_to_center() -> Grip {
    let [x, y, z] = start().positions[0];
    Grip::new(
        WorldPoint::new(x.into(), y.into(), z.into()),
        WorldPoint::new(0.0, 0.0, 0.005),
    )
}

fn equal_worlds_say_the_same(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let [one, other] = [make()?, make()?].map(|world| About::of(world.as_ref()));
    let differ = |what: &str| format!("two equal worlds have different {what}");
    demand(one.name == other.name, &differ("names"))?;
    demand(one.parameters == other.parameters, &differ("`parameters`"))?;
    demand(one.code == other.code, &differ("`code`"))?;
    Ok(Conformance::Whole)
}

fn looks_only_after_a_reset(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let mut world = make()?;
    let seen = matches!(world.observe(), Err(WorldError::NotReset));
    demand(seen, "it takes a picture before any cloth was laid")?;
    let done = world.act(&corner_to_center().into(), &Interrupt::default());
    demand(
        matches!(done, Err(WorldError::NotReset)),
        "it acts before any cloth was laid",
    )?;
    demand(
        world.particles().is_none(),
        "it has particles before any cloth was laid",
    )?;
    Ok(Conformance::Whole)
}

fn two_looks_are_equal(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let mut world = laid(make)?;
    let (first, second) = (world.observe()?, world.observe()?);
    demand(
        first.rgb == second.rgb,
        "the colours of two pictures without an action between them differ",
    )?;
    demand(
        first.depth_m == second.depth_m,
        "the depths of two pictures without an action between them differ",
    )?;
    let is_registered = first.rgb.dimensions() == first.depth_m.dimensions();
    demand(is_registered, "colour and depth are not of one size")?;
    Ok(Conformance::Whole)
}

fn a_fold_moves_the_cloth_and_a_reset_brings_it_back(
    make: &MakeWorld<'_>,
) -> Result<Conformance, Violation> {
    let mut world = laid(make)?;
    let before = world.observe()?;
    let executed = world.act(&corner_to_center().into(), &Interrupt::default())?;
    demand(
        !executed.has_missed(),
        "a pick at the cloth's corner grasps nothing",
    )?;
    demand(executed.duration_s > 0.0, "a fold takes no time")?;
    demand(
        world.observe()?.rgb != before.rgb,
        "the fold is not to be seen",
    )?;
    if let Some(particles) = world.particles() {
        let count = start().positions.len();
        demand(
            particles.len() == count,
            &format!(
                "it has {} particles, and the start has {count}",
                particles.len()
            ),
        )?;
        let mut numbers = particles.iter().flatten();
        demand(
            numbers.all(|number| number.is_finite()),
            "a particle's place is not finite",
        )?;
        demand(particles != start().positions, "the fold moved no particle")?;
    }
    if !world.repeats() {
        return refused("it says that it does not repeat");
    }
    world.reset(&start())?;
    demand(
        world.observe()?.rgb == before.rgb,
        "a reset does not lay the cloth as before",
    )?;
    Ok(Conformance::Whole)
}

fn equal_actions_have_equal_results(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let (mut one, mut other) = (make()?, make()?);
    if !one.repeats() {
        return refused("it says that it does not repeat");
    }
    for world in [&mut one, &mut other] {
        world.reset(&start())?;
        world.act(&corner_to_center().into(), &Interrupt::default())?;
    }
    demand(
        one.particles() == other.particles(),
        "equal actions bring the particles to different places",
    )?;
    demand(
        one.observe()?.rgb == other.observe()?.rgb,
        "equal actions end in different pictures",
    )?;
    Ok(Conformance::Whole)
}

fn a_pick_beside_the_cloth_grasps_nothing(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let mut world = laid(make)?;
    let before = world.particles();
    let beside = Grip::new(
        WorldPoint::new(0.2, 0.2, 0.0),
        WorldPoint::new(0.2, -0.2, 0.0),
    );
    for done in world.act(&beside.into(), &Interrupt::default())?.grips {
        let grasp = done.grasp;
        demand(
            grasp == Grasp::Missed,
            &format!("a pick beside the cloth is called {grasp:?} in place of missed"),
        )?;
        demand(
            done.released_at.is_none(),
            "a pick beside the cloth says where it let go of a particle",
        )?;
    }
    demand(
        world.particles() == before,
        "an empty gripper moved the cloth",
    )?;
    Ok(Conformance::Whole)
}

fn a_motion_for_other_grippers_is_refused(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let mut world = laid(make)?;
    let before = world.particles();
    let motion = Motion {
        grips: vec![corner_to_center(); world.grippers() + 1],
    };
    let done = world.act(&motion, &Interrupt::default());
    demand(
        matches!(done, Err(WorldError::Motion { .. })),
        "it executes a motion for more grippers than it has",
    )?;
    demand(
        world.particles() == before,
        "a motion that it refused moved the cloth",
    )?;
    Ok(Conformance::Whole)
}

fn a_manner_is_followed_or_refused(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let manner = Manner {
        lift_m: Some(0.03),
        release_height_m: Some(0.01),
        ..Manner::default()
    };
    let motion = Motion::from(corner_to_center().with_manner(manner));
    let mut world = laid(make)?;
    let Some(why) = world.refuses(&motion) else {
        let executed = world.act(&motion, &Interrupt::default())?;
        demand(
            executed.grips.iter().all(|done| done.grip.manner == manner),
            "an action is reported in another manner than it was asked for",
        )?;
        return Ok(Conformance::Whole);
    };
    demand(
        manner
            .stated()
            .any(|(name, _)| why.contains(&format!("`{name}`"))),
        &format!("it refuses a manner and names no field: {why}"),
    )?;
    let done = world.act(&motion, &Interrupt::default());
    demand(
        matches!(done, Err(WorldError::Motion { .. })),
        "it acts in a manner that it refuses",
    )?;
    Ok(Conformance::Refused(why))
}

fn an_interrupt_ends_an_action(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let mut world = laid(make)?;
    let interrupt = Interrupt::default();
    interrupt.raise();
    let begun = Instant::now();
    let done = world.act(&corner_to_center().into(), &interrupt);
    let took = begun.elapsed();
    match done {
        Err(WorldError::Interrupted | WorldError::Halted { .. }) => {
            let took_s = took.as_secs_f64();
            let late = format!("an interrupted action took {took_s:.1} s to stop");
            demand(took < LONGEST_HALT, &late)?;
            Ok(Conformance::Whole)
        }
        Err(other) => Err(other.into()),
        Ok(_) if took < INSTANT => refused("an action is over before an interrupt can reach it"),
        Ok(_) => Err(Violation::Promise(
            "it completes an action that was interrupted".to_owned(),
        )),
    }
}

fn a_broken_start_is_refused(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let mut world = make()?;
    let mut short = start();
    short.positions.pop();
    for (start, what) in [
        (broken(), "a number that is not finite"),
        (short, "fewer particles than its grid has"),
    ] {
        let is_refused = matches!(world.reset(&start), Err(WorldError::Start { .. }));
        demand(is_refused, &format!("it lays a start with {what}"))?;
    }
    Ok(Conformance::Whole)
}

fn crumpling_depends_on_the_seed_alone(make: &MakeWorld<'_>) -> Result<Conformance, Violation> {
    let world = make()?;
    let crumple = |seed| world.crumple(&start(), seed, &Interrupt::default());
    let heap = match crumple(7) {
        Ok(heap) => heap,
        Err(WorldError::CannotCrumple { .. }) => {
            return refused("it says that it cannot crumple a cloth");
        }
        Err(other) => return Err(other.into()),
    };
    let is_named = heap.name == "crumpled, seed 7" && heap.seed == Some(7);
    demand(is_named, "the heap is not named by its seed")?;
    demand(heap == crumple(7)?, "the same seed gives two heaps")?;
    demand(
        heap.positions != crumple(8)?.positions,
        "two seeds give the same heap",
    )?;
    demand(
        world.particles().is_none(),
        "crumpling a start laid a cloth",
    )?;
    let covered = |start: &Start| coverage(&start.positions, &start.grid).unwrap_or(f64::NAN);
    let (before, after) = (covered(&start()), covered(&heap));
    demand(
        after < 0.85 * before,
        &format!(
            "a heap covers {after:.3} of the table's share that the flat cloth covers by {before:.3}"
        ),
    )?;
    let interrupt = Interrupt::default();
    interrupt.raise();
    let interrupted = world.crumple(&start(), 7, &interrupt);
    demand(
        matches!(interrupted, Err(WorldError::Interrupted)),
        "it goes on crumpling after an interrupt",
    )?;
    let refused = world.crumple(&broken(), 7, &Interrupt::default());
    demand(
        matches!(refused, Err(WorldError::Start { .. })),
        "it crumples a start with a number that is not finite",
    )?;
    Ok(Conformance::Whole)
}
