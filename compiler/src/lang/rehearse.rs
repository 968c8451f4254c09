//! Rows of `rehearse`: its twin and its numbers.

use super::verify::NumberRow;
use fab_program::TwinRanges;
use fab_program::vocabulary::{Arg, Call, CallOf, Default, Kind, Range};

/// The twins. The ranges are those of the axes along which suites vary worlds, and of a material's friction.
pub(crate) const TWINS: &[CallOf<TwinRanges>] = &[Call::new(
    "twin",
    "twins",
    &[
        Arg::named(
            "material",
            Kind::Material,
            "what they are made of: the name of a `material`, or `pyflex` for the recorded cloth",
        ),
        Arg::named(
            "size",
            Kind::Between(Range::plain("a factor", 0.5, 2.0)),
            "their sides, as a factor of those that the camera sees",
        ),
        Arg::named(
            "friction",
            Kind::Between(Range::plain("a coefficient of friction", 0.0, 3.0)),
            "their coefficient of friction on the table",
        ),
        Arg::named(
            "draws",
            Kind::Whole(Range::plain("a count", 1.0, 9.0)),
            "how many twins are drawn; the mean of their measures counts",
        )
        .or(Default::Number(3.0)),
    ],
    "simulated cloths that are laid as the camera sees the real one, each drawn from these ranges",
    |args| TwinRanges {
        material: None,
        size: args.between("size"),
        friction: args.between("friction"),
        draws: args.whole("draws"),
    },
)];

pub(crate) const REVISIONS: NumberRow = NumberRow::repeats(
    "revise",
    "how often the model may answer anew after it has seen what would come of its answer",
);

pub(crate) const TRUST: NumberRow = NumberRow::overlap(
    "trust overlap >",
    "how much the silhouettes of the twins and of the camera's cloth must overlap, as a fraction",
);

/// The numbers, in the order of the reference.
pub(crate) const NUMBERS: [&NumberRow; 2] = [&REVISIONS, &TRUST];
