//! Finds what an answer says about itself: that it counts in another frame, is only a sample, or is not to be carried out.
//!
//! In: the sentences of an answer, and where its last claim stands. Out: for each kind of field, why its values are not
//! those that the answer means. Each remark is a row of a table.

use super::lexer::{Gap, Kind, Token};
use super::point;
use super::value;
use crate::data::actions::{ActionField, Choices};
use crate::pointing::{Notation, Order};

/// What a remark is about.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum About {
    /// Points, where pixels are asked for.
    Pixels,
    /// Directions.
    Directions,
    /// The whole action.
    Action,
}

impl About {
    /// Returns whether a remark about this concerns a field.
    pub fn concerns(self, field: &ActionField) -> bool {
        match self {
            About::Pixels => field.is_point(),
            About::Directions => matches!(field.choices, Choices::Directions { .. }),
            About::Action => true,
        }
    }
}

/// Where a remark counts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Anywhere,
    /// Only after the values: before them, it is about something else.
    AfterValues,
}

/// A row: a sentence is such a remark if it says one phrase of each group and none of `unless`. Phrases of a group are
/// separated by `|`; signs are words of their own.
struct Row {
    about: About,
    place: Place,
    says: &'static [&'static str],
    unless: &'static str,
    why: &'static str,
}

const NEGATIONS: &str = "not|no|without|isn't|aren't";

const ROWS: [Row; 24] = [
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &["origin", "bottom|lower|center|centre"],
        unless: "not|no|without|top",
        why: "the answer counts from another origin than the top left",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &[
            "y",
            "measured upward|measured upwards|increases upward|increases upwards|increasing upward|increasing upwards|\
             grows upward|grows upwards|points up|pointing up|axis up|upward from|upwards from",
        ],
        unless: NEGATIONS,
        why: "the answer counts y upwards",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &[
            "normalized|normalised",
            "coordinates|coordinate|points|values",
        ],
        unless: NEGATIONS,
        why: "the answer counts in another unit than pixels",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &[
            "percent|percentage|percentages|thousandths",
            "coordinates|coordinate|x|image width|picture width|image size|picture size",
        ],
        unless: NEGATIONS,
        why: "the answer counts in another unit than pixels",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &[
            "1000|999",
            "grid|scale|range",
            "coordinates|coordinate|points|values",
        ],
        unless: "",
        why: "the answer counts on another scale than pixels",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &[
            "not in pixels|not pixels|not px|not in px|not pixel",
            "coordinates|coordinate|points|values|numbers",
        ],
        unless: "",
        why: "the answer counts in another unit than pixels",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &[
            "millimetres|millimeters|mm|centimetres|centimeters|cm|meters|metres",
            "robot|base|world",
            "frame|coordinates",
        ],
        unless: NEGATIONS,
        why: "the answer counts in a frame of the robot",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &[
            "enlarged|cropped|zoomed|upscaled|rescaled|magnified",
            "picture|image|crop|view|version|region",
        ],
        unless: NEGATIONS,
        why: "the answer refers to another picture",
    },
    Row {
        about: About::Pixels,
        place: Place::Anywhere,
        says: &["row , column|row , col|rows , columns|v , u|y before x|y first"],
        unless: NEGATIONS,
        why: "the answer writes its coordinates in another order",
    },
    Row {
        about: About::Directions,
        place: Place::Anywhere,
        says: &[
            "clockwise|cw",
            "angle|angles|direction|directions|degrees|deg|measured|measure|counted",
        ],
        unless: "counter clockwise|counter - clockwise|anti clockwise|anti - clockwise|anticlockwise|\
                 counterclockwise|ccw|not",
        why: "the answer counts angles clockwise",
    },
    Row {
        about: About::Directions,
        place: Place::Anywhere,
        says: &[
            "0 deg|0 degrees|0 °|zero degrees",
            "is up|points up|pointing up|means up|pointing upwards|is straight up|pointing straight up|is north",
        ],
        unless: "not|right",
        why: "the answer counts angles from another side than the right",
    },
    Row {
        about: About::Action,
        place: Place::Anywhere,
        says: &[
            "illustrative|dummy|hypothetical|fictitious|made - up|made up|invented",
            "value|values|number|numbers|coordinates|points|answer|purely|example|below|above",
        ],
        unless: NEGATIONS,
        why: "the answer says that its values are made up",
    },
    Row {
        about: About::Action,
        place: Place::Anywhere,
        says: &[
            "sample values|example values|placeholder values|are placeholders|placeholder coordinates|sample coordinates|\
             example coordinates|only an example|just an example|merely an example|only a template|just a template|\
             only a sample|only an illustration",
        ],
        unless: NEGATIONS,
        why: "the answer says that its values are only an example",
    },
    Row {
        about: About::Action,
        place: Place::Anywhere,
        says: &[
            "would look like|would respond|you would write|format would be|would be formatted|would have the form|\
             structure you need|replace the numbers|replace the values|replace these|replace them|replace those|\
             fill in the actual|fill in your",
        ],
        unless: "",
        why: "the answer says that its values are only an example",
    },
    Row {
        about: About::Action,
        place: Place::Anywhere,
        says: &[
            "if",
            "were at|were in|could see|had the image|were visible",
            "would",
        ],
        unless: "",
        why: "the answer says what would be right in another picture",
    },
    Row {
        about: About::Action,
        place: Place::Anywhere,
        says: &[
            "can't|cannot|unable|don't|can not|couldn't|do not|didn't|not able",
            "see the image|see an image|see any image|see images|see your image|see the picture|see a picture|\
             see any picture|see the photo|see the cloth|view the image|view an image|view images|view the picture|\
             analyze images|analyze the image|access the image|access images|process images|open the image|\
             receive an image|receive the image",
        ],
        unless: "",
        why: "the answer says that it sees no picture",
    },
    Row {
        about: About::Action,
        place: Place::Anywhere,
        says: &[
            "no image|no picture|no photo|without the image|without an image|not given the image|without seeing the image",
            "attached|came|come|provided|received|through|cannot|can't|given|was|available|determine",
        ],
        unless: "",
        why: "the answer says that it sees no picture",
    },
    Row {
        about: About::Action,
        place: Place::Anywhere,
        says: &["not my final|not the final|not final|isn't final"],
        unless: "",
        why: "the answer calls itself a draft",
    },
    Row {
        about: About::Action,
        place: Place::AfterValues,
        says: &[
            "answer is incorrect|answer is wrong|would be wrong|is not correct|isn't correct|is invalid|are wrong|\
             are incorrect|is mistaken|was a mistake",
        ],
        unless: "if|otherwise|previous|earlier|first|else|instead",
        why: "the answer calls itself wrong",
    },
    Row {
        about: About::Action,
        place: Place::AfterValues,
        says: &[
            "do not execute|don't execute|not be executed|do not perform|don't perform|do not carry out|\
             don't carry out|do not run|don't use this|do not use this",
        ],
        unless: "",
        why: "the answer says that it is not to be carried out",
    },
    Row {
        about: About::Action,
        place: Place::AfterValues,
        says: &[
            "disregard|ignore|forget|withdraw|retract",
            "those|these|above|two|both|points|lines|answer|that|it",
        ],
        unless: NEGATIONS,
        why: "the answer takes itself back",
    },
    Row {
        about: About::Action,
        place: Place::AfterValues,
        says: &[
            "exchange|swap|swapped",
            "those|these|above|two|both|points|lines|answer|that|it",
        ],
        unless: NEGATIONS,
        why: "the answer exchanges its values afterwards",
    },
    Row {
        about: About::Action,
        place: Place::AfterValues,
        says: &[
            "add|subtract|multiply|divide|scale|double|doubled|halve|halved|reverse|reversed|flip|flipped|invert|\
             inverted|mirror|mirrored",
            "every x|every y|each x|each y|x value|y value|x values|y values|x coordinate|y coordinate|\
             x coordinates|y coordinates|coordinates|the values|all values|both by|both values|the distance|\
             the direction|the angle|them to|to your resolution",
        ],
        unless: NEGATIONS,
        why: "the answer changes its values afterwards",
    },
    Row {
        about: About::Pixels,
        place: Place::AfterValues,
        says: &[
            "scale them|rescale them|convert them",
            "resolution|pixels|size",
        ],
        unless: NEGATIONS,
        why: "the answer refers to another picture",
    },
];

/// Returns the remarks of an answer: what each is about, and the reason why those values cannot be used.
///
/// - `last_claim`: where the last claim begins.
pub(super) fn of(
    tokens: &[Token<'_>],
    notation: &Notation,
    last_claim: Option<usize>,
) -> Vec<(About, String)> {
    let mut found: Vec<(About, String)> = Vec::new();
    let mut start = 0;
    for index in 0..tokens.len() {
        let goes_on = tokens.get(index + 1).is_some_and(|next| {
            // The last value ends with its line.
            let states_last =
                last_claim.is_some_and(|at| (tokens[start].at..=tokens[index].at).contains(&at));
            let least = if states_last { Gap::Line } else { Gap::Item };
            !value::ends_sentence(tokens, index) && next.gap < least
        });
        if goes_on {
            continue;
        }
        let sentence = &tokens[start..=index];
        start = index + 1;
        let is_after = last_claim.is_some_and(|at| sentence[0].at > at);
        let words = spoken(sentence);
        let rows = ROWS.iter().filter(|row| {
            (row.place == Place::Anywhere || is_after)
                && row.says.iter().all(|group| says(&words, group))
                && !says(&words, row.unless)
        });
        found.extend(rows.map(|row| (row.about, row.why.to_owned())));
        found.extend(another_size(sentence, notation).map(|why| (About::Pixels, why)));
        if !says(&words, NEGATIONS) && another_order(sentence, notation) {
            let why = "the answer writes its coordinates in another order";
            found.push((About::Pixels, why.to_owned()));
        }
    }
    found.retain(|(about, _)| *about != About::Pixels || notation.is_native());
    found
}

/// Writes a sentence in lower case, with blanks around each word and sign.
fn spoken(sentence: &[Token<'_>]) -> String {
    let mut words = String::from(" ");
    for token in sentence {
        match token.kind {
            Kind::Sign(sign) => words.push(sign),
            Kind::Word | Kind::Number => {
                words.push_str(&token.text.to_lowercase().replace('’', "'"));
            }
        }
        words.push(' ');
    }
    words
}

fn says(words: &str, group: &str) -> bool {
    group.split('|').any(|phrase| {
        !phrase.is_empty()
            && words.match_indices(phrase).any(|(at, _)| {
                words[..at].ends_with(' ') && words[at + phrase.len()..].starts_with(' ')
            })
    })
}

/// Returns whether a sentence repeats the format with its coordinates exchanged: `[y, x]`.
fn another_order(sentence: &[Token<'_>], notation: &Notation) -> bool {
    (0..sentence.len()).any(|at| {
        let mut cursor = super::cursor::Cursor {
            tokens: sentence,
            at,
        };
        point::echo(&mut cursor) == Some(Order::Yx) && notation.order() == Order::Xy
    })
}

/// Words between a picture and its size: `the image appears to be 640x480`.
const JOINING: [&str; 14] = [
    "is",
    "of",
    "appears",
    "to",
    "be",
    "a",
    "an",
    "the",
    "size",
    "as",
    "has",
    "resolution",
    "with",
    "uploaded",
];

/// The fewest and the most pixels of a picture's side.
const SIDES: std::ops::RangeInclusive<u32> = 64..=8192;

/// Returns why the points are not in the picture that was sent, if the sentence gives a picture another size.
fn another_size(sentence: &[Token<'_>], notation: &Notation) -> Option<String> {
    let asked = notation.sent_px()?;
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| SIDES.contains(side));
    let is_picture =
        |token: &Token<'_>| token.is_any(&["image", "picture", "photo", "frame", "resolution"]);
    (0..sentence.len().saturating_sub(1)).find_map(|at| {
        let width = side(sentence[at].text)?;
        let joint = &sentence[at + 1];
        // `640x480` and `640 x 480`
        let (height, end) = match joint.text.strip_prefix('x').and_then(side) {
            Some(height) => (height, at + 2),
            None => {
                let joins = joint.is_any(&["x", "by"]) || matches!(joint.kind, Kind::Sign('*' | '×'));
                (side(sentence.get(at + 2).filter(|_| joins)?.text)?, at + 3)
            }
        };
        let named_after = sentence.get(end).is_some_and(is_picture);
        let named_before = sentence[..at]
            .iter()
            .rev()
            .take(8)
            .find(|token| !(token.is_any(&JOINING) || matches!(token.kind, Kind::Sign(','))))
            .is_some_and(is_picture);
        (( named_after || named_before) && [width, height] != asked).then(|| {
            format!("the answer refers to a picture of {width} by {height} pixels, and this one has {} by {}", asked[0], asked[1])
        })
    })
}
