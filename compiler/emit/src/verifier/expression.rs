//! Conditions as calls of small functions, the same in each language.
//!
//! Nothing is simplified if that could change a bit: a function does what one line of [`fab_program::eval`] does.

use super::dialect::Dialect;
use super::fields::Field;
use super::helpers;
use super::layout::Code;
use super::names::number;
use crate::error::EmitError;
use fab_program::{Choices, Comparison, Condition, End, Heading, Length, Number, Point};
use std::collections::BTreeSet;

/// Turns conditions into code and records which helpers that code calls.
pub(super) struct Lowering<'a> {
    pub dialect: &'static Dialect,
    pub fields: &'a [Field<'a>],
    pub helpers: BTreeSet<&'static str>,
}

impl<'a> Lowering<'a> {
    /// Writes whether every field is one of the offered values.
    pub fn offered(&mut self) -> Code {
        let fields = self.fields;
        let mut parts = Vec::with_capacity(fields.len());
        for field in fields {
            let table = self.table(field);
            let value = proposed(field);
            parts.push(match field.declared.choices {
                Choices::Points { .. } => {
                    self.call("is_point", [Code::text("facts"), table, value])
                }
                Choices::Region { .. } => {
                    self.call("is_inside", [Code::text("facts"), table, value])
                }
                Choices::Words { .. } => self.call("is_word", [table, value]),
                Choices::Directions { .. } | Choices::Lengths { .. } => {
                    self.call("is_choice", [table, value])
                }
            });
        }
        self.every("all", parts)
    }

    /// Writes a condition; its parts are evaluated from left to right until it is decided.
    pub fn condition(&mut self, condition: &Condition) -> Result<Code, EmitError> {
        Ok(match condition {
            Condition::All { of } => {
                let parts = self.conditions(of)?;
                self.joined("all", self.dialect.and, parts)
            }
            Condition::Any { of } => {
                let parts = self.conditions(of)?;
                self.joined("any", self.dialect.or, parts)
            }
            // Two of them cancel; a long chain would be nested too deeply for some parsers.
            Condition::Not { of } => match &**of {
                Condition::Not { of } => self.condition(of)?,
                of => {
                    let [open, close] = self.dialect.not;
                    Code::wrapped(open, self.condition(of)?, close)
                }
            },
            Condition::Lengths { left, is, right } => {
                let (left, right) = (self.square(left)?, self.square(right)?);
                Code::infix(left, is.sign(), right)
            }
            Condition::Angle {
                a,
                b,
                is,
                limit_cos,
                ..
            } => {
                let helper = match is {
                    Comparison::Less => "angle_less",
                    Comparison::AtMost => "angle_at_most",
                    Comparison::Greater => "angle_greater",
                    Comparison::AtLeast => "angle_at_least",
                };
                let (a, b) = (self.heading(a)?, self.heading(b)?);
                self.call(helper, [a, b, Code::text(number(*limit_cos)?)])
            }
            Condition::Number { left, is, limit } => {
                let left = self.number(left)?;
                Code::infix(left, is.sign(), Code::text(number(*limit)?))
            }
            Condition::Word { field, is } => {
                let field = self.field(field, "a field of words", |choices| {
                    matches!(choices, Choices::Words { .. })
                })?;
                Code::infix(proposed(field), "==", self.literal(is))
            }
            Condition::Within {
                point,
                region,
                margin_px,
            } => {
                let point = self.point(point)?;
                let region = self.literal(region);
                let distance = self.call("distance_px", [Code::text("facts"), point, region]);
                Code::infix(distance, "<=", Code::text(number(*margin_px)?))
            }
            Condition::Last => Code::text(self.dialect.has_last),
            // The compiler does not allow it in a check.
            Condition::Unreachable => {
                return Err(EmitError::Reference {
                    name: "unreachable".to_owned(),
                    wanted: "a condition of a check",
                });
            }
        })
    }

    fn conditions(&mut self, conditions: &[Condition]) -> Result<Vec<Code>, EmitError> {
        conditions.iter().map(|it| self.condition(it)).collect()
    }

    fn point(&mut self, point: &Point) -> Result<Code, EmitError> {
        Ok(match point {
            Point::Action { field } => {
                let field = self.field(field, "a field of points", Choices::are_points)?;
                self.call("at", [proposed(field)])
            }
            Point::Keypoint { name } => {
                let name = self.literal(name);
                self.missing_call("keypoint", [Code::text("facts"), name])
            }
            Point::Last { end } => {
                let end = match end {
                    End::Pick => "pick",
                    End::Place => "place",
                };
                let last = self.last(end);
                self.call("at", [last])
            }
            Point::Mirror { of, about } => {
                let (of, about) = (self.point(of)?, self.point(about)?);
                self.call("mirror", [of, about])
            }
            Point::Carried {
                from,
                direction,
                distance,
                px_per_m,
            } => {
                let from = self.point(from)?;
                let vector = self.direction(direction)?;
                let length_px = self.scaled(distance, *px_per_m)?;
                self.call("carried", [from, vector, length_px])
            }
        })
    }

    /// Writes the square of a length.
    fn square(&mut self, length: &Length) -> Result<Code, EmitError> {
        Ok(match length {
            Length::Constant { value } => {
                let value = Code::text(number(*value)?);
                self.call("square", [value])
            }
            Length::OfPoints(measure) => {
                let points = measure.points().iter().map(|point| self.point(point));
                let points = points.collect::<Result<Vec<_>, _>>()?;
                self.call(helpers::of_measure(measure.name())?, points)
            }
            Length::Field { field, scale } => {
                let value = self.scaled(field, *scale)?;
                self.call("square", [value])
            }
        })
    }

    /// Writes the metres of a field, times a factor.
    fn scaled(&mut self, field: &str, factor: f64) -> Result<Code, EmitError> {
        let field = self.field(field, "a field of lengths", |choices| {
            matches!(choices, Choices::Lengths { .. })
        })?;
        let metres = self.chosen(field, proposed(field));
        let factor = Code::text(number(factor)?);
        Ok(Code::infix(metres, "*", factor))
    }

    fn direction(&mut self, field: &str) -> Result<Code, EmitError> {
        let field = self.direction_field(field)?;
        Ok(self.chosen(field, proposed(field)))
    }

    fn heading(&mut self, heading: &Heading) -> Result<Code, EmitError> {
        Ok(match heading {
            Heading::Field { field } => self.direction(field)?,
            Heading::Last { field } => {
                let field = self.direction_field(field)?;
                let value = self.last(&field.identifier);
                self.chosen(field, value)
            }
            Heading::FromTo { from, to } => {
                let (from, to) = (self.point(from)?, self.point(to)?);
                self.call("from_to", [from, to])
            }
            Heading::Constant {
                vector: [right, down],
            } => {
                let [open, close] = self.dialect.pair;
                let numbers = [Code::text(number(*right)?), Code::text(number(*down)?)];
                Code::group(open, numbers, close)
            }
        })
    }

    fn number(&mut self, value: &Number) -> Result<Code, EmitError> {
        Ok(match value {
            Number::Count { keypoint } => {
                let keypoint = self.literal(keypoint);
                self.missing_call("count", [Code::text("facts"), keypoint])
            }
            Number::Step => Code::text(self.dialect.step),
            Number::Coverage { mask, flat_px } => {
                // Python would raise an error where Rust gets infinity.
                if *flat_px == 0.0 {
                    return Err(EmitError::Number {
                        value: format!("coverage of {mask} / {flat_px}"),
                    });
                }
                let mask = self.literal(mask);
                let area = self.missing_call("area_px", [Code::text("facts"), mask]);
                Code::infix(area, "/", Code::text(number(*flat_px)?))
            }
        })
    }

    /// Writes a part of the previous action.
    fn last(&mut self, part: &str) -> Code {
        let close = format!("){}.{part}", self.dialect.may_miss);
        self.helpers.insert("last");
        let open = format!("{}last(", self.dialect.private);
        Code::group(open, [Code::text("facts")], close)
    }

    /// Writes the meaning of a chosen value: metres, or a vector.
    fn chosen(&mut self, field: &Field<'_>, value: Code) -> Code {
        let table = self.table(field);
        let name = self.literal(&field.declared.name);
        self.missing_call("chosen", [table, value, name])
    }

    /// Joins conditions. Fewer than two need a function, but no source text has so few.
    fn joined(&mut self, helper: &'static str, sign: &'static str, parts: Vec<Code>) -> Code {
        if parts.len() < 2 {
            self.every(helper, parts)
        } else {
            Code::Joined { sign, parts }
        }
    }

    fn every(&mut self, helper: &'static str, parts: Vec<Code>) -> Code {
        self.helpers.insert(helper);
        Code::group(format!("{helper}(["), parts, "])")
    }

    fn call(&mut self, helper: &'static str, arguments: impl IntoIterator<Item = Code>) -> Code {
        self.helpers.insert(helper);
        let open = format!("{}{helper}(", self.dialect.private);
        Code::group(open, arguments, ")")
    }

    fn missing_call<const N: usize>(&mut self, helper: &'static str, arguments: [Code; N]) -> Code {
        self.helpers.insert(helper);
        let open = format!("{}{helper}(", self.dialect.private);
        Code::group(open, arguments, format!("){}", self.dialect.may_miss))
    }

    fn literal(&self, text: &str) -> Code {
        Code::text((self.dialect.text)(text))
    }

    fn table(&self, field: &Field<'_>) -> Code {
        Code::text(format!("{}{}", self.dialect.private, field.table))
    }

    fn direction_field(&self, name: &str) -> Result<&'a Field<'a>, EmitError> {
        self.field(name, "a field of directions", |choices| {
            matches!(choices, Choices::Directions { .. })
        })
    }

    fn field(
        &self,
        name: &str,
        wanted: &'static str,
        is_wanted: impl Fn(&Choices) -> bool,
    ) -> Result<&'a Field<'a>, EmitError> {
        let field = self.fields.iter().find(|field| field.declared.name == name);
        field
            .filter(|field| is_wanted(&field.declared.choices))
            .ok_or_else(|| EmitError::Reference {
                name: name.to_owned(),
                wanted,
            })
    }
}

/// Writes the proposed value of a field.
fn proposed(field: &Field<'_>) -> Code {
    Code::text(format!("facts.action.{}", field.identifier))
}
