//! Rows of `stage`: the models, settings and pictures that its lines take.

use fab_program::vocabulary::{Arg, Default, Kind, Range, Word};
use fab_program::{Arrow, Layers, Picture, Reasoning, ReasoningLevel, SubgoalStep};

/// The kinds of model, the first word of `model`.
pub(crate) const MODELS: &[Word] = &[
    Word::new("vision", "a model that sees pictures"),
    Word::new("text", "a model that reads only text"),
];

/// The settings after the kind of model, each at most once. Without a setting, the model's own default applies.
pub(crate) const SETTINGS: &[Arg] = &[
    setting(
        "temperature",
        Kind::Quantity(Range::plain("a number", 0.0, 2.0)),
        "sampling temperature; at 0 the likeliest token is always chosen",
    ),
    setting(
        "top_p",
        Kind::Quantity(Range::plain("a fraction", 0.0, 1.0)),
        "nucleus sampling: the probability mass of the likeliest tokens that are sampled from",
    ),
    setting(
        "tokens",
        Kind::Whole(Range::plain("a count", 1.0, 100_000.0)),
        "the maximum length of the answer, in tokens",
    ),
    setting(
        "reasoning",
        Kind::WordOrCount {
            noun: "level of reasoning",
            words: ReasoningLevel::WORDS,
            range: Range::plain("a count", 1.0, Reasoning::MOST_TOKENS as f64),
            unit: Reasoning::UNIT,
        },
        "how much the model thinks before it answers, beside `tokens`",
    ),
    setting(
        "candidates",
        Kind::Whole(Range::plain("a count", 2.0, 16.0)),
        "how many answers are asked for where a `rehearse` chooses among them; needs a temperature above 0",
    ),
];

const fn setting(name: &'static str, kind: Kind, doc: &'static str) -> Arg {
    Arg::named(name, kind, doc).or(Default::Nothing)
}

/// A picture that `show` takes, and what can be drawn on it.
pub(crate) struct PictureRow {
    /// How it is written.
    pub word: Word,
    /// The picture without a drawing.
    pub bare: Picture,
    /// What may follow `with`.
    pub drawings: &'static [Word],
    /// The picture with a drawing.
    pub drawn: Picture,
}

const ARROW: Word = Word::new(
    "arrow",
    "on a subgoal: an arrow from the step's pick to its place",
);
const ANNOTATIONS: Word = Word::new("annotations", "on the scene: the layers of `annotate`");

/// Every picture that `show` takes.
pub(crate) const PICTURE_ROWS: [PictureRow; 3] = [
    subgoal(
        "subgoal(now)",
        SubgoalStep::Now,
        "the cloth before this step, as the subgoals show it",
    ),
    subgoal(
        "subgoal(next)",
        SubgoalStep::Next,
        "the cloth after this step, as the subgoals show it",
    ),
    PictureRow {
        word: Word::new("scene", "what the camera sees now"),
        bare: Picture::Scene {
            layers: Layers::Absent,
        },
        drawings: &[ANNOTATIONS],
        drawn: Picture::Scene {
            layers: Layers::Drawn,
        },
    },
];

const fn subgoal(name: &'static str, which: SubgoalStep, doc: &'static str) -> PictureRow {
    PictureRow {
        word: Word::new(name, doc),
        bare: Picture::Subgoal {
            which,
            arrow: Arrow::Absent,
        },
        drawings: &[ARROW],
        drawn: Picture::Subgoal {
            which,
            arrow: Arrow::Drawn,
        },
    }
}

/// The pictures as words.
pub(crate) const PICTURES: &[Word] = &[
    PICTURE_ROWS[0].word,
    PICTURE_ROWS[1].word,
    PICTURE_ROWS[2].word,
];

/// Everything that may follow `with`.
pub(crate) const DRAWINGS: &[Word] = &[ARROW, ANNOTATIONS];
