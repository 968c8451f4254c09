//! The pictures that show a fold, step by step.
//!
//! In: a program and the folder of its file. Out: `steps + 1` pictures and the arrow of each step, from the author's
//! files, from pinned ones, or drawn by executing `demonstrate` in a world.

mod pins;

use crate::error::RunError;
use crate::policy::{Aim, Ground};
use crate::scene::Scene;
use crate::task_files;
use fab_base::interrupt::Interrupt;
use fab_picture::observation::Observation;
use fab_picture::png;
use fab_program::{
    Arrow, Effect, Fold, Program, StepTrial, SubgoalStep, Subgoals, Trial, Unoffered,
};
use fab_vision::VisionError;
use fab_world::metrics::{ClothMoved, cloth_moved};
use fab_world::start::Start;
use fab_world::{Grip, World, WorldError, expert, smallest_fold};
use image::RgbImage;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::Path;

/// Tail and tip of an arrow in a picture's pixels, `[column, row]`.
pub type ArrowPx = [[f64; 2]; 2];

/// The pictures of a whole task.
#[derive(Clone, Debug, Default)]
pub struct SubgoalSet {
    /// One more than there are steps.
    pub pictures: Vec<RgbImage>,
    /// The arrow from each picture to the next; `None` if the picture already contains one.
    pub arrows: Vec<Option<ArrowPx>>,
    /// Their origin.
    pub origin: Origin,
    /// What the steps did to the cloth, if they were drawn anew to be pinned.
    pub trial: Option<Trial>,
}

impl SubgoalSet {
    /// Returns the SHA-256 of all pictures and arrows, hex.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for picture in &self.pictures {
            add_picture(&mut hash, picture);
        }
        hash.update(format!("{:?}", self.arrows));
        fab_base::digest::hex(&hash.finalize())
    }
}

fn add_picture(hash: &mut Sha256, picture: &RgbImage) {
    hash.update(picture.width().to_le_bytes());
    hash.update(picture.height().to_le_bytes());
    hash.update(picture.as_raw());
}

/// The origin of subgoal pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// Files that the author names.
    Author,
    /// Files that `fabc subgoals` drew earlier.
    Pinned,
    /// Files that `fabc subgoals` drew earlier, by another simulator, of another colour or carried otherwise.
    PinnedByOther,
    /// Drawn for this run, because none are pinned.
    Drawn,
    /// The task has none.
    #[default]
    Absent,
    /// Drawn for this run, because the pinned ones show another fold, cloth or camera.
    DrawnAnew,
}

/// The pictures around one step, current and next: without arrows, and with that of the step.
#[derive(Clone, Debug)]
pub struct StepPictures([[RgbImage; 2]; 2]);

impl SubgoalSet {
    /// Returns the program's pictures; `folder` contains its file.
    ///
    /// `world` is reset and used only if nothing is pinned.
    pub fn obtain(
        program: &Program,
        folder: &Path,
        world: &mut dyn World,
        interrupt: &Interrupt,
    ) -> Result<SubgoalSet, RunError> {
        let Some(Subgoals::Demonstrate { folds }) = &program.subgoals else {
            return load_images(program, folder);
        };
        match pins::load(program, folds, folder, world) {
            Ok(set) => Ok(set),
            Err(origin) => {
                let (drawn, _) = demonstrate(program, folds, world, interrupt)?;
                Ok(SubgoalSet { origin, ..drawn })
            }
        }
    }

    /// Draws the demonstration again, even if pictures are pinned; the author's own pictures are loaded.
    ///
    /// For a step that folds nothing, the smallest fold that stays is searched.
    pub fn draw(
        program: &Program,
        folder: &Path,
        world: &mut dyn World,
        interrupt: &Interrupt,
    ) -> Result<SubgoalSet, RunError> {
        let Some(Subgoals::Demonstrate { folds }) = &program.subgoals else {
            return load_images(program, folder);
        };
        let (set, steps) = demonstrate(program, folds, world, interrupt)?;
        let trial = tried(program, steps, world, interrupt)?;
        Ok(SubgoalSet { trial, ..set })
    }

    /// Executes the demonstration; returns for each step whether it changed the cloth. Empty without one.
    pub fn steps_that_stay(
        program: &Program,
        world: &mut dyn World,
        interrupt: &Interrupt,
    ) -> Result<Vec<bool>, RunError> {
        let Some(Subgoals::Demonstrate { folds }) = &program.subgoals else {
            return Ok(Vec::new());
        };
        let (_, steps) = demonstrate(program, folds, world, interrupt)?;
        let stays = |step: &DoneStep| step.moved.held.is_some_and(|held| !held.went_back);
        Ok(steps.iter().map(stays).collect())
    }

    /// Returns the pictures around step `number`, from 0; the last step's if there are fewer, `None` if there are none
    /// at all.
    ///
    /// Fails if the arrow cannot be drawn.
    pub fn step(&self, number: usize) -> Result<Option<StepPictures>, VisionError> {
        if self.pictures.is_empty() {
            return Ok(None);
        }
        let last = self.pictures.len() - 1;
        let number = number.min(last.saturating_sub(1));
        let bare = [number, last.min(number + 1)].map(|index| self.pictures[index].clone());
        let mut with_arrow = bare.clone();
        if let Some([tail, tip]) = self.arrows.get(number).copied().flatten() {
            for picture in &mut with_arrow {
                fab_vision::draw_arrow(picture, tail, tip)?;
            }
        }
        Ok(Some(StepPictures([bare, with_arrow])))
    }
}

impl StepPictures {
    /// Returns one of the two pictures.
    pub fn picture(&self, which: SubgoalStep, arrow: Arrow) -> &RgbImage {
        &self.0[usize::from(arrow == Arrow::Drawn)][usize::from(which == SubgoalStep::Next)]
    }
}

/// Loads the author's pictures; none if the task names none.
fn load_images(program: &Program, folder: &Path) -> Result<SubgoalSet, RunError> {
    let Some(Subgoals::Images { images }) = &program.subgoals else {
        return Ok(SubgoalSet::default());
    };
    let mut set = SubgoalSet {
        origin: Origin::Author,
        ..SubgoalSet::default()
    };
    for image in images {
        let path = task_files::resolve(folder, &image.file)?;
        let picture = png::load(&path)
            .map_err(|why| RunError::Failed(format!("a subgoal picture cannot be used: {why}")))?;
        set.pictures.push(picture);
        let pixel = |point: fab_program::PixelPoint| [f64::from(point.u), f64::from(point.v)];
        set.arrows
            .push(image.arrow.map(|[tail, tip]| [pixel(tail), pixel(tip)]));
    }
    set.arrows.truncate(images.len().saturating_sub(1));
    Ok(set)
}

/// An executed step of a demonstration.
struct DoneStep {
    /// The particles before it.
    before: Vec<[f32; 3]>,
    /// What the camera saw before it.
    seen: Observation,
    grip: Grip,
    moved: ClothMoved,
}

/// Judges the steps of a demonstration, and searches the smallest fold for those that changed nothing.
fn tried(
    program: &Program,
    steps: Vec<DoneStep>,
    world: &mut dyn World,
    interrupt: &Interrupt,
) -> Result<Option<Trial>, WorldError> {
    let Some(of) = program.demonstration_hash() else {
        return Ok(None);
    };
    let mut first = None;
    let judged = |step: DoneStep| {
        let unoffered = unoffered(program, &step, &mut first).unwrap_or_default();
        let effect = match step.moved.held {
            None => Effect::Missed,
            Some(held) if held.went_back => {
                let cloth = Start {
                    name: "the cloth before the step".to_owned(),
                    positions: step.before,
                    ..Start::flat(&program.cloth)
                };
                Effect::WentBack {
                    carried_mm: tenths(held.carried_mm),
                    stayed_mm: tenths(held.stayed_mm),
                    slid_mm: tenths(step.moved.slid_mm),
                    smallest: smallest_fold::find(&cloth, &step.grip, world, interrupt)?,
                }
            }
            Some(_) => Effect::Changed,
        };
        let way = step.grip.place - step.grip.pick;
        Ok(StepTrial {
            planned_mm: tenths(way.x.hypot(way.y) * 1000.0),
            effect,
            unoffered,
        })
    };
    let steps = steps.into_iter().map(judged);
    let steps = steps.collect::<Result<_, WorldError>>()?;
    let offers = Some(program.offers_hash());
    Ok(Some(Trial { of, offers, steps }))
}

/// Returns the ends of a step for which no offered point stands; `None` if nothing is found in its picture, which ends a run.
///
/// - `first`: the scene of the first step, which is set by it.
fn unoffered(
    program: &Program,
    step: &DoneStep,
    first: &mut Option<Scene>,
) -> Option<Vec<Unoffered>> {
    let scene = Scene::of(program, &step.seen, first.as_ref()).ok()?;
    let ground = Ground::of(program, &scene, &step.seen);
    let aim = Aim::of(step.grip, &step.seen).ok()?;
    let (_, action) = aim.nearest(ground, &[])?;
    let far_ends = aim.far_ends(program, &action).into_iter().map(|end| {
        let (nearest, offered, wanted) = match end {
            "pick" => (action.pick_px, action.grip.pick, step.grip.pick),
            _ => (action.place_px, action.grip.place, step.grip.place),
        };
        let away = offered - wanted;
        Unoffered {
            end: end.to_owned(),
            nearest,
            away_mm: tenths(away.x.hypot(away.y) * 1000.0),
            keypoint: aim.keypoint_at(end, ground),
        }
    });
    let far_ends = far_ends.collect();
    first.get_or_insert(scene);
    Some(far_ends)
}

fn tenths(mm: f64) -> f64 {
    (mm * 10.0).round() / 10.0
}

/// Draws the pictures and the arrows between them; also returns what was executed.
fn demonstrate(
    program: &Program,
    folds: &[Fold],
    world: &mut dyn World,
    interrupt: &Interrupt,
) -> Result<(SubgoalSet, Vec<DoneStep>), RunError> {
    let start = Start::flat(&program.cloth);
    let mut steps = Vec::new();
    world.reset(&start)?;
    let mut observation = world.observe()?;
    let mut set = SubgoalSet {
        pictures: vec![observation.rgb.clone()],
        origin: Origin::Drawn,
        ..SubgoalSet::default()
    };
    for fold in folds {
        let grip = expert::grip(fold, &start, world)?.with_manner(program.manner);
        let camera = &observation.camera;
        let ends_px = [grip.pick, grip.place].map(|point| camera.pixel_from_world(point));
        set.arrows.push(match ends_px {
            [Some(tail), Some(tip)] => Some([tail, tip]),
            _ => None,
        });
        let before = world.particles().unwrap_or_default();
        let executed = world.act(&grip.into(), interrupt)?;
        let after = world.particles().unwrap_or_default();
        // Folds are executed only where particles are known.
        let moved = cloth_moved(&before, &after, &executed);
        let seen = std::mem::replace(&mut observation, world.observe()?);
        set.pictures.push(observation.rgb.clone());
        steps.extend(moved.map(|moved| DoneStep {
            before,
            seen,
            grip,
            moved,
        }));
    }
    Ok((set, steps))
}
