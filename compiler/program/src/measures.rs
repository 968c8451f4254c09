//! What checks and texts measure: lengths, angles and numbers, one row for each call.
//!
//! In: points of the picture and what the scene shows. Out: numbers. Verdicts depend on them, so they use only
//! additions, multiplications and comparisons of 64-bit floats, in a fixed order; the emitted verifiers do the same
//! in other languages. A length in pixels between points needs only a row of [`MEASURES`], whose formula the emitting
//! crate writes in these languages.

use crate::data::actions::Direction;
use crate::data::points::{Heading, Point};
use crate::data::shape::KeypointShape;
use crate::data::uses::{Depends, Uses};
use crate::scene::{Missing, SceneView};
use crate::vocabulary::{Arg, Args, Call, Kind, Signature};
use serde::de::Error;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// Every measure.
pub const MEASURES: &[Call<Make>] = &[
    length(
        "distance",
        &[A, B],
        "how far apart two points are",
        Square::Sum(&Square::Apart(0), &Square::Apart(1)),
    ),
    length(
        "chebyshev",
        &[A, B],
        "the larger of two points' distances along the two axes",
        Square::Larger(&Square::Apart(0), &Square::Apart(1)),
    ),
    COLUMN,
    ROW,
    other(
        "angle_between",
        "an angle",
        &[
            Arg::positional("a", Kind::Heading, "a direction"),
            Arg::positional("b", Kind::Heading, "another"),
        ],
        "the angle between two directions, `0deg` to `180deg`",
        |args, _| Measure::Angle {
            a: args.heading("a"),
            b: args.heading("b"),
        },
    ),
    other(
        "count",
        "a number",
        &[Arg::positional(
            "points",
            Kind::Keypoint(&[KeypointShape::Points]),
            "a list of points",
        )],
        "how many points a keypoint has",
        |args, _| {
            Measure::Number(Number::Count {
                keypoint: args.name("points"),
            })
        },
    ),
    other(
        "coverage",
        "a number",
        &[Arg::positional(
            "mask",
            Kind::Keypoint(&[KeypointShape::Mask]),
            "a mask",
        )],
        "a mask's pixels divided by those of the flat cloth",
        |args, flat_px| {
            Measure::Number(Number::Coverage {
                mask: args.name("mask"),
                flat_px,
            })
        },
    ),
    Call::new(
        "mirror",
        "a point",
        &[
            Arg::positional("point", Kind::Point, "the point that is mirrored"),
            Arg::positional("about", Kind::Point, "the point between the two"),
        ],
        "the point on the other side of another",
        Make::Point(|args| Point::Mirror {
            of: Box::new(args.point("point")),
            about: Box::new(args.point("about")),
        }),
    ),
    other(
        "nearest",
        "a direction of a field, in texts",
        &[
            Arg::positional("field", Kind::DirectionField, "a field that is a direction"),
            Arg::positional("direction", Kind::Heading, "a direction"),
        ],
        "the field's choice that is nearest to a direction",
        |args, _| Measure::Nearest {
            field: args.name("field"),
            to: args.heading("direction"),
        },
    ),
    other(
        "quadrant",
        "a word",
        &[
            POINT,
            Arg::positional("about", Kind::Point, "the point that it is seen from"),
        ],
        "where in the picture a point lies, seen from another: `upper_left`, `upper_right`, `lower_left` or `lower_right`",
        |args, _| Measure::Quadrant {
            point: args.point("point"),
            about: args.point("about"),
        },
    ),
];

/// Where a point lies along the picture's columns.
pub const COLUMN: Call<Make> = length(
    "x",
    &[POINT],
    "how far a point is from the left of the picture",
    Square::Coordinate(0),
);

/// Where a point lies along the picture's rows.
pub const ROW: Call<Make> = length(
    "y",
    &[POINT],
    "how far a point is from the top of the picture",
    Square::Coordinate(1),
);

/// The words of `quadrant`: above the other point, then below it; each time left of it, then right.
///
/// A point in the other's row is below it, and one in its column right of it, so each point has one word.
pub const QUADRANTS: [[&str; 2]; 2] =
    [["upper_left", "upper_right"], ["lower_left", "lower_right"]];

const A: Arg = Arg::positional("a", Kind::Point, "a point");
const B: Arg = Arg::positional("b", Kind::Point, "another");
const POINT: Arg = Arg::positional("point", Kind::Point, "a point");

/// How a call makes its value.
#[derive(Clone, Copy, Debug)]
pub enum Make {
    /// A length in the picture, from the points that are the call's arguments.
    Length(Square),
    /// A point of the picture.
    Point(fn(&Args) -> Point),
    /// Any other value, from the arguments and the number of pixels of the flat cloth.
    Other(fn(&Args, f64) -> Measure),
}

/// The square of a length as a formula over its points; negative if the length is.
///
/// It is the square because verdicts compare squares, which need no root. It is a formula, not code, because the
/// emitted verifiers write it in other languages. A coordinate is 0 for the column, 1 for the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Square {
    /// The square of the first point's coordinate, with its sign.
    Coordinate(usize),
    /// The square of the distance between the first two points along this coordinate.
    Apart(usize),
    /// The sum of two squares.
    Sum(&'static Square, &'static Square),
    /// The larger of two squares.
    Larger(&'static Square, &'static Square),
}

impl Square {
    /// Computes it from the points, `[column, row]`.
    fn of(self, points: &[[f64; 2]]) -> f64 {
        match self {
            Square::Coordinate(axis) => points[0][axis] * points[0][axis].abs(),
            Square::Apart(axis) => {
                let apart = points[0][axis] - points[1][axis];
                apart * apart
            }
            Square::Sum(one, other) => one.of(points) + other.of(points),
            Square::Larger(one, other) => {
                let (one, other) = (one.of(points), other.of(points));
                if one > other { one } else { other }
            }
        }
    }
}

/// The value of a call to a measure.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// A length in the picture.
    Length(Length),
    /// The angle between two directions.
    Angle {
        /// One direction.
        a: Heading,
        /// The other.
        b: Heading,
    },
    /// A number.
    Number(Number),
    /// A point.
    Point(Point),
    /// The choice of a direction field nearest to a direction.
    Nearest {
        /// The field.
        field: String,
        /// The direction.
        to: Heading,
    },
    /// The word of [`QUADRANTS`] for a point.
    Quadrant {
        /// The point.
        point: Point,
        /// The point that it is seen from.
        about: Point,
    },
}

impl Call<Make> {
    /// Makes the value of a call with these arguments.
    ///
    /// - `flat_px`: the number of pixels of the flat cloth; NaN if the task has no cloth or no camera.
    pub fn measure(&'static self, args: &Args, flat_px: f64) -> Measure {
        match self.make {
            Make::Length(square) => Measure::Length(Length::OfPoints(PointMeasure {
                signature: &self.signature,
                square,
                points: self
                    .signature
                    .args
                    .iter()
                    .map(|arg| args.point(arg.name))
                    .collect(),
            })),
            Make::Point(make) => Measure::Point(make(args)),
            Make::Other(make) => make(args, flat_px),
        }
    }
}

/// A length. Both sides of a comparison are in the same unit, pixels or metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "length", rename_all = "snake_case")]
pub enum Length {
    /// A number, at least 0.
    Constant {
        /// The number.
        value: f64,
    },
    /// A field that is a length.
    Field {
        /// The field.
        field: String,
        /// The factor for its metres: 1, or pixels per metre.
        scale: f64,
    },
    /// A measure of points, pixels.
    #[serde(untagged)]
    OfPoints(PointMeasure),
}

/// A length in the picture: a row of [`MEASURES`] and its points.
///
/// In JSON `{"length": "distance", "a": …, "b": …}`: the row's name, and the points by its arguments' names.
#[derive(Clone, Debug)]
pub struct PointMeasure {
    signature: &'static Signature,
    square: Square,
    points: Vec<Point>,
}

impl PointMeasure {
    /// Returns the measure with this name and these points; `None` for an unknown name or a wrong number of points.
    pub fn new(name: &str, points: Vec<Point>) -> Option<PointMeasure> {
        let row = MEASURES.iter().find(|row| row.signature.name == name)?;
        match row.make {
            Make::Length(square) if row.signature.args.len() == points.len() => {
                Some(PointMeasure {
                    signature: &row.signature,
                    square,
                    points,
                })
            }
            Make::Length(_) | Make::Point(_) | Make::Other(_) => None,
        }
    }

    /// Returns the measure's name.
    pub fn name(&self) -> &'static str {
        self.signature.name
    }

    /// Returns its points, in the order of the call.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Returns the square of its value for these points, negative if the value is.
    pub fn square(&self, points: &[[f64; 2]]) -> f64 {
        self.square.of(points)
    }
}

impl PartialEq for PointMeasure {
    fn eq(&self, other: &PointMeasure) -> bool {
        self.name() == other.name() && self.points == other.points
    }
}

impl Serialize for PointMeasure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1 + self.points.len()))?;
        map.serialize_entry("length", self.name())?;
        for (arg, point) in self.signature.args.iter().zip(&self.points) {
            map.serialize_entry(arg.name, point)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for PointMeasure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<PointMeasure, D::Error> {
        #[derive(Deserialize)]
        struct Entries {
            length: String,
            #[serde(flatten)]
            points: BTreeMap<String, Point>,
        }
        let mut entries = Entries::deserialize(deserializer)?;
        let name = &entries.length;
        let row = MEASURES.iter().find(|row| row.signature.name == *name);
        let args = row.map_or(&[][..], |row| row.signature.args);
        let points = args.iter().map_while(|arg| entries.points.remove(arg.name));
        PointMeasure::new(name, points.collect())
            .ok_or_else(|| D::Error::custom(format!("no length `{name}` of these points")))
    }
}

/// A number without a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "number", rename_all = "snake_case")]
pub enum Number {
    /// How many points a keypoint has.
    Count {
        /// The keypoint.
        keypoint: String,
    },
    /// Which step of the rollout this is, from 1.
    Step,
    /// A mask's pixels divided by those of the flat cloth.
    Coverage {
        /// The mask.
        mask: String,
        /// The number of pixels of the flat cloth.
        flat_px: f64,
    },
}

impl Number {
    /// Returns whether it is always whole, so that it can be tested for equality.
    pub fn is_whole(&self) -> bool {
        !matches!(self, Number::Coverage { .. })
    }

    /// Returns its value in a scene; fails if the scene lacks its keypoint.
    pub fn value(&self, scene: &dyn SceneView, step: u32) -> Result<f64, Missing> {
        match self {
            Number::Count { keypoint } => {
                let points = scene
                    .points(keypoint)
                    .ok_or_else(|| Missing::of(keypoint))?;
                Ok(points.len() as f64)
            }
            Number::Step => Ok(f64::from(step)),
            Number::Coverage { mask, flat_px } => {
                let area_px = scene.area_px(mask).ok_or_else(|| Missing::of(mask))?;
                Ok(area_px / flat_px)
            }
        }
    }
}

impl Depends for Length {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Length::Constant { .. } => {}
            Length::Field { field, .. } => uses.add_field(field),
            Length::OfPoints(measure) => measure.points.add_uses(uses),
        }
    }
}

impl Depends for Number {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Number::Count { keypoint: name } | Number::Coverage { mask: name, .. } => {
                uses.keypoints.insert(name.clone());
            }
            Number::Step => uses.history = true,
        }
    }
}

impl fmt::Display for PointMeasure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let points: Vec<String> = self.points.iter().map(Point::to_string).collect();
        write!(f, "{}({})", self.name(), points.join(", "))
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Number::Count { keypoint } => write!(f, "count({keypoint})"),
            Number::Step => f.write_str("step"),
            Number::Coverage { mask, .. } => write!(f, "coverage({mask})"),
        }
    }
}

/// Returns the point on the other side of another.
pub(crate) fn mirror(of: [f64; 2], about: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis| 2.0 * about[axis] - of[axis])
}

/// Returns the word for where a point lies, seen from another.
pub fn quadrant(point: [f64; 2], about: [f64; 2]) -> &'static str {
    let [right, below] = [0, 1].map(|axis| usize::from(point[axis] >= about[axis]));
    QUADRANTS[below][right]
}

/// Returns the angle between two directions, degrees; 0 if one has no length.
pub fn angle_deg(a: [f64; 2], b: [f64; 2]) -> f64 {
    let cross = a[0] * b[1] - a[1] * b[0];
    libm::atan2(cross.abs(), dot(a, b)).to_degrees()
}

/// Returns what is compared instead of an angle and its limit: their cosines, squared with their signs, times both
/// squared lengths. This needs no root and no trigonometry. The larger an angle, the smaller its cosine.
///
/// Sides that differ only by rounding are equal, so that 45 degrees are not less than 45 degrees.
pub fn angle_sides(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> [f64; 2] {
    let along = dot(a, b);
    let along = along * along.abs();
    let size = dot(a, a) * dot(b, b);
    let limit = limit_cos * limit_cos.abs() * size;
    if (along - limit).abs() <= ROUNDING * size {
        [limit, limit]
    } else {
        [along, limit]
    }
}

/// The part of a squared cosine that rounding can change. Offered angles differ by 1e-4 degrees at least, which changes
/// it by 3e-12.
const ROUNDING: f64 = 1e-12;

/// Returns the choice nearest to a direction, degrees; the first of equally near ones.
pub(crate) fn nearest_deg(choices: &[Direction], to: [f64; 2]) -> Option<f64> {
    let mut best: Option<(f64, f64)> = None;
    for choice in choices {
        let along = dot(choice.vector, to);
        if best.is_none_or(|(most, _)| along > most) {
            best = Some((along, choice.deg));
        }
    }
    best.map(|(_, deg)| deg)
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

const fn length(
    name: &'static str,
    args: &'static [Arg],
    doc: &'static str,
    square: Square,
) -> Call<Make> {
    Call::new(
        name,
        "a length in the picture",
        args,
        doc,
        Make::Length(square),
    )
}

const fn other(
    name: &'static str,
    gives: &'static str,
    args: &'static [Arg],
    doc: &'static str,
    make: fn(&Args, f64) -> Measure,
) -> Call<Make> {
    Call::new(name, gives, args, doc, Make::Other(make))
}
