//! Finds the word that was probably meant, and lists candidates.

use super::diagnostic::Diagnostic;

/// The most candidates per message. With all of them, a file full of errors would take quadratic time.
const MOST_LOOKED_AT: usize = 200;

/// Returns the candidate nearest to `word`, within an edit distance of `max(1, len / 3)`.
///
/// Of equally near candidates the first wins. Words and lists far longer than anyone writes are not searched to the
/// end.
pub fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    const LONGEST: usize = 40;
    if word.len() > LONGEST {
        return None;
    }
    let word = lower_case(word);
    let mut limit = (word.chars().count() / 3).max(1);
    let mut best = None;
    for candidate in candidates
        .into_iter()
        .take(MOST_LOOKED_AT)
        .filter(|name| name.len() <= LONGEST)
    {
        let distance = strsim::osa_distance(&word, &lower_case(candidate));
        if distance <= limit {
            best = Some(candidate);
            // From here on, only a nearer candidate counts.
            match distance.checked_sub(1) {
                Some(nearer) => limit = nearer,
                None => break,
            }
        }
    }
    best
}

impl Diagnostic {
    /// Offers the candidate nearest to the word that it is about, or lists all; `none` is the help if there are none.
    pub(crate) fn suggest<'c>(
        self,
        word: &str,
        candidates: impl IntoIterator<Item = &'c str>,
        none: &str,
    ) -> Diagnostic {
        let candidates: Vec<&str> = candidates.into_iter().collect();
        let span = self.span;
        match nearest(word, candidates.iter().copied()) {
            Some(meant) => self.meant(span, meant),
            None if candidates.is_empty() => self.help(none),
            None => self.help(format!("there is {}", among(candidates))),
        }
    }
}

fn lower_case(word: &str) -> String {
    word.chars().flat_map(char::to_lowercase).collect()
}

/// Lists names as `a`, `b` or `c`, at most twelve.
pub fn among<'c>(names: impl IntoIterator<Item = &'c str>) -> String {
    const MOST: usize = 12;
    let mut all = names.into_iter();
    let names: Vec<String> = all
        .by_ref()
        .take(MOST)
        .map(|name| format!("`{name}`"))
        .collect();
    let more = all.take(MOST_LOOKED_AT).count();
    match names.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] if more == 0 => format!("{} or {last}", first.join(", ")),
        _ if more == MOST_LOOKED_AT => format!("{} or many more", names.join(", ")),
        _ => format!("{} or {more} more", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swap_of_neighbours_is_one_slip() {
        assert_eq!(nearest("cneter", ["corners", "center"]), Some("center"));
        assert_eq!(nearest("stgae", ["stage"]), Some("stage"));
    }

    #[test]
    fn a_far_word_is_not_suggested() {
        assert_eq!(nearest("ab", ["goal"]), None);
        assert_eq!(nearest("verfy", ["goal", "verify"]), Some("verify"));
    }

    #[test]
    fn the_limit_is_a_third_of_the_word() {
        assert_eq!(nearest("kitten", ["mittens"]), Some("mittens"));
        assert_eq!(nearest("kitten", ["sitting"]), None);
    }

    #[test]
    fn lists_that_are_long_are_cut() {
        let names: Vec<String> = (0..20).map(|number| number.to_string()).collect();
        let listed = among(names.iter().map(String::as_str));
        assert!(listed.ends_with("`11` or 8 more"), "{listed}");
        let listed = among(std::iter::repeat_n("corner", 1000));
        assert!(listed.ends_with("`corner` or many more"), "{listed}");
    }
}
