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
use fab_picture::observation::Observation;
use fab_program::{Camera, Cloth, Distrusted, Picker, Program, Rehearsal, RehearsalMeasure};
use fab_vision::{Rectangle, VisionError};
use fab_world::twin::{Drawn, Kind, Sighting, Twin, TwinView};
use fab_world::{Motion, WorldError};
use image::RgbImage;
use std::time::{Duration, Instant};

/// How much higher than its flat surface a cloth may lie in the first picture, metres, where all but [`HIGHEST`] of it
/// counts. A camera's errors stay below it, and of simulated cloths those that are crumpled or folded in half lie higher
/// (`docs/rehearse.md`).
const RAISED_M: f64 = 0.008;

/// The share of a cloth's pixels whose height does not count: wrinkles, and readings that a camera gets wrong.
const HIGHEST: f64 = 0.1;

/// The twins of one rollout.
pub struct Twins {
    rehearsal: Rehearsal,
    camera: Camera,
    picker: Picker,
    cloth: Cloth,
    /// Distinguishes the draws of rollouts.
    seed: String,
    /// Whether nothing real can move.
    is_simulated: bool,
    /// The silhouettes of the subgoal pictures, from the unfolded cloth on.
    subgoals: Vec<Mask>,
    /// The current step, from 1.
    step: u32,
    table: Table,
    /// What the world has done and the twins have not.
    behind: Option<Motion>,
    /// The results of this step's answers.
    tried: Vec<Tried>,
    line: RehearsedStep,
    took: Duration,
}

/// What lies on the twins' table.
enum Table {
    /// Nothing: no picture has been seen.
    Bare,
    /// The twins, at least one.
    Twins(Vec<Laid>),
    /// Nothing from this step on.
    Without { since: u32, why: String },
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
    /// On each twin, in their order.
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

/// A stop was requested.
#[derive(Clone, Copy, Debug)]
pub struct Interrupted;

/// Why an action could not be tried.
#[derive(Debug)]
pub enum Untried {
    /// A stop was requested.
    Interrupted,
    /// A twin failed; the step's line says why.
    Failed,
}

/// Why a step is not rehearsed.
#[derive(Debug, thiserror::Error)]
enum Aside {
    #[error("a stop was requested")]
    Interrupted,
    #[error("the picture shows no cloth")]
    NoCloth,
    #[error(
        "the cloth does not lie flat at first: more than a tenth of it is {raised_mm:.0} mm above the table, and a flat cloth {flat_mm:.1} mm"
    )]
    NotFlat { raised_mm: f64, flat_mm: f64 },
    #[error("the camera does not tell where on the table the cloth lies")]
    OffTable,
    #[error("the picture cannot be read: {0}")]
    Picture(#[from] VisionError),
    #[error("a twin cannot be laid: {0}")]
    NotLaid(WorldError),
    #[error("a twin cannot be seen: {0}")]
    NotSeen(WorldError),
    #[error("a twin could not follow the last action: {0}")]
    NotFollowed(WorldError),
    #[error("there are no twins since step {since}: {why}")]
    Without { since: u32, why: String },
    #[error("no result of step {step} can be compared: a subgoal picture shows no cloth")]
    NoSubgoal { step: u32 },
    #[error("twins and camera overlap by {overlap:.3}, and the task trusts more than {trusted}")]
    Disagree { overlap: f64, trusted: f64 },
}

impl Twins {
    /// Prepares the twins of a rollout; `None` if the task does not rehearse.
    ///
    /// - `draws`: distinguishes the draws of rollouts; equal ones give equal twins.
    /// - `is_simulated`: whether nothing real can move; [`fab_world::World::is_simulated`] of the rollout's world.
    pub fn of(
        program: &Program,
        subgoals: &SubgoalSet,
        draws: &str,
        is_simulated: bool,
    ) -> Option<Twins> {
        Some(Twins {
            rehearsal: program.rehearsal.clone()?,
            camera: program.camera.clone(),
            picker: program.picker,
            cloth: program.cloth.clone(),
            seed: format!("twin {draws}"),
            is_simulated,
            subgoals: subgoals.pictures.iter().map(silhouette).collect(),
            step: 1,
            table: Table::Bare,
            behind: None,
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
    /// - `cloth`: the pixels that show cloth.
    pub fn look(
        &mut self,
        step: u32,
        observation: &Observation,
        cloth: Option<&Mask>,
        interrupt: &Interrupt,
    ) -> Result<(), Interrupted> {
        let begun = Instant::now();
        self.step = step;
        self.line = RehearsedStep::default();
        let compared = self.compare(observation, cloth, interrupt);
        self.tried.clear();
        self.took += begun.elapsed();
        match compared {
            Ok(()) => Ok(()),
            Err(Aside::Interrupted) => Err(Interrupted),
            Err(why) => {
                self.line.aside = Some(why.to_string());
                Ok(())
            }
        }
    }

    fn compare(
        &mut self,
        observation: &Observation,
        cloth: Option<&Mask>,
        interrupt: &Interrupt,
    ) -> Result<(), Aside> {
        let ready = match &self.table {
            Table::Bare => self.lay(observation, cloth).map(Table::Twins),
            Table::Twins(_) => self.catch_up(interrupt).map(Table::Twins),
            Table::Without { since, why } => {
                let (since, why) = (*since, why.clone());
                return Err(Aside::Without { since, why });
            }
        };
        self.table = match ready {
            Ok(table) => table,
            Err(why) => {
                self.table = Table::Without {
                    since: self.step,
                    why: why.to_string(),
                };
                return Err(why);
            }
        };
        let cloth = cloth.ok_or(Aside::NoCloth)?;
        let mut overlaps = Vec::new();
        for it in self.laid_mut() {
            let view = it.twin.view().map_err(Aside::NotSeen)?;
            overlaps.push(view.overlap_with(cloth, observation));
        }
        let (overlap, trusted) = (mean(&overlaps), self.rehearsal.trust_above);
        self.line.overlap = Some(overlap);
        if overlap <= trusted {
            return Err(Aside::Disagree { overlap, trusted });
        }
        match self.rehearsal.choose {
            Some(RehearsalMeasure::Overlap) if !self.has_subgoal() => {
                Err(Aside::NoSubgoal { step: self.step })
            }
            _ => Ok(()),
        }
    }

    /// Returns whether the result of the step can be compared with a subgoal picture.
    fn has_subgoal(&self) -> bool {
        let goal = self.subgoals.get(self.step as usize);
        goal.is_some_and(|goal| goal.area_px() > 0)
            && self.laid().iter().all(|it| it.alignment.is_some())
    }

    fn laid(&self) -> &[Laid] {
        match &self.table {
            Table::Twins(laid) => laid,
            Table::Bare | Table::Without { .. } => &[],
        }
    }

    fn laid_mut(&mut self) -> &mut [Laid] {
        match &mut self.table {
            Table::Twins(laid) => laid,
            Table::Bare | Table::Without { .. } => &mut [],
        }
    }

    /// Lays the twins where the camera sees the cloth.
    fn lay(&self, observation: &Observation, cloth: Option<&Mask>) -> Result<Vec<Laid>, Aside> {
        let cloth = cloth.ok_or(Aside::NoCloth)?;
        if let Some(raised_m) = raised_m(observation, cloth)
            && raised_m > self.cloth.rest_height_m() + RAISED_M
        {
            return Err(Aside::NotFlat {
                raised_mm: raised_m * 1000.0,
                flat_mm: self.cloth.rest_height_m() * 1000.0,
            });
        }
        let rectangle = fab_vision::rectangle_around(cloth)?.ok_or(Aside::NoCloth)?;
        let seen = Sighting::of(observation, corners_px(&rectangle)).ok_or(Aside::OffTable)?;
        let kind = Kind {
            camera: &self.camera,
            picker: self.picker,
            ranges: &self.rehearsal.twin,
            cloth: &self.cloth,
        };
        let twins = (1..=self.rehearsal.twin.draws).map(|draw| {
            let drawn = Drawn::by(kind.ranges, &format!("{} {draw}", self.seed));
            let mut twin = Twin::lay(&seen, &kind, drawn).map_err(Aside::NotLaid)?;
            let flat = twin.view().map_err(Aside::NotSeen)?.silhouette;
            let shown = self.subgoals.first();
            let alignment = shown.map(|shown| Alignment::of(&flat, shown)).transpose()?;
            Ok(Laid {
                twin,
                flat_px: flat.area_px(),
                alignment: alignment.flatten(),
            })
        });
        twins.collect()
    }

    /// Does on the twins what the world has done since they were last compared.
    fn catch_up(&mut self, interrupt: &Interrupt) -> Result<Vec<Laid>, Aside> {
        let Table::Twins(mut laid) = std::mem::replace(&mut self.table, Table::Bare) else {
            return Ok(Vec::new());
        };
        let Some(executed) = self.behind.take() else {
            return Ok(laid);
        };
        let mut tried = self.tried.drain(..);
        if let Some(known) = tried.find(|it| it.motion == executed) {
            for (it, folded) in laid.iter_mut().zip(known.results) {
                it.twin = folded.twin;
            }
            return Ok(laid);
        }
        for it in &mut laid {
            let followed = it.twin.fold(&executed, interrupt);
            followed.map_err(|error| match error {
                WorldError::Interrupted => Aside::Interrupted,
                other => Aside::NotFollowed(other),
            })?;
        }
        Ok(laid)
    }

    /// Returns why the step is not rehearsed; `None` if it is.
    pub fn aside(&self) -> Option<&str> {
        self.line.aside.as_deref()
    }

    /// Returns why nothing may move, if something real would, or the task refuses to move without twins.
    pub fn refusal(&self) -> Option<String> {
        let why = self.aside()?;
        let refuses = self.rehearsal.distrusted == Distrusted::Refuses || !self.is_simulated;
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
        let (twins, failed) = match tried {
            Ok(tried) => {
                let results = self.tried[tried].results.iter();
                (results.filter_map(|it| it.measure).collect(), None)
            }
            Err(WorldError::Interrupted) => return Err(Untried::Interrupted),
            Err(why) => (Vec::new(), Some(why.to_string())),
        };
        let measure = (!twins.is_empty()).then(|| mean(&twins));
        let result = match failed {
            None => Ok(measure),
            Some(_) => Err(Untried::Failed),
        };
        self.line.candidates.push(RehearsedAnswer {
            attempt,
            measure,
            twins,
            failed,
        });
        result
    }

    fn fold(&self, motion: &Motion, interrupt: &Interrupt) -> Result<Tried, WorldError> {
        let results = self.laid().iter().map(|it| {
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
    pub fn picture(&self, motion: &Motion) -> Option<&RgbImage> {
        let tried = self.tried.iter().find(|it| it.motion == *motion)?;
        tried.results.first().map(|it| &it.picture)
    }

    /// Records which answer is taken, and how many questions were asked beyond those without rehearsal.
    pub fn record_choice(&mut self, chosen: Option<u32>, calls: u32) {
        (self.line.chosen, self.line.calls) = (chosen, calls);
    }

    /// Records why fewer answers were asked for than the task declares.
    pub fn record_shortfall(&mut self, why: String) {
        self.line.shortfall.get_or_insert(why);
    }

    /// Returns the step's entry of the run record.
    pub fn line(&self) -> &RehearsedStep {
        &self.line
    }

    /// Notes what the world has done; the next [`Twins::look`] does it on the twins.
    pub fn follow(&mut self, executed: Motion) {
        self.behind = Some(executed);
    }

    /// Returns the time spent on twins since the last call.
    pub fn take_time(&mut self) -> Duration {
        std::mem::take(&mut self.took)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns the height above the table that all of the cloth but [`HIGHEST`] stays below, metres; `None` if no pixel of
/// it has a depth.
fn raised_m(observation: &Observation, cloth: &Mask) -> Option<f64> {
    let camera = &observation.camera;
    let height_m = |column: u32, row: u32| {
        let depth_m = observation.depth_m.get_pixel_checked(column, row)?.0[0];
        let at = [f64::from(column) + 0.5, f64::from(row) + 0.5];
        let seen = camera.world_from_pixel(at, f64::from(depth_m))?;
        Some(seen.z - camera.table_from_pixel(at)?.z)
    };
    let pixels = (0..cloth.height()).flat_map(|row| (0..cloth.width()).map(move |it| (it, row)));
    let shown = pixels.filter(|(column, row)| cloth.contains_at(*column, *row));
    let mut heights_m: Vec<f64> = shown
        .filter_map(|(column, row)| height_m(column, row))
        .collect();
    heights_m.sort_by(f64::total_cmp);
    let highest = (heights_m.len() as f64 * HIGHEST) as usize;
    heights_m.into_iter().rev().nth(highest)
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

#[cfg(test)]
#[path = "tests/twins.rs"]
mod tests;
