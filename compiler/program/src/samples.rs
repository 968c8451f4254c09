//! Makes arguments that fit a signature from its kinds alone. Tests use them to check every row against its
//! declaration.

use crate::data::annotate::Spot;
use crate::data::camera::PixelPoint;
use crate::data::folds::ClothPoint;
use crate::data::points::{End, Heading, Point};
use crate::units;
use crate::vocabulary::{Arg, ArgValue, Args, Default, Kind, Signature};

/// Returns two sets of arguments: with every argument given, and with defaults for the optional ones.
pub fn of(signature: &Signature) -> [Args; 2] {
    let given = |arg: &Arg| (arg.name, value(&arg.kind));
    let least = |arg: &Arg| match arg.default {
        None => given(arg),
        Some(Default::Number(number)) => (arg.name, ArgValue::Number(number)),
        Some(Default::Word(word)) => (arg.name, ArgValue::Word(word)),
        Some(Default::CameraSide) => (arg.name, ArgValue::Number(224.0)),
        Some(Default::Nothing) => (arg.name, ArgValue::Nothing),
    };
    [
        Args(signature.args.iter().map(given).collect()),
        Args(signature.args.iter().map(least).collect()),
    ]
}

fn value(kind: &Kind) -> ArgValue {
    let point = || Point::Last { end: End::Pick };
    match kind {
        Kind::Quantity(range) | Kind::Whole(range) | Kind::Odd(range) | Kind::DepthLimit(range) => {
            ArgValue::Number(units::base(range.to))
        }
        Kind::Between(range) => ArgValue::Between([range.from, range.to].map(units::base)),
        Kind::Word(words)
        | Kind::NameOf { words, .. }
        | Kind::WordOrFile { words, .. }
        | Kind::WordOrCount { words, .. } => ArgValue::Word(words[0].name),
        Kind::Keypoint(_) | Kind::DirectionField => ArgValue::Name("name".to_owned()),
        Kind::Pixel => ArgValue::Pixel(PixelPoint::new(40, 52)),
        Kind::Point => ArgValue::Point(point()),
        Kind::Spot => ArgValue::Spot(Spot::One { point: point() }),
        Kind::Heading => ArgValue::Heading(Heading::Constant { vector: [1.0, 0.0] }),
        Kind::Material => ArgValue::Name("towel".to_owned()),
        Kind::Face => ArgValue::Colours([[0.0, 60.0], [0.5, 1.0], [0.5, 1.0]]),
        Kind::ColourName => ArgValue::Name("orange".to_owned()),
        Kind::ClothPoint => ArgValue::ClothPoint(ClothPoint::Center),
    }
}
