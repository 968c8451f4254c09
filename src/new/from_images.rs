//! A fold that is drafted from the user's pictures, as a task's text.
//!
//! In: files, and what `runtime::draft` finds in them. Out: a [`Draft`]; all that was not known is said in it and among
//! its guesses.

use super::{Draft, FOLDING, file_of, folder_of, shown};
use crate::cli::new::NewFoldArguments;
use crate::exit::Failure;
use crate::{output, setting, sources};
use compiler::program::{ClothPoint, Fold, Picker, Sequence};
use runtime::draft::{self, ArrowOrigin, DraftError, DraftStep, Named};
use runtime::picture;
use runtime::world::{SimulatedWorld, World, WorldError};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The side of the pictures that the base task's camera takes, pixels.
const BASE_PX: u32 = 224;

/// Least overlap of every step for its folds to be scored by.
const SCORED: f64 = 0.7;

/// Overlap of the outlines around a step above which the base task's limit would let it pass undone.
const SMALL_CHANGE: f64 = 0.65;

/// A cloth that covers less of its rectangle is doubted to be one.
const RECTANGULAR: f64 = 0.93;

/// A turn that is worth a word, degrees.
const TURNED_DEG: f64 = 3.0;

/// Looks at the pictures and writes the task.
pub fn draft(arguments: &NewFoldArguments) -> Result<Draft, Failure> {
    let load = |path: &PathBuf| -> Result<Named, Failure> {
        Ok(Named {
            name: shown(path),
            picture: picture::load(path).map_err(Failure::environment)?,
        })
    };
    let pictures = arguments.from_images.iter().map(load);
    let pictures: Vec<Named> = pictures.collect::<Result<_, _>>()?;
    let found = look(&pictures)?;
    let (places, brought) = places(arguments, &pictures);
    let page = Page {
        name: &arguments.task.name,
        pictures: &pictures,
        places: &places,
        found: &found,
    };
    let file = shown(&file_of(&arguments.task));
    Ok(Draft {
        text: page.text(),
        library: FOLDING,
        pictures: brought,
        guesses: page.guesses(),
        next: vec![
            format!("fabc subgoals {file} --sheet {}.png", arguments.task.name),
            format!("fabc render {file}"),
            format!("fabc run {file}"),
        ],
    })
}

fn look(pictures: &[Named]) -> Result<draft::Draft, Failure> {
    let interrupt = setting::interrupt()?;
    let make_world = || -> Result<Box<dyn World>, WorldError> {
        let world = SimulatedWorld::new(&draft::compared_camera(), Picker::PutDown)?;
        Ok(Box::new(world))
    };
    let announce = |step: usize, tries: usize| {
        let folds = if tries == 1 { "fold" } else { "folds" };
        let steps = pictures.len() - 1;
        output::progress(&format!("step {step}/{steps}: trying {tries} {folds}"));
    };
    let found = draft::draft(pictures, &make_world, &interrupt, &announce);
    output::progress("");
    found.map_err(|error| match error {
        DraftError::World(WorldError::Interrupted) => Failure::interrupted(),
        DraftError::Count { .. } => Failure::usage(error.to_string()),
        error => Failure::environment(error),
    })
}

/// Returns what the task calls each picture, and those that are to be brought beside it.
///
/// One that lies there already is named where it is.
fn places(
    arguments: &NewFoldArguments,
    pictures: &[Named],
) -> (Vec<String>, Vec<(PathBuf, Vec<u8>)>) {
    let folder = folder_of(&arguments.task);
    let mut brought = Vec::new();
    let numbered = arguments.from_images.iter().zip(pictures).enumerate();
    let places = numbered.map(|(number, (path, named))| {
        beside(&folder, path).unwrap_or_else(|| {
            let place = format!("{}.images/{number}.png", arguments.task.name);
            brought.push((PathBuf::from(&place), picture::encode(&named.picture)));
            place
        })
    });
    (places.collect(), brought)
}

/// Returns a picture's path from the task's folder, where it lies in it under a name that a task can state.
fn beside(folder: &Path, path: &Path) -> Option<String> {
    let real = sources::inside(folder, path).ok()?;
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let below = real.strip_prefix(folder.canonicalize().ok()?).ok()?;
    let parts = below.iter().map(|part| part.to_str());
    let path = parts.collect::<Option<Vec<&str>>>()?.join("/");
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "._-/".contains(letter);
    path.chars().all(is_plain).then_some(path)
}

/// All that the text is written from.
struct Page<'p> {
    name: &'p str,
    pictures: &'p [Named],
    places: &'p [String],
    found: &'p draft::Draft,
}

impl Page<'_> {
    /// Returns the folds, where every step has one that explains its pictures.
    fn folds(&self) -> Option<Vec<Fold>> {
        let fold = |step: &DraftStep| step.fold.clone().filter(|_| step.overlap >= SCORED);
        self.found.steps.iter().map(fold).collect()
    }

    fn cloth(&self) -> String {
        let cloth = &self.found.cloth;
        let [width, depth] = [cloth.dimx, cloth.dimy]
            .map(|particles| f64::from(particles - 1) * cloth.spacing_m * 1000.0);
        format!("{width:.0} mm by {depth:.0} mm")
    }

    fn guesses(&self) -> Vec<String> {
        let mut guesses = vec![format!(
            "the camera is 650 mm above the table and has a field of view of 45 degrees; the cloth then measures {}",
            self.cloth()
        )];
        let turned_deg = self.found.turned_rad.to_degrees();
        if turned_deg.abs() >= TURNED_DEG {
            guesses.push(format!(
                "the cloth lies turned by {turned_deg:.0} degrees in the pictures, clockwise; folds are said as if it lay straight"
            ));
        }
        if self.found.rectangular < RECTANGULAR {
            guesses.push(format!(
                "not sure: the cloth is a rectangle, of which {:.2} is seen",
                self.found.rectangular
            ));
        }
        let steps = self.found.steps.iter().enumerate();
        guesses.extend(steps.map(|(number, step)| {
            let [before, after] = [number, number + 1].map(|index| &self.pictures[index].name);
            format!("from `{before}` to `{after}`: {}", self.guess(step))
        }));
        if self.folds().is_none() {
            guesses.push(
                "nothing to score by, since not every fold is known: the task has no goal, and runs to its last step"
                    .to_owned(),
            );
        }
        guesses
    }

    fn guess(&self, step: &DraftStep) -> String {
        let doubt = if step.is_sure() { "" } else { "not sure: " };
        let fold = match &step.fold {
            Some(fold) => fold_text(fold),
            None => "between points without names".to_owned(),
        };
        let next = match &step.next_best {
            Some((next, overlap)) => format!(", next best {overlap:.2} for {}", fold_text(next)),
            None => String::new(),
        };
        let arrow = match step.origin {
            ArrowOrigin::Drawn => {
                let [tail, tip] = step.arrow.map(pixel);
                format!(", by the arrow in the picture from {tail} to {tip}")
            }
            ArrowOrigin::Proposed => String::new(),
        };
        format!("{doubt}{fold}{arrow} (overlap {:.2}{next})", step.overlap)
    }

    fn text(&self) -> String {
        let folds = self.folds();
        let places: Vec<ClothPoint> = self
            .found
            .steps
            .iter()
            .filter_map(|step| Some(step.fold.as_ref()?.place))
            .collect();
        let goal = match &folds {
            Some(_) => {
                let untouched_mm = self.found.untouched_m * 1000.0;
                let limit_mm = (0.3 * untouched_mm).round().clamp(2.0, 40.0);
                format!(
                    "    goal  particle_distance < {limit_mm}mm   # from what the folds below come to, on average; \
                     an untouched cloth scores {untouched_mm:.0} mm\n"
                )
            }
            None => {
                "    # No goal: the folds are not known well enough to compare a result with.\n"
                    .to_owned()
            }
        };
        let is_small = |step: &DraftStep| step.unchanged > SMALL_CHANGE;
        let alike = match self.found.steps.iter().any(is_small) {
            true => {
                "    const alike = 0.9   # a step whose result shares less of the next picture's outline is tried again\n"
            }
            false => "",
        };
        let side_px = self.found.camera.image_px;
        let camera = match side_px {
            BASE_PX => String::new(),
            _ => format!("    camera top_down(height: 650mm, fov: 45deg, image: {side_px}px)\n"),
        };
        let is_main = |point: &ClothPoint| !point_text(point).starts_with("point");
        let is_side = |point: &ClothPoint| !matches!(&point_text(point)[..4], "corn" | "cent");
        let base = match places.iter().any(is_side) {
            true => "folding_to_sides",
            false => "folding",
        };
        let sides = match places.iter().all(is_main) {
            true => "",
            false => SIDES_NOW,
        };
        let mut text = include_str!("from_images.fab").to_owned();
        let across = |share: f64| (share * f64::from(side_px)).round().to_string();
        for (mark, filled) in [
            ("@BASE@", base.to_owned()),
            (
                "@CLOTH@",
                format!("grid({}, {})", self.found.cloth.dimx, self.found.cloth.dimy),
            ),
            ("@MEASURES@", self.cloth()),
            ("    @CAMERA@\n", camera),
            ("    @GOAL@\n", goal),
            ("    @ALIKE@\n", alike.to_owned()),
            ("    @SIDES@\n", format!("{sides}\n")),
            ("    @IMAGES@\n", self.images()),
            (
                "    @EXPERTS@\n",
                match &folds {
                    Some(_) => "    experts @NAME@_folds\n\n".to_owned(),
                    None => String::new(),
                },
            ),
            (
                "@SEQUENCES@\n",
                folds
                    .map(|folds| self.sequences(&folds))
                    .unwrap_or_default(),
            ),
            ("@LOW@", across(0.2)),
            ("@HIGH@", across(0.8)),
            ("@OFF@", across(0.9)),
            ("@MIDDLE@", across(0.5)),
            ("@NAME@", self.name.to_owned()),
        ] {
            text = text.replace(mark, &filled);
        }
        text.trim_end().to_owned() + "\n"
    }

    fn images(&self) -> String {
        let mut lines = String::new();
        for (number, place) in self.places.iter().enumerate() {
            let Some(step) = self.found.steps.get(number) else {
                let _ = writeln!(lines, "        image \"{place}\"");
                continue;
            };
            let _ = writeln!(lines, "        # guessed: {}", self.guess(step));
            let arrow = match step.origin {
                ArrowOrigin::Drawn => String::new(),
                ArrowOrigin::Proposed => {
                    let [tail, tip] = step.arrow.map(|at| self.written(at));
                    format!(" arrow {tail} -> {tip}")
                }
            };
            let _ = writeln!(lines, "        image \"{place}\"{arrow}");
        }
        lines
    }

    /// Writes a pixel of the picture; a point beside it is moved onto it.
    fn written(&self, at: [f64; 2]) -> String {
        let last = f64::from(self.found.camera.image_px - 1);
        // A hair short of the middle is the middle.
        let [u, v] = at.map(|at| (at + 0.001).floor().clamp(0.0, last));
        format!("({u}px, {v}px)")
    }

    fn sequences(&self, folds: &[Fold]) -> String {
        let sequence = |Sequence { folds }: Sequence| {
            let folds: Vec<String> = folds.iter().map(fold_text).collect();
            format!("    sequence {{ fold {} }}\n", folds.join(", "))
        };
        let all = draft::symmetric(folds, &self.found.cloth);
        let all: String = all.into_iter().map(sequence).collect();
        format!(
            "# The folds that count as right: those of the pictures, from each side from which the cloth looks the same.\n\
             experts @NAME@_folds {{\n{all}}}\n"
        )
    }
}

/// Side points as the cloth lies now: a fold that ends elsewhere than on a corner or a side's middle may end on a crease.
const SIDES_NOW: &str = "    # One fold ends elsewhere than on a corner or a side's middle, so the sides are those of the cloth as it lies now.
    keypoints {
        outline     = contour(cloth, tolerance: 4px)
        side_points = edge_middles(outline)
    }
";

fn pixel([u, v]: [f64; 2]) -> String {
    format!("({u:.0}, {v:.0})")
}

fn fold_text(fold: &Fold) -> String {
    format!("{} -> {}", point_text(&fold.pick), point_text(&fold.place))
}

/// Writes a point of the cloth as the language does.
fn point_text(point: &ClothPoint) -> String {
    let ClothPoint::Particle { right, front } = *point else {
        return "center".to_owned();
    };
    let name = |low: &'static str, high: &'static str, at: f64| match at {
        0.0 => Some(low),
        1.0 => Some(high),
        _ => None,
    };
    let (side, end) = (name("left", "right", right), name("back", "front", front));
    match (end, side) {
        (Some(end), Some(side)) => format!("corner({end}_{side})"),
        (None, Some(side)) if front == 0.5 => format!("middle({side})"),
        (Some(end), None) if right == 0.5 => format!("middle({end})"),
        _ => format!("point({right}, {front})"),
    }
}
