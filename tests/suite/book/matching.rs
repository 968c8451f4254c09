//! Compares the output that a page shows with a command's real output.
//!
//! In: both texts, and the beginnings of lines whose numbers vary. A line `...` matches any lines, `[..]` any
//! characters of a line. Values of durations, and all numbers of a varying line, are ignored, so that a page may show
//! one; so is trailing whitespace.

/// Matches any lines.
const ANY_LINES: &str = "...";

/// Matches any characters within a line.
const ANY_LETTERS: &str = "[..]";

/// Units that mark a number as a duration.
const UNITS_OF_TIME: [&str; 4] = ["s", "ms", "min", "seconds"];

/// Returns whether a command's output matches its page.
pub fn fits(stated: &str, printed: &str, varying: &[String]) -> bool {
    let comparable = |text: &str| -> Vec<String> {
        let lines = text.lines();
        lines.map(|line| comparable(line, varying)).collect()
    };
    lines_fit(&comparable(stated), &comparable(printed))
}

/// Returns the page's new text: the real output where it differs, otherwise the page's own text.
pub fn refreshed(stated: &str, printed: &str, varying: &[String]) -> String {
    if fits(stated, printed, varying) {
        return stated.to_owned();
    }
    let refresh = |line: &str| {
        let printed = comparable(line, varying);
        let kept = stated
            .lines()
            .find(|kept| *kept != ANY_LINES && line_fits(&comparable(kept, varying), &printed));
        format!("{}\n", kept.unwrap_or(line.trim_end()))
    };
    printed.lines().map(refresh).collect()
}

fn lines_fit(stated: &[String], printed: &[String]) -> bool {
    match stated.split_first() {
        None => printed.is_empty(),
        Some((first, rest)) if first == ANY_LINES => {
            (0..=printed.len()).any(|skipped| lines_fit(rest, &printed[skipped..]))
        }
        Some((first, rest)) => printed
            .split_first()
            .is_some_and(|(line, others)| line_fits(first, line) && lines_fit(rest, others)),
    }
}

fn line_fits(stated: &str, printed: &str) -> bool {
    match stated.split_once(ANY_LETTERS) {
        None => stated == printed,
        Some((before, after)) => printed.strip_prefix(before).is_some_and(|rest| {
            let mut ends = (0..=rest.len()).filter(|at| rest.is_char_boundary(*at));
            ends.any(|at| line_fits(after, &rest[at..]))
        }),
    }
}

/// A line without the numbers of its durations, or without any numbers if it varies.
fn comparable(line: &str, varying: &[String]) -> String {
    if varying.iter().any(|beginning| line.starts_with(beginning)) {
        let is_part = |letter: char| letter.is_ascii_digit() || letter == '.';
        let words = line.split_whitespace();
        let words = words.map(|word| word.trim_matches(is_part));
        return words.collect::<Vec<_>>().join(" ");
    }
    let words: Vec<&str> = line.trim_end().split(' ').collect();
    let is_duration = |index: usize| {
        let unit = words.get(index + 1).copied().unwrap_or_default();
        let unit = unit.trim_end_matches([',', '.', ')', ':']);
        words[index].parse::<f64>().is_ok() && UNITS_OF_TIME.contains(&unit)
    };
    let shown = (0..words.len()).map(|index| {
        if is_duration(index) {
            "N"
        } else {
            words[index]
        }
    });
    shown.collect::<Vec<_>>().join(" ")
}

#[test]
fn what_a_page_states_fits_what_is_printed_and_nothing_else() {
    let varying = ["MB".to_owned()];
    for (stated, printed, expected) in [
        ("MB  12.1 of 3\n", "MB   7 of 4.5\n", true),
        ("MB  12.1 of 3\n", "MB   7 in 4.5\n", false),
        ("GB 12\n", "GB 13\n", false),
        ("one\n", "one\n", true),
        ("one\n", "one  \n", true),
        ("one\n", "one\ntwo\n", false),
        ("one\ntwo\n", "one\n", false),
        ("one\n...\n", "one\ntwo\nthree\n", true),
        ("one\n...\nfour\n", "one\ntwo\nthree\n", false),
        ("...\n", "", true),
        ("to [..].npy\n", "to a b.npy\n", true),
        ("to [..].npy\n", "to a.obj\n", false),
        ("done in 3.4 s, ok\n", "done in 12 s, ok\n", true),
        ("done in 3.4 mm\n", "done in 12 mm\n", false),
    ] {
        assert_eq!(
            fits(stated, printed, &varying),
            expected,
            "{stated:?} {printed:?}"
        );
    }
}

#[test]
fn a_page_keeps_the_lines_that_still_fit_when_it_is_refreshed() {
    let stated = "took 3 s\nfile [..].npy\nold\n";
    let printed = "took 9 s\nfile a.npy\nnew\n";
    assert_eq!(
        refreshed(stated, printed, &[]),
        "took 3 s\nfile [..].npy\nnew\n"
    );
    assert_eq!(refreshed("...\n", printed, &[]), "...\n");
}
