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
mod tests;
