//! What points, lengths, directions, numbers and conditions come to.
//!
//! In: a program's values and [`Facts`]. Out: numbers. Only additions, multiplications and comparisons of
//! 64-bit floats are used where a verdict depends on the result, in a fixed order, so that the emitted
//! verifiers come to the same in other languages.

use crate::data::actions::{Choices, Value};
use crate::data::camera::PixelPoint;
use crate::data::program::Program;
use crate::data::values::{Condition, End, Heading, Length, Number, Point};
use crate::facts::{Facts, Missing};

/// Evaluates the values of one program.
#[derive(Clone, Copy)]
pub struct Eval<'a> {
    /// The program.
    pub program: &'a Program,
    /// What is known.
    pub facts: Facts<'a>,
}

/// A condition's sides, for reports: what, and what it came to.
pub type Notes = Vec<(String, String)>;

impl Eval<'_> {
    /// Returns a point, `[column, row]` in pixels.
    pub fn point(&self, point: &Point) -> Result<[f64; 2], Missing> {
        match point {
            Point::Action { field } => match self.facts.proposed(field) {
                Some(Value::Point(pixel)) => Ok(float(*pixel)),
                _ => Err(missing(field)),
            },
            Point::Keypoint { name } => {
                let points = self.facts.scene.points(name);
                let first = points.and_then(|points| points.first().copied());
                first.map(float).ok_or_else(|| missing(name))
            }
            Point::Last { end } => {
                let last = self.facts.last.ok_or_else(|| missing("last"))?;
                Ok(float(match end {
                    End::Pick => last.pick,
                    End::Place => last.place,
                }))
            }
            Point::Mirror { of, about } => {
                let (of, about) = (self.point(of)?, self.point(about)?);
                Ok([0, 1].map(|axis| 2.0 * about[axis] - of[axis]))
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
            Length::Distance { a, b } => {
                let (a, b) = (self.point(a)?, self.point(b)?);
                let (du, dv) = (a[0] - b[0], a[1] - b[1]);
                du * du + dv * dv
            }
            Length::Chebyshev { a, b } => {
                let (a, b) = (self.point(a)?, self.point(b)?);
                let (du, dv) = (a[0] - b[0], a[1] - b[1]);
                let (du, dv) = (du * du, dv * dv);
                if du > dv { du } else { dv }
            }
            Length::Field { field, scale } => {
                let value = self.length_m(field)? * scale;
                value * value
            }
        })
    }

    /// Returns a length, pixels or metres.
    pub fn length(&self, length: &Length) -> Result<f64, Missing> {
        Ok(match length {
            Length::Constant { value } => *value,
            Length::Distance { .. } | Length::Chebyshev { .. } => self.square(length)?.sqrt(),
            Length::Field { field, scale } => self.length_m(field)? * scale,
        })
    }

    /// Returns the metres of a field that is a length; of a value that is not offered, what it says.
    fn length_m(&self, field: &str) -> Result<f64, Missing> {
        let declared = self.program.field(field).map(|field| &field.choices);
        let (Some(Choices::Lengths { unit, choices }), Some(Value::Length { length })) =
            (declared, self.facts.proposed(field))
        else {
            return Err(missing(field));
        };
        let offered = choices.iter().find(|choice| choice.value == *length);
        Ok(offered.map_or_else(
            || length * unit.size_with(self.program.cloth.edge_m()),
            |choice| choice.m,
        ))
    }

    /// Returns a field's direction as a vector; of a value that is not offered, what it says.
    fn direction(&self, field: &str, value: Option<&Value>) -> Result<[f64; 2], Missing> {
        let declared = self.program.field(field).map(|field| &field.choices);
        let (Some(Choices::Directions { choices }), Some(Value::Direction { deg })) =
            (declared, value)
        else {
            return Err(missing(field));
        };
        let offered = choices.iter().find(|choice| choice.deg == *deg);
        Ok(offered.map_or_else(|| crate::exact::vector_of(*deg), |choice| choice.vector))
    }

    /// Returns a direction as a vector, right and down; not of length 1.
    pub fn heading(&self, heading: &Heading) -> Result<[f64; 2], Missing> {
        match heading {
            Heading::Field { field } => self.direction(field, self.facts.proposed(field)),
            Heading::Last { field } => {
                let last = self.facts.last.ok_or_else(|| missing("last"))?;
                self.direction(field, last.proposal.get(field))
            }
            Heading::FromTo { from, to } => {
                let (from, to) = (self.point(from)?, self.point(to)?);
                Ok([to[0] - from[0], to[1] - from[1]])
            }
            Heading::Constant { vector } => Ok(*vector),
        }
    }

    /// Returns the angle between two directions, degrees; 0 where one has no length.
    pub fn angle_deg(&self, a: &Heading, b: &Heading) -> Result<f64, Missing> {
        let (a, b) = (self.heading(a)?, self.heading(b)?);
        let cross = a[0] * b[1] - a[1] * b[0];
        Ok(libm::atan2(cross.abs(), dot(a, b)).to_degrees())
    }

    /// Returns the choice of a direction field that is nearest to a direction, degrees.
    pub fn nearest_deg(&self, field: &str, to: &Heading) -> Result<f64, Missing> {
        let Some(Choices::Directions { choices }) =
            self.program.field(field).map(|field| &field.choices)
        else {
            return Err(missing(field));
        };
        let to = self.heading(to)?;
        let mut best: Option<(f64, f64)> = None;
        for choice in choices {
            let along = dot(choice.vector, to);
            if best.is_none_or(|(most, _)| along > most) {
                best = Some((along, choice.deg));
            }
        }
        best.map(|(_, deg)| deg).ok_or_else(|| missing(field))
    }

    /// Returns a number.
    pub fn number(&self, number: &Number) -> Result<f64, Missing> {
        match number {
            Number::Count { keypoint } => {
                let points = self.facts.scene.points(keypoint);
                points
                    .map(|points| points.len() as f64)
                    .ok_or_else(|| missing(keypoint))
            }
            Number::Step => Ok(f64::from(self.facts.step)),
            Number::Coverage { mask, flat_px } => {
                let area_px = self.facts.scene.area_px(mask);
                area_px
                    .map(|area_px| area_px / flat_px)
                    .ok_or_else(|| missing(mask))
            }
        }
    }

    /// Returns whether a condition holds, and notes what its sides came to.
    ///
    /// Parts are evaluated from left to right until it is decided, so that `last and …` asks nothing of an
    /// action that there was not.
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
                note(
                    notes,
                    format!("angle from {} to {}", heading_name(a), heading_name(b)),
                    degrees,
                );
                let (a, b) = (self.heading(a)?, self.heading(b)?);
                let along = dot(a, b);
                let limit = limit_cos * limit_cos.abs() * (dot(a, a) * dot(b, b));
                // The larger the angle, the smaller its cosine.
                Ok(is.reversed().holds(along * along.abs(), limit))
            }
            Condition::Number { left, is, limit } => {
                let value = self.number(left)?;
                note(notes, number_name(left), crate::exact::written(value, 3));
                Ok(is.holds(value, *limit))
            }
            Condition::Word { field, is } => match self.facts.proposed(field) {
                Some(Value::Word(word)) => {
                    note(notes, field.clone(), word.clone());
                    Ok(word == is)
                }
                _ => Err(missing(field)),
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
                note(notes, point_name(point), at.to_string());
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
            Length::Distance { a, b } | Length::Chebyshev { a, b } => {
                let measure = match length {
                    Length::Chebyshev { .. } => "chebyshev",
                    _ => "distance",
                };
                let value = format!("{:.1} px", self.length(length)?);
                note(
                    notes,
                    format!("{measure}({}, {})", point_name(a), point_name(b)),
                    value,
                );
            }
            Length::Field { field, .. } => {
                let value = format!(
                    "{} mm",
                    crate::exact::written(self.length_m(field)? * 1000.0, 1)
                );
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

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn float(pixel: PixelPoint) -> [f64; 2] {
    [f64::from(pixel.u), f64::from(pixel.v)]
}

fn missing(name: &str) -> Missing {
    Missing {
        name: name.to_owned(),
    }
}

fn note(notes: &mut Notes, what: String, value: String) {
    if !notes.iter().any(|(known, _)| *known == what) {
        notes.push((what, value));
    }
}

fn point_name(point: &Point) -> String {
    match point {
        Point::Action { field } => field.clone(),
        Point::Keypoint { name } => name.clone(),
        Point::Last { end: End::Pick } => "last.pick".to_owned(),
        Point::Last { end: End::Place } => "last.place".to_owned(),
        Point::Mirror { of, about } => format!("mirror({}, {})", point_name(of), point_name(about)),
        Point::Carried { .. } => "place".to_owned(),
    }
}

fn heading_name(heading: &Heading) -> String {
    match heading {
        Heading::Field { field } => field.clone(),
        Heading::Last { field } => format!("last.{field}"),
        Heading::FromTo { from, to } => format!("({} -> {})", point_name(from), point_name(to)),
        Heading::Constant { vector } => {
            let deg = libm::atan2(-vector[1], vector[0]).to_degrees();
            format!(
                "{} deg",
                crate::exact::written(crate::exact::normalised_deg(deg), 1)
            )
        }
    }
}

fn number_name(number: &Number) -> String {
    match number {
        Number::Count { keypoint } => format!("count({keypoint})"),
        Number::Step => "step".to_owned(),
        Number::Coverage { mask, .. } => format!("coverage({mask})"),
    }
}
