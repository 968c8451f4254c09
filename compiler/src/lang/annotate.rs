//! Rows of `annotate`: what can be drawn on the camera's picture, and in which colours.

use fab_program::vocabulary::{Arg, Call, CallOf, Default, Kind, Range, Word};
use fab_program::{KeypointShape, Mark};

// ---- colours -------------------------------------------------------------------------------------

/// Declares the colours: each with its red, green and blue.
macro_rules! colors {
    ($($name:literal $red:literal $green:literal $blue:literal,)*) => {
        /// The colours.
        pub(crate) const COLORS: &[Word] =
            &[$(Word::new($name, concat!("red ", $red, ", green ", $green, ", blue ", $blue)),)*];

        const RGB: &[[u8; 3]] = &[$([$red, $green, $blue],)*];
    };
}

colors! {
    "black" 0 0 0,
    "white" 255 255 255,
    "gray" 128 128 128,
    "red" 255 0 0,
    "green" 0 255 0,
    "blue" 0 0 255,
    "yellow" 255 255 0,
    "cyan" 0 255 255,
    "magenta" 255 0 255,
    "purple" 128 0 128,
}

/// Returns the red, green and blue of one of [`COLORS`].
pub(crate) fn rgb(color: &str) -> [u8; 3] {
    let mut colors = COLORS.iter().zip(RGB);
    let found = colors.find(|(word, _)| word.name == color);
    *found.expect("a colour that was read is a row").1
}

// ---- marks ---------------------------------------------------------------------------------------

const RADIUS: Kind = Kind::Whole(Range::new("a size", (1.0, "px"), (100.0, "px")));
const WIDTH: Kind = Kind::Whole(Range::new("a width", (1.0, "px"), (20.0, "px")));
const SPACING: Kind = Kind::Whole(Range::new("a spacing", (1.0, "px"), (20.0, "px")));

/// The points at which a mark is drawn; prompts use the plural for several.
pub(crate) const POINTS: Arg = Arg::rest("points", Kind::Spot, "where it is drawn");

/// The colour, which every mark has.
pub(crate) const COLOR: Arg = Arg::named(
    "color",
    Kind::NameOf {
        noun: "colour",
        words: COLORS,
    },
    "its colour",
);

const fn radius(doc: &'static str) -> Arg {
    Arg::named("radius", RADIUS, doc).or(Default::Number(3.0))
}

const fn width(default_px: f64) -> Arg {
    Arg::named("width", WIDTH, "the width of its lines").or(Default::Number(default_px))
}

/// The marks; prompts use a mark's name.
pub(crate) const MARKS: &[CallOf<Mark>] = &[
    Call::new(
        "dot",
        "a mark",
        &[POINTS, COLOR, radius("its radius")],
        "a filled circle at each point",
        |args| Mark::Dot {
            at: args.spots(POINTS.name),
            radius_px: args.whole("radius"),
        },
    ),
    Call::new(
        "ring",
        "a mark",
        &[POINTS, COLOR, radius("its radius"), width(1.0)],
        "a circle at each point",
        |args| Mark::Ring {
            at: args.spots(POINTS.name),
            radius_px: args.whole("radius"),
            width_px: args.whole("width"),
        },
    ),
    Call::new(
        "cross",
        "a mark",
        &[POINTS, COLOR, radius("the length of each arm"), width(1.0)],
        "an upright cross at each point",
        |args| Mark::Cross {
            at: args.spots(POINTS.name),
            radius_px: args.whole("radius"),
            width_px: args.whole("width"),
        },
    ),
    Call::new(
        "number",
        "a mark",
        &[POINTS, COLOR],
        "beside each point its number in its list, from 1",
        |args| Mark::Number {
            at: args.spots(POINTS.name),
        },
    ),
    Call::new(
        "arrow",
        "a mark",
        &[
            Arg::positional("from", Kind::Point, "its tail"),
            Arg::positional("to", Kind::Point, "its tip"),
            COLOR,
            width(2.0),
        ],
        "an arrow from one point to another",
        |args| Mark::Arrow {
            from: args.point("from"),
            to: args.point("to"),
            width_px: args.whole("width"),
        },
    ),
    Call::new(
        "box",
        "a mark",
        &[
            Arg::positional("keypoint", Kind::Keypoint(&[KeypointShape::Box]), "the box"),
            COLOR,
            Arg::named(
                "spacing",
                SPACING,
                "`1px` for solid sides, `3px` for every third pixel of them",
            )
            .or(Default::Number(1.0)),
        ],
        "the sides of a box",
        |args| Mark::Box {
            of: args.name("keypoint"),
            spacing_px: args.whole("spacing"),
        },
    ),
    Call::new(
        "outline",
        "a mark",
        &[
            Arg::positional(
                "keypoint",
                Kind::Keypoint(&[KeypointShape::Outline]),
                "the outline",
            ),
            COLOR,
            width(1.0),
        ],
        "the sides of an outline",
        |args| Mark::Outline {
            of: args.name("keypoint"),
            width_px: args.whole("width"),
        },
    ),
];
