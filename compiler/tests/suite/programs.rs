//! The programs of valid files: their bytes, defaults and inheritance.

use crate::common;
use crate::common::{Memory, TASK, messages, program, programs};
use fab_program::{ClothPoint, Exhausted, Fold, KeypointShape, PROGRAM_FORMAT, Program, Subgoals};

#[test]
fn the_same_text_gives_the_same_bytes_wherever_it_lies() {
    let child = "use \"lib/base.fab\"\ntask child extends small { horizon 1 }\n";
    let bytes = |root: &str| {
        let files = Memory::of([
            (&format!("{root}tasks/child.fab"), child),
            (&format!("{root}tasks/lib/base.fab"), TASK),
        ]);
        let compiled = fab_compiler::compile(&format!("{root}tasks/child.fab"), &files).unwrap();
        serde_json::to_string(&compiled.programs[0]).unwrap()
    };
    assert_eq!(bytes(""), bytes(""));
    assert_eq!(bytes(""), bytes("/somewhere/else/"));
    assert!(
        bytes("").contains("\"lib/base.fab\""),
        "a source is named as seen from the entry's folder"
    );
}

#[test]
fn a_program_survives_json_and_its_hash_follows_the_text() {
    let right = program("task.fab", TASK);
    let again: Program = serde_json::from_str(&serde_json::to_string(&right).unwrap()).unwrap();
    assert_eq!((&again, again.hash()), (&right, right.hash()));
    assert_eq!(right.hash().len(), 16);
    let other = program("task.fab", &TASK.replace("40mm", "41mm"));
    assert_ne!(other.hash(), right.hash());
}

#[test]
fn a_program_of_another_format_is_refused_by_name() {
    let json = serde_json::to_string(&program("task.fab", TASK)).unwrap();
    let own = format!("{{\"format\":{PROGRAM_FORMAT},");
    for other in [PROGRAM_FORMAT - 1, PROGRAM_FORMAT + 1] {
        let json = json.replacen(&own, &format!("{{\"format\":{other},"), 1);
        let refused = serde_json::from_str::<Program>(&json)
            .unwrap_err()
            .to_string();
        let expected = format!(
            "the program has format {other}, and this version reads format {PROGRAM_FORMAT}; compile the task again"
        );
        assert!(refused.starts_with(&expected), "{refused}");
    }
}

#[test]
fn a_cloth_of_a_material_has_the_spacing_that_it_states() {
    let silk = r#"
material silk {
    weight    35g/m2                               from "scales"
    thickness 0.1mm                                from "a gauge"
    bending   warp: 13mm, weft: 12mm, bias: 11mm   from "a cantilever"
    recovery  125deg                               from "a protractor"
    stretch   warp: 0.015, weft: 0.025, bias: 0.08 from "a weight"
    friction  table: 0.3, itself: 0.4              from "a slope"
}
"#;
    let of = |cloth: &str| {
        let text = TASK.replace("cloth grid(55, 44)", &format!("cloth {cloth}"));
        program("task.fab", &format!("{silk}{text}"))
    };
    for (cloth, dims, spacing_m) in [
        ("square(340mm, material: silk)", [55, 55], 0.00625),
        (
            "square(340mm, spacing: 4mm, material: silk)",
            [86, 86],
            0.004,
        ),
        (
            "rectangle(340mm, 240mm, material: silk, spacing: 0.4cm)",
            [86, 61],
            0.004,
        ),
        (
            "grid(33, 17, spacing: 12mm, material: silk)",
            [33, 17],
            0.012,
        ),
    ] {
        let made = of(cloth).cloth;
        assert_eq!(
            ([made.dimx, made.dimy], made.spacing_m),
            (dims, spacing_m),
            "{cloth}"
        );
    }
    let [default, stated] = ["", ", spacing: 6.25mm"]
        .map(|spacing| of(&format!("grid(55, 44{spacing}, material: silk)")).hash());
    assert_eq!(default, stated);
}

#[test]
fn a_program_looks_back_if_a_question_does() {
    let told = TASK.replace("component role \"\"\"", "component role when last \"\"\"");
    for (text, looks_back) in [(TASK, false), (&told, true)] {
        let program = program("task.fab", text);
        assert_eq!(program.looks_back(), looks_back, "{text}");
    }
}

#[test]
fn a_hash_is_that_of_what_a_rollout_does() {
    let right = program("task.fab", TASK);
    let moved = program(
        "other.fab",
        &format!("# A remark.\n\n{TASK}# Another one.\n"),
    );
    assert_ne!(moved.sources, right.sources);
    assert_ne!(moved.templates[0].line, right.templates[0].line);
    assert_eq!(moved.hash(), right.hash());
}

#[test]
fn what_a_task_is_for_changes_nothing_that_a_model_sees() {
    let about = TASK.replacen("{", "{\n    about \"Folds a corner.\"\n", 1);
    let (silent, told) = (program("task.fab", TASK), program("task.fab", &about));
    assert_eq!(told.notes(), [("about", "Folds a corner.")]);
    assert_eq!((silent.notes(), silent.hash()), (Vec::new(), told.hash()));
    let texts = |program: &Program| {
        let templates = program.templates.iter();
        templates.map(|it| it.text.clone()).collect::<Vec<_>>()
    };
    assert_eq!(texts(&told), texts(&silent));
    let again: Program = serde_json::from_str(&serde_json::to_string(&told).unwrap()).unwrap();
    assert_eq!(again, told);
}

#[test]
fn a_variant_keeps_what_its_task_is_for_and_an_extending_task_does_not() {
    let about = TASK.replacen(
        "{",
        "{\n    about \"Folds a corner.\"\n    variant short { horizon 1 }\n    \
         variant other { about \"Folds less.\" horizon 1 }\n",
        1,
    );
    let text = format!("{about}\ntask child extends small {{ horizon 2 }}\n");
    let programs = programs("task.fab", &Memory::of([("task.fab", text.as_str())]));
    let told: Vec<_> = programs
        .iter()
        .map(|it| (it.title(), it.about.as_deref()))
        .collect();
    let expected = [
        ("small", Some("Folds a corner.")),
        ("small/short", Some("Folds a corner.")),
        ("small/other", Some("Folds less.")),
        ("child", None),
        ("child/short", None),
        ("child/other", Some("Folds less.")),
    ];
    assert_eq!(
        told,
        expected.map(|(title, about)| (title.to_owned(), about))
    );
}

#[test]
fn quantities_are_in_base_units_and_folds_are_fractions() {
    let program = program("task.fab", TASK);
    assert_eq!(
        (program.camera.height_m, program.camera.image_px),
        (0.65, 224)
    );
    assert!((program.camera.fov_rad - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    assert_eq!(program.goal.as_ref().unwrap().limit, 0.04);
    let Some(Subgoals::Demonstrate { folds }) = &program.subgoals else {
        panic!("the folds are demonstrated")
    };
    let corner = |right: f64, front: f64| ClothPoint::Particle { right, front };
    assert_eq!(
        folds[0],
        Fold {
            pick: corner(0.0, 0.0),
            place: corner(0.0, 1.0),
            fraction: 1.0
        }
    );
    assert_eq!(
        folds[1],
        Fold {
            pick: corner(0.0, 0.5),
            place: ClothPoint::Center,
            fraction: 0.5
        }
    );
    // Without a list of experts, the demonstration counts as right and gives the horizon.
    assert_eq!(
        (program.experts[0].folds.as_slice(), program.experts.len()),
        (folds.as_slice(), 1)
    );
    assert_eq!((program.horizon, program.calls_per_step()), (2, 4));
    assert_eq!(
        program.keypoint("corners").unwrap().extractor.shape(),
        KeypointShape::Points
    );
}

#[test]
fn sides_in_metres_are_rounded_to_particles() {
    let dims = |cloth: &str| {
        let cloth = program("task.fab", &TASK.replace("grid(55, 44)", cloth)).cloth;
        (cloth.dimx, cloth.dimy)
    };
    assert_eq!(dims("rectangle(338mm, 269mm)"), (55, 44));
    assert_eq!(dims("square(25cm)"), (41, 41));
    assert_eq!(dims("square(0.25m)"), (41, 41));
    let exact = messages(&TASK.replace("grid(55, 44)", "rectangle(337.5mm, 268.75mm)"));
    assert!(exact.is_empty(), "{exact:?}");
}

#[test]
fn single_checks_are_replaced_in_their_place_and_left_out() {
    let verify = r#"verify {
        check moves { distance(pick, place) > 10px } else "Nothing would move."
        check far   { distance(pick, place) > 30px } else "Too near."
        check inner { distance(place, center) < 90px } else "Too far out."
        attempts 3, then without far, inner, else skip
    }"#;
    let base = match TASK.find("verify {") {
        Some(at) => format!("{}{verify}\n}}", &TASK[..at]),
        None => panic!("the task verifies nothing"),
    };
    let child = r#"
        use "base.fab"
        task child extends small {
            override check moves { distance(pick, place) > 20px } else "Too little would move."
            without check far
            variant unchecked { without check moves, far, inner }
            variant alone { verify { check near { distance(pick, place) < 99px } else "Too far." } }
        }
    "#;
    let files = Memory::of([("child.fab", child), ("base.fab", base.as_str())]);
    let programs = programs("child.fab", &files);
    let checked = |at: usize| {
        let verify = &programs[at].verify;
        let names: Vec<&str> = verify
            .checks
            .iter()
            .map(|check| check.name.as_str())
            .collect();
        (names, verify.relaxed.clone(), verify.exhausted)
    };
    assert_eq!(
        checked(0),
        (
            vec!["moves", "inner"],
            vec!["inner".to_owned()],
            Exhausted::Skips
        )
    );
    assert_eq!(checked(1), (vec![], vec![], Exhausted::Skips));
    assert_eq!(checked(2), (vec!["near"], vec![], Exhausted::Ends));
    let text = |at: usize, name: &str| programs[at].template(name).map(|part| part.text.clone());
    assert_eq!(
        text(0, "check.moves").as_deref(),
        Some("Too little would move.")
    );
    assert_eq!(
        text(0, "check.far"),
        None,
        "a check that is left out has no words either"
    );
}

/// A task whose stages say parts with names, and tasks that add to them.
const ADDITIONS: &str = r#"
    use "base.fab"
    task worded extends small {
        component greeting "Hello."
        component bye      "Goodbye."
        stage plan { model text system role say greeting, "The corners are {{ corners }}.", bye read action }
        variant calm { horizon 1 }
        ablate greeting
    }
    task child extends worded {
        component one   "One."
        component two   "Two."
        component three "Three."
        component four  "Four."
        component five  "Five."
        say one, two in plan after greeting
        say three in plan after greeting
        say four in plan before one
        say five in plan before role
        check far { distance(pick, place) > 30px } else "Too near."
        without variant calm
        variant wordy { say seven in plan before bye component seven "Seven." }
    }
    task grandchild extends child {
        component six "Six."
        say six in plan after greeting
        without component one
        without variant wordy
        check few { count(corners) < 20 } else "Too many."
    }
    task stated_again extends child {
        without variant wordy
        stage plan { model text say bye read action }
    }
"#;

#[test]
fn parts_are_added_to_what_a_stage_says() {
    let files = Memory::of([("child.fab", ADDITIONS), ("base.fab", TASK)]);
    let programs = programs("child.fab", &files);
    let said = |name: &str| {
        let mut named = programs.iter();
        let program = named.find(|it| match it.variant.as_deref() {
            Some(variant) => name == format!("{}/{variant}", it.task),
            None => name == it.task,
        });
        let plan = program.unwrap().stages.iter().find(|it| it.name == "plan");
        let plan = plan.unwrap();
        (plan.system.join(" "), plan.say.join(" "))
    };
    let of = |system: &str, say: &str| (system.to_owned(), say.to_owned());
    assert_eq!(said("worded"), of("role", "greeting plan.say bye"));
    assert_eq!(
        said("child"),
        of("five role", "greeting four one two three plan.say bye")
    );
    assert_eq!(
        said("child/without_greeting"),
        of("five role", "four one two three plan.say bye"),
        "a component that is left out keeps its place"
    );
    assert_eq!(
        said("grandchild"),
        of("five role", "greeting four two three six plan.say bye")
    );
    assert_eq!(
        said("child/wordy"),
        of(
            "five role",
            "greeting four one two three plan.say seven bye"
        )
    );
    assert_eq!(said("stated_again"), of("", "bye"));
}

#[test]
fn checks_are_added_and_variants_left_out() {
    let files = Memory::of([("child.fab", ADDITIONS), ("base.fab", TASK)]);
    let programs = programs("child.fab", &files);
    let named = |program: &Program| match &program.variant {
        Some(variant) => format!("{}/{variant}", program.task),
        None => program.task.clone(),
    };
    let checks = |program: &Program| {
        let names = program.verify.checks.iter().map(|it| it.name.as_str());
        names.collect::<Vec<_>>().join(" ")
    };
    let all: Vec<(String, String)> = programs.iter().map(|it| (named(it), checks(it))).collect();
    let all: Vec<(&str, &str)> = all.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    assert_eq!(
        all,
        [
            ("worded", "on_cloth moves"),
            ("worded/calm", "on_cloth moves"),
            ("worded/without_greeting", "on_cloth moves"),
            ("child", "on_cloth moves far"),
            ("child/without_greeting", "on_cloth moves far"),
            ("child/wordy", "on_cloth moves far"),
            ("grandchild", "on_cloth moves far few"),
            ("grandchild/without_greeting", "on_cloth moves far few"),
            ("stated_again", "on_cloth moves far"),
            ("stated_again/without_greeting", "on_cloth moves far"),
        ]
    );
    let (base, child) = (&programs[0].verify, &programs[3].verify);
    assert_eq!(
        (base.attempts, base.exhausted),
        (child.attempts, child.exhausted),
        "what else the base verifies stays"
    );
}

#[test]
fn a_child_inherits_replaces_overrides_and_leaves_out() {
    let child = r#"
        use "base.fab"
        task child extends small {
            cloth square(250mm)
            override component role """
                You fold towels.
                """
            component hint "Mind the {{ corners }}."
            stage describe {
                model text
                say hint
                read instruction from "Do: {instruction}."
            }
            keypoints {
                center = centroid(cloth)
                more = shi_tomasi(cloth, image: 64px, max: 5, quality: 0.1, spacing: 4px)
            }
        }
        task bare extends child {
            without component role, hint
            stage describe { model text say "What?" read instruction from "Do: {instruction}" }
        }
    "#;
    let files = Memory::of([("child.fab", child), ("base.fab", TASK)]);
    let programs = programs("child.fab", &files);
    let names: Vec<&str> = programs
        .iter()
        .map(|program| program.task.as_str())
        .collect();
    assert_eq!(
        names,
        ["child", "bare"],
        "only tasks of the entry file become programs"
    );
    let child = &programs[0];
    assert_eq!((child.cloth.dimx, child.cloth.dimy), (41, 41));
    assert_eq!(child.template("role").unwrap().text, "You fold towels.");
    let keypoints: Vec<&str> = child
        .keypoints
        .iter()
        .map(|keypoint| keypoint.name.as_str())
        .collect();
    assert_eq!(
        keypoints,
        ["cloth", "corners", "center", "more"],
        "a keypoint of the same name keeps its place"
    );
    let stages: Vec<&str> = child
        .stages
        .iter()
        .map(|stage| stage.name.as_str())
        .collect();
    assert_eq!(stages, ["describe", "plan"]);
    let bare = &programs[1];
    assert!(
        bare.template("role").is_none() && bare.stages[1].system.is_empty(),
        "a component that is left out is never used"
    );
}

#[test]
fn a_task_with_an_error_gives_no_program_but_its_neighbour_does() {
    let text = format!("{TASK}\ntask other extends small {{ horizon 0 }}\n");
    let compiled = common::compile("task.fab", &text);
    let names: Vec<&str> = compiled
        .programs
        .iter()
        .map(|program| program.task.as_str())
        .collect();
    assert!(compiled.has_errors());
    assert_eq!(names, ["small"]);
}

#[test]
fn an_error_in_a_base_keeps_its_children_back() {
    let base = TASK
        .replace("quality: 0.04", "quality: 4")
        .replace("task small {", "task small_base {");
    let files = Memory::of([
        (
            "a.fab",
            "use \"b.fab\"\ntask a extends small_base { horizon 2 }",
        ),
        ("b.fab", &base),
    ]);
    let compiled = fab_compiler::compile("a.fab", &files).unwrap();
    assert!(compiled.programs.is_empty());
    assert_eq!(
        compiled.diagnostics.len(),
        1,
        "what is inherited is reported once: {:?}",
        compiled.diagnostics
    );
}

#[test]
fn an_entry_that_cannot_be_read_is_the_callers_error() {
    let error = fab_compiler::compile("nowhere.fab", &Memory::default()).unwrap_err();
    assert_eq!(error.to_string(), "there is no file `nowhere.fab`");
}

#[test]
fn line_ends_and_a_byte_order_mark_change_no_prompt() {
    let unix = program("task.fab", TASK);
    let windows = program(
        "task.fab",
        &format!("\u{feff}{}", TASK.replace('\n', "\r\n")),
    );
    assert_eq!(unix.templates.len(), windows.templates.len());
    for (unix, windows) in unix.templates.iter().zip(&windows.templates) {
        assert_eq!((&unix.text, unix.line), (&windows.text, windows.line));
    }
}

#[test]
fn files_beyond_the_limits_are_refused() {
    let long = format!("# {}\n{TASK}", "x".repeat(1 << 20));
    assert_eq!(
        messages(&long),
        [format!(
            "F0001 the file has {} bytes, at most 1048576 are accepted",
            long.len()
        )]
    );
    let many: String = (0..100)
        .map(|number| format!("use \"f{number}.fab\"\n"))
        .collect();
    let mut files = Memory::of([("many.fab", &many)]);
    files
        .0
        .extend((0..100).map(|number| (format!("f{number}.fab"), String::new())));
    let compiled = fab_compiler::compile("many.fab", &files).unwrap();
    let codes: Vec<&str> = { compiled.diagnostics.iter() }
        .map(|it| it.code.as_str())
        .collect();
    assert!(
        !codes.is_empty() && codes.iter().all(|code| *code == "F0004"),
        "{codes:?}"
    );
    assert_eq!(compiled.sources.iter().count(), fab_compiler::MAX_FILES);
}
