//! Reads a number with its surroundings: fractions, multiples of pi, units.
//!
//! In: a cursor. Out: a number, whether it is multiplied by pi, and its unit. [`super::choice`] decides what it
//! means. Numbers are finite and of bounded size, products short, brackets shallow.

use super::cursor::{Cursor, decorates};
use super::number::{AnswerUnit, Decimals, MAX_NUMBER, blanks, eat_any, number, unit};

/// The most factors of a product.
const MAX_FACTORS: usize = 6;

/// The most brackets inside one another.
const MAX_DEPTH: usize = 3;

/// A number as stated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    /// The number, without pi.
    pub number: f64,
    /// Whether it is multiplied by pi.
    pub times_pi: bool,
    /// Its unit, if it has one.
    pub unit: Option<AnswerUnit>,
    /// Its decimal separator.
    pub decimals: Decimals,
}

/// What was found where a number is expected.
pub(super) enum Parsed {
    Quantity(Quantity),
    /// Almost a number, and what is wrong with it.
    Bad(String),
    Nothing,
}

/// A product while it is being read.
struct Product {
    over: f64,
    under: f64,
    pi: i32,
    factors: usize,
    decimals: Decimals,
}

/// Why a product cannot be read; `None` if there is no product at all.
type Failure = Option<String>;

/// Reads a number with its unit and moves past it; otherwise the cursor does not move.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Parsed {
    let start = *cursor;
    let mut product = Product {
        over: 1.0,
        under: 1.0,
        pi: 0,
        factors: 0,
        decimals: Decimals::Point,
    };
    let outcome = product.read(cursor, 0).and_then(|()| product.value());
    match outcome {
        Ok((number, times_pi)) => {
            let unit = unit(cursor);
            Parsed::Quantity(Quantity {
                number,
                times_pi,
                unit,
                decimals: product.decimals,
            })
        }
        Err(why) => {
            *cursor = start;
            why.map_or(Parsed::Nothing, Parsed::Bad)
        }
    }
}

impl Product {
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
    fn read(&mut self, cursor: &mut Cursor<'_>, depth: usize) -> Result<(), Failure> {
        if depth > MAX_DEPTH {
            return Err(Some("it has too many brackets".to_owned()));
        }
        if sign(cursor)? {
            self.over = -self.over;
        }
        self.factor(cursor, depth, Line::Above)?;
        loop {
            let before = *cursor;
            blanks(cursor);
            let line = if eat_any(cursor, &['*', '×', '·', '⋅'])
                || cursor.eat_word("times")
                || cursor.eat_word("cdot")
            {
                Line::Above
            } else if eat_any(cursor, &['/', '÷', '∕', '⁄']) {
                Line::Below
            } else if starts_pi(cursor) {
                Line::Above
            } else {
                *cursor = before;
                return Ok(());
            };
            blanks(cursor);
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

    fn factor(&mut self, cursor: &mut Cursor<'_>, depth: usize, line: Line) -> Result<(), Failure> {
        self.factors += 1;
        if self.factors > MAX_FACTORS {
            return Err(Some("it has too many factors".to_owned()));
        }
        cursor.skip(|character| character == '\\' || character == '$');
        if eat_pi(cursor) {
            self.pi += if matches!(line, Line::Above) { 1 } else { -1 };
            return Ok(());
        }
        if cursor.eat_word("frac") || cursor.eat_word("dfrac") || cursor.eat_word("tfrac") {
            self.inside(cursor, depth, line, ['{', '}'])?;
            return self.inside(cursor, depth, line.other(), ['{', '}']);
        }
        if matches!(cursor.peek(), Some('(' | '（')) {
            return self.inside(cursor, depth, line, ['(', ')']);
        }
        let (number, decimals) = number(cursor)?;
        if decimals == Decimals::Comma {
            self.decimals = Decimals::Comma;
        }
        match line {
            Line::Above => self.over *= number,
            Line::Below => self.under *= number,
        }
        Ok(())
    }

    /// Reads a product in brackets.
    fn inside(
        &mut self,
        cursor: &mut Cursor<'_>,
        depth: usize,
        line: Line,
        [open, close]: [char; 2],
    ) -> Result<(), Failure> {
        let is_open = cursor.eat(open) || (open == '(' && cursor.eat('（'));
        if !is_open {
            return Err(None);
        }
        blanks(cursor);
        let mut inner = Product {
            over: 1.0,
            under: 1.0,
            pi: 0,
            factors: self.factors,
            decimals: self.decimals,
        };
        inner.read(cursor, depth + 1)?;
        blanks(cursor);
        let is_closed = cursor.eat(close) || (close == ')' && cursor.eat('）'));
        if !is_closed {
            return Err(None);
        }
        (self.factors, self.decimals) = (inner.factors, inner.decimals);
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

/// Skips a sign; returns whether it negates.
fn sign(cursor: &mut Cursor<'_>) -> Result<bool, Failure> {
    if cursor.eat('-') {
        if cursor.peek().is_some_and(char::is_whitespace) {
            return Err(Some("its `-` can be a minus or a bullet".to_owned()));
        }
        return Ok(true);
    }
    let is_negative =
        eat_any(cursor, &MINUS) || cursor.eat_word("minus") || cursor.eat_word("negative");
    if !is_negative {
        eat_any(cursor, &['+', '＋']);
    }
    blanks(cursor);
    Ok(is_negative)
}

/// Characters used as a minus sign, besides a hyphen.
const MINUS: [char; 3] = ['−', '－', '﹣'];

fn starts_pi(cursor: &Cursor<'_>) -> bool {
    let mut ahead = *cursor;
    ahead.skip(|character| character == '\\');
    eat_pi(&mut ahead)
}

fn eat_pi(cursor: &mut Cursor<'_>) -> bool {
    eat_any(cursor, &['π', '𝜋', 'Π']) || cursor.eat_word("pi")
}

/// Skips decoration on the same line.
pub(super) fn skip_decoration(cursor: &mut Cursor<'_>) {
    cursor.skip(|character| {
        matches!(character, ' ' | '\t' | '\u{a0}' | '\u{202f}') || decorates(character)
    });
}
