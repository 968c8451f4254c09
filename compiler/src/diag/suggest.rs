//! Finds the word that was probably meant, and lists the words there are.

/// Returns the candidate nearest to `word`, within an edit distance of `max(1, len / 3)`.
///
/// The first of equally near ones wins, so the order of the candidates decides. Words and lists far beyond
/// what people write are not searched: time would grow with the square of the file.
pub(crate) fn nearest<'c>(
    word: &str,
    candidates: impl IntoIterator<Item = &'c str>,
) -> Option<&'c str> {
    const MOST: usize = 200;
    const LONGEST: usize = 64;
    if word.len() > LONGEST {
        return None;
    }
    let limit = (word.chars().count() / 3).max(1);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates
        .into_iter()
        .take(MOST)
        .filter(|name| name.len() <= LONGEST)
    {
        let distance = edit_distance(word, candidate);
        if distance <= limit && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// Writes names as `a`, `b` or `c`, at most twelve of them.
pub(crate) fn among<'c>(names: impl IntoIterator<Item = &'c str>) -> String {
    const MOST: usize = 12;
    let all: Vec<&str> = names.into_iter().collect();
    let count = all.len();
    let names: Vec<String> = all
        .iter()
        .take(MOST)
        .map(|name| format!("`{name}`"))
        .collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] if count <= MOST => format!("{} or {last}", first.join(", ")),
        _ => format!("{} or {} more", names.join(", "), count - MOST),
    }
}

/// Counts insertions, deletions, replacements and swaps of neighbours, regardless of case.
fn edit_distance(from: &str, to: &str) -> usize {
    let from: Vec<char> = from.to_lowercase().chars().collect();
    let to: Vec<char> = to.to_lowercase().chars().collect();
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for i in 1..=from.len() {
        let mut row = vec![i];
        for j in 1..=to.len() {
            let replaced = last[j - 1] + usize::from(from[i - 1] != to[j - 1]);
            let mut least = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            let swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
            if swapped {
                least = least.min(before_last[j - 2] + 1);
            }
            row.push(least);
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swap_of_neighbours_is_one_slip() {
        assert_eq!(nearest("cneter", ["corners", "center"]), Some("center"));
        assert_eq!(edit_distance("stgae", "stage"), 1);
    }

    #[test]
    fn a_far_word_is_not_suggested() {
        assert_eq!(nearest("ab", ["goal"]), None);
        assert_eq!(nearest("verfy", ["goal", "verify"]), Some("verify"));
    }

    #[test]
    fn lists_that_are_long_are_cut() {
        let names: Vec<String> = (0..20).map(|number| number.to_string()).collect();
        let listed = among(names.iter().map(String::as_str));
        assert!(listed.ends_with("`11` or 8 more"), "{listed}");
    }
}
