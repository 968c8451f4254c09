//! Blanks out thoughts, control tokens, quotations and struck-out text.
//!
//! In: an answer. Out: the same text with blanks there, each byte in its place. Control tokens are recognised by their
//! shape, because every family of models brings its own: `<|im_end|>`, `<turn|>`, `<｜end▁of▁sentence｜>`, `[EOS]`.

use std::ops::Range;

/// Why a part of an answer states nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aside {
    /// `<think>…</think>` and its like.
    Thought,
    /// `> …`
    Quotation,
    /// `~~…~~`
    StruckOut,
    /// `<|im_end|>` and other control tokens.
    Token,
}

/// An answer without what states nothing.
pub struct Standing {
    /// The answer, of the same length; asides are blanks.
    pub text: String,
    /// What was set aside, in order; a part may lie within another.
    pub asides: Vec<(Range<usize>, Aside)>,
    /// Whether a thought never ends, so that the answer is missing.
    pub is_cut_off: bool,
}

/// What a control token contains if it opens or closes a thought.
const THOUGHTS: [&str; 6] = [
    "think",
    "thought",
    "reason",
    "analysis",
    "scratchpad",
    "commentary",
];

/// Words in tokens that a role or a channel follows: `<|start|>assistant`.
const ROLES: [&str; 4] = ["channel", "start", "turn", "role"];

/// The longest control token, bytes.
const MAX_TOKEN: usize = 80;

/// Sets aside what an answer does not state, in time linear in its length.
pub fn standing(reply: &str) -> Standing {
    let mut scan = Scan {
        text: reply,
        asides: Vec::new(),
        open: None,
    };
    scan.bare_analysis();
    scan.tokens();
    let (is_cut_off, mut asides) = (scan.open.is_some(), scan.asides);
    let open = scan.open.map(|(start, _)| start..reply.len());
    asides.extend(open.map(|span| (span, Aside::Thought)));
    quoted(reply, &mut asides);
    struck(reply, &mut asides);
    asides.sort_by_key(|(span, _)| (span.start, std::cmp::Reverse(span.end)));
    Standing {
        text: blanked(reply, asides.iter().map(|(span, _)| span.clone())),
        asides,
        is_cut_off,
    }
}

/// Replaces parts of a text by blanks; line breaks stay.
///
/// - `spans`: in the order of where they begin.
pub(super) fn blanked(text: &str, spans: impl IntoIterator<Item = Range<usize>>) -> String {
    let mut kept = String::with_capacity(text.len());
    for span in spans {
        if span.end <= kept.len() {
            continue;
        }
        kept.push_str(&text[kept.len()..span.start.max(kept.len())]);
        let blank = |byte: u8| if byte == b'\n' { '\n' } else { ' ' };
        kept.extend(text[kept.len()..span.end].bytes().map(blank));
    }
    kept.push_str(&text[kept.len()..]);
    kept
}

struct Scan<'t> {
    text: &'t str,
    asides: Vec<(Range<usize>, Aside)>,
    /// Where the thought that has not ended yet begins, and whether a channel opened it.
    open: Option<(usize, Opened)>,
}

/// What opened a thought, which decides what closes it.
#[derive(Clone, Copy)]
enum Opened {
    /// `<think>`: a closing token of the kind.
    ByToken,
    /// `<|channel|>analysis`: any token but `<|message|>`.
    ByChannel,
}

impl Scan<'_> {
    /// gpt-oss without its control tokens: `analysisThe arrow … assistantfinalPick Point = …`.
    fn bare_analysis(&mut self) {
        const CLOSES: [&str; 2] = ["assistantfinal", "\nfinal\n"];
        let Some(thought) = self.text.trim_start().strip_prefix("analysis") else {
            return;
        };
        let begins = |letter: char| letter.is_alphanumeric() || letter == '\n';
        let end = |close: &&str| Some(self.text.find(*close)? + close.len());
        match CLOSES.iter().find_map(end) {
            Some(end) => self.asides.push((0..end, Aside::Thought)),
            None if thought.trim_start_matches(' ').starts_with(begins) => {
                self.open = Some((0, Opened::ByToken));
            }
            None => {}
        }
    }

    fn tokens(&mut self) {
        let mut at = 0;
        while let Some(found) = self.text[at..].find(['<', '[', '◁']) {
            at += found;
            let rest = &self.text[at..];
            at = match Token::at_start_of(rest) {
                Some(token) => self.token(at, &token),
                None => at + rest.chars().next().map_or(1, char::len_utf8),
            };
        }
    }

    /// Takes a control token into account; returns where to go on.
    fn token(&mut self, at: usize, token: &Token<'_>) -> usize {
        let end = at + token.length;
        let is_thought = is_thought(token.word);
        match self.open {
            Some((start, Opened::ByToken)) if is_thought && token.closes => {
                self.asides.push((start..end, Aside::Thought));
                self.open = None;
            }
            Some((start, Opened::ByChannel)) if token.is_special && token.word != "message" => {
                self.asides.push((start..at, Aside::Thought));
                self.open = None;
                return at;
            }
            // The server had opened the thought already.
            None if is_thought && token.closes => self.asides.push((0..end, Aside::Thought)),
            None if is_thought => self.open = Some((at, Opened::ByToken)),
            None if token.is_special => {
                let behind = &self.text[end..];
                let names_role = ROLES.iter().any(|word| token.word.contains(word));
                let is_role = |letter: &u8| names_role && letter.is_ascii_lowercase();
                let role = behind.bytes().take_while(is_role).count();
                if !token.closes && self::is_thought(&behind[..role]) {
                    self.open = Some((at, Opened::ByChannel));
                } else {
                    self.asides.push((at..end + role, Aside::Token));
                }
                return end + role;
            }
            _ => {}
        }
        end
    }
}

/// A control token, or a tag.
struct Token<'t> {
    /// Without brackets, bars and slash.
    word: &'t str,
    /// Bytes.
    length: usize,
    closes: bool,
    /// Whether only models write it: it has bars, or is a word in capitals in square brackets.
    is_special: bool,
}

impl Token<'_> {
    fn at_start_of(text: &str) -> Option<Token<'_>> {
        let is_bar = |letter: char| matches!(letter, '|' | '｜');
        let open = text.chars().next()?;
        let close = match open {
            '<' => '>',
            '[' => ']',
            _ => '▷',
        };
        let most = text.floor_char_boundary(MAX_TOKEN);
        let (inside, _) = text[open.len_utf8()..most].split_once(close)?;
        if inside.contains('\n') {
            return None;
        }
        let slashed = inside.trim_start_matches(is_bar);
        let barred = slashed.trim_start_matches('/');
        let word = barred.trim_end_matches(is_bar);
        let (has_bar, ends_with_bar) = (slashed.len() < inside.len(), word.len() < barred.len());
        // A tag may have attributes.
        let is_letter = |letter: char| letter.is_alphanumeric() || "_-.:▁".contains(letter);
        let length = word.find(|letter| !is_letter(letter)).unwrap_or(word.len());
        let is_whole = length == word.len();
        let word = &word[..length];
        let is_capitals = word.len() > 1 && !word.contains(|it: char| it.is_lowercase());
        let is_special = match open {
            '<' => has_bar || ends_with_bar,
            '[' => is_capitals,
            _ => true,
        };
        let is_token = match open {
            '[' => is_whole && is_capitals,
            _ => is_whole || !is_special,
        };
        let ends = word.split(|letter: char| !letter.is_alphanumeric());
        let ends = { ends }.any(|part| part.eq_ignore_ascii_case("end"));
        (word.contains(char::is_alphabetic) && is_token).then_some(Token {
            word,
            length: 2 * open.len_utf8() + inside.len(),
            closes: slashed.len() > barred.len() || ends || (ends_with_bar && !has_bar),
            is_special,
        })
    }
}

fn is_thought(word: &str) -> bool {
    let word = word.to_ascii_lowercase();
    THOUGHTS.iter().any(|part| word.contains(part))
}

fn quoted(reply: &str, asides: &mut Vec<(Range<usize>, Aside)>) {
    let mut at = 0;
    for line in reply.split_inclusive('\n') {
        if line.trim_start().starts_with('>') {
            asides.push((at..at + line.trim_end().len(), Aside::Quotation));
        }
        at += line.len();
    }
}

fn struck(reply: &str, asides: &mut Vec<(Range<usize>, Aside)>) {
    const MARK: &str = "~~";
    let mut at = 0;
    while let Some(start) = reply[at..].find(MARK).map(|found| at + found) {
        let inside = &reply[start + MARK.len()..];
        let Some(length) = inside.find(MARK) else {
            break;
        };
        at = start + MARK.len() + length;
        // A fence of tildes strikes nothing out, and nothing does so over paragraphs.
        if !inside.starts_with('~') && !inside[..length].contains("\n\n") {
            at += MARK.len();
            asides.push((start..at, Aside::StruckOut));
        }
    }
}
