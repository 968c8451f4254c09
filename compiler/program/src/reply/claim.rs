//! What an answer states about one field, and what every part of the reader needs to find it.

use super::names::Names;
use super::value::Context;
use crate::data::actions::{ActionField, Value};
use crate::pointing::Notation;
use std::ops::Range;

/// A statement about a field.
#[derive(Debug)]
pub(super) struct Claim {
    /// The field, by its index.
    pub field: usize,
    /// Where it stands in the answer, bytes.
    pub span: Range<usize>,
    pub claimed: Claimed,
    /// Whether it begins a clause or is data. What stands inside of a sentence, `I would not say Pick Point = (1, 2)`, may
    /// contradict another statement, and is none on its own.
    pub is_own: bool,
}

impl Claim {
    /// Makes a claim that was found in an object, a table or a tag.
    pub fn data(field: usize, span: Range<usize>, claimed: Claimed) -> Claim {
        Claim {
            field,
            span,
            claimed,
            is_own: true,
        }
    }
}

/// What a claim says.
#[derive(Debug)]
pub(super) enum Claimed {
    /// The field has this value; how it was read, if that is not obvious.
    Value(Value, Option<String>),
    /// One coordinate of a point.
    Axis(char, f64),
    /// It stands in the asked form or under the field's key, and is no value.
    Unreadable,
    /// Names the field without a readable value: `Pick point: near the hem`.
    Vague,
}

/// What every part of the reader needs.
pub(super) struct Reader<'a> {
    pub fields: &'a [ActionField],
    pub names: Names,
    pub edge_m: f64,
    pub notation: &'a Notation,
}

impl Reader<'_> {
    pub fn context(&self, field: usize) -> Context<'_> {
        Context {
            field: &self.fields[field],
            notation: self.notation,
            edge_m: self.edge_m,
        }
    }
}
