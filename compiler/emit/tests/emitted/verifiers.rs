//! The interpreter, emitted Rust and emitted Python give the same verdict on every case.

use super::case::Case;
use super::{drivers, oracle, programs, table, truth};
use fab_emit::Manifest;
use fab_program::measures::{MEASURES, Make};
use fab_program::{Condition, Program};
use std::collections::BTreeSet;

/// Asserts that all three verifiers agree with the interpreter, and returns their verdicts.
///
/// The interpreter runs on the program as read back from `program.json`.
fn agreed(program: &Program, cases: &[Case], test: &str) -> Option<Vec<[String; 2]>> {
    let built = drivers::build(program, test);
    let text = std::fs::read_to_string(built.folder.join("program.json")).unwrap();
    let manifest: Manifest = serde_json::from_str(&text).unwrap();
    assert_eq!(
        manifest.program, *program,
        "program.json gives other numbers back"
    );
    let said: Vec<[String; 2]> = cases
        .iter()
        .map(|case| case.judged(&manifest.program))
        .collect();
    let in_rust = drivers::by_rust(program, &built, cases);
    for ((case, ours), theirs) in cases.iter().zip(&said).zip(&in_rust) {
        assert_eq!(ours, theirs, "{}, Rust: {case:?}", program.task);
    }
    let python = drivers::python(test)?;
    let in_python = drivers::by_python(python, program, &built, cases);
    for ((case, ours), theirs) in cases.iter().zip(&said).zip(&in_python) {
        assert_eq!(ours, theirs, "{}, Python: {case:?}", program.task);
    }
    Some(said)
}

/// Asserts that a table covers every check and every limit, then that all three agree on it.
fn agree_on_a_table(name: &str, seed: u64) {
    let program = programs::named(name);
    let cases = table::generate(&program, seed);
    let n_checks = program.verify.checks.len();
    let mut near = 0;
    let mut near_each = vec![0; oracle::comparisons(&program)];
    let mut reached = vec![0; n_checks + 1];
    let mut refused = vec![0; n_checks + 2];
    let outcomes: Vec<_> = cases
        .iter()
        .map(|case| oracle::judge(&program, case))
        .collect();
    for outcome in &outcomes {
        let Some(said) = outcome.verdict else {
            continue;
        };
        refused[said] += 1;
        for check in &outcome.reached {
            reached[*check] += 1;
        }
        let close: BTreeSet<usize> = outcome
            .margins
            .iter()
            .filter(|(_, margin)| *margin <= 1.0)
            .map(|(comparison, _)| *comparison)
            .collect();
        near += usize::from(!close.is_empty());
        close
            .iter()
            .for_each(|comparison| near_each[*comparison] += 1);
    }
    assert!(cases.len() >= 10_000);
    assert!(
        2 * near >= cases.len(),
        "{near} of {} are close to a limit",
        cases.len()
    );
    assert!(
        near_each.iter().all(|near| *near >= 100),
        "close to each limit: {near_each:?}"
    );
    for (check, reached) in reached.iter().enumerate() {
        let refused = refused[check];
        assert!(
            10 * refused >= 3 * reached,
            "check {check} refuses {refused} of {reached}"
        );
    }
    assert!(
        refused[n_checks + 1] >= 100,
        "{} are accepted",
        refused[n_checks + 1]
    );

    let Some(said) = agreed(&program, &cases, name) else {
        return;
    };
    for ((case, outcome), [full, _]) in cases.iter().zip(&outcomes).zip(&said) {
        // If a limit is hit exactly, a root or an angle in degrees may round to either side.
        if outcome.margins.iter().any(|(_, margin)| *margin < 1e-9) {
            continue;
        }
        let expected = match outcome.verdict {
            None => full.starts_with("missing:"),
            Some(0) => full == "check:offered",
            Some(number) => match program.verify.checks.get(number - 1) {
                Some(check) => *full == format!("check:{}", check.name),
                None => full == "accept",
            },
        };
        assert!(expected, "{name}: {full} for {case:?}");
    }
    let missing = outcomes.iter().filter(|it| it.verdict.is_none()).count();
    assert_eq!(
        missing >= 100,
        name == "steered" || name == "placed",
        "something is missing in {missing} cases"
    );
    let lenient = said
        .iter()
        .filter(|[full, relaxed]| full != relaxed)
        .count();
    let relaxes = !program.verify.relaxed.is_empty();
    assert_eq!(
        lenient >= 100,
        relaxes,
        "fewer checks decide differently in {lenient} cases"
    );
}

#[test]
#[ignore = "long"]
fn three_verifiers_of_double_straight_agree() {
    agree_on_a_table("double_straight", 1);
}

#[test]
#[ignore = "long"]
fn three_verifiers_of_double_triangle_agree() {
    agree_on_a_table("double_triangle", 2);
}

#[test]
#[ignore = "long"]
fn three_verifiers_of_directions_lengths_and_words_agree() {
    agree_on_a_table("steered", 3);
}

#[test]
#[ignore = "long"]
fn three_verifiers_of_points_numbers_and_the_last_action_agree() {
    agree_on_a_table("placed", 4);
}

/// Asserts that the hand-made programs cover everything that a check can use.
#[test]
fn the_programs_use_everything_that_a_check_can_say() {
    let text: String = programs::all()
        .iter()
        .map(|program| serde_json::to_string(&program.verify).unwrap())
        .collect();
    for used in [
        r#""op":"all""#,
        r#""op":"any""#,
        r#""op":"not""#,
        r#""op":"lengths""#,
        r#""op":"angle""#,
        r#""op":"number""#,
        r#""op":"word""#,
        r#""op":"within""#,
        r#""op":"last""#,
        r#""point":"action""#,
        r#""point":"keypoint""#,
        r#""point":"last","end":"pick""#,
        r#""point":"last","end":"place""#,
        r#""point":"mirror""#,
        r#""point":"carried""#,
        r#""length":"constant""#,
        r#""length":"field""#,
        r#""heading":"field""#,
        r#""heading":"last""#,
        r#""heading":"from_to""#,
        r#""heading":"constant""#,
        r#""number":"count""#,
        r#""number":"step""#,
        r#""number":"coverage""#,
    ] {
        assert!(text.contains(used), "no program has {used}");
    }
    let measures = MEASURES.iter();
    for row in measures.filter(|row| matches!(row.make, Make::Length(_))) {
        let used = format!(r#""length":"{}""#, row.signature.name);
        assert!(text.contains(&used), "no program has {used}");
    }
    let mut signs = BTreeSet::new();
    for program in programs::all() {
        for check in &program.verify.checks {
            collect_signs(&check.holds, &mut signs);
        }
    }
    assert_eq!(
        signs.len(),
        12,
        "each of three kinds with each of four signs: {signs:?}"
    );
}

fn collect_signs(condition: &Condition, signs: &mut BTreeSet<String>) {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().for_each(|part| collect_signs(part, signs));
        }
        Condition::Not { of } => collect_signs(of, signs),
        Condition::Lengths { is, .. } => drop(signs.insert(format!("lengths {is:?}"))),
        Condition::Angle { is, .. } => drop(signs.insert(format!("angle {is:?}"))),
        Condition::Number { is, .. } => drop(signs.insert(format!("number {is:?}"))),
        Condition::Word { .. }
        | Condition::Within { .. }
        | Condition::Last
        | Condition::Unreachable => {}
    }
}

fn meets_its_truth_table(name: &str, text: &str) {
    meets(&programs::named(name), text);
}

fn meets(program: &Program, text: &str) {
    let name = &program.task;
    let rows = truth::read(program, text);
    let cases: Vec<Case> = rows.iter().map(|(_, case, _)| case.clone()).collect();
    for (line, case, expected) in &rows {
        assert_eq!(case.judged(program), *expected, "{name}: {line}");
    }
    agreed(program, &cases, &format!("truth_{name}"));
}

#[test]
fn truth_of_each_task_that_stands_above_its_table() {
    for (program, table) in programs::written() {
        meets(&program, &table);
    }
}

#[test]
fn truth_of_double_straight() {
    meets_its_truth_table(
        "double_straight",
        include_str!("../fixtures/truth/double_straight.txt"),
    );
}

#[test]
fn truth_of_directions_lengths_and_words() {
    meets_its_truth_table("steered", include_str!("../fixtures/truth/steered.txt"));
}

#[test]
fn truth_of_points_numbers_and_the_last_action() {
    meets_its_truth_table("placed", include_str!("../fixtures/truth/placed.txt"));
}

#[test]
fn truth_of_distances_along_the_axes() {
    meets_its_truth_table("boxed", include_str!("../fixtures/truth/boxed.txt"));
}

#[test]
#[ignore = "long"]
fn the_rust_module_needs_core_alone_and_gives_no_warning() {
    for program in programs::all() {
        let built = drivers::build(&program, "bare");
        let source = built.folder.join("bare.rs");
        let bare =
            "//! Nothing else.\n#![no_std]\n#![deny(warnings, missing_docs)]\npub mod verifier;\n";
        std::fs::write(&source, bare).unwrap();
        for edition in ["2018", "2021", "2024"] {
            let arguments = [
                "--edition",
                edition,
                "--crate-type",
                "lib",
                "--emit=metadata",
            ];
            drivers::rustc(&arguments, &source, &built.folder.join("bare.rmeta"));
        }
    }
}
