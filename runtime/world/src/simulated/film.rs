//! Films of a simulated cloth: the whole motion as an animated picture from one side, for people.
//!
//! In: the cloth after every step, while a world or a verb moves it. Out: one GIF file, written at the end.
//! A film changes nothing in the simulation. It keeps below [`MAX_BYTES`] by leaving out pictures where a motion is too
//! long for all of them, and counts those.

use fab_base::files;
use fab_base::interrupt::Interrupt;
use fab_picture::animation::{Animation, MAX_COLOURS, Written};
use fab_program as program;
use fab_sim::{
    CameraError, ImageUp, Look, Manner, Marker, PickAndPlace, SimError, Simulator, SlantedCamera,
    SlantedView, TopDownCamera,
};
use image::RgbImage;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A film's largest file, bytes.
pub const MAX_BYTES: u64 = 3_000_000;
/// Steps of the simulator, 0.01 s each, between two pictures: 12.5 pictures a second.
pub const STEPS_A_PICTURE: u64 = 8;
/// A step of the simulator, hundredths of a second.
const STEP_CS: u64 = 1;
/// The longest time that an unchanged picture is shown during a motion: the picker's way outside the picture.
const MAX_STILL_CS: u64 = 60;
/// How long the start is shown, before the first motion.
const START_CS: u32 = 60;
/// How long the end of each motion is shown.
const END_OF_MOTION_CS: u32 = 50;
/// How long the end is shown, before the film begins again.
const END_CS: u32 = 200;
/// A motion's length that the size of the film is planned with, steps. A usual one takes 400 to 500.
const PLANNED_STEPS: u64 = 520;
/// The share of the size that may be spent ahead of the plan, since motions differ.
const AHEAD: f64 = 0.15;
/// Width and height of the pictures, pixels.
const SIZE_PX: [u16; 2] = [384, 288];

/// What a film is to show and where it goes.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmPlan {
    /// The file.
    pub path: PathBuf,
    /// The camera over the table; the film's camera, beside the table, sees as much.
    pub camera: TopDownCamera,
    /// The number of motions expected, which decides how many bytes each may take.
    pub motions: u32,
    /// The largest file, bytes; [`MAX_BYTES`] unless something smaller is wanted.
    pub max_bytes: u64,
}

/// A finished film.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Film {
    /// The file.
    pub file: PathBuf,
    /// Pictures in it.
    pub pictures: u32,
    /// Its length, seconds.
    pub shown_s: f64,
    /// Its size.
    pub bytes: u64,
    /// Pictures that were left out, to keep below [`MAX_BYTES`].
    pub left_out: u32,
}

impl fmt::Display for Film {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "video: {} ({} pictures, {:.1} s, {:.2} MB)",
            self.file.display(),
            self.pictures,
            self.shown_s,
            self.bytes as f64 / 1e6
        )?;
        match self.left_out {
            0 => Ok(()),
            n => write!(f, "; {n} pictures left out, to keep the file small"),
        }
    }
}

/// A film's file cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write `{path}`: {why}")]
pub struct FilmError {
    path: PathBuf,
    why: std::io::Error,
}

/// Takes a film; clones write the same one.
#[derive(Clone)]
pub struct Recorder(Arc<Mutex<Recording>>);

struct Recording {
    plan: FilmPlan,
    camera: SlantedCamera,
    /// `None` until there is a cloth.
    open: Option<Open>,
}

/// A film under way.
struct Open {
    animation: Animation,
    view: SlantedView,
    /// The cloth's steps up to the last picture.
    at_step: u64,
    /// How long nothing has changed, hundredths of a second.
    still_cs: u64,
    /// The bytes that the plan grants by now.
    granted: f64,
    left_out: u32,
}

impl Recorder {
    /// Begins a film.
    pub fn new(plan: FilmPlan) -> Result<Recorder, CameraError> {
        Ok(Recorder(Arc::new(Mutex::new(Recording {
            camera: slanted(&plan.camera)?,
            plan,
            open: None,
        }))))
    }

    /// Shows the cloth before the first motion.
    pub fn begin(&self, cloth: &Simulator, look: &Look) {
        let mut recording = self.locked();
        let view = SlantedView::new(recording.camera, look);
        let mut animation = Animation::new(SIZE_PX, palette(look));
        animation.show(&picture(&view, cloth, None));
        animation.hold(START_CS);
        recording.open = Some(Open {
            animation,
            view,
            at_step: cloth.steps(),
            still_cs: 0,
            granted: recording.plan.max_bytes as f64 * AHEAD,
            left_out: 0,
        });
    }

    /// Shows the cloth after a step, if a picture is due; cheap if not.
    pub fn step(&self, cloth: &Simulator) {
        if !cloth.steps().is_multiple_of(STEPS_A_PICTURE) {
            return;
        }
        let Recording { plan, open, .. } = &mut *self.locked();
        let Some(open) = open else { return };
        let max_bytes = plan.max_bytes as f64;
        let planned_steps = u64::from(plan.motions.max(1)) * PLANNED_STEPS;
        let share = STEPS_A_PICTURE as f64 / planned_steps as f64;
        // The end of what may be spent is for the ends of motions.
        let most = max_bytes * (1.0 - AHEAD);
        open.granted = (open.granted + share * max_bytes * (1.0 - 2.0 * AHEAD)).min(most);
        open.show(cloth, open.granted);
    }

    /// Shows the cloth after a motion, or where it was interrupted.
    pub fn end_motion(&self, cloth: &Simulator) {
        let Recording { plan, open, .. } = &mut *self.locked();
        let Some(open) = open else { return };
        // Half of that is for the last picture of all, whose end is not known in advance.
        if open.show(cloth, plan.max_bytes as f64 * (1.0 - 0.5 * AHEAD)) {
            open.animation.hold(END_OF_MOTION_CS);
        }
    }

    /// Ends the film and writes its file; `None`, and no file, if no cloth was ever laid.
    ///
    /// Nothing is recorded afterwards.
    pub fn finish(&self) -> Result<Option<Film>, FilmError> {
        let mut recording = self.locked();
        let Some(mut open) = recording.open.take() else {
            return Ok(None);
        };
        open.animation.hold(END_CS);
        let Some(Written {
            bytes,
            pictures,
            shown_cs,
        }) = open.animation.finish()
        else {
            return Ok(None);
        };
        let path = recording.plan.path.clone();
        if let Err(why) = files::write_whole(&path, &bytes) {
            return Err(FilmError { path, why });
        }
        Ok(Some(Film {
            file: path,
            pictures,
            shown_s: shown_cs as f64 / 100.0,
            bytes: bytes.len() as u64,
            left_out: open.left_out,
        }))
    }

    fn locked(&self) -> MutexGuard<'_, Recording> {
        // A film of which one picture failed is as good as before.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Open {
    /// Shows the last picture for the time since then, and the cloth, unless the film has more bytes than granted.
    ///
    /// The time in which nothing changes is shortened. Returns whether there was room.
    fn show(&mut self, cloth: &Simulator, granted: f64) -> bool {
        let steps = cloth.steps().saturating_sub(self.at_step);
        self.at_step = cloth.steps();
        let longer = (steps * STEP_CS).min(MAX_STILL_CS.saturating_sub(self.still_cs));
        self.still_cs += longer;
        self.animation
            .hold(u32::try_from(longer).unwrap_or(u32::MAX));
        if self.animation.bytes() as f64 > granted {
            self.left_out += 1;
            return false;
        }
        let picture = picture(&self.view, cloth, Some(&cloth.marker()));
        if self.animation.show(&picture) {
            self.still_cs = 0;
        }
        true
    }
}

/// Draws a cloth, and the picker's marker if there is one.
fn picture(view: &SlantedView, cloth: &Simulator, marker: Option<&Marker>) -> RgbImage {
    let drawn = view.render(cloth.mask(), &cloth.positions(), marker);
    RgbImage::from_raw(drawn.width, drawn.height, drawn.rgb)
        .expect("a picture holds width * height pixels")
}

/// Puts a camera beside the table that sees what the camera over it sees; what is up in that picture is behind.
fn slanted(above: &TopDownCamera) -> Result<SlantedCamera, CameraError> {
    // Half the side of the table's visible square.
    let half_m = above.height_m * (0.5 * above.fov_rad).tan();
    let [aside, back, up] = [0.34, -1.72, 1.78].map(|share| share * half_m);
    let turned = |x: f32, y: f32| match above.up {
        ImageUp::Y => [x, y],
        ImageUp::X => [y, -x],
    };
    let [x, y] = turned(aside, back);
    let [target_x, target_y] = turned(0.0, 0.02 * half_m);
    SlantedCamera::new(
        [x, y, up],
        [target_x, target_y, 0.0],
        0.76,
        SIZE_PX.map(u32::from),
    )
}

/// Carries a cloth as [`Simulator::pick_and_place_in`] does, and films it if there is a recorder.
pub fn pick_and_place(
    cloth: &mut Simulator,
    manner: &Manner,
    pick: [f32; 2],
    place: [f32; 2],
    recorder: Option<&Recorder>,
    interrupt: &Interrupt,
) -> Result<PickAndPlace, SimError> {
    let mut watch = |cloth: &Simulator| {
        if let Some(recorder) = recorder {
            recorder.step(cloth);
        }
    };
    let done = cloth.pick_and_place_in(manner, pick, place, &|| interrupt.is_raised(), &mut watch);
    if let Some(recorder) = recorder {
        recorder.end_motion(cloth);
    }
    done
}

/// Returns the camera over the table of a task.
pub fn table_camera(camera: &program::Camera) -> Result<TopDownCamera, CameraError> {
    let up = match camera.up {
        program::ImageUp::Y => ImageUp::Y,
        program::ImageUp::X => ImageUp::X,
    };
    let [height_m, fov_rad] = [camera.height_m, camera.fov_rad].map(|number| number as f32);
    Ok(TopDownCamera::new(height_m, fov_rad, camera.image_px)?.with_up(up))
}

/// Chooses a film's colours: those of the table, and shades of the cloth's sides, the table and the picker's marker.
fn palette(look: &Look) -> Vec<[u8; 3]> {
    let marker = |holds| {
        Marker {
            tip: [0.0; 3],
            holds,
        }
        .colour()
    };
    let shaded = [look.top, look.underside].map(|colour| (colour, 80));
    let few =
        [look.tiles[0], look.tiles[1], marker(false), marker(true)].map(|colour| (colour, 23));
    let mut colours = look.tiles.to_vec();
    for (colour, n) in shaded.into_iter().chain(few) {
        colours.extend((0..n).map(|step| {
            let brightness = 0.26 + 0.86 * step as f32 / (n - 1) as f32;
            colour.map(|level| (f32::from(level) * brightness).min(255.0) as u8)
        }));
    }
    debug_assert!(colours.len() <= MAX_COLOURS, "{}", colours.len());
    colours
}

#[cfg(test)]
#[path = "tests/film.rs"]
mod tests;
