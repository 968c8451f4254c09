//! Emitted prompts render to the compiler's own text, in minijinja and in Python's jinja2.

use super::case::Scene;
use super::programs;
use super::table::Chance;
use fab_emit::Artifact;
use fab_program::Proposal;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::render::{self, PromptSpeaker, Values};
use fab_program::space;
use fab_program::{
    Comparison, Extractor, Keypoint, Moment, Number, PixelPoint, Placeholder, Program, Stage,
    Template, Value, Variable,
};
use std::collections::BTreeMap;

/// Parts of a stage: names that are methods of Python's dictionaries, and texts with awkward beginnings and ends.
const PARTS: [(&str, &str); 4] = [
    ("items", "\n{{ v0 }} is {"),
    ("plan.say.7", "- {{ v1 }}{{ \"{%\" }} %}"),
    ("keys", "{{ v0 }}{{ v2_inner }}\n"),
    ("values", "{"),
];

/// One filled template: its path, source, values and text.
struct Filled {
    path: String,
    source: String,
    values: serde_json::Value,
    text: String,
}

/// Returns a program whose `plan` says four parts; `guarded` tells which of them are conditional.
fn guarded_program(guarded: [bool; 4]) -> Program {
    let mut program = programs::placed();
    let mut names = Vec::new();
    for (index, (name, text)) in PARTS.into_iter().enumerate() {
        let keypoint = format!("guard_{index}");
        program.keypoints.push(Keypoint {
            name: keypoint.clone(),
            moment: Moment::Now,
            extractor: Extractor::Fixed { points: Vec::new() },
        });
        let count = Number::Count { keypoint };
        let shown = |name: &str| Variable {
            name: name.to_owned(),
            value: Placeholder::Text {
                name: name.to_owned(),
            },
        };
        let used = ["v0", "v1", "v2_inner"].into_iter();
        program.templates.push(Template {
            name: name.to_owned(),
            when: guarded[index].then(|| programs::number(count, Comparison::AtLeast, 1.0)),
            text: text.to_owned(),
            variables: used.filter(|it| text.contains(it)).map(shown).collect(),
            declared_in: "task.fab".to_owned(),
            line: 1,
        });
        names.push(name.to_owned());
    }
    let stage = program.stages.last_mut().unwrap();
    stage.system = names.clone();
    stage.say = names;
    program
}

/// Returns a scene in which exactly these guards hold.
fn scene(holding: [bool; 4], program: &Program) -> Scene {
    let mut scene = Scene::default();
    for keypoint in &program.keypoints {
        let points = vec![PixelPoint::new(10, -3), PixelPoint::new(40, 7)];
        scene.points.insert(keypoint.name.clone(), points);
    }
    for (index, holds) in holding.into_iter().enumerate() {
        let points = vec![PixelPoint::new(1, 1); usize::from(holds)];
        scene.points.insert(format!("guard_{index}"), points);
    }
    scene
}

/// Returns texts that are hard for templates and for the code that passes them on.
fn hard_text(chance: &mut Chance) -> String {
    const PIECES: [&str; 18] = [
        "{{",
        "}}",
        "{%",
        "%}",
        "{#",
        "#}",
        "{",
        "\n",
        "\r\n",
        "\"",
        "'",
        "\\",
        "é",
        "折り",
        "\u{1f9e3}",
        " ",
        "<b>&",
        "word",
    ];
    (0..chance.below(9))
        .map(|_| PIECES[chance.below(PIECES.len() as u32) as usize])
        .collect()
}

/// Fills every prompt of a program and asserts that the renderer gives the same text.
fn filled(program: &Program, holding: [bool; 4], chance: &mut Chance) -> Vec<Filled> {
    let artifacts = fab_emit::emit(std::slice::from_ref(program), &[]).unwrap();
    let scene = scene(holding, program);
    let names = ["v0", "v1", "v2_inner", "instruction"];
    let texts: BTreeMap<String, String> = names
        .map(|name| (name.to_owned(), hard_text(chance)))
        .into_iter()
        .collect();
    let proposal = Proposal {
        fields: program
            .actions
            .iter()
            .map(|field| {
                // The pixels of a region are not listed.
                let first = space::choices(field, &scene).into_iter().next();
                let value = first.unwrap_or(Value::Point(PixelPoint::new(5, 6)));
                (field.name.clone(), value)
            })
            .collect(),
    };
    let last = ExecutedAction {
        proposal: proposal.clone(),
        pick: PixelPoint::new(1, 2),
        place: PixelPoint::new(3, 4),
    };
    let facts = Facts {
        scene: &scene,
        texts: &texts,
        step: 2,
        last: Some(&last),
        proposal: Some(&proposal),
        pointing: Pointing::pixels([224, 224]),
    };
    let mut all = Vec::new();
    let mut fill = |path: String, templates: &[String], expected: String| {
        let values = fab_emit::guards_and_values(program, templates, facts).unwrap();
        let source = source(&artifacts, &path);
        let text = fab_emit::fill(&source, &values).unwrap();
        assert_eq!(text, expected, "{path}, {holding:?}:\n{source}");
        all.push(Filled {
            path,
            source,
            values,
            text,
        });
    };
    for stage in &program.stages {
        for (speaker, templates, text) in said(program, stage, facts) {
            let path = format!("prompts/{}.{speaker}.txt.j2", stage.name);
            fill(path, templates, text);
        }
    }
    for check in &program.verify.checks {
        let text = render::correction(program, check, facts).unwrap();
        let path = format!("prompts/check.{}.txt.j2", check.name);
        fill(path, std::slice::from_ref(&check.message), text);
    }
    all
}

fn source(artifacts: &[Artifact], path: &str) -> String {
    let found = artifacts.iter().find(|it| it.path.ends_with(path));
    found.unwrap_or_else(|| panic!("no {path}")).text.clone()
}

/// Returns the rendered texts of a stage, without its examples.
fn said<'p>(
    program: &Program,
    stage: &'p Stage,
    facts: Facts<'_>,
) -> Vec<(&'static str, &'p [String], String)> {
    let messages = render::messages(program, stage, Values::Known(facts)).unwrap();
    let mut said = Vec::new();
    if let Some(system) = messages
        .iter()
        .find(|it| it.speaker == PromptSpeaker::System)
    {
        said.push((
            "system",
            stage.system.as_slice(),
            system.content.text.clone(),
        ));
    }
    let user = messages.last().unwrap();
    said.push(("user", stage.say.as_slice(), user.content.text.clone()));
    said
}

/// Fills all prompts of all programs, for every combination of guards that hold.
fn filled_in_every_way() -> Vec<Filled> {
    let mut chance = Chance::of(5);
    let mut all = Vec::new();
    let bits = |number: usize| [0, 1, 2, 3].map(|bit| number >> bit & 1 == 1);
    for program in programs::all() {
        for _ in 0..20 {
            all.extend(filled(&program, [false; 4], &mut chance));
        }
    }
    for guarded in 0..16 {
        let program = guarded_program(bits(guarded));
        for holding in 0..16 {
            all.extend(filled(&program, bits(holding), &mut chance));
        }
    }
    all
}

#[test]
fn emitted_prompts_say_what_the_renderer_says_under_every_combination_of_guards() {
    let all = filled_in_every_way();
    let of_four: Vec<&Filled> = all
        .iter()
        .filter(|it| it.path == "prompts/plan.user.txt.j2")
        .collect();
    assert!(
        of_four.iter().any(|it| it.text.is_empty()),
        "nothing said at all"
    );
    assert!(of_four.iter().any(|it| it.source.contains("{% set said")));
    // No part follows that would ask for it.
    let last = "{% set said = \"yes\" %}{% endif %}";
    assert!(!all.iter().any(|it| it.source.ends_with(last)));
    assert!(
        of_four
            .iter()
            .any(|it| !it.source.contains("{% set") && it.source.contains("{% if"))
    );
    assert!(all.len() > 2_000, "{}", all.len());
}

#[test]
fn a_missing_guard_or_value_is_an_error() {
    let program = guarded_program([true; 4]);
    let artifacts = fab_emit::emit(std::slice::from_ref(&program), &[]).unwrap();
    let source = source(&artifacts, "prompts/plan.user.txt.j2");
    let whole = serde_json::json!({
        "v0": "a", "v1": "b", "v2_inner": "c",
        "when": { "items": "yes", "plan.say.7": "", "keys": "yes", "values": "" },
    });
    assert_eq!(fab_emit::fill(&source, &whole).unwrap(), "\na is {\n\nac\n");
    for name in ["v0", "v2_inner", "when"] {
        let mut less = whole.clone();
        less.as_object_mut().unwrap().remove(name);
        assert!(fab_emit::fill(&source, &less).is_err(), "{name}");
    }
    let mut less = whole.clone();
    less["when"].as_object_mut().unwrap().remove("keys");
    assert!(fab_emit::fill(&source, &less).is_err());
}

#[test]
fn what_never_changes_stands_in_an_emitted_prompt_as_words() {
    // Braces next to the words, which a template could interpret.
    let format = "{%{{ actions.points }}{{{ big in px }}%}\n            {{ actions.format }}{";
    let text = crate::common::TASK
        .replacen("cloth grid", "const big = 12px\n    cloth grid", 1)
        .replace("{{ actions.format }}", format);
    let program = crate::common::program("task.fab", &text);
    let artifacts = fab_emit::emit(std::slice::from_ref(&program), &[]).unwrap();
    let source = source(&artifacts, "prompts/plan.user.txt.j2");
    let values = serde_json::json!({ "instruction": "i", "corners": "c", "center": "m" });
    let text = fab_emit::fill(&source, &values).unwrap();
    let (_, said) = text.split_once("- Center: m\n\n").unwrap();
    let expected = "{%(x, y) in pixels{12 px%}\nPick Point = (x, y)\nPlace Point = (x, y){";
    assert_eq!(said, expected);
}

#[test]
fn a_name_of_the_task_is_not_taken_for_what_was_said() {
    let mut program = guarded_program([true; 4]);
    for template in &mut program.templates {
        template.text = template.text.replace("v0", "said");
        for variable in &mut template.variables {
            if variable.name == "v0" {
                variable.name = "said".to_owned();
            }
        }
    }
    let artifacts = fab_emit::emit(std::slice::from_ref(&program), &[]).unwrap();
    let values = serde_json::json!({
        "said": "x", "v1": "b", "v2_inner": "c",
        "when": { "items": "yes", "plan.say.7": "yes", "keys": "", "values": "" },
    });
    let text = fab_emit::fill(&source(&artifacts, "prompts/plan.user.txt.j2"), &values).unwrap();
    assert_eq!(text, "\nx is {\n\n- b{% %}");
}

#[test]
#[ignore = "needs Python with jinja2 3.1.6"]
fn peer_python_fills_every_emitted_prompt_alike() {
    let all = filled_in_every_way();
    let asked: Vec<_> = all
        .iter()
        .map(|it| serde_json::json!([it.source, it.values]))
        .collect();
    let answers = crate::common::jinja2::rendered(&asked);
    for (ours, theirs) in all.iter().zip(&answers) {
        assert_eq!(ours.text, *theirs, "{}:\n{}", ours.path, ours.source);
    }
}
