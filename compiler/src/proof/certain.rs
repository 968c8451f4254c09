//! Finds conditions whose result is certain, whatever the camera shows and the model answers.
//!
//! In: conditions, and the program that declares the spaces of their values. Out: whether they can hold together, and
//! the range that decides it. Every value has a range: a count ends at the extractor's `max`, a distance at the
//! picture's diagonal, a step at the horizon. Comparisons narrow the ranges; a condition is impossible if a range
//! becomes empty. "Possible" is no promise: conditions that depend on each other in other ways are not compared.

use fab_program::exact::written;
use fab_program::{
    Choices, Comparison, Condition, Extractor, Heading, Length, Number, Point, PointMeasure,
    Program,
};
use std::collections::{BTreeMap, BTreeSet};

/// The most comparisons that are looked at together; nobody writes as many, and the work grows with their square.
const MOST_PARTS: usize = 200;

/// What is added at both ends of a range that is computed with rounding, as a fraction and in pixels or metres.
const ROUNDING: f64 = 1e-9;

/// Returns whether no scene and no answer fulfils every condition; each is negated if its flag is false.
pub(crate) fn never(conditions: &[(&Condition, bool)], program: &Program) -> bool {
    let mut parts = 0;
    conditions
        .iter()
        .for_each(|(condition, _)| count(condition, &mut parts));
    parts <= MOST_PARTS && impossible(conditions, Known::default(), program)
}

/// Says which range decides a condition, such as "`count(corners)` is 0 to 27"; `None` if no single one does.
pub(crate) fn reason(condition: &Condition, program: &Program) -> Option<String> {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().find_map(|part| reason(part, program))
        }
        Condition::Not { of } => reason(of, program),
        part if never(&[(part, true)], program) || never(&[(part, false)], program) => {
            compared(part, program).map(|compared| compared.words())
        }
        _ => None,
    }
}

fn count(condition: &Condition, parts: &mut usize) {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().for_each(|part| count(part, parts));
        }
        Condition::Not { of } => count(of, parts),
        _ => *parts += 1,
    }
}

/// Returns whether the conditions contradict each other or what is known.
fn impossible(conditions: &[(&Condition, bool)], mut known: Known, program: &Program) -> bool {
    let mut open = conditions.to_vec();
    let mut choices = Vec::new();
    while let Some((condition, holds)) = open.pop() {
        match (condition, holds) {
            (Condition::Not { of }, _) => open.push((of, !holds)),
            (Condition::All { of }, true) | (Condition::Any { of }, false) => {
                open.extend(of.iter().map(|part| (part, holds)));
            }
            (Condition::All { of }, false) | (Condition::Any { of }, true) => {
                choices.push((of, holds));
            }
            (part, _) => known.add(part, holds, program),
        }
    }
    let fails = |part, holds| impossible(&[(part, holds)], known.clone(), program);
    known.is_contradictory
        || choices
            .iter()
            .any(|(of, holds)| of.iter().all(|part| fails(part, *holds)))
}

/// What some conditions, which hold together, say about the values.
#[derive(Clone, Default)]
struct Known {
    ranges: BTreeMap<String, Range>,
    /// The words that a field may still be.
    words: BTreeMap<String, BTreeSet<String>>,
    /// Whether a condition that compares nothing holds.
    facts: BTreeMap<String, bool>,
    is_contradictory: bool,
}

impl Known {
    fn add(&mut self, part: &Condition, holds: bool, program: &Program) {
        if let Some(compared) = compared(part, program) {
            let key = compared.key.clone();
            let range = self.ranges.entry(key).or_insert(compared.range);
            *range = match holds {
                true => range.narrowed(compared.is, compared.limit),
                false => range.narrowed(negated(compared.is), compared.limit),
            };
            self.is_contradictory |= range.is_empty();
        } else if let Condition::Word { field, is } = part {
            let offered = || match program.field(field).map(|field| &field.choices) {
                Some(Choices::Words { choices }) => choices.iter().cloned().collect(),
                _ => BTreeSet::new(),
            };
            let words = self.words.entry(field.clone()).or_insert_with(offered);
            words.retain(|word| (word == is) == holds);
            self.is_contradictory |= words.is_empty();
        } else {
            let before = *self.facts.entry(format!("{part:?}")).or_insert(holds);
            self.is_contradictory |= before != holds;
        }
    }
}

fn negated(is: Comparison) -> Comparison {
    match is {
        Comparison::Less => Comparison::AtLeast,
        Comparison::AtMost => Comparison::Greater,
        Comparison::Greater => Comparison::AtMost,
        Comparison::AtLeast => Comparison::Less,
    }
}

// ---- comparisons ---------------------------------------------------------------------------------

/// A comparison of a value with a limit.
struct Compared {
    /// Equal for equal values.
    key: String,
    /// The value as messages name it, and its unit.
    name: String,
    unit: &'static str,
    range: Range,
    is: Comparison,
    limit: f64,
}

impl Compared {
    fn words(&self) -> String {
        let [low, high] = [self.range.low, self.range.high];
        let number = |value: f64| format!("{}{}", written(value, 1), self.unit);
        match (low == high, low.is_finite(), high.is_finite()) {
            (true, true, _) => format!("{} is always {}", self.name, number(low)),
            (_, true, true) => format!("{} is {} to {}", self.name, number(low), number(high)),
            (_, true, false) => format!("{} is at least {}", self.name, number(low)),
            _ => format!("{} is at most {}", self.name, number(high)),
        }
    }
}

/// Reads a condition as a comparison of one value with a limit; `None` if it is none.
fn compared(part: &Condition, program: &Program) -> Option<Compared> {
    match part {
        Condition::Number { left, is, limit } => Some(Compared {
            key: left.to_string(),
            name: format!("`{left}`"),
            unit: "",
            range: numbers(left, program),
            is: *is,
            limit: *limit,
        }),
        Condition::Angle {
            a,
            b,
            is,
            limit_deg,
            ..
        } => Some(Compared {
            key: format!("{a:?} {b:?}"),
            name: format!("the angle between `{a}` and `{b}`"),
            unit: "deg",
            range: angles(a, b, program),
            is: *is,
            limit: *limit_deg,
        }),
        Condition::Lengths { left, is, right } => Some(lengths(left, *is, right, program)),
        _ => None,
    }
}

fn lengths(left: &Length, is: Comparison, right: &Length, program: &Program) -> Compared {
    let of = |length: &Length, is, limit| {
        let (name, unit) = match length {
            Length::OfPoints(measure) => (measure.to_string(), "px"),
            Length::Field { field, .. } => (field.clone(), ""),
            Length::Constant { .. } => (String::new(), ""),
        };
        Compared {
            key: format!("{length:?}"),
            name: format!("`{name}`"),
            unit,
            range: length_range(length, program),
            is,
            limit,
        }
    };
    match (left, right) {
        (length, Length::Constant { value }) => of(length, is, *value),
        (Length::Constant { value }, length) => of(length, is.reversed(), *value),
        (left, right) => {
            let range = match left == right {
                true => Range::only(0.0),
                false => length_range(left, program).minus(length_range(right, program)),
            };
            Compared {
                key: format!("{left:?} {right:?}"),
                name: "the difference".to_owned(),
                unit: "",
                range,
                is,
                limit: 0.0,
            }
        }
    }
}

// ---- the declared spaces -------------------------------------------------------------------------

fn numbers(number: &Number, program: &Program) -> Range {
    match number {
        Number::Step => Range::whole(1.0, f64::from(program.horizon)),
        Number::Count { keypoint } => counts(keypoint, program),
        Number::Coverage { flat_px, .. } => {
            let side_px = f64::from(program.camera.image_px);
            Range::of(0.0, side_px * side_px / flat_px)
        }
    }
}

/// Returns how many points a keypoint may have.
fn counts(keypoint: &str, program: &Program) -> Range {
    match program
        .keypoint(keypoint)
        .map(|keypoint| &keypoint.extractor)
    {
        Some(Extractor::Corners { max, .. }) => Range::whole(0.0, f64::from(*max)),
        Some(Extractor::Along { count, .. }) => Range::whole(0.0, f64::from(*count)),
        Some(Extractor::Fixed { points }) => Range::whole(points.len() as f64, points.len() as f64),
        // Only earlier keypoints are used, so this ends.
        Some(Extractor::Toward { points, .. }) => counts(points, program),
        _ => Range::whole(0.0, f64::INFINITY),
    }
}

fn angles(a: &Heading, b: &Heading, program: &Program) -> Range {
    let vectors = |heading: &Heading| match heading {
        Heading::Constant { vector } => Some(vec![*vector]),
        Heading::Field { field } | Heading::Last { field } => {
            match program.field(field).map(|field| &field.choices) {
                Some(Choices::Directions { choices }) => {
                    Some(choices.iter().map(|choice| choice.vector).collect())
                }
                _ => None,
            }
        }
        Heading::FromTo { .. } => None,
    };
    let (Some(from), Some(to)) = (vectors(a), vectors(b)) else {
        return Range::of(0.0, 180.0);
    };
    if a == b {
        return Range::only(0.0);
    }
    let apart = from.iter().flat_map(|a| {
        to.iter().map(|b| {
            let cross = a[0] * b[1] - a[1] * b[0];
            cross.abs().atan2(a[0] * b[0] + a[1] * b[1]).to_degrees()
        })
    });
    let range = Range::around(apart).rounded();
    Range::of(range.low.max(0.0), range.high.min(180.0))
}

fn length_range(length: &Length, program: &Program) -> Range {
    match length {
        Length::Constant { value } => Range::only(*value),
        Length::Field { field, scale } => offered_m(field, program).times(*scale).rounded(),
        Length::OfPoints(measure) => measured(measure, program),
    }
}

/// Returns the range of a length field, metres.
fn offered_m(field: &str, program: &Program) -> Range {
    match program.field(field).map(|field| &field.choices) {
        Some(Choices::Lengths { choices, .. }) => {
            Range::around(choices.iter().map(|choice| choice.m))
        }
        _ => Range::of(0.0, f64::INFINITY),
    }
}

fn measured(measure: &PointMeasure, program: &Program) -> Range {
    let points = measure.points();
    match (measure.name(), points) {
        ("x", [point]) => area(point, program)[0],
        ("y", [point]) => area(point, program)[1],
        ("distance" | "chebyshev", [a, b]) if a == b => Range::only(0.0),
        (
            "distance",
            [
                start,
                Point::Carried {
                    from,
                    distance,
                    px_per_m,
                    ..
                },
            ]
            | [
                Point::Carried {
                    from,
                    distance,
                    px_per_m,
                    ..
                },
                start,
            ],
        ) if **from == *start => offered_m(distance, program).times(*px_per_m).rounded(),
        ("distance", [a, b]) => {
            let [dx, dy] = apart(a, b, program);
            Range::of(dx.low.hypot(dy.low), dx.high.hypot(dy.high)).rounded()
        }
        ("chebyshev", [a, b]) => {
            let [dx, dy] = apart(a, b, program);
            Range::of(dx.low.max(dy.low), dx.high.max(dy.high))
        }
        _ => Range::of(f64::NEG_INFINITY, f64::INFINITY),
    }
}

/// Returns how far apart two points may be along each axis.
fn apart(a: &Point, b: &Point, program: &Program) -> [Range; 2] {
    let (a, b) = (area(a, program), area(b, program));
    [0, 1].map(|axis| a[axis].minus(b[axis]).size())
}

/// Returns the columns and rows in which a point may be.
fn area(point: &Point, program: &Program) -> [Range; 2] {
    match point {
        Point::Action { field } => match program.field(field).map(|field| &field.choices) {
            Some(Choices::Points { keypoints }) => {
                let areas = keypoints.iter().map(|name| keypoint_area(name, program));
                areas
                    .reduce(around_both)
                    .unwrap_or_else(|| picture(program))
            }
            _ => picture(program),
        },
        Point::Keypoint { name } => keypoint_area(name, program),
        // An action may end outside of the picture.
        Point::Last { .. } => [Range::of(f64::NEG_INFINITY, f64::INFINITY); 2],
        Point::Mirror { of, about } => {
            let (of, about) = (area(of, program), area(about, program));
            [0, 1].map(|axis| about[axis].times(2.0).minus(of[axis]))
        }
        Point::Carried {
            from,
            direction,
            distance,
            px_per_m,
        } => {
            let from = area(from, program);
            let far_px = offered_m(distance, program).high * px_per_m;
            let vectors = match program.field(direction).map(|field| &field.choices) {
                Some(Choices::Directions { choices }) => {
                    choices.iter().map(|choice| choice.vector).collect()
                }
                _ => vec![[1.0, 1.0], [-1.0, -1.0]],
            };
            [0, 1].map(|axis| {
                let shifts = vectors.iter().map(|vector| vector[axis] * far_px);
                // The shortest distance is at least 0.
                let shift = Range::around(shifts.chain([0.0])).rounded();
                Range::of(from[axis].low + shift.low, from[axis].high + shift.high)
            })
        }
    }
}

fn keypoint_area(name: &str, program: &Program) -> [Range; 2] {
    match program.keypoint(name).map(|keypoint| &keypoint.extractor) {
        Some(Extractor::Fixed { points }) => [
            Range::around(points.iter().map(|point| f64::from(point.u))),
            Range::around(points.iter().map(|point| f64::from(point.v))),
        ],
        Some(Extractor::Outermost { points, .. }) => keypoint_area(points, program),
        Some(Extractor::Toward { points, to, .. }) => {
            around_both(keypoint_area(points, program), keypoint_area(to, program))
        }
        _ => picture(program),
    }
}

fn picture(program: &Program) -> [Range; 2] {
    [Range::of(0.0, f64::from(program.camera.image_px) - 1.0); 2]
}

fn around_both(a: [Range; 2], b: [Range; 2]) -> [Range; 2] {
    [0, 1].map(|axis| Range::of(a[axis].low.min(b[axis].low), a[axis].high.max(b[axis].high)))
}

// ---- ranges --------------------------------------------------------------------------------------

/// The numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    low: f64,
    high: f64,
    is_low_excluded: bool,
    is_high_excluded: bool,
    /// Whether only whole numbers are meant.
    is_whole: bool,
}

impl Range {
    fn of(low: f64, high: f64) -> Range {
        Range {
            low,
            high,
            is_low_excluded: false,
            is_high_excluded: false,
            is_whole: false,
        }
    }

    fn whole(low: f64, high: f64) -> Range {
        Range {
            is_whole: true,
            ..Range::of(low, high)
        }
    }

    fn only(value: f64) -> Range {
        Range::of(value, value)
    }

    /// Returns the smallest range with all of these values; every number if there are none.
    fn around(values: impl Iterator<Item = f64>) -> Range {
        let one = values.map(Range::only);
        one.reduce(|a, b| Range::of(a.low.min(b.low), a.high.max(b.high)))
            .unwrap_or(Range::of(f64::NEG_INFINITY, f64::INFINITY))
    }

    fn times(self, factor: f64) -> Range {
        Range::of(self.low * factor, self.high * factor)
    }

    fn minus(self, other: Range) -> Range {
        Range::of(self.low - other.high, self.high - other.low)
    }

    /// Returns the range of the values without their signs.
    fn size(self) -> Range {
        let (low, high) = (self.low.abs(), self.high.abs());
        let least = match self.low <= 0.0 && self.high >= 0.0 {
            true => 0.0,
            false => low.min(high),
        };
        Range::of(least, low.max(high))
    }

    /// Returns the range with room for rounding.
    fn rounded(self) -> Range {
        let room = |value: f64| ROUNDING * (1.0 + value.abs());
        let low = self.low - room(self.low);
        // What is never negative stays so.
        let low = if self.low >= 0.0 { low.max(0.0) } else { low };
        match self.low == self.high && self.low == 0.0 {
            true => self,
            false => Range::of(low, self.high + room(self.high)),
        }
    }

    /// Returns the part that compares like this with a limit.
    fn narrowed(mut self, is: Comparison, limit: f64) -> Range {
        match is {
            Comparison::Less | Comparison::AtMost => {
                let excludes = is == Comparison::Less;
                if limit < self.high || limit == self.high && excludes {
                    (self.high, self.is_high_excluded) = (limit, excludes);
                }
            }
            Comparison::Greater | Comparison::AtLeast => {
                let excludes = is == Comparison::Greater;
                if limit > self.low || limit == self.low && excludes {
                    (self.low, self.is_low_excluded) = (limit, excludes);
                }
            }
        }
        self
    }

    fn is_empty(self) -> bool {
        if self.is_whole {
            let low = match self.is_low_excluded {
                true => self.low.floor() + 1.0,
                false => self.low.ceil(),
            };
            let high = match self.is_high_excluded {
                true => self.high.ceil() - 1.0,
                false => self.high.floor(),
            };
            return low > high;
        }
        self.low > self.high
            || self.low == self.high && (self.is_low_excluded || self.is_high_excluded)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explain::HALF;
    use crate::{LoadError, Loader};
    use fab_program::Check;

    /// What a condition is, and the reason that is given for it.
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Is {
        Never(&'static str),
        Always(&'static str),
        Open,
    }
    use Is::{Always, Never, Open};

    /// Conditions of a fold that picks corners, and places on corners, on the centre or on fixed points.
    const FOLDS: &[(&str, Is)] = &[
        (
            "distance(pick, pick) > 20px",
            Never("`distance(pick, pick)` is always 0px"),
        ),
        (
            "distance(pick, pick) < 20px",
            Always("`distance(pick, pick)` is always 0px"),
        ),
        ("distance(pick, place) > 20px", Open),
        (
            "distance(pick, place) > 400px",
            Never("`distance(pick, place)` is 0px to 315.4px"),
        ),
        (
            "400px < distance(pick, place)",
            Never("`distance(pick, place)` is 0px to 315.4px"),
        ),
        (
            "distance(pick, place) < 316px",
            Always("`distance(pick, place)` is 0px to 315.4px"),
        ),
        (
            "distance(pick, place) >= 0px",
            Always("`distance(pick, place)` is 0px to 315.4px"),
        ),
        ("distance(pick, place) > 0px", Open),
        (
            "distance(pick, place) > distance(pick, place)",
            Never("the difference is always 0"),
        ),
        ("distance(pick, place) >= distance(place, pick)", Open),
        (
            "chebyshev(pick, center) <= 223px",
            Always("`chebyshev(pick, center)` is 0px to 223px"),
        ),
        ("chebyshev(pick, center) <= 222px", Open),
        ("x(pick) >= 0px", Always("`x(pick)` is 0px to 223px")),
        ("x(pick) > 223px", Never("`x(pick)` is 0px to 223px")),
        ("x(mirror(pick, center)) > 400px", Open),
        (
            "x(mirror(pick, center)) > 446px",
            Never("`x(mirror(pick, center))` is -223px to 446px"),
        ),
        ("distance(pick, marks_end) < 10px", Open),
        (
            "x(marks_end) < 10px",
            Never("`x(marks_end)` is 100px to 140px"),
        ),
        (
            "distance(marks_end, other_end) < 40px",
            Never("`distance(marks_end, other_end)` is 60px to 100.5px"),
        ),
        ("distance(pick, last.place) > 9999px", Open),
        ("count(corners) > 90", Never("`count(corners)` is 0 to 27")),
        ("count(corners) > 27", Never("`count(corners)` is 0 to 27")),
        ("count(corners) >= 27", Open),
        ("count(corners) == 90", Never("`count(corners)` is 0 to 27")),
        (
            "count(corners) != 90",
            Always("`count(corners)` is 0 to 27"),
        ),
        ("count(corners) > 4 and count(corners) < 5", Never("")),
        ("count(corners) > 4 and count(corners) < 6", Open),
        ("count(corners) <= 4 or count(corners) > 3", Always("")),
        ("count(marks) == 2", Always("`count(marks)` is always 2")),
        ("count(marks) > 2", Never("`count(marks)` is always 2")),
        ("step == 0", Never("`step` is 1 to 2")),
        ("step >= 1", Always("`step` is 1 to 2")),
        ("step == 2", Open),
        ("step > 1 and step < 2", Never("")),
        ("not step == 3", Always("`step` is 1 to 2")),
        (
            "coverage(cloth) < 0",
            Never("`coverage(cloth)` is 0 to 3.2"),
        ),
        ("coverage(cloth) > 0.5", Open),
        (
            "angle_between(from center to pick, 90deg) <= 180deg",
            Always("the angle between `(center -> pick)` and `90 deg` is 0deg to 180deg"),
        ),
        ("angle_between(from center to pick, 90deg) < 45deg", Open),
        ("pick within 8px of cloth", Open),
        (
            "pick within 8px of cloth and not pick within 8px of cloth",
            Never(""),
        ),
        (
            "pick within 8px of cloth or not pick within 8px of cloth",
            Always(""),
        ),
        ("pick within 8px of cloth or step == 0", Open),
        (
            "pick within 8px of cloth and step == 0",
            Never("`step` is 1 to 2"),
        ),
        ("grip == \"soft\" and grip == \"firm\"", Never("")),
        ("grip == \"soft\" or grip == \"firm\"", Always("")),
        ("grip == \"soft\"", Open),
        ("last and step == 1", Open),
    ];

    /// Conditions of a pull in a direction, where the place follows from the other fields.
    const PULLS: &[(&str, Is)] = &[
        (
            "distance(pick, place) > 10px",
            Always("`distance(pick, place)` is 14px to 28.1px"),
        ),
        ("distance(pick, place) > 20px", Open),
        (
            "distance(pick, place) > 30px",
            Never("`distance(pick, place)` is 14px to 28.1px"),
        ),
        ("distance >= 33mm", Always("`distance` is 0 to 0.1")),
        ("distance > 60mm", Open),
        ("x(place) < 252px", Always("`x(place)` is 0px to 251.1px")),
        ("y(place) < 223px", Open),
        (
            "angle_between(direction, 0deg) <= 91deg",
            Always("the angle between `direction` and `0 deg` is 0deg to 90deg"),
        ),
        ("angle_between(direction, 180deg) < 90deg", Open),
        (
            "angle_between(direction, 180deg) < 80deg",
            Never("the angle between `direction` and `180 deg` is 90deg to 180deg"),
        ),
    ];

    struct Files(String);

    impl Loader for Files {
        fn load(&self, name: &str) -> Result<String, LoadError> {
            Ok(match name {
                "half.fab" => HALF.to_owned(),
                _ => self.0.clone(),
            })
        }
    }

    /// Returns a program with one check, which has this condition.
    fn program(actions: &str, condition: &str) -> Program {
        let text = format!(
            "use \"half.fab\"\ntask tried extends half {{
                keypoints {{
                    marks = points((100px, 50px), (140px, 60px))
                    marks_end = leftmost(marks)
                    others = points((40px, 50px), (40px, 60px))
                    other_end = leftmost(others)
                }}
                actions {{ {actions} }}
                verify {{ check tried when last {{ {condition} }} else \"No.\" }}
            }}"
        );
        let compiled = crate::compile("tried.fab", &Files(text)).expect("a text");
        let shown = crate::diag::to_text(
            &compiled.diagnostics,
            &compiled.sources,
            crate::diag::Color::Plain,
        );
        let mut programs = compiled.programs;
        programs.pop().unwrap_or_else(|| panic!("{shown}"))
    }

    fn is(program: &Program) -> (&'static str, String) {
        let Check { holds, .. } = &program.verify.checks[0];
        let why = reason(holds, program).unwrap_or_default();
        match [true, false].map(|holds_| never(&[(holds, holds_)], program)) {
            [true, false] => ("never", why),
            [false, true] => ("always", why),
            [false, false] => ("open", String::new()),
            [true, true] => ("both", why),
        }
    }

    fn check(actions: &str, table: &[(&str, Is)]) {
        let mut wrong = Vec::new();
        for (condition, expected) in table {
            let found = is(&program(actions, condition));
            let expected = match *expected {
                Never(why) => ("never", why.to_owned()),
                Always(why) => ("always", why.to_owned()),
                Open => ("open", String::new()),
            };
            if found != expected {
                wrong.push(format!("{condition}: {found:?}, not {expected:?}"));
            }
        }
        assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    }

    #[test]
    fn conditions_on_points_counts_and_words_are_certain_where_the_table_says_so() {
        check(
            "pick: one of corners place: one of corners, center grip: one of \"soft\", \"firm\"",
            FOLDS,
        );
    }

    #[test]
    fn conditions_on_directions_and_lengths_are_certain_where_the_table_says_so() {
        check(
            "pick: one of corners direction: one of 0deg, 45deg, 90deg distance: one of 33.6mm, 67.6mm",
            PULLS,
        );
    }

    #[test]
    fn a_condition_of_many_parts_is_left_alone() {
        let many = vec!["step == 0"; MOST_PARTS].join(" or ");
        let actions = "pick: one of corners place: one of corners";
        assert_eq!(is(&program(actions, &many)).0, "open");
        assert_eq!(is(&program(actions, "step == 0 or step == 0")).0, "never");
    }
}
