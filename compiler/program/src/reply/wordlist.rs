//! Lists of words and of phrases, written as text: whether a word is in one, whether a text has a phrase of one.

/// Cuts a text into its words, when the program is compiled.
macro_rules! words {
    ($text:literal) => {{
        const COUNT: usize = $crate::reply::wordlist::count($text);
        const WORDS: &[&str; COUNT] = &$crate::reply::wordlist::split::<COUNT>($text);
        WORDS
    }};
}
pub(super) use words;

/// Nouns after a side: `to the left corner` is a place.
pub(super) const PLACES: &[&str] = words!(
    "corner corners edge edges side hem flap layer part half end tip of sleeve border point wrinkle fold crease"
);

/// What makes a sentence about a motion none about the answer's own.
pub(super) const UNREAL: &[&str] = words!(
    "not no never n't would could might may cannot can't don't shouldn't instead rather than avoid avoids without
    previous previously earlier last had was were been next then later after if unless when before already other
    attempt attempts try tried tries wanted planned intended ago already another opposite itself eventually finally rest neighbouring neighboring while whereas went said doesn't isn't won't didn't wouldn't couldn't aren't"
);

/// Returns whether a word is one of these, in any case.
pub(super) fn is_any(word: &str, words: &[&str]) -> bool {
    words.iter().any(|it| word.eq_ignore_ascii_case(it))
}

/// Returns whether a text with blanks around each word has one of these phrases: `values below|answer below`.
pub(super) fn says(text: &str, phrases: &str) -> bool {
    phrases.split('|').any(|phrase| {
        !phrase.is_empty()
            && text.match_indices(' ').any(|(blank, _)| {
                text[blank + 1..]
                    .strip_prefix(phrase)
                    .is_some_and(|rest| rest.starts_with(' '))
            })
    })
}

/// Returns the number of words of a text.
pub(super) const fn count(text: &str) -> usize {
    let bytes = text.as_bytes();
    let (mut count, mut at) = (0, 0);
    while at < bytes.len() {
        let begins = at == 0 || bytes[at - 1].is_ascii_whitespace();
        if begins && !bytes[at].is_ascii_whitespace() {
            count += 1;
        }
        at += 1;
    }
    count
}

/// Returns the words of a text.
pub(super) const fn split<const COUNT: usize>(text: &'static str) -> [&'static str; COUNT] {
    let mut words = [""; COUNT];
    let (mut rest, mut index) = (text.trim_ascii(), 0);
    while index < COUNT {
        let bytes = rest.as_bytes();
        let mut length = 0;
        while length < bytes.len() && !bytes[length].is_ascii_whitespace() {
            length += 1;
        }
        let (word, behind) = rest.split_at(length);
        (words[index], rest) = (word, behind.trim_ascii());
        index += 1;
    }
    words
}
