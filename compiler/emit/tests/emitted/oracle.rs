//! Judges cases in a second way, with roots and with angles in degrees. Far from any limit the result is the same.
//!
//! It also reports how far each comparison is from its limit, in the unit of the compared values: pixels,
//! millimetres, degrees, points, steps, hundredths.

use super::case::Case;
use fab_program::scene::SceneView;
use fab_program::space;
use fab_program::{
    Choices, Comparison, Condition, End, Heading, Length, Number, Point, Program, Value,
};

/// A keypoint or the previous action is missing.
pub struct Missing;

/// The result of a case.
pub struct Outcome {
    /// `None` if something is missing.
    pub verdict: Option<Said>,
    /// Each comparison of each check that was reached: its number, and how far it is from its limit.
    pub margins: Vec<(usize, f64)>,
    /// The numbers of the checks that were run.
    pub reached: Vec<usize>,
}

/// The number of the check that rejects; a number beyond the last one means accepted.
pub type Said = usize;

pub struct Oracle<'a> {
    program: &'a Program,
    case: &'a Case,
    margins: Vec<(usize, f64)>,
    next: usize,
}

/// Judges a case: 0 if a field is not offered, the number from 1 of the check that fails, or one more than the last.
pub fn judge(program: &Program, case: &Case) -> Outcome {
    let mut oracle = Oracle {
        program,
        case,
        margins: Vec::new(),
        next: 0,
    };
    let mut reached = vec![0];
    let verdict = oracle.verdict(&mut reached);
    Outcome {
        verdict: verdict.ok(),
        margins: oracle.margins,
        reached,
    }
}

/// Returns the number of comparisons with a limit in a program's checks.
pub fn comparisons(program: &Program) -> usize {
    let checks = &program.verify.checks;
    let conditions = checks
        .iter()
        .flat_map(|it| it.when.iter().chain([&it.holds]));
    conditions.map(leaves).sum()
}

fn leaves(condition: &Condition) -> usize {
    match condition {
        Condition::All { of } | Condition::Any { of } => of.iter().map(leaves).sum(),
        Condition::Not { of } => leaves(of),
        Condition::Word { .. } | Condition::Last | Condition::Unreachable => 0,
        _ => 1,
    }
}

impl Oracle<'_> {
    fn verdict(&mut self, reached: &mut Vec<usize>) -> Result<Said, Missing> {
        let program = self.program;
        for field in &program.actions {
            let value = self.case.proposal.get(&field.name).unwrap();
            if !space::choices(field, &self.case.scene).contains(value) {
                return Ok(0);
            }
        }
        for (index, check) in program.verify.checks.iter().enumerate() {
            let first = self.next;
            let is_asked = match &check.when {
                Some(when) => self.holds(when)?,
                None => true,
            };
            if is_asked {
                reached.push(index + 1);
                if !self.holds(&check.holds)? {
                    return Ok(index + 1);
                }
            }
            let conditions = check.when.iter().chain([&check.holds]);
            self.next = first + conditions.map(leaves).sum::<usize>();
        }
        Ok(program.verify.checks.len() + 1)
    }

    fn compare(&mut self, left: f64, is: Comparison, right: f64, unit: f64) -> bool {
        self.margins.push((self.next, (left - right).abs() / unit));
        self.next += 1;
        match is {
            Comparison::Less => left < right,
            Comparison::AtMost => left <= right,
            Comparison::Greater => left > right,
            Comparison::AtLeast => left >= right,
        }
    }

    fn holds(&mut self, condition: &Condition) -> Result<bool, Missing> {
        Ok(match condition {
            Condition::All { of } => {
                for part in of {
                    if !self.holds(part)? {
                        return Ok(false);
                    }
                }
                true
            }
            Condition::Any { of } => {
                for part in of {
                    if self.holds(part)? {
                        return Ok(true);
                    }
                }
                false
            }
            Condition::Not { of } => !self.holds(of)?,
            Condition::Lengths { left, is, right } => {
                let in_metres = matches!(left, Length::Field { scale, .. } if *scale == 1.0);
                let (left, right) = (self.length(left)?, self.length(right)?);
                self.compare(left, *is, right, if in_metres { 0.001 } else { 1.0 })
            }
            Condition::Angle {
                a,
                b,
                is,
                limit_deg,
                ..
            } => {
                let (a, b) = (self.heading(a)?, self.heading(b)?);
                let deg = |vector: [f64; 2]| vector[1].atan2(vector[0]).to_degrees();
                let turn = (deg(a) - deg(b)).abs();
                // Between equal points there is no direction, so the comparisons with 0 decide.
                if a == [0.0, 0.0] || b == [0.0, 0.0] {
                    self.margins.push((self.next, 0.0));
                    self.next += 1;
                    return Ok(matches!(is, Comparison::AtMost | Comparison::AtLeast));
                }
                self.compare(turn.min(360.0 - turn), *is, *limit_deg, 1.0)
            }
            Condition::Number { left, is, limit } => {
                let unit = if matches!(left, Number::Coverage { .. }) {
                    0.01
                } else {
                    1.0
                };
                let left = self.number(left)?;
                self.compare(left, *is, *limit, unit)
            }
            Condition::Word { field, is } => {
                self.case.proposal.get(field) == Some(&Value::Word(is.clone()))
            }
            Condition::Within {
                point,
                region,
                margin_px,
            } => {
                let at = self
                    .point(point)?
                    .map(|it| (it + 0.5).floor() as i32)
                    .into();
                let distance = self.case.scene.distance_px(region, at);
                self.compare(
                    distance.unwrap_or(f64::INFINITY),
                    Comparison::AtMost,
                    *margin_px,
                    1.0,
                )
            }
            Condition::Last => self.case.last.is_some(),
            Condition::Unreachable => unreachable!("no check asks what is out of reach"),
        })
    }

    fn number(&self, number: &Number) -> Result<f64, Missing> {
        let scene = &self.case.scene;
        match number {
            Number::Count { keypoint } => {
                Ok(scene.points.get(keypoint).ok_or(Missing)?.len() as f64)
            }
            Number::Step => Ok(f64::from(self.case.step)),
            Number::Coverage { mask, flat_px } => {
                Ok(scene.areas.get(mask).ok_or(Missing)? / flat_px)
            }
        }
    }

    fn length(&self, length: &Length) -> Result<f64, Missing> {
        Ok(match length {
            Length::Constant { value } => *value,
            Length::OfPoints(measure) => {
                let points = measure.points();
                let (a, b) = (self.point(&points[0])?, self.point(&points[1])?);
                match measure.name() {
                    "distance" => (a[0] - b[0]).hypot(a[1] - b[1]),
                    "chebyshev" => (a[0] - b[0]).abs().max((a[1] - b[1]).abs()),
                    other => panic!("no oracle for `{other}`"),
                }
            }
            Length::Field { field, scale } => self.metres(field) * scale,
        })
    }

    fn metres(&self, field: &str) -> f64 {
        match (
            &self.program.field(field).unwrap().choices,
            self.case.proposal.get(field),
        ) {
            (Choices::Lengths { choices, .. }, Some(Value::Length { length })) => {
                choices.iter().find(|it| it.value == *length).unwrap().m
            }
            other => panic!("{other:?}"),
        }
    }

    fn heading(&self, heading: &Heading) -> Result<[f64; 2], Missing> {
        let vector = |value: Option<&Value>| match value {
            Some(Value::Direction { deg }) => [deg.to_radians().cos(), -deg.to_radians().sin()],
            other => panic!("{other:?}"),
        };
        Ok(match heading {
            Heading::Field { field } => vector(self.case.proposal.get(field)),
            Heading::Last { field } => {
                vector(self.case.last.as_ref().ok_or(Missing)?.proposal.get(field))
            }
            Heading::FromTo { from, to } => {
                let (from, to) = (self.point(from)?, self.point(to)?);
                [to[0] - from[0], to[1] - from[1]]
            }
            Heading::Constant { vector } => *vector,
        })
    }

    fn point(&self, point: &Point) -> Result<[f64; 2], Missing> {
        let pixel = match point {
            Point::Action { field } => self.case.proposal.point(field).unwrap(),
            Point::Keypoint { name } => *self
                .case
                .scene
                .points
                .get(name)
                .and_then(|it| it.first())
                .ok_or(Missing)?,
            Point::Last { end } => {
                let last = self.case.last.as_ref().ok_or(Missing)?;
                match end {
                    End::Pick => last.pick,
                    End::Place => last.place,
                }
            }
            Point::Mirror { of, about } => {
                let (of, about) = (self.point(of)?, self.point(about)?);
                return Ok([about[0] + (about[0] - of[0]), about[1] + (about[1] - of[1])]);
            }
            Point::Carried {
                from,
                direction,
                distance,
                px_per_m,
            } => {
                let from = self.point(from)?;
                let heading = Heading::Field {
                    field: direction.clone(),
                };
                let vector = self.heading(&heading)?;
                let length = px_per_m * self.metres(distance);
                return Ok([0, 1].map(|axis| from[axis] + length * vector[axis]));
            }
        };
        Ok([f64::from(pixel.u), f64::from(pixel.v)])
    }
}
