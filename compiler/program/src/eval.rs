//! Evaluates points, lengths, directions, numbers and conditions.
//!
//! In: a program's values and [`Facts`]. Out: numbers. Where a verdict depends on the result, only additions,
//! multiplications and comparisons of 64-bit floats are used, in a fixed order, so the emitted verifiers compute the
//! same bits in other languages.

use crate::data::actions::{Choices, Value};
use crate::data::camera::PixelPoint;
use crate::data::points::{End, Heading, Point};
use crate::data::program::Program;
use crate::data::values::Condition;
use crate::exact::{vector_of, written};
use crate::facts::Facts;
use crate::measures::{self, Length, Number, PointMeasure};
use crate::scene::Missing;

/// Evaluates the values of one program.
#[derive(Clone, Copy)]
pub struct Eval<'a> {
    /// The program.
    pub program: &'a Program,
    /// What is known.
    pub facts: Facts<'a>,
}

/// The sides of a condition for reports: a name and its value.
pub type Notes = Vec<(String, String)>;

impl Eval<'_> {
    /// Returns a point, `[column, row]` in pixels.
    pub fn point(&self, point: &Point) -> Result<[f64; 2], Missing> {
        match point {
            Point::Action { field } => match self.facts.proposed(field) {
                Some(Value::Point(pixel)) => Ok(float(*pixel)),
                _ => Err(Missing::of(field)),
            },
            Point::Keypoint { name } => {
                let points = self.facts.scene.points(name);
                let first = points.and_then(|points| points.first().copied());
                first.map(float).ok_or_else(|| Missing::of(name))
            }
            Point::Last { end } => {
                let last = self.facts.last.ok_or_else(|| Missing::of("last"))?;
                Ok(float(match end {
                    End::Pick => last.pick,
                    End::Place => last.place,
                }))
            }
            Point::Mirror { of, about } => {
                let (of, about) = (self.point(of)?, self.point(about)?);
                Ok(measures::mirror(of, about))
            }
            Point::Carried {
                from,
                direction,
                distance,
                px_per_m,
            } => {
                let from = self.point(from)?;
                let vector = self.direction(direction, self.facts.proposed(direction))?;
                let length_px = self.length_m(distance)? * px_per_m;
                Ok([0, 1].map(|axis| from[axis] + vector[axis] * length_px))
            }
        }
    }

    /// Returns a point as a whole pixel.
    pub fn pixel(&self, point: &Point) -> Result<PixelPoint, Missing> {
        Ok(rounded(self.point(point)?))
    }

    /// Returns the square of a length.
    fn square(&self, length: &Length) -> Result<f64, Missing> {
        Ok(match length {
            Length::Constant { value } => value * value,
            Length::OfPoints(measure) => self.square_of_points(measure)?,
            Length::Field { field, scale } => {
                let value = self.length_m(field)? * scale;
                value * value
            }
        })
    }

    fn square_of_points(&self, measure: &PointMeasure) -> Result<f64, Missing> {
        let points = measure.points().iter().map(|point| self.point(point));
        Ok(measure.square(&points.collect::<Result<Vec<_>, _>>()?))
    }

    /// Returns a length, pixels or metres.
    pub fn length(&self, length: &Length) -> Result<f64, Missing> {
        Ok(match length {
            Length::Constant { value } => *value,
            Length::OfPoints(measure) => {
                let square = self.square_of_points(measure)?;
                square.abs().sqrt().copysign(square)
            }
            Length::Field { field, scale } => self.length_m(field)? * scale,
        })
    }

    /// Returns the value of a length field in metres; a value that is not offered counts as missing.
    fn length_m(&self, field: &str) -> Result<f64, Missing> {
        let declared = self.program.field(field).map(|field| &field.choices);
        let (Some(Choices::Lengths { choices, .. }), Some(Value::Length { length })) =
            (declared, self.facts.proposed(field))
        else {
            return Err(Missing::of(field));
        };
        let offered = choices.iter().find(|choice| choice.value == *length);
        offered
            .map(|choice| choice.m)
            .ok_or_else(|| Missing::of(field))
    }

    /// Returns a field's direction as a vector; a value that is not offered is converted by its unit.
    fn direction(&self, field: &str, value: Option<&Value>) -> Result<[f64; 2], Missing> {
        let declared = self.program.field(field).map(|field| &field.choices);
        let (Some(Choices::Directions { choices }), Some(Value::Direction { deg })) =
            (declared, value)
        else {
            return Err(Missing::of(field));
        };
        let offered = choices.iter().find(|choice| choice.deg == *deg);
        Ok(offered.map_or_else(|| vector_of(*deg), |choice| choice.vector))
    }

    /// Returns a direction as a vector, right and down; not of length 1.
    pub fn heading(&self, heading: &Heading) -> Result<[f64; 2], Missing> {
        match heading {
            Heading::Field { field } => self.direction(field, self.facts.proposed(field)),
            Heading::Last { field } => {
                let last = self.facts.last.ok_or_else(|| Missing::of("last"))?;
                self.direction(field, last.proposal.get(field))
            }
            Heading::FromTo { from, to } => {
                let (from, to) = (self.point(from)?, self.point(to)?);
                Ok([to[0] - from[0], to[1] - from[1]])
            }
            Heading::Constant { vector } => Ok(*vector),
        }
    }

    /// Returns the angle between two directions, degrees; 0 if one has no length.
    pub fn angle_deg(&self, a: &Heading, b: &Heading) -> Result<f64, Missing> {
        Ok(measures::angle_deg(self.heading(a)?, self.heading(b)?))
    }

    /// Returns the choice of a direction field that is nearest to a direction, degrees.
    pub fn nearest_deg(&self, field: &str, to: &Heading) -> Result<f64, Missing> {
        let Some(Choices::Directions { choices }) =
            self.program.field(field).map(|field| &field.choices)
        else {
            return Err(Missing::of(field));
        };
        measures::nearest_deg(choices, self.heading(to)?).ok_or_else(|| Missing::of(field))
    }

    /// Returns a number.
    pub fn number(&self, number: &Number) -> Result<f64, Missing> {
        number.value(self.facts.scene, self.facts.step)
    }

    /// Returns whether a condition holds, and notes the values of its sides.
    ///
    /// Parts are evaluated from left to right until the result is certain, so `last and …` also works in the first
    /// step.
    pub fn holds(&self, condition: &Condition, notes: &mut Notes) -> Result<bool, Missing> {
        match condition {
            Condition::All { of } => {
                for part in of {
                    if !self.holds(part, notes)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            Condition::Any { of } => {
                for part in of {
                    if self.holds(part, notes)? {
                        return Ok(true);
                    }
                }
                Ok(false)
            }
            Condition::Not { of } => Ok(!self.holds(of, notes)?),
            Condition::Lengths { left, is, right } => {
                self.note_length(left, notes)?;
                self.note_length(right, notes)?;
                Ok(is.holds(self.square(left)?, self.square(right)?))
            }
            Condition::Angle {
                a,
                b,
                is,
                limit_cos,
                ..
            } => {
                let degrees = format!("{:.1} deg", self.angle_deg(a, b)?);
                note(notes, format!("angle from {a} to {b}"), degrees);
                let (a, b) = (self.heading(a)?, self.heading(b)?);
                let [along, limit] = measures::angle_sides(a, b, *limit_cos);
                // The larger the angle, the smaller its cosine.
                Ok(is.reversed().holds(along, limit))
            }
            Condition::Number { left, is, limit } => {
                let value = self.number(left)?;
                note(notes, left.to_string(), written(value, 3));
                Ok(is.holds(value, *limit))
            }
            Condition::Word { field, is } => match self.facts.proposed(field) {
                Some(Value::Word(word)) => {
                    note(notes, field.clone(), word.clone());
                    Ok(word == is)
                }
                _ => Err(Missing::of(field)),
            },
            Condition::Within {
                point,
                region,
                margin_px,
            } => {
                let at = self.pixel(point)?;
                // A mask without pixels is infinitely far away.
                let distance_px = self
                    .facts
                    .scene
                    .distance_px(region, at)
                    .unwrap_or(f64::INFINITY);
                note(notes, point.to_string(), at.to_string());
                note(
                    notes,
                    format!("distance to {region}"),
                    format!("{distance_px:.1} px"),
                );
                Ok(distance_px <= *margin_px)
            }
            Condition::Last => Ok(self.facts.last.is_some()),
            Condition::Unreachable => Ok(!self.facts.scene.unreachable().is_empty()),
        }
    }

    fn note_length(&self, length: &Length, notes: &mut Notes) -> Result<(), Missing> {
        match length {
            Length::Constant { .. } => {}
            Length::OfPoints(measure) => {
                let value = format!("{:.1} px", self.length(length)?);
                note(notes, measure.to_string(), value);
            }
            Length::Field { field, .. } => {
                let value = format!("{} mm", written(self.length_m(field)? * 1000.0, 1));
                note(notes, field.clone(), value);
            }
        }
        Ok(())
    }
}

/// Returns a point as a whole pixel.
pub fn pixel(program: &Program, facts: Facts<'_>, point: &Point) -> Result<PixelPoint, Missing> {
    Eval { program, facts }.pixel(point)
}

/// Returns the nearest whole pixel; halves go up.
pub fn rounded(point: [f64; 2]) -> PixelPoint {
    let [u, v] = point.map(|value| (value + 0.5).floor() as i32);
    PixelPoint::new(u, v)
}

fn float(pixel: PixelPoint) -> [f64; 2] {
    [f64::from(pixel.u), f64::from(pixel.v)]
}

fn note(notes: &mut Notes, what: String, value: String) {
    if !notes.iter().any(|(known, _)| *known == what) {
        notes.push((what, value));
    }
}
