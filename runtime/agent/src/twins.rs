//! The twins of one rollout: laid once from a camera's picture, carried along, and folded before the world moves.
//!
//! In: what the task declares, pictures of the cloth, executed motions, and actions to try. Out: measures of the
//! results, and whether the twins can still be trusted. Twins get nothing else of the world: in particular no particles,
//! no start and no true material. A cloth that does not lie flat at first gives twins that overlap little with it, so
//! they are not trusted.

use crate::record::{RehearsedAnswer, RehearsedStep};
use crate::result::{Alignment, overlap, silhouette};
use crate::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_picture::Mask;
use fab_picture::observation::Observation;
use fab_program::{Camera, Distrusted, Material, Picker, Program, Rehearsal, RehearsalMeasure};
use fab_vision::{Rectangle, VisionError};
use fab_world::twin::{Drawn, Kind, Sighting, Twin, TwinView};
use fab_world::{Motion, World, WorldError};
use image::RgbImage;
use std::time::{Duration, Instant};

/// The twins of one rollout.
pub struct Twins {
    rehearsal: Rehearsal,
    camera: Camera,
    picker: Picker,
    colours: Option<Material>,
    /// Distinguishes the draws of rollouts.
    seed: String,
    /// Whether nothing real can move.
    is_simulated: bool,
    /// The silhouettes of the subgoal pictures, from the unfolded cloth on.
    subgoals: Vec<Mask>,
    /// The current step, from 1.
    step: u32,
    laid: Option<Vec<Laid>>,
    /// The results of this step's answers.
    tried: Vec<Tried>,
    line: RehearsedStep,
    took: Duration,
}

/// A twin on the table.
struct Laid {
    twin: Twin,
    /// The pixels that it covered where it lay flat.
    flat_px: usize,
    /// Brings it onto the unfolded cloth of the subgoal pictures, if there are any.
    alignment: Option<Alignment>,
}

/// What came of a motion.
struct Tried {
    motion: Motion,
    /// The twins after it.
    twins: Vec<Twin>,
    measures: Vec<f64>,
    /// The first twin as the camera would see it.
    picture: RgbImage,
}

/// Why an action could not be tried.
#[derive(Debug)]
pub enum Untried {
    /// A stop was requested.
    Interrupted,
    /// A twin failed.
    Failed(String),
}

impl Twins {
    /// Prepares the twins of a rollout; `None` if the task does not rehearse.
    ///
    /// - `draws`: distinguishes the draws of rollouts; equal ones give equal twins.
    /// - `world`: only asked whether it is simulated.
    pub fn of(
        program: &Program,
        subgoals: &SubgoalSet,
        draws: &str,
        world: &dyn World,
    ) -> Option<Twins> {
        Some(Twins {
            rehearsal: program.rehearsal.clone()?,
            camera: program.camera.clone(),
            picker: program.picker,
            colours: program.cloth.material.clone(),
            seed: format!("twin {draws}"),
            is_simulated: world.is_simulated(),
            subgoals: subgoals.pictures.iter().map(silhouette).collect(),
            step: 1,
            laid: None,
            tried: Vec::new(),
            line: RehearsedStep::default(),
            took: Duration::ZERO,
        })
    }

    /// Compares the twins with the camera's picture at the beginning of an action; the first picture lays them.
    ///
    /// - `step`: of the task, from 1.
    /// - `cloth`: the pixels that show cloth.
    pub fn look(&mut self, step: u32, observation: &Observation, cloth: Option<&Mask>) {
        let begun = Instant::now();
        self.step = step;
        self.tried.clear();
        self.line = RehearsedStep::default();
        if let Err(why) = self.compare(observation, cloth) {
            self.line.aside = Some(why);
        }
        self.took += begun.elapsed();
    }

    fn compare(&mut self, observation: &Observation, cloth: Option<&Mask>) -> Result<(), String> {
        let cloth = cloth.ok_or("the picture shows no cloth")?;
        if self.laid.is_none() {
            let laid = self.lay(observation, cloth);
            // Without twins at first there are none later.
            self.laid = Some(Vec::new());
            self.laid = Some(laid?);
        }
        let laid = self.laid.as_mut().filter(|laid| !laid.is_empty());
        let laid = laid.ok_or("there are no twins of this cloth")?;
        let mut overlaps = Vec::with_capacity(laid.len());
        for it in laid.iter_mut() {
            let view = it.twin.view().map_err(|error| error.to_string())?;
            overlaps.push(view.overlap_with(cloth, observation));
        }
        let overlap = mean(&overlaps);
        self.line.overlap = Some(overlap);
        let trusted = self.rehearsal.trust_above;
        match overlap > trusted {
            true => Ok(()),
            false => Err(format!(
                "twins and camera overlap by {overlap:.3}, and the task trusts more than {trusted}"
            )),
        }
    }

    /// Lays the twins where the camera sees the cloth.
    fn lay(&self, observation: &Observation, cloth: &Mask) -> Result<Vec<Laid>, String> {
        let failed = |error: VisionError| error.to_string();
        let rectangle = fab_vision::rectangle_around(cloth).map_err(failed)?;
        let rectangle = rectangle.ok_or("the picture shows no cloth")?;
        let seen = Sighting::of(observation, corners_px(&rectangle));
        let seen = seen.ok_or("the camera does not tell where on the table the cloth lies")?;
        let kind = Kind {
            camera: &self.camera,
            picker: self.picker,
            ranges: &self.rehearsal.twin,
            colours: self.colours.as_ref(),
        };
        let twins = (1..=self.rehearsal.twin.draws).map(|draw| {
            let drawn = Drawn::by(kind.ranges, &format!("{} {draw}", self.seed));
            let mut twin = Twin::lay(&seen, &kind, drawn).map_err(|error| error.to_string())?;
            let flat = twin.view().map_err(|error| error.to_string())?.silhouette;
            let shown = self.subgoals.first();
            let alignment = shown.map(|shown| Alignment::of(&flat, shown)).transpose();
            Ok(Laid {
                twin,
                flat_px: flat.area_px(),
                alignment: alignment.map_err(failed)?.flatten(),
            })
        });
        twins.collect()
    }

    /// Returns why the step is not rehearsed; `None` if it is.
    pub fn aside(&self) -> Option<&str> {
        self.line.aside.as_deref()
    }

    /// Returns why nothing may move, if the task refuses to move without twins and something real would.
    pub fn refusal(&self) -> Option<String> {
        let why = self.aside()?;
        let refuses = self.rehearsal.distrusted == Distrusted::Refuses && !self.is_simulated;
        refuses.then(|| format!("the rehearsal refused to move: {why}"))
    }

    /// Folds an action on the twins, and records the result.
    ///
    /// - `attempt`: the number of its question among those of the stage.
    ///
    /// Returns the mean of the declared measure; `None` if none is declared.
    pub fn try_action(
        &mut self,
        attempt: u32,
        motion: &Motion,
        interrupt: &Interrupt,
    ) -> Result<Option<f64>, Untried> {
        let begun = Instant::now();
        let tried = match self.tried.iter().position(|it| it.motion == *motion) {
            Some(known) => Ok(known),
            None => self.fold(motion, interrupt).map(|tried| {
                self.tried.push(tried);
                self.tried.len() - 1
            }),
        };
        self.took += begun.elapsed();
        let (measures, failed) = match &tried {
            Ok(tried) => (self.tried[*tried].measures.clone(), None),
            Err(Untried::Failed(why)) => (Vec::new(), Some(why.clone())),
            Err(Untried::Interrupted) => return Err(Untried::Interrupted),
        };
        let measure = (!measures.is_empty()).then(|| mean(&measures));
        self.line.candidates.push(RehearsedAnswer {
            attempt,
            measure,
            twins: measures,
            failed,
        });
        tried.map(|_| measure)
    }

    fn fold(&self, motion: &Motion, interrupt: &Interrupt) -> Result<Tried, Untried> {
        let failed = |error: WorldError| match error {
            WorldError::Interrupted => Untried::Interrupted,
            other => Untried::Failed(other.to_string()),
        };
        let laid = self.laid.iter().flatten();
        let mut tried = Tried {
            motion: *motion,
            twins: Vec::new(),
            measures: Vec::new(),
            picture: RgbImage::new(1, 1),
        };
        for (number, it) in laid.enumerate() {
            let mut twin = it.twin.clone();
            twin.fold(motion, interrupt).map_err(failed)?;
            let view = twin.view().map_err(failed)?;
            tried.measures.extend(self.measure(it, &view));
            if number == 0 {
                tried.picture = view.observation.rgb;
            }
            tried.twins.push(twin);
        }
        Ok(tried)
    }

    /// Measures the result on a twin; `None` if the task declares no measure.
    fn measure(&self, laid: &Laid, view: &TwinView) -> Option<f64> {
        Some(match self.rehearsal.choose? {
            RehearsalMeasure::Coverage => {
                view.silhouette.area_px() as f64 / laid.flat_px.max(1) as f64
            }
            RehearsalMeasure::Overlap => {
                let goal = self.subgoals.get(self.step as usize);
                let ends = goal.zip(laid.alignment.as_ref());
                ends.map_or(0.0, |(goal, it)| overlap(&view.silhouette, goal, it))
            }
        })
    }

    /// Returns what the camera would see after a motion that was tried.
    pub fn picture(&self, motion: &Motion) -> Option<&RgbImage> {
        let mut tried = self.tried.iter();
        tried.find(|it| it.motion == *motion).map(|it| &it.picture)
    }

    /// Records which answer is taken, and how many questions were asked beyond those without rehearsal.
    pub fn record_choice(&mut self, chosen: Option<u32>, calls: u32) {
        (self.line.chosen, self.line.calls) = (chosen, calls);
    }

    /// Returns the step's entry of the run record.
    pub fn line(&self) -> &RehearsedStep {
        &self.line
    }

    /// Does on the twins what the world has done.
    pub fn follow(&mut self, executed: &Motion, interrupt: &Interrupt) {
        let begun = Instant::now();
        let known = self.tried.iter().position(|it| it.motion == *executed);
        let folded = known.map(|known| self.tried.swap_remove(known).twins);
        let mut folded = folded.unwrap_or_default().into_iter();
        let laid = self.laid.iter_mut().flatten();
        let followed = laid.map(|it| match folded.next() {
            Some(twin) => {
                it.twin = twin;
                Ok(())
            }
            None => it.twin.fold(executed, interrupt),
        });
        let followed: Result<Vec<()>, WorldError> = followed.collect();
        if followed.is_err() {
            // A twin that could not follow lies anywhere.
            self.laid = Some(Vec::new());
        }
        self.took += begun.elapsed();
    }

    /// Returns the time spent on twins since the last call.
    pub fn take_time(&mut self) -> Duration {
        std::mem::take(&mut self.took)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns the corners of a rectangle in order around it.
fn corners_px(rectangle: &Rectangle) -> [[f64; 2]; 4] {
    let Rectangle {
        center,
        along,
        sides,
    } = rectangle;
    let across = [-along[1], along[0]];
    [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[s, t]| {
        [0, 1].map(|axis| center[axis] + s * sides[0] * along[axis] + t * sides[1] * across[axis])
    })
}
