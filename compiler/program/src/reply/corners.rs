//! Reads which corner an answer says in words that it picks, and where it says to put it.
//!
//! In: the sentences of an answer. Out: sides of the picture, as angles. Models name the right corner and then give the
//! point of another one, so a value on the other side of the cloth is not what they mean.

use super::cursor::Cursor;
use super::lexer::{Kind, Token};
use super::sentences::{Claim, Claimed};
use super::wordlist::words;
use super::words;
use crate::data::actions::Value;
use std::ops::Range;

/// Verbs for what happens to the picked corner.
const TAKING: &[&str] = words!(
    "pick picks picking picked grasp grasps grasping grasped grab grabs grabbing grabbed take takes taking taken lift lifts
    lifting lifted fold folds folding folded bring brings bringing brought carry carries carrying carried move moves
    moving moved drag drags dragging dragged"
);

/// The same after `is`.
const TAKEN: &[&str] =
    words!("picked grasped grabbed taken lifted folded brought carried moved dragged");

/// What may stand between a verb and its corner.
const BETWEEN: &[&str] =
    words!("the its this up by at hold of cloth's one my your towel's fabric's");

/// What leads to the place.
const LEADING: &[&str] = words!("to onto on over toward towards at");

/// The fewest degrees between a side in words and the side on which a point lies that nobody can mean.
const OPPOSITE_DEG: f64 = 120.0;

/// Returns what a sentence says of the corners that are picked and put down.
///
/// - `sentence`: its tokens' indices.
/// - `pick`, `place`: the two fields, by their index.
pub(super) fn of_sentence(
    tokens: &[Token<'_>],
    sentence: Range<usize>,
    (pick, place): (usize, usize),
) -> Vec<Claim> {
    let within = &tokens[..sentence.end];
    let claim = |field, begin: usize, (deg, end): (f64, usize)| Claim {
        field,
        span: tokens[begin].at..tokens[end - 1].end(),
        claimed: Claimed::Side(deg),
    };
    let mut claims = Vec::new();
    for at in sentence.clone() {
        // `the lower left corner is picked`, `the lower left corner, which I grab`
        let passive = corner(within, at).filter(|(_, end)| {
            let mut behind = Cursor {
                tokens: within,
                at: *end,
            };
            // `corner of the` was read with the side.
            behind.eat_any(&["cloth", "towel", "fabric", "napkin", "shirt"]);
            behind.eat_sign(',');
            let is_active = behind.eat_any(&["which", "that"]) && behind.eat_any(&["i", "we"]);
            let verbs = if is_active { TAKING } else { TAKEN };
            let is_passive = behind.eat_any(&["is", "gets"]);
            behind.eat_any(&["therefore", "thus", "now", "hence", "to"]);
            behind.eat_word("be");
            (is_active || is_passive) && behind.peek().is_some_and(|it| it.is_any(verbs))
        });
        let taken = if tokens[at].is_any(TAKING) {
            let mut cursor = Cursor {
                tokens: within,
                at: at + 1,
            };
            while cursor.eat_any(BETWEEN) {}
            // `I picked the one at the upper left`
            let is_one = cursor.eat_word("one") && cursor.eat_any(&["at", "on", "in"]);
            side(within, cursor.at, is_one)
        } else {
            passive
        };
        let Some(taken) = taken else { continue };
        claims.push(claim(pick, at, taken));
        let put = (taken.1..sentence.end).find_map(|to| {
            let mut cursor = Cursor {
                tokens: within,
                at: to + 1,
            };
            cursor.eat_any(&["the", "its"]);
            corner(within, cursor.at).filter(|_| tokens[to].is_any(LEADING))
        });
        claims.extend(put.map(|put| claim(place, at, put)));
        break;
    }
    claims
}

/// Reads `lower left corner`; its angle from the cloth's middle, degrees, and the token after it.
fn corner(tokens: &[Token<'_>], at: usize) -> Option<(f64, usize)> {
    side(tokens, at, false)
}

/// The same, also without its noun if it is known what stands there.
fn side(tokens: &[Token<'_>], at: usize, is_known: bool) -> Option<(f64, usize)> {
    let mut cursor = Cursor { tokens, at };
    if cursor.peek()?.kind != Kind::Word {
        return None;
    }
    let deg = words::side(&mut cursor)?;
    let is_corner = tokens[at..cursor.at].iter().any(|it| it.is("corner"));
    ((is_corner || is_known) && deg % 90.0 != 0.0).then_some((deg, cursor.at))
}

/// Returns whether a point lies on the other side of the cloth than words say.
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
    let apart = (seen - deg).rem_euclid(360.0);
    own != other && apart.min(360.0 - apart) >= OPPOSITE_DEG
}
