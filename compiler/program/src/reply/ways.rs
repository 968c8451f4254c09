//! Tells which lines are about one of several ways to act: `Option A: …`.
//!
//! In: a line of an answer. Out: whether it tells a way, and whether it chooses it.

use super::wordlist::{is_any, words};

/// Words with a number or a letter behind them that begin a line about one of several ways to act.
const WAYS: &[&str] = words!("option candidate possibility idea alternative");

/// Words in such a line that may choose what it says.
const WAY_CHOSEN: &[&str] = words!(
    "best better choose chosen chose choosing select selected selecting prefer preferred recommended recommend winner
    wins winning go going use taken final answer yes ✅ ✓ ✔ ⭐"
);

/// Returns whether an answer tells ways to act, and chooses none of them where it tells them.
pub(super) fn are_weighed(reply: &str) -> bool {
    let mut ways = reply.lines().filter(|line| is_way(line)).peekable();
    ways.peek().is_some() && !ways.any(chooses)
}

/// Returns whether a line tells one of several ways to act: `Option A: corner (10, 20), 45 deg.`
pub(super) fn is_way(line: &str) -> bool {
    let is_mark = |letter: char| matches!(letter, '-' | '*' | '+' | '#' | '>' | '_' | ' ' | '•');
    let line = line.trim_start_matches(is_mark);
    let Some((word, rest)) = line.split_once(' ') else {
        return false;
    };
    let mut rest = rest.trim_start().chars();
    let is_label = { rest.next() }.is_some_and(|it| it.is_ascii_digit() || it.is_ascii_uppercase());
    let rest = rest.as_str().trim_start_matches(['*', '_', ' ']);
    let Some(said) = rest.strip_prefix([':', ')', '.', '–', '—', '-']) else {
        return false;
    };
    is_label && is_any(word, WAYS) && said.contains(char::is_alphanumeric)
}

/// Returns whether a line may choose what it says.
pub(super) fn chooses(line: &str) -> bool {
    line.split(|letter: char| !letter.is_alphanumeric() && !"✅✓✔⭐".contains(letter))
        .any(|word| is_any(word, WAY_CHOSEN))
}
