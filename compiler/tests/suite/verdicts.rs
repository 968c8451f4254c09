//! Which actions may run, and the messages about those that may not.

use crate::common;
use crate::common::{Known, TASK, pick_and_place, pixels, program};
use fab_program::Program;
use fab_program::test::Finding;
use fab_program::verify::{self, Strictness, Verdict};

/// A scene in which every column below 100 is cloth.
fn table() -> Known {
    Known {
        points: vec![
            (
                "corners",
                pixels(&[(10, 10), (90, 10), (105, 50), (120, 50), (90, 10)]),
            ),
            ("center", pixels(&[(95, 14)])),
        ],
        regions: vec![("cloth", [-1000, -1000, 99, 1000])],
        ..Known::default()
    }
}

fn judge(program: &Program, pick: (i32, i32), place: (i32, i32)) -> Verdict {
    let proposal = pick_and_place(pick, place);
    verify::verdict(program, table().facts(), &proposal, Strictness::Full).unwrap()
}

fn with_condition(condition: &str) -> Program {
    program(
        "task.fab",
        &TASK.replace("distance(pick, place) > 10px", condition),
    )
}

#[test]
fn an_offered_action_that_passes_every_check_runs() {
    let program = program("task.fab", TASK);
    assert_eq!(judge(&program, (10, 10), (90, 10)), Verdict::Accept);
    assert_eq!(
        judge(&program, (105, 50), (10, 10)),
        Verdict::Accept,
        "6 px beside the cloth are within 8 px of it"
    );
}

#[test]
fn points_that_were_not_offered_are_refused_with_the_choices() {
    let refused = judge(&program("task.fab", TASK), (95, 14), (10, 10));
    let Verdict::Reject {
        check,
        values,
        message,
    } = refused
    else {
        panic!("the center is offered for the place alone")
    };
    assert_eq!(check, verify::OFFERED);
    assert_eq!(values[0], ("pick".to_owned(), "(95, 14)".to_owned()));
    assert_eq!(
        message,
        "The pick point (95, 14) is not one of the offered points. Choose one of these: (10, 10), (90, 10), (105, 50), (120, 50)."
    );
}

#[test]
fn picks_outside_the_mask_are_refused_by_name() {
    let refused = judge(&program("task.fab", TASK), (120, 50), (10, 10));
    let Verdict::Reject {
        check,
        values,
        message,
    } = refused
    else {
        panic!("21 px beside the cloth are too far")
    };
    assert_eq!(check, "on_cloth");
    assert_eq!(
        values,
        [
            ("pick".to_owned(), "(120, 50)".to_owned()),
            ("distance to cloth".to_owned(), "21.0 px".to_owned())
        ]
    );
    assert_eq!(message, "(120, 50) is off the cloth.");
}

#[test]
fn the_first_check_that_fails_speaks() {
    let Verdict::Reject { check, values, .. } =
        judge(&program("task.fab", TASK), (90, 10), (95, 14))
    else {
        panic!("too near")
    };
    assert_eq!(
        (check.as_str(), values),
        (
            "moves",
            vec![("distance(pick, place)".to_owned(), "6.4 px".to_owned())]
        )
    );
}

#[test]
fn conditions_mean_what_they_say() {
    // From (10, 10) to (90, 10): 80 px apart, both on the cloth.
    for (condition, holds) in [
        ("distance(pick, place) > 80px", false),
        ("distance(pick, place) >= 80px", true),
        ("distance(pick, place) < 80px", false),
        ("distance(pick, place) <= 80px", true),
        ("80px <= distance(pick, place)", true),
        ("not distance(pick, place) > 80px", true),
        ("not not distance(pick, place) > 80px", false),
        ("pick within cloth and place within cloth", true),
        ("pick within cloth and distance(pick, place) > 80px", false),
        ("pick within cloth or distance(pick, place) > 80px", true),
        (
            "not (pick within cloth or distance(pick, place) > 80px)",
            false,
        ),
        (
            "distance(pick, place) > 80px and pick within cloth or place within cloth",
            true,
        ),
        (
            "distance(pick, place) > 80px and (pick within cloth or place within cloth)",
            false,
        ),
        ("distance(place, center) < distance(pick, center)", true),
        ("center within 8px of cloth", true),
    ] {
        let verdict = judge(&with_condition(condition), (10, 10), (90, 10));
        assert_eq!(verdict == Verdict::Accept, holds, "{condition}");
    }
}

#[test]
fn an_angle_that_equals_its_limit_is_equal() {
    let angles = [
        0, 15, 30, 45, 60, 75, 90, 120, 135, 150, 180, 210, 225, 270, 300, 315, 345,
    ];
    for a in angles {
        for b in angles {
            let apart = (a - b + 360) % 360;
            let limit = apart.min(360 - apart);
            let condition = format!(
                "angle_between({a}deg, {b}deg) <= {limit}deg and angle_between({a}deg, {b}deg) >= {limit}deg \
                 and not angle_between({a}deg, {b}deg) < {limit}deg and not angle_between({a}deg, {b}deg) > {limit}deg"
            );
            let verdict = judge(&with_condition(&condition), (10, 10), (90, 10));
            assert_eq!(verdict, Verdict::Accept, "{condition}");
        }
    }
    // Directions that can be told apart stay apart.
    let condition =
        "angle_between(0.0001deg, 0deg) > 0deg and angle_between(180deg, 0.0001deg) < 180deg";
    let verdict = judge(&with_condition(condition), (10, 10), (90, 10));
    assert_eq!(verdict, Verdict::Accept, "{condition}");
}

#[test]
fn an_empty_or_unknown_mask_is_infinitely_far() {
    let bare = Known {
        regions: Vec::new(),
        ..table()
    };
    let program = program("task.fab", TASK);
    let proposal = pick_and_place((10, 10), (90, 10));
    let verdict = verify::verdict(&program, bare.facts(), &proposal, Strictness::Full).unwrap();
    assert!(matches!(verdict, Verdict::Reject { check, .. } if check == "on_cloth"));
}

/// A cloth of 100 by 100 pixels, and points beside it.
const GIVEN: &str = "given cloth = (119px, 30px) to (20px, 129px) \
    given corners = (17px, 26px), (123px, 132px), (50px, 60px), (50px, 61px)";

#[test]
fn a_task_is_tested_on_what_its_tests_give() {
    let task = TASK
        .replacen(
            "center  =",
            "home    = points((70px, 80px))\n        center  =",
            1,
        )
        .replace("of corners, center", "of corners, home")
        .replace("within 8px of cloth", "within 4.5px of cloth")
        .replace(
            "pick, place) > 10px",
            "pick, place) > 10px or coverage(cloth) < 0.5",
        );
    let anywhere = task
        .replace("pick:  one of corners", "pick:  any of cloth")
        .replace("pick within 4.5px of cloth", "distance(pick, place) > 9px")
        .replace(" or coverage(cloth) < 0.5", "");
    let pick_and_place =
        |pick: &str, place: &str| format!("reply \"Pick Point = {pick}, Place Point = {place}\"");
    let inside = pick_and_place("(50, 60)", "(70, 80)");
    let near = pick_and_place("(50, 60)", "(50, 61)");
    let only_corners = "given corners = (50px, 60px)";
    let more_places = task.replace("of corners, home", "of corners, center, home");
    for (task, given, answer, expect, finding, is_expected) in [
        (
            &task,
            GIVEN,
            &inside,
            "accept",
            "the answer is accepted",
            true,
        ),
        (
            &task,
            GIVEN,
            &inside,
            "malformed",
            "the answer is accepted",
            false,
        ),
        (
            &task,
            GIVEN,
            &pick_and_place("(17, 26)", "(50, 60)"),
            "reject(on_cloth)",
            "the check `on_cloth` refuses the answer; pick: (17, 26); distance to cloth: 5.0 px\n(17, 26) is off the cloth.",
            true,
        ),
        (
            &task,
            GIVEN,
            &pick_and_place("(123, 132)", "(50, 60)"),
            "reject(moves)",
            "the check `on_cloth` refuses the answer; pick: (123, 132); distance to cloth: 5.0 px\n(123, 132) is off the cloth.",
            false,
        ),
        // 10,000 of the flat cloth's 15,698 pixels.
        (
            &task,
            GIVEN,
            &near,
            "reject(moves)",
            "the check `moves` refuses the answer; distance(pick, place): 1.0 px; coverage(cloth): 0.637\n(50, 60) and (50, 61) are too near.",
            true,
        ),
        (
            &task,
            only_corners,
            &inside,
            "accept",
            "the test does not give `cloth`; write `given cloth = …`",
            false,
        ),
        (
            &anywhere,
            only_corners,
            &inside,
            "accept",
            "the test does not give `cloth`; write `given cloth = …`",
            false,
        ),
        (
            &more_places,
            GIVEN,
            &inside,
            "accept",
            "the answer is accepted",
            true,
        ),
        (
            &anywhere,
            GIVEN,
            &inside,
            "accept",
            "the answer is accepted",
            true,
        ),
        (
            &task,
            GIVEN,
            &"reply \"Pick Point = (50, 60)\"".to_owned(),
            "malformed",
            "the answer is malformed\n",
            true,
        ),
        (
            &task,
            "",
            &"reply describe \"Instructions: fold\"".to_owned(),
            "text \"fold\"",
            "the answer's text is `fold`",
            true,
        ),
        (
            &task,
            "",
            &"reply describe \"Instructions: fold\"".to_owned(),
            "text \"unfold\"",
            "the answer's text is `fold`",
            false,
        ),
    ] {
        let test = format!("test \"it\" {{ {given} {answer} expect {expect} }}");
        let task = task.trim_end().strip_suffix('}').unwrap();
        let compiled = common::compile("task.fab", &format!("{task}{test}\n}}\n"));
        assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
        let trial = fab_program::test::run(&compiled.programs[0], &compiled.tests[0]);
        let found = trial.finding.to_string();
        let is_whole = !finding.ends_with('\n');
        assert!(found.starts_with(finding), "{test}\n{found}");
        assert!(!is_whole || found == finding, "{test}\n{found}");
        assert_eq!(trial.is_expected, is_expected, "{test}");
    }
}

#[test]
fn a_verdict_survives_json() {
    let refused = judge(&program("task.fab", TASK), (120, 50), (10, 10));
    let again: Verdict = serde_json::from_str(&serde_json::to_string(&refused).unwrap()).unwrap();
    assert_eq!(again, refused);
}

/// Texts and conditions name quadrants by themselves; they must agree, also beside and on the lines between two.
#[test]
fn the_word_that_a_message_tells_is_the_one_that_its_check_accepts() {
    let words = ["upper_left", "upper_right", "lower_left", "lower_right"];
    let task = common::TASK
        .replace("pick:", &format!("corner: one of \"{}\"\n        pick:", words.join("\", \"")))
        .replace("verify {", "verify {\n        check agrees { corner == quadrant(pick, center) } else \"{{ quadrant(pick, center) }}\"");
    let task = task.trim_end().strip_suffix('}').unwrap();
    for (u, v) in [59, 60, 61]
        .into_iter()
        .flat_map(|u| [39, 40, 41].map(|v| (u, v)))
    {
        let tests = words.map(|word| {
            format!(
                "test \"{word}\" {{ given corners = ({u}px, {v}px), (90px, 90px) given center = (60px, 40px)
                given cloth = (0px, 0px) to (100px, 100px)
                reply \"Corner = {word}, Pick Point = ({u}, {v}), Place Point = (90, 90)\" expect accept }}"
            )
        });
        let compiled = common::compile("task.fab", &format!("{task}{}\n}}\n", tests.join("\n")));
        assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
        let program = &compiled.programs[0];
        let trials = compiled
            .tests
            .iter()
            .map(|test| (test, fab_program::test::run(program, test).finding));
        let (right, wrong): (Vec<_>, Vec<_>) = trials.partition(|(_, it)| *it == Finding::Accepted);
        assert_eq!(
            (right.len(), wrong.len()),
            (1, 3),
            "({u}, {v}): {right:?}, {wrong:?}"
        );
        for (_, finding) in wrong {
            assert!(
                matches!(&finding, Finding::Rejected { check, message, .. } if check == "agrees" && *message == right[0].0.name),
                "{finding:?}"
            );
        }
    }
}
