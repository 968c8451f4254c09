//! Reads which corner an answer says in words that it picks, and where it says to put it.
//!
//! In: the sentences of an answer. Out: sides of the picture, as angles. Models name the right corner and then give the
//! point of another one, so a value on the other side of the other point is not what they mean.

use super::claim::{Claim, Claimed};
use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, Token};
use super::point::{self, Brackets, PointFound};
use super::value;
use super::wordlist::{UNREAL, words};
use super::words;
use crate::data::actions::Value;
use crate::pointing::Notation;
use std::ops::Range;

/// Verbs for what happens to the picked corner.
const TAKING: &[&str] = words!(
    "pick picks picking picked grip grips gripping grasp grasps grasping grasped grab grabs grabbing grabbed take takes taking taken lift lifts
    lifting lifted fold folds folding folded bring brings bringing brought carry carries carrying carried move moves
    moving moved drag drags dragging dragged pull pulls pulling"
);

/// The same after `is`, where it tells of no earlier step: `is folded` may.
const TAKEN: &[&str] =
    words!("picked gripped grasped grabbed taken lifted brought carried dragged");

/// The same after `is therefore`.
const NOW_TAKEN: &[&str] =
    words!("picked grasped grabbed taken lifted folded brought carried moved dragged");

/// The same after `is to be`, `has to be` and `must be`.
const TO_BE_TAKEN: &[&str] = words!(
    "picked grasped grabbed taken lifted folded brought carried moved dragged laid put placed"
);

/// What an action is drawn as, if its ends are named: `the arrow starts at the lower right corner`.
const DRAWN: &[&str] = words!("arrow motion movement");

/// The end of an arrow that is picked: `its tail lies at the lower right corner`.
const TAILS: &[&str] = words!("tail ring");

/// The most tokens back from `It starts at …` to what it is.
const MAX_BACK: usize = 30;

/// The most tokens from an arrow's end to its verb: `the ring of the arrow marks`.
const MAX_TO_TAIL: usize = 4;

/// What may stand before a verb that is an action of the answer: `I`, `the robot`; otherwise it may be a noun.
const ACTING: &[&str] = words!(
    "i i'd i'll we we'd we'll let's to and robot arm gripper it therefore so must should will would"
);

/// What makes `at` lead to the place: `let go at the upper left corner`.
const RELEASING: &[&str] = words!("go released releases placed dropped down ends ending");

/// What makes the next word no lead to a place: `closest to the upper left corner`.
const COMPARING: &[&str] =
    words!("closest close next nearest near opposite similar belongs equal parallel");

/// Verbs after `I` for what is picked, unless it is chosen `as` something.
const CORNER_CHOSEN: &[&str] = words!("choose chose select selected");

/// Words for where the motion ends, before which `I chose` speaks of the place.
const ENDING: &[&str] = words!(
    "place target destination landing lands land drop go goes end ends arrowhead head where final release released"
);

/// What may stand between a verb and its corner.
const BETWEEN: &[&str] =
    words!("the its this up by at on hold of cloth cloth's fabric towel my your towel's fabric's");

/// What leads to the place.
const LEADING: &[&str] = words!("to onto on over toward towards");

/// The fewest degrees between a side in words and the side on which a point lies, or another side, that nobody can mean.
/// In a fold along a diagonal, the corner next to the one that is meant lies 81 degrees off or more, if the cloth's sides
/// are no more than 4:3.
const APART_DEG: f64 = 80.0;

/// The same for the tips of a cloth that lies on one.
const TIP_APART_DEG: f64 = 120.0;

/// Nouns for what is taken, where no corner is named.
const THINGS: &[&str] = words!("corner flap tip edge hem rim");

/// Returns what a sentence says of the corners that are picked and put down, with the points that stand beside them.
///
/// - `sentence`: its tokens' indices.
/// - `pick`, `place`: the fields, by their index.
pub(super) fn of_sentence(
    tokens: &[Token<'_>],
    sentence: Range<usize>,
    (pick, place): (usize, Option<usize>),
    notation: &Notation,
) -> Vec<Claim> {
    let within = &tokens[..sentence.end];
    let mut claims = Vec::new();
    let mut add = |field: usize, begin: usize, corner: Corner| {
        let claim = |end: usize, claimed| {
            Claim::new(field, tokens[begin].at..tokens[end - 1].end(), claimed)
        };
        if let (Some(deg), Some(_)) = (corner.deg, place) {
            claims.push(claim(corner.end, Claimed::Side(deg)));
        }
        let mut cursor = Cursor::at(within, corner.end);
        cursor.eat_sign(',');
        let leads = cursor.eat_word("at") || corner.deg.is_some();
        if let PointFound::Pixel(pixel, note) = point::read(&mut cursor, notation, Brackets::Needed)
            && leads
        {
            claims.push(claim(cursor.at, Claimed::Value(Value::Point(pixel), note)));
        }
    };
    for at in sentence.clone() {
        // `under the fold at (10, 20)`, `the finished fold of the upper left corner`
        let is_act = tokens[at].is_any(TAKING)
            && (at == sentence.start
                || tokens[at].gap >= Gap::Line
                || tokens[at - 1].kind != Kind::Word && tokens[at - 1].kind != Kind::Number
                || tokens[at - 1].is_any(ACTING)
                || at > sentence.start + 1
                    && tokens[at - 1].is("step")
                    && tokens[at - 2].is_any(&["this", "the"]));
        let is_tail = tokens[at].is_any(&["is", "lies", "sits", "marks"])
            && is_of_tail(&tokens[sentence.start..at]);
        let begins = tokens[at].is_any(&["starts", "begins"]) && is_drawn(tokens, at) || is_tail;
        // `the pick point is the lower left corner`
        let is_point = tokens[at].is_any(&["is", "lies"])
            && at >= sentence.start + 2
            && tokens[at - 1].is("point")
            && tokens[at - 2].is_any(&["pick", "grasp"]);
        // `Where should it go? I chose the lower left corner.`
        let is_asked = sentence.start > 0 && tokens[sentence.start - 1].is_sign('?');
        let said = match is_asked {
            true => sentence.start.saturating_sub(MAX_BACK)..at,
            false => sentence.start..at,
        };
        let chooses = tokens[at].is_any(CORNER_CHOSEN)
            && at > sentence.start
            && tokens[at - 1].is_any(&["i", "we"])
            && !tokens[said].iter().any(|it| it.is_any(ENDING));
        let taken = match is_act || chooses || begins || is_point {
            true => taken(Cursor::at(within, at + 1)),
            false => corner(within, at)
                .filter(|corner| is_taken(Cursor::at(within, corner.end), notation)),
        };
        // The tail of an arrow is seen roughly, so only a corner's name counts.
        let is_told = |it: &Corner| {
            // `I chose the lower left corner as the target`
            let next = within.get(it.end);
            let is_use = chooses
                && next.is_some_and(|next| {
                    next.is_any(&["as", "for", "to", "first", "initially", "at"])
                });
            !is_use && (it.deg.is_some() || !(begins || is_point || chooses))
        };
        let Some(taken) = taken.filter(is_told) else {
            continue;
        };
        add(pick, at, taken);
        let put = (taken.end..sentence.end).find_map(|to| {
            let mut cursor = Cursor::at(within, to + 1);
            cursor.eat_any(&["the", "its"]);
            let is_lead = tokens[to].is_any(LEADING) && !tokens[to - 1].is_any(COMPARING)
                || tokens[to].is("at")
                    && (tokens[to - 1].is_any(RELEASING)
                        || to > 2 && tokens[to - 3].is("go") && tokens[to - 1].is("it"));
            corner(within, cursor.at).filter(|_| is_lead)
        });
        if let (Some(put), Some(place)) = (put, place) {
            add(place, at, put);
        }
        break;
    }
    claims
}

/// Returns whether the subject that ends here is the tail of an arrow: `the ring of the arrow`.
fn is_of_tail(before: &[Token<'_>]) -> bool {
    let subject = before.iter().rev().take(MAX_TO_TAIL);
    let mut words =
        subject.take_while(|it| it.kind == Kind::Word && !it.is_any(&["head", "arrowhead", "tip"]));
    words.any(|it| it.is_any(TAILS))
}

/// Returns whether a verb tells of the arrow or the motion of the answer, perhaps as `It`.
fn is_drawn(tokens: &[Token<'_>], verb: usize) -> bool {
    let before = &tokens[verb.saturating_sub(MAX_BACK)..verb];
    let last = before.last();
    let is_it = last.is_some_and(|it| it.is("it")) && before.iter().any(|it| it.is_any(DRAWN));
    is_it || last.is_some_and(|it| it.is_any(DRAWN))
}

/// A corner in words.
#[derive(Clone, Copy)]
struct Corner {
    /// Its side of the picture, degrees; none if no side is named.
    deg: Option<f64>,
    /// The token after it.
    end: usize,
}

/// Reads what follows a verb that takes something: `the lower left corner`, `the one at the upper left`.
fn taken(mut cursor: Cursor<'_, '_>) -> Option<Corner> {
    while cursor.eat_any(BETWEEN) {}
    let is_one = cursor.eat_word("one") && cursor.eat_any(&["at", "on", "in"]);
    side(cursor.tokens, cursor.at, is_one).or_else(|| {
        let is_named = cursor.eat_any(THINGS);
        let mut behind = cursor;
        let of_corner = is_named && behind.eat_any(&["at", "of"]) && {
            behind.eat_any(&["the", "its"]);
            true
        };
        if of_corner && let Some(corner) = corner(cursor.tokens, behind.at) {
            return Some(corner);
        }
        let is_thing = is_named || cursor.tokens[cursor.at - 1].is("at");
        cursor.at -= usize::from(cursor.tokens[cursor.at - 1].is("at"));
        is_thing.then_some(Corner {
            deg: None,
            end: cursor.at,
        })
    })
}

/// Returns whether a corner is said to be taken: `is picked`, `, which I grab`.
fn is_taken(mut behind: Cursor<'_, '_>, notation: &Notation) -> bool {
    // `corner of the` was read with the side.
    behind.eat_words("of the");
    behind.eat_any(&["cloth", "towel", "fabric", "napkin", "shirt", "diamond"]);
    // `the top left corner (41, 41) is gripped`, `the top left corner at (41, 41) is taken`
    behind.eat_word("at");
    let _ = point::read(&mut behind, notation, Brackets::Needed);
    behind.eat_sign(',');
    let is_active = behind.eat_any(&["which", "that"]) && behind.eat_any(&["i", "we"]);
    // `is to be`, `has to be`, `must be`, `asks for the corner to be`
    let mut duty = behind;
    let is_modal = duty.eat_any(&["must", "should"]);
    duty.eat_any(&["is", "has", "needs"]);
    let is_duty = (is_modal || duty.eat_word("to")) && duty.eat_word("be");
    if is_duty {
        behind = duty;
    }
    let is_passive = is_duty || behind.eat_any(&["is", "gets"]);
    let is_now = behind.eat_any(&["therefore", "thus", "now", "hence"]);
    let verbs = match () {
        () if is_active => TAKING,
        () if is_duty => TO_BE_TAKEN,
        () if is_now => NOW_TAKEN,
        () => TAKEN,
    };
    (is_active || is_passive) && behind.peek().is_some_and(|it| it.is_any(verbs))
}

/// Reads `lower left corner` and `corner at the lower left`.
fn corner(tokens: &[Token<'_>], at: usize) -> Option<Corner> {
    let mut cursor = Cursor::at(tokens, at);
    let is_behind = cursor.eat_word("corner") && cursor.eat_any(&["at", "in", "on"]);
    cursor.eat_word("the");
    match is_behind {
        true => side(tokens, cursor.at, true),
        false => side(tokens, at, false),
    }
}

/// The same, also without its noun if it is known what stands there.
fn side(tokens: &[Token<'_>], at: usize, is_known: bool) -> Option<Corner> {
    let mut cursor = Cursor::at(tokens, at);
    if cursor.peek()?.kind != Kind::Word {
        return None;
    }
    let deg = words::side(&mut cursor)?;
    let read = &tokens[at..cursor.at];
    let is_corner = read.iter().any(|it| it.is("corner"));
    // `pull the cloth to the upper left corner`
    let leads = read.iter().any(|it| it.is_any(LEADING));
    // The cloth may lie on its tip: `the left tip of the diamond`.
    let is_tip = deg % 90.0 == 0.0 && cursor.eat_word("tip");
    (!leads && (is_tip || (is_corner || is_known) && deg % 90.0 != 0.0)).then_some(Corner {
        deg: Some(deg),
        end: cursor.at,
    })
}

/// Returns whether the corners that one text takes are all others than those that another text takes.
pub(super) fn differ(one: &str, other: &str) -> bool {
    let sides = |text: &str| {
        let tokens = lexer::tokens(text);
        let mut sides = Vec::new();
        for sentence in value::sentences(&tokens) {
            let found = of_sentence(&tokens, sentence.clone(), (0, Some(1)), &Notation::pixels());
            let end = found.iter().map(|claim| claim.span.end).max();
            let is_unreal = tokens[sentence].iter().any(|it| {
                it.is_any(UNREAL) && end.is_some_and(|end| it.at < end) || it.is("afterwards")
            });
            let found = found.iter().filter(|_| !is_unreal);
            sides.extend(found.filter_map(|claim| match claim.claimed {
                Claimed::Side(deg) if claim.field == 0 => Some(deg),
                _ => None,
            }));
        }
        sides
    };
    let (one, other) = (sides(one), sides(other));
    let is_apart = |side: &f64| {
        other
            .iter()
            .all(|other| words::apart_deg(*side, *other) >= APART_DEG)
    };
    !one.is_empty() && !other.is_empty() && one.iter().all(is_apart)
}

/// Returns whether a point lies on the other side of the other point than words say.
///
/// - `own`: the point that the words describe; `other`: the other end of the motion.
pub(super) fn contradicts(deg: f64, own: &Value, other: &Value) -> bool {
    let (Value::Point(own), Value::Point(other)) = (own, other) else {
        return false;
    };
    let (right, down) = (
        f64::from(own.u) - f64::from(other.u),
        f64::from(own.v) - f64::from(other.v),
    );
    let seen = (-down).atan2(right).to_degrees();
    let apart = match deg % 90.0 == 0.0 {
        // A tip may be the next one in a fold along a side.
        true => TIP_APART_DEG,
        false => APART_DEG,
    };
    own != other && words::apart_deg(seen, deg) >= apart
}
