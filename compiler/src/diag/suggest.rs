//! Finds the word that was probably meant, and lists candidates.

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
    let mut limit = (word.len() / 3).max(1);
    let mut best = None;
    for candidate in candidates
        .into_iter()
        .take(MOST_LOOKED_AT)
        .filter(|name| name.len() <= LONGEST)
    {
        if let Some(distance) = edit_distance(&word, &lower_case(candidate), limit) {
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

fn lower_case(word: &str) -> Vec<char> {
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

/// Counts insertions, deletions, replacements and swaps of neighbours; `None` if there are more than `limit`.
fn edit_distance(from: &[char], to: &[char], limit: usize) -> Option<usize> {
    if from.len().abs_diff(to.len()) > limit {
        return None;
    }
    let far = limit + 1;
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for i in 1..=from.len() {
        let mut row = vec![far; to.len() + 1];
        row[0] = i;
        // Cells further from the diagonal are beyond the limit anyway.
        let band = i.saturating_sub(limit).max(1)..=(i + limit).min(to.len());
        let mut nearest = row[0];
        for j in band {
            let replaced = last[j - 1] + usize::from(from[i - 1] != to[j - 1]);
            let mut least = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            let swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
            if swapped {
                least = least.min(before_last[j - 2] + 1);
            }
            row[j] = least;
            nearest = nearest.min(least);
        }
        // A swap looks back one row, so the search ends only after two rows beyond the limit.
        let is_lost = nearest > limit && last.iter().all(|distance| *distance > limit);
        if is_lost {
            return None;
        }
        before_last = std::mem::replace(&mut last, row);
    }
    Some(last[to.len()]).filter(|distance| *distance <= limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(from: &str, to: &str, limit: usize) -> Option<usize> {
        edit_distance(&lower_case(from), &lower_case(to), limit)
    }

    #[test]
    fn a_swap_of_neighbours_is_one_slip() {
        assert_eq!(nearest("cneter", ["corners", "center"]), Some("center"));
        assert_eq!(distance("stgae", "stage", 3), Some(1));
    }

    #[test]
    fn a_distance_beyond_the_limit_is_not_returned() {
        assert_eq!(distance("kitten", "sitting", 3), Some(3));
        assert_eq!(distance("kitten", "sitting", 2), None);
        assert_eq!(distance("", "ab", 2), Some(2));
        assert_eq!(distance("abcdefgh", "bcdefgh", 1), Some(1));
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
        let listed = among(std::iter::repeat_n("corner", 1000));
        assert!(listed.ends_with("`corner` or many more"), "{listed}");
    }
}
