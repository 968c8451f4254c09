//! The mistakes that people make, each a row: what they write, where, and what to write instead.
//!
//! A mistake without a row is reported as what was expected and what was found. Write a row for what authors really
//! type, such as the signs of other languages; not for what could be typed.

/// A place that does not parse.
pub(super) struct Place<'t> {
    /// The word, number, text or sign there; empty at the end of the line.
    pub found: &'t str,
    /// What would fit, in backticks where it is literal.
    pub expected: &'t [&'static str],
    /// The words of the language that would fit.
    pub words: &'t [&'static str],
    /// The file before it.
    pub before: &'t str,
    /// The file from it on.
    pub rest: &'t str,
}

/// Where a mistake is made.
#[derive(Clone, Copy)]
enum Where {
    Anywhere,
    /// This would fit, among other things.
    Expecting(&'static str),
    /// This alone would fit.
    ExpectingOnly(&'static str),
    /// The statement is complete.
    ExpectingNothing,
    /// Behind these words.
    After(&'static str),
    /// On a line that begins with a word.
    In(&'static str),
    /// At the beginning of a line.
    AtStart,
    /// At the end of a line.
    AtEnd,
    /// Where the line has a `(` without `)`.
    InBrackets,
    /// Elsewhere.
    OutsideBrackets,
}

/// What an edit does, and whether the author can only have meant that.
#[derive(Clone, Copy)]
pub(super) enum Change {
    Nothing,
    /// Certainly writes this instead.
    Write(&'static str),
    /// Probably writes this instead.
    MayWrite(&'static str),
    /// Probably writes this before it.
    MayInsert(&'static str),
}

/// A row of [`MISTAKES`].
pub(super) struct Mistake {
    /// What is written: the beginning of a sign, a whole word, or one of the kinds `WORD`, `NUMBER`, `GROUP` of digits,
    /// `TEXT`, `ANY` and `END`, where nothing is left.
    found: &'static [&'static str],
    place: Where,
    pub change: Change,
    /// What to do.
    pub help: &'static str,
    /// What is wrong, with `{}` for what is written; empty for what was expected and found.
    pub message: &'static str,
}

macro_rules! mistakes {
    ($([$($found:literal)*] $place:expr, $change:expr, $help:expr $(, $message:literal)?;)*) => {
        /// The first row that fits counts.
        const MISTAKES: &[Mistake] = &[$(Mistake {
            found: &[$($found),*],
            place: $place,
            change: $change,
            help: $help,
            message: concat!($($message)?),
        }),*];
    };
}

use Change::{MayInsert, MayWrite, Nothing, Write};
use Where::*;

const ADDED: &str =
    "write `say NAME in STAGE after NAME`, or `before NAME`, with names of components, in the task";

mistakes! {
    // Signs and words of other languages.
    ["&&"] Anywhere, Write("and"), "write `and`", "`{}` is written `and` here";
    ["||"] Anywhere, Write("or"), "write `or`", "`{}` is written `or` here";
    ["and" "with" "&" "+"] In("fold"), Nothing,
        "a step has one pick and one place; write `,` before the next step: `fold A -> B, C -> D`";
    ["!="] Anywhere, Nothing, "a value stands on both sides of it";
    ["!"] Anywhere, Write("not"), "write `not`", "`{}` is written `not` here";
    ["//"] AtStart, Write("#"), "write `#`", "`{}` is written `#` here";
    ["//"] Anywhere, MayWrite("#"), "write `#`", "`{}` is written `#` here";
    ["/"] InBrackets, Nothing, "a fraction is two numbers without blanks, `1/3`";
    [";"] AtEnd, Write(""), "remove it: a statement ends with its line", "`{}` is not part of the language";
    ["and" "&" "+" ";" "|"] ExpectingOnly("`,`"), MayWrite(","), "write `,`";
    [";"] Anywhere, Nothing, "end the statement with its line", "`{}` is not part of the language";
    ["→" "=>" "–>" "—>" "⇒" "to"] Expecting("`->`"), Write("->"), "write `->`";
    [":="] Expecting("`=`"), Write("="), "write `=`", "`{}` is written `=` here";
    [":"] Expecting("`=`"), Write("="), "write `=`";
    ["=<"] Anywhere, Nothing, "write `<` or `<=`", "`{}` is not a comparison";
    ["="] Expecting("`:`"), Write(":"), "write `:`";
    ["="] Expecting("`)`"), Write(":"), "an argument's name is followed by `:`";
    [":=" ":" "="] Expecting("a value"), MayWrite(""), "remove it: its word is followed by the value";
    [":=" ":" "="] Expecting("a text in quotes"), MayWrite(""), "remove it: its word is followed by the text";
    ["GROUP"] Anywhere, Nothing, "write all digits together", "a number is written without `_`";
    ["."] Expecting("a value"), Write("0."), "write `0` before the point", "a number begins with a digit";
    [":"] Expecting("`{`"), Nothing, "write `{` here, and `}` where the block ends";
    ["[" "("] Expecting("`{`"), MayWrite("{"), "write `{` here, and `}` where the block ends";
    ["]"] InBrackets, MayWrite(")"), "write `)`";
    ["[" "]"] Anywhere, Nothing, "lists have no brackets; write the parts with commas between them";
    ["True" "False" "None" "true" "false" "none"] ExpectingNothing, Nothing,
        "a condition compares values; remove it if it always holds", "expected a condition, found `{}`";
    ["“" "”" "'" "‘" "’"] Anywhere, Nothing, "write straight double quotes `\"`";
    // Values and comparisons.
    ["="] After("trust overlap >"), MayWrite(""), "remove it: twins are trusted above the overlap";
    ["<" "=" ":"] After("trust overlap"), Nothing, "write `>`: twins are trusted above the overlap";
    ["="] In("goal"), Nothing, "write `<` or `>`: a goal has a limit", "`{}` is not a comparison";
    ["=>" "="] ExpectingNothing, Nothing,
        "write `<`, `<=`, `>` or `>=`; words and counts are compared with `==`", "`{}` is not a comparison";
    ["<" ">" "=="] ExpectingNothing, Nothing,
        "write two comparisons joined by `and`", "a comparison has two sides, and `{}` begins a third";
    ["-" "–" "…"] Expecting("`)`"), Nothing, "a range is written with `to`: `0.9 to 1.1`";
    ["on"] ExpectingNothing, MayWrite("within"), "write `within` and a mask, as in `pick within cloth`",
        "expected `within`, found `{}`";
    ["from" "to" "off" "at" "in"] Expecting("`of`"), MayWrite("of"), "did you mean `of`?";
    ["NUMBER"] After("depth"), Nothing, "write `<` or `>` between them, such as `depth < 640mm`";
    ["ANY"] After("when"), Nothing, "write `when` and a condition, such as `when step > 1`";
    // What is missing.
    ["\"\"\""] ExpectingNothing, Nothing, "write one line between `\"` and `\"`",
        "a text of several lines is not allowed here";
    ["\"\"\""] Expecting("a value"), Nothing, "write one line between `\"` and `\"`",
        "a text of several lines is not allowed here";
    ["TEXT"] Expecting("`else`"), MayInsert("else "), "write `else` before it";
    ["WORD"] In("use"), Nothing, "write the path in quotes: `use \"…\"`";
    ["WORD"] After("expect reject"), Nothing, "write `expect reject(NAME)`", "expected `(`, found `{}`";
    ["in" "half"] In("fold"), Nothing, "say what moves where: `fold corner(back_left) -> center`";
    ["WORD"] After("given last"), Nothing, "a point joins the names: `given last.pick`";
    ["WORD" "NUMBER" "TEXT" "-"] ExpectingOnly("`=`"), MayInsert("= "), "write `=` before it";
    ["NUMBER"] Expecting("`)`"), Nothing, "write `:` behind an argument's name, and `,` between arguments";
    [")" "}"] After(","), Nothing, "remove the comma before it";
    // Changes to what a task inherits, rehearsals and stages.
    ["when"] In("say"), Nothing, "state the condition where the text is declared: `component NAME when … \"…\"`";
    ["ANY" "END"] Expecting("`in`"), Nothing, ADDED;
    ["ANY" "END"] Expecting("`after`"), Nothing, ADDED;
    ["in" "after" "before" "stage"] In("say"), Nothing, ADDED;
    ["WORD" "NUMBER" "TEXT"] ExpectingOnly("`,`"), MayInsert(", "), "write `,` before it";
    ["TEXT"] In("say"), Nothing, ADDED;
    ["ANY"] After("override"), Nothing,
        "write `override component` or `override check`; any other section is stated again to replace it";
    ["ANY"] After("without"), Nothing,
        "only components, checks and a task's variants are left out; state any other section again";
    ["ANY"] Expecting("`most`"), Nothing, "write `most`: the answer with the highest measure is taken";
    ["skip"] Expecting("`refuse`"), Nothing, "write `else refuse`, or leave it out to act without rehearsal";
    ["subgoals"] Expecting("a value"), MayWrite("subgoal"), "did you mean `subgoal`?";
    ["actions"] After("read"), MayWrite("action"), "did you mean `action`?";
    ["override"] After("component"), Nothing, "write `override` before `component`";
    ["ANY"] ExpectingOnly("a name"), Nothing, "a name belongs here: letters, digits and `_`, no word of the language";
    [")"] OutsideBrackets, Nothing, "write the `(` that it closes, or remove it", "this `{}` closes nothing";
    ["WORD"] Expecting("`)`"), MayInsert(", "), "write `,` before it";
    ["WORD" "NUMBER"] ExpectingNothing, Nothing, "a sign or a word such as `and` is missing before it, or remove it";
}

/// Returns the mistake at a place, and what is written there.
pub(super) fn recognise<'t>(place: &Place<'t>) -> Option<(&'static Mistake, &'t str)> {
    MISTAKES.iter().find_map(|row| {
        let found = row.found.iter().find_map(|found| written(found, place))?;
        is_at(row.place, place).then_some((row, found))
    })
}

/// Returns what is written at a place if it is what a row has.
fn written<'t>(found: &str, place: &Place<'t>) -> Option<&'t str> {
    let begins = |fits: fn(char) -> bool| place.found.starts_with(fits);
    let fits = match found {
        "ANY" => !place.found.is_empty(),
        "END" => place.found.is_empty(),
        "WORD" => begins(char::is_alphabetic),
        "NUMBER" => begins(|first| first.is_ascii_digit()),
        "GROUP" => {
            let digits = place.found.strip_prefix('_');
            digits.is_some_and(|it| it.starts_with(|first: char| first.is_ascii_digit()))
        }
        "TEXT" => begins(|first| first == '"') && !place.rest.starts_with("\"\"\""),
        _ if found.starts_with(char::is_alphabetic) => place.found == found,
        // The sign may be longer than the text found.
        _ => {
            return place
                .rest
                .starts_with(found)
                .then(|| &place.rest[..found.len()]);
        }
    };
    fits.then_some(place.found)
}

fn is_at(wanted: Where, place: &Place<'_>) -> bool {
    let before = place.before.trim_end();
    match wanted {
        Anywhere => true,
        Expecting(words) => place.expected.contains(&words),
        ExpectingOnly(words) => place.expected == [words],
        ExpectingNothing => place.expected.is_empty(),
        After(words) => before.ends_with(words),
        In(word) => {
            let line = place.before.rsplit(['\n', '{', '}']).next();
            line.is_some_and(|line| line.trim_start().starts_with(word))
        }
        AtStart => place.before.trim_end_matches([' ', '\t']).ends_with('\n'),
        AtEnd => {
            let behind = place.rest[1..].trim_start_matches([' ', '\t']);
            behind.is_empty() || behind.starts_with(['\n', '\r', '#', '}'])
        }
        InBrackets => open_bracket(place.before).is_some(),
        OutsideBrackets => open_bracket(place.before).is_none(),
    }
}

/// Returns the place of the last `(` on this line that is still open; brackets in texts do not count.
pub(super) fn open_bracket(before: &str) -> Option<usize> {
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let mut open = Vec::new();
    let mut is_text = false;
    for (at, letter) in before[start..].char_indices() {
        match letter {
            '"' => is_text = !is_text,
            '(' if !is_text => open.push(start + at),
            ')' if !is_text => drop(open.pop()),
            _ => {}
        }
    }
    open.pop()
}

macro_rules! misplaced {
    ($($block:literal: $($word:literal)+ => $help:literal;)*) => {
        /// Words with which people begin a line of a block, each with what to write instead.
        const MISPLACED: &[(&str, &[&str], &str)] = &[$(($block, &[$($word),+], $help)),*];
    };
}

misplaced! {
    "task": "system" =>
        "write `say NAME in STAGE after NAME`: beside a part of `system`, it becomes a part of `system`";
    "task": "model" "show" "read" "example" =>
        "it belongs in a `stage`; to change it, state the stage again: a stage replaces the inherited one of the same name";
    "task": "attempts" "result" =>
        "it belongs in `verify`; a `verify` of this task's own replaces the inherited one, so state the inherited checks in it too";
    "task": "add" "append" "insert" "new" "extend" =>
        "a new part needs no word before it: write `component NAME \"…\"`, `check NAME { … } else \"…\"`, or `say NAME in STAGE after NAME`";
    "task": "remove" "delete" "drop" "omit" "exclude" =>
        "write `without component NAME`, `without check NAME` or `without variant NAME`; another section is stated again to change it";
    "variant": "variant" => "variants do not nest: write each in the task, beside the others";
    "stage": "vision" => "write `model vision`";
    "stage": "text" => "write `model text`";
    "subgoals": "fold" => "write `demonstrate { fold A -> B }`, with all folds between its braces";
    "verify": "else" "then" "otherwise" "message" =>
        "the message of a check is behind `else`: write `check NAME { … } else \"…\"`";
    "verify": "override" =>
        "move `override check` out of `verify`, into the task; a `verify` of the task's own inherits no checks";
    "verify": "without" => "move `without check` out of `verify`, into the task";
}

/// Returns what to write instead of a word that does not begin a line of a block.
pub(super) fn misplaced(word: &str, block: &str) -> Option<&'static str> {
    // What a task may hold, a variant may hold too.
    let is_of = |row: &str| row == block || row == "task" && block == "variant";
    let mut rows = MISPLACED.iter();
    let row = rows.find(|(of, words, _)| is_of(of) && words.contains(&word));
    row.map(|(.., help)| *help)
}
