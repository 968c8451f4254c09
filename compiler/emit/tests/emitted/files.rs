//! The files of a build: which ones there are, what lists them, and what is rejected.

use super::table::Chance;
use super::{drivers, programs};
use fab_emit::{EmitError, Manifest, Target};
use fab_program::{ActionField, Choices, Comparison, Condition, LengthChoice, Number, Program};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::process::Command;

const ALL: [Target; 3] = [Target::Program, Target::Rust, Target::Python];

fn emitted(program: &Program) -> Result<Vec<fab_emit::Artifact>, EmitError> {
    fab_emit::emit(std::slice::from_ref(program), &ALL)
}

#[test]
fn every_program_gets_a_folder_and_a_variant_its_own() {
    let task = programs::shipped("double_straight");
    let mut variant = task.clone();
    variant.variant = Some("bare".to_owned());
    let artifacts = fab_emit::emit(&[task, variant], &ALL).unwrap();
    let paths: Vec<&str> = artifacts.iter().map(|it| it.path.as_str()).collect();
    let files = [
        "prompts/describe.user.txt.j2",
        "prompts/plan.system.txt.j2",
        "prompts/plan.user.txt.j2",
        "prompts/check.on_cloth.txt.j2",
        "prompts/check.moves.txt.j2",
        "prompts/result.txt.j2",
        "actions.schema.json",
        "verifier.rs",
        "verifier.py",
        "program.json",
    ];
    let expected: Vec<String> = ["double_straight", "double_straight.bare"]
        .iter()
        .flat_map(|folder| files.iter().map(move |file| format!("{folder}/{file}")))
        .collect();
    assert_eq!(paths, expected);
}

#[test]
fn only_what_is_asked_for_is_emitted_beside_prompts_and_schema() {
    let program = programs::placed();
    for (targets, expected) in [
        (vec![], vec![]),
        (vec![Target::Rust], vec!["placed/verifier.rs"]),
        (vec![Target::Python], vec!["placed/verifier.py"]),
        (vec![Target::Program], vec!["placed/program.json"]),
    ] {
        let artifacts = fab_emit::emit(std::slice::from_ref(&program), &targets).unwrap();
        let beside: Vec<&str> = artifacts
            .iter()
            .map(|it| it.path.as_str())
            .filter(|it| !it.contains("/prompts/") && !it.ends_with("actions.schema.json"))
            .collect();
        assert_eq!(beside, expected);
    }
}

#[test]
fn the_list_names_every_other_file_with_its_hash() {
    for program in programs::all() {
        let artifacts = emitted(&program).unwrap();
        let (last, others) = artifacts.split_last().unwrap();
        let manifest: Manifest = serde_json::from_str(&last.text).unwrap();
        assert_eq!(manifest.format, fab_emit::BUILD_FORMAT);
        assert_eq!(manifest.program, program);
        assert_eq!(manifest.program_hash, program.hash());
        assert_eq!(manifest.artifacts.len(), others.len());
        for (listed, artifact) in manifest.artifacts.iter().zip(others) {
            assert_eq!(format!("{}/{}", program.task, listed.path), artifact.path);
            let digest = Sha256::digest(artifact.text.as_bytes());
            let hex: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(listed.sha256, hex);
        }
        for verifier in others.iter().filter(|it| it.path.contains("/verifier.")) {
            assert!(verifier.text.contains(&manifest.program_hash));
            assert!(verifier.text.is_ascii(), "{}", verifier.path);
        }
    }
}

#[test]
fn the_same_program_gives_the_same_bytes() {
    for program in programs::all() {
        assert_eq!(emitted(&program), emitted(&program.clone()));
    }
}

#[test]
fn the_schema_lists_what_each_field_may_be() {
    let artifacts = emitted(&programs::steered()).unwrap();
    let schema = artifacts.iter().find(|it| it.path.ends_with("schema.json"));
    let schema: Value = serde_json::from_str(&schema.unwrap().text).unwrap();
    assert_eq!(
        schema["required"],
        json!(["pick", "direction", "distance", "grip", "type"])
    );
    assert_eq!(schema["additionalProperties"], json!(false));
    let fields = &schema["properties"];
    assert_eq!(
        fields["distance"]["enum"],
        json!(["2 cm", "2.05 cm", "5.5 cm", "10 cm"])
    );
    assert_eq!(fields["direction"]["enum"][8], json!("350 deg"));
    assert_eq!(
        fields["grip"]["enum"],
        json!(["soft", "firm", "say \"é\" {{\n\\"])
    );
    assert!(fields["pick"].get("enum").is_none());

    let Some(python) = drivers::python("the_schema_lists_what_each_field_may_be") else {
        return;
    };
    let pattern = fields["pick"]["pattern"].as_str().unwrap();
    for (text, fits) in [
        ("(12, 34)", "True"),
        ("(-1, 0)", "True"),
        ("(12,34)", "False"),
        ("(1.5, 2)", "False"),
        ("x (1, 2)", "False"),
    ] {
        let program = "import re, sys; print(re.search(sys.argv[1], sys.argv[2]) is not None)";
        let said = Command::new(python)
            .args(["-c", program, pattern, text])
            .output();
        let said = String::from_utf8(said.unwrap().stdout).unwrap();
        assert_eq!(said.trim(), fits, "{text}");
    }
}

#[test]
fn a_verifier_says_what_its_fields_are_and_which_checks_it_leaves_out() {
    let values = "pick: [120, 40], direction_deg: 0.0, distance: 2.0, grip: \"soft\", type_: \"a\"";
    let python = "pick=(120, 40), direction_deg=0.0, distance=2.0, grip=\"soft\", type_=\"a\"";
    let both = [
        "Field `pick`: a pixel.",
        "Field `direction`: degrees counter-clockwise from the picture's right, below 360.",
        "Field `distance`: centimetres.",
        "Field `grip`: a word.",
        "Field `pick`: the keypoints whose points it may be.",
        "Field `direction`: degrees, and the same as a vector, right and down.",
        "Field `distance`: centimetres, and metres.",
        "Field `type`: the words that it may be.",
        ": without `ahead`, `lands`.",
    ];
    let artifacts = emitted(&programs::steered()).unwrap();
    for (file, example) in [("verifier.rs", values), ("verifier.py", python)] {
        let text = &artifacts
            .iter()
            .find(|it| it.path.ends_with(file))
            .unwrap()
            .text;
        for line in both.iter().chain([&example]) {
            assert!(text.contains(line), "{line} is not in\n{text}");
        }
    }
    let all = emitted(&programs::shipped("double_triangle")).unwrap();
    let verifiers = all.iter().filter(|it| it.path.contains("/verifier."));
    for verifier in verifiers {
        let words = ": this task leaves out none.";
        assert!(verifier.text.contains(words), "{}", verifier.text);
    }
}

#[test]
fn names_that_are_no_file_names_are_refused() {
    for name in ["../x", "a/b", "", "a b", "a.", "{{"] {
        let mut program = programs::placed();
        program.stages[0].name = name.to_owned();
        let wrong = EmitError::Name {
            name: name.to_owned(),
        };
        assert_eq!(emitted(&program), Err(wrong.clone()));
        let mut program = programs::placed();
        program.task = name.to_owned();
        assert_eq!(emitted(&program), Err(wrong));
    }
}

#[test]
fn files_that_differ_by_the_case_of_letters_are_refused() {
    let mut program = programs::placed();
    program.stages[0].name = "PLAN".to_owned();
    let error = emitted(&program).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`placed/prompts/PLAN.user.txt.j2` and `placed/prompts/plan.user.txt.j2` are the same file on systems that ignore letter case; rename one"
    );
}

#[test]
fn what_a_program_edited_by_hand_can_get_wrong_is_refused() {
    let refused = |condition: Condition| {
        let mut program = programs::placed();
        program.verify.checks = vec![programs::check("it", None, condition)];
        emitted(&program).unwrap_err().to_string()
    };
    let word = |field: &str| Condition::Word {
        field: field.to_owned(),
        is: "x".to_owned(),
    };
    assert_eq!(refused(word("pick")), "`pick` is not a field of words");
    assert_eq!(refused(word("grip")), "`grip` is not a field of words");
    for limit in [f64::NAN, f64::INFINITY] {
        let condition = programs::number(Number::Step, Comparison::Less, limit);
        assert!(refused(condition).contains("not a finite number"));
    }
    let nothing = Number::Coverage {
        mask: "cloth".to_owned(),
        flat_px: 0.0,
    };
    let condition = programs::number(nothing, Comparison::Less, 1.0);
    assert!(refused(condition).contains("not a finite number"));
    let mut program = programs::steered();
    if let Choices::Lengths { choices, .. } = &mut program.actions[2].choices {
        choices[0].m = f64::NAN;
    }
    assert!(emitted(&program).is_err());
}

#[test]
fn a_long_chain_of_negations_is_not_nested() {
    for (depth, sign) in [(300, ""), (301, "!(")] {
        let mut condition = programs::number(Number::Step, Comparison::Less, 3.0);
        for _ in 0..depth {
            condition = Condition::Not {
                of: Box::new(condition),
            };
        }
        let mut program = programs::placed();
        program.verify.checks = vec![programs::check("it", None, condition)];
        let artifacts = fab_emit::emit(std::slice::from_ref(&program), &[Target::Rust]).unwrap();
        let rust = &artifacts.last().unwrap().text;
        assert!(
            rust.contains(&format!("Ok({sign}facts.step < 3.0")),
            "{rust}"
        );
    }
}

#[test]
fn every_number_reads_back_to_the_same_bits() {
    let mut chance = Chance::of(6);
    let mut program = programs::steered();
    if let Choices::Lengths { choices, .. } = &mut program.actions[2].choices {
        let mut fraction =
            || f64::from(chance.below(u32::MAX)) / f64::from(chance.below(u32::MAX) + 1);
        choices.extend((0..1000).map(|_| LengthChoice {
            value: fraction(),
            m: fraction(),
        }));
    }
    let artifacts = emitted(&program).unwrap();
    let manifest: Manifest = serde_json::from_str(&artifacts.last().unwrap().text).unwrap();
    assert_eq!(manifest.program, program);
}

#[test]
fn fields_may_be_called_like_words_of_rust_and_python() {
    let words = "abstract and as assert async await become box break class const continue crate def del do \
        dyn elif else enum except extern final finally fn for from gen global if impl import in is lambda let \
        loop macro match mod move mut nonlocal not or override pass priv pub raise ref return self static \
        struct super trait try type typeof unsafe unsized use virtual where while with yield true false \
        True False None Self";
    let mut program = programs::placed();
    for word in words.split_whitespace() {
        program.actions.push(ActionField {
            name: word.to_owned(),
            choices: Choices::Words {
                choices: vec![word.to_owned()],
            },
        });
    }
    let built = drivers::build(&program, "words");
    for edition in ["2018", "2024"] {
        let arguments = [
            "--edition",
            edition,
            "--crate-type",
            "lib",
            "--emit=metadata",
        ];
        let made = built.folder.join("words.rmeta");
        drivers::rustc(&arguments, &built.folder.join("verifier.rs"), &made);
    }
    let test = "fields_may_be_called_like_words_of_rust_and_python";
    let Some(python) = drivers::python(test) else {
        return;
    };
    let said = Command::new(python)
        .args(["-B", "-W", "error", "-c", "import verifier"])
        .current_dir(&built.folder)
        .output()
        .unwrap();
    assert!(
        said.status.success(),
        "{}",
        String::from_utf8_lossy(&said.stderr)
    );
}
