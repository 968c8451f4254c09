//! Tests of `operator`.

use super::*;

fn answered(typed: &str) -> (Option<Judgement>, usize) {
    let mut questions = 0;
    let mut lines = typed.as_bytes();
    let judgement = asked(&mut || terminal::line_of(&mut lines), &mut |_| {
        questions += 1
    });
    (judgement, questions)
}

fn judgement(reached: bool, why: Option<Cause>, words: Option<&str>) -> Option<Judgement> {
    let words = words.map(str::to_owned);
    Some(Judgement {
        reached,
        why,
        words,
    })
}

#[test]
fn answers_are_understood_and_others_asked_for_again() {
    for (typed, expected, questions) in [
        ("y\n\n", judgement(true, None, None), 2),
        ("YES\nas told\n", judgement(true, None, Some("as told")), 2),
        ("n\nh\n\n", judgement(false, Some(Cause::Hardware), None), 3),
        (
            "perhaps\n\nno\nx\ndetection\ntwo corners lay hidden",
            judgement(
                false,
                Some(Cause::Detection),
                Some("two corners lay hidden"),
            ),
            6,
        ),
        (
            "n\nreason\n",
            judgement(false, Some(Cause::Reasoning), None),
            3,
        ),
        ("", None, 1),
        ("n\n", None, 2),
    ] {
        assert_eq!(answered(typed), (expected, questions), "{typed:?}");
    }
    assert_eq!(
        answered(&"what\n".repeat(50)),
        (None, terminal::ATTEMPTS as usize)
    );
}

#[test]
fn a_line_without_end_is_cut() {
    let long = format!("y\n{}", "a".repeat(1 << 20));
    let (judgement, _) = answered(&long);
    let words = judgement.and_then(|it| it.words).expect("there are words");
    assert_eq!(words.len(), terminal::MAX_LINE as usize);
}
