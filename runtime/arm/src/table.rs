//! A simulated cloth under a simulated hand and a camera, for a simulated arm.
//!
//! In: the pose of the hand, step by step, and whether it is closed. Out: a cloth that follows it, and the camera's
//! pictures. The hand grasps one particle, like the picker of the simulated world, and touches nothing on its path.

mod sheets;

use crate::rgbd::{RgbdSource, Shot};
use crate::settings::{Settings, SimulatedSettings};
use crate::simulated::SimulatedTable;
use fab_program::Material;
use fab_sim::{Grid, ImageUp, Params, Simulator, TopDownCamera};
use fab_world::WorldError;
use fab_world::simulated::{self, Look, stopped};
use fab_world::start::Start;
use nalgebra::{Isometry3, Point3};
use std::cell::RefCell;
use std::rc::Rc;

/// How far from the fingertips cloth can be grasped: horizontally, and above or below them. Metres.
const REACH_ASIDE_M: f64 = 0.012;
const REACH_UP_M: f64 = 0.015;

/// Cloth less than this below the uppermost belongs to the same layer, metres: half of the least gap between layers.
const LAYER_M: f64 = 0.0005;

/// Everything up to this height above the table counts as the table, metres: cloth lies higher.
const TABLE_M: f64 = 0.001;

/// A cloth on a table.
pub struct ClothTable {
    cloth: Option<Simulator>,
    params: Params,
    look: Look,
    lens: TopDownCamera,
    camera: SimulatedSettings,
    /// What is printed on the table in each pixel of a picture, row by row.
    printed: Vec<Option<u8>>,
    world_from_base: Isometry3<f64>,
    /// The hand's last position, world frame, while it holds cloth.
    holds_at: Option<[f32; 3]>,
    broken: Option<String>,
}

impl ClothTable {
    /// Sets up a table without cloth; fails if the camera cannot be set up.
    ///
    /// - `material`: what every cloth is made of, and the colours of its faces; `None` is the recorded cloth.
    pub fn new(
        settings: &Settings,
        base_from_world: &Isometry3<f64>,
        material: Option<&Material>,
    ) -> Result<ClothTable, WorldError> {
        let camera = settings.simulated.clone();
        let lens = TopDownCamera::new(
            camera.camera_height_m as f32,
            crate::settings::CAMERA_FOV_RAD as f32,
            camera.camera_px,
        );
        let lens = lens.map_err(|error| WorldError::Camera {
            why: error.to_string(),
        })?;
        Ok(ClothTable {
            printed: printed(&camera),
            cloth: None,
            params: Params {
                material: material.map(simulated::material),
                ..Params::default()
            },
            look: simulated::look(material),
            lens: lens.with_up(ImageUp::Y),
            camera,
            world_from_base: base_from_world.inverse(),
            holds_at: None,
            broken: None,
        })
    }

    /// Lays a cloth as a start says.
    pub fn lay(&mut self, start: &Start) -> Result<(), WorldError> {
        simulated::check_whole(start)?;
        self.cloth = Some(simulated::laid(start, &self.params)?);
        self.holds_at = None;
        self.broken = None;
        Ok(())
    }

    /// Returns every particle's position, world frame, metres; `None` before a cloth is laid.
    pub fn particles(&self) -> Option<Vec<[f32; 3]>> {
        self.cloth.as_ref().map(Simulator::positions)
    }

    /// Takes a picture of the same cloth lying flat in the middle of the table; `None` before a cloth is laid.
    pub fn flat_shot(&self) -> Option<Shot> {
        let grid = self.cloth.as_ref()?.grid();
        Some(self.shot_of(grid, &grid.flat_positions(&self.params)))
    }

    /// Takes a picture of the table without a cloth.
    pub fn bare_shot(&self) -> Result<Shot, WorldError> {
        let anywhere = Grid::new(2, 2, 0.01).map_err(|error| WorldError::Camera {
            why: error.to_string(),
        })?;
        // A cloth this far from the table's middle is outside any picture.
        Ok(self.shot_of(anywhere, &[[1e4, 0.0, 0.0]; 4]))
    }

    /// Returns a digest of the code that moves the cloth.
    pub fn code() -> &'static str {
        fab_sim::CODE_DIGEST
    }

    fn tip(&self, tool: &Isometry3<f64>) -> [f32; 3] {
        let tip = self.world_from_base * Point3::from(tool.translation.vector);
        [tip.x as f32, tip.y as f32, tip.z as f32]
    }

    /// Renders a cloth at the given positions, world frame, metres.
    fn shot_of(&self, grid: Grid, positions: &[[f32; 3]]) -> Shot {
        // The renderer looks down on the origin, so the cloth is moved relative to the camera.
        let world_from_camera = self.camera.world_from_camera();
        let seen: Vec<[f32; 3]> = positions
            .iter()
            .map(|point| {
                let point =
                    world_from_camera.inverse_transform_point(&Point3::from(point.map(f64::from)));
                [point.x as f32, point.y as f32, point.z as f32]
            })
            .collect();
        let frame = self.lens.render(grid, &seen, &self.look);
        let (mut rgb, depth_m) = simulated::pictures(frame);
        let height_m = self.camera.camera_height_m;
        let pixels = rgb.pixels_mut().zip(depth_m.pixels());
        for ((color, depth_m), printed) in pixels.zip(&self.printed) {
            let is_table = f64::from(depth_m.0[0]) >= height_m - TABLE_M;
            if is_table && let Some(grey) = *printed {
                color.0 = [grey; 3];
            }
        }
        Shot {
            rgb,
            depth_m,
            intrinsics: Some(self.camera.intrinsics()),
        }
    }
}

/// Returns the particle that the fingers would grasp, as the simulated world's picker does: of the uppermost layer within
/// reach, the nearest.
fn grasped(positions: &[[f32; 3]], tip: [f32; 3]) -> Option<usize> {
    let aside_m =
        |point: &[f32; 3]| f64::from(point[0] - tip[0]).hypot(f64::from(point[1] - tip[1]));
    let up_m = |point: &[f32; 3]| f64::from(point[2] - tip[2]);
    let within = || {
        positions
            .iter()
            .enumerate()
            .filter(|(_, point)| aside_m(point) <= REACH_ASIDE_M && up_m(point).abs() <= REACH_UP_M)
    };
    let top_m = within()
        .map(|(_, point)| up_m(point))
        .fold(f64::MIN, f64::max);
    within()
        .filter(|(_, point)| up_m(point) >= top_m - LAYER_M)
        .min_by(|(_, a), (_, b)| aside_m(a).total_cmp(&aside_m(b)))
        .map(|(particle, _)| particle)
}

/// Returns what is printed on the table in each pixel of a picture, row by row.
fn printed(camera: &SimulatedSettings) -> Vec<Option<u8>> {
    let world_from_camera = camera.world_from_camera();
    let lens = camera.intrinsics();
    let m_per_px = camera.camera_height_m / lens.focal_px[0];
    let [width, height] = lens.size_px;
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| [column, row]));
    pixels
        .map(|[column, row]| {
            let [right, down] = [column, row].map(|at| f64::from(at) + 0.5 - lens.middle_px[0]);
            let at = world_from_camera * Point3::new(right * m_per_px, -down * m_per_px, 0.0);
            sheets::printed([at.x, at.y])
        })
        .collect()
}

impl SimulatedTable for ClothTable {
    fn advance(&mut self, seconds: f64, tool: &Isometry3<f64>, are_closed: bool) {
        let tip = self.tip(tool);
        let Some(cloth) = &mut self.cloth else {
            return;
        };
        let grasps = are_closed && self.holds_at.is_none();
        let taken = if grasps {
            grasped(&cloth.positions(), tip)
        } else {
            None
        };
        let mut step = || {
            if !are_closed && self.holds_at.take().is_some() {
                cloth.hold(&[])?;
            }
            if let Some(particle) = taken {
                cloth.hold(&[particle])?;
                self.holds_at = Some(tip);
            }
            let shift = match &mut self.holds_at {
                Some(before) => {
                    let shift = [0, 1, 2].map(|axis| tip[axis] - before[axis]);
                    *before = tip;
                    shift
                }
                None => [0.0; 3],
            };
            let steps = (seconds / f64::from(self.params.step_secs))
                .round()
                .max(1.0) as u32;
            let part = shift.map(|way| way / steps as f32);
            (0..steps).try_for_each(|_| cloth.step_held(part))
        };
        if let Err(error) = step() {
            self.broken = Some(stopped(error).to_string());
        }
    }

    fn is_cloth_between_fingers(&self, tool: &Isometry3<f64>) -> bool {
        let near = |positions: Vec<_>| grasped(&positions, self.tip(tool));
        self.holds_at.is_some() || self.particles().and_then(near).is_some()
    }
}

/// The camera over a simulated table.
pub struct TableCamera(pub Rc<RefCell<ClothTable>>);

impl RgbdSource for TableCamera {
    fn name(&self) -> String {
        "simulated".to_owned()
    }

    fn shoot(&mut self) -> Result<Shot, String> {
        let table = self.0.borrow();
        if let Some(why) = &table.broken {
            return Err(why.clone());
        }
        let cloth = table.cloth.as_ref().ok_or("no cloth has been laid yet")?;
        Ok(table.shot_of(cloth.grid(), &cloth.positions()))
    }
}

#[cfg(test)]
mod tests;
