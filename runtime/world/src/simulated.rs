//! The bundled cloth simulator as a [`World`]; this module alone names the simulator's crate.

pub mod film;

use self::film::Recorder;
use super::{Executed, Grasp, Motion, World, WorldError};
use crate::crumple;
use crate::start::Start;
use fab_base::interrupt::Interrupt;
use fab_picture::DepthImage;
use fab_picture::camera::Camera;
use fab_picture::observation::Observation;
use fab_program as program;
pub use fab_sim::Look;
use fab_sim::{Aim, Grid, Mask, Params, SimError, Simulator, TopDownCamera};
use image::RgbImage;

/// Why a cloth with missing particles is not laid for actions: its corners, which tasks name, may not exist.
pub const OUTLINED: &str =
    "it has an outline, and a rollout needs a whole cloth; `fabc sim render` and `export` take it";

/// A simulated cloth under a simulated camera.
pub struct SimulatedWorld {
    parameters: Params,
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

    /// Changes the colours of cloth and table.
    pub fn with_look(self, look: Look) -> SimulatedWorld {
        SimulatedWorld { look, ..self }
    }

    /// Lays a cloth as a start says.
    fn lay(&self, start: &Start) -> Result<Simulator, WorldError> {
        let wrong = |why: String| WorldError::Start {
            start: start.name.clone(),
            why,
        };
        let grid = Grid::new(
            start.grid.dimx as usize,
            start.grid.dimy as usize,
            start.grid.spacing_m as f32,
        )
        .map_err(|error| wrong(error.to_string()))?;
        let mask = match &start.outline {
            Some(outline) => Mask::parse(&outline.text(), grid.spacing_m)
                .map_err(|error| wrong(error.to_string()))?,
            None => Mask::full(grid),
        };
        if mask.grid() != grid {
            return Err(wrong("its outline is of another grid".to_owned()));
        }
        let mut cloth = Simulator::from_positions(mask, &start.positions, &self.parameters)
            .map_err(|error| wrong(error.to_string()))?;
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

    fn reset(&mut self, start: &Start) -> Result<(), WorldError> {
        if start.outline.is_some() {
            return Err(WorldError::Start {
                start: start.name.clone(),
                why: OUTLINED.to_owned(),
            });
        }
        let cloth = self.lay(start)?;
        if let Some(recorder) = &self.recorder {
            recorder.begin(&cloth, &self.look);
        }
        self.cloth = Some(cloth);
        Ok(())
    }

    fn observe(&mut self) -> Result<Observation, WorldError> {
        let cloth = self.cloth()?;
        let frame = self
            .lens
            .render(cloth.grid(), &cloth.positions(), &self.look);
        const INVARIANT: &str = "a frame holds width * height pixels";
        Ok(Observation {
            rgb: RgbImage::from_raw(frame.width, frame.height, frame.rgb).expect(INVARIANT),
            depth_m: DepthImage::from_raw(frame.width, frame.height, frame.depth_m)
                .expect(INVARIANT),
            camera: self.camera.clone(),
            time_s: cloth.time_s(),
        })
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        let cloth = self.cloth.as_mut().ok_or(WorldError::NotReset)?;
        let on_table = |point: &super::WorldPoint| [point.x as f32, point.y as f32];
        let [pick, place] = [&motion.pick, &motion.place].map(on_table);
        let recorder = self.recorder.as_ref();
        let done =
            film::pick_and_place(cloth, pick, place, recorder, interrupt).map_err(stopped)?;
        Ok(Executed {
            motion: *motion,
            grasp: done
                .grasped
                .map_or(Grasp::Missed, |particle| Grasp::Particle(particle as u32)),
            duration_s: done.time_s,
        })
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
