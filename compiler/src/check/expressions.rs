//! Reads expressions: points, directions, values, and the arguments of calls by their kinds.
//!
//! In: an expression and what is expected there. Out: its part of the program. Each length carries the frame in which
//! it is compared, the picture or the table. It is converted through the camera only where the source says `in`.

use super::arguments::{Bound, bind, form};
use super::context::Context;
use super::names::Meaning;
use super::quantity::{
    beyond, measured, no_conversion, no_unit, not_whole, out_of_range, quantity_of, read,
    read_whole, units_of,
};
use super::short_text::colour_name;
use super::{files, missing_action};
use crate::diag::{Code, Diagnostic, Reported, among, nearest};
use crate::lang::calls::CLOTH_POINTS;
use crate::loader::Wanted;
use fab_grammar::ast::{Call, Expr, Name};
use fab_program::Depends;
use fab_program::exact::{normalised_deg, vector_of};
use fab_program::measures::{MEASURES, Make, Measure};
use fab_program::units::{self, Dimension, Unit};
use fab_program::vocabulary::{ArgValue, Args, Default, Kind, Place, Range, Signature, Word};
use fab_program::{
    ActionField, Choices, ClothPoint, Colour, End, Face, Heading, KeypointShape, Length, Number,
    PixelPoint, Point, Spot,
};

// ---- calls ---------------------------------------------------------------------------------------

/// Which keypoints a call may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Those declared above the keypoint of this index.
    Above(usize),
    /// All of them.
    Everywhere,
}

/// Reads a call by the row of its name that fits best.
///
/// - `rows`: the signatures of all calls of this kind, such as `extractor`.
pub(crate) fn call<'a>(
    kind: &str,
    expr: Expr<'a>,
    rows: impl Iterator<Item = &'static Signature> + Clone,
    scope: Scope,
    context: &mut Context<'a, '_>,
) -> Result<(usize, Args, Bound<'a>), Reported> {
    let Expr::Call(call) = expr else {
        let article = if kind.starts_with(['a', 'e', 'o']) {
            "an"
        } else {
            "a"
        };
        // Of many calls, the forms would fill the screen.
        let forms: Vec<String> = if rows.clone().count() <= 8 {
            rows.map(Signature::form).collect()
        } else {
            let mut names: Vec<String> = rows.map(|row| format!("{}(…)", row.name)).collect();
            names.dedup();
            names
        };
        let message = format!("expected {article} {kind}");
        let diagnostic = Diagnostic::new(Code::WrongForm, expr.span(), message);
        let help = format!("write {}", among(forms.iter().map(String::as_str)));
        return Err(context.error(diagnostic.help(help)));
    };
    let Some((row, signature)) = form(call, rows.clone()) else {
        return Err(context.unknown(kind, call.name(), rows.map(|row| row.name)));
    };
    let bound = bind(call, signature, Signature::form, context)?;
    let values = self::values(&bound, signature, scope, context)?;
    Ok((row, values, bound))
}

/// Reports a length in `edge`, the only unit without a size where there is no cloth yet.
pub(super) fn without_edge(
    args: &Args,
    bound: &Bound<'_>,
    message: &str,
    context: &mut Context<'_, '_>,
) -> Result<(), Reported> {
    let mut given = args.0.iter().zip(bound);
    let in_edge =
        given.find(|((_, value), _)| matches!(value, ArgValue::Number(it) if it.is_nan()));
    let Some((_, (_, expr))) = in_edge else {
        return Ok(());
    };
    let diagnostic = Diagnostic::new(Code::WrongQuantity, expr.span(), message);
    Err(context.error(diagnostic.help("write a length such as `4mm` or `250mm`")))
}

/// Reads the expressions of bound arguments, and adds the defaults.
pub(super) fn values<'a>(
    bound: &Bound<'a>,
    signature: &Signature,
    scope: Scope,
    context: &mut Context<'a, '_>,
) -> Result<Args, Reported> {
    let mut values = Vec::with_capacity(signature.args.len());
    let mut all = Ok(());
    for (index, (arg, expr)) in bound.iter().enumerate() {
        // The parts of a list probably share one mistake, so report only the first.
        if all.is_err() && arg.place == Place::Rest && index > 0 {
            break;
        }
        match argument(*expr, arg.kind, scope, context) {
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

fn by_default(default: Default, context: &Context<'_, '_>) -> Result<ArgValue, Reported> {
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
pub(super) fn argument<'a>(
    expr: Expr<'a>,
    kind: Kind,
    scope: Scope,
    context: &mut Context<'a, '_>,
) -> Result<ArgValue, Reported> {
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
        Kind::Keypoint(shapes) => ArgValue::Name(keypoint(expr, shapes, scope, context)?),
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
pub(super) fn material_name<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Name<'a>, Reported> {
    match expr {
        Expr::Name(name) => Ok(name),
        _ => {
            let diagnostic = context.unexpected(Code::WrongForm, expr, "the name of a material");
            Err(context.error(diagnostic))
        }
    }
}

/// Reads a face of the cloth as its colour; in a base without a cloth, as that of the recorded one.
fn face(expr: Expr<'_>, context: &mut Context<'_, '_>) -> Result<Colour, Reported> {
    let name = name_of(expr, "face", Face::WORDS, context)?;
    let face = Face::from_word(name).expect("a word of the table");
    let cloth = context.cloth.as_ref().map_err(|reported| *reported)?;
    Ok(match cloth {
        Some(cloth) => cloth.colour(face),
        None => Colour::recorded(face),
    })
}

/// Reads `A to B`.
fn between<'a>(
    expr: Expr<'a>,
    range: &Range,
    context: &mut Context<'a, '_>,
) -> Result<[f64; 2], Reported> {
    let Expr::Range(ends) = expr else {
        let diagnostic = context.unexpected(Code::WrongForm, expr, "a range");
        let help = format!("write `A to B`, each {}", range.words());
        return Err(context.error(diagnostic.help(help)));
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
    context: &mut Context<'_, '_>,
) -> Result<&'static str, Reported> {
    if let Expr::Name(name) = expr
        && let Some(word) = words.iter().find(|word| word.name == name.text())
    {
        return Ok(word.name);
    }
    let diagnostic = context.unexpected(Code::WrongForm, expr, &among(names(words)));
    let found = context.written(expr.span());
    Err(context.error(match nearest(&found, names(words)) {
        Some(meant) => diagnostic.meant(expr.span(), meant),
        None => diagnostic,
    }))
}

/// Reads a word of a closed set that messages have a noun for, such as a colour.
pub(super) fn name_of(
    expr: Expr<'_>,
    noun: &str,
    words: &'static [Word],
    context: &mut Context<'_, '_>,
) -> Result<&'static str, Reported> {
    let Expr::Name(name) = expr else {
        let diagnostic = context.unexpected(Code::WrongForm, expr, &among(names(words)));
        return Err(context.error(diagnostic));
    };
    // `corner(top_left)`: the top of the picture is called the back of the cloth here.
    let turned = name
        .text()
        .replace("top", "back")
        .replace("bottom", "front");
    if turned != name.text() && names(words).any(|word| word == turned) {
        let message = format!("there is no {noun} `{}`", name.text());
        let help = format!("write `{turned}`: back is the top of the picture, front its bottom");
        let diagnostic = Diagnostic::new(Code::UnknownName, name.span(), message).help(help);
        // It is another name, so it is left to the author.
        return Err(context.error(diagnostic.likely(name.span(), turned)));
    }
    context.word(noun, name, words)
}

/// Reads a word of a closed set, or a whole number with its unit: `low`, `2048 tokens`.
fn word_or_count<'a>(
    expr: Expr<'a>,
    (noun, words): (&str, &'static [Word]),
    (range, unit): (&Range, &'static str),
    context: &mut Context<'a, '_>,
) -> Result<ArgValue, Reported> {
    let expected = format!("{}, or a number of {unit}", among(names(words)));
    let quantity = match expr {
        Expr::Name(name) => return Ok(ArgValue::Word(context.word(noun, name, words)?)),
        Expr::Quantity(quantity) => quantity,
        _ => {
            let diagnostic = context.unexpected(Code::WrongForm, expr, &expected);
            return Err(context.error(diagnostic));
        }
    };
    let number = quantity.value();
    match quantity.unit() {
        Some(written) if written.text() == unit => {}
        Some(written) => return Err(context.unknown("unit", written, [unit])),
        None => {
            let diagnostic = no_unit(expr, &expected, context);
            return Err(context.error(diagnostic.help(format!("write `{number} {unit}`"))));
        }
    }
    if number.fract() != 0.0 {
        let help = format!("expected {}", range.words());
        return Err(not_whole(expr, &help, context));
    }
    if !range.contains(number) {
        return Err(beyond(expr, range, context));
    }
    Ok(ArgValue::Number(number))
}

fn names(words: &'static [Word]) -> impl Iterator<Item = &'static str> {
    words.iter().map(|word| word.name)
}

fn word_or_file(
    expr: Expr<'_>,
    words: &'static [Word],
    ending: &str,
    context: &mut Context<'_, '_>,
) -> Result<ArgValue, Reported> {
    let Expr::Text(text) = expr else {
        let word = word(expr, words, context);
        return word.map(ArgValue::Word);
    };
    let file = files::named(text, "a start file", Wanted::Positions, context)?;
    if !file.path.ends_with(ending) {
        let written = context.written(expr.span());
        let message = format!("{written} is not a `{ending}` file");
        let help = format!(
            "the path must end in `{ending}`; {} are written without quotes",
            among(names(words)).replace(" or ", " and ")
        );
        return Err(
            context.error(Diagnostic::new(Code::WrongForm, expr.span(), message).help(help))
        );
    }
    Ok(ArgValue::File(file))
}

fn depth_limit<'a>(
    expr: Expr<'a>,
    range: &Range,
    context: &mut Context<'a, '_>,
) -> Result<f64, Reported> {
    let limit = match expr {
        Expr::Compare(compare)
            if compare.sign().text() == "<"
                && matches!(compare.left(), Expr::Name(name) if name.text() == "depth") =>
        {
            compare.right()
        }
        _ => {
            let message = "expected a limit of the depth";
            let diagnostic = Diagnostic::new(Code::WrongForm, expr.span(), message);
            let help = "write `mask(depth < 646mm)`: the pixels nearer to the camera than that";
            return Err(context.error(diagnostic.help(help)));
        }
    };
    let below_m = read(limit, range, context)?;
    if let Ok(Some(camera)) = &context.camera
        && below_m >= camera.height_m
    {
        let message = format!(
            "the mask reaches the table, which is {}mm from the camera",
            fab_program::exact::written(camera.height_m * 1000.0, 3)
        );
        let diagnostic = Diagnostic::new(Code::MaskSeesTable, limit.span(), message);
        context.remark(diagnostic.help("a flat cloth lies about 5 mm above the table"));
    }
    Ok(below_m)
}

// ---- keypoints and pixels ------------------------------------------------------------------------

/// Returns the name of a keypoint of one of these shapes.
pub(super) fn keypoint(
    expr: Expr<'_>,
    shapes: &[KeypointShape],
    scope: Scope,
    context: &mut Context<'_, '_>,
) -> Result<String, Reported> {
    let words: Vec<&str> = shapes.iter().map(|shape| shape.words()).collect();
    let words = words.join(" or ");
    let Expr::Name(name) = expr else {
        return Err(match scope {
            Scope::Above(_) => {
                let message = format!("expected the name of {words}");
                let diagnostic = Diagnostic::new(Code::WrongForm, expr.span(), message);
                let written = context.written(expr.span());
                context.error(match expr {
                    Expr::Call(_) => diagnostic.help(format!(
                        "declare it above, `NAME = {written}`, and write `NAME` here"
                    )),
                    _ => diagnostic,
                })
            }
            Scope::Everywhere => {
                let diagnostic = context.unexpected(Code::WrongExpression, expr, &words);
                context.error(diagnostic)
            }
        });
    };
    context.names.one_meaning(name.text())?;
    let Some(Meaning::Keypoint(shape)) = context.names.get(name.text()) else {
        let fits =
            |meaning| matches!(meaning, Meaning::Keypoint(Some(shape)) if shapes.contains(&shape));
        let kinds: Vec<&str> = shapes.iter().map(|shape| shape.name()).collect();
        let mut candidates = context.names.that(fits);
        if let Scope::Above(below) = scope {
            let is_above = |name: &&str| matches!(context.keypoints.get(name), Some((place, _)) if *place < below);
            candidates.retain(is_above);
        }
        return Err(context.unknown(&kinds.join(" or "), name, candidates));
    };
    if let Scope::Above(place) = scope {
        let found = context.keypoints.get(name.text());
        if found.is_none_or(|(found, _)| *found >= place) {
            let message = format!("`{}` is declared further down", name.text());
            let diagnostic = Diagnostic::new(Code::NotYetKnown, name.span(), message);
            return Err(
                context.error(diagnostic.help("an extractor can use only the keypoints above it"))
            );
        }
    }
    match shape {
        Some(shape) if shapes.contains(&shape) => Ok(name.text().to_owned()),
        shape => Err(wrong_shape(name, shape, &words, context)),
    }
}

/// Reports a keypoint of the wrong shape; one without a shape is reported at its declaration.
pub(super) fn wrong_shape(
    name: Name<'_>,
    shape: Option<KeypointShape>,
    expected: &str,
    context: &mut Context<'_, '_>,
) -> Reported {
    if let (None, Some((_, Err(reported)))) = (shape, context.keypoints.get(name.text())) {
        return *reported;
    }
    let message = format!("expected {expected}, found `{}`", name.text());
    let diagnostic = Diagnostic::new(Code::WrongKindOfName, name.span(), message);
    context.error(match shape {
        Some(KeypointShape::Mask) => diagnostic.label("this is a mask, a set of pixels"),
        Some(shape) => diagnostic.label(format!("this is {}", shape.words())),
        None => diagnostic,
    })
}

/// The range of a pixel's numbers: the largest picture that is read.
pub(crate) const PIXEL: Range = Range::new("a pixel", (0.0, "px"), (8191.0, "px"));

/// Reads the two numbers of a pixel.
pub(super) fn pixel<'a>(
    [u, v]: [Expr<'a>; 2],
    context: &mut Context<'a, '_>,
) -> Result<PixelPoint, Reported> {
    let u = read_whole(u, &PIXEL, context);
    let v = read_whole(v, &PIXEL, context);
    Ok(PixelPoint::new(u? as i32, v? as i32))
}

/// Reads a pixel in the camera's picture.
pub(super) fn pixel_in_picture<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<PixelPoint, Reported> {
    let Expr::Pair(pair) = expr else {
        let diagnostic = context.unexpected(Code::WrongForm, expr, "a pixel");
        return Err(context.error(diagnostic.help("write `(40px, 52px)`")));
    };
    let pixel = pixel(pair.parts(), context)?;
    if let Ok(Some(camera)) = &context.camera
        && pixel.u.max(pixel.v) >= camera.image_px as i32
    {
        let written = context.written(expr.span());
        let message = format!("`{written}` lies outside of the picture");
        let diagnostic = Diagnostic::new(Code::OutOfRange, expr.span(), message);
        return Err(context.error(
            diagnostic
                .help("the camera's `image` sets the size of the picture; pixels count from 0"),
        ));
    }
    Ok(pixel)
}

// ---- points of the cloth -------------------------------------------------------------------------

/// Reads a point of the cloth.
pub(super) fn cloth_point<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<ClothPoint, Reported> {
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
        let known = || rows.clone().map(|row| row.name).chain(["center"]);
        return Err(context.error(match nearest(name.text(), known()) {
            Some(meant) => diagnostic.meant(name.span(), meant),
            None => diagnostic.help(format!("there is {}", among(known()))),
        }));
    }
    let scope = Scope::Everywhere;
    let (row, args, bound) = call("point of the cloth", expr, rows, scope, context)?;
    let mut given = args.0.iter().zip(&bound);
    let center = ArgValue::ClothPoint(ClothPoint::Center);
    if let Some((_, (_, expr))) = given.find(|((_, value), _)| *value == center) {
        let message = "`center` is a point of the table, not of the cloth";
        let diagnostic = Diagnostic::new(Code::WrongForm, expr.span(), message);
        let help = "write `point(0.5, 0.5)` for the middle of the cloth";
        return Err(context.error(diagnostic.help(help)));
    }
    Ok((CLOTH_POINTS[row].make)(&args))
}

// ---- points of the picture -----------------------------------------------------------------------

/// Reads a point.
pub(crate) fn point<'a>(expr: Expr<'a>, context: &mut Context<'a, '_>) -> Result<Point, Reported> {
    match expr {
        Expr::Path(path) => match path.text() {
            "last.pick" => Ok(Point::Last { end: End::Pick }),
            "last.place" => Ok(Point::Last { end: End::Place }),
            text => match last_field(text, context)? {
                Some(_) => {
                    let message =
                        format!("`{text}` can be used only in texts, as `{{{{ {text} }}}}`");
                    Err(context.fault(Code::WrongExpression, path.span(), message))
                }
                None => {
                    Err(context.unknown_at("point", text, path.span(), ["last.pick", "last.place"]))
                }
            },
        },
        Expr::Call(call) if is_measure_of_point(call) => match measure(call, context)? {
            Measure::Point(point) => Ok(point),
            _ => Err(not_a_point(expr, context)),
        },
        Expr::Name(name) => named_point(name, context),
        _ => Err(not_a_point(expr, context)),
    }
}

/// Returns the field of the last action that a dotted name refers to; `None` if the action has no such field.
fn last_field<'c>(
    text: &str,
    context: &'c Context<'_, '_>,
) -> Result<Option<&'c ActionField>, Reported> {
    let Some(name) = text.strip_prefix("last.") else {
        return Ok(None);
    };
    context.actions.get(name)
}

fn not_a_point(expr: Expr<'_>, context: &mut Context<'_, '_>) -> Reported {
    let diagnostic = context.unexpected(Code::WrongExpression, expr, "a point");
    context.error(diagnostic.help("points are `pick`, `place`, `last.pick`, `last.place`, `mirror(…)` and keypoints that are one point"))
}

fn named_point(name: Name<'_>, context: &mut Context<'_, '_>) -> Result<Point, Reported> {
    let text = name.text().to_owned();
    match context.names.get(&text) {
        Some(Meaning::Field) => match context.actions.get(&text)? {
            Some(field) if field.is_point() => Ok(Point::Action { field: text }),
            Some(_) => {
                let message = format!("expected a point, found `{text}`");
                let diagnostic = Diagnostic::new(Code::WrongKindOfName, name.span(), message);
                Err(context.error(diagnostic.label("this field of the action is not a point")))
            }
            None => carried(name, context),
        },
        Some(Meaning::Keypoint(Some(KeypointShape::Point))) => Ok(Point::Keypoint { name: text }),
        Some(Meaning::Keypoint(shape)) => Err(wrong_shape(name, shape, "one point", context)),
        Some(Meaning::DuplicateNames(reported)) => Err(reported),
        None if text == "last" => {
            let message = "`last` is a condition, not a point";
            let diagnostic = Diagnostic::new(Code::WrongExpression, name.span(), message);
            Err(context.error(diagnostic.help("write `last.pick` or `last.place`")))
        }
        None if context.constants.contains_key(text.as_str()) => {
            let message = format!("expected a point, found `{text}`");
            let diagnostic = Diagnostic::new(Code::WrongKindOfName, name.span(), message);
            Err(context.error(diagnostic.label("this is a constant")))
        }
        Some(Meaning::Text { .. }) | None => {
            let candidates = points(context);
            Err(context.unknown("point", name, candidates))
        }
    }
}

/// Returns the names that can stand for a point.
fn points<'a>(context: &Context<'a, '_>) -> Vec<&'a str> {
    let mut names = context.names.that(|meaning| {
        matches!(
            meaning,
            Meaning::Field | Meaning::Keypoint(Some(KeypointShape::Point))
        )
    });
    names.retain(|name| match context.actions.get(name) {
        Ok(Some(field)) => field.is_point(),
        Ok(None) | Err(_) => true,
    });
    names
}

/// Returns the `place` of an action that declares a direction and a distance instead of a place.
fn carried(name: Name<'_>, context: &mut Context<'_, '_>) -> Result<Point, Reported> {
    context.actions.complete?;
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

/// Reads a point of a drawing, which must be known before an action is proposed.
fn spot<'a>(expr: Expr<'a>, context: &mut Context<'a, '_>) -> Result<Spot, Reported> {
    if let Expr::Name(name) = expr
        && context.names.get(name.text()) == Some(Meaning::Keypoint(Some(KeypointShape::Points)))
    {
        return Ok(Spot::Points {
            keypoint: name.text().to_owned(),
        });
    }
    let point = point(expr, context)?;
    if point.uses().action {
        return Err(missing_action::needs_action(expr.span(), context));
    }
    Ok(Spot::One { point })
}

// ---- directions ----------------------------------------------------------------------------------

/// Returns whether an expression can only be a direction.
pub(super) fn is_heading(expr: Expr<'_>, context: &Context<'_, '_>) -> bool {
    match expr {
        Expr::Heading(_) => true,
        Expr::Path(path) => path
            .text()
            .strip_prefix("last.")
            .is_some_and(|field| is_direction(field, context)),
        Expr::Name(name) => is_direction(name.text(), context),
        _ => false,
    }
}

fn is_direction(name: &str, context: &Context<'_, '_>) -> bool {
    let field = context.actions.get(name);
    matches!(field, Ok(Some(field)) if matches!(field.choices, Choices::Directions { .. }))
}

/// Reads a direction.
pub(crate) fn heading<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Heading, Reported> {
    match expr {
        Expr::Heading(heading) => {
            let from = point(heading.from(), context);
            let to = point(heading.to(), context);
            Ok(Heading::FromTo {
                from: from?,
                to: to?,
            })
        }
        Expr::Path(path) if is_heading(expr, context) => Ok(Heading::Last {
            field: path.text().trim_start_matches("last.").to_owned(),
        }),
        Expr::Name(name) if is_direction(name.text(), context) => Ok(Heading::Field {
            field: name.text().to_owned(),
        }),
        _ if quantity_of(expr, context)?.is_some() => Ok(Heading::Constant {
            vector: vector_of(fixed_deg(expr, context)?),
        }),
        _ => {
            if let Expr::Name(name) = expr {
                // A broken field is reported at its declaration.
                context.actions.get(name.text())?;
            }
            if let Expr::Path(path) = expr {
                last_field(path.text(), context)?;
            }
            let diagnostic = context.unexpected(Code::WrongExpression, expr, "a direction");
            Err(context.error(diagnostic.help("write `from center to pick`, an angle such as `45deg`, or a field of the action that is a direction")))
        }
    }
}

/// Returns a constant direction, in degrees within one turn.
pub(crate) fn fixed_deg<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<f64, Reported> {
    match constant(expr, context)? {
        Operand::Angle { deg, .. } => Ok(normalised_deg(deg)),
        other => {
            let message = format!("expected a direction, found {}", other.noun());
            let diagnostic = Diagnostic::new(Code::WrongQuantity, expr.span(), message);
            Err(context.error(
                diagnostic.help(
                    "write an angle such as `45deg`, counter-clockwise from the image's right",
                ),
            ))
        }
    }
}

fn direction_field(expr: Expr<'_>, context: &mut Context<'_, '_>) -> Result<String, Reported> {
    if let Expr::Name(name) = expr {
        if is_direction(name.text(), context) {
            return Ok(name.text().to_owned());
        }
        context.actions.get(name.text())?;
    }
    let diagnostic = context.unexpected(Code::WrongExpression, expr, "a field that is a direction");
    let fields = context.actions.right();
    let fields = fields.filter(|it| matches!(it.choices, Choices::Directions { .. }));
    let fields: Vec<&str> = fields.map(|it| it.name.as_str()).collect();
    let help = match fields.as_slice() {
        [] => "no field of this task is a direction".to_owned(),
        fields => format!("there is {}", among(fields.iter().copied())),
    };
    Err(context.error(diagnostic.help(help)))
}

// ---- values --------------------------------------------------------------------------------------

/// A value.
// Only one exists at a time, so its size does not matter.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub(crate) enum Operand {
    Length(FramedLength),
    /// A constant angle, degrees, and the unit that it is written in.
    Angle {
        deg: f64,
        unit: &'static Unit,
    },
    Between {
        a: Heading,
        b: Heading,
        unit: &'static Unit,
    },
    Number(f64),
    Counted {
        number: Number,
        as_percent: AsPercent,
    },
    Point(Point),
    Heading,
    /// A field that is a word.
    WordField(String),
    /// The word for where a point lies, seen from another.
    Quadrant {
        point: Point,
        about: Point,
    },
    Word(String),
}

impl Operand {
    /// Returns whether it is the same in every scene and for every action. Lengths are compared elsewhere.
    pub fn is_constant(&self) -> bool {
        matches!(
            self,
            Operand::Angle { .. } | Operand::Number(_) | Operand::Word(_)
        )
    }

    /// Returns the unit that it is written in, if it has one.
    pub fn unit(&self) -> Option<&'static Unit> {
        match self {
            Operand::Length(length) => Some(length.unit),
            Operand::Angle { unit, .. } | Operand::Between { unit, .. } => Some(unit),
            _ => None,
        }
    }

    /// Returns a noun for its kind.
    pub fn noun(&self) -> &'static str {
        match self {
            Operand::Length(FramedLength { unit, .. })
            | Operand::Angle { unit, .. }
            | Operand::Between { unit, .. } => unit.dimension.noun(),
            Operand::Number(_) | Operand::Counted { .. } => "a number",
            Operand::Point(_) => "a point",
            Operand::Heading => "a direction",
            Operand::WordField(_) | Operand::Quadrant { .. } | Operand::Word(_) => "a word",
        }
    }
}

/// Whether a fraction is written as a percentage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AsPercent {
    Yes,
    No,
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
    /// Returns the length in pixels or in metres. A measure of the picture stays in pixels.
    pub fn in_frame(
        &self,
        frame: Dimension,
        context: &Context<'_, '_>,
    ) -> Result<Length, Reported> {
        let [from_picture, to_picture] = [self.native, frame].map(|it| it == Dimension::Pixels);
        if from_picture == to_picture {
            return Ok(self.length.clone());
        }
        Ok(match &self.length {
            Length::Constant { value } if from_picture => Length::Constant {
                value: value / context.px_per_m()?,
            },
            Length::Constant { value } => Length::Constant {
                value: value * context.px_per_m()?,
            },
            Length::Field { field, .. } => Length::Field {
                field: field.clone(),
                scale: context.px_per_m()?,
            },
            Length::OfPoints(_) => self.length.clone(),
        })
    }
}

/// Reads a value.
pub(crate) fn operand<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Operand, Reported> {
    match expr {
        Expr::Converted(converted) => {
            let value = operand(converted.value(), context)?;
            convert(value, converted.target(), context)
        }
        _ if quantity_of(expr, context)?.is_some() => constant(expr, context),
        Expr::Name(name) => named(name, expr, context),
        Expr::Path(_) | Expr::Heading(_) if is_heading(expr, context) => {
            heading(expr, context).map(|_| Operand::Heading)
        }
        Expr::Path(_) => point(expr, context).map(Operand::Point),
        Expr::Text(text) => text.plain().map(Operand::Word).ok_or_else(|| {
            let message = "a word in a comparison cannot contain `{{ … }}`";
            context.fault(Code::WrongExpression, expr.span(), message)
        }),
        Expr::Call(call) => Ok(match measure(call, context)? {
            Measure::Length(length) => Operand::Length(FramedLength {
                length,
                native: Dimension::Pixels,
                unit: &units::PX,
            }),
            Measure::Angle { a, b } => Operand::Between {
                a,
                b,
                unit: &units::DEG,
            },
            Measure::Number(number) => Operand::Counted {
                number,
                as_percent: AsPercent::No,
            },
            Measure::Point(point) => Operand::Point(point),
            Measure::Quadrant { point, about } => Operand::Quadrant { point, about },
            Measure::Nearest { .. } => {
                let message = format!(
                    "`{0}` can be used only in texts, as `{{{{ {0}(…) }}}}`",
                    call.name().text()
                );
                return Err(context.fault(Code::WrongExpression, expr.span(), message));
            }
        }),
        _ => {
            let diagnostic = context.unexpected(Code::WrongExpression, expr, "a value");
            Err(context
                .error(diagnostic.help("write, for example, `distance(pick, place)` or `10px`")))
        }
    }
}

fn is_measure_of_point(call: Call<'_>) -> bool {
    let mut rows = MEASURES.iter();
    rows.any(|row| row.signature.name == call.name().text() && matches!(row.make, Make::Point(_)))
}

/// Reads a measure: `distance(pick, place)`.
pub(super) fn measure<'a>(
    call: Call<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Measure, Reported> {
    let signatures = MEASURES.iter().map(|row| &row.signature);
    let scope = Scope::Everywhere;
    let (row, args, _) = self::call("measure", Expr::Call(call), signatures, scope, context)?;
    let px_per_m = context.px_per_m();
    let flat_px = context
        .area_m2()
        .and_then(|area_m2| Ok(area_m2 * px_per_m? * px_per_m?));
    // A task with an error in its cloth or camera never becomes a program, so the size does not matter.
    Ok(MEASURES[row].measure(&args, flat_px.unwrap_or(f64::NAN)))
}

fn constant<'a>(expr: Expr<'a>, context: &mut Context<'a, '_>) -> Result<Operand, Reported> {
    let Some(found) = measured(expr, context)? else {
        let diagnostic = context.unexpected(Code::WrongExpression, expr, "a number and its unit");
        return Err(context.error(diagnostic));
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
            Ok(Operand::Length(FramedLength {
                length: Length::Constant { value: found.value },
                native: unit.dimension,
                unit,
            }))
        }
        // Converting through radians would make whole degrees inexact.
        Dimension::Angle if *unit == units::DEG => Ok(Operand::Angle {
            deg: found.number,
            unit,
        }),
        Dimension::Angle | Dimension::Number => Ok(Operand::Angle {
            deg: found.value.to_degrees(),
            unit,
        }),
        Dimension::ArealDensity => {
            let message = "nothing in a task weighs anything";
            let diagnostic = Diagnostic::new(Code::WrongExpression, expr.span(), message);
            let help = "only a `material` states a mass per area";
            Err(context.error(diagnostic.help(help)))
        }
    }
}

fn named<'a>(
    name: Name<'a>,
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Operand, Reported> {
    let text = name.text();
    match context.names.get(text) {
        Some(Meaning::Field) => match context.actions.get(text)?.map(|field| &field.choices) {
            Some(Choices::Lengths { unit, .. }) => Ok(Operand::Length(FramedLength {
                length: Length::Field {
                    field: text.to_owned(),
                    scale: 1.0,
                },
                native: unit.dimension,
                unit: unit.row(),
            })),
            Some(Choices::Directions { .. }) => Ok(Operand::Heading),
            Some(Choices::Words { .. }) => Ok(Operand::WordField(text.to_owned())),
            _ => point(expr, context).map(Operand::Point),
        },
        None if text == "step" => Ok(Operand::Counted {
            number: Number::Step,
            as_percent: AsPercent::No,
        }),
        None if text != "last" => {
            let mut candidates = points(context);
            candidates.extend(context.constants.keys());
            Err(context.unknown("value", name, candidates))
        }
        _ => point(expr, context).map(Operand::Point),
    }
}

fn convert(
    value: Operand,
    target: Name<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Operand, Reported> {
    let dimensions: &[Dimension] = match value.unit().map(|unit| unit.dimension) {
        Some(Dimension::Length | Dimension::Pixels) => &[Dimension::Length, Dimension::Pixels],
        Some(Dimension::Speed) => &[Dimension::Speed],
        Some(Dimension::Angle) => &[Dimension::Angle],
        Some(Dimension::ArealDensity | Dimension::Number) | None => &[],
    };
    let unit = units::find(target.text()).filter(|unit| dimensions.contains(&unit.dimension));
    Ok(match (value, unit) {
        (Operand::Length(length), Some(unit)) => Operand::Length(FramedLength { unit, ..length }),
        (Operand::Angle { deg, .. }, Some(unit)) => Operand::Angle { deg, unit },
        (Operand::Between { a, b, .. }, Some(unit)) => Operand::Between { a, b, unit },
        (Operand::Counted { number, .. }, None)
            if target.text() == "percent" && !number.is_whole() =>
        {
            Operand::Counted {
                number,
                as_percent: AsPercent::Yes,
            }
        }
        (value, _) => {
            let fitting = match &value {
                Operand::Counted { number, .. } if !number.is_whole() => vec!["percent"],
                _ => units_of(dimensions),
            };
            return Err(no_conversion(target, value.noun(), fitting, context));
        }
    })
}
