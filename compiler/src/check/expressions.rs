//! Reads expressions: points, directions, values, and the arguments of calls by their kinds.
//!
//! In: an expression and what is expected there. Out: its part of the program. Each length carries the frame in which
//! it is compared, the picture or the table. It is converted through the camera only where the source says `in`.

use super::arguments::{Bound, bind, form};
use super::context::{Context, Result};
use super::files;
use super::names::Meaning;
use super::quantity::{
    beyond, measured, no_conversion, no_unit, out_of_range, read, read_whole, units_of, whole,
};
use super::short_text::colour_name;
use crate::diag::{Code, Diagnostic, Reported, among};
use crate::lang::calls::CLOTH_POINTS;
use crate::loader::Wanted;
use fab_grammar::ast::{Call, Expr, Name, Path};
use fab_program::Depends;
use fab_program::exact::{normalised_deg, vector_of, written};
use fab_program::measures::{MEASURES, Measure};
use fab_program::units::{self, Dimension, Unit};
use fab_program::vocabulary::{
    ArgValue, Args, CallOf, Default, Kind, Place, Range, Signature, Word,
};
use fab_program::{
    ActionField, Choices, ClothPoint, Colour, End, Face, Heading, KeypointShape, Length, Number,
    NumberFormat, PixelPoint, Point, Spot,
};

// ---- calls ---------------------------------------------------------------------------------------

/// Reads a call by the row of its name that fits best.
///
/// - `rows`: the signatures of all calls of this kind, such as `extractor`.
pub(crate) fn call<'a>(
    kind: &str,
    expr: Expr<'a>,
    rows: impl Iterator<Item = &'static Signature> + Clone,
    context: &mut Context<'_>,
) -> Result<(usize, Args, Bound<'a>)> {
    let Expr::Call(call) = expr else {
        // Of many calls, the forms would fill the screen.
        let forms: Vec<String> = if rows.clone().count() <= 8 {
            rows.map(Signature::form).collect()
        } else {
            let mut names: Vec<String> = rows.map(|row| format!("{}(…)", row.name)).collect();
            names.dedup();
            names
        };
        let article = if kind.starts_with(['a', 'e', 'o']) {
            "an"
        } else {
            "a"
        };
        let message = format!("expected {article} {kind}");
        let help = format!("write {}", among(forms.iter().map(String::as_str)));
        return Err(context.refuse(Code::WrongForm, expr.span(), message, help));
    };
    let Some((row, signature)) = form(call, rows.clone()) else {
        return Err(context.unknown(kind, call.name(), rows.map(|row| row.name)));
    };
    let bound = bind(call, signature, Signature::form, context)?;
    let values = self::values(&bound, signature, context)?;
    Ok((row, values, bound))
}

/// Reads a call of a table, and makes its part of the program.
pub(crate) fn made<'a, T>(
    kind: &str,
    expr: Expr<'a>,
    rows: &'static [CallOf<T>],
    context: &mut Context<'_>,
) -> Result<(T, Args, Bound<'a>)> {
    let signatures = rows.iter().map(|row| &row.signature);
    let (row, args, bound) = call(kind, expr, signatures, context)?;
    Ok(((rows[row].make)(&args), args, bound))
}

/// Reports a length in `edge`, the only unit without a size where there is no cloth yet.
pub(super) fn without_edge(
    args: &Args,
    bound: &Bound<'_>,
    message: &str,
    context: &mut Context<'_>,
) -> Result<()> {
    let mut given = args.0.iter().zip(bound);
    let in_edge =
        given.find(|((_, value), _)| matches!(value, ArgValue::Number(it) if it.is_nan()));
    let Some((_, (_, expr))) = in_edge else {
        return Ok(());
    };
    let help = "write a length such as `4mm` or `250mm`";
    Err(context.refuse(Code::WrongQuantity, expr.span(), message, help))
}

/// Reads the expressions of bound arguments, and adds the defaults.
pub(super) fn values(
    bound: &Bound<'_>,
    signature: &Signature,
    context: &mut Context<'_>,
) -> Result<Args> {
    let mut values = Vec::with_capacity(signature.args.len());
    let mut all = Ok(());
    for (index, (arg, expr)) in bound.iter().enumerate() {
        // The parts of a list probably share one mistake, so report only the first.
        if all.is_err() && arg.place == Place::Rest && index > 0 {
            break;
        }
        match argument(*expr, arg.kind, context) {
            Ok(value) => values.push((arg.name, value)),
            Err(reported) => all = Err(reported),
        }
    }
    all?;
    for arg in signature.args {
        let is_given = bound.iter().any(|(given, _)| given.name == arg.name);
        if let Some(default) = arg.default.filter(|_| !is_given) {
            values.push((arg.name, by_default(default, context)?));
        }
    }
    Ok(Args(values))
}

fn by_default(default: Default, context: &Context<'_>) -> Result<ArgValue> {
    Ok(match default {
        Default::Number(number) => ArgValue::Number(number),
        Default::Word(word) => ArgValue::Word(word),
        Default::Nothing => ArgValue::Nothing,
        // A base without a camera never becomes a program, so its side does not matter.
        Default::CameraSide => {
            let camera = context.camera.as_ref().map_err(|reported| *reported)?;
            ArgValue::Number(camera.as_ref().map_or(0.0, |it| f64::from(it.image_px)))
        }
    })
}

/// Reads one argument by its kind.
pub(super) fn argument(expr: Expr<'_>, kind: Kind, context: &mut Context<'_>) -> Result<ArgValue> {
    Ok(match kind {
        Kind::Quantity(range) => ArgValue::Number(read(expr, &range, context)?),
        Kind::Whole(range) => ArgValue::Number(read_whole(expr, &range, context)?),
        Kind::Odd(range) => {
            let number = read_whole(expr, &range, context)?;
            if number % 2.0 != 1.0 {
                return Err(beyond(expr, &range, context));
            }
            ArgValue::Number(number)
        }
        Kind::Between(range) => ArgValue::Between(between(expr, &range, context)?),
        Kind::Word(words) => ArgValue::Word(word(expr, words, context)?),
        Kind::NameOf { noun, words } => ArgValue::Word(name_of(expr, noun, words, context)?),
        Kind::Keypoint(shapes) => ArgValue::Name(keypoint(expr, shapes, context)?),
        Kind::DepthLimit(range) => ArgValue::Number(depth_limit(expr, &range, context)?),
        Kind::Pixel => ArgValue::Pixel(pixel_in_picture(expr, context)?),
        Kind::Point => ArgValue::Point(point(expr, context)?),
        Kind::Spot => ArgValue::Spot(spot(expr, context)?),
        Kind::Heading => ArgValue::Heading(heading(expr, context)?),
        Kind::DirectionField => ArgValue::Name(direction_field(expr, context)?),
        Kind::ClothPoint => ArgValue::ClothPoint(cloth_point(expr, context)?),
        // Whoever reads the call finds the material itself.
        Kind::Material => ArgValue::Name(material_name(expr, context)?.text().to_owned()),
        Kind::Face => ArgValue::Colours(face(expr, context)?.in_picture()),
        Kind::ColourName => ArgValue::Name(colour_name(expr, context)?),
        Kind::WordOrFile { words, ending } => word_or_file(expr, words, ending, context)?,
        Kind::WordOrCount {
            noun,
            words,
            range,
            unit,
        } => word_or_count(expr, (noun, words), (&range, unit), context)?,
    })
}

/// Reads the name of a material, declared or not.
pub(super) fn material_name<'a>(expr: Expr<'a>, context: &mut Context<'_>) -> Result<Name<'a>> {
    match expr {
        Expr::Name(name) => Ok(name),
        _ => Err(context.wrong(Code::WrongForm, expr, "the name of a material", None)),
    }
}

/// Reads a face of the cloth as its colour.
fn face(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Colour> {
    let name = name_of(expr, "face", Face::WORDS, context)?;
    context.colour(Face::from_word(name).expect("a word of the table"))
}

/// Reads `A to B`.
fn between(expr: Expr<'_>, range: &Range, context: &mut Context<'_>) -> Result<[f64; 2]> {
    let Expr::Range(ends) = expr else {
        let help = format!("write `A to B`, each {}", range.words());
        return Err(context.wrong(Code::WrongForm, expr, "a range", Some(&help)));
    };
    let low = read(ends.low(), range, context);
    let high = read(ends.high(), range, context);
    let [low, high] = [low?, high?];
    if low > high && !range.wraps {
        let written = context.written(expr.span());
        let message = format!("the range `{written}` ends below its beginning");
        let [low, high] = [ends.low(), ends.high()].map(|end| context.written(end.span()));
        let turned = format!("{high} to {low}");
        let diagnostic = Diagnostic::new(Code::OutOfRange, expr.span(), message)
            .help(format!("write `{turned}`"))
            .likely(expr.span(), turned);
        return Err(context.error(diagnostic));
    }
    Ok([low, high])
}

/// Reads a word of a closed set.
pub(super) fn word(
    expr: Expr<'_>,
    words: &'static [Word],
    context: &mut Context<'_>,
) -> Result<&'static str> {
    if let Expr::Name(name) = expr
        && let Some(word) = words.iter().find(|word| word.name == name.text())
    {
        return Ok(word.name);
    }
    Err(context.wrong(Code::WrongForm, expr, &among(names(words)), None))
}

/// Reads a word of a closed set that messages have a noun for, such as a colour.
pub(super) fn name_of(
    expr: Expr<'_>,
    noun: &str,
    words: &'static [Word],
    context: &mut Context<'_>,
) -> Result<&'static str> {
    let Expr::Name(name) = expr else {
        return word(expr, words, context);
    };
    // `corner(top_left)`: the top of the picture is the back of the cloth.
    let turned = { name.text() }.replace("top", "back");
    let turned = turned.replace("bottom", "front");
    if turned != name.text() && names(words).any(|word| word == turned) {
        let message = format!("there is no {noun} `{}`", name.text());
        let diagnostic = Diagnostic::new(Code::UnknownName, name.span(), message);
        return Err(context.error(diagnostic.meant(name.span(), &turned)));
    }
    context.word(noun, name, words)
}

/// Reads a word of a closed set, or a whole number with its unit: `low`, `2048 tokens`.
fn word_or_count(
    expr: Expr<'_>,
    (noun, words): (&str, &'static [Word]),
    (range, unit): (&Range, &'static str),
    context: &mut Context<'_>,
) -> Result<ArgValue> {
    let expected = format!("{}, or a number of {unit}", among(names(words)));
    let quantity = match expr {
        Expr::Name(name) => return Ok(ArgValue::Word(context.word(noun, name, words)?)),
        Expr::Quantity(quantity) => quantity,
        _ => return Err(context.wrong(Code::WrongForm, expr, &expected, None)),
    };
    let number = quantity.value();
    match quantity.unit() {
        Some(written) if written.text() == unit => whole(number, expr, range, context),
        Some(written) => Err(context.unknown("unit", written, [unit])),
        None => {
            let diagnostic = no_unit(expr, &expected, context);
            Err(context.error(diagnostic.help(format!("write `{number} {unit}`"))))
        }
    }
    .map(ArgValue::Number)
}

fn names(words: &'static [Word]) -> impl Iterator<Item = &'static str> {
    words.iter().map(|word| word.name)
}

fn word_or_file(
    expr: Expr<'_>,
    words: &'static [Word],
    ending: &str,
    context: &mut Context<'_>,
) -> Result<ArgValue> {
    let Expr::Text(text) = expr else {
        return word(expr, words, context).map(ArgValue::Word);
    };
    let file = files::named(text, "a start file", Wanted::Positions, context)?;
    if !file.path.ends_with(ending) {
        let written = context.written(expr.span());
        let message = format!("{written} is not a `{ending}` file");
        let words = among(names(words)).replace(" or ", " and ");
        let help = format!("the path must end in `{ending}`; {words} are written without quotes");
        return Err(context.refuse(Code::WrongForm, expr.span(), message, help));
    }
    Ok(ArgValue::File(file))
}

fn depth_limit(expr: Expr<'_>, range: &Range, context: &mut Context<'_>) -> Result<f64> {
    let is_depth = |expr| matches!(expr, Expr::Name(name) if name.text() == "depth");
    let limit = match expr {
        Expr::Compare(compare) if compare.sign().text() == "<" && is_depth(compare.left()) => {
            compare.right()
        }
        _ => {
            let message = "expected a limit of the depth";
            let help = "write `mask(depth < 646mm)`: the pixels nearer to the camera than that";
            return Err(context.refuse(Code::WrongForm, expr.span(), message, help));
        }
    };
    let below_m = read(limit, range, context)?;
    if let Ok(Some(camera)) = &context.camera
        && below_m >= camera.height_m
    {
        let height = written(camera.height_m * 1000.0, 3);
        let message = format!("the mask reaches the table, which is {height}mm from the camera");
        let help = "a flat cloth lies about 5 mm above the table";
        context.warn(Code::MaskSeesTable, limit.span(), message, help);
    }
    Ok(below_m)
}

// ---- keypoints and pixels ------------------------------------------------------------------------

/// Returns the name of a keypoint of one of these shapes.
pub(super) fn keypoint(
    expr: Expr<'_>,
    shapes: &[KeypointShape],
    context: &mut Context<'_>,
) -> Result<String> {
    let words: Vec<&str> = shapes.iter().map(|shape| shape.words()).collect();
    let words = words.join(" or ");
    let Expr::Name(name) = expr else {
        let is_extractor = context.n_keypoints < usize::MAX;
        return Err(match expr {
            Expr::Call(_) if is_extractor => {
                let message = format!("expected the name of {words}");
                let written = context.written(expr.span());
                let help = format!("declare it above, `NAME = {written}`, and write `NAME` here");
                context.refuse(Code::WrongForm, expr.span(), message, help)
            }
            _ if is_extractor => context.wrong(Code::WrongForm, expr, &words, None),
            _ => context.wrong(Code::WrongExpression, expr, &words, None),
        });
    };
    let n_keypoints = context.n_keypoints;
    let Some(Meaning::Keypoint(shape, place)) = context.names.get(name.text())? else {
        let candidates = context.names.that(|meaning| match meaning {
            Meaning::Keypoint(shape, place) => {
                place < n_keypoints && shape.is_some_and(|shape| shapes.contains(&shape))
            }
            _ => false,
        });
        let kinds: Vec<&str> = shapes.iter().map(|shape| shape.name()).collect();
        return Err(context.unknown(&kinds.join(" or "), name, candidates));
    };
    if place >= n_keypoints {
        let message = format!("`{}` is declared further down", name.text());
        let help = "an extractor can use only the keypoints above it";
        return Err(context.refuse(Code::NotYetKnown, name.span(), message, help));
    }
    match shape {
        Some(shape) if shapes.contains(&shape) => Ok(name.text().to_owned()),
        shape => {
            let found = shape.map_or("a keypoint", KeypointShape::words);
            Err(wrong_kind(name, &words, found, context))
        }
    }
}

/// Reports a name that stands for something else than what is expected.
pub(super) fn wrong_kind(
    name: Name<'_>,
    expected: &str,
    found: &str,
    context: &mut Context<'_>,
) -> Reported {
    let message = format!("expected {expected}, found `{}`", name.text());
    let diagnostic = Diagnostic::new(Code::WrongKindOfName, name.span(), message);
    context.error(diagnostic.label(format!("this is {found}")))
}

/// The range of a pixel's numbers: the largest picture that is read.
pub(crate) const PIXEL: Range = Range::new("a pixel", (0.0, "px"), (8191.0, "px"));

/// Reads a pixel, which may lie outside of the picture.
pub(super) fn pixel(expr: Expr<'_>, context: &mut Context<'_>) -> Result<PixelPoint> {
    let Expr::Pair(pair) = expr else {
        let help = Some("write `(40px, 52px)`");
        return Err(context.wrong(Code::WrongForm, expr, "a pixel", help));
    };
    pixel_of(pair.parts(), context)
}

/// Reads the two numbers of a pixel.
pub(super) fn pixel_of([u, v]: [Expr<'_>; 2], context: &mut Context<'_>) -> Result<PixelPoint> {
    let u = read_whole(u, &PIXEL, context);
    let v = read_whole(v, &PIXEL, context);
    Ok(PixelPoint::new(u? as i32, v? as i32))
}

/// Reads a pixel in the camera's picture.
pub(super) fn pixel_in_picture(expr: Expr<'_>, context: &mut Context<'_>) -> Result<PixelPoint> {
    let pixel = pixel(expr, context)?;
    if let Ok(Some(camera)) = &context.camera
        && pixel.u.max(pixel.v) >= camera.image_px as i32
    {
        let written = context.written(expr.span());
        let message = format!("`{written}` lies outside of the picture");
        let help = "the camera's `image` sets the size of the picture; pixels count from 0";
        return Err(context.refuse(Code::OutOfRange, expr.span(), message, help));
    }
    Ok(pixel)
}

// ---- points of the cloth -------------------------------------------------------------------------

/// Reads a point of the cloth.
pub(super) fn cloth_point(expr: Expr<'_>, context: &mut Context<'_>) -> Result<ClothPoint> {
    let rows = CLOTH_POINTS.iter().map(|row| &row.signature);
    let unknown = match expr {
        Expr::Name(name) if name.text() == "center" => return Ok(ClothPoint::Center),
        Expr::Name(name) => Some(name),
        Expr::Call(call) => Some(call.name()).filter(|_| form(call, rows.clone()).is_none()),
        _ => None,
    };
    if let Some(name) = unknown {
        let message = format!("`{}` is not a point of the cloth", name.text());
        let diagnostic = Diagnostic::new(Code::WrongForm, name.span(), message);
        let known = rows.map(|row| row.name).chain(["center"]);
        return Err(context.error(diagnostic.suggest(name.text(), known, "")));
    }
    let (point, args, bound) = made("point of the cloth", expr, CLOTH_POINTS, context)?;
    let mut given = args.0.iter().zip(&bound);
    let center = ArgValue::ClothPoint(ClothPoint::Center);
    if let Some((_, (_, expr))) = given.find(|((_, value), _)| *value == center) {
        let message = "`center` is a point of the table, not of the cloth";
        let help = "write `point(0.5, 0.5)` for the middle of the cloth";
        return Err(context.refuse(Code::WrongForm, expr.span(), message, help));
    }
    if let [a, b] = ["a", "b"].map(|end| args.get(end))
        && a.is_some()
        && a == b
    {
        let [a, b] = [&bound[0], &bound[1]].map(|(_, end)| *end);
        let a = context.written(a.span());
        let message = format!("there is nothing between `{a}` and the same point");
        let help = format!("name another point here, or write `{a}` alone");
        return Err(context.refuse(Code::WrongForm, b.span(), message, help));
    }
    Ok(point)
}

// ---- values --------------------------------------------------------------------------------------

/// What an expression stands for.
// Only one exists at a time, so its size does not matter.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub(crate) enum Operand {
    Length(FramedLength),
    /// A constant angle, degrees, and the unit that it is written in.
    Angle(f64, &'static Unit),
    /// The angle between two directions, and the unit that it is written in.
    Between([Heading; 2], &'static Unit),
    Number(f64),
    /// A number, and how it is written.
    Counted(Number, NumberFormat),
    Point(Point),
    Heading(Heading),
    /// A field that is a word.
    WordField(String),
    /// The word for where the first point lies, seen from the second.
    Quadrant([Point; 2]),
    Word(String),
    /// The choice of a direction field that is nearest to a direction.
    Nearest(String, Heading),
    /// A keypoint that is not one point.
    Keypoint(String, KeypointShape),
    /// A text that the stage with this index reads.
    Text(String, usize),
    /// A layer that is drawn on the camera's picture.
    Layer(String),
}

impl Operand {
    /// Returns whether it is the same in every scene and for every action. Lengths are compared elsewhere.
    pub fn is_constant(&self) -> bool {
        matches!(
            self,
            Operand::Angle(..) | Operand::Number(_) | Operand::Word(_)
        )
    }

    /// Returns the unit that it is written in, if it has one.
    pub fn unit(&self) -> Option<&'static Unit> {
        match self {
            Operand::Length(length) => Some(length.unit),
            Operand::Angle(_, unit) | Operand::Between(_, unit) => Some(unit),
            _ => None,
        }
    }

    /// Returns a noun for its kind.
    pub fn noun(&self) -> &'static str {
        match self {
            Operand::Length(FramedLength { unit, .. })
            | Operand::Angle(_, unit)
            | Operand::Between(_, unit) => unit.dimension.noun(),
            Operand::Number(_) | Operand::Counted(..) => "a number",
            Operand::Point(_) => "a point",
            Operand::Heading(_) => "a direction",
            Operand::WordField(_) | Operand::Quadrant(_) | Operand::Word(_) => "a word",
            Operand::Nearest(..) => "a choice, only for texts",
            Operand::Keypoint(_, shape) => shape.words(),
            Operand::Text(..) => "a text",
            Operand::Layer(_) => "a layer",
        }
    }
}

/// A length. It is compared where its unit measures: in the picture, on the table, or as a speed.
#[derive(Clone, Debug)]
pub(crate) struct FramedLength {
    /// Pixels, metres, or metres per second.
    pub length: Length,
    /// What the length measures where it comes from.
    pub native: Dimension,
    /// The unit that it is written in.
    pub unit: &'static Unit,
}

impl FramedLength {
    /// Makes a length that comes from where its unit measures.
    fn new(length: Length, unit: &'static Unit) -> FramedLength {
        FramedLength {
            length,
            native: unit.dimension,
            unit,
        }
    }

    /// Returns the length in pixels or in metres. A measure of the picture stays in pixels.
    pub fn in_frame(&self, frame: Dimension, context: &Context<'_>) -> Result<Length> {
        let [from_picture, to_picture] = [self.native, frame].map(|it| it == Dimension::Pixels);
        if from_picture == to_picture {
            return Ok(self.length.clone());
        }
        let px_per_m = context.px_per_m()?;
        Ok(match &self.length {
            Length::Constant { value } if from_picture => Length::Constant {
                value: value / px_per_m,
            },
            Length::Constant { value } => Length::Constant {
                value: value * px_per_m,
            },
            Length::Field { field, .. } => Length::Field {
                field: field.clone(),
                scale: px_per_m,
            },
            Length::OfPoints(_) => self.length.clone(),
        })
    }
}

/// The kind of value that is expected.
struct Expected {
    noun: &'static str,
    help: &'static str,
}

const VALUE: Expected = Expected {
    noun: "value",
    help: "write, for example, `distance(pick, place)` or `10px`",
};

const POINT: Expected = Expected {
    noun: "point",
    help: "points are `pick`, `place`, `last.pick`, `last.place`, `mirror(…)` and keypoints that are one point",
};

const DIRECTION: Expected = Expected {
    noun: "direction",
    help: "write `from center to pick`, an angle such as `45deg`, or a field of the action that is a direction",
};

/// Reads a value.
pub(crate) fn operand(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Operand> {
    value(expr, &VALUE, context)
}

/// Reads a point.
pub(crate) fn point(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Point> {
    match value(expr, &POINT, context)? {
        Operand::Point(point) => Ok(point),
        other => Err(mismatch(expr, &POINT, &other, context)),
    }
}

/// Reads a point of a drawing, which must be known before an action is proposed.
fn spot(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Spot> {
    match value(expr, &POINT, context)? {
        Operand::Keypoint(name, KeypointShape::Points) => Ok(Spot::Points { keypoint: name }),
        Operand::Point(point) if point.uses().action => Err(context.needs_action(expr.span())),
        Operand::Point(point) => Ok(Spot::One { point }),
        other => Err(mismatch(expr, &POINT, &other, context)),
    }
}

/// Reads a direction.
pub(crate) fn heading(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Heading> {
    match value(expr, &DIRECTION, context)? {
        Operand::Heading(heading) => Ok(heading),
        Operand::Angle(deg, _) => Ok(Heading::Constant {
            vector: vector_of(normalised_deg(deg)),
        }),
        other => Err(mismatch(expr, &DIRECTION, &other, context)),
    }
}

/// Returns a constant direction, in degrees within one turn.
pub(crate) fn fixed_deg(expr: Expr<'_>, context: &mut Context<'_>) -> Result<f64> {
    match constant(expr, context)? {
        Operand::Angle(deg, _) => Ok(normalised_deg(deg)),
        other => {
            let message = format!("expected a direction, found {}", other.noun());
            let help = "write an angle such as `45deg`, counter-clockwise from the image's right";
            Err(context.refuse(Code::WrongQuantity, expr.span(), message, help))
        }
    }
}

fn direction_field(expr: Expr<'_>, context: &mut Context<'_>) -> Result<String> {
    match value(expr, &DIRECTION, context)? {
        Operand::Heading(Heading::Field { field }) => Ok(field),
        _ => {
            let expected = "a field of the action that is a direction";
            Err(context.wrong(Code::WrongExpression, expr, expected, None))
        }
    }
}

/// Reports a value of another kind than the expected one.
fn mismatch(
    expr: Expr<'_>,
    expected: &Expected,
    found: &Operand,
    context: &mut Context<'_>,
) -> Reported {
    let code = match expr {
        Expr::Name(_) if expected.noun == POINT.noun => Code::WrongKindOfName,
        _ => Code::WrongExpression,
    };
    let diagnostic = context.unexpected(code, expr, &format!("a {}", expected.noun));
    let found = format!("this is {}", found.noun());
    context.error(diagnostic.label(found).help(expected.help))
}

/// Reads what an expression stands for.
///
/// - `expected`: for messages about names.
fn value(expr: Expr<'_>, expected: &Expected, context: &mut Context<'_>) -> Result<Operand> {
    match expr {
        Expr::Converted(converted) => {
            let value = operand(converted.value(), context)?;
            convert(value, converted.target(), context)
        }
        Expr::Quantity(_) => constant(expr, context),
        Expr::Name(name) => named(name, expected, context),
        Expr::Path(path) => of_last(path, context),
        Expr::Heading(heading) => {
            let from = point(heading.from(), context);
            let to = point(heading.to(), context);
            Ok(Operand::Heading(Heading::FromTo {
                from: from?,
                to: to?,
            }))
        }
        Expr::Text(text) => text.plain().map(Operand::Word).ok_or_else(|| {
            let message = "a word in a comparison cannot contain `{{ … }}`";
            context.fault(Code::WrongExpression, expr.span(), message)
        }),
        Expr::Call(call) => measure(call, context),
        _ => {
            let noun = format!("a {}", expected.noun);
            Err(context.wrong(Code::WrongExpression, expr, &noun, Some(expected.help)))
        }
    }
}

/// Returns what a name stands for.
fn named(name: Name<'_>, expected: &Expected, context: &mut Context<'_>) -> Result<Operand> {
    let text = name.text().to_owned();
    Ok(match context.names.get(&text)? {
        Some(Meaning::Constant(_)) => return constant(Expr::Name(name), context),
        Some(Meaning::Field) => match context.actions.get(&text)? {
            Some(field) => of_field(field),
            None => carried(name, context).map(Operand::Point)?,
        },
        Some(Meaning::Keypoint(Some(KeypointShape::Point), _)) => {
            Operand::Point(Point::Keypoint { name: text })
        }
        Some(Meaning::Keypoint(Some(shape), _)) => Operand::Keypoint(text, shape),
        Some(Meaning::Text(stage)) => Operand::Text(text, stage),
        Some(Meaning::Layer) => Operand::Layer(text),
        None if text == "step" => plain(Number::Step),
        None if text == "last" => {
            let message = "`last` is a condition, not a point";
            let help = "write `last.pick` or `last.place`";
            return Err(context.refuse(Code::WrongExpression, name.span(), message, help));
        }
        Some(Meaning::Keypoint(None, _)) | None => {
            let is_any = expected.noun == VALUE.noun;
            let candidates = context.names.that(|meaning| match meaning {
                Meaning::Field => true,
                Meaning::Keypoint(shape, _) => shape == Some(KeypointShape::Point),
                Meaning::Constant(_) => is_any,
                Meaning::Text(_) | Meaning::Layer => false,
            });
            return Err(context.unknown(expected.noun, name, candidates));
        }
    })
}

/// Returns a number that is written without a unit.
fn plain(number: Number) -> Operand {
    let written = NumberFormat {
        factor: 1.0,
        decimals: 3,
        unit: String::new(),
    };
    Operand::Counted(number, written)
}

/// Returns the value of a field of the action.
fn of_field(field: &ActionField) -> Operand {
    let name = field.name.clone();
    match &field.choices {
        Choices::Lengths { unit, .. } => {
            let (field, scale) = (name, 1.0);
            Operand::Length(FramedLength::new(
                Length::Field { field, scale },
                unit.row(),
            ))
        }
        Choices::Directions { .. } => Operand::Heading(Heading::Field { field: name }),
        Choices::Words { .. } => Operand::WordField(name),
        Choices::Points { .. } | Choices::Region { .. } => {
            Operand::Point(Point::Action { field: name })
        }
    }
}

/// Returns the value of `last.pick`, `last.place`, or of a direction of the last action.
fn of_last(path: Path<'_>, context: &mut Context<'_>) -> Result<Operand> {
    let text = path.text();
    let field = match text.strip_prefix("last.") {
        Some("pick") => return Ok(Operand::Point(Point::Last { end: End::Pick })),
        Some("place") => return Ok(Operand::Point(Point::Last { end: End::Place })),
        Some(name) => context.actions.get(name)?,
        None => None,
    };
    match field.map(of_field) {
        Some(Operand::Heading(Heading::Field { field })) => {
            Ok(Operand::Heading(Heading::Last { field }))
        }
        Some(_) => {
            let message = format!("`{text}` can be used only in texts, as `{{{{ {text} }}}}`");
            Err(context.fault(Code::WrongExpression, path.span(), message))
        }
        None => {
            let points = ["last.pick", "last.place"];
            Err(context.unknown_at("point", text, path.span(), points))
        }
    }
}

/// Returns the `place` of an action that declares a direction and a distance instead of a place.
fn carried(name: Name<'_>, context: &mut Context<'_>) -> Result<Point> {
    context.complete?;
    for field in ["pick", "direction", "distance"] {
        if context.actions.get(field)?.is_none() {
            return Err(context.unknown("point", name, []));
        }
    }
    Ok(Point::Carried {
        from: Box::new(Point::Action {
            field: "pick".to_owned(),
        }),
        direction: "direction".to_owned(),
        distance: "distance".to_owned(),
        px_per_m: context.px_per_m()?,
    })
}

/// Reads a measure: `distance(pick, place)`.
fn measure(call: Call<'_>, context: &mut Context<'_>) -> Result<Operand> {
    let signatures = MEASURES.iter().map(|row| &row.signature);
    let (row, args, _) = self::call("measure", Expr::Call(call), signatures, context)?;
    let px_per_m = context.px_per_m();
    let flat_px = context
        .area_m2()
        .and_then(|area_m2| Ok(area_m2 * px_per_m? * px_per_m?));
    // A task with an error in its cloth or camera never becomes a program, so the size does not matter.
    Ok(
        match MEASURES[row].measure(&args, flat_px.unwrap_or(f64::NAN)) {
            Measure::Length(length) => Operand::Length(FramedLength::new(length, &units::PX)),
            Measure::Angle { a, b } => Operand::Between([a, b], &units::DEG),
            Measure::Number(number) => plain(number),
            Measure::Point(point) => Operand::Point(point),
            Measure::Quadrant { point, about } => Operand::Quadrant([point, about]),
            Measure::Nearest { field, to } => Operand::Nearest(field, to),
        },
    )
}

fn constant(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Operand> {
    let Some(found) = measured(expr, context)? else {
        let expected = "a number and its unit";
        return Err(context.wrong(Code::WrongExpression, expr, expected, None));
    };
    // Huge numbers would overflow when they are squared.
    if found.value.abs() > 1e6 {
        let help = "write at most a million pixels, metres, metres per second or degrees";
        return Err(out_of_range(expr, help, context));
    }
    let Some(unit) = found.unit else {
        return Ok(Operand::Number(found.value));
    };
    match unit.dimension {
        Dimension::Pixels | Dimension::Length | Dimension::Speed if found.value < 0.0 => {
            let help = format!("{} is never negative", unit.dimension.noun());
            Err(out_of_range(expr, &help, context))
        }
        Dimension::Pixels | Dimension::Length | Dimension::Speed => {
            let length = Length::Constant { value: found.value };
            Ok(Operand::Length(FramedLength::new(length, unit)))
        }
        // Converting through radians would make whole degrees inexact.
        Dimension::Angle if *unit == units::DEG => Ok(Operand::Angle(found.number, unit)),
        Dimension::Angle | Dimension::Number => Ok(Operand::Angle(found.value.to_degrees(), unit)),
        Dimension::ArealDensity => {
            let message = "nothing in a task weighs anything";
            let help = "only a `material` states a mass per area";
            Err(context.refuse(Code::WrongExpression, expr.span(), message, help))
        }
    }
}

fn convert(value: Operand, target: Name<'_>, context: &mut Context<'_>) -> Result<Operand> {
    if let Operand::Counted(number, _) = &value
        && !number.is_whole()
    {
        if target.text() != "percent" {
            let fitting = vec!["percent"];
            return Err(no_conversion(target, value.noun(), fitting, context));
        }
        let percent = NumberFormat {
            factor: 100.0,
            decimals: 0,
            unit: "%".to_owned(),
        };
        return Ok(Operand::Counted(number.clone(), percent));
    }
    let dimensions: &[Dimension] = match value.unit().map(|unit| unit.dimension) {
        Some(Dimension::Length | Dimension::Pixels) => &[Dimension::Length, Dimension::Pixels],
        Some(Dimension::Speed) => &[Dimension::Speed],
        Some(Dimension::Angle) => &[Dimension::Angle],
        Some(Dimension::ArealDensity | Dimension::Number) | None => &[],
    };
    let unit = units::find(target.text()).filter(|unit| dimensions.contains(&unit.dimension));
    match (value, unit) {
        (Operand::Length(length), Some(unit)) => {
            Ok(Operand::Length(FramedLength { unit, ..length }))
        }
        (Operand::Angle(deg, _), Some(unit)) => Ok(Operand::Angle(deg, unit)),
        (Operand::Between([a, b], _), Some(unit)) => Ok(Operand::Between([a, b], unit)),
        (value, _) => {
            let fitting = units_of(dimensions);
            Err(no_conversion(target, value.noun(), fitting, context))
        }
    }
}
