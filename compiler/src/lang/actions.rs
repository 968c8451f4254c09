//! Rows of `actions`: the fields that act.

use fab_program::data::manner::{LIFT, PRESS, RELEASE_HEIGHT, SPEED};
use fab_program::units::Dimension;
use fab_program::vocabulary::{Arg, Kind, Range};

/// The kind of a field's choices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChoiceKind {
    Points,
    Directions,
    Lengths,
    Speeds,
    Words,
}

/// A field that acts; other fields are only recorded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldRow {
    pub name: &'static str,
    pub choices: ChoiceKind,
    /// The range of its choices; `None` for points and directions, and for lengths as long as an arm may move.
    pub range: Option<Range>,
    /// Whether every action says it, so that a field with nearly its name is a mistake.
    pub is_expected: bool,
    /// How its choices are written.
    pub example: &'static str,
    /// What it is, one line.
    pub doc: &'static str,
}

/// The fields that act: where the cloth is moved, then how.
pub(crate) const FIELDS: &[FieldRow] = &[
    FieldRow {
        name: "pick",
        choices: ChoiceKind::Points,
        example: "pick: one of corners, center",
        doc: "where the cloth is gripped",
        range: None,
        is_expected: true,
    },
    FieldRow {
        name: "place",
        choices: ChoiceKind::Points,
        example: "place: one of corners, center",
        doc: "where it is released; without it, the direction and the distance from the pick decide",
        range: None,
        is_expected: true,
    },
    FieldRow {
        name: "direction",
        choices: ChoiceKind::Directions,
        example: "direction: one of 0deg, 90deg, 180deg, 270deg",
        doc: "which way the cloth is carried, counter-clockwise from the picture's right",
        range: None,
        is_expected: true,
    },
    FieldRow {
        name: "distance",
        choices: ChoiceKind::Lengths,
        example: "distance: one of 0.25edge, 0.5edge",
        doc: "how far it is carried over the table",
        range: None,
        is_expected: true,
    },
    manner(LIFT, ChoiceKind::Lengths, "lift: one of 0mm, 30mm, 100mm"),
    manner(SPEED, ChoiceKind::Speeds, "speed: one of 100mm/s, 500mm/s"),
    manner(
        RELEASE_HEIGHT,
        ChoiceKind::Lengths,
        "release_height: one of 0mm, 50mm",
    ),
    manner(PRESS, ChoiceKind::Lengths, "press: one of 0mm, 200mm"),
];

/// Makes the row of a field that says how the gripper goes about it.
const fn manner(arg: Arg, choices: ChoiceKind, example: &'static str) -> FieldRow {
    FieldRow {
        name: arg.name,
        choices,
        range: match arg.kind {
            Kind::Quantity(range) => Some(range),
            _ => None,
        },
        is_expected: false,
        example,
        doc: arg.doc,
    }
}

/// Returns the row of a field; `None` for one that does not act.
pub(crate) fn field(name: &str) -> Option<&'static FieldRow> {
    FIELDS.iter().find(|row| row.name == name)
}

impl ChoiceKind {
    /// Returns the kind of a number of this dimension.
    pub fn of(dimension: Dimension) -> ChoiceKind {
        match dimension {
            Dimension::Angle => ChoiceKind::Directions,
            Dimension::Speed => ChoiceKind::Speeds,
            Dimension::Length | Dimension::Pixels | Dimension::ArealDensity | Dimension::Number => {
                ChoiceKind::Lengths
            }
        }
    }

    /// Returns the dimension of a number among such choices, by which advice adds a unit.
    pub fn dimension(self) -> Dimension {
        match self {
            ChoiceKind::Directions => Dimension::Angle,
            ChoiceKind::Speeds => Dimension::Speed,
            ChoiceKind::Points | ChoiceKind::Lengths | ChoiceKind::Words => Dimension::Length,
        }
    }

    /// Returns the plural noun for choices of this kind.
    pub fn noun(self) -> &'static str {
        match self {
            ChoiceKind::Points => "points",
            ChoiceKind::Directions => "directions",
            ChoiceKind::Lengths => "lengths",
            ChoiceKind::Speeds => "speeds",
            ChoiceKind::Words => "words",
        }
    }
}
