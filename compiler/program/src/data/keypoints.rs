//! Keypoints: what is found in each observation, and the extractors that find it.

use crate::data::camera::PixelPoint;
use crate::data::folds::ClothPoint;
use crate::data::shape::KeypointShape;
use crate::vocabulary::{Arg, Args, Call, Default, Kind, Range};
use crate::words::words;
use serde::{Deserialize, Serialize};

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
    /// The first of the rollout, then kept to the end (the paper's cloth centre, protocol section 6).
    Start,
}

words! { Moment {
    "now" => Now, "the latest picture";
    "start" => Start, "the rollout's first picture, kept until its end";
} }

/// How a keypoint is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Extractor {
    /// The pixels nearer to the camera than a depth. Gives a mask.
    DepthMask {
        /// Depth limit along the optical axis, metres, exclusive.
        below_m: f64,
    },
    /// The pixels whose colour is in three ranges, both ends included. Gives a mask.
    ColorMask {
        /// Hue, degrees, 0 to 360; a range whose end is below its beginning passes through 360.
        hue_deg: [f64; 2],
        /// Saturation, 0 to 1.
        saturation: [f64; 2],
        /// Value (brightness), 0 to 1.
        value: [f64; 2],
    },
    /// The pixels on one side of the threshold that best separates two kinds of pixels (Otsu's method). Gives a mask.
    SplitMask {
        /// The number that is compared with the threshold.
        of: Channel,
        /// Which side is kept.
        keep: Side,
        /// Side of the square over which levels are averaged first, pixels, odd; 1 for none.
        blur_px: u32,
        /// The least difference between the means of the two sides, 0 to 1; below it, the mask is empty.
        contrast: f64,
    },
    /// A mask with its gaps filled: grown by a square and shrunk again. Gives a mask.
    Closed {
        /// The mask's name.
        mask: String,
        /// Side of the square, pixels.
        by_px: u32,
    },
    /// The largest piece of a mask. Gives a mask.
    Largest {
        /// The mask's name.
        mask: String,
    },
    /// The pixels of all of these masks. Gives a mask.
    Union {
        /// The masks' names, two or more.
        masks: Vec<String>,
    },
    /// The pixels of a mask that are not in another one. Gives a mask.
    Minus {
        /// The mask's name.
        mask: String,
        /// The name of the mask to subtract.
        without: String,
    },
    /// Corners that a mask shows (OpenCV's goodFeaturesToTrack). Gives points.
    Corners {
        /// The mask's name.
        mask: String,
        /// What the detector looks at.
        of: Sight,
        /// A mask whose pixels are painted white before the detector sees the picture; `None` leaves the picture
        /// unchanged.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        white: Option<String>,
        /// The box in or near which corners are kept; `None` keeps all.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Inside>,
        /// Side of the square image that the detector sees, pixels of that image. Results are scaled back.
        image_px: u32,
        /// The most corners kept, strongest first.
        max: u32,
        /// Smallest accepted response, as a fraction of the strongest, `0 < quality <= 1`.
        quality: f64,
        /// Smallest distance between corners, pixels of the detector's image.
        spacing_px: f64,
        /// Side of the square over which a response is averaged, pixels of the detector's image, odd.
        block_px: u32,
        /// What counts as a strong response.
        response: Response,
    },
    /// The mean of a mask's pixels, truncated to whole pixels. Gives a point.
    Centroid {
        /// The mask's name.
        mask: String,
    },
    /// The upright box around a mask. Gives a box.
    BoundingBox {
        /// The mask's name.
        mask: String,
    },
    /// The middle of a box: `floor((right - left) / 2) + left`, likewise for rows (protocol, section 4). Gives a point.
    BoxCenter {
        /// The box's name.
        of: String,
    },
    /// The middle of the picture, computed like that of a box around all of it. Gives a point.
    PictureCenter,
    /// The outline of a mask's largest piece as a polygon. Gives an outline.
    Contour {
        /// The mask's name.
        mask: String,
        /// How far the polygon may deviate from the outline, pixels; 0 keeps every bend.
        tolerance_px: f64,
    },
    /// The middle of each side of an outline, in the outline's order. Gives points.
    EdgeMiddles {
        /// The outline's name.
        outline: String,
    },
    /// Points named as those of a cloth whose outline has four sides, by their fractions of these. Gives points.
    PointsOf {
        /// The outline's name.
        outline: String,
        /// The points, in the order in which they are found.
        points: Vec<ClothPoint>,
    },
    /// Points at equal distances along an outline, starting at its first one. Gives points.
    Along {
        /// The outline's name.
        outline: String,
        /// How many.
        count: u32,
    },
    /// Points moved towards another point. Gives points.
    Toward {
        /// The points' name.
        points: String,
        /// The name of the point that they move towards.
        to: String,
        /// How much of the way to it, above 0 and below 1.
        share: f64,
    },
    /// The point farthest towards a side of the picture; the first of equally far ones. Gives a point.
    Outermost {
        /// The points' name.
        points: String,
        /// The side.
        side: PictureSide,
    },
    /// Points that never change. Gives points.
    Fixed {
        /// The points.
        points: Vec<PixelPoint>,
    },
}

/// The box in which corners are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inside {
    /// The box's name.
    pub of: String,
    /// How far outside it a corner may be, pixels.
    pub margin_px: f64,
}

/// A number that each pixel of a picture has, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Its grey level.
    Brightness,
    /// How far its colour is from grey: three times its saturation, at most 1.
    Saturation,
}

words! { Channel {
    "brightness" => Brightness, "how bright a pixel is";
    "saturation" => Saturation, "how far its colour is from grey: HSV saturation times 3, at most 1";
} }

/// One side of a threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Below it: dark, or grey.
    Low,
    /// Above it: bright, or coloured.
    High,
}

words! { Side {
    "low" => Low, "what is dark, or grey";
    "high" => High, "what is bright, or coloured";
} }

/// What a corner detector looks at; everything outside of the mask is black.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sight {
    /// The depth image (the paper's folding).
    Depth,
    /// The mask itself, white (the paper's smoothing).
    Mask,
    /// The camera's picture in grey.
    Picture,
    /// The same, with its blue, green and red read as hue, saturation and value. This is a mistake in the paper's
    /// code (protocol, section 4), kept only for comparisons with its recordings.
    MisreadPicture,
}

words! { Sight {
    "depth" => Depth, "the depth image";
    "mask" => Mask, "the mask itself, white";
    "picture" => Picture, "the camera's picture in grey";
    "misread_picture" => MisreadPicture, "the same, with a mistake in the smoothing paper's code";
} }

/// A side of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PictureSide {
    /// Where columns begin.
    Left,
    /// Where columns end.
    Right,
    /// Where rows begin.
    Top,
    /// Where rows end.
    Bottom,
}

/// How a corner detector measures a response.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Response {
    /// Harris' measure.
    Harris {
        /// Its free parameter.
        k: f64,
    },
    /// The smaller eigenvalue.
    ShiTomasi,
}

/// What an extractor looks at, besides the keypoints that it names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source<'a> {
    /// The camera's depth.
    Depth,
    /// The camera's picture, or nothing.
    Picture,
    /// The mask of this name, of which it gives a cleaner one.
    Refined(&'a str),
}

impl Extractor {
    /// Returns whether it needs the camera's depth as well as its picture.
    pub fn needs_depth(&self) -> bool {
        self.nature().1 == Source::Depth
    }

    /// Returns the mask that this one refines; `None` if it is taken from the picture.
    pub fn refines(&self) -> Option<&str> {
        match self.nature().1 {
            Source::Refined(mask) => Some(mask),
            Source::Depth | Source::Picture => None,
        }
    }

    /// Returns how many points it gives at most; `None` if the picture alone decides, or if it gives no points.
    ///
    /// - `keypoints`: those that it may use.
    pub fn most_points(&self, keypoints: &[Keypoint]) -> Option<u32> {
        match self {
            Extractor::Corners { max, .. } => Some(*max),
            Extractor::Along { count, .. } => Some(*count),
            Extractor::PointsOf { points, .. } => u32::try_from(points.len()).ok(),
            Extractor::Fixed { points } => u32::try_from(points.len()).ok(),
            // Only earlier keypoints are used, so this ends.
            Extractor::Toward { points, .. } => {
                let used = keypoints.iter().find(|keypoint| keypoint.name == *points);
                used.and_then(|used| used.extractor.most_points(keypoints))
            }
            Extractor::Centroid { .. }
            | Extractor::BoxCenter { .. }
            | Extractor::PictureCenter
            | Extractor::Outermost { .. } => Some(1),
            Extractor::EdgeMiddles { .. }
            | Extractor::DepthMask { .. }
            | Extractor::ColorMask { .. }
            | Extractor::SplitMask { .. }
            | Extractor::Closed { .. }
            | Extractor::Largest { .. }
            | Extractor::Union { .. }
            | Extractor::Minus { .. }
            | Extractor::BoundingBox { .. }
            | Extractor::Contour { .. } => None,
        }
    }

    /// Returns the shape that this extractor gives.
    pub fn shape(&self) -> KeypointShape {
        self.nature().0
    }

    /// Returns what it gives and what it looks at.
    fn nature(&self) -> (KeypointShape, Source<'_>) {
        match self {
            Extractor::DepthMask { .. } => (KeypointShape::Mask, Source::Depth),
            Extractor::Closed { mask, .. } | Extractor::Largest { mask } => {
                (KeypointShape::Mask, Source::Refined(mask))
            }
            // A mask made of two others refines neither.
            Extractor::Union { .. }
            | Extractor::Minus { .. }
            | Extractor::ColorMask { .. }
            | Extractor::SplitMask { .. } => (KeypointShape::Mask, Source::Picture),
            Extractor::BoundingBox { .. } => (KeypointShape::Box, Source::Picture),
            Extractor::Contour { .. } => (KeypointShape::Outline, Source::Picture),
            Extractor::Corners { of, .. } => {
                let source = match of {
                    Sight::Depth => Source::Depth,
                    Sight::Mask | Sight::Picture | Sight::MisreadPicture => Source::Picture,
                };
                (KeypointShape::Points, source)
            }
            Extractor::EdgeMiddles { .. }
            | Extractor::PointsOf { .. }
            | Extractor::Along { .. }
            | Extractor::Toward { .. }
            | Extractor::Fixed { .. } => (KeypointShape::Points, Source::Picture),
            Extractor::Centroid { .. }
            | Extractor::BoxCenter { .. }
            | Extractor::PictureCenter
            | Extractor::Outermost { .. } => (KeypointShape::Point, Source::Picture),
        }
    }
}

/// The arguments that both corner detectors share, and the ones that only one has.
macro_rules! corner_args {
    ($($own:expr),*) => {
        &[
            MASK,
            Arg::named("max", Kind::Whole(N_POINTS), "the most corners that are kept"),
            Arg::named("quality", Kind::Quantity(QUALITY), "the smallest accepted response, as a fraction of the strongest"),
            Arg::named("spacing", Kind::Quantity(SPACING), "the smallest distance between two corners"),
            Arg::named("image", Kind::Whole(IMAGE), "the side of the picture that the detector sees")
                .or(Default::CameraSide),
            Arg::named("of", Kind::Word(Sight::WORDS), "what the detector looks at inside of the mask")
                .or(Default::Word("depth")),
            Arg::named("white", Kind::Keypoint(&[KeypointShape::Mask]), "a mask that is painted white first")
                .or(Default::Nothing)
                .needs("of", &["picture", "misread_picture"]),
            Arg::named("inside", Kind::Keypoint(&[KeypointShape::Box]), "the box in which corners are kept")
                .or(Default::Nothing),
            Arg::named("margin", Kind::Quantity(SPACING), "how far outside the box a corner may be")
                .or(Default::Number(0.0))
                .needs("inside", &[]),
            Arg::named("block", Kind::Odd(BLOCK), "the side of the square over which a response is averaged")
                .or(Default::Number(DEFAULT_BLOCK_PX)),
            $($own,)*
            AT,
        ]
    };
}

/// An extractor of the language: its call, and the shape it gives.
#[derive(Clone, Copy, Debug)]
pub struct ExtractorRow {
    /// The call, and what it makes.
    pub call: Call<fn(&Args) -> Extractor>,
    /// What it gives; the same for all rows of one name.
    pub gives: KeypointShape,
}

/// Every extractor, one row for each form of a call.
pub const EXTRACTORS: &[ExtractorRow] = &[
    row(
        "mask",
        KeypointShape::Mask,
        &[Arg::positional(
            "depth < limit",
            Kind::DepthLimit(DEPTH),
            "the distance from the camera",
        )],
        "the pixels nearer to the camera than a depth",
        |args| Extractor::DepthMask {
            below_m: args.number("depth < limit"),
        },
    ),
    row(
        "mask",
        KeypointShape::Mask,
        &[
            Arg::named(
                "hue",
                Kind::Between(HUE),
                "a range; `330deg to 20deg` passes through red",
            ),
            Arg::named("saturation", Kind::Between(FRACTION), "a range"),
            Arg::named("value", Kind::Between(FRACTION), "a range of brightness"),
        ],
        "the pixels of a colour",
        |args| Extractor::ColorMask {
            // Converting through radians must not move a limit off the whole degree that the author wrote.
            hue_deg: args
                .between("hue")
                .map(|hue_rad| (hue_rad.to_degrees() * 1e9).round() / 1e9),
            saturation: args.between("saturation"),
            value: args.between("value"),
        },
    ),
    row(
        "mask",
        KeypointShape::Mask,
        &[Arg::named(
            "face",
            Kind::Face,
            "a face of the cloth: `upper` or `under`",
        )],
        "the pixels of the colour of one face of the cloth's material",
        |args| {
            let [hue_deg, saturation, value] = args.colours("face");
            Extractor::ColorMask {
                hue_deg,
                saturation,
                value,
            }
        },
    ),
    row(
        "mask",
        KeypointShape::Mask,
        &[
            Arg::named(
                "split",
                Kind::Word(Channel::WORDS),
                "the value of each pixel that is compared",
            ),
            Arg::named(
                "keep",
                Kind::Word(Side::WORDS),
                "which of the two kinds is the mask",
            ),
            Arg::named(
                "blur",
                Kind::Odd(BLUR),
                "the side of the square over which it is averaged first",
            )
            .or(Default::Number(1.0)),
            Arg::named(
                "contrast",
                Kind::Quantity(FRACTION),
                "the smallest difference between the two kinds",
            )
            .or(Default::Number(DEFAULT_CONTRAST)),
        ],
        "one of the two kinds of pixels into which a picture splits best",
        |args| Extractor::SplitMask {
            of: args.meaning("split", Channel::from_word),
            keep: args.meaning("keep", Side::from_word),
            blur_px: args.whole("blur"),
            contrast: args.number("contrast"),
        },
    ),
    row(
        "closed",
        KeypointShape::Mask,
        &[
            MASK,
            Arg::named("by", Kind::Whole(CLOSING), "the widest gap that is filled"),
        ],
        "a mask with narrow gaps filled",
        |args| Extractor::Closed {
            mask: args.name("mask"),
            by_px: args.whole("by"),
        },
    ),
    row(
        "largest",
        KeypointShape::Mask,
        &[MASK],
        "the largest piece of a mask",
        |args| Extractor::Largest {
            mask: args.name("mask"),
        },
    ),
    row(
        "union",
        KeypointShape::Mask,
        &[
            MASK,
            Arg::rest(
                "others",
                Kind::Keypoint(&[KeypointShape::Mask]),
                "more masks",
            ),
        ],
        "the pixels of two or more masks",
        |args| Extractor::Union {
            masks: [args.names("mask"), args.names("others")].concat(),
        },
    ),
    row(
        "minus",
        KeypointShape::Mask,
        &[
            MASK,
            Arg::positional(
                "without",
                Kind::Keypoint(&[KeypointShape::Mask]),
                "the mask to subtract",
            ),
        ],
        "the pixels of a mask that are not in another",
        |args| Extractor::Minus {
            mask: args.name("mask"),
            without: args.name("without"),
        },
    ),
    row(
        "harris",
        KeypointShape::Points,
        corner_args![
            Arg::named(
                "k",
                Kind::Quantity(HARRIS_K),
                "the detector's free parameter"
            )
            .or(Default::Number(DEFAULT_HARRIS_K))
        ],
        "Harris corners, strongest first",
        |args| {
            let k = args.number("k");
            corners(args, Response::Harris { k })
        },
    ),
    row(
        "shi_tomasi",
        KeypointShape::Points,
        corner_args![],
        "Shi-Tomasi corners, strongest first",
        |args| corners(args, Response::ShiTomasi),
    ),
    row(
        "centroid",
        KeypointShape::Point,
        &[MASK, AT],
        "the mean of a mask's pixels",
        |args| Extractor::Centroid {
            mask: args.name("mask"),
        },
    ),
    row(
        "bounding_box",
        KeypointShape::Box,
        &[MASK, AT],
        "the upright box around a mask",
        |args| Extractor::BoundingBox {
            mask: args.name("mask"),
        },
    ),
    row(
        "center",
        KeypointShape::Point,
        &[
            Arg::positional("box", Kind::Keypoint(&[KeypointShape::Box]), "a box"),
            AT,
        ],
        "the middle of a box",
        |args| Extractor::BoxCenter {
            of: args.name("box"),
        },
    ),
    row(
        "center",
        KeypointShape::Point,
        &[],
        "the middle of the picture; of two middle pixels the left or upper one",
        |_| Extractor::PictureCenter,
    ),
    row(
        "contour",
        KeypointShape::Outline,
        &[
            MASK,
            Arg::named(
                "tolerance",
                Kind::Quantity(SPACING),
                "how far the polygon may deviate from it",
            ),
            AT,
        ],
        "the outline of a mask's largest piece, straightened",
        |args| Extractor::Contour {
            mask: args.name("mask"),
            tolerance_px: args.number("tolerance"),
        },
    ),
    row(
        "edge_middles",
        KeypointShape::Points,
        &[OUTLINE, AT],
        "the middle of each side of an outline",
        |args| Extractor::EdgeMiddles {
            outline: args.name("outline"),
        },
    ),
    row(
        "points_of",
        KeypointShape::Points,
        &[
            OUTLINE,
            Arg::rest(
                "points",
                Kind::ClothPoint,
                "points of a cloth, as a demonstration names them",
            ),
            AT,
        ],
        "points of a cloth with this outline of four sides",
        |args| Extractor::PointsOf {
            outline: args.name("outline"),
            points: args.cloth_points("points"),
        },
    ),
    row(
        "along",
        KeypointShape::Points,
        &[
            OUTLINE,
            Arg::named("count", Kind::Whole(N_POINTS), "how many"),
            AT,
        ],
        "points at equal distances along an outline",
        |args| Extractor::Along {
            outline: args.name("outline"),
            count: args.whole("count"),
        },
    ),
    row(
        "toward",
        KeypointShape::Points,
        &[
            POINTS,
            Arg::positional("point", Kind::Keypoint(&[KeypointShape::Point]), "a point"),
            Arg::named(
                "share",
                Kind::Quantity(SHARE),
                "how much of its way each one moves",
            ),
            AT,
        ],
        "points, each moved towards another point",
        |args| Extractor::Toward {
            points: args.name("points"),
            to: args.name("point"),
            share: args.number("share"),
        },
    ),
    row(
        "leftmost",
        KeypointShape::Point,
        &[POINTS, AT],
        "the point that is nearest to the left of the picture; the first of equally near ones",
        |args| outermost(args, PictureSide::Left),
    ),
    row(
        "rightmost",
        KeypointShape::Point,
        &[POINTS, AT],
        "the point that is nearest to the right of the picture; the first of equally near ones",
        |args| outermost(args, PictureSide::Right),
    ),
    row(
        "topmost",
        KeypointShape::Point,
        &[POINTS, AT],
        "the point that is nearest to the top of the picture; the first of equally near ones",
        |args| outermost(args, PictureSide::Top),
    ),
    row(
        "bottommost",
        KeypointShape::Point,
        &[POINTS, AT],
        "the point that is nearest to the bottom of the picture; the first of equally near ones",
        |args| outermost(args, PictureSide::Bottom),
    ),
    row(
        "points",
        KeypointShape::Points,
        &[Arg::rest(
            "points",
            Kind::Pixel,
            "pixels of the camera's picture",
        )],
        "points that are always the same",
        |args| Extractor::Fixed {
            points: args.pixels("points"),
        },
    ),
];

/// When an extractor's keypoint is taken. A keypoint stores it next to its extractor.
pub const AT: Arg =
    Arg::named("at", Kind::Word(Moment::WORDS), "when it is looked for").or(Default::Word("now"));

const MASK: Arg = Arg::positional("mask", Kind::Keypoint(&[KeypointShape::Mask]), "a mask");
const OUTLINE: Arg = Arg::positional(
    "outline",
    Kind::Keypoint(&[KeypointShape::Outline]),
    "an outline",
);
const POINTS: Arg = Arg::positional(
    "points",
    Kind::Keypoint(&[KeypointShape::Points]),
    "a list of points",
);

const DEPTH: Range = Range::new("a depth", (1.0, "mm"), (10.0, "m"));
const HUE: Range = Range::new("a hue", (0.0, "deg"), (360.0, "deg")).wrapping();
const FRACTION: Range = Range::plain("a fraction", 0.0, 1.0);
const BLUR: Range = Range::new("an odd side", (1.0, "px"), (101.0, "px"));
const CLOSING: Range = Range::new("a side", (1.0, "px"), (200.0, "px"));
const N_POINTS: Range = Range::plain("a number of points", 1.0, 1000.0);
const QUALITY: Range = Range::plain("a fraction", 0.0, 1.0).above();
const SPACING: Range = Range::new("a distance", (0.0, "px"), (2048.0, "px"));
/// The side of a picture.
pub const IMAGE: Range = Range::new("a picture's side", (16.0, "px"), (2048.0, "px"));
const BLOCK: Range = Range::new("an odd side", (1.0, "px"), (31.0, "px"));
const HARRIS_K: Range = Range::plain("a number", 0.001, 0.25);
const SHARE: Range = Range::plain("a share", 0.001, 0.999);

/// The smallest contrast between the two kinds of pixels of a split, if none is stated. A cloth and a table that look
/// alike to a person differ by less. The simulator's two kinds of tiles differ by 0.12, and neither is cloth.
const DEFAULT_CONTRAST: f64 = 0.15;

/// Harris' free parameter if none is stated: the usual one (protocol, section 6).
const DEFAULT_HARRIS_K: f64 = 0.04;

/// Side of the square over which a response is averaged, if none is stated: OpenCV's default, which the paper uses.
const DEFAULT_BLOCK_PX: f64 = 3.0;

fn corners(args: &Args, response: Response) -> Extractor {
    let inside = args.optional_name("inside");
    Extractor::Corners {
        mask: args.name("mask"),
        of: args.meaning("of", Sight::from_word),
        white: args.optional_name("white"),
        inside: inside.map(|of| Inside {
            of,
            margin_px: args.number("margin"),
        }),
        image_px: args.whole("image"),
        max: args.whole("max"),
        quality: args.number("quality"),
        spacing_px: args.number("spacing"),
        block_px: args.whole("block"),
        response,
    }
}

fn outermost(args: &Args, side: PictureSide) -> Extractor {
    Extractor::Outermost {
        points: args.name("points"),
        side,
    }
}

const fn row(
    name: &'static str,
    gives: KeypointShape,
    args: &'static [Arg],
    doc: &'static str,
    make: fn(&Args) -> Extractor,
) -> ExtractorRow {
    ExtractorRow {
        call: Call::new(name, gives.words(), args, doc, make),
        gives,
    }
}
