//! What becomes of a corner of a flat square cloth that is carried along the diagonal and let go.
//!
//! In: the simulator's parameters and the distance between particles. Out: where the corner comes to rest, and how far
//! it must be carried to stay. World, motion and search are those of a demonstrated step.

use crate::metrics::cloth_moved;
use crate::simulated::Params;
use crate::start::Start;
use crate::{Grip, SimulatedWorld, World, WorldError, WorldPoint, smallest_fold};
use fab_base::interrupt::Interrupt;
use fab_program::{Camera, Cloth, ClothStart, ImageUp, Picker, SmallestFold, particles_along};

/// How far the corner is carried, millimetres.
pub const CARRIED_MM: u32 = 40;

/// The side of the cloth between its outermost particles, metres.
const SIDE_M: f64 = 0.3375;

/// The back left corner of a square cloth.
pub struct CornerFold {
    cloth: Start,
    world: SimulatedWorld,
    corner: WorldPoint,
}

impl CornerFold {
    /// Lays the cloth: 340 mm a side, or as much of it as a grid holds.
    pub fn new(parameters: Params, spacing_m: f64) -> Result<CornerFold, WorldError> {
        let particles = particles_along(SIDE_M, spacing_m);
        let cloth = Start::flat(&Cloth {
            dimx: particles,
            dimy: particles,
            spacing_m,
            material: None,
            start: ClothStart::Flat,
        });
        // Nothing looks through it.
        let camera = Camera {
            height_m: 0.65,
            fov_rad: std::f64::consts::FRAC_PI_4,
            image_px: 32,
            up: ImageUp::Y,
        };
        let [x, y, z] = cloth.positions[0].map(f64::from);
        Ok(CornerFold {
            cloth,
            world: SimulatedWorld::new(&camera, Picker::PutDown)?.with_parameters(parameters),
            corner: WorldPoint::new(x, y, z),
        })
    }

    /// Carries the corner by [`CARRIED_MM`] and returns how far from its place it comes to rest, millimetres; `None` if
    /// nothing was held.
    pub fn stays_mm(&mut self, interrupt: &Interrupt) -> Result<Option<f64>, WorldError> {
        let motion = self.grip(CARRIED_MM).into();
        self.world.reset(&self.cloth)?;
        let executed = self.world.act(&motion, interrupt)?;
        let after = self.world.particles().unwrap_or_default();
        let moved = cloth_moved(&self.cloth.positions, &after, &executed);
        Ok(moved
            .and_then(|moved| moved.held)
            .map(|held| held.stayed_mm))
    }

    /// Searches the smallest fold that stays.
    pub fn smallest(&mut self, interrupt: &Interrupt) -> Result<SmallestFold, WorldError> {
        // Hardly longer than the distance of two particles, so that it goes back.
        let grip = self.grip(10);
        smallest_fold::find(&self.cloth, &grip, &mut self.world, interrupt)
    }

    fn grip(&self, carried_mm: u32) -> Grip {
        let share = 0.001 * f64::from(carried_mm) / 2.0_f64.sqrt();
        let [x, y] = [self.corner.x + share, self.corner.y - share];
        Grip::new(self.corner, WorldPoint::new(x, y, self.corner.z))
    }
}

#[cfg(test)]
#[path = "tests/corner_fold.rs"]
mod tests;
