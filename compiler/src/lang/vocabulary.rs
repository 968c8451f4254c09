//! Everything that the language knows as one list: for editors, and for the tables of the reference.
//!
//! In: the tables. Out: [`Vocabulary`], plain data that serializes to the JSON of `fabc vocabulary --json`; and the
//! tables of `docs/language.md` as Markdown. Nothing is known here that does not stand in a table.

use super::actions::FIELDS;
use super::annotate::{COLORS, MARKS};
use super::calls::{CAMERAS, CLOTH_POINTS, CLOTHS};
use super::conditions::{SIGNS, WORDS};
use super::goal::{METRICS, STEPS};
use super::sections::{Merges, Needed, SECTIONS};
use super::stage::{DRAWINGS, MODELS, PICTURES, SETTINGS};
use super::test::{EXPECTATIONS, GIVEN};
use super::verify::NUMBERS;
use fab_program::measures::MEASURES;
use fab_program::units::{Dimension, UNITS};
use fab_program::vocabulary::{Arg, Default, Kind, Place, Range, Signature, Word};
use fab_program::{EXTRACTORS, Picker};
use serde::Serialize;

/// Version of the shape of [`Vocabulary`].
pub const VOCABULARY_FORMAT: u32 = 1;

/// Every word of the language.
#[derive(Clone, Debug, Serialize)]
pub struct Vocabulary {
    /// [`VOCABULARY_FORMAT`].
    pub format: u32,
    /// Words that can name nothing.
    pub keywords: Vec<&'static str>,
    /// Which words may begin a line, by the block that it stands in; none where lines begin with names.
    pub blocks: Vec<BlockWords>,
    /// The sections of a task.
    pub sections: Vec<SectionEntry>,
    /// The units of numbers.
    pub units: Vec<UnitEntry>,
    /// What is called with arguments: extractors, measures, marks and others.
    pub calls: Vec<CallEntry>,
    /// Closed sets of words, and numbers that stand behind a word.
    pub words: Vec<WordEntry>,
}

/// The words of one kind of block.
#[derive(Clone, Debug, Serialize)]
pub struct BlockWords {
    /// The block's keyword; `file` for a whole file.
    pub block: &'static str,
    /// What may begin a line of it.
    pub words: Vec<&'static str>,
}

/// A section of a task.
#[derive(Clone, Debug, Serialize)]
pub struct SectionEntry {
    /// The word that it begins with.
    pub word: &'static str,
    /// How it is written.
    pub form: &'static str,
    /// Who must have it: `each_task`, `a_run` (most inherit it) or `none`.
    pub needed: &'static str,
    /// What a task that extends another does to its section: `whole`, `by_name`, `changes` or `never`.
    pub merges: &'static str,
    /// What it says.
    pub doc: &'static str,
}

/// A unit.
#[derive(Clone, Debug, Serialize)]
pub struct UnitEntry {
    /// How it is written.
    pub name: &'static str,
    /// What it measures.
    pub measures: &'static str,
    /// Its size in metres, pixels or radians; none where the cloth decides.
    pub size: Option<f64>,
    /// How else models write it; in a source the right name is suggested.
    pub spellings: &'static [&'static str],
    /// What it is.
    pub doc: &'static str,
}

/// A call, one form of it.
#[derive(Clone, Debug, Serialize)]
pub struct CallEntry {
    /// Where it may stand: `extractor`, `measure`, `mark`, `cloth`, `camera`, `point of the cloth`.
    pub kind: &'static str,
    /// Its name.
    pub name: &'static str,
    /// How it looks when it is complete.
    pub form: String,
    /// What it gives.
    pub gives: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// Its arguments; those without a label in order.
    pub arguments: Vec<ArgumentEntry>,
}

/// An argument, or a setting.
#[derive(Clone, Debug, Serialize)]
pub struct ArgumentEntry {
    /// Its name.
    pub name: &'static str,
    /// How it is given: `positional`, `named` or `rest`.
    pub place: &'static str,
    /// What it may be.
    pub kind: String,
    /// The numbers that are accepted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<RangeEntry>,
    /// The words that are accepted.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<&'static str>,
    /// What holds where it is not given; none: it must be given.
    pub default: Option<String>,
    /// What it needs beside it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub needs: Option<&'static str>,
    /// What it is.
    pub doc: &'static str,
}

/// The numbers that are accepted.
#[derive(Clone, Debug, Serialize)]
pub struct RangeEntry {
    /// The least with its unit.
    pub from: String,
    /// Whether the least itself is accepted.
    pub from_included: bool,
    /// The most with its unit; it is accepted.
    pub to: String,
}

/// A word of a closed set.
#[derive(Clone, Debug, Serialize)]
pub struct WordEntry {
    /// The set: `picker`, `colour`, `setting`, `condition` and others.
    pub set: &'static str,
    /// The word.
    pub name: &'static str,
    /// The numbers that may follow it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<RangeEntry>,
    /// What it means.
    pub doc: &'static str,
}

/// Lists everything that the language knows.
pub fn vocabulary() -> Vocabulary {
    let blocks = fab_grammar::blocks().iter();
    Vocabulary {
        format: VOCABULARY_FORMAT,
        keywords: fab_grammar::keywords().to_vec(),
        blocks: blocks
            .map(|block| BlockWords {
                block: block.name(),
                words: block.words().to_vec(),
            })
            .collect(),
        sections: SECTIONS
            .iter()
            .map(|row| SectionEntry {
                word: row.word,
                form: row.form,
                needed: match row.needed {
                    Needed::ByEachTask => "each_task",
                    Needed::ByARun => "a_run",
                    Needed::Never => "none",
                },
                merges: match row.merges {
                    Merges::Whole => "whole",
                    Merges::ByName => "by_name",
                    Merges::Changes => "changes",
                    Merges::Never => "never",
                },
                doc: row.doc,
            })
            .collect(),
        units: UNITS
            .iter()
            .map(|unit| UnitEntry {
                name: unit.name,
                measures: dimension(unit.dimension),
                size: Some(unit.size).filter(|size| !size.is_nan()),
                spellings: unit.spellings,
                doc: unit.doc,
            })
            .collect(),
        calls: calls()
            .map(|(kind, signature)| call(kind, signature))
            .collect(),
        words: words(),
    }
}

/// Returns every call with where it may stand.
fn calls() -> impl Iterator<Item = (&'static str, &'static Signature)> {
    let cloths = CLOTHS.iter().map(|row| ("cloth", &row.signature));
    let cameras = CAMERAS.iter().map(|row| ("camera", &row.signature));
    let points = CLOTH_POINTS
        .iter()
        .map(|row| ("point of the cloth", &row.signature));
    let extractors = EXTRACTORS
        .iter()
        .map(|row| ("extractor", &row.call.signature));
    let marks = MARKS.iter().map(|row| ("mark", &row.signature));
    let measures = MEASURES.iter().map(|row| ("measure", &row.signature));
    cloths
        .chain(cameras)
        .chain(points)
        .chain(extractors)
        .chain(marks)
        .chain(measures)
}

fn words() -> Vec<WordEntry> {
    let sets: [(&'static str, &'static [Word]); 7] = [
        ("picker", Picker::WORDS),
        ("colour", COLORS),
        ("model", MODELS),
        ("picture", PICTURES),
        ("drawing", DRAWINGS),
        ("given", GIVEN),
        ("expectation", EXPECTATIONS),
    ];
    let plain = sets.into_iter().flat_map(|(set, words)| {
        words.iter().map(move |word| WordEntry {
            set,
            name: word.name,
            range: None,
            doc: word.doc,
        })
    });
    let ranged = |set, name, range: &Range, doc| WordEntry {
        set,
        name,
        range: Some(range_of(range)),
        doc,
    };
    let metrics = METRICS
        .iter()
        .map(|row| ranged("goal", row.metric.as_str(), &row.limit, row.doc));
    let settings = SETTINGS.iter().map(|arg| WordEntry {
        set: "setting",
        name: arg.name,
        range: kind(arg.kind).1,
        doc: arg.doc,
    });
    let word = |set, name, doc| WordEntry {
        set,
        name,
        range: None,
        doc,
    };
    let fields = FIELDS.iter().map(|row| word("field", row.name, row.doc));
    let conditions = WORDS.iter().map(|row| word("condition", row.name, row.doc));
    let signs = SIGNS
        .iter()
        .map(|row| word("comparison", row.name, row.doc));
    let numbers = NUMBERS
        .into_iter()
        .map(|row| ranged("verify", row.name, &row.range, row.doc));
    let steps = [ranged(
        "horizon",
        "horizon",
        &STEPS,
        "the most actions of a rollout",
    )];
    let words = plain
        .chain(metrics)
        .chain(settings)
        .chain(fields)
        .chain(conditions);
    words.chain(signs).chain(numbers).chain(steps).collect()
}

fn call(kind: &'static str, signature: &'static Signature) -> CallEntry {
    CallEntry {
        kind,
        name: signature.name,
        form: signature.form(),
        gives: signature.gives,
        doc: signature.doc,
        arguments: signature.args.iter().map(argument).collect(),
    }
}

fn argument(arg: &'static Arg) -> ArgumentEntry {
    let (words_of_kind, range, words) = kind(arg.kind);
    ArgumentEntry {
        name: arg.name,
        place: match arg.place {
            Place::Positional => "positional",
            Place::Named => "named",
            Place::Rest => "rest",
        },
        kind: words_of_kind,
        range,
        words: words.iter().map(|word| word.name).collect(),
        default: arg.default.map(|default| by_default(default, arg.kind)),
        needs: arg.needs.map(|needs| needs.arg),
        doc: arg.doc,
    }
}

/// Says what an argument may be: in words, its range, its closed set.
fn kind(kind: Kind) -> (String, Option<RangeEntry>, &'static [Word]) {
    let of = |words: &str| (words.to_owned(), None, &[][..]);
    let ranged = |words: &str, range: Range| (words.to_owned(), Some(range_of(&range)), &[][..]);
    match kind {
        Kind::Quantity(range) => ranged(range.noun, range),
        Kind::Whole(range) => ranged(&format!("{}, whole", range.noun), range),
        Kind::Odd(range) => ranged(&format!("{}, odd", range.noun), range),
        Kind::Between(range) => ranged(&format!("{} to another", range.noun), range),
        Kind::Word(words) => ("a word".to_owned(), None, words),
        Kind::NameOf(noun, words) => (format!("a {noun}"), None, words),
        Kind::Keypoint(shapes) => {
            let shapes: Vec<&str> = shapes.iter().map(|shape| shape.words()).collect();
            of(&format!("the name of {}", shapes.join(" or ")))
        }
        Kind::DepthLimit(range) => ranged("`depth <` and a limit", range),
        Kind::Pixel => of("a pixel such as `(40px, 52px)`"),
        Kind::Point => of("a point"),
        Kind::Spot => of("a point that is known before the action, or a list of points"),
        Kind::Heading => of("a direction"),
        Kind::DirectionField => of("a field that is a direction"),
        Kind::ClothPoint => of("a point of the cloth"),
        Kind::WordOrFile(words, ending) => (
            format!("a word, or the path of a `{ending}` file"),
            None,
            words,
        ),
    }
}

fn by_default(default: Default, kind: Kind) -> String {
    match default {
        Default::Number(number) => {
            let unit = match kind {
                Kind::Quantity(range) | Kind::Whole(range) | Kind::Odd(range) => range.to.1,
                _ => "",
            };
            format!("{number}{unit}")
        }
        Default::Word(word) => word.to_owned(),
        Default::CameraSide => "the camera's own side".to_owned(),
        Default::Nothing => "nothing".to_owned(),
    }
}

fn range_of(range: &Range) -> RangeEntry {
    let end = |(number, unit): (f64, &str)| format!("{number}{unit}");
    RangeEntry {
        from: end(range.from),
        from_included: range.least == fab_program::vocabulary::Bound::Included,
        to: end(range.to),
    }
}

fn dimension(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Length => "a length on the table",
        Dimension::Pixels => "a length in the picture",
        Dimension::Angle => "an angle",
        Dimension::Number => "a plain number",
    }
}
