//! Everything that the language knows as one list, for editors and for the tables of the reference.
//!
//! In: the tables. Out: [`Vocabulary`], the rows themselves, which serialize to the JSON of `fabc vocabulary --json`.
//! This module adds nothing of its own.

use super::actions::FIELDS;
use super::annotate::{COLORS, MARKS};
use super::calls::CLOTH_POINTS;
use super::conditions::{SIGNS, WORDS};
use super::goal::{METRICS, STEPS};
use super::material::{self, PROPERTIES};
use super::rehearse::{self, TWINS};
use super::sections::{SECTIONS, Section};
use super::stage::{DRAWINGS, MODELS, PICTURES, SETTINGS};
use super::test::{EXPECTATIONS, GIVEN};
use super::verify::NUMBERS;
use fab_grammar::Block;
use fab_program::measures::MEASURES;
use fab_program::units::{UNITS, Unit};
use fab_program::vocabulary::{Kind, Signature, Word};
use fab_program::{EXTRACTORS, Face, Picker, RehearsalMeasure};
use serde::Serialize;

/// Version of the format of [`Vocabulary`].
pub const VOCABULARY_FORMAT: u32 = 1;

/// Every word of the language.
#[derive(Clone, Debug, Serialize)]
pub struct Vocabulary {
    /// [`VOCABULARY_FORMAT`].
    pub format: u32,
    /// Words that cannot be names.
    pub keywords: &'static [&'static str],
    /// The words that may begin a line, by block; empty if lines begin with names.
    pub blocks: Vec<BlockWords>,
    /// The sections of a task.
    pub sections: &'static [Section],
    /// The units of numbers; a null size depends on the cloth.
    pub units: &'static [Unit],
    /// Everything that is called with arguments.
    pub calls: Vec<CallEntry>,
    /// Words of closed sets, and words followed by a number.
    pub words: Vec<WordEntry>,
}

/// The words of one kind of block.
#[derive(Clone, Debug, Serialize)]
pub struct BlockWords {
    /// The block's keyword; `file` for a whole file.
    pub block: &'static str,
    /// The words that may begin a line in it.
    pub words: &'static [&'static str],
}

/// One form of a call.
#[derive(Clone, Debug, Serialize)]
pub struct CallEntry {
    /// Where it may be used: the word of a section, or `property of a material`, `point of the cloth`, `extractor`,
    /// `mark`, `measure`, `twin`.
    pub kind: &'static str,
    /// How a complete call is written.
    pub form: String,
    /// Its row.
    #[serde(flatten)]
    pub signature: Signature,
}

/// A word that is not a call.
#[derive(Clone, Debug, Serialize)]
pub struct WordEntry {
    /// The set: `picker`, `colour`, `setting`, `condition` and others.
    pub set: &'static str,
    /// The word.
    #[serde(flatten)]
    pub word: Word,
    /// The numbers that may follow it, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<Kind>,
}

/// Lists everything that the language knows.
pub fn vocabulary() -> Vocabulary {
    let words_of = |block: &'static Block| BlockWords {
        block: &block.name,
        words: &block.words,
    };
    Vocabulary {
        format: VOCABULARY_FORMAT,
        keywords: fab_grammar::keywords(),
        blocks: fab_grammar::blocks().iter().map(words_of).collect(),
        sections: SECTIONS,
        units: UNITS,
        calls: calls(),
        words: words(),
    }
}

fn calls() -> Vec<CallEntry> {
    let of = |kind, signature: &Signature| CallEntry {
        kind,
        form: signature.form(),
        signature: *signature,
    };
    let sections = SECTIONS.iter().flat_map(|section| {
        let calls = (section.calls)().into_iter();
        calls.map(move |signature| of(section.word, signature))
    });
    let property = "property of a material";
    let properties = PROPERTIES.iter().map(|row| CallEntry {
        form: material::form(&row.call.signature),
        ..of(property, &row.call.signature)
    });
    let extractors = { EXTRACTORS.iter() }.map(|row| ("extractor", &row.call.signature));
    let points = { CLOTH_POINTS.iter() }.map(|row| ("point of the cloth", &row.signature));
    let marks = MARKS.iter().map(|row| ("mark", &row.signature));
    let measures = MEASURES.iter().map(|row| ("measure", &row.signature));
    let twins = TWINS.iter().map(|row| ("twin", &row.signature));
    let others = points.chain(extractors).chain(marks);
    let others = others.chain(measures).chain(twins);
    let others = others.map(|(kind, signature)| of(kind, signature));
    sections.chain(properties).chain(others).collect()
}

fn words() -> Vec<WordEntry> {
    let of = |set, name, value, doc| WordEntry {
        set,
        word: Word::new(name, doc),
        value,
    };
    let sets: [(_, &[Word]); 9] = [
        ("picker", Picker::WORDS),
        ("colour", COLORS),
        ("face", Face::WORDS),
        ("model", MODELS),
        ("picture", PICTURES),
        ("drawing", DRAWINGS),
        ("given", GIVEN),
        ("expectation", EXPECTATIONS),
        ("measure on a twin", RehearsalMeasure::WORDS),
    ];
    let sets = { sets.into_iter() }
        .flat_map(|(set, list)| list.iter().map(move |it| of(set, it.name, None, it.doc)));
    let number = |range| Some(Kind::Quantity(range));
    let goals = METRICS.iter();
    let goals = goals.map(|it| of("goal", it.metric.as_str(), number(it.limit), it.doc));
    let settings = SETTINGS.iter();
    let settings = settings.map(|it| of("setting", it.name, Some(it.kind), it.doc));
    let fields = FIELDS.iter();
    let fields = fields.map(|it| of("field", it.name, it.range.map(Kind::Quantity), it.doc));
    let conditions = { WORDS.iter() }.map(|it| of("condition", it.name, None, it.doc));
    let signs = { SIGNS.iter() }.map(|it| of("comparison", it.name, None, it.doc));
    let verify = NUMBERS.iter().map(|it| ("verify", it));
    let numbers = verify.chain(rehearse::NUMBERS.iter().map(|it| ("rehearse", it)));
    let numbers = numbers.map(|(set, it)| of(set, it.name, number(it.range), it.doc));
    let steps = "the most actions of a rollout";
    let horizon = of("horizon", "horizon", number(STEPS), steps);
    { sets.chain(goals).chain(settings).chain(fields) }
        .chain(conditions.chain(signs).chain(numbers).chain([horizon]))
        .collect()
}
