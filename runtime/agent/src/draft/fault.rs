//! Why pictures cannot be drafted from.

use super::measures::LARGEST_M;
use super::{MAX_STEPS, SIDE_PX};
use fab_vision::VisionError;
use fab_world::WorldError;

/// Why pictures cannot be drafted from.
#[derive(Debug, thiserror::Error)]
pub enum DraftError {
    /// There are too few or too many pictures.
    #[error(
        "{}; there must be 2 to {}, the flat cloth first and then one after each step", count(*found), MAX_STEPS + 1
    )]
    Count {
        /// How many there are.
        found: usize,
    },
    /// A picture has a shape that no task camera has.
    #[error(
        "`{name}` has {} x {} px; it must be a square of {} to {} px a side, cut around the cloth or with table added",
        size_px[0], size_px[1], SIDE_PX.start(), SIDE_PX.end()
    )]
    Size {
        /// The picture.
        name: String,
        /// Its width and height, pixels.
        size_px: [u32; 2],
    },
    /// Two pictures have different sizes.
    #[error(
        "`{name}` has {side_px} px a side and `{first}` has {first_px}; all pictures must have one size and be taken \
         from one place"
    )]
    SizesDiffer {
        /// The picture.
        name: String,
        /// Its side, pixels.
        side_px: u32,
        /// The first picture.
        first: String,
        /// Its side, pixels.
        first_px: u32,
    },
    /// Nothing differs from the table.
    #[error(
        "no cloth is seen on `{name}`: its largest patch unlike the colours at its border has {found_px} of \
         {all_px} px; the picture must show a plain table all round the whole cloth, in a colour unlike the cloth's{}", several(*n_colours)
    )]
    NoCloth {
        /// The picture.
        name: String,
        /// Pixels of the largest patch that is not table.
        found_px: usize,
        /// All pixels.
        all_px: usize,
        /// The number of common colours of its border; all of them count as table.
        n_colours: usize,
    },
    /// The detected cloth has an impossible size.
    #[error(
        "the cloth on `{name}` measures {:.0} x {:.0} of {side_px} px; it must fill at least an eighth of the \
         picture's side", sides_px[0], sides_px[1]
    )]
    ClothSize {
        /// The picture.
        name: String,
        /// Both sides, pixels.
        sides_px: [f64; 2],
        /// The picture's side, pixels.
        side_px: u32,
    },
    /// The detected cloth reaches the border, and the border has no common colours.
    #[error(
        "the table on `{name}` is not plain: {:.0} % of the picture's border has none of its common colours, and a \
         patch of other colours reaches the border; the table must have one colour, be evenly lit, and be visible \
         all round the cloth", (1.0 - plain) * 100.0
    )]
    NotPlain {
        /// The picture.
        name: String,
        /// The share of its border that has one of the border's common colours.
        plain: f64,
    },
    /// The flat cloth is not completely visible.
    #[error(
        "the cloth on `{name}` reaches the picture's border; the table must be visible all round it: take the \
         picture from higher up, or lay the cloth in the middle"
    )]
    AtBorder {
        /// The picture.
        name: String,
    },
    /// The stated sizes match no camera that a task may have.
    #[error(
        "a cloth of {:.0} mm that takes up {:.0} of {side_px} px needs a camera {:.0} mm above the table; it must be \
         100 mm to 5 m above it", longer_m * 1000.0, longer_px, height_m * 1000.0
    )]
    Height {
        /// The cloth's longer side, metres.
        longer_m: f64,
        /// The cloth's longer side, pixels.
        longer_px: f64,
        /// The picture's side, pixels.
        side_px: u32,
        /// The camera's height, metres.
        height_m: f64,
    },
    /// Both are stated, and no lens shows this cloth from this height in this size.
    #[error(
        "a cloth of {:.0} mm seen from {:.0} mm above the table takes up {:.0} of {side_px} px with a field of view \
         of {fov_deg:.0} degrees only; it must be 5 to 150 degrees, so state only the cloth or only the height",
        longer_m * 1000.0, height_m * 1000.0, longer_px
    )]
    View {
        /// The cloth's longer side, metres.
        longer_m: f64,
        /// The cloth's longer side, pixels.
        longer_px: f64,
        /// The picture's side, pixels.
        side_px: u32,
        /// The camera's height, metres.
        height_m: f64,
        /// The field of view that this would need, degrees.
        fov_deg: f64,
    },
    /// The cloth has more particles than permitted.
    #[error(
        "the cloth would measure {:.0} mm; at most {:.0} mm can be simulated",
        longer_m * 1000.0, LARGEST_M * 1000.0
    )]
    TooLarge {
        /// Its longer side, metres.
        longer_m: f64,
    },
    /// Nothing was folded.
    #[error(
        "`{after}` shows the cloth as `{before}` does (their outlines overlap by {overlap:.3}); give one picture \
         after each fold"
    )]
    Unchanged {
        /// The picture before.
        before: String,
        /// The picture after.
        after: String,
        /// The overlap of their outlines.
        overlap: f64,
    },
    /// Something was unfolded.
    #[error(
        "`{after}` shows {:.0} % more cloth than `{before}`, but a fold must show less; give the flat cloth first \
         and then the pictures in the order of the steps", (growth - 1.0) * 100.0
    )]
    Grown {
        /// The picture before.
        before: String,
        /// The picture after.
        after: String,
        /// The factor by which the outline's area grew.
        growth: f64,
    },
    /// No fold between named points is possible there.
    #[error(
        "no fold leads from `{before}` to `{after}`: the part that is gone holds no corner, side middle or quarter \
         point of the cloth; an arrow drawn on `{before}` would say what is meant"
    )]
    NoFold {
        /// The picture before.
        before: String,
        /// The picture after.
        after: String,
    },
    /// A picture cannot be processed.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// Folds cannot be simulated.
    #[error("folds cannot be tried: {0}")]
    World(#[from] WorldError),
    /// Folds cannot be tried in parallel.
    #[error("folds cannot be tried: {0}")]
    Threads(#[from] std::io::Error),
}

/// Explains a border of several colours, as the end of a message.
fn several(n_colours: usize) -> String {
    match n_colours {
        0 | 1 => String::new(),
        n_colours => format!(
            "; the border has {n_colours} colours, and one of them may be that of a cloth that reaches it"
        ),
    }
}

fn count(found: usize) -> String {
    match found {
        1 => "one picture shows no fold; give one more than there are steps".to_owned(),
        found if found > MAX_STEPS => format!("{found} pictures are too many"),
        found => format!("{found} pictures show no fold"),
    }
}
