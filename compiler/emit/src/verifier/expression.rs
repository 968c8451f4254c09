//! Conditions as calls of the functions in `support.rs` and `support.py`, which have the same names and arguments.
//!
//! Nothing is simplified if that could change a bit: a function does what one line of [`fab_program::eval`] does.

use super::dialect::Dialect;
use super::fields::Field;
use super::names::number;
use crate::error::EmitError;
use fab_program::measures::Square;
use fab_program::{Choices, Comparison, Condition, End, Heading, Length, Number, Point};

/// Writes the conditions of a program whose fields these are.
pub(super) struct Lowering<'a> {
    pub dialect: &'static Dialect,
    pub fields: &'a [Field<'a>],
}

impl<'a> Lowering<'a> {
    /// Writes whether every field is one of the offered values.
    pub fn offered(&self) -> String {
        let offered = self.fields.iter().map(|field| {
            let (table, value) = (&field.table, proposed(field));
            match field.declared.choices {
                Choices::Points { .. } => format!("is_point(facts.scene, {table}, {value})"),
                Choices::Region { .. } => format!("is_inside(facts.scene, {table}, {value})"),
                Choices::Words { .. } => format!("is_word({table}, {value})"),
                Choices::Directions { .. } | Choices::Lengths { .. } => {
                    format!("is_choice({table}, {value})")
                }
            }
        });
        joined("all", self.dialect.and, offered.collect())
    }

    /// Writes a condition; its parts are evaluated from left to right until it is decided.
    pub fn condition(&self, condition: &Condition) -> Result<String, EmitError> {
        Ok(match condition {
            Condition::All { of } => joined("all", self.dialect.and, self.conditions(of)?),
            Condition::Any { of } => joined("any", self.dialect.or, self.conditions(of)?),
            // Two of them cancel; a long chain would be nested too deeply for some parsers.
            Condition::Not { of } => match &**of {
                Condition::Not { of } => self.condition(of)?,
                of => format!("{}({})", self.dialect.not, self.condition(of)?),
            },
            Condition::Lengths { left, is, right } => {
                let (left, right) = (self.square(left)?, self.square(right)?);
                format!("{left} {} {right}", is.sign())
            }
            Condition::Angle {
                a,
                b,
                is,
                limit_cos,
                ..
            } => {
                let holds = match is {
                    Comparison::Less => "angle_less",
                    Comparison::AtMost => "angle_at_most",
                    Comparison::Greater => "angle_greater",
                    Comparison::AtLeast => "angle_at_least",
                };
                let (a, b, limit) = (self.heading(a)?, self.heading(b)?, number(*limit_cos)?);
                format!("{holds}({a}, {b}, {limit})")
            }
            Condition::Number { left, is, limit } => {
                let (left, limit) = (self.number(left)?, number(*limit)?);
                format!("{left} {} {limit}", is.sign())
            }
            Condition::Word { field, is } => {
                let field = self.field(field, "a field of words", |choices| {
                    matches!(choices, Choices::Words { .. })
                })?;
                format!("{} == {}", proposed(field), self.dialect.text(is))
            }
            Condition::Within {
                point,
                region,
                margin_px,
            } => {
                let (point, region) = (self.point(point)?, self.dialect.text(region));
                let margin = number(*margin_px)?;
                format!("distance_px(facts.scene, {point}, {region}) <= {margin}")
            }
            Condition::Last => self.dialect.has_last.to_owned(),
            // The compiler does not allow it in a check.
            Condition::Unreachable => {
                return Err(EmitError::Reference {
                    name: "unreachable".to_owned(),
                    wanted: "a condition of a check",
                });
            }
        })
    }

    fn conditions(&self, conditions: &[Condition]) -> Result<Vec<String>, EmitError> {
        conditions.iter().map(|it| self.condition(it)).collect()
    }

    fn point(&self, point: &Point) -> Result<String, EmitError> {
        Ok(match point {
            Point::Action { field } => {
                let field = self.field(field, "a field of points", Choices::are_points)?;
                format!("at({})", proposed(field))
            }
            Point::Keypoint { name } => {
                let name = self.dialect.text(name);
                self.may_miss(format!("keypoint(facts.scene, {name})"))
            }
            Point::Last { end } => {
                let end = match end {
                    End::Pick => "pick",
                    End::Place => "place",
                };
                format!("at({})", self.last(end))
            }
            Point::Mirror { of, about } => {
                format!("mirror({}, {})", self.point(of)?, self.point(about)?)
            }
            Point::Carried {
                from,
                direction,
                distance,
                px_per_m,
            } => {
                let (from, vector) = (self.point(from)?, self.direction(direction)?);
                let length_px = self.scaled(distance, *px_per_m)?;
                format!("carried({from}, {vector}, {length_px})")
            }
        })
    }

    /// Writes the square of a length.
    fn square(&self, length: &Length) -> Result<String, EmitError> {
        Ok(match length {
            Length::Constant { value } => format!("square({})", number(*value)?),
            Length::OfPoints(measure) => {
                let points = measure.points().iter().map(|point| self.point(point));
                let points = points.collect::<Result<Vec<_>, _>>()?.join(", ");
                format!("squared_{}({points})", measure.name())
            }
            Length::Field { field, scale } => format!("square({})", self.scaled(field, *scale)?),
        })
    }

    /// Writes the metres of a field, times a factor.
    fn scaled(&self, field: &str, factor: f64) -> Result<String, EmitError> {
        let field = self.field(field, "a field of lengths", |choices| {
            matches!(choices, Choices::Lengths { .. })
        })?;
        let metres = self.chosen(field, &proposed(field));
        Ok(format!("{metres} * {}", number(factor)?))
    }

    fn direction(&self, field: &str) -> Result<String, EmitError> {
        let field = self.direction_field(field)?;
        Ok(self.chosen(field, &proposed(field)))
    }

    fn heading(&self, heading: &Heading) -> Result<String, EmitError> {
        Ok(match heading {
            Heading::Field { field } => self.direction(field)?,
            Heading::Last { field } => {
                let field = self.direction_field(field)?;
                self.chosen(field, &self.last(&field.identifier))
            }
            Heading::FromTo { from, to } => {
                format!("from_to({}, {})", self.point(from)?, self.point(to)?)
            }
            Heading::Constant {
                vector: [right, down],
            } => self.dialect.pair(&number(*right)?, &number(*down)?),
        })
    }

    fn number(&self, value: &Number) -> Result<String, EmitError> {
        Ok(match value {
            Number::Count { keypoint } => {
                let keypoint = self.dialect.text(keypoint);
                self.may_miss(format!("count(facts.scene, {keypoint})"))
            }
            Number::Step => "facts.step".to_owned(),
            Number::Coverage { mask, flat_px } => {
                // Python would raise an error where Rust gets infinity.
                if *flat_px == 0.0 {
                    return Err(EmitError::Number {
                        value: format!("coverage of {mask} / {flat_px}"),
                    });
                }
                let mask = self.dialect.text(mask);
                let area = self.may_miss(format!("area_px(facts.scene, {mask})"));
                format!("{area} / {}", number(*flat_px)?)
            }
        })
    }

    /// Writes a part of the previous action.
    fn last(&self, part: &str) -> String {
        format!("{}.{part}", self.may_miss("known(facts.last)".to_owned()))
    }

    /// Writes the meaning of a chosen value: metres, or a vector.
    fn chosen(&self, field: &Field<'_>, value: &str) -> String {
        let (table, name) = (&field.table, self.dialect.text(&field.declared.name));
        self.may_miss(format!("chosen({table}, {value}, {name})"))
    }

    /// Writes a call that ends the check if something is missing.
    fn may_miss(&self, call: String) -> String {
        call + self.dialect.may_miss
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

/// Writes the formula of a measure over the names of its points.
pub(super) fn formula(square: Square, points: &[String]) -> String {
    match square {
        Square::Coordinate(axis) => format!("signed_square({}[{axis}])", points[0]),
        Square::Apart(axis) => {
            format!("square({}[{axis}] - {}[{axis}])", points[0], points[1])
        }
        Square::Sum(one, other) => {
            let (one, other) = (formula(*one, points), formula(*other, points));
            format!("({one} + {other})")
        }
        Square::Larger(one, other) => {
            let (one, other) = (formula(*one, points), formula(*other, points));
            format!("larger({one}, {other})")
        }
    }
}

/// Joins conditions, one a line. Fewer than two need a function, but no source text has so few.
fn joined(function: &str, sign: &str, parts: Vec<String>) -> String {
    if parts.len() < 2 {
        return format!("{function}([{}])", parts.concat());
    }
    let lines = parts.join(&format!("\n{sign} ")).replace('\n', "\n    ");
    format!("(\n    {lines}\n)")
}

/// Writes the proposed value of a field.
fn proposed(field: &Field<'_>) -> String {
    format!("facts.action.{}", field.identifier)
}
