//! Writes the text of a drafted task, and lists everything that had to be guessed.
//!
//! In: what `fab_agent::draft` found in pictures, and what the user stated. Out: text that compiles, with a comment at
//! each guess, and a list of the same guesses.

use super::points::{fold_text, point_text};
use fab_agent::draft;
use fab_agent::draft::{ArrowOrigin, DraftStep, NamedPicture, StatedMeasures};
use fab_base::wording::quoted;
use fab_program::{ClothPoint, Fold, Sequence};
use std::fmt::Write;

/// The camera of the base task: height, millimetres, and side of its pictures, pixels.
const BASE_HEIGHT_MM: f64 = 650.0;
const BASE_PX: u32 = 224;
/// Its field of view, degrees.
const BASE_FOV_DEG: f64 = 45.0;

/// Least overlap that the base task requires of a step's result.
const BASE_ALIKE: f64 = 0.7;

/// How far below the picture's own overlap a model's result may stay.
const MARGIN: f64 = 0.1;

/// Height above the table from which pixels count as cloth, millimetres; a flat cloth lies at 5 mm.
const CLOTH_MM: f64 = 4.0;

/// A cloth that covers a smaller share of its rectangle may not be rectangular, so the draft says that it is not sure.
const RECTANGULAR: f64 = 0.93;

/// Rotation from which on a note is written, degrees.
const TURNED_DEG: f64 = 3.0;

/// The inputs of the text.
pub struct Page<'p> {
    /// The task's name.
    pub name: &'p str,
    /// What the user stated.
    pub stated: &'p StatedMeasures,
    /// The pictures, under the user's names.
    pub pictures: &'p [NamedPicture],
    /// What the task calls the pictures.
    pub places: &'p [String],
    /// What the pictures show.
    pub found: &'p draft::Draft,
}

impl Page<'_> {
    /// Returns the folds, if every step has one that explains its pictures.
    fn folds(&self) -> Option<Vec<Fold>> {
        let fold = |step: &DraftStep| step.found().cloned();
        self.found.steps.iter().map(fold).collect()
    }

    fn cloth(&self) -> String {
        let cloth = &self.found.cloth;
        let [width, depth] = [cloth.dimx, cloth.dimy]
            .map(|particles| f64::from(particles - 1) * cloth.spacing_m * 1000.0);
        format!("{width:.0} mm by {depth:.0} mm")
    }

    fn height_mm(&self) -> f64 {
        (self.found.camera.height_m * 10_000.0).round() / 10.0
    }

    fn fov_deg(&self) -> f64 {
        (self.found.camera.fov_rad.to_degrees() * 10.0).round() / 10.0
    }

    /// States the assumptions about camera and cloth, and their consequences.
    fn measures(&self) -> String {
        let (height_mm, fov_deg, cloth) = (self.height_mm(), self.fov_deg(), self.cloth());
        match (self.stated.height_m, self.stated.longer_m) {
            (None, None) => format!(
                "the camera is {height_mm} mm above the table and has a field of view of {fov_deg} degrees; the cloth \
                 then measures {cloth}"
            ),
            (Some(_), None) => format!(
                "the camera has a field of view of {fov_deg} degrees; {height_mm} mm above the table it sees a cloth of \
                 {cloth}"
            ),
            (None, Some(_)) => format!(
                "the camera has a field of view of {fov_deg} degrees; it sees the cloth of {cloth} so large from \
                 {height_mm} mm above the table"
            ),
            (Some(_), Some(_)) => format!(
                "the camera has a field of view of {fov_deg} degrees, so that it sees the cloth of {cloth} so large from \
                 {height_mm} mm above the table"
            ),
        }
    }

    /// Returns all guesses, the most general first.
    pub fn guesses(&self) -> Vec<String> {
        let mut guesses = vec![self.measures()];
        let turned_deg = self.found.turned_rad.to_degrees();
        if turned_deg.abs() >= TURNED_DEG {
            let way = match turned_deg > 0.0 {
                true => "clockwise",
                false => "counter-clockwise",
            };
            guesses.push(format!(
                "the cloth lies turned by {:.0} degrees {way} in the pictures; folds are said as if it lay straight",
                turned_deg.abs()
            ));
        }
        if self.found.rectangular < RECTANGULAR {
            guesses.push(format!(
                "not sure: the cloth is a rectangle, of which {:.2} is seen",
                self.found.rectangular
            ));
        }
        let steps = self.found.steps.iter().zip(self.pictures);
        let bare = steps.filter(|(step, _)| step.origin == ArrowOrigin::Proposed);
        let bare = quoted(bare.map(|(_, picture)| &picture.name));
        if !bare.is_empty() {
            guesses.push(format!(
                "no arrow found in {bare} (arrows must be black, with a ring at the tail and a head at the tip); \
                 proposed one from the difference between the pictures"
            ));
        }
        let steps = self.found.steps.iter().enumerate();
        guesses.extend(steps.map(|(number, step)| {
            let [before, after] = [number, number + 1].map(|index| &self.pictures[index].name);
            format!("from `{before}` to `{after}`: {}", self.guess(step))
        }));
        let lost = self.found.steps.iter().zip(self.places);
        guesses.extend(lost.filter(|(step, _)| is_lost(step)).map(|(_, place)| {
            format!(
                "write the arrow of `{place}` by hand: {}",
                self.by_hand(place)
            )
        }));
        if self.folds().is_none() {
            guesses.push(
                "nothing to score by, since not every fold is known: the task has no goal, and runs to its last step"
                    .to_owned(),
            );
        }
        guesses
    }

    /// Describes what the author may write where no arrow can be proposed.
    fn by_hand(&self, place: &str) -> String {
        let across = |share: f64| (share * f64::from(self.found.camera.image_px)).floor();
        let (near, middle) = (across(0.2), across(0.5));
        format!(
            "`image \"{place}\" arrow ({near}px, {near}px) -> ({middle}px, {middle}px)`, with the pixels, (column, row) \
             from the top left, where the step picks and places"
        )
    }

    fn guess(&self, step: &DraftStep) -> String {
        let fold = match &step.fold {
            Some(fold) => fold_text(fold),
            None => "between points without names".to_owned(),
        };
        let arrow = match step.origin {
            ArrowOrigin::Drawn => {
                let [tail, tip] = step.arrow.map(pixel);
                format!(", by the arrow in the picture from {tail} to {tip}")
            }
            ArrowOrigin::Proposed if is_lost(step) => {
                return format!(
                    "no fold found; the best guess is {fold} (overlap {:.2})",
                    step.overlap
                );
            }
            ArrowOrigin::Proposed => String::new(),
        };
        let doubt = if step.is_sure() { "" } else { "not sure: " };
        let next = match &step.next_best {
            Some((next, overlap)) if *overlap > step.overlap => format!(
                "; {overlap:.2} for {}, between points that are named less often",
                fold_text(next)
            ),
            Some((next, overlap)) => format!(", next best {overlap:.2} for {}", fold_text(next)),
            None => String::new(),
        };
        format!("{doubt}{fold}{arrow} (overlap {:.2}{next})", step.overlap)
    }

    /// Returns the least overlap to require of the steps' results, if the base task requires too much.
    fn alike(&self) -> Option<f64> {
        let overlaps = self.found.steps.iter().map(|step| step.overlap);
        let least = overlaps.fold(1.0, f64::min) - MARGIN;
        let alike = (least * 100.0).floor().max(1.0) / 100.0;
        Some(alike).filter(|alike| *alike < BASE_ALIKE)
    }

    /// Returns the task's text.
    pub fn text(&self) -> String {
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
        let alike = match self.alike() {
            Some(alike) => format!(
                "    const alike = {alike}   # a step whose result shares less of the next picture's outline is tried again\n"
            ),
            None => String::new(),
        };
        let side_px = self.found.camera.image_px;
        let is_side = |point: &ClothPoint| !matches!(&point_text(point)[..4], "corn" | "cent");
        let base = match places.iter().any(is_side) {
            true => "folding_to_sides",
            false => "folding",
        };
        let keypoints = self.keypoints(&places);
        let mut text = include_str!("from_images.fab").to_owned();
        let across = |share: f64| (share * f64::from(side_px)).round().to_string();
        for (mark, filled) in [
            ("@BASE@", base.to_owned()),
            (
                "@CLOTH@",
                format!("grid({}, {})", self.found.cloth.dimx, self.found.cloth.dimy),
            ),
            ("@MEASURES@", wrapped(&self.measures())),
            ("    @CAMERA@\n", self.camera()),
            ("    @GOAL@\n", goal),
            ("    @ALIKE@\n", alike),
            ("    @SIDES@\n", format!("{keypoints}\n")),
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

    /// Writes the camera if it differs from the base task's.
    fn camera(&self) -> String {
        let (height_mm, fov_deg) = (self.height_mm(), self.fov_deg());
        let side_px = self.found.camera.image_px;
        match (self.is_base_camera(), side_px) {
            (true, BASE_PX) => String::new(),
            _ => format!(
                "    camera top_down(height: {height_mm}mm, fov: {fov_deg}deg, image: {side_px}px)\n"
            ),
        }
    }

    fn is_base_camera(&self) -> bool {
        self.height_mm() == BASE_HEIGHT_MM && self.fov_deg() == BASE_FOV_DEG
    }

    /// Writes the keypoints that differ from the base task's.
    fn keypoints(&self, places: &[ClothPoint]) -> String {
        let mut lines = String::new();
        if self.height_mm() != BASE_HEIGHT_MM {
            let below_mm = self.height_mm() - CLOTH_MM;
            let _ = writeln!(
                lines,
                "        cloth = mask(depth < {below_mm}mm)   # the table is {}mm away",
                self.height_mm()
            );
        }
        let is_main = |point: &ClothPoint| !point_text(point).starts_with("point");
        if !places.iter().all(is_main) {
            lines.push_str(SIDES_NOW);
        }
        match lines.is_empty() {
            true => lines,
            false => format!("    keypoints {{\n{lines}    }}\n"),
        }
    }

    fn images(&self) -> String {
        let mut lines = String::new();
        for (number, place) in self.places.iter().enumerate() {
            let Some(step) = self.found.steps.get(number) else {
                let _ = writeln!(lines, "        image \"{place}\"");
                continue;
            };
            let _ = writeln!(lines, "        # guessed: {}", self.guess(step));
            if is_lost(step) {
                let _ = writeln!(lines, "        # Write by hand: {}.", self.by_hand(place));
            }
            let arrow = match step.origin {
                _ if is_lost(step) => String::new(),
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

    /// Writes a pixel of the picture; a point outside the picture is clamped to it.
    fn written(&self, at: [f64; 2]) -> String {
        let last = f64::from(self.found.camera.image_px - 1);
        // A point just short of the picture's middle counts as the middle.
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

/// Side points as the cloth lies now: a fold that ends neither on a corner nor on a side's middle may end on a crease.
const SIDES_NOW: &str = "        # One fold ends elsewhere than on a corner or a side's middle, so these sides are those of the cloth now.
        outline     = contour(cloth, tolerance: 4px)
        side_points = edge_middles(outline)
";

/// Returns whether all that is known of a step is a guess that does not explain it.
fn is_lost(step: &DraftStep) -> bool {
    step.origin == ArrowOrigin::Proposed && step.found().is_none()
}

/// Wraps a sentence into comment lines; the first follows `# guessed: `.
fn wrapped(text: &str) -> String {
    const WIDTH: usize = 100;
    let (mut lines, mut width) = (String::new(), 0);
    for word in text.split(' ') {
        if width > 0 && width + word.len() >= WIDTH {
            lines.push_str("\n    #");
            width = 0;
        }
        if !lines.is_empty() {
            lines.push(' ');
        }
        lines.push_str(word);
        width += word.len() + 1;
    }
    lines
}

fn pixel([u, v]: [f64; 2]) -> String {
    format!("({u:.0}, {v:.0})")
}
