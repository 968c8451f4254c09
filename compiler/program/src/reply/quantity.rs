//! Reads a number with its surroundings: fractions, multiples of pi, percent, units, number words.
//!
//! In: a cursor. Out: a number, whether it is multiplied by pi, and its unit. [`super::choice`] decides what it
//! means. Numbers are finite and of bounded size, products short, brackets shallow.

use super::cursor::Cursor;
use super::lexer::{Kind, Token, digit};
use super::wordlist::words;
use crate::units::{DEG, Dimension, EDGE, PER_SECOND, UNITS, Unit};

/// The largest number that an answer can mean.
pub(super) const MAX_NUMBER: f64 = 1_000_000.0;

/// The most digits of a number.
const MAX_DIGITS: usize = 24;

/// The most factors of a product.
const MAX_FACTORS: usize = 6;

/// The most brackets inside one another.
const MAX_DEPTH: usize = 3;

/// What follows a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AnswerUnit {
    /// A unit of the language.
    Of(&'static Unit),
    /// Percent of something unnamed.
    Percent,
    /// Percent of the cloth's longer side.
    PercentOfEdge,
    /// Thousandths of a millimetre, which the language does not have.
    Micrometres,
}

/// Names of micrometres.
const MICROMETRES: [&str; 7] = [
    "um",
    "µm",
    "μm",
    "micrometers",
    "micrometres",
    "micrometer",
    "microns",
];

/// A number as stated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    /// The number, without pi.
    pub number: f64,
    /// Whether it is multiplied by pi.
    pub times_pi: bool,
    /// Its unit, if it has one.
    pub unit: Option<AnswerUnit>,
    /// Whether it has a comma where a point is usual.
    pub has_comma: bool,
    /// Half of the last decimal that was written; 0 for fractions.
    pub rounding: f64,
}

/// What was found where a number is expected.
pub(super) enum Parsed {
    Quantity(Quantity),
    /// Almost a number, and what is wrong with it.
    Bad(String),
    Nothing,
}

/// Units in other languages, and their names here.
const FOREIGN: &[(&[&str], &str)] = &[
    (
        words!("度 도 graus grados degrés degré gradi grad graden grader stopni derece градусов"),
        "deg",
    ),
    (words!("边长 邊長 kante"), "edge"),
    (words!("毫米 millimètres milímetros"), "mm"),
];

/// Number words; those from twenty on may be followed by a smaller one.
const WORDS: [(&str, f64); 30] = [
    ("zero", 0.0),
    ("one", 1.0),
    ("two", 2.0),
    ("three", 3.0),
    ("four", 4.0),
    ("five", 5.0),
    ("six", 6.0),
    ("seven", 7.0),
    ("eight", 8.0),
    ("nine", 9.0),
    ("ten", 10.0),
    ("eleven", 11.0),
    ("twelve", 12.0),
    ("thirteen", 13.0),
    ("fourteen", 14.0),
    ("fifteen", 15.0),
    ("sixteen", 16.0),
    ("seventeen", 17.0),
    ("eighteen", 18.0),
    ("nineteen", 19.0),
    ("twenty", 20.0),
    ("thirty", 30.0),
    ("forty", 40.0),
    ("fifty", 50.0),
    ("sixty", 60.0),
    ("seventy", 70.0),
    ("eighty", 80.0),
    ("ninety", 90.0),
    ("hundred", 100.0),
    ("point", 0.0),
];

/// Fractions in one character.
const FRACTIONS: [(char, f64); 5] = [
    ('¼', 0.25),
    ('½', 0.5),
    ('¾', 0.75),
    ('⅛', 0.125),
    ('⅒', 0.1),
];

/// Parts of the cloth's edge in words.
const PARTS: [(&str, f64); 14] = [
    ("one full", 1.0),
    ("one whole", 1.0),
    ("entire", 1.0),
    ("one entire", 1.0),
    ("three quarters", 0.75),
    ("three quarter", 0.75),
    ("one half", 0.5),
    ("one quarter", 0.25),
    ("one tenth", 0.1),
    ("half", 0.5),
    ("quarter", 0.25),
    ("tenth", 0.1),
    ("full", 1.0),
    ("whole", 1.0),
];

/// A product while it is being read.
struct Product {
    over: f64,
    under: f64,
    pi: i32,
    factors: usize,
    has_comma: bool,
    rounding: f64,
}

/// Why a product cannot be read; `None` if there is no product at all.
type Failure = Option<String>;

/// Reads a number with its unit and moves past it; otherwise the cursor does not move.
pub(super) fn read(cursor: &mut Cursor<'_, '_>) -> Parsed {
    if let Some(quantity) = part_of_edge(cursor) {
        return Parsed::Quantity(quantity);
    }
    let start = *cursor;
    if let Some(number) = in_words(cursor) {
        let unit = unit(cursor);
        if unit.is_none() {
            *cursor = start;
            return Parsed::Nothing;
        }
        return Parsed::Quantity(Quantity {
            number,
            times_pi: false,
            unit,
            has_comma: false,
            rounding: 0.0,
        });
    }
    let mut product = Product::new();
    match product.read(cursor, 0).and_then(|()| product.value()) {
        Ok((number, times_pi)) => Parsed::Quantity(Quantity {
            number,
            times_pi,
            unit: unit(cursor),
            has_comma: product.has_comma,
            rounding: if product.factors == 1 {
                product.rounding
            } else {
                0.0
            },
        }),
        Err(why) => {
            *cursor = start;
            why.map_or(Parsed::Nothing, Parsed::Bad)
        }
    }
}

/// Returns whether a number in digits or a fraction begins here.
pub(super) fn begins(cursor: Cursor<'_, '_>) -> bool {
    let mut cursor = cursor;
    while cursor.eat_signs(&['-', '+', '(', '[', '{', '#']).is_some() {}
    cursor.peek().is_some_and(|token| match token.kind {
        Kind::Number => true,
        Kind::Sign(sign) => FRACTIONS.iter().any(|(fraction, _)| *fraction == sign),
        Kind::Word => token.is_any(&["pi", "π", "frac"]),
    })
}

/// Returns whether a number in degrees is next.
pub(super) fn degrees(tokens: &[Token<'_>]) -> bool {
    let mut cursor = Cursor::new(tokens);
    cursor
        .peek()
        .is_some_and(|token| token.kind == Kind::Number)
        && matches!(
            read(&mut cursor),
            Parsed::Quantity(Quantity { unit: Some(AnswerUnit::Of(unit)), .. }) if *unit == DEG
        )
}

/// Reads `half the edge`, `three-quarters of an edge length`, `the full edge`.
fn part_of_edge(cursor: &mut Cursor<'_, '_>) -> Option<Quantity> {
    let mut ahead = *cursor;
    ahead.eat_any(&["the", "a", "an"]);
    // Most tokens begin no part; comparing them with each would take most of the time.
    let first = ahead.peek()?.text.chars().next()?.to_ascii_lowercase();
    let may_begin = |words: &str| words.starts_with(first) || first == '3';
    let number = PARTS
        .iter()
        .filter(|(words, _)| may_begin(words))
        .find_map(|(words, number)| {
            let mut parts = ahead;
            let mut all = words.split(' ').enumerate().all(|(index, word)| {
                if index > 0 {
                    parts.eat_sign('-');
                }
                parts.eat_word(word)
            });
            if !all && *words == "three quarters" {
                parts = ahead;
                all = parts.eat_number() == Some("3") && parts.eat_word("quarters");
            }
            all.then(|| {
                ahead = parts;
                *number
            })
        })?;
    ahead.eat_sign('-');
    if !of_edge(&mut ahead) {
        return None;
    }
    *cursor = ahead;
    Some(Quantity {
        number,
        times_pi: false,
        unit: Some(AnswerUnit::Of(&EDGE)),
        has_comma: false,
        rounding: 0.0,
    })
}

/// Reads `forty-five`, `one hundred and thirty five`, `zero point five`.
fn in_words(cursor: &mut Cursor<'_, '_>) -> Option<f64> {
    let start = *cursor;
    let mut whole: Option<f64> = None;
    let mut decimals: Option<(f64, f64)> = None;
    loop {
        let before = *cursor;
        if whole.is_some() {
            cursor.eat_sign('-');
            cursor.eat_word("and");
        }
        let Some(word) = cursor.peek().filter(|token| token.kind == Kind::Word) else {
            *cursor = before;
            break;
        };
        let Some((name, value)) = WORDS.iter().find(|(name, _)| word.is(name)) else {
            *cursor = before;
            break;
        };
        cursor.at += 1;
        match (&mut decimals, *name) {
            (None, "point") if whole.is_some() => decimals = Some((0.0, 0.1)),
            (Some((sum, size)), _) if *value < 10.0 && *name != "point" => {
                *sum += value * *size;
                *size /= 10.0;
            }
            (None, "hundred") if whole.is_some_and(|it| (1.0..10.0).contains(&it)) => {
                whole = whole.map(|it| it * 100.0);
            }
            (None, _) if *name != "point" && *name != "hundred" => match whole {
                None => whole = Some(*value),
                // A ten takes a digit, and a hundred takes both.
                Some(sum)
                    if (sum % 100.0 == 0.0 && sum >= 100.0)
                        || (sum % 10.0 == 0.0 && sum >= 20.0 && *value < 10.0) =>
                {
                    whole = Some(sum + value);
                }
                Some(_) => {
                    *cursor = start;
                    return None;
                }
            },
            _ => {
                *cursor = start;
                return None;
            }
        }
    }
    match decimals {
        Some((_, size)) if size > 0.05 => {
            *cursor = start;
            None
        }
        decimals => whole.map(|whole| whole + decimals.map_or(0.0, |(sum, _)| sum)),
    }
}

impl Product {
    fn new() -> Product {
        Product {
            over: 1.0,
            under: 1.0,
            pi: 0,
            factors: 0,
            has_comma: false,
            rounding: 0.0,
        }
    }

    fn value(&self) -> Result<(f64, bool), Failure> {
        if self.under == 0.0 {
            return Err(Some("it divides by zero".to_owned()));
        }
        let number = self.over / self.under;
        if !number.is_finite() || number.abs() > MAX_NUMBER {
            return Err(Some("its number is far too large".to_owned()));
        }
        match self.pi {
            0 => Ok((number, false)),
            1 => Ok((number, true)),
            _ => Err(Some(
                "pi appears in it more than once or in the denominator".to_owned(),
            )),
        }
    }

    /// Reads factors with `*`, `/` or pi between them. `depth` counts open brackets.
    fn read(&mut self, cursor: &mut Cursor<'_, '_>, depth: usize) -> Result<(), Failure> {
        if depth > MAX_DEPTH {
            return Err(Some("it has too many brackets".to_owned()));
        }
        let is_negative = cursor.eat_sign('-') || cursor.eat_any(&["minus", "negative"]);
        if is_negative {
            self.over = -self.over;
        } else {
            cursor.eat_sign('+');
        }
        self.factor(cursor, depth, Line::Above)?;
        loop {
            let before = *cursor;
            let line = if cursor.eat_sign('*') || cursor.eat_word("times") {
                Line::Above
            } else if cursor.eat_sign('/') {
                Line::Below
            } else if cursor
                .peek()
                .is_some_and(|token| token.is_any(&["pi", "π"]))
            {
                Line::Above
            } else {
                return Ok(());
            };
            match self.factor(cursor, depth, line) {
                Ok(()) => {}
                // In `0.5 * edge`, the unit follows.
                Err(None) => {
                    *cursor = before;
                    return Ok(());
                }
                Err(why) => return Err(why),
            }
        }
    }

    fn factor(
        &mut self,
        cursor: &mut Cursor<'_, '_>,
        depth: usize,
        line: Line,
    ) -> Result<(), Failure> {
        self.factors += 1;
        if self.factors > MAX_FACTORS {
            return Err(Some("it has too many factors".to_owned()));
        }
        if cursor.eat_any(&["pi", "π"]) {
            self.pi += if matches!(line, Line::Above) { 1 } else { -1 };
            return Ok(());
        }
        if cursor.eat_word("frac") {
            self.inside(cursor, depth, line, ['{', '}'])?;
            return self.inside(cursor, depth, line.other(), ['{', '}']);
        }
        if cursor.peek().is_some_and(|token| token.is_sign('(')) {
            return self.inside(cursor, depth, line, ['(', ')']);
        }
        let number = self.number(cursor)?;
        match line {
            Line::Above => self.over *= number,
            Line::Below => self.under *= number,
        }
        Ok(())
    }

    fn number(&mut self, cursor: &mut Cursor<'_, '_>) -> Result<f64, Failure> {
        for (sign, value) in FRACTIONS {
            if cursor.eat_sign(sign) {
                return Ok(value);
            }
        }
        let text = cursor.eat_number().ok_or(None)?;
        let mut digits: String = text
            .chars()
            .map(|letter| digit(letter).unwrap_or('.'))
            .collect();
        // `0,5`: a comma between two numbers without blanks.
        let comma = *cursor;
        if cursor.is_joined() && cursor.eat_sign(',') && cursor.is_joined() {
            match cursor.eat_number() {
                Some(decimals) if !decimals.contains('.') && !digits.contains('.') => {
                    let is_zero = digits.chars().all(|digit| digit == '0');
                    if decimals.chars().count() == 3 && !is_zero {
                        return Err(Some(
                            "its comma can set apart decimals or thousands".to_owned(),
                        ));
                    }
                    digits.push('.');
                    digits.extend(decimals.chars().filter_map(digit));
                    self.has_comma = true;
                }
                _ => *cursor = comma,
            }
        } else {
            *cursor = comma;
        }
        if digits.len() > MAX_DIGITS {
            return Err(Some(format!("its number has {} digits", digits.len())));
        }
        let decimals = digits
            .split_once('.')
            .map_or(0, |(_, decimals)| decimals.len());
        if let Some(exponent) = exponent(cursor) {
            digits.push_str(&format!("e{exponent}"));
        }
        self.rounding = 0.5 * 10_f64.powi(-(decimals as i32));
        let mut value: f64 = digits.parse().map_err(|_| None)?;
        value += third(cursor);
        if value > MAX_NUMBER {
            return Err(Some("its number is far too large".to_owned()));
        }
        Ok(value)
    }

    /// Reads a product in brackets.
    fn inside(
        &mut self,
        cursor: &mut Cursor<'_, '_>,
        depth: usize,
        line: Line,
        [open, close]: [char; 2],
    ) -> Result<(), Failure> {
        if !cursor.eat_sign(open) {
            return Err(None);
        }
        let mut inner = Product {
            factors: self.factors,
            has_comma: self.has_comma,
            ..Product::new()
        };
        inner.read(cursor, depth + 1)?;
        if !cursor.eat_sign(close) {
            return Err(None);
        }
        (self.factors, self.has_comma) = (inner.factors, inner.has_comma);
        match line {
            Line::Above => {
                self.over *= inner.over;
                self.under *= inner.under;
                self.pi += inner.pi;
            }
            Line::Below => {
                self.over *= inner.under;
                self.under *= inner.over;
                self.pi -= inner.pi;
                // Dividing by a fraction over zero must not give zero over zero.
                if inner.under == 0.0 {
                    self.under = 0.0;
                }
            }
        }
        Ok(())
    }
}

/// Reads the exponent of `1.25e-1`.
fn exponent(cursor: &mut Cursor<'_, '_>) -> Option<i32> {
    let start = *cursor;
    let word = cursor
        .peek()
        .filter(|word| word.kind == Kind::Word && cursor.is_joined())?;
    cursor.at += 1;
    let digits = word.text.strip_prefix(['e', 'E']).unwrap_or(" ");
    let found = if digits.is_empty() {
        let sign = cursor.eat_signs(&['-', '+']);
        let number = cursor.eat_number().filter(|number| number.len() < 3);
        number
            .and_then(|number| number.parse::<i32>().ok())
            .map(|size| if sign == Some('-') { -size } else { size })
    } else {
        digits.parse().ok().filter(|_| digits.len() < 3)
    };
    if found.is_none() {
        *cursor = start;
    }
    found
}

/// Reads the fraction of a mixed number, `33 1/3`; 0 if there is none.
fn third(cursor: &mut Cursor<'_, '_>) -> f64 {
    let start = *cursor;
    let parts = (
        cursor.eat_number(),
        cursor.eat_sign('/'),
        cursor.eat_number(),
    );
    if let (Some(over), true, Some(under)) = parts
        && let (Ok(over), Ok(under)) = (over.parse::<u8>(), under.parse::<u8>())
        && 0 < over
        && over < under
        && under < 10
    {
        return f64::from(over) / f64::from(under);
    }
    *cursor = start;
    0.0
}

/// The side of a fraction's line that a factor is on.
#[derive(Clone, Copy)]
enum Line {
    Above,
    Below,
}

impl Line {
    fn other(self) -> Line {
        match self {
            Line::Above => Line::Below,
            Line::Below => Line::Above,
        }
    }
}

/// Reads a unit; without one the cursor does not move.
pub(super) fn unit(cursor: &mut Cursor<'_, '_>) -> Option<AnswerUnit> {
    let start = *cursor;
    // `45-degree`
    let is_hyphen = cursor.is_joined() && cursor.eat_sign('-') && cursor.is_joined();
    if !is_hyphen {
        *cursor = start;
    }
    if cursor.eat_sign('%') || cursor.eat_any(&["percent", "pct"]) {
        return Some(match of_edge(cursor) {
            true => AnswerUnit::PercentOfEdge,
            false => AnswerUnit::Percent,
        });
    }
    if of_edge(cursor) {
        return Some(AnswerUnit::Of(&EDGE));
    }
    if cursor.eat_any(&MICROMETRES) {
        return Some(AnswerUnit::Micrometres);
    }
    let token = cursor.peek();
    let foreign = |token: &Token<'_>| {
        FOREIGN
            .iter()
            .find(|(words, _)| token.is_any(words) || words.contains(&token.text))
            .map(|(_, name)| *name)
    };
    let found = token.and_then(|token| {
        let name = foreign(token);
        UNITS
            .iter()
            .filter(|unit| unit.dimension != Dimension::Pixels)
            .find(|unit| {
                name == Some(unit.name)
                    || unit.words().any(|word| match word.is_ascii() {
                        true => token.is(word),
                        false => token.text == word || (token.is_sign('°') && **unit == DEG),
                    })
            })
    });
    match found {
        Some(unit) => {
            cursor.at += 1;
            if let Some(speed) = per_second(cursor, unit) {
                return Some(AnswerUnit::Of(speed));
            }
            // `45° (deg)`, `45 ° degrees`
            let mut again = *cursor;
            let is_bracket = again.eat_sign('(');
            let is_same = again
                .peek()
                .is_some_and(|token| unit.words().any(|word| token.is(word)));
            again.at += 1;
            if is_same && (!is_bracket || again.eat_sign(')')) {
                *cursor = again;
            }
            Some(AnswerUnit::Of(unit))
        }
        None => {
            *cursor = start;
            None
        }
    }
}

/// Reads the rest of a unit of speed after its unit of length: `/s`, `per second`; otherwise the cursor does not move.
fn per_second(cursor: &mut Cursor<'_, '_>, length: &Unit) -> Option<&'static Unit> {
    let mut ahead = *cursor;
    let is_speed = (ahead.eat_sign('/') || ahead.eat_word("per")) && ahead.eat_any(PER_SECOND);
    let speed = length.per_second().filter(|_| is_speed)?;
    *cursor = ahead;
    Some(speed)
}

/// Reads `side` after `the cloth's`, and `side of the cloth`; other sides are none of its edges.
fn side_of_cloth(cursor: &mut Cursor<'_, '_>, start: Cursor<'_, '_>) -> bool {
    let names_cloth = start.tokens[start.at..cursor.at]
        .iter()
        .any(|token| token.is_any(&["cloth", "cloth's", "cloth’s", "fabric's"]));
    let mut ahead = *cursor;
    let is_side = ahead.eat_any(&["side", "sides"]);
    let mut behind = ahead;
    behind.eat_any(&["length", "lengths"]);
    let is_there = is_side && (names_cloth || behind.eat_words("of the cloth"));
    if is_there {
        *cursor = ahead;
    }
    is_there
}

/// Reads `edge`, `of the cloth's edge length`, `* edge`, `x edge`; otherwise the cursor does not move.
fn of_edge(cursor: &mut Cursor<'_, '_>) -> bool {
    let start = *cursor;
    let _ = cursor.eat_sign('*') || cursor.eat_any(&["of", "times", "x"]);
    for _ in 0..4 {
        cursor.eat_any(&[
            "the",
            "an",
            "a",
            "one",
            "cloth",
            "cloth's",
            "cloth’s",
            "fabric's",
            "full",
            "whole",
            "s",
        ]);
    }
    cursor.eat_sign('(');
    let is_open =
        cursor.at > 0 && cursor.tokens[cursor.at - 1].is_sign('(') && cursor.at > start.at;
    if cursor.eat_any(&["longer", "long", "longest"]) {
        cursor.eat_any(&["edge", "side"]);
    } else if !(cursor.eat_any(&["edge", "edges"]) || side_of_cloth(cursor, start)) {
        *cursor = start;
        return false;
    }
    let behind = *cursor;
    cursor.eat_sign('-');
    if !cursor.eat_any(&["length", "lengths", "unit", "units"]) {
        *cursor = behind;
    }
    if is_open && !cursor.eat_sign(')') {
        *cursor = start;
        return false;
    }
    let of_cloth = *cursor;
    if !(cursor.eat_words("of the cloth")
        || cursor.eat_words("of cloth")
        || cursor.eat_words("of the fabric"))
    {
        *cursor = of_cloth;
    }
    true
}
