//! Tests of `report`.

use super::*;

#[test]
fn a_rehearsed_step_names_the_taken_answer_and_the_first_by_measure_and_place() {
    let said = |measures: &[Option<f64>], taken: Option<u32>| {
        // The first question of all had no usable answer, so the answers' numbers begin at 2.
        let candidates = measures.iter().zip(2..).map(|(measure, attempt)| {
            let (measure, twins, failed) = (*measure, Vec::new(), None);
            RehearsedAnswer {
                attempt,
                measure,
                twins,
                failed,
            }
        });
        rehearsed(&candidates.collect::<Vec<_>>(), taken, 4.72)
    };
    let four = [Some(0.41), Some(0.93), Some(0.9), None];
    let rows = [
        (
            said(&four, Some(3)),
            "4 answers, answer 2 taken (0.93) in place of the first (0.41), 4.7 s",
        ),
        (
            said(&four[..1], Some(2)),
            "1 answer, the first taken (0.41), 4.7 s",
        ),
        (
            said(&[None, None, None], Some(4)),
            "3 answers, answer 3 taken (no measure) in place of the first (no measure), 4.7 s",
        ),
        (said(&[], None), "0 answers, none taken, 4.7 s"),
    ];
    for (said, expected) in rows {
        assert_eq!(said, format!("rehearsed: {expected}"));
    }
}
