//! Writes the text of a drafted task.
//!
//! In: what `fab_agent::draft` found in pictures. Out: text that compiles, with a comment
//! `# guessed: …` at each guess.

use crate::verbs::new::GUESSED;
use fab_agent::draft;
use fab_agent::draft::{DraftStep, NamedPicture};
use fab_program::{ClothPoint, Fold};

/// Least overlap that the base task requires of a step's result.
const BASE_ALIKE: f64 = 0.7;

/// How far below the picture's own overlap a model's result may stay.
const MARGIN: f64 = 0.1;

/// Height above the table from which pixels count as cloth, millimetres; a flat cloth lies at 5 mm.
const CLOTH_MM: f64 = 4.0;

/// Rotation from which on a note is written, degrees.
const TURNED_DEG: f64 = 3.0;

pub struct Page<'p> {
    pub name: &'p str,
    /// The pictures, under the user's names.
    pub pictures: &'p [NamedPicture],
    pub found: &'p draft::Draft,
}

impl Page<'_> {
    pub fn text(&self) -> String {
        let found = self.found;
        // Only if every step has a fold that explains its pictures.
        let folds: Option<Vec<&Fold>> = found.steps.iter().map(DraftStep::found).collect();
        let (goal, experts, sequences) = match &folds {
            Some(folds) => {
                let experts = "    experts @NAME@_folds\n\n";
                (self.goal(), experts, self.sequences(folds))
            }
            None => (
                format!(
                    "    {GUESSED}nothing to score by, since not every fold is known: the task has no goal, and runs to its last step\n"
                ),
                "",
                String::new(),
            ),
        };
        let steps = found.steps.iter();
        let places = steps.map(|step| point_text(&step.fold.place));
        let places: Vec<String> = places.collect();
        let is_beside = places.iter().any(|place| place.starts_with("point"));
        let is_side = |place: &String| !place.starts_with("corner") && !place.starts_with("center");
        let base = if places.iter().any(is_side) {
            "folding_to_sides"
        } else {
            "folding"
        };
        let cloth = format!("grid({}, {})", found.cloth.dimx, found.cloth.dimy);
        let guesses = self.guesses().into_iter();
        let guesses = guesses.map(|guess| format!("    {GUESSED}{guess}\n"));
        let side = f64::from(found.camera.image_px);
        let across = |share: f64| (share * side).round().to_string();
        let mut text = include_str!("from_images.fab").to_owned();
        for (mark, filled) in [
            ("@BASE@", base),
            ("@CLOTH@", &cloth),
            ("    @GUESSES@\n", &guesses.collect::<String>()),
            ("@HEIGHT@", &self.height_mm().to_string()),
            ("@BELOW@", &(self.height_mm() - CLOTH_MM).to_string()),
            (
                "@FOV@",
                &found.camera.fov_rad.to_degrees().round().to_string(),
            ),
            ("@IMAGE@", &found.camera.image_px.to_string()),
            ("    @GOAL@\n", &goal),
            ("    @ALIKE@\n", &self.alike()),
            ("        @SIDES@\n", if is_beside { SIDES_NOW } else { "" }),
            ("    @IMAGES@\n", &self.images()),
            ("    @EXPERTS@\n", experts),
            ("@SEQUENCES@\n", &sequences),
            ("@LOW@", &across(0.2)),
            ("@HIGH@", &across(0.8)),
            ("@OFF@", &across(0.9)),
            ("@MIDDLE@", &across(0.5)),
            ("@NAME@", self.name),
        ] {
            text = text.replace(mark, filled);
        }
        text.trim_end().to_owned() + "\n"
    }

    /// Returns what the task calls a picture.
    pub fn place(&self, number: usize) -> String {
        format!("{}.images/{number}.png", self.name)
    }

    fn height_mm(&self) -> f64 {
        (self.found.camera.height_m * 10_000.0).round() / 10.0
    }

    /// States what is assumed of camera and cloth, or follows from what the user stated, and of all pictures.
    fn guesses(&self) -> Vec<String> {
        let cloth = &self.found.cloth;
        let [width, depth] = [cloth.dimx, cloth.dimy]
            .map(|particles| f64::from(particles - 1) * cloth.spacing_m * 1000.0);
        let mut guesses = vec![format!(
            "the camera is {} mm above the table and has a field of view of {:.0} degrees, and the cloth measures {width:.0} mm by {depth:.0} mm",
            self.height_mm(),
            self.found.camera.fov_rad.to_degrees()
        )];
        let turned_deg = self.found.turned_rad.to_degrees();
        if turned_deg.abs() >= TURNED_DEG {
            let direction = if turned_deg > 0.0 {
                "clockwise"
            } else {
                "counter-clockwise"
            };
            guesses.push(format!(
                "the cloth lies turned by {:.0} degrees {direction} in the pictures; folds are said as if it lay straight",
                turned_deg.abs()
            ));
        }
        guesses
    }

    fn goal(&self) -> String {
        let untouched_mm = self.found.untouched_m * 1000.0;
        let limit_mm = (0.3 * untouched_mm).round().clamp(2.0, 40.0);
        format!(
            "    goal  particle_distance < {limit_mm}mm   # from what the folds below come to, on average; \
             an untouched cloth scores {untouched_mm:.0} mm\n"
        )
    }

    /// States the least overlap to require of the steps' results, if the base task requires too much.
    fn alike(&self) -> String {
        let overlaps = self.found.steps.iter().map(|step| step.overlap);
        let least = overlaps.fold(1.0, f64::min) - MARGIN;
        let alike = (least * 100.0).floor().max(1.0) / 100.0;
        if alike >= BASE_ALIKE {
            return String::new();
        }
        format!(
            "    const alike = {alike}   # a step whose result shares less of the next picture's outline is tried again\n"
        )
    }

    /// Writes the pictures, with a guess before each from which a step begins.
    fn images(&self) -> String {
        let mut lines = String::new();
        for number in 0..self.pictures.len() {
            let place = self.place(number);
            let mut arrow = String::new();
            if let Some(step) = self.found.steps.get(number) {
                let [before, after] = [number, number + 1].map(|at| &self.pictures[at].name);
                let guess = self.guess(step, &place);
                lines.push_str(&format!(
                    "        {GUESSED}from `{before}` to `{after}`: {guess}\n"
                ));
                if step.found().is_some() {
                    let [tail, tip] = step.arrow.map(|at| self.written(at));
                    arrow = format!(" arrow {tail} -> {tip}");
                }
            }
            lines.push_str(&format!("        image \"{place}\"{arrow}\n"));
        }
        lines
    }

    fn guess(&self, step: &DraftStep, place: &str) -> String {
        let fold = fold_text(&step.fold);
        let overlap = step.overlap;
        if step.found().is_none() {
            let across = |share: f64| (share * f64::from(self.found.camera.image_px)).floor();
            let (near, middle) = (across(0.2), across(0.5));
            return format!(
                "no fold found; the best guess is {fold} (overlap {overlap:.2}). Write by hand: \
                 `image \"{place}\" arrow ({near}px, {near}px) -> ({middle}px, {middle}px)`, with the pixels, \
                 (column, row) from the top left, where the step picks and places"
            );
        }
        let doubt = if step.is_sure() { "" } else { "not sure: " };
        let next = match &step.next_best {
            Some((next, other)) => format!(", next best {other:.2} for {}", fold_text(next)),
            None => String::new(),
        };
        format!("{doubt}{fold} (overlap {overlap:.2}{next})")
    }

    /// Writes a pixel of the picture; a point outside the picture is clamped to it.
    fn written(&self, at: [f64; 2]) -> String {
        let last = f64::from(self.found.camera.image_px - 1);
        // A point just short of the picture's middle counts as the middle.
        let [u, v] = at.map(|at| (at + 0.001).floor().clamp(0.0, last));
        format!("({u}px, {v}px)")
    }

    fn sequences(&self, folds: &[&Fold]) -> String {
        let folds: Vec<String> = folds.iter().map(|fold| fold_text(fold)).collect();
        format!(
            "# The folds that count as right: those of the pictures. Each further `sequence {{ … }}` counts as right, too.\n\
             experts {}_folds {{\n    sequence {{ fold {} }}\n}}\n",
            self.name,
            folds.join(", ")
        )
    }
}

/// Side points as the cloth lies now: a fold that ends neither on a corner nor on a side's middle may end on a crease.
const SIDES_NOW: &str = "        # One fold ends elsewhere than on a corner or a side's middle, so these sides are those of the cloth now.
        outline     = contour(cloth, tolerance: 4px)
        side_points = edge_middles(outline)
";

/// Writes a fold as a whole, ignoring its fraction.
fn fold_text(fold: &Fold) -> String {
    format!("{} -> {}", point_text(&fold.pick), point_text(&fold.place))
}

/// Writes a point of the cloth in the language's syntax.
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
