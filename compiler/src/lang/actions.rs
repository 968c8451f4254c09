//! Rows of `actions`: the fields that move the cloth.

use fab_program::units::{Dimension, UNITS};

/// The kind of a field's choices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChoiceKind {
    Points,
    Directions,
    Lengths,
    Words,
}

/// A field that moves the cloth; other fields are only recorded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldRow {
    pub name: &'static str,
    pub choices: ChoiceKind,
    /// How its choices are written.
    pub example: &'static str,
    /// What it is, one line.
    pub doc: &'static str,
}

/// The fields that move the cloth.
pub(crate) const FIELDS: &[FieldRow] = &[
    FieldRow {
        name: "pick",
        choices: ChoiceKind::Points,
        example: "pick: one of corners, center",
        doc: "where the cloth is gripped",
    },
    FieldRow {
        name: "place",
        choices: ChoiceKind::Points,
        example: "place: one of corners, center",
        doc: "where it is released; without it, the direction and the distance from the pick decide",
    },
    FieldRow {
        name: "direction",
        choices: ChoiceKind::Directions,
        example: "direction: one of 0deg, 90deg, 180deg, 270deg",
        doc: "which way the cloth is carried, counter-clockwise from the picture's right",
    },
    FieldRow {
        name: "distance",
        choices: ChoiceKind::Lengths,
        example: "distance: one of 0.25edge, 0.5edge",
        doc: "how far it is carried over the table",
    },
];

/// Returns the row of a field; `None` for one that moves nothing.
pub(crate) fn field(name: &str) -> Option<&'static FieldRow> {
    FIELDS.iter().find(|row| row.name == name)
}

impl ChoiceKind {
    /// Returns the kind of a number of this dimension.
    pub fn of(dimension: Dimension) -> ChoiceKind {
        match dimension {
            Dimension::Angle => ChoiceKind::Directions,
            Dimension::Length | Dimension::Pixels | Dimension::ArealDensity | Dimension::Number => {
                ChoiceKind::Lengths
            }
        }
    }

    /// Returns the unit that advice adds to a number without one.
    pub fn usual_unit(self) -> &'static str {
        let dimension = match self {
            ChoiceKind::Directions => Dimension::Angle,
            ChoiceKind::Points | ChoiceKind::Lengths | ChoiceKind::Words => Dimension::Length,
        };
        UNITS
            .iter()
            .find(|unit| unit.dimension == dimension)
            .map_or("", |unit| unit.name)
    }

    /// Returns the plural noun for choices of this kind.
    pub fn noun(self) -> &'static str {
        match self {
            ChoiceKind::Points => "points",
            ChoiceKind::Directions => "directions",
            ChoiceKind::Lengths => "lengths",
            ChoiceKind::Words => "words",
        }
    }
}
