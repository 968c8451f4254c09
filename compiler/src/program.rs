//! A compiled task: plain, versioned data that the runtime executes.
//!
//! In: nothing; [`crate::compile`] builds it. Out: JSON whose bytes depend on the source text alone.
//! Quantities are in base units (metres, pixels, radians); pixels are those of the task's camera image,
//! `[column, row]`, origin top-left. What the data means is defined beside it: [`crate::render`] fills
//! the templates, [`crate::reply`] reads answers, [`crate::verify`] judges them.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Version of the shape of [`Program`]; it changes whenever an older reader would misread the data.
pub const PROGRAM_FORMAT: u32 = 1;

/// Everything a rollout needs to know about one task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// [`PROGRAM_FORMAT`] at the time of compilation.
    pub format: u32,
    /// Version of the compiler, e.g. `0.1.0`.
    pub compiler: String,
    /// The task's name as written in the file.
    pub task: String,
    /// The files that went in, in the order in which they were first read.
    pub sources: Vec<SourceStamp>,
    /// The cloth that the task is about.
    pub cloth: Cloth,
    /// The camera whose pixels every point is given in.
    pub camera: Camera,
    /// The pictures that show what to do, step by step.
    pub subgoals: Subgoals,
    /// Fold sequences that count as right; the score is the distance to the nearest of their results.
    pub experts: Vec<Sequence>,
    /// What is found in each observation, in declaration order; an extractor uses only earlier ones.
    pub keypoints: Vec<Keypoint>,
    /// The discretised action space, one entry per field of an answer.
    pub actions: Vec<ActionField>,
    /// Every piece of text that can reach a model, by name.
    pub templates: Vec<Template>,
    /// The questions that make up one step, in order; the last one reads the action.
    pub stages: Vec<Stage>,
    /// The checks that a proposed action must pass.
    pub verify: Verify,
    /// The most actions in one rollout.
    pub horizon: u32,
    /// When the task counts as reached; without one, a rollout ends at its horizon.
    pub goal: Option<Goal>,
}

impl Program {
    /// Returns the program's identity: the first 16 hex digits of the SHA-256 of its compact JSON.
    pub fn hash(&self) -> String {
        let bytes = serde_json::to_vec(self).expect("a program has string keys and finite numbers");
        hex(&Sha256::digest(bytes))[..16].to_owned()
    }

    /// Returns the template of that name.
    ///
    /// The compiler only emits names that exist, so `None` means a program edited by hand.
    pub fn template(&self, name: &str) -> Option<&Template> {
        self.templates.iter().find(|template| template.name == name)
    }

    /// Returns the keypoint of that name.
    pub fn keypoint(&self, name: &str) -> Option<&Keypoint> {
        self.keypoints.iter().find(|keypoint| keypoint.name == name)
    }

    /// Returns the largest number of model calls in one step: every stage, asked as often as it may be.
    pub fn calls_per_step(&self) -> u32 {
        self.stages.len() as u32 * self.verify.attempts
    }
}

/// Writes bytes as lower-case hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// One source file's name and content hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceStamp {
    /// The file as the compiler was given it, or as a `use` names it.
    pub name: String,
    /// SHA-256 of the text, hex.
    pub sha256: String,
}

/// A rectangular cloth as a grid of particles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloth {
    /// Particles from left to right, at least 2.
    pub dimx: u32,
    /// Particles from back (image top) to front (image bottom), at least 2.
    pub dimy: u32,
    /// Distance between neighbours, metres.
    pub spacing_m: f64,
}

/// A camera that looks straight down; image right is world +X, image up is world +Y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Height of the optical centre above the table, metres.
    pub height_m: f64,
    /// Field of view across the square image, radians.
    pub fov_rad: f64,
    /// Side of the square image, pixels.
    pub image_px: u32,
}

/// Where the subgoal pictures come from; `n` folds have `n + 1` pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "from", rename_all = "snake_case")]
pub enum Subgoals {
    /// Drawn in the simulator by executing these folds on the task's flat cloth.
    Demonstrate {
        /// One fold per step.
        folds: Vec<Fold>,
    },
    /// Pictures that the author brings.
    Images {
        /// At least two, in order.
        images: Vec<SubgoalImage>,
    },
}

impl Subgoals {
    /// Returns the number of steps that the pictures show.
    pub fn steps(&self) -> usize {
        match self {
            Subgoals::Demonstrate { folds } => folds.len(),
            Subgoals::Images { images } => images.len().saturating_sub(1),
        }
    }
}

/// One picture of the author's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SubgoalImage {
    /// Path relative to the file that declares it, `/` as separator.
    pub path: String,
    /// The file that declares it, as in [`SourceStamp::name`].
    pub declared_in: String,
    /// Tail and tip in the picture's pixels of the arrow to draw on it; none where the picture already has one.
    pub arrow: Option<[PixelPoint; 2]>,
}

/// Moves one cloth point to another: `place = pick + fraction * (target - pick)` (protocol, section 6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fold {
    /// The point that is picked.
    pub pick: ClothPoint,
    /// The point it is carried to.
    pub place: ClothPoint,
    /// How far towards it, `0 < fraction <= 1`.
    pub fraction: f64,
}

/// A point that belongs to the cloth, whatever its size and wherever it lies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClothPoint {
    /// A particle, by its place in the flat cloth: `right` from 0 (left edge) to 1 (right edge), `front`
    /// from 0 (back edge, image top) to 1 (front edge). The particle's grid index is
    /// `floor(right * (dimx - 1)), floor(front * (dimy - 1))`; its position is read when the fold starts.
    Particle {
        /// Fraction from the left edge to the right edge.
        right: f64,
        /// Fraction from the back edge to the front edge.
        front: f64,
    },
    /// The middle of the cloth's bounding box on the table at the start of the rollout; a fixed table point.
    Center,
}

/// A sequence of folds whose result counts as right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sequence {
    /// The folds in order.
    pub folds: Vec<Fold>,
}

/// Something found in every observation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Keypoint {
    /// Its name in the task and in prompts.
    pub name: String,
    /// Which observation it is taken from.
    pub moment: Moment,
    /// How it is found.
    pub extractor: Extractor,
}

/// Which observation a keypoint is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Moment {
    /// The latest.
    Now,
    /// The first of the rollout, kept until its end (the paper's cloth centre, protocol section 6).
    Start,
}

/// How a keypoint is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Extractor {
    /// The pixels nearer to the camera than a depth. Gives a mask.
    DepthMask {
        /// Depth limit along the optical axis, metres, exclusive.
        below_m: f64,
    },
    /// Harris corners of the masked depth image (OpenCV's goodFeaturesToTrack). Gives points.
    Harris {
        /// The mask's name.
        mask: String,
        /// Side of the square image that the detector sees, pixels of that image; results are scaled back.
        image_px: u32,
        /// The most corners kept, strongest first.
        max: u32,
        /// Least accepted response as a fraction of the strongest, `0 < quality <= 1`.
        quality: f64,
        /// Least distance between corners, pixels of the detector's image.
        spacing_px: f64,
        /// Harris' free parameter.
        k: f64,
    },
    /// Shi-Tomasi corners of the masked depth image. Gives points.
    ShiTomasi {
        /// The mask's name.
        mask: String,
        /// As for Harris.
        image_px: u32,
        /// As for Harris.
        max: u32,
        /// As for Harris.
        quality: f64,
        /// As for Harris.
        spacing_px: f64,
    },
    /// The mean of a mask's pixels, truncated to whole pixels. Gives a point.
    Centroid {
        /// The mask's name.
        mask: String,
    },
}

/// What an extractor gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeypointShape {
    /// A set of pixels.
    Mask,
    /// A list of points.
    Points,
    /// One point.
    Point,
}

impl Extractor {
    /// Returns what this extractor gives.
    pub fn shape(&self) -> KeypointShape {
        match self {
            Extractor::DepthMask { .. } => KeypointShape::Mask,
            Extractor::Harris { .. } | Extractor::ShiTomasi { .. } => KeypointShape::Points,
            Extractor::Centroid { .. } => KeypointShape::Point,
        }
    }
}

/// One field of an answer and what it may be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActionField {
    /// `pick` or `place`.
    pub name: String,
    /// The keypoints (points or a point) that are offered, in this order.
    pub one_of: Vec<String>,
}

/// One piece of text in the portable Jinja subset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Template {
    /// The component's name, `stage.say`, or `check.NAME`.
    pub name: String,
    /// Jinja source; every variable in it is a string.
    pub text: String,
    /// The variables it needs, sorted, as [`crate::render::Bindings`] names them.
    pub variables: Vec<String>,
    /// The file that declares it, as in [`SourceStamp::name`].
    pub declared_in: String,
    /// The line of its first character there, from 1.
    pub line: u32,
}

/// One question to a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Its name in the task.
    pub name: String,
    /// Which model is asked.
    pub model: ModelRole,
    /// Sampling temperature, where the task states one.
    pub temperature: Option<f64>,
    /// The longest answer, tokens, where the task states one.
    pub max_tokens: Option<u32>,
    /// Templates of the system message, joined by a blank line; empty: no system message.
    pub system: Vec<String>,
    /// Templates of the user message, joined by a blank line.
    pub say: Vec<String>,
    /// Pictures that follow the user message's text, in order.
    pub show: Vec<Picture>,
    /// What is taken from the answer.
    pub read: Read,
}

/// The kind of model that a stage asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelRole {
    /// One that sees pictures.
    Vision,
    /// One that reads text.
    Text,
}

/// A picture shown to a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Picture {
    /// Which subgoal picture.
    pub subgoal: Which,
    /// Whether the step's arrow is drawn on it.
    pub arrow: Arrow,
}

/// Which of the two pictures around a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Which {
    /// The cloth before the step.
    Now,
    /// The cloth after the step.
    Next,
}

/// Whether an arrow from pick to place is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrow {
    /// A ring at the pick, a line, and a tip at the place (protocol, section 6).
    Drawn,
    /// The bare picture.
    Absent,
}

/// What is taken from an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Read {
    /// The text between two literals, as a variable of later stages.
    Text {
        /// The variable.
        name: String,
        /// The literal before it, e.g. `Instructions:`.
        before: String,
        /// The literal after it; empty: to the end of the line.
        after: String,
    },
    /// All fields of the action.
    Action,
}

/// The checks on a proposed action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verify {
    /// In order; the first one that fails speaks.
    pub checks: Vec<Check>,
    /// The most questions per stage and step, at least 1 (the paper: three).
    pub attempts: u32,
}

/// One check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Its name in the task and in the journal.
    pub name: String,
    /// What must hold.
    pub holds: Expr,
    /// Template of the correction message.
    pub message: String,
}

/// A condition over the proposed action and the scene; total, without loops.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Expr {
    /// Every part holds.
    All {
        /// The parts.
        of: Vec<Expr>,
    },
    /// At least one part holds.
    Any {
        /// The parts.
        of: Vec<Expr>,
    },
    /// The part does not hold.
    Not {
        /// The part.
        of: Box<Expr>,
    },
    /// Two lengths in pixels compare so.
    Compare {
        /// Left of the operator.
        left: Length,
        /// The operator.
        is: Comparison,
        /// Right of the operator.
        right: Length,
    },
    /// A point lies on a mask, or at most `margin_px` away from it.
    Within {
        /// The point.
        point: PointRef,
        /// The mask's name.
        mask: String,
        /// Distance to the nearest pixel of the mask that is still accepted, pixels.
        margin_px: f64,
    },
}

/// How two numbers compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
}

/// A length in pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Length {
    /// A number of pixels.
    Pixels {
        /// The number.
        px: f64,
    },
    /// The Euclidean distance between two points.
    Distance {
        /// One end.
        a: PointRef,
        /// The other end.
        b: PointRef,
    },
}

/// A point that a check can name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "of", rename_all = "snake_case")]
pub enum PointRef {
    /// A field of the proposed action.
    Action {
        /// The field.
        field: String,
    },
    /// A keypoint that is one point.
    Keypoint {
        /// The keypoint.
        name: String,
    },
}

/// When a task counts as reached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// What is measured after the last step.
    pub metric: Metric,
    /// The limit, metres; reached when the measure is below it.
    pub below_m: f64,
}

/// A measure of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Mean distance between equal particles of the result and of the nearest expert result (protocol, section 6).
    ParticleDistance,
}

/// A whole pixel of the camera image: column from the left, row from the top, written `[u, v]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(from = "[i32; 2]", into = "[i32; 2]")]
pub struct PixelPoint {
    /// Column.
    pub u: i32,
    /// Row.
    pub v: i32,
}

impl PixelPoint {
    /// Names a pixel by column and row.
    pub const fn new(u: i32, v: i32) -> Self {
        PixelPoint { u, v }
    }

    /// Returns the Euclidean distance to another pixel, pixels.
    pub fn distance_px(self, other: PixelPoint) -> f64 {
        let du = f64::from(self.u) - f64::from(other.u);
        let dv = f64::from(self.v) - f64::from(other.v);
        (du * du + dv * dv).sqrt()
    }
}

impl From<[i32; 2]> for PixelPoint {
    fn from([u, v]: [i32; 2]) -> Self {
        PixelPoint { u, v }
    }
}

impl From<PixelPoint> for [i32; 2] {
    fn from(point: PixelPoint) -> Self {
        [point.u, point.v]
    }
}

impl std::fmt::Display for PixelPoint {
    /// Writes `(u, v)`, the form that prompts use and answers are asked for in.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}, {})", self.u, self.v)
    }
}
