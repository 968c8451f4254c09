//! Twins: simulated cloths on which an action is tried before a world moves.
//!
//! In: a [`Sighting`] of a flat cloth in a camera's picture, and what the task declares about its twins. Out: a [`Twin`]
//! that folds and is looked at. A twin has a simulator of its own. It is made of no [`World`] and no
//! [`Start`], so it cannot hold a world's particles: the only thing that it gets of a world are
//! pictures and executed motions.
//!
//! ```
//! # use fab_world::twin::{Drawn, Kind, Sighting, Twin};
//! # fn can(seen: &Sighting, kind: &Kind<'_>, drawn: Drawn) {
//! let twin = Twin::lay(seen, kind, drawn);
//! # }
//! ```
//!
//! It is laid from what a camera saw, and from nothing else:
//!
//! ```compile_fail,E0308
//! # use fab_world::twin::{Drawn, Kind, Sighting, Twin};
//! # fn cannot(world: &dyn fab_world::World, kind: &Kind<'_>, drawn: Drawn) {
//! let particles = world.particles().expect("a world that knows them");
//! let twin = Twin::lay(&particles, kind, drawn);
//! # }
//! ```

use crate::simulated::{SimulatedWorld, look};
use crate::start::Start;
use crate::vary::AxisValues;
use crate::{Motion, World, WorldError};
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_picture::camera::center_of;
use fab_picture::observation::Observation;
use fab_picture::{Mask, depth_mask};
use fab_program::{self as program, ClothStart, PixelPoint, TwinRanges, particles_along};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// How much nearer than the bare table a pixel must be to show a twin, metres: well above the rounding of depths and
/// below half the thinnest cloth.
const ABOVE_TABLE_M: f64 = 0.0001;

/// Where a flat cloth lies, as a camera's picture shows it. Table frame, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    center_m: [f64; 2],
    /// Its sides along and across `turn_rad`.
    sides_m: [f64; 2],
    /// Counter-clockwise as seen from above, from -45 to 45 degrees.
    turn_rad: f64,
}

impl Sighting {
    /// Finds the cloth on the table.
    ///
    /// - `corners_px`: of the rectangle around the cloth in the observation's picture, `[column, row]`, in order around.
    ///
    /// The cloth's height is the depth in the rectangle's middle. `None` if the camera does not look at the table there,
    /// or the rectangle has no area.
    pub fn of(observation: &Observation, corners_px: [[f64; 2]; 4]) -> Option<Sighting> {
        let middle = [0, 1].map(|axis| corners_px.iter().map(|it| it[axis]).sum::<f64>() / 4.0);
        let [column, row] = middle.map(|at| at.max(0.0) as u32);
        let reading = observation.depth_m.get_pixel_checked(column, row);
        let depth_m = reading.map_or(0.0, |it| f64::from(it.0[0]));
        let camera = &observation.camera;
        let point = |at: [f64; 2]| {
            let seen = camera.world_from_pixel(at, depth_m);
            let point = seen.or_else(|| camera.table_from_pixel(at))?;
            Some([point.x, point.y])
        };
        let [a, b, c, d] = corners_px.map(point);
        let corners = [a?, b?, c?, d?];
        let between = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
        let mean = |a: [f64; 2], b: [f64; 2]| [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
        // Opposite sides, in the same direction.
        let along = mean(
            between(corners[0], corners[1]),
            between(corners[3], corners[2]),
        );
        let across = mean(
            between(corners[1], corners[2]),
            between(corners[0], corners[3]),
        );
        let [along_m, across_m] = [along, across].map(|side| side[0].hypot(side[1]));
        if !(along_m > 0.0 && across_m > 0.0) {
            return None;
        }
        let angle = along[1].atan2(along[0]);
        let quarters = (angle / FRAC_PI_2).round();
        let is_turned = quarters.rem_euclid(2.0) == 1.0;
        Some(Sighting {
            center_m: [0, 1].map(|axis| corners.iter().map(|it| it[axis]).sum::<f64>() / 4.0),
            sides_m: match is_turned {
                true => [across_m, along_m],
                false => [along_m, across_m],
            },
            turn_rad: angle - quarters * FRAC_PI_2,
        })
    }
}

/// What all twins of a task share.
#[derive(Clone, Copy, Debug)]
pub struct Kind<'a> {
    /// The task's camera, with which twins are looked at.
    pub camera: &'a program::Camera,
    /// How they are picked, carried and released.
    pub picker: program::Picker,
    /// What they are made of, and the ranges of what is drawn.
    pub ranges: &'a TwinRanges,
    /// The cloth that the task declares; only its colours and the distance between its particles are used.
    pub cloth: &'a program::Cloth,
}

/// The drawn values of a twin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// Its sides, as a factor of those that the camera sees.
    pub size: f64,
    /// Its coefficient of friction on the table.
    pub friction: f64,
}

impl Drawn {
    /// Draws a twin's values; equal seeds give equal ones.
    pub fn by(ranges: &TwinRanges, seed: &str) -> Drawn {
        let mut chance = Chance::of(seed);
        let mut within = |[low, high]: [f64; 2]| low + (high - low) * chance.fraction();
        Drawn {
            size: within(ranges.size),
            friction: within(ranges.friction),
        }
    }
}

/// A simulated cloth that stands for the one that a camera sees.
#[derive(Clone)]
pub struct Twin {
    world: SimulatedWorld,
    /// Depth of the bare table, metres.
    table_m: f64,
}

/// A twin as its camera sees it.
pub struct TwinView {
    /// The picture.
    pub observation: Observation,
    /// Which pixels show the twin.
    pub silhouette: Mask,
}

impl Twin {
    /// Lays a twin where a cloth was seen.
    ///
    /// Fails if the material is too stiff for a cloth of this size, or the camera cannot be simulated.
    pub fn lay(seen: &Sighting, kind: &Kind<'_>, drawn: Drawn) -> Result<Twin, WorldError> {
        let friction = BTreeMap::from([("friction".to_owned(), drawn.friction)]);
        let mut world = SimulatedWorld::new(kind.camera, kind.picker)?
            .with_material(kind.ranges.material.as_ref())
            .with_look(look(kind.cloth.material.as_ref()))
            .varied(&AxisValues(friction), kind.camera);
        let spacing_m = kind.ranges.spacing_m(kind.cloth);
        let [dimx, dimy] = seen
            .sides_m
            .map(|side_m| particles_along(side_m, spacing_m));
        let cells = [dimx, dimy].map(|count| f64::from(count - 1));
        let cell_m = |axis: usize| seen.sides_m[axis] / cells[axis];
        let cloth = program::Cloth {
            dimx,
            dimy,
            spacing_m: drawn.size * (cell_m(0) * cell_m(1)).sqrt(),
            start: ClothStart::Flat,
            material: kind.ranges.material.clone(),
        };
        world.reset(&Start::flat(&cloth).moved(seen.turn_rad, seen.center_m))?;
        Ok(Twin {
            world,
            table_m: kind.camera.height_m,
        })
    }

    /// Picks and places on the twin. It ends early when `interrupt` is raised.
    pub fn fold(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<(), WorldError> {
        self.world.act(motion, interrupt).map(drop)
    }

    /// Looks at the twin with the task's camera.
    pub fn view(&mut self) -> Result<TwinView, WorldError> {
        let observation = self.world.observe()?;
        let silhouette = depth_mask(&observation.depth_m, self.table_m - ABOVE_TABLE_M);
        Ok(TwinView {
            observation,
            silhouette,
        })
    }
}

/// About how many pixels along a picture's side are compared; more would not change an overlap by a hundredth.
const SAMPLES: u32 = 256;

impl TwinView {
    /// Returns the overlap of the twin with the cloth of a camera's picture: the area of their intersection over that
    /// of their union, from 0 to 1. Both are compared on the table's plane.
    ///
    /// - `cloth`: the pixels of `seen` that show cloth.
    pub fn overlap_with(&self, cloth: &Mask, seen: &Observation) -> f64 {
        let step = cloth.width().max(cloth.height()).div_ceil(SAMPLES).max(1) as usize;
        let rows = (0..cloth.height() as i32).step_by(step);
        let pixels = rows.flat_map(|row| {
            let columns = (0..cloth.width() as i32).step_by(step);
            columns.map(move |column| PixelPoint::new(column, row))
        });
        fab_picture::overlap(pixels.map(|pixel| {
            let point = seen.camera.table_from_pixel(center_of(pixel));
            let at = point.and_then(|it| self.observation.camera.pixel_from_world(it));
            let is_twin = at.is_some_and(|[column, row]| {
                let pixel = PixelPoint::new(column.floor() as i32, row.floor() as i32);
                self.silhouette.contains(pixel)
            });
            (cloth.contains(pixel), is_twin)
        }))
    }
}

#[cfg(test)]
#[path = "tests/twin.rs"]
mod tests;
