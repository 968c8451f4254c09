//! How a word of the language is described: one row per word, and everything else is read from the row.
//!
//! A [`Call`] is a row: its name, its arguments with kind, range and default, one line of documentation, and the
//! function that makes its value. The compiler binds, checks and explains arguments from the row alone; the reference
//! tables and the editor's vocabulary are generated from it. Rows are beside the code that they make values for:
//! units in [`crate::units`], extractors in [`crate::data::keypoints`], measures in `crate::measures`, all other
//! calls in the compiler.

use crate::data::annotate::Spot;
use crate::data::camera::PixelPoint;
use crate::data::files::FileRef;
use crate::data::folds::ClothPoint;
use crate::data::points::{Heading, Point};
use crate::data::shape::KeypointShape;
use crate::units::{self, Dimension};
use serde::Serialize;

pub use crate::words::Word;

/// A function that a task may call, and the value it makes.
#[derive(Clone, Copy, Debug)]
pub struct Call<Make> {
    /// Its name, arguments and documentation.
    pub signature: Signature,
    /// Makes its value from arguments that match the signature.
    pub make: Make,
}

/// A call that makes its value from its arguments alone.
pub type CallOf<T> = Call<fn(&Args) -> T>;

impl<Make> Call<Make> {
    /// Makes a row.
    pub const fn new(
        name: &'static str,
        gives: &'static str,
        args: &'static [Arg],
        doc: &'static str,
        make: Make,
    ) -> Call<Make> {
        let signature = Signature {
            name,
            gives,
            args,
            doc,
        };
        Call { signature, make }
    }
}

/// The signature of a call: its name, its arguments, one line of documentation.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Signature {
    /// Its name. Rows with one name are the forms of one call; the labels of the arguments tell them apart.
    pub name: &'static str,
    /// What it gives, such as `a mask`.
    pub gives: &'static str,
    /// Its arguments; positional ones in order.
    pub args: &'static [Arg],
    /// What it does, one line.
    pub doc: &'static str,
}

/// One argument of a call.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Arg {
    /// Its name: the label of a named argument, or how messages refer to a positional one.
    pub name: &'static str,
    /// How it is given.
    pub place: Place,
    /// Its type and range.
    pub kind: Kind,
    /// Its value if it is not given; `None` if it is required.
    pub default: Option<Default>,
    /// The other argument that it needs, if it makes no sense alone.
    pub needs: Option<Needs>,
    /// What it means, a few words.
    pub doc: &'static str,
}

/// How an argument is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// By its place: `grid(55, 44)`.
    Positional,
    /// By its label: `image: 224px`.
    Named,
    /// One or more without a label: `points((40px, 52px), …)`.
    Rest,
}

/// The value of an optional argument that is not given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Default {
    /// A number, in base units.
    Number(f64),
    /// A word of its closed set.
    Word(&'static str),
    /// The side of the camera's picture, pixels.
    CameraSide,
    /// Nothing: the value is absent.
    Nothing,
}

/// Another argument that an argument needs.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Needs {
    /// The other argument.
    pub arg: &'static str,
    /// Its accepted words; empty if any value is accepted.
    pub words: &'static [&'static str],
}

/// The type and range of an argument.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A number with its unit.
    Quantity(Range),
    /// A whole number.
    Whole(Range),
    /// An odd whole number: the side of a square that has a middle pixel.
    Odd(Range),
    /// `A to B`, both in the range.
    Between(Range),
    /// One word of a closed set.
    Word(&'static [Word]),
    /// The same, for a set that has a noun.
    NameOf {
        /// The noun for its words, such as `colour`.
        noun: &'static str,
        /// The set.
        words: &'static [Word],
    },
    /// The name of a keypoint of one of these shapes; in a keypoint's declaration, an earlier one.
    Keypoint(&'static [KeypointShape]),
    /// `depth < LIMIT`, the limit in the range.
    DepthLimit(Range),
    /// A pixel of the camera's picture, `(40px, 52px)`.
    Pixel,
    /// A point: a field, a keypoint, `last.place`, `mirror(…)`.
    Point,
    /// A point that is known before an action is proposed, or a keypoint with several points.
    Spot,
    /// A direction: `from A to B`, an angle, a field.
    Heading,
    /// A field of the action that is a direction.
    DirectionField,
    /// A point of the cloth: `corner(back_left)`, `center`.
    ClothPoint,
    /// The name of a material.
    Material,
    /// A face of the cloth; its value is the range of colours that it may have in a picture.
    Face,
    /// A name, or words in quotes, that people call a colour.
    ColourName,
    /// A word of a closed set, or the path of a file.
    WordOrFile {
        /// The set.
        words: &'static [Word],
        /// The ending of the path.
        ending: &'static str,
    },
    /// A word of a closed set, or a whole number of what its unit counts.
    WordOrCount {
        /// The noun for both, such as `level`.
        noun: &'static str,
        /// The set.
        words: &'static [Word],
        /// The numbers.
        range: Range,
        /// The word after the number.
        unit: &'static str,
    },
}

impl Kind {
    /// Returns the accepted words, if it is one of a closed set.
    pub fn words(&self) -> Option<&'static [Word]> {
        match self {
            Kind::Word(words) | Kind::NameOf { words, .. } => Some(words),
            _ => None,
        }
    }
}

/// The accepted numbers, both ends included, stated once and in the author's units.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Range {
    /// What the number is, such as `a width`.
    pub noun: &'static str,
    /// The smallest, and its unit; no unit if empty.
    pub from: (f64, &'static str),
    /// The largest, and its unit.
    pub to: (f64, &'static str),
    /// Whether the smallest itself is accepted.
    pub least: Bound,
    /// Whether the end of a range `A to B` may be below its beginning, as with hues.
    pub wraps: bool,
}

/// Whether an end of a range is included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// It does.
    Included,
    /// It does not.
    Excluded,
}

impl Range {
    /// Makes a range with both ends included.
    pub const fn new(
        noun: &'static str,
        from: (f64, &'static str),
        to: (f64, &'static str),
    ) -> Range {
        let least = Bound::Included;
        Range {
            noun,
            from,
            to,
            least,
            wraps: false,
        }
    }

    /// Makes a range of plain numbers with both ends included.
    pub const fn plain(noun: &'static str, from: f64, to: f64) -> Range {
        Range::new(noun, (from, ""), (to, ""))
    }

    /// Returns the same range without its smallest value.
    pub const fn above(self) -> Range {
        Range {
            least: Bound::Excluded,
            ..self
        }
    }

    /// Returns the same range, with ends allowed below their beginnings.
    pub const fn wrapping(self) -> Range {
        Range {
            wraps: true,
            ..self
        }
    }

    /// Returns the dimension of its numbers.
    pub fn dimension(&self) -> Dimension {
        units::find(self.to.1).map_or(Dimension::Number, |unit| unit.dimension)
    }

    /// Returns whether a number in base units is in the range; NaN never is.
    pub fn contains(&self, value: f64) -> bool {
        let (least, most) = (units::base(self.from), units::base(self.to));
        let above = match self.least {
            Bound::Included => value >= least,
            Bound::Excluded => value > least,
        };
        above && value <= most
    }

    /// Describes what is accepted, such as ``a width from `1px` to `20px` ``.
    pub fn words(&self) -> String {
        let [from, to] = [self.from, self.to].map(|(number, unit)| format!("`{number}{unit}`"));
        match self.least {
            Bound::Included => format!("{} from {from} to {to}", self.noun),
            Bound::Excluded => format!("{} above {from} and at most {to}", self.noun),
        }
    }
}

impl Arg {
    const fn new(name: &'static str, place: Place, kind: Kind, doc: &'static str) -> Arg {
        Arg {
            name,
            place,
            kind,
            default: None,
            needs: None,
            doc,
        }
    }

    /// Makes an argument that is given by its place.
    pub const fn positional(name: &'static str, kind: Kind, doc: &'static str) -> Arg {
        Arg::new(name, Place::Positional, kind, doc)
    }

    /// Makes an argument that is given by its label.
    pub const fn named(name: &'static str, kind: Kind, doc: &'static str) -> Arg {
        Arg::new(name, Place::Named, kind, doc)
    }

    /// Makes an argument that stands for one or more without a label.
    pub const fn rest(name: &'static str, kind: Kind, doc: &'static str) -> Arg {
        Arg::new(name, Place::Rest, kind, doc)
    }

    /// Returns the same argument with a default, so it is optional.
    pub const fn or(self, default: Default) -> Arg {
        Arg {
            default: Some(default),
            ..self
        }
    }

    /// Returns the same argument, which makes sense only together with another one.
    pub const fn needs(self, arg: &'static str, words: &'static [&'static str]) -> Arg {
        Arg {
            needs: Some(Needs { arg, words }),
            ..self
        }
    }
}

impl Signature {
    /// Writes the form of a complete call: `contour(MASK, tolerance: …, [at: …])`.
    pub fn form(&self) -> String {
        let arg = |arg: &Arg| match (arg.place, arg.default) {
            (Place::Positional, _) => arg.name.to_uppercase(),
            (Place::Rest, _) => format!("{}, …", arg.name.to_uppercase()),
            (Place::Named, None) => format!("{}: …", arg.name),
            (Place::Named, Some(_)) => format!("[{}: …]", arg.name),
        };
        let args: Vec<String> = self.args.iter().map(arg).collect();
        format!("{}({})", self.name, args.join(", "))
    }
}

/// The value of one argument, read by its [`Kind`].
#[derive(Clone, Debug, PartialEq)]
pub enum ArgValue {
    /// A number in base units.
    Number(f64),
    /// The two ends of a range, base units.
    Between([f64; 2]),
    /// A word of the closed set.
    Word(&'static str),
    /// A keypoint or a field.
    Name(String),
    /// A pixel.
    Pixel(PixelPoint),
    /// A point.
    Point(Point),
    /// A place in a drawing.
    Spot(Spot),
    /// A direction.
    Heading(Heading),
    /// A point of the cloth.
    ClothPoint(ClothPoint),
    /// A file.
    File(FileRef),
    /// The hue, saturation and value of a colour in a picture, in degrees and fractions.
    Colours([[f64; 2]; 3]),
    /// It is not given and has no default value.
    Nothing,
}

/// The arguments of one call, by name; those of [`Place::Rest`] may occur several times.
///
/// Every argument of the signature is present, so reading one by its name and kind cannot fail. A row that reads
/// another name or kind than it declares is a bug, which the test over all rows finds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Args(pub Vec<(&'static str, ArgValue)>);

/// A row that disagrees with its own signature is a bug in the row.
const ROW: &str = "a row asks for the arguments that it declares, by their kinds";

macro_rules! getters {
    ($($(#[$doc:meta])* $name:ident $variant:ident -> $type:ty;)*) => {
        impl Args {
            $($(#[$doc])* pub fn $name(&self, name: &str) -> $type {
                match self.get(name) {
                    Some(ArgValue::$variant(value)) => value.clone(),
                    _ => panic!("{ROW}: `{name}`"),
                }
            })*
        }
    };
}

getters! {
    /// Returns a number in base units.
    number Number -> f64;
    /// Returns the ends of a range, base units.
    between Between -> [f64; 2];
    /// Returns a word.
    word Word -> &'static str;
    /// Returns the name of a keypoint or a field.
    name Name -> String;
    /// Returns a point.
    point Point -> Point;
    /// Returns a direction.
    heading Heading -> Heading;
    /// Returns a point of the cloth.
    cloth_point ClothPoint -> ClothPoint;
    /// Returns ranges of hue, saturation and value.
    colours Colours -> [[f64; 2]; 3];
}

macro_rules! lists {
    ($($(#[$doc:meta])* $name:ident $variant:ident -> $type:ty;)*) => {
        impl Args {
            $($(#[$doc])* pub fn $name(&self, name: &str) -> Vec<$type> {
                let one = |value: &ArgValue| match value {
                    ArgValue::$variant(value) => value.clone(),
                    _ => panic!("{ROW}: `{name}`"),
                };
                self.all(name).map(one).collect()
            })*
        }
    };
}

lists! {
    /// Returns the names of an argument.
    names Name -> String;
    /// Returns the pixels of an argument.
    pixels Pixel -> PixelPoint;
    /// Returns the points of the cloth of an argument.
    cloth_points ClothPoint -> ClothPoint;
    /// Returns the places of a drawing.
    spots Spot -> Spot;
}

impl Args {
    /// Returns a whole number. The kinds that give one have limits far below the largest `u32`.
    pub fn whole(&self, name: &str) -> u32 {
        self.number(name) as u32
    }

    /// Returns what a word means, such as `args.meaning("keep", Side::from_word)`.
    pub fn meaning<T>(&self, name: &str, from_word: fn(&str) -> Option<T>) -> T {
        from_word(self.word(name)).expect(ROW)
    }

    /// Returns the name of a keypoint, if one is given.
    pub fn optional_name(&self, name: &str) -> Option<String> {
        self.is_given(name).then(|| self.name(name))
    }

    /// Returns whether an argument is given, or has a default value.
    pub fn is_given(&self, name: &str) -> bool {
        !matches!(self.get(name), None | Some(ArgValue::Nothing))
    }

    /// Returns every value of an argument, in order.
    pub fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a ArgValue> {
        self.0
            .iter()
            .filter(move |(known, _)| *known == name)
            .map(|(_, value)| value)
    }

    /// Returns the first value of an argument.
    pub fn get(&self, name: &str) -> Option<&ArgValue> {
        self.0
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, value)| value)
    }
}
