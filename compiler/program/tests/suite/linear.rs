//! Reading takes time linear in an answer's length.

use crate::{growth, read};
use fab_program::reply::{self, MAX_REPLY_BYTES};

/// Pieces that an answer may repeat.
const PIECES: [&str; 76] = [
    "grip= ",
    "grip=x ",
    "pick ",
    "grip grip ",
    "pick=(",
    "a * ",
    "1. 45 deg\n",
    "tip angle=60 deg\nwait ",
    "pick= ",
    "pick - ",
    "tip ",
    "tip angle= ",
    "tip angle=((",
    "tip angle=pi*",
    "distance=1*",
    "distance=1,",
    "distance (",
    "distance=the ",
    "grip=soft or ",
    "soft ",
    "grip: not ",
    "9",
    "-",
    "\"pick\": {",
    "grip=soft, a a a a a a a ",
    "grip=soft (",
    "_",
    "{\"pick\": ",
    "{\"pick\": \"",
    "{a:1",
    "\"{\\\"pick\\\": ",
    "[",
    "[1,",
    "[[",
    "[A",
    "<",
    "<a",
    "<think>",
    "</think>",
    "<think></think>",
    "<|",
    "<|channel|>analysis",
    "<|a|>",
    "◁",
    "analysis",
    "assistantfinal",
    "~~",
    "~~a",
    "~~~",
    "<s>",
    "<del>\n\n",
    "<!--",
    "> a\n",
    "```\n",
    "| pick ",
    "| pick |\n",
    "|-|\n",
    "| pick | place |\n|-|-|\n",
    "- ",
    "# ",
    "\n",
    "\r",
    "Instructions: ",
    "Instructions: x\n",
    "Instructions:\n- ",
    "{\"instructions\": ",
    "<instructions>",
    "\\",
    "\\text{",
    "\\begin{a}",
    "<pick>",
    "<point x=\"1\" y=\"1\" ",
    "<arg_key>pick</arg_key>",
    "pick x = 1 ",
    "placeholde ",
    "é",
];

/// Reads answers that repeat one of every so many pieces, of a length and of eight times that.
fn take_linear_time(length: usize, first: usize, every: usize) {
    for piece in PIECES.iter().skip(first).step_by(every) {
        growth::assert_linear(piece, length, |length| {
            let text = piece.repeat(length / piece.len());
            let _ = read("grip", &text);
            let _ = read("paper", &text);
            let _ = reply::read_text("Instructions:", "", &text);
            let _ = reply::read_text("<instructions>", "</instructions>", &text);
        });
    }
}

#[test]
fn reading_takes_linear_time() {
    take_linear_time(1 << 13, 0, 2);
}

#[test]
#[ignore = "long"]
fn reading_long_answers_takes_linear_time() {
    take_linear_time(MAX_REPLY_BYTES / 32, 1, 2);
}
