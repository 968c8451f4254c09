//! The twins of one rollout: laid once from a camera's picture, carried along, and folded before the world moves.
//!
//! In: what the task declares, whether the world is simulated, pictures of the cloth, executed motions, and actions to
//! try. Out: measures of the results, and whether the twins can still be trusted. Twins get no world that could be asked
//! for more: in particular no particles, no start and no true material. A cloth that does not lie flat in the first
//! picture has no twins.

use crate::record::{RehearsedAnswer, RehearsedStep};
use crate::result::{Alignment, overlap, silhouette};
use crate::subgoals::SubgoalSet;
use fab_base::interrupt::Interrupt;
use fab_picture::Mask;
use fab_picture::camera::center_of;
use fab_picture::observation::Observation;
use fab_program::{Distrusted, PixelPoint, Program, Rehearsal, RehearsalMeasure};
use fab_world::twin::{Drawn, Kind, Sighting, Twin, TwinView};
use fab_world::{Motion, WorldError};
use image::RgbImage;
use std::fmt::Display;
use std::time::{Duration, Instant};

/// How much higher than its flat surface a cloth may lie in the first picture, metres, where all but [`HIGHEST`] of it
/// counts. A camera's errors stay below it, and of simulated cloths those that are crumpled or folded in half lie higher
/// (`docs/rehearse.md`).
const RAISED_M: f64 = 0.008;

/// The share of a cloth's pixels whose height does not count: wrinkles, and readings that a camera gets wrong.
const HIGHEST: f64 = 0.1;

/// The twins of one rollout.
pub struct Twins<'p> {
    program: &'p Program,
    pub(crate) rehearsal: &'p Rehearsal,
    /// Distinguishes the draws of rollouts.
    seed: String,
    /// Whether nothing real can move.
    is_simulated: bool,
    /// The silhouettes of the subgoal pictures, from the unfolded cloth on.
    subgoals: Vec<Mask>,
    /// The current step, from 1.
    step: u32,
    /// The twins; none before the first picture.
    laid: Vec<Laid>,
    /// Since which step there are none, and why.
    without: Option<(u32, String)>,
    /// The results of this step's answers.
    tried: Vec<Tried>,
    /// The step's entry of the run record.
    pub(crate) line: RehearsedStep,
    /// The time spent on twins in this step.
    pub(crate) took: Duration,
}

/// A twin on the table.
struct Laid {
    twin: Twin,
    /// The pixels that it covered where it lay flat.
    flat_px: usize,
    /// Brings it onto the unfolded cloth of the subgoal pictures, if there are any.
    alignment: Option<Alignment>,
}

/// What came of a motion on each twin, in their order.
struct Tried {
    motion: Motion,
    results: Vec<Folded>,
}

/// A twin after a motion.
struct Folded {
    twin: Twin,
    /// The declared measure; `None` if none is declared.
    measure: Option<f64>,
    /// The twin as the camera would see it.
    picture: RgbImage,
}

const NO_CLOTH: &str = "the picture shows no cloth";
const NOT_SEEN: &str = "a twin cannot be seen";
const UNREADABLE: &str = "the picture cannot be read";

/// Says what could not be done, and why.
fn because<E: Display>(what: &str) -> impl Fn(E) -> String {
    move |error| format!("{what}: {error}")
}

impl<'p> Twins<'p> {
    /// Prepares the twins of a rollout; `None` if the task does not rehearse.
    ///
    /// - `draws`: distinguishes the draws of rollouts; equal ones give equal twins.
    /// - `is_simulated`: whether nothing real can move; [`fab_world::World::is_simulated`] of the rollout's world.
    pub fn of(
        program: &'p Program,
        subgoals: &SubgoalSet,
        draws: &str,
        is_simulated: bool,
    ) -> Option<Twins<'p>> {
        Some(Twins {
            program,
            rehearsal: program.rehearsal.as_ref()?,
            seed: format!("twin {draws}"),
            is_simulated,
            subgoals: subgoals.pictures.iter().map(silhouette).collect(),
            step: 1,
            laid: Vec::new(),
            without: None,
            tried: Vec::new(),
            line: RehearsedStep::default(),
            took: Duration::ZERO,
        })
    }

    /// Compares the twins with the camera's picture at the beginning of an action.
    ///
    /// The first picture lays them; before later ones they do what the world has done.
    ///
    /// - `step`: of the task, from 1.
    /// - `seen`: the camera's picture, and the pixels that show cloth.
    /// - `executed`: what the world has done since.
    pub(crate) fn look(
        &mut self,
        step: u32,
        seen: (&Observation, Option<&Mask>),
        executed: Option<&Motion>,
        interrupt: &Interrupt,
    ) {
        let begun = Instant::now();
        self.step = step;
        self.line = RehearsedStep::default();
        self.line.aside = self.compare(seen, executed, interrupt).err();
        self.tried.clear();
        self.took += begun.elapsed();
    }

    /// Fails with why the step is not rehearsed.
    fn compare(
        &mut self,
        (observation, cloth): (&Observation, Option<&Mask>),
        executed: Option<&Motion>,
        interrupt: &Interrupt,
    ) -> Result<(), String> {
        if let Some((since, why)) = &self.without {
            return Err(format!("there are no twins since step {since}: {why}"));
        }
        let ready = if self.laid.is_empty() {
            self.lay(observation, cloth)
        } else {
            self.follow(executed, interrupt)
        };
        if let Err(why) = ready {
            self.without = Some((self.step, why.clone()));
            return Err(why);
        }
        let cloth = cloth.ok_or(NO_CLOTH)?;
        let mut overlaps = Vec::new();
        for it in &mut self.laid {
            let view = it.twin.view().map_err(because(NOT_SEEN))?;
            overlaps.push(view.overlap_with(cloth, observation));
        }
        let (overlap, trusted) = (mean(&overlaps), self.rehearsal.trust_above);
        self.line.overlap = Some(overlap);
        if overlap <= trusted {
            return Err(format!(
                "twins and camera overlap by {overlap:.3}, and the task trusts more than {trusted}"
            ));
        }
        let goal = self.subgoals.get(self.step as usize);
        let has_subgoal = goal.is_some_and(|goal| goal.area_px() > 0)
            && self.laid.iter().all(|it| it.alignment.is_some());
        if self.rehearsal.choose == Some(RehearsalMeasure::Overlap) && !has_subgoal {
            return Err(format!(
                "no result of step {} can be compared: a subgoal picture shows no cloth",
                self.step
            ));
        }
        Ok(())
    }

    /// Lays the twins where the camera sees the cloth.
    fn lay(&mut self, observation: &Observation, cloth: Option<&Mask>) -> Result<(), String> {
        let cloth = cloth.ok_or(NO_CLOTH)?;
        let flat_m = self.program.cloth.rest_height_m();
        if let Some(raised_m) = raised_m(observation, cloth)
            && raised_m > flat_m + RAISED_M
        {
            return Err(format!(
                "the cloth does not lie flat at first: more than a tenth of it is {:.0} mm above the table, and a flat cloth {:.1} mm",
                raised_m * 1000.0,
                flat_m * 1000.0
            ));
        }
        let rectangle = fab_vision::rectangle_around(cloth).map_err(because(UNREADABLE))?;
        let rectangle = rectangle.ok_or(NO_CLOTH)?;
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        let corners_px = corners.map(|share| rectangle.point(share));
        let seen = Sighting::of(observation, corners_px)
            .ok_or("the camera does not tell where on the table the cloth lies")?;
        let kind = Kind {
            camera: &self.program.camera,
            picker: self.program.picker,
            ranges: &self.rehearsal.twin,
            cloth: &self.program.cloth,
        };
        let twins = (1..=self.rehearsal.twin.draws).map(|draw| {
            let drawn = Drawn::by(kind.ranges, &format!("{} {draw}", self.seed));
            let twin = Twin::lay(&seen, &kind, drawn);
            let mut twin = twin.map_err(because("a twin cannot be laid"))?;
            let flat = twin.view().map_err(because(NOT_SEEN))?.silhouette;
            let shown = self.subgoals.first();
            let alignment = shown.map(|shown| Alignment::of(&flat, shown)).transpose();
            Ok(Laid {
                twin,
                flat_px: flat.area_px(),
                alignment: alignment.map_err(because(UNREADABLE))?.flatten(),
            })
        });
        self.laid = twins.collect::<Result<_, String>>()?;
        Ok(())
    }

    /// Does on the twins what the world has done since they were last compared.
    fn follow(&mut self, executed: Option<&Motion>, interrupt: &Interrupt) -> Result<(), String> {
        let Some(executed) = executed else {
            return Ok(());
        };
        let known = self.tried.iter().position(|it| it.motion == *executed);
        if let Some(known) = known {
            let results = self.tried.swap_remove(known).results;
            for (it, folded) in self.laid.iter_mut().zip(results) {
                it.twin = folded.twin;
            }
            return Ok(());
        }
        for it in &mut self.laid {
            let followed = it.twin.fold(executed, interrupt);
            followed.map_err(because("a twin could not follow the last action"))?;
        }
        Ok(())
    }

    /// Returns why nothing may move, if something real would, or the task refuses to move without twins.
    pub(crate) fn refusal(&self) -> Option<String> {
        let why = self.line.aside.as_deref()?;
        let refuses = self.rehearsal.distrusted == Distrusted::Refuses || !self.is_simulated;
        refuses.then(|| format!("the rehearsal refused to move: {why}"))
    }

    /// Executes a motion on the twins, and records the result.
    ///
    /// - `attempt`: the number of its question among those of the stage.
    ///
    /// Returns the mean of the declared measure; `None` if none is declared, a twin failed, or a stop was requested.
    pub(crate) fn try_motion(
        &mut self,
        attempt: u32,
        motion: &Motion,
        interrupt: &Interrupt,
    ) -> Option<f64> {
        let begun = Instant::now();
        let mut failed = None;
        if !self.tried.iter().any(|it| it.motion == *motion) {
            match self.fold(motion, interrupt) {
                Ok(tried) => self.tried.push(tried),
                Err(error) => failed = Some(error),
            }
        }
        self.took += begun.elapsed();
        if let Some(WorldError::Interrupted) = failed {
            return None;
        }
        let tried = self.tried.iter().filter(|it| it.motion == *motion);
        let results = tried.flat_map(|it| &it.results);
        let twins: Vec<f64> = results.filter_map(|it| it.measure).collect();
        let measure = (!twins.is_empty()).then(|| mean(&twins));
        self.line.candidates.push(RehearsedAnswer {
            attempt,
            measure,
            twins,
            failed: failed.map(|error| error.to_string()),
        });
        measure
    }

    fn fold(&self, motion: &Motion, interrupt: &Interrupt) -> Result<Tried, WorldError> {
        let results = self.laid.iter().map(|it| {
            let mut twin = it.twin.clone();
            twin.fold(motion, interrupt)?;
            let view = twin.view()?;
            Ok(Folded {
                twin,
                measure: self.measure(it, &view),
                picture: view.observation.rgb,
            })
        });
        Ok(Tried {
            motion: motion.clone(),
            results: results.collect::<Result<_, WorldError>>()?,
        })
    }

    /// Measures the result on a twin; `None` if the task declares no measure, or nothing is there to compare with.
    fn measure(&self, laid: &Laid, view: &TwinView) -> Option<f64> {
        Some(match self.rehearsal.choose? {
            RehearsalMeasure::Coverage => {
                view.silhouette.area_px() as f64 / laid.flat_px.max(1) as f64
            }
            RehearsalMeasure::Overlap => {
                let goal = self.subgoals.get(self.step as usize)?;
                overlap(&view.silhouette, goal, laid.alignment.as_ref()?)
            }
        })
    }

    /// Returns what the camera would see of the first twin after a motion that was tried.
    pub(crate) fn picture(&self, motion: Option<&Motion>) -> Option<&RgbImage> {
        let tried = self.tried.iter().find(|it| Some(&it.motion) == motion)?;
        tried.results.first().map(|it| &it.picture)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns the height above the table that all of the cloth but [`HIGHEST`] stays below, metres; `None` if no pixel of
/// it has a depth.
fn raised_m(observation: &Observation, cloth: &Mask) -> Option<f64> {
    let camera = &observation.camera;
    let height_m = |pixel: PixelPoint| {
        let [column, row] = [pixel.u, pixel.v].map(|at| at as u32);
        let depth_m = observation.depth_m.get_pixel_checked(column, row)?.0[0];
        let at = center_of(pixel);
        let seen = camera.world_from_pixel(at, f64::from(depth_m))?;
        Some(seen.z - camera.table_from_pixel(at)?.z)
    };
    let heights_m = cloth.pixels().filter_map(height_m);
    let mut heights_m: Vec<f64> = heights_m.collect();
    heights_m.sort_by(f64::total_cmp);
    let highest = (heights_m.len() as f64 * HIGHEST) as usize;
    heights_m.into_iter().rev().nth(highest)
}

#[cfg(test)]
#[path = "tests/twins.rs"]
mod tests;
