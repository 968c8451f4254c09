//! The agent loop with scripted models: what ends it, what it asks again, what it never does.

use super::support::{self, Scripted, Trial};
use fab_agent::outcome::Outcome;
use fab_agent::policy::Finding;
use fab_agent::rollout::{Ended, Event};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::Budget;
use fab_model::{Part, Request, Speaker};
use fab_program::verify::Verdict;
use fab_program::{Extractor, Program, Response};
use fab_world::Look;
use fab_world::start::Start;
use serde_json::Value;

const WORDS: &str = "Instructions: fold the back left corner onto the front left corner.\nExplanation: the arrow says so.";

/// The result of a rollout with scripted replies.
struct Played {
    report: Ended,
    seen: Vec<Request>,
    said: Vec<Request>,
    findings: Vec<Finding>,
}

/// Plays one step of the small task.
fn play(vision: &[&str], text: &[&str]) -> Played {
    play_task(
        &Program {
            horizon: 1,
            ..support::small_task()
        },
        vision,
        text,
        &Interrupt::default(),
    )
}

fn play_task(program: &Program, vision: &[&str], text: &[&str], interrupt: &Interrupt) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let (vision, text) = (Scripted::new(vision), Scripted::new(text));
    let steps = program
        .subgoals
        .as_ref()
        .map_or(0, |subgoals| subgoals.steps());
    // Scripted models do not look at pictures, so none need to be drawn.
    let subgoals = SubgoalSet {
        pictures: vec![image::RgbImage::new(32, 32); steps + 1],
        arrows: vec![None; steps],
        origin: Origin::Author,
        ..SubgoalSet::default()
    };
    let trial = Trial {
        examples: fab_agent::examples::Examples::default(),
        program,
        start: Start::flat(&program.cloth),
        subgoals,
        look: Look::default(),
        cache: Cache::none(),
        interrupt: interrupt.clone(),
        horizon: None,
        early_stop: true,
        budget: Budget::default(),
        repetition: 0,
        start_number: None,
    };
    let mut findings = Vec::new();
    let mut watch = |event: Event| {
        if let Event::Verdict { asked, .. } = event {
            findings.push(asked.result);
        }
    };
    let models = Models {
        vision: &vision,
        text: &text,
    };
    let report = trial.run(models, &folder.path().join("run"), &mut watch);
    Played {
        report,
        seen: vision.asked.into_inner().unwrap(),
        said: text.asked.into_inner().unwrap(),
        findings,
    }
}

/// The corners that the prompt of stage two offers, in its notation.
fn offered_corners() -> Vec<String> {
    let played = play(&[WORDS], &["nothing", "nothing", "nothing"]);
    let Part::Text(prompt) = &played.said[0].messages[1].parts[0] else {
        panic!("stage two has no words")
    };
    let line = prompt
        .lines()
        .find(|line| line.contains("corners"))
        .unwrap();
    let list = &line[line.find('(').unwrap()..];
    list.split_inclusive(')')
        .map(|point| point.trim_start_matches([',', ' ']).to_owned())
        .filter(|point| point.ends_with(')'))
        .collect()
}

fn answer(pick: &str, place: &str) -> String {
    format!("Pick Point = {pick}\nPlace Point = {place}")
}

#[test]
fn a_good_answer_is_executed_after_two_questions() {
    let corners = offered_corners();
    let played = play(&[WORDS], &[&answer(&corners[0], &corners[1])]);
    assert_eq!(played.report.outcome, Outcome::HorizonReached);
    assert_eq!(
        (played.report.steps, played.seen.len(), played.said.len()),
        (1, 1, 1)
    );
    let Part::Text(prompt) = &played.said[0].messages[1].parts[0] else {
        panic!("stage two has no words")
    };
    assert!(
        prompt.contains("fold the back left corner onto the front left corner"),
        "{prompt}"
    );
}

#[test]
fn the_record_says_what_was_read_and_each_repair() {
    let corners = offered_corners();
    let [pick, place] = [&corners[0], &corners[1]];
    let bare = |corner: &str| corner.trim_matches(['(', ')']).to_owned();
    let played = play(
        &[&format!(
            "**Instructions:** {}",
            &WORDS["Instructions: ".len()..]
        )],
        &[&format!(
            "Pick Point: {}\nPlace Point = {place}",
            bare(pick)
        )],
    );
    let recorded: Vec<Value> = played
        .findings
        .iter()
        .map(|finding| serde_json::to_value(finding).unwrap())
        .collect();
    let told = &recorded[0]["stated"][0];
    assert_eq!(told["field"], "instruction");
    let text = told["text"].as_str().unwrap();
    assert!(
        text.starts_with("**Instructions:** fold the back left"),
        "{text}"
    );
    assert_eq!(told["at"], 0);
    let action = &recorded[1];
    let stated = |field: usize| {
        (
            &action["stated"][field]["field"],
            &action["stated"][field]["text"],
        )
    };
    assert_eq!(
        stated(0),
        (
            &"pick".into(),
            &format!("Pick Point: {}", bare(pick)).into()
        )
    );
    assert_eq!(
        stated(1),
        (&"place".into(), &format!("Place Point = {place}").into())
    );
    let repairs = action["stated"][0]["repairs"].as_array().unwrap();
    assert!(
        repairs.len() == 1 && repairs[0].as_str().unwrap().contains(&bare(pick)),
        "{repairs:?}"
    );
}

#[test]
fn stage_one_sees_two_pictures_and_stage_two_sees_none() {
    let played = play(&[WORDS], &["no", "no", "no"]);
    let pictures = |request: &Request| {
        request
            .messages
            .iter()
            .flat_map(|message| &message.parts)
            .filter(|part| matches!(part, Part::Image(_)))
            .count()
    };
    assert_eq!(pictures(&played.seen[0]), 2);
    assert!(played.said.iter().all(|request| pictures(request) == 0));
}

#[test]
fn a_refused_answer_is_asked_again_with_the_reason_and_at_most_three_times() {
    let corners = offered_corners();
    let nowhere = answer("(1, 2)", &corners[1]);
    let played = play(&[WORDS], &[&nowhere, &nowhere, &nowhere, &nowhere]);
    assert_eq!(played.report.outcome, Outcome::AttemptsExhausted);
    assert_eq!((played.said.len(), played.report.steps), (3, 0));
    for (finding, _) in played.findings.iter().skip(1).zip(0..3) {
        let Finding::Action {
            verdict: Verdict::Reject { check, message, .. },
            ..
        } = finding
        else {
            panic!("{finding:?}")
        };
        assert_eq!(check, "offered");
        assert!(
            message.contains("(1, 2)") && message.contains(&corners[0]),
            "{message}"
        );
    }
    let last = &played.said[2].messages;
    let speakers: Vec<Speaker> = last.iter().map(|message| message.speaker).collect();
    use Speaker::{Assistant, System, User};
    assert_eq!(speakers, [System, User, Assistant, User, Assistant, User]);
}

#[test]
fn a_correction_is_taken_to_heart() {
    let corners = offered_corners();
    let still = answer(&corners[0], &corners[0]);
    let played = play(&[WORDS], &[&still, &answer(&corners[0], &corners[1])]);
    let Finding::Action {
        verdict: Verdict::Reject { check, .. },
        ..
    } = &played.findings[1]
    else {
        panic!("{:?}", played.findings)
    };
    assert_eq!(check, "moves");
    assert_eq!(
        (played.report.outcome, played.report.steps),
        (Outcome::HorizonReached, 1)
    );
}

#[test]
fn answers_that_cannot_be_read_end_with_their_own_outcome() {
    let played = play(&["I see a cloth.", "Still a cloth.", "A cloth."], &[]);
    assert_eq!(played.report.outcome, Outcome::MalformedReply);
    assert_eq!((played.seen.len(), played.said.len()), (3, 0));
    let played = play(&[WORDS], &["left", "right", "up"]);
    assert_eq!(played.report.outcome, Outcome::MalformedReply);
}

#[test]
fn the_last_answer_decides_between_malformed_and_refused() {
    let corners = offered_corners();
    let nowhere = answer("(1, 2)", &corners[1]);
    assert_eq!(
        play(&[WORDS], &["?", "?", &nowhere]).report.outcome,
        Outcome::AttemptsExhausted
    );
    assert_eq!(
        play(&[WORDS], &[&nowhere, &nowhere, "?"]).report.outcome,
        Outcome::MalformedReply
    );
}

#[test]
fn a_model_without_an_answer_ends_the_rollout() {
    assert_eq!(play(&[], &[]).report.outcome, Outcome::ModelFailed);
    assert_eq!(play(&[WORDS], &[]).report.outcome, Outcome::ModelFailed);
}

#[test]
fn a_cloth_outside_the_picture_is_a_named_outcome() {
    let mut program = support::small_task();
    for keypoint in &mut program.keypoints {
        if let Extractor::DepthMask { below_m } = &mut keypoint.extractor {
            *below_m = 0.5;
        }
    }
    let played = play_task(&program, &[], &[], &Interrupt::default());
    assert_eq!(played.report.outcome, Outcome::ClothOutOfView);
    assert_eq!(played.seen.len(), 0);
}

#[test]
fn a_detector_without_a_corner_is_a_named_outcome() {
    let mut program = support::small_task();
    for keypoint in &mut program.keypoints {
        if let Extractor::Corners { response, .. } = &mut keypoint.extractor {
            // With k = 1, Harris's response, det - k trace^2, is never above zero.
            *response = Response::Harris { k: 1.0 };
        }
    }
    let played = play_task(&program, &[], &[], &Interrupt::default());
    assert_eq!(played.report.outcome, Outcome::NoCandidates);
}

#[test]
fn an_interrupt_before_a_step_asks_nobody() {
    let interrupt = Interrupt::default();
    interrupt.raise();
    let played = play_task(&support::small_task(), &[WORDS], &[], &interrupt);
    assert_eq!(
        (played.report.outcome, played.seen.len()),
        (Outcome::Interrupted, 0)
    );
}
