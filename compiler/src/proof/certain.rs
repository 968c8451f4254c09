//! Finds conditions whose result is certain, whatever the camera shows and the model answers.
//!
//! In: conditions, and the program that declares the spaces of their values. Out: whether they can hold together, and
//! the range that decides it. Every value has a range: a count ends at the extractor's `max`, a distance at the
//! picture's diagonal, a step at the horizon. Comparisons narrow the ranges; a condition is impossible if a range
//! becomes empty. Offered directions, lengths and single points are few, so each combination is tried by itself, and
//! compared as verdicts compare it. "Possible" is no promise: conditions that depend on each other in other ways are not
//! compared.

use fab_program::exact::written;
use fab_program::{
    Choices, Comparison, Condition, Extractor, Heading, Keypoint, KeypointShape, Length, Number,
    Point, PointMeasure, Program, measures,
};
use std::collections::{BTreeMap, BTreeSet};

/// The most comparisons that are looked at together; nobody writes as many, and the work grows with their square.
const MOST_PARTS: usize = 200;

/// The most work on combinations of offered values: their number times the square of the comparisons.
const MOST_WORK: usize = 100_000;

/// What is added at both ends of a range that is computed with rounding, as a fraction and in pixels or metres.
const ROUNDING: f64 = 1e-9;

/// Returns whether no scene and no answer fulfils every condition; each is negated if its flag is false.
pub(crate) fn never(conditions: &[(&Condition, bool)], program: &Program) -> bool {
    let mut parts = 0;
    conditions
        .iter()
        .for_each(|(condition, _)| count(condition, &mut parts));
    if parts > MOST_PARTS {
        return false;
    }
    let all = conditions.iter().map(|(condition, _)| *condition);
    let combinations = Combinations::of(all, MOST_WORK / (parts * parts).max(1), program);
    combinations.all(|answer| {
        let here: Vec<(Condition, bool)> = conditions
            .iter()
            .map(|(condition, holds)| (answer.put_into(condition), *holds))
            .collect();
        let here: Vec<(&Condition, bool)> = here.iter().map(|(it, holds)| (it, *holds)).collect();
        impossible(&here, Known::default(), program)
    })
}

/// Says which range keeps a condition from holding, or from failing if the flag is false, such as "`count(corners)` is
/// 0 to 27"; `None` if no single one does.
pub(crate) fn reason((condition, holds): (&Condition, bool), program: &Program) -> Option<String> {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().find_map(|part| reason((part, holds), program))
        }
        Condition::Not { of } => reason((of, !holds), program),
        part if never(&[(part, holds)], program) => {
            let mut whole = compared(part, program)?;
            let mut ranges: Vec<Range> = Vec::new();
            Combinations::of([part], MOST_WORK, program).all(|answer| {
                let here = compared(&answer.put_into(part), program);
                ranges.extend(here.map(|here| here.range));
                true
            });
            if let Some(range) = ranges.into_iter().reduce(Range::with) {
                whole.range = range;
            }
            Some(whole.words())
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
            if *part == Condition::Last && holds {
                // The first step has no action before it.
                let second = Condition::Number {
                    left: Number::Step,
                    is: Comparison::AtLeast,
                    limit: 2.0,
                };
                self.add(&second, true, program);
            }
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

// ---- offered values ------------------------------------------------------------------------------

/// The combinations of offered values that are tried one by one.
struct Combinations<'a> {
    /// The fields with few values, of this action or the last.
    fields: Vec<(Whose<'a>, Vec<Offered<'a>>)>,
}

/// A field of an action.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Whose<'a> {
    Proposed(&'a str),
    Last(&'a str),
}

/// An offered value that a condition can name.
#[derive(Clone, Copy)]
enum Offered<'a> {
    Direction([f64; 2]),
    LengthM(f64),
    /// The name of a keypoint that is one point.
    Point(&'a str),
}

impl<'a> Combinations<'a> {
    /// Returns the combinations of the fields that occur, at most `most`. Fields with the fewest values come first.
    fn of(
        conditions: impl IntoIterator<Item = &'a Condition>,
        most: usize,
        program: &'a Program,
    ) -> Combinations<'a> {
        let mut used = BTreeSet::new();
        for condition in conditions {
            add_used(condition, &mut used);
        }
        let mut fields: Vec<_> = used
            .into_iter()
            .filter_map(|whose| Some((whose, offered(whose, program)?)))
            .collect();
        fields.sort_by_key(|(_, values)| values.len());
        let mut product = 1_usize;
        let few = fields.iter().take_while(|(_, values)| {
            product = product.saturating_mul(values.len());
            product <= most
        });
        let n_few = few.count();
        fields.truncate(n_few);
        Combinations { fields }
    }

    /// Returns whether something holds for each combination.
    fn all(&self, mut holds: impl FnMut(&Answer<'_>) -> bool) -> bool {
        let mut indices = vec![0; self.fields.len()];
        loop {
            let fields = self.fields.iter().zip(&indices);
            let answer = Answer(
                fields
                    .map(|((whose, values), at)| (*whose, values[*at]))
                    .collect(),
            );
            if !holds(&answer) {
                return false;
            }
            // Counts on: the first index that can grow grows, and those before it begin again.
            let mut fields = self.fields.iter().zip(&mut indices);
            let grown = fields.any(|((_, values), at)| {
                *at = (*at + 1) % values.len();
                *at > 0
            });
            if !grown {
                return true;
            }
        }
    }
}

/// Returns the values of a field; `None` if it has none, or if some cannot be named.
fn offered<'a>(whose: Whose<'a>, program: &'a Program) -> Option<Vec<Offered<'a>>> {
    let (Whose::Proposed(field) | Whose::Last(field)) = whose;
    let values: Vec<Offered<'a>> = match &program.field(field)?.choices {
        Choices::Directions { choices } => {
            let vectors = choices.iter().map(|choice| choice.vector);
            vectors.map(Offered::Direction).collect()
        }
        Choices::Lengths { choices, .. } => {
            let lengths = choices.iter().map(|choice| choice.m);
            lengths.map(Offered::LengthM).collect()
        }
        Choices::Points { keypoints } => {
            let point = |name: &'a String| {
                let shape = program.keypoint(name)?.extractor.shape();
                (shape == KeypointShape::Point).then_some(Offered::Point(name))
            };
            keypoints.iter().map(point).collect::<Option<_>>()?
        }
        _ => return None,
    };
    (!values.is_empty()).then_some(values)
}

fn add_used<'a>(condition: &'a Condition, used: &mut BTreeSet<Whose<'a>>) {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().for_each(|part| add_used(part, used));
        }
        Condition::Not { of } => add_used(of, used),
        Condition::Lengths { left, right, .. } => {
            for length in [left, right] {
                match length {
                    Length::Field { field, .. } => drop(used.insert(Whose::Proposed(field))),
                    Length::OfPoints(measure) => {
                        measure.points().iter().for_each(|it| add_point(it, used));
                    }
                    Length::Constant { .. } => {}
                }
            }
        }
        Condition::Angle { a, b, .. } => {
            for heading in [a, b] {
                match heading {
                    Heading::Field { field } => drop(used.insert(Whose::Proposed(field))),
                    Heading::Last { field } => drop(used.insert(Whose::Last(field))),
                    Heading::FromTo { .. } | Heading::Constant { .. } => {}
                }
            }
        }
        Condition::Number { .. }
        | Condition::Word { .. }
        | Condition::Within { .. }
        | Condition::Last
        | Condition::Unreachable => {}
    }
}

fn add_point<'a>(point: &'a Point, used: &mut BTreeSet<Whose<'a>>) {
    match point {
        Point::Action { field } => drop(used.insert(Whose::Proposed(field))),
        Point::Mirror { of, about } => {
            add_point(of, used);
            add_point(about, used);
        }
        Point::Carried { from, .. } => add_point(from, used),
        Point::Keypoint { .. } | Point::Last { .. } => {}
    }
}

/// One combination.
struct Answer<'a>(Vec<(Whose<'a>, Offered<'a>)>);

impl Answer<'_> {
    fn get(&self, whose: Whose<'_>) -> Option<Offered<'_>> {
        let found = self.0.iter().find(|(it, _)| *it == whose);
        found.map(|(_, value)| *value)
    }

    /// Returns a condition with the values in place of the fields.
    fn put_into(&self, condition: &Condition) -> Condition {
        let all = |of: &[Condition]| of.iter().map(|part| self.put_into(part)).collect();
        match condition {
            Condition::All { of } => Condition::All { of: all(of) },
            Condition::Any { of } => Condition::Any { of: all(of) },
            Condition::Not { of } => Condition::Not {
                of: Box::new(self.put_into(of)),
            },
            Condition::Lengths { left, is, right } => Condition::Lengths {
                left: self.length(left),
                is: *is,
                right: self.length(right),
            },
            Condition::Angle {
                a,
                b,
                is,
                limit_deg,
                limit_cos,
            } => Condition::Angle {
                a: self.heading(a),
                b: self.heading(b),
                is: *is,
                limit_deg: *limit_deg,
                limit_cos: *limit_cos,
            },
            other => other.clone(),
        }
    }

    fn length(&self, length: &Length) -> Length {
        match length {
            Length::Field { field, scale } => match self.get(Whose::Proposed(field)) {
                Some(Offered::LengthM(m)) => Length::Constant { value: m * scale },
                _ => length.clone(),
            },
            Length::OfPoints(measure) => {
                let points = measure.points().iter().map(|point| self.point(point));
                PointMeasure::new(measure.name(), points.collect())
                    .map_or_else(|| length.clone(), Length::OfPoints)
            }
            Length::Constant { .. } => length.clone(),
        }
    }

    fn heading(&self, heading: &Heading) -> Heading {
        let value = match heading {
            Heading::Field { field } => self.get(Whose::Proposed(field)),
            Heading::Last { field } => self.get(Whose::Last(field)),
            Heading::FromTo { .. } | Heading::Constant { .. } => None,
        };
        match value {
            Some(Offered::Direction(vector)) => Heading::Constant { vector },
            _ => heading.clone(),
        }
    }

    fn point(&self, point: &Point) -> Point {
        match point {
            Point::Action { field } => match self.get(Whose::Proposed(field)) {
                Some(Offered::Point(name)) => Point::Keypoint {
                    name: name.to_owned(),
                },
                _ => point.clone(),
            },
            Point::Mirror { of, about } => Point::Mirror {
                of: Box::new(self.point(of)),
                about: Box::new(self.point(about)),
            },
            Point::Carried {
                from,
                direction,
                distance,
                px_per_m,
            } => Point::Carried {
                from: Box::new(self.point(from)),
                direction: direction.clone(),
                distance: distance.clone(),
                px_per_m: *px_per_m,
            },
            Point::Keypoint { .. } | Point::Last { .. } => point.clone(),
        }
    }
}

// ---- comparisons ---------------------------------------------------------------------------------

/// A comparison of a value with a limit.
struct Compared {
    /// Equal for equal values.
    key: String,
    /// The value as messages name it, and how they write it.
    name: String,
    written: Written,
    range: Range,
    is: Comparison,
    limit: f64,
}

/// How messages write a value.
#[derive(Clone, Copy)]
enum Written {
    /// As it is, with this unit.
    Plain(&'static str),
    /// It is the square of a length, negative if the length is; the length times this has the unit.
    Square(f64, &'static str),
}

impl Compared {
    fn words(&self) -> String {
        let [low, high] = [self.range.low, self.range.high];
        let number = |value: f64| match self.written {
            Written::Plain(unit) => format!("{}{unit}", written(value, 1)),
            Written::Square(factor, unit) => {
                let length = value.abs().sqrt().copysign(value) * factor;
                format!("{}{unit}", written(length, 1))
            }
        };
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
            written: Written::Plain(""),
            range: numbers(left, program),
            is: *is,
            limit: *limit,
        }),
        Condition::Angle {
            a,
            b,
            is,
            limit_deg,
            limit_cos,
        } => Some(Compared {
            // Two directions are compared with each limit by itself: a range of the angle would be rounded.
            key: format!("{a:?} {b:?} {limit_deg}"),
            name: format!("the angle between `{a}` and `{b}`"),
            written: Written::Plain("deg"),
            range: angles(a, b, [*limit_deg, *limit_cos]),
            is: *is,
            limit: *limit_deg,
        }),
        Condition::Lengths { left, is, right } => Some(lengths(left, *is, right, program)),
        _ => None,
    }
}

/// Reads a comparison of lengths as one of their squares, as verdicts do.
fn lengths(left: &Length, is: Comparison, right: &Length, program: &Program) -> Compared {
    let of = |length: &Length, is, limit: f64| {
        let (name, written) = match length {
            Length::OfPoints(measure) => (measure.to_string(), Written::Square(1.0, "px")),
            Length::Field { field, scale } => (field.clone(), Written::Square(1e3 / scale, "mm")),
            Length::Constant { .. } => (String::new(), Written::Square(1.0, "")),
        };
        Compared {
            key: format!("{length:?}"),
            name: format!("`{name}`"),
            written,
            range: square_range(length, program),
            is,
            limit: limit * limit,
        }
    };
    match (left, right) {
        (length, Length::Constant { value }) => of(length, is, *value),
        (Length::Constant { value }, length) => of(length, is.reversed(), *value),
        (left, right) => {
            let range = match left == right {
                true => Range::only(0.0),
                false => {
                    let [left, right] = [left, right].map(|it| square_range(it, program).root());
                    left.minus(right).rounded()
                }
            };
            Compared {
                key: format!("{left:?} {right:?}"),
                name: "the difference".to_owned(),
                written: Written::Plain(""),
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
    // None may be seen, and those out of the arm's reach are left out.
    Range::whole(0.0, most_points(keypoint, &program.keypoints))
}

/// Returns how many points a keypoint has at most; infinite if there is no limit.
pub(crate) fn most_points(name: &str, keypoints: &[Keypoint]) -> f64 {
    let found = keypoints.iter().find(|keypoint| keypoint.name == name);
    match found.map(|keypoint| &keypoint.extractor) {
        Some(Extractor::Corners { max, .. }) => f64::from(*max),
        Some(Extractor::Along { count, .. }) => f64::from(*count),
        Some(Extractor::Fixed { points }) => points.len() as f64,
        // Only earlier keypoints are used, so this ends.
        Some(Extractor::Toward { points, .. }) => most_points(points, keypoints),
        _ => f64::INFINITY,
    }
}

/// - `limit`: what the angle is compared with, degrees, and its cosine.
fn angles(a: &Heading, b: &Heading, limit: [f64; 2]) -> Range {
    match (a, b) {
        (Heading::Constant { vector: a }, Heading::Constant { vector: b }) => {
            let [limit_deg, limit_cos] = limit;
            // An angle that verdicts take for the limit is the limit.
            match measures::angle_sides(*a, *b, limit_cos) {
                [along, limit] if along == limit => Range::only(limit_deg),
                _ => Range::only(measures::angle_deg(*a, *b)),
            }
        }
        (a, b) if a == b => Range::only(0.0),
        _ => Range::of(0.0, 180.0),
    }
}

/// Returns the range of a length's square; negative if the length is.
fn square_range(length: &Length, program: &Program) -> Range {
    match length {
        Length::Constant { value } => Range::only(value * value),
        Length::Field { field, scale } => {
            offered_m(field, program).times(*scale).squared().rounded()
        }
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

/// Returns the range of a measure's square; negative if the measure is.
fn measured(measure: &PointMeasure, program: &Program) -> Range {
    let points = measure.points();
    match (measure.name(), points) {
        ("x", [point]) => area(point, program)[0].squared(),
        ("y", [point]) => area(point, program)[1].squared(),
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
        ) if **from == *start => {
            let carried_px = offered_m(distance, program).times(*px_per_m);
            // The end of an offered direction is off the unit circle by rounding, and so is its distance.
            carried_px.squared().rounded()
        }
        ("distance", [a, b]) => {
            let [dx, dy] = apart(a, b, program).map(Range::squared);
            Range::of(dx.low + dy.low, dx.high + dy.high)
        }
        ("chebyshev", [a, b]) => {
            let [dx, dy] = apart(a, b, program).map(Range::squared);
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
        one.reduce(Range::with)
            .unwrap_or(Range::of(f64::NEG_INFINITY, f64::INFINITY))
    }

    /// Returns the smallest range with both.
    fn with(self, other: Range) -> Range {
        Range {
            is_whole: self.is_whole && other.is_whole,
            ..Range::of(self.low.min(other.low), self.high.max(other.high))
        }
    }

    /// Returns the range of the values' squares, with their signs.
    fn squared(self) -> Range {
        Range::of(self.low * self.low.abs(), self.high * self.high.abs())
    }

    /// Returns the range of the values' roots, with their signs.
    fn root(self) -> Range {
        let root = |value: f64| value.abs().sqrt().copysign(value);
        Range::of(root(self.low), root(self.high))
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
#[path = "../../tests/suite/common/chance.rs"]
mod chance;

#[cfg(test)]
mod tests {
    use super::chance::Chance;
    use super::*;
    use crate::explain::HALF;
    use crate::{LoadError, Loader};
    use fab_program::eval::Eval;
    use fab_program::facts::{ExecutedAction, Facts};
    use fab_program::pointing::Pointing;
    use fab_program::scene::SceneView;
    use fab_program::{Check, PixelPoint, Proposal, space};

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
        ("count(marks) == 2", Open),
        ("count(marks) < 2", Open),
        ("count(marks) > 2", Never("`count(marks)` is 0 to 2")),
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
            Always("the angle between `from center to pick` and `90 deg` is 0deg to 180deg"),
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
        ("last and step == 1", Never("")),
        ("last and step == 2", Open),
        ("not last or step > 1", Always("")),
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
        (
            "distance >= 33.6mm",
            Always("`distance` is 33.6mm to 67.6mm"),
        ),
        ("distance > 67.6mm", Never("`distance` is 33.6mm to 67.6mm")),
        ("distance >= 67.6mm", Open),
        ("distance > 50mm and distance < 60mm", Never("")),
        ("distance > 50mm and distance < 68mm", Open),
        ("distance > 60mm", Open),
        ("x(place) < 252px", Always("`x(place)` is 0px to 251.1px")),
        ("y(place) < 223px", Open),
        (
            "angle_between(direction, 0deg) <= 91deg",
            Always("the angle between `direction` and `0 deg` is 0deg to 90deg"),
        ),
        ("angle_between(direction, 180deg) <= 90deg", Open),
        ("angle_between(direction, 90deg) < 45deg", Open),
        (
            "angle_between(direction, 45deg) <= 45deg",
            Always("the angle between `direction` and `45 deg` is 0deg to 45deg"),
        ),
        (
            "angle_between(direction, last.direction) <= 90deg",
            Always("the angle between `direction` and `last.direction` is 0deg to 90deg"),
        ),
        ("angle_between(direction, last.direction) < 90deg", Open),
        (
            "angle_between(direction, 0deg) < 45deg and angle_between(direction, 90deg) < 45deg",
            Never(""),
        ),
        (
            "angle_between(direction, 180deg) < 90deg",
            Never("the angle between `direction` and `180 deg` is 90deg to 180deg"),
        ),
    ];

    /// Conditions of a fold that places on single points.
    const CENTRES: &[(&str, Is)] = &[
        (
            "distance(place, center) > 5px or distance(place, marks_end) > 5px",
            Open,
        ),
        (
            "distance(place, center) > 5px and distance(place, marks_end) > 5px",
            Never(""),
        ),
        ("distance(place, pick) < 5px", Open),
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
        let check = format!("check tried when last {{ {condition} }} else \"No.\"");
        program_of(actions, &check)
    }

    fn program_of(actions: &str, checks: &str) -> Program {
        let text = format!(
            "use \"half.fab\"\ntask tried extends half {{
                keypoints {{
                    marks = points((100px, 50px), (140px, 60px))
                    marks_end = leftmost(marks)
                    others = points((40px, 50px), (40px, 60px))
                    other_end = leftmost(others)
                }}
                actions {{ {actions} }}
                verify {{ {checks} }}
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
        let why = |passes| reason((holds, passes), program).unwrap_or_default();
        match [true, false].map(|holds_| never(&[(holds, holds_)], program)) {
            [true, false] => ("never", why(true)),
            [false, true] => ("always", why(false)),
            [false, false] => ("open", String::new()),
            [true, true] => ("both", why(true)),
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
    fn conditions_on_single_points_are_certain_where_the_table_says_so() {
        check(
            "pick: one of corners place: one of center, marks_end",
            CENTRES,
        );
        check(
            "pick: one of corners place: one of center",
            &[(
                "distance(place, center) > 5px",
                Never("`distance(place, center)` is always 0px"),
            )],
        );
    }

    #[test]
    fn a_condition_of_many_parts_is_left_alone() {
        let many = vec!["step == 0"; MOST_PARTS].join(" or ");
        let actions = "pick: one of corners place: one of corners";
        assert_eq!(is(&program(actions, &many)).0, "open");
        assert_eq!(is(&program(actions, "step == 0 or step == 0")).0, "never");
    }

    // ---- sampled scenes --------------------------------------------------------------------------

    /// Two action spaces, and comparisons that are possible in each. Limits are often offered values.
    const SPACES: &[(&str, &[&str])] = &[
        (
            "pick: one of corners direction: one of 0deg, 45deg, 90deg, 225deg
             distance: one of 0.1edge, 0.3edge, 0.5edge",
            &[
                "angle_between(direction, 180deg) @ 90deg",
                "angle_between(direction, 45deg) @ 45deg",
                "angle_between(direction, last.direction) @ 135deg",
                "angle_between(from center to pick, direction) @ 90deg",
                "distance @ 0.1edge",
                "distance @ 0.3edge",
                "distance @ 0.5edge",
                "distance(pick, place) @ 14px",
                "distance(pick, place) @ 100px",
                "x(place) @ 224px",
                "y(mirror(pick, center)) @ 400px",
            ],
        ),
        (
            "pick: one of corners place: one of center, marks_end grip: one of \"soft\", \"firm\"",
            &[
                "distance(place, center) @ 5px",
                "distance(place, marks_end) @ 0px",
                "distance(pick, place) @ 300px",
                "chebyshev(pick, place) @ 223px",
                "distance(pick, place) @ distance(pick, center)",
                "x(place) @ 100px",
                "y(mirror(marks_end, other_end)) @ 50px",
                "distance(marks_end, other_end) @ 60px",
                "distance(place, last.place) @ 400px",
                "grip == \"soft\"",
            ],
        ),
    ];

    /// Comparisons that are possible in every space.
    const ANYWHERE: &[&str] = &[
        "step @ 1",
        "step @ 2",
        "count(corners) @ 27",
        "count(corners) @ 0",
        "count(marks) @ 2",
        "coverage(cloth) @ 0.5",
        "pick within 8px of cloth",
        "last",
    ];

    /// Returns a condition with up to four comparisons.
    fn condition(atoms: &[&str], chance: &mut Chance) -> String {
        let one = |chance: &mut Chance| {
            let all = atoms.len() + ANYWHERE.len();
            let at = chance.below(all);
            let atom = atoms.get(at).unwrap_or_else(|| &ANYWHERE[at - atoms.len()]);
            let sign = ["<", "<=", ">", ">="][chance.below(4)];
            let not = ["", "", "not "][chance.below(3)];
            format!("{not}({})", atom.replace('@', sign))
        };
        let mut text = one(chance);
        for _ in 0..chance.below(4) {
            let word = ["and", "or"][chance.below(2)];
            text = format!("({text}) {word} {}", one(chance));
        }
        text
    }

    impl Chance {
        /// Returns a point of the picture, often at its edge.
        fn point(&mut self) -> PixelPoint {
            let mut side = || [0, 223, self.below(224) as i32][self.below(3)];
            PixelPoint::new(side(), side())
        }
    }

    /// What a camera may show.
    struct Shown {
        corners: Vec<PixelPoint>,
        center: PixelPoint,
        distance_px: f64,
        area_px: f64,
    }

    impl SceneView for Shown {
        fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
            let of = |points: &[[i32; 2]]| points.iter().copied().map(PixelPoint::from).collect();
            Some(match keypoint {
                "corners" => self.corners.clone(),
                "center" => vec![self.center],
                "marks" => of(&[[100, 50], [140, 60]]),
                "marks_end" => of(&[[100, 50]]),
                "others" => of(&[[40, 50], [40, 60]]),
                "other_end" => of(&[[40, 50]]),
                _ => return None,
            })
        }

        fn distance_px(&self, _: &str, _: PixelPoint) -> Option<f64> {
            Some(self.distance_px)
        }

        fn area_px(&self, _: &str) -> Option<f64> {
            Some(self.area_px)
        }
    }

    /// Tries conditions in scenes, steps and answers; returns how many were called certain.
    fn no_certain_condition_is_refuted(seed: u64, n_conditions: usize, n_scenes: usize) -> usize {
        let mut chance = Chance(seed);
        let (actions, atoms) = SPACES[seed as usize % SPACES.len()];
        let mut checks = String::new();
        for number in 0..n_conditions {
            let [when, holds] = [(); 2].map(|()| condition(atoms, &mut chance));
            // Only after an action are there values of the last.
            let guard = match format!("{when}{holds}").contains("last.") {
                true => format!("when last and ({when})"),
                false => ["", &format!("when {when}")][chance.below(2)].to_owned(),
            };
            checks += &format!("check c{number} {guard} {{ {holds} }} else \"No.\"\n");
        }
        let program = program_of(actions, &checks);
        let (mut n_certain, mut wrong) = (0, BTreeSet::new());
        let verdicts: Vec<[bool; 3]> = program
            .verify
            .checks
            .iter()
            .map(|it| {
                let when = it.when.as_ref().map(|when| (when, true));
                let both =
                    |passes| -> Vec<_> { when.into_iter().chain([(&it.holds, passes)]).collect() };
                let never_applies = when.is_some_and(|when| never(&[when], &program));
                [
                    never_applies,
                    never(&both(true), &program),
                    never(&both(false), &program),
                ]
            })
            .collect();
        n_certain += verdicts.iter().filter(|it| it.contains(&true)).count();
        for _ in 0..n_scenes {
            let n_corners = 1 + chance.below(27);
            let scene = Shown {
                corners: (0..n_corners).map(|_| chance.point()).collect(),
                center: chance.point(),
                distance_px: chance.below(12) as f64,
                area_px: chance.below(224 * 224) as f64,
            };
            let mut proposal = || Proposal {
                fields: program
                    .actions
                    .iter()
                    .map(|field| {
                        let offered = space::choices(field, &scene);
                        (
                            field.name.clone(),
                            offered[chance.below(offered.len())].clone(),
                        )
                    })
                    .collect(),
            };
            let (proposed, before) = (proposal(), proposal());
            let last = ExecutedAction {
                proposal: before,
                pick: chance.point(),
                place: PixelPoint::new(
                    chance.below(500) as i32 - 100,
                    chance.below(500) as i32 - 100,
                ),
            };
            let step = 1 + chance.below(2);
            let facts = Facts {
                scene: &scene,
                texts: &BTreeMap::new(),
                step: step as u32,
                last: (step > 1).then_some(&last),
                proposal: Some(&proposed),
                pointing: Pointing::pixels([224, 224]),
            };
            let eval = Eval {
                program: &program,
                facts,
            };
            for (check, [never_applies, never_passes, never_fails]) in
                program.verify.checks.iter().zip(&verdicts)
            {
                let mut holds = |it: &Condition| eval.holds(it, &mut Vec::new());
                // What needs a last action is not judged without one.
                let Ok(applies) = check.when.as_ref().map_or(Ok(true), &mut holds) else {
                    continue;
                };
                let Ok(passes) = holds(&check.holds) else {
                    continue;
                };
                if applies && (*never_applies || passes && *never_passes || !passes && *never_fails)
                {
                    wrong.insert(format!("{:?}: {:?}", check.when, check.holds));
                }
            }
        }
        assert!(wrong.is_empty(), "seed {seed}: {wrong:#?}");
        n_certain
    }

    #[test]
    fn no_sampled_scene_refutes_what_is_called_certain() {
        let n_certain: usize = (0..4)
            .map(|seed| no_certain_condition_is_refuted(seed, 60, 60))
            .sum();
        assert!(n_certain > 60, "only {n_certain} of 240 are certain");
    }

    #[test]
    #[ignore = "long"]
    fn no_scene_of_many_refutes_what_is_called_certain() {
        for seed in 100..140 {
            no_certain_condition_is_refuted(seed, 60, 500);
        }
    }
}
