//! Lays out expressions: on one line if they fit, otherwise with one argument per line.
//!
//! Rust and Python agree on the shape of calls, lists and comparisons, so one tree serves both.

/// The most characters in a line.
const WIDTH: usize = 100;

/// An expression of the emitted code.
#[derive(Clone, Debug)]
pub(super) enum Code {
    /// A literal piece of code.
    Text(String),
    /// Parts between two brackets, separated by commas.
    Group {
        open: String,
        parts: Vec<Code>,
        close: String,
    },
    /// One part between two brackets, without a comma: with one, Python would read a tuple.
    Wrapped {
        open: &'static str,
        part: Box<Code>,
        close: &'static str,
    },
    /// Parts in brackets with an operator between them, evaluated from left to right until the result is certain.
    Joined {
        sign: &'static str,
        parts: Vec<Code>,
    },
    /// Two sides and the sign between them.
    Infix {
        left: Box<Code>,
        sign: &'static str,
        right: Box<Code>,
    },
}

impl Code {
    pub fn text(text: impl Into<String>) -> Code {
        Code::Text(text.into())
    }

    pub fn group(
        open: impl Into<String>,
        parts: impl IntoIterator<Item = Code>,
        close: impl Into<String>,
    ) -> Code {
        Code::Group {
            open: open.into(),
            parts: parts.into_iter().collect(),
            close: close.into(),
        }
    }

    pub fn infix(left: Code, sign: &'static str, right: Code) -> Code {
        Code::Infix {
            left: Box::new(left),
            sign,
            right: Box::new(right),
        }
    }

    pub fn wrapped(open: &'static str, part: Code, close: &'static str) -> Code {
        Code::Wrapped {
            open,
            part: Box::new(part),
            close,
        }
    }

    /// Prints the expression after `before` characters on its first line, indented by `indent` blanks.
    pub fn print(&self, before: usize, indent: usize) -> String {
        let flat = self.flat();
        if before + flat.len() <= WIDTH {
            return flat;
        }
        match self {
            Code::Text(text) => text.clone(),
            Code::Group { open, parts, close } => {
                let inner = indent + 4;
                let margin = " ".repeat(inner);
                let lines: Vec<String> = parts
                    .iter()
                    .map(|part| format!("{margin}{},\n", part.print(inner + 1, inner)))
                    .collect();
                format!("{open}\n{}{}{close}", lines.concat(), " ".repeat(indent))
            }
            Code::Joined { sign, parts } => {
                let inner = indent + 4;
                let margin = " ".repeat(inner);
                let line = |(number, part): (usize, &Code)| {
                    let before = if number == 0 {
                        String::new()
                    } else {
                        format!("{sign} ")
                    };
                    let part = part.print(inner + before.len(), inner);
                    format!("{margin}{before}{part}\n")
                };
                let lines: String = parts.iter().enumerate().map(line).collect();
                format!("(\n{lines}{})", " ".repeat(indent))
            }
            Code::Wrapped { open, part, close } => {
                let part = part.print(before + open.len() + close.len(), indent);
                format!("{open}{part}{close}")
            }
            Code::Infix { left, sign, right } => {
                let left = left.print(before, indent);
                let behind_left = match left.rsplit_once('\n') {
                    Some((_, last_line)) => last_line.len(),
                    None => before + left.len(),
                };
                let right = right.print(behind_left + sign.len() + 2, indent);
                format!("{left} {sign} {right}")
            }
        }
    }

    fn flat(&self) -> String {
        match self {
            Code::Text(text) => text.clone(),
            Code::Group { open, parts, close } => {
                let parts: Vec<String> = parts.iter().map(Code::flat).collect();
                format!("{open}{}{close}", parts.join(", "))
            }
            Code::Joined { sign, parts } => {
                let parts: Vec<String> = parts.iter().map(Code::flat).collect();
                format!("({})", parts.join(&format!(" {sign} ")))
            }
            Code::Wrapped { open, part, close } => format!("{open}{}{close}", part.flat()),
            Code::Infix { left, sign, right } => {
                format!("{} {sign} {}", left.flat(), right.flat())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expression_is_on_one_line_if_it_fits_and_no_line_is_too_long() {
        for n_letters in 2..=120 {
            let half = || Code::text("x".repeat(n_letters / 2));
            let other = || Code::text("x".repeat(n_letters - n_letters / 2));
            let pair = || Code::group("f(", [half(), other()], ")");
            let joined = |parts| Code::Joined { sign: "and", parts };
            for code in [
                pair(),
                Code::group("[", [pair(), pair()], "]"),
                joined(vec![pair(), pair()]),
                Code::wrapped("not (", pair(), ")"),
                Code::wrapped("not (", joined(vec![half(), half()]), ")"),
                Code::infix(Code::text("1"), "<=", pair()),
                Code::infix(half(), "<=", Code::text("1")),
            ] {
                let text = code.print(11, 4);
                let is_short = 11 + code.flat().len() <= WIDTH;
                let one_word_is_left = matches!(code, Code::Infix { .. });
                assert!(
                    is_short != text.contains('\n') || one_word_is_left,
                    "{text}"
                );
                let text = format!("{}{text}", " ".repeat(11));
                let longest = text.lines().map(str::len).max();
                assert!(longest <= Some(WIDTH), "{text}");
            }
            // A part is broken only if it does not fit where it begins.
            let fits = |begin: usize| begin + pair().flat().len() <= WIDTH;
            let left = Code::wrapped("not (", Code::infix(pair(), "<", half()), ")");
            let is_whole = left
                .print(11, 4)
                .starts_with(&format!("not ({}", pair().flat()));
            assert_eq!(is_whole, fits(11 + "not ()".len()), "{n_letters}");
            let right = Code::infix(pair(), "<", pair());
            let is_whole = right
                .print(11, 4)
                .ends_with(&format!(" < {}", pair().flat()));
            let behind_left = match fits(11) {
                true => 11 + pair().flat().len(),
                false => "    )".len(),
            };
            assert_eq!(is_whole, fits(behind_left + " < ".len()), "{n_letters}");
        }
    }
}
