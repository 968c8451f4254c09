//! The calls that make parts of a task: cloths, cameras, points of the cloth. One row each.

use fab_program::data::keypoints::IMAGE;
use fab_program::vocabulary::{Arg, ArgValue, Args, Call, CallOf, Default, Kind, Range, Word};
use fab_program::{
    Camera, Cloth, ClothPoint, ClothStart, ImageUp, MANNERS, Manner, PARTICLES_A_SIDE, Picker,
    RECORDED_SPACING_M, STATED_SPACING_MM,
};

// ---- cloths --------------------------------------------------------------------------------------

/// Particles on a side; their number grows with the square.
pub(crate) const PARTICLES: Range = Range::plain(
    "a count of particles",
    PARTICLES_A_SIDE[0] as f64,
    PARTICLES_A_SIDE[1] as f64,
);

/// The length of a side, for the fewest to the most particles.
const SIDE: Kind = Kind::Quantity(Range::new(
    "a side",
    (side_mm(PARTICLES_A_SIDE[0]), "mm"),
    (side_mm(PARTICLES_A_SIDE[1]), "mm"),
));

const fn side_mm(particles: u32) -> f64 {
    (particles - 1) as f64 * 1000.0 * RECORDED_SPACING_M
}

/// The distance between particles.
pub(crate) const SPACING: Arg = Arg::named(
    "spacing",
    Kind::Quantity(Range::new(
        "a spacing",
        (STATED_SPACING_MM[0], "mm"),
        (STATED_SPACING_MM[1], "mm"),
    )),
    "the distance between particles, of a cloth with a `material`",
)
.or(Default::Number(RECORDED_SPACING_M));

const STARTS: &[Word] = &[
    Word::new("flat", "flat and straight"),
    Word::new(
        "crumpled",
        "lifted and dropped at random, depending on the seed",
    ),
];

const START: Arg = Arg::named(
    "start",
    Kind::WordOrFile {
        words: STARTS,
        ending: ".npy",
    },
    "how it lies at the start: a word, or particle positions from a file",
)
.or(Default::Word("flat"));

const MATERIAL: Arg = Arg::named(
    "material",
    Kind::Material,
    "what it is made of: the name of a `material`, or `pyflex` for the recorded cloth",
)
.or(Default::Nothing);

/// The forms of `cloth`.
pub(crate) const CLOTHS: &[CallOf<Cloth>] = &[
    Call::new(
        "grid",
        "a cloth",
        &[
            Arg::positional(
                "width",
                Kind::Whole(PARTICLES),
                "particles from left to right",
            ),
            Arg::positional(
                "depth",
                Kind::Whole(PARTICLES),
                "particles from back to front",
            ),
            SPACING,
            START,
            MATERIAL,
        ],
        "particles from left to right and from back to front",
        |args| cloth(["width", "depth"].map(|side| args.whole(side)), args),
    ),
    Call::new(
        "square",
        "a cloth",
        &[
            Arg::positional("side", SIDE, "its side"),
            SPACING,
            START,
            MATERIAL,
        ],
        "the same side both ways",
        |args| cloth(["side"; 2].map(|side| particles(side, args)), args),
    ),
    Call::new(
        "rectangle",
        "a cloth",
        &[
            Arg::positional("width", SIDE, "from left to right"),
            Arg::positional("depth", SIDE, "from back to front"),
            SPACING,
            START,
            MATERIAL,
        ],
        "width and depth",
        |args| cloth(["width", "depth"].map(|side| particles(side, args)), args),
    ),
];

fn particles(side: &str, args: &Args) -> u32 {
    (args.number(side) / args.number("spacing")).round() as u32 + 1
}

fn cloth([dimx, dimy]: [u32; 2], args: &Args) -> Cloth {
    let start = match args.get("start") {
        Some(ArgValue::File(file)) => ClothStart::File { file: file.clone() },
        Some(ArgValue::Word("crumpled")) => ClothStart::Crumpled,
        _ => ClothStart::Flat,
    };
    Cloth {
        dimx,
        dimy,
        spacing_m: args.number("spacing"),
        start,
        material: None,
    }
}

// ---- pickers -------------------------------------------------------------------------------------

/// The pickers that state how the gripper goes about it. Without an argument, only their names are written.
pub(crate) const PICKERS: &[CallOf<(Picker, Manner)>] = &[
    Call::new(
        "put_down",
        "a picker",
        MANNERS,
        "carries the cloth and puts it down, in the stated manner",
        |args| (Picker::PutDown, Manner::from_args(args)),
    ),
    Call::new(
        "drop",
        "a picker",
        MANNERS,
        "carries the cloth and lets it fall, in the stated manner",
        |args| (Picker::Drop, Manner::from_args(args)),
    ),
];

// ---- cameras -------------------------------------------------------------------------------------

/// The forms of `camera`.
pub(crate) const CAMERAS: &[CallOf<Camera>] = &[Call::new(
    "top_down",
    "a camera",
    &[
        Arg::named(
            "height",
            Kind::Quantity(Range::new("a height", (100.0, "mm"), (5.0, "m"))),
            "of its optical centre above the table",
        ),
        Arg::named(
            "fov",
            Kind::Quantity(Range::new("a field of view", (5.0, "deg"), (150.0, "deg"))),
            "its field of view across the picture",
        ),
        Arg::named(
            "image",
            Kind::Whole(IMAGE),
            "the side of its square picture",
        ),
        Arg::named(
            "up",
            Kind::Word(ImageUp::WORDS),
            "the axis of the table that is up in the picture",
        )
        .or(Default::Word("y")),
    ],
    "looks straight down",
    |args| Camera {
        height_m: args.number("height"),
        fov_rad: args.number("fov"),
        image_px: args.whole("image"),
        up: args.meaning("up", ImageUp::from_word),
    },
)];

// ---- points of the cloth -------------------------------------------------------------------------

const CORNERS: &[Word] = &[
    Word::new("back_left", "the picture's top left"),
    Word::new("back_right", "the picture's top right"),
    Word::new("front_left", "the picture's bottom left"),
    Word::new("front_right", "the picture's bottom right"),
];

const SIDES: &[Word] = &[
    Word::new("left", "the left side"),
    Word::new("right", "the right side"),
    Word::new("back", "the picture's top"),
    Word::new("front", "the picture's bottom"),
];

const PART: Kind = Kind::Quantity(Range::plain("a fraction", 0.0, 1.0));

/// How far towards its place a fold goes.
pub(crate) const FOLD_FRACTION: Range = Range::plain("a fraction", 0.0, 1.0).above();

/// Points of the cloth that are calls; `center` is a word.
pub(crate) const CLOTH_POINTS: &[CallOf<ClothPoint>] = &[
    Call::new(
        "corner",
        "a point of the cloth",
        &[Arg::positional(
            "name",
            Kind::NameOf {
                noun: "corner",
                words: CORNERS,
            },
            "which one",
        )],
        "a corner",
        |args| side(args.word("name")),
    ),
    Call::new(
        "middle",
        "a point of the cloth",
        &[Arg::positional(
            "side",
            Kind::NameOf {
                noun: "middle",
                words: SIDES,
            },
            "which one",
        )],
        "the middle of a side",
        |args| side(args.word("side")),
    ),
    Call::new(
        "point",
        "a point of the cloth",
        &[
            Arg::positional("right", PART, "of the way from the left to the right side"),
            Arg::positional("front", PART, "of the way from the back to the front"),
        ],
        "a point by its fractions of both sides",
        |args| ClothPoint::Particle {
            right: args.number("right"),
            front: args.number("front"),
        },
    ),
    Call::new(
        "between",
        "a point of the cloth",
        &[
            Arg::positional("a", Kind::ClothPoint, "where it begins"),
            Arg::positional("b", Kind::ClothPoint, "where it ends"),
            Arg::positional("fraction", PART, "of the way from a to b"),
        ],
        "a point on the way from one to another",
        |args| {
            let [a, b] = ["a", "b"].map(|end| particle(args.cloth_point(end)));
            let at = |axis: usize| a[axis] + args.number("fraction") * (b[axis] - a[axis]);
            ClothPoint::Particle {
                right: at(0),
                front: at(1),
            }
        },
    ),
];

/// Returns the point of a named corner or side. Each word in the name is one end of an axis; without a word, the
/// middle.
fn side(name: &str) -> ClothPoint {
    let along = |least: &str, most: &str| {
        if name.contains(most) {
            1.0
        } else if name.contains(least) {
            0.0
        } else {
            0.5
        }
    };
    ClothPoint::Particle {
        right: along("left", "right"),
        front: along("back", "front"),
    }
}

/// Returns a point's fractions. `center` belongs to the table and was already rejected.
fn particle(point: ClothPoint) -> [f64; 2] {
    match point {
        ClothPoint::Particle { right, front } => [right, front],
        ClothPoint::Center => [0.5, 0.5],
    }
}
