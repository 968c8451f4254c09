//! The bundled cloth simulator as a [`World`]; in this package, this module alone names the simulator's crate.

pub mod film;

use self::film::Recorder;
use super::{Executed, ExecutedGrip, Fork, Grasp, Grip, Motion, World, WorldError};
use crate::crumple;
use crate::start::Start;
use crate::vary::{AxisValues, Setup};
use fab_base::interrupt::Interrupt;
use fab_picture::DepthImage;
use fab_picture::camera::Camera;
use fab_picture::observation::Observation;
use fab_program::{self as program, Program};
use fab_sim::{
    Aim, Frame, Grid, Manner, Mask, MaskError, PickAndPlace, SimError, Simulator, TopDownCamera,
};
pub use fab_sim::{Look, Params};
use image::RgbImage;

/// Why a cloth with missing particles is not laid for actions: its corners, which tasks name, may not exist.
const OUTLINED: &str =
    "it has an outline, and a rollout needs a whole cloth; `fabc sim render` and `export` take it";

/// A simulated cloth under a simulated camera. A clone goes on by itself; both add to one film, if there is one.
#[derive(Clone)]
pub struct SimulatedWorld {
    parameters: Params,
    variation: AxisValues,
    look: Look,
    lens: TopDownCamera,
    camera: Camera,
    cloth: Option<Simulator>,
    recorder: Option<Recorder>,
}

impl SimulatedWorld {
    /// Sets up table, camera and picker with the default physics.
    ///
    /// Fails where the camera's numbers are outside what the renderer accepts.
    pub fn new(
        camera: &program::Camera,
        picker: program::Picker,
    ) -> Result<SimulatedWorld, WorldError> {
        let lens = film::table_camera(camera).map_err(|error| WorldError::Camera {
            why: error.to_string(),
        })?;
        Ok(SimulatedWorld {
            parameters: match picker {
                program::Picker::PutDown => Params::default(),
                program::Picker::Drop => Params::with_dropping_picker(),
            },
            variation: AxisValues::default(),
            look: Look::default(),
            lens,
            camera: Camera::top_down(camera.height_m, camera.fov_rad, camera.image_px, camera.up),
            cloth: None,
            recorder: None,
        })
    }

    /// Takes a film of everything that happens.
    pub fn with_recorder(self, recorder: Recorder) -> SimulatedWorld {
        SimulatedWorld {
            recorder: Some(recorder),
            ..self
        }
    }

    /// Sets up the world of a program: its camera, its picker, and the material of its cloth.
    pub fn of(program: &Program) -> Result<SimulatedWorld, WorldError> {
        let world = SimulatedWorld::new(&program.camera, program.picker)?;
        Ok(world.with_material(program.cloth.material.as_ref()))
    }

    /// Changes what every cloth is made of, and the colours of its faces; `None` is the recorded cloth.
    pub fn with_material(mut self, material: Option<&program::Material>) -> SimulatedWorld {
        self.parameters.material = material.map(self::material);
        self.look = look(material);
        self
    }

    /// Changes the physics, with the material; the colours stay.
    pub fn with_parameters(self, parameters: Params) -> SimulatedWorld {
        SimulatedWorld { parameters, ..self }
    }

    /// Changes the colours of cloth and table.
    pub fn with_look(self, look: Look) -> SimulatedWorld {
        SimulatedWorld { look, ..self }
    }

    /// Changes the world to the values of some axes, within their bounds; how starts are laid is not the world's part.
    ///
    /// - `camera`: the task's camera.
    pub fn varied(self, values: &AxisValues, camera: &program::Camera) -> SimulatedWorld {
        let mut setup = Setup {
            parameters: self.parameters,
            look: self.look,
            ..Setup::default()
        };
        values.apply(&mut setup);
        let height_m = setup.camera_height_m.unwrap_or(camera.height_m);
        SimulatedWorld {
            parameters: setup.parameters,
            variation: values.clone(),
            look: setup.look,
            lens: TopDownCamera {
                height_m: height_m as f32,
                ..self.lens
            },
            camera: Camera::top_down(height_m, camera.fov_rad, camera.image_px, camera.up),
            ..self
        }
    }

    /// Makes the simulated cloth of a start, with an outline too; a rollout calls [`check_whole`] first.
    fn lay(&self, start: &Start) -> Result<Simulator, WorldError> {
        let mut cloth = laid(start, &self.parameters)?;
        cloth.set_aim(Aim::Uppermost);
        Ok(cloth)
    }

    fn cloth(&self) -> Result<&Simulator, WorldError> {
        self.cloth.as_ref().ok_or(WorldError::NotReset)
    }
}

impl World for SimulatedWorld {
    fn name(&self) -> &str {
        "sim"
    }

    fn parameters(&self) -> String {
        self.parameters.hash()
    }

    fn code(&self) -> String {
        fab_sim::CODE_DIGEST.to_owned()
    }

    fn variation(&self) -> AxisValues {
        self.variation.clone()
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn reset(&mut self, start: &Start) -> Result<(), WorldError> {
        check_whole(start)?;
        let cloth = self.lay(start)?;
        if let Some(recorder) = &self.recorder {
            recorder.begin(&cloth, &self.look);
        }
        self.cloth = Some(cloth);
        Ok(())
    }

    fn fork(&self) -> Option<Fork> {
        Some(Box::new(self.clone()))
    }

    fn observe(&mut self) -> Result<Observation, WorldError> {
        let cloth = self.cloth()?;
        let frame = self
            .lens
            .render(cloth.grid(), &cloth.positions(), &self.look);
        let (rgb, depth_m) = pictures(frame);
        Ok(Observation {
            rgb,
            depth_m,
            camera: self.camera.clone(),
            time_s: cloth.time_s(),
            notes: Vec::new(),
        })
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        let cloth = self.cloth.as_mut().ok_or(WorldError::NotReset)?;
        let grip = motion.only("sim")?;
        let (manner, [pick, place]) = in_metres(&grip);
        let recorder = self.recorder.as_ref();
        let done = film::pick_and_place(cloth, &manner, pick, place, recorder, interrupt)
            .map_err(stopped)?;
        Ok(executed(grip, &done))
    }

    fn crumple(
        &self,
        start: &Start,
        seed: u64,
        interrupt: &Interrupt,
    ) -> Result<Start, WorldError> {
        let mut cloth = self.lay(start)?;
        cloth
            .crumple_until(
                seed,
                crumple::MOST_LIFTS,
                &|positions| crumple::is_start(positions, start),
                &|| interrupt.is_raised(),
            )
            .map_err(stopped)?;
        Ok(start.crumpled(seed, cloth.positions()))
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        self.cloth.as_ref().map(Simulator::positions)
    }

    /// Of a cloth of a material alone: the recorded scene's is held against recordings, and not against real cloth.
    fn crossings(&self) -> Option<usize> {
        self.parameters.material.as_ref()?;
        let cloth = self.cloth.as_ref()?;
        Some(fab_sim::crossings(cloth.mask(), &cloth.positions()))
    }

    fn refuses(&self, _: &Motion) -> Option<String> {
        None
    }
}

/// Lays a cloth as a start says.
pub fn laid(start: &Start, parameters: &Params) -> Result<Simulator, WorldError> {
    let wrong = |why: String| WorldError::Start {
        start: start.name.clone(),
        why,
    };
    let mask = mask(start).map_err(|error| wrong(error.to_string()))?;
    let Grid { dimx, dimy, .. } = mask.grid();
    if [dimx, dimy] != [start.grid.dimx, start.grid.dimy].map(|side| side as usize) {
        return Err(wrong("its outline is of another grid".to_owned()));
    }
    let cloth = Simulator::from_positions(mask, &start.positions, parameters);
    cloth.map_err(|error| wrong(error.to_string()))
}

/// Returns which particles of a start's grid there are.
pub fn mask(start: &Start) -> Result<Mask, MaskError> {
    let (dimx, dimy) = (start.grid.dimx as usize, start.grid.dimy as usize);
    let spacing_m = start.grid.spacing_m as f32;
    match &start.outline {
        Some(outline) => Mask::parse(&outline.text(), spacing_m),
        None => Ok(Mask::full(Grid::new(dimx, dimy, spacing_m)?)),
    }
}

/// Refuses a cloth with missing particles: its corners, which tasks name, may not exist.
pub fn check_whole(start: &Start) -> Result<(), WorldError> {
    let refused = start.outline.as_ref().map(|_| WorldError::Start {
        start: start.name.clone(),
        why: OUTLINED.to_owned(),
    });
    refused.map_or(Ok(()), Err)
}

/// Returns the pictures of a frame: its colours, and its depths in metres.
pub fn pictures(frame: Frame) -> (RgbImage, DepthImage) {
    const INVARIANT: &str = "a frame holds width * height pixels";
    let Frame { width, height, .. } = frame;
    (
        RgbImage::from_raw(width, height, frame.rgb).expect(INVARIANT),
        DepthImage::from_raw(width, height, frame.depth_m).expect(INVARIANT),
    )
}

/// Returns a grip as the simulator takes it: its manner, and where on the table it picks and places.
fn in_metres(grip: &Grip) -> (Manner, [[f32; 2]; 2]) {
    let metres = |value: Option<f64>| value.map(|value| value as f32);
    let manner = Manner {
        lift_m: metres(grip.manner.lift_m),
        speed_m_s: metres(grip.manner.speed_m_s),
        release_height_m: metres(grip.manner.release_height_m),
        press_m: metres(grip.manner.press_m),
    };
    let on_table = |point: &super::WorldPoint| [point.x as f32, point.y as f32];
    (manner, [&grip.pick, &grip.place].map(on_table))
}

/// Returns what a grip really did, as a world says it.
fn executed(grip: Grip, done: &PickAndPlace) -> Executed {
    let done_grip = ExecutedGrip {
        grip,
        grasp: done
            .grasped
            .map_or(Grasp::Missed, |particle| Grasp::Particle(particle as u32)),
        released_at: done.released_at.map(|point| point.map(f64::from).into()),
    };
    Executed {
        grips: vec![done_grip],
        duration_s: done.time_s,
    }
}

/// Returns a material as the simulator takes it.
pub fn material(declared: &program::Material) -> fab_sim::Material {
    let directions = |along: program::Directions| fab_sim::Directions {
        warp: along.warp as f32,
        weft: along.weft as f32,
        bias: along.bias as f32,
    };
    fab_sim::Material {
        weight_kg_m2: declared.weight_kg_m2 as f32,
        thickness_m: declared.thickness_m as f32,
        bending_length_m: directions(declared.bending_length_m),
        crease_recovery_deg: declared.crease_recovery_deg as f32,
        stretch: directions(declared.stretch),
        table_friction: declared.table_friction as f32,
        self_friction: declared.self_friction as f32,
    }
}

/// Returns the colours of a cloth of this material on the recorded table.
pub fn look(material: Option<&program::Material>) -> Look {
    match material {
        None => Look::default(),
        Some(material) => Look {
            top: material.upper.rgb,
            underside: material.under.rgb,
            ..Look::default()
        },
    }
}

/// Says in the world's words why the simulator stopped.
pub fn stopped(error: SimError) -> WorldError {
    match error {
        SimError::Interrupted { .. } => WorldError::Interrupted,
        other => WorldError::Motion {
            why: other.to_string(),
        },
    }
}

#[cfg(test)]
pub(crate) mod tests;
