//! Finds sentences that put the answer in doubt, withdraw it, or tell somebody to do something else.
//!
//! In: a sentence, and where it stands. Out: why the answer cannot be used. Each clause is read as a statement: who it
//! speaks of, what it says, and whether it denies that. Doubt counts where it is said of the answer, by its author, or
//! of nobody (`a wild guess`); orders count where they are given to whoever carries the answer out. What is said of
//! the cloth and the picture is free.

mod clause;
mod explained;
mod known;
mod sayings;
mod vocabulary;
mod weighing;

use super::lexer::{Gap, Kind, Token};
use super::wordlist::{self, words};
use clause::{CONDITIONAL, Clause, DOUBTED, HALTED, OTHERWISE, Subject, refers_forward};
pub(super) use clause::{Place, Prose};
use vocabulary::*;

const STRANGE: &str = "the answer says something beside its values that is not understood";

/// The language of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Language {
    English,
    /// Another one, of which only the words of doubt are known.
    Other,
}

/// What stands before a reason.
const REASONS: &[&str] = words!("reason reasoning rationale explanation why");

/// The fewest words of an answer that explains itself, those of its values included.
pub(super) const MIN_EXPLANATION: usize = 30;

/// The fewest words of an explanation in what an object says beside its fields, keys of remarks included.
pub(super) const MIN_BESIDE: usize = 15;

/// Returns how much an answer of these tokens says.
///
/// - `least`: the fewest words of an explanation.
pub(super) fn prose(tokens: &[Token<'_>], least: usize) -> Prose {
    let words = tokens.iter().filter(|it| it.kind == Kind::Word);
    match words.take(least).count() < least {
        true => Prose::Remark,
        false => Prose::Explanation,
    }
}

/// Returns where `Reason:` first begins a line, in bytes; what stands behind it is an explanation, however short.
pub(super) fn reasons_begin(tokens: &[Token<'_>]) -> Option<usize> {
    let label = tokens.windows(2).find(|pair| {
        pair[0].gap >= Gap::Line
            && pair[0].is_any(REASONS)
            && matches!(pair[1].kind, Kind::Sign(':' | '-' | '–'))
    });
    label.map(|pair| pair[0].at)
}

/// Returns the language of an answer that consists of these sentences.
pub(super) fn language(sentences: &[&[Token<'_>]]) -> Language {
    let is_foreign = |sentence: &&[Token<'_>]| {
        let text = plain(sentence);
        known::is_foreign(&text.split_whitespace().collect::<Vec<_>>())
    };
    match sentences.iter().any(is_foreign) {
        true => Language::Other,
        false => Language::English,
    }
}

/// Returns why a sentence puts the answer in doubt, if it does.
pub(super) fn cast_by(
    sentence: &[Token<'_>],
    place: Place,
    language: Language,
    prose: Prose,
) -> Option<&'static str> {
    let text = plain(sentence);
    let words: Vec<&str> = text.split_whitespace().collect();
    let said = format!(" {} ", words.join(" "));
    if let Some(why) = whole(sentence, &words, &said, place, prose) {
        return Some(why);
    }
    let clauses = clauses(&words, place, prose);
    if prose == Prose::Explanation {
        return explained::why(&clauses);
    }
    let is_of_answer = |clause: &Clause<'_>| {
        // `Here is a breakdown of the scene`
        if words.starts_with(&["here"]) && !words.iter().any(|it| PARTS.contains(it)) {
            return false;
        }
        clause.subject == Subject::Answer && refers_forward(clause.named())
    };
    // A member of an object with one or two words is a name or a level.
    let may_be_strange = match place {
        Place::Before => clauses.iter().any(is_of_answer),
        Place::Beside => words.len() > 4,
        Place::After => true,
    };
    let is_courtesy = COURTESIES.iter().any(|it| words.starts_with(it));
    let has_strange_word = || {
        let mut goes_on = false;
        clauses.iter().any(|clause| {
            // `The band comes from the lamp and can be neglected`
            let is_elided = clause.joint == "and"
                && clause
                    .words
                    .first()
                    .is_some_and(|it| MODALS.contains(it) || BE.contains(it) || it.ends_with('s'));
            // `The sleeve would cover the placket, contrary to the picture`
            let is_apposed = clause.joint.is_empty() && clause.is_mere_phrase();
            goes_on = clause.describes_the_world() || goes_on && (is_elided || is_apposed);
            !goes_on && known::has_strange_word(clause.words)
        })
    };
    let is_strange = language == Language::English && may_be_strange && !is_courtesy;
    let doubted = clauses.iter().find_map(Clause::doubt);
    doubted
        .or_else(|| {
            let saying = clauses.iter().find_map(sayings::why);
            // `To sum up: pick (10, 20), pull it to the left` states values, which are compared.
            let restates = words.contains(&"pick") && words.contains(&"@");
            // `Reason: the corner is folded in, pull it out`
            let gives_reason = words.get(1) == Some(&":") && REASONS.contains(&words[0]);
            saying.filter(|why| {
                *why != OTHERWISE || !(restates || gives_reason && place == Place::After)
            })
        })
        .or_else(|| clauses.iter().find_map(sayings::plainly))
        .or_else(|| weighing::favours_another(&clauses))
        .or_else(|| (is_strange && has_strange_word()).then_some(STRANGE))
}

/// Cuts a sentence at its signs and conjunctions.
fn clauses<'a>(words: &'a [&'a str], place: Place, prose: Prose) -> Vec<Clause<'a>> {
    let mut found: Vec<Clause<'_>> = Vec::new();
    let (mut start, mut joint, mut is_sequel) = (0, "", false);
    for end in 0..=words.len() {
        let word = words.get(end).copied().unwrap_or(".");
        let is_sign = word != "@" && word.len() <= 3 && !word.starts_with(char::is_alphanumeric);
        let is_not_yet = word == "yet" && end > 0 && words[end - 1] == "not";
        if !(is_sign || EXPLAINING.contains(&word) || JOINING.contains(&word)) || is_not_yet {
            continue;
        }
        let clause = Clause::new(&words[start..end], joint, (place, prose), is_sequel);
        is_sequel |= clause.is_sequel;
        found.push(clause);
        // `Reason: …`; a longer clause before a colon is no label.
        let is_label = word == ":" && end - start < 3;
        (start, joint) = (end + 1, if is_sign && !is_label { "" } else { word });
    }
    found
}

/// Returns why a sentence as a whole puts the answer in doubt.
fn whole(
    sentence: &[Token<'_>],
    words: &[&str],
    said: &str,
    place: Place,
    prose: Prose,
) -> Option<&'static str> {
    let is_remark = prose == Prose::Remark;
    let first = words.first()?;
    let says = |sayings: &str| wordlist::says(said, sayings);
    if place == Place::Before {
        let announces = words.last() == Some(&":");
        // `Were the sleeve flat, I would say:`
        let is_heading = !words
            .last()
            .is_some_and(|it| words!(". ! ? ; …").contains(it));
        if is_heading && matches!(*first, "were" | "had") && words.get(1) != Some(&"to") {
            return Some(CONDITIONAL);
        }
        // `I can offer no better than chance here:`
        let denies = words.rsplit(|it| *it == ",").next().is_some_and(|last| {
            last.iter().any(|it| NEGATIONS.contains(it))
                && !last
                    .windows(2)
                    .any(|near| near[0] == "not" && matches!(near[1], "just" | "only"))
                && (words!("i we here you").iter().any(|it| last.contains(it))
                    || last.contains(&"yet") && (PARTS.contains(first) || PRONOUNS.contains(first)))
        });
        let is_elsewhere = words.contains(&"memory")
            || words.windows(3).any(|near| {
                words!("these they those values points numbers").contains(&near[0])
                    && BE.contains(&near[1])
                    && words!("on from of for").contains(&near[2])
            });
        let is_doubtful = announces
            && words
                .iter()
                .any(|it| DOUBTS.contains(it) && !WEAK_DOUBTS.contains(it))
            && !words.iter().any(|it| NEGATIONS.contains(it))
            // `A tempting but mistaken choice`
            && words.iter().rposition(|it| *it == "but").is_none_or(|but| {
                words[but..]
                    .iter()
                    .any(|it| DOUBTS.contains(it) && !WEAK_DOUBTS.contains(it))
            });
        // `What a bad answer looks like:`
        let is_bad = announces
            && words
                .windows(2)
                .any(|pair| DOUBTS.contains(&pair[0]) && ANSWERS.contains(&pair[1]))
            && !words.iter().any(|it| {
                NEGATIONS.contains(it)
                    || words!("i we instead was were but avoid avoids rather replaces").contains(it)
            });
        let is_formal = is_doubtful
            || announces
                && (words!("example sample template").contains(first)
                    || words!("just only merely purely").contains(first)
                        && words!("to for").contains(&words[1])
                    || *first == "not" && !words.contains(&"but"));
        // `Rough draft, not to be executed:`
        let forbids = announces
            && says(
                "not to be|not for execution|not for use|not intended|not meant|not for this|before this one|after this one",
            );
        if announces
            && said.contains(" would ")
            && words!("for in on with").contains(first)
            && words!("a an another").contains(&words[1])
        {
            return Some(CONDITIONAL);
        }
        // `I mixed up x and y in the lines below:`
        let confuses = announces
            && words.iter().any(|it| {
                words!("mixed misread misjudged mistyped erred confused transposed").contains(it)
            });
        let dismisses = confuses
            || is_formal
            || forbids
            || is_bad
            || announces
                && words
                    .iter()
                    .any(|it| words!("delete ignore discard disregard skip").contains(it));
        if dismisses || introduces_another(words) || announces && (denies || is_elsewhere) {
            return Some(DOUBTED);
        }
        let idle = words.windows(2).any(|pair| {
            words!("nothing anything").contains(&pair[0])
                && words!("should needs must").contains(&pair[1])
        });
        let from = words.windows(4).any(|near| {
            words!("from for").contains(&near[0])
                && near[1..]
                    .iter()
                    .any(|it| words!("different another old separate unrelated").contains(it))
        });
        let is_label = words!("a an values numbers").contains(first);
        if idle && !said.contains(" else ") || announces && from && is_label {
            return Some(HALTED);
        }
        let hedges = announces
            && words!("take treat regard consider read")
                .iter()
                .any(|verb| {
                    words!("these this the")
                        .iter()
                        .any(|it| said.contains(&format!(" {verb} {it} ")))
                })
            && said.contains(" as ");
        let is_formality = (is_remark || announces) && says(FORMALITIES);
        return (hedges || is_formality || reports(words)).then_some(DOUBTED);
    }
    let is_foreign = words
        .iter()
        .any(|it| FOREIGN.iter().any(|stem| it.starts_with(stem)))
        || sentence
            .iter()
            .any(|it| FOREIGN_WITHIN.iter().any(|part| it.text.contains(part)))
        || says(FOREIGN_SAYINGS);
    let hangs =
        words.starts_with(&["it", "is"]) && said.contains(" whether ") && place == Place::After;
    let is_vague = is_remark && (hangs || place == Place::After && words.contains(&"±"));
    if is_foreign
        || is_vague
        || said.contains(" in doubt ")
        || is_remark && place == Place::After && says(CONDITIONS)
    {
        return Some(DOUBTED);
    }
    let turns = place != Place::Before && says("no , actually|no , wait|wait , no|no no");
    if turns {
        return Some(DOUBTED);
    }
    // `I would pick the collar if it were offered`
    let is_past = prose == Prose::Explanation && said.contains(" i would have ");
    let wishes = said.contains(" i would ")
        && !is_past
        && words.windows(3).any(|near| {
            near[0] == "if" && near[1..].iter().any(|it| words!("were had").contains(it))
        });
    if wishes {
        return Some(CONDITIONAL);
    }
    if place == Place::After && words.starts_with(&["if", "i"]) && said.contains(" i would ") {
        return Some(OTHERWISE);
    }
    if says(UNCERTAIN) {
        return Some(DOUBTED);
    }
    // `too blurry to tell`
    let blurs = words.iter().enumerate().any(|(at, it)| {
        *it == "too"
            && words[at..]
                .iter()
                .take(5)
                .any(|it| words!("tell judge say decide know determine be").contains(it))
    });
    let is_done = words.iter().enumerate().any(|(at, it)| {
        *it == "already"
            && words.get(at + 1).is_some_and(|it| {
                words!("matches done complete completed finished solved reached").contains(it)
            })
            && words[..at].iter().rev().take(3).any(|it| {
                words!("cloth towel garment shirt task goal subgoal target job everything fabric")
                    .contains(it)
            })
    });
    if is_remark && blurs || is_done {
        return Some(DOUBTED);
    }
    if is_remark && place == Place::After {
        let corrects =
            words.starts_with(&["no", ","]) && !words[1..].iter().any(|it| NEGATIONS.contains(it));
        let sees_other = words.starts_with(&["i", "see"]) && words.contains(&"not");
        if corrects || sees_other || words!("perhaps maybe possibly").contains(first) {
            return Some(DOUBTED);
        }
        if DISCLOSING.iter().any(|it| {
            said.strip_prefix(' ')
                .is_some_and(|it2| it2.starts_with(it) && it2[it.len()..].starts_with(' '))
        }) {
            return Some(DOUBTED);
        }
        let offers_other = said.starts_with(" should you ")
            && words
                .iter()
                .any(|it| words!("use try take prefer").contains(it));
        if offers_other {
            return Some(CONDITIONAL);
        }
    }
    None
}

/// Returns whether the line above the values says that they are not for this cloth, or not for now.
fn introduces_another(words: &[&str]) -> bool {
    let (Some(first), Some(last)) = (words.first(), words.last()) else {
        return false;
    };
    if words!(". ! ? ; …").contains(last) {
        return false;
    }
    // `Based on the corners that were detected, here is the action:`
    let announced = words.rsplit(|it| *it == ",").next().unwrap_or_default();
    let is_condition =
        words!("if unless once until were had should assuming supposing in when provided")
            .contains(first);
    let is_later = |word: &&str| {
        LATER.contains(word)
            && (is_condition
                || !matches!(announced, ["here", "is" | "are", ..])
                || announced.contains(word))
    };
    let is_own = words.iter().any(|it| words!("i we").contains(it));
    let begins = words!("if unless once until had draft").contains(first)
        && !words
            .iter()
            .any(|it| words!("more again to").contains(it) && *first != "draft");
    begins
        || words.windows(2).any(|pair| {
            (OTHER.contains(&pair[0]) && OTHERS.contains(&pair[1]))
                || (is_later(&pair[1])
                    // `The places where the hem could be pinched:`
                    && (!words!("could might").contains(&pair[1])
                        || words.iter().any(|it| {
                            ANSWERS.contains(it) || words!("points numbers coordinates").contains(it)
                        }))
                    && *first != "as"
                    && !words!("you it what").contains(&pair[0]))
                || (PEOPLE.contains(&pair[0]) && pair[1] == "used")
                || (pair[1] == "would"
                    && !is_own
                    && !words!("it this that").contains(&pair[0])
                    && !words.contains(&"my"))
        })
}

/// Returns whether the line above the values says that somebody else, or an earlier step, has stated them.
fn reports(words: &[&str]) -> bool {
    let last = words.last().copied().unwrap_or_default();
    let is_of_now = words
        .iter()
        .any(|it| words!("i we my now so therefore instead instruction next").contains(it));
    // `Two steps ago my answer was:`
    if last == ":"
        && words.contains(&"ago")
        && words.iter().any(|it| words!("was were did").contains(it))
    {
        return true;
    }
    if words!(". ! ? ; …").contains(&last)
        || is_of_now && words.first() != Some(&"my")
        || words.starts_with(&["as"])
    {
        return false;
    }
    let is_other = |it: &str| {
        PEOPLE.contains(&it)
            || AGENTS.contains(&it) && !words!("you hand one").contains(&it)
            || REPORTERS.contains(&it)
    };
    // `The foreman told the robot:`
    let begins = matches!(words, ["the" | "a" | "an" | "another" | "our", _, verb, ..]
        if words!("told wrote said did used executed performed tried ran").contains(verb));
    let stated = words.iter().position(|it| is_other(it)).is_some_and(|at| {
        let mut behind = words[at + 1..].iter().take(3);
        behind.any(|it| REPORTING.contains(it))
    });
    let was = words!("was were did").contains(&words[words.len().saturating_sub(2)])
        && words
            .iter()
            .any(|it| words!("step turn move action answer round log").contains(it));
    stated || begins || was
}

/// Writes a sentence in lower case, with its contractions written out.
fn plain(sentence: &[Token<'_>]) -> String {
    const SHORT: [(&str, &str); 8] = [
        ("n't", " not"),
        ("'m", " am"),
        ("'re", " are"),
        ("'ve", " have"),
        ("'ll", " will"),
        ("'d", " would"),
        ("'s", " is"),
        ("cannot", "can not"),
    ];
    let mut text = String::new();
    let mut skipped = 0;
    for (at, token) in sentence.iter().enumerate() {
        if at < skipped {
            continue;
        }
        let number = |at: usize| sentence.get(at).is_some_and(|it| it.kind == Kind::Number);
        let sign = |at: usize, sign: char| sentence.get(at).is_some_and(|it| it.is_sign(sign));
        let is_point = sign(at, '(')
            && number(at + 1)
            && sign(at + 2, ',')
            && number(at + 3)
            && sign(at + 4, ')');
        if is_point {
            skipped = at + 5;
            // `The pick point (10, 20) lies`
            let is_noun = at > 1 && sentence[at - 2].is_any(ARTICLES);
            let is_named = at > 0
                && (sentence[at - 1].is_any(&["point", "corner"])
                    || is_noun && sentence[at - 1].is_any(PARTS));
            text.push_str(if is_named { "" } else { " @" });
            continue;
        }
        let is_hyphen = token.is_sign('-') && token.gap == Gap::None;
        match token.kind {
            _ if is_hyphen => {}
            Kind::Sign(sign) => text.extend([' ', sign]),
            Kind::Word | Kind::Number => {
                let word = token.text.to_lowercase().replace('’', "'");
                let word = match word.as_str() {
                    "won't" => "will not".to_owned(),
                    "can't" => "can not".to_owned(),
                    "let's" => "let us".to_owned(),
                    _ => SHORT
                        .iter()
                        .find_map(|(short, long)| {
                            word.strip_suffix(short).map(|stem| format!("{stem}{long}"))
                        })
                        .unwrap_or(word),
                };
                text.push(' ');
                text.push_str(&word);
            }
        }
    }
    text
}
