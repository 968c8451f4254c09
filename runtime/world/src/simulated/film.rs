//! Films of a simulated cloth: the whole motion as an animated picture from one side, for people.
//!
//! In: the cloth after every step, while a world or a verb moves it. Out: one GIF file, written as the motion goes on.
//! A film changes nothing in the simulation. It keeps below [`MAX_BYTES`] by leaving out pictures where a motion is too
//! long for all of them, and counts those. Faults do not stop the motion; [`Recorder::finish`] returns the first one.

use fab_base::interrupt::Interrupt;
use fab_picture::animation::{Animation, AnimationError, MAX_COLOURS, Palette, Written};
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
const SIZE_PX: [u32; 2] = [384, 288];

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

/// Takes a film; clones write the same one.
#[derive(Clone)]
pub struct Recorder(Arc<Mutex<Recording>>);

struct Recording {
    plan: FilmPlan,
    /// `None` until there is a cloth.
    open: Option<Open>,
    fault: Option<AnimationError>,
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
    /// Begins a film; its file is begun with the first cloth.
    pub fn new(plan: FilmPlan) -> Recorder {
        Recorder(Arc::new(Mutex::new(Recording {
            plan,
            open: None,
            fault: None,
        })))
    }

    /// Shows the cloth before the first motion.
    pub fn begin(&self, cloth: &Simulator, look: &Look) {
        self.locked()
            .attempt(|recording| recording.begin(cloth, look));
    }

    /// Shows the cloth after a step, if a picture is due; cheap if not.
    pub fn step(&self, cloth: &Simulator) {
        if cloth.steps().is_multiple_of(STEPS_A_PICTURE) {
            self.locked().attempt(|recording| recording.step(cloth));
        }
    }

    /// Shows the cloth after a motion, or where it was interrupted.
    pub fn end_motion(&self, cloth: &Simulator) {
        self.locked()
            .attempt(|recording| recording.end_motion(cloth));
    }

    /// Ends the film; `None`, and no file, if no cloth was ever laid.
    ///
    /// Fails with the first fault, and then leaves no file. Nothing is recorded afterwards.
    pub fn finish(&self) -> Result<Option<Film>, AnimationError> {
        let mut recording = self.locked();
        let open = recording.open.take();
        if let Some(fault) = recording.fault.take() {
            return Err(fault);
        }
        let Some(mut open) = open else {
            return Ok(None);
        };
        open.animation.hold(END_CS);
        let Some(Written {
            path,
            pictures,
            shown_cs,
            bytes,
        }) = open.animation.finish()?
        else {
            return Ok(None);
        };
        Ok(Some(Film {
            file: path,
            pictures,
            shown_s: shown_cs as f64 / 100.0,
            bytes,
            left_out: open.left_out,
        }))
    }

    fn locked(&self) -> MutexGuard<'_, Recording> {
        // A film of which one picture failed is as good as before.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Recording {
    /// Does something, unless there was a fault; keeps the first fault.
    fn attempt(&mut self, work: impl FnOnce(&mut Recording) -> Result<(), AnimationError>) {
        if self.fault.is_none()
            && let Err(fault) = work(self)
        {
            self.fault = Some(fault);
            self.open = None;
        }
    }

    fn begin(&mut self, cloth: &Simulator, look: &Look) -> Result<(), AnimationError> {
        let camera = slanted(&self.plan.camera).map_err(|error| AnimationError::Unwritable {
            path: self.plan.path.clone(),
            why: error.to_string(),
        })?;
        let view = SlantedView::new(camera, look);
        let mut animation = Animation::create(&self.plan.path, SIZE_PX, palette(look))?;
        animation.show(&picture(&view, cloth, None))?;
        animation.hold(START_CS);
        self.open = Some(Open {
            animation,
            view,
            at_step: cloth.steps(),
            still_cs: 0,
            granted: self.plan.max_bytes as f64 * AHEAD,
            left_out: 0,
        });
        Ok(())
    }

    fn step(&mut self, cloth: &Simulator) -> Result<(), AnimationError> {
        let max_bytes = self.plan.max_bytes as f64;
        let planned_steps = u64::from(self.plan.motions.max(1)) * PLANNED_STEPS;
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        open.pass_time(cloth);
        let share = STEPS_A_PICTURE as f64 / planned_steps as f64;
        // The end of what may be spent is for the ends of motions.
        let most = max_bytes * (1.0 - AHEAD);
        open.granted = (open.granted + share * max_bytes * (1.0 - 2.0 * AHEAD)).min(most);
        if open.animation.bytes() as f64 > open.granted {
            open.left_out += 1;
            return Ok(());
        }
        open.show(cloth)
    }

    fn end_motion(&mut self, cloth: &Simulator) -> Result<(), AnimationError> {
        let max_bytes = self.plan.max_bytes as f64;
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        open.pass_time(cloth);
        // Half of that is for the last picture of all, whose end is not known in advance.
        if open.animation.bytes() as f64 > max_bytes * (1.0 - 0.5 * AHEAD) {
            open.left_out += 1;
            return Ok(());
        }
        open.show(cloth)?;
        open.animation.hold(END_OF_MOTION_CS);
        Ok(())
    }
}

impl Open {
    /// Shows the last picture for the time since then; what stands still is shortened.
    fn pass_time(&mut self, cloth: &Simulator) {
        let steps = cloth.steps().saturating_sub(self.at_step);
        self.at_step = cloth.steps();
        let longer = (steps * STEP_CS).min(MAX_STILL_CS.saturating_sub(self.still_cs));
        self.still_cs += longer;
        self.animation
            .hold(u32::try_from(longer).unwrap_or(u32::MAX));
    }

    fn show(&mut self, cloth: &Simulator) -> Result<(), AnimationError> {
        let picture = picture(&self.view, cloth, Some(&cloth.marker()));
        if self.animation.show(&picture)? {
            self.still_cs = 0;
        }
        Ok(())
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
    SlantedCamera::new([x, y, up], [target_x, target_y, 0.0], 0.76, SIZE_PX)
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

/// Chooses a film's colours: every shade of the cloth's sides, of table and marker, and what lies between them.
fn palette(look: &Look) -> Palette {
    let times = |colour: [u8; 3], brightness: f32| {
        colour.map(|channel| (f32::from(channel) * brightness).min(255.0) as u8)
    };
    let between = |a: [u8; 3], b: [u8; 3], share: f32| {
        [0, 1, 2].map(|channel| {
            let [a, b] = [a, b].map(|colour| f32::from(colour[channel]));
            (a + share * (b - a)) as u8
        })
    };
    let ramp = |low: f32, high: f32, n: u32| {
        (0..n).map(move |step| low + (high - low) * step as f32 / (n - 1) as f32)
    };
    let sides = [look.top, look.underside];
    // First what must be exact: the colours themselves.
    let mut colours: Vec<[u8; 3]> = look.tiles.into_iter().chain(sides).collect();
    for side in sides {
        colours.extend(ramp(0.26, 1.12, 52).map(|brightness| times(side, brightness)));
    }
    let tiles = [
        look.tiles[0],
        look.tiles[1],
        times(look.tiles[0], 0.8),
        times(look.tiles[1], 0.8),
    ];
    for tile in tiles {
        for side in sides {
            for brightness in [0.64, 0.95] {
                let edge = times(side, brightness);
                colours.extend(ramp(0.25, 0.75, 3).map(|share| between(tile, edge, share)));
            }
        }
        colours.extend(ramp(0.25, 0.75, 3).map(|share| between(tile, times(tile, 0.8), share)));
    }
    for holds in [false, true] {
        let marker = Marker {
            tip: [0.0; 3],
            holds,
        };
        let colour = marker.colour();
        colours.extend(ramp(0.4, 1.1, 9).map(|brightness| times(colour, brightness)));
        for other in [look.tiles[0], look.top, look.underside] {
            colours.extend(ramp(0.25, 0.75, 3).map(|share| between(colour, other, share)));
        }
    }
    for brightness in [0.64, 0.95] {
        let [top, underside] = sides.map(|side| times(side, brightness));
        colours.extend(ramp(0.2, 0.8, 4).map(|share| between(top, underside, share)));
    }
    colours.dedup();
    debug_assert!(colours.len() <= MAX_COLOURS, "{}", colours.len());
    Palette::new(colours)
}

#[cfg(test)]
#[path = "tests/film.rs"]
mod tests;
