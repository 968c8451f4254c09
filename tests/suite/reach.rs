//! Points that a world cannot reach: never offered, reported before a model is asked, and rejected if an answer still
//! leads there.

use super::support::{self, ProjectFiles, words_of};
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::Prompted;
use fab_agent::record::RECORD_FILE;
use fab_agent::rollout;
use fab_agent::rollout::{Ended, Job, first_questions};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_compiler::{LoadError, Loader};
use fab_model::Models;
use fab_model::calls::{Budget, Calls};
use fab_model::{Model, ModelError, ModelKind, Reply, Request};
use fab_program::{ModelRole, Program};
use fab_world::start::Start;
use fab_world::{Executed, Motion, SimulatedWorld, World, WorldError, WorldPoint, Wrapper};
use serde_json::Value;
use std::sync::Mutex;

/// The simulator's world with an arm that reaches to the right only up to some x, and lifts at most 150 mm.
struct Short {
    world: SimulatedWorld,
    most_x_m: f64,
}

impl Wrapper for Short {
    fn inner(&self) -> &dyn World {
        &self.world
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.world
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        assert_eq!(
            Wrapper::refuses(self, motion),
            None,
            "it was sent all the same"
        );
        for point in motion.grips.iter().flat_map(|grip| [grip.pick, grip.place]) {
            assert_eq!(
                Wrapper::out_of_reach(self, &point),
                None,
                "it was sent out of reach"
            );
        }
        self.world.act(motion, interrupt)
    }

    fn out_of_reach(&self, point: &WorldPoint) -> Option<String> {
        (point.x > self.most_x_m).then(|| {
            format!(
                "it lies {:.0} mm to the right, and the arm reaches {:.0} mm",
                point.x * 1000.0,
                self.most_x_m * 1000.0
            )
        })
    }

    fn refuses(&self, motion: &Motion) -> Option<String> {
        let lifts = motion.grips.iter().filter_map(|grip| grip.manner.lift_m);
        let lift_m = lifts.into_iter().find(|lift_m| *lift_m > 0.15)?;
        let lift_mm = lift_m * 1000.0;
        Some(format!(
            "`lift` of {lift_mm:.0} mm is above the arm's 150 mm"
        ))
    }
}

/// A model whose answer depends on the question and on the number of earlier ones.
struct Answering<'a> {
    answer: &'a (dyn Fn(usize, &Request) -> String + Sync),
    asked: Mutex<Vec<Request>>,
}

impl Model for Answering<'_> {
    fn name(&self) -> &str {
        "answering"
    }
    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }
    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let mut asked = self.asked.lock().unwrap();
        let text = (self.answer)(asked.len(), request);
        asked.push(request.clone());
        Ok(Reply::text(text))
    }
}

struct Played {
    report: Ended,
    asked: Vec<Request>,
    /// The journal's lines.
    lines: Vec<Value>,
}

/// Runs a task's first steps with an arm that reaches to `most_x_m`.
fn play(
    program: &Program,
    most_x_m: f64,
    answer: &(dyn Fn(usize, &Request) -> String + Sync),
) -> Played {
    let model = Answering {
        answer,
        asked: Mutex::default(),
    };
    let report_and_lines = with_job(program, most_x_m, &model, |job| {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        let report = rollout::run(job, RunFolder::create(&run).unwrap(), &mut |_| {}).unwrap();
        let text = std::fs::read_to_string(run.join(RECORD_FILE)).unwrap();
        let lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
        (report, lines.collect())
    });
    let (report, lines) = report_and_lines;
    Played {
        report,
        asked: model.asked.into_inner().unwrap(),
        lines,
    }
}

fn with_job<T>(
    program: &Program,
    most_x_m: f64,
    model: &dyn Model,
    work: impl FnOnce(&Job<'_>) -> T,
) -> T {
    let steps = program.subgoals.as_ref().map_or(0, |it| it.steps());
    let make_world = || -> Result<Box<dyn World>, WorldError> {
        let world = SimulatedWorld::of(program)?;
        Ok(Box::new(Short { world, most_x_m }))
    };
    work(&Job {
        program,
        start: &Start::flat(&program.cloth),
        subgoals: &SubgoalSet {
            pictures: vec![image::RgbImage::new(32, 32); steps + 1],
            arrows: vec![None; steps],
            origin: Origin::Author,
            ..SubgoalSet::default()
        },
        examples: &Examples::default(),
        make_policy: &Prompted::new(Models {
            vision: model,
            text: model,
        }),
        budget: &Budget::default(),
        make_world: &make_world,
        make_expert_world: &make_world,
        cache: &Cache::none(),
        interrupt: &Interrupt::default(),
        horizon: Some(1),
        early_stop: true,
        operator: None,
        repetition: 0,
        start_number: None,
    })
}

fn offered(request: &Request, field: &str) -> Vec<String> {
    let schema = request.schema.as_ref().unwrap();
    let values = schema["properties"][field]["enum"].as_array().unwrap();
    values
        .iter()
        .map(|value| value.as_str().unwrap().to_owned())
        .collect()
}

fn column(point: &str) -> i32 {
    let digits = point.trim_start_matches('(').split(',').next().unwrap();
    digits.parse().unwrap()
}

/// Answers for a fold: first the description of the step, then its first offered points.
fn folds(_: usize, request: &Request) -> String {
    if request.role == ModelRole::Vision {
        return "Instructions: fold it.".to_owned();
    }
    let (picks, places) = (offered(request, "pick"), offered(request, "place"));
    let place = places.iter().find(|place| **place != picks[0]).unwrap();
    format!("Pick Point = {}\nPlace Point = {place}", picks[0])
}

#[test]
fn points_out_of_reach_are_neither_offered_nor_listed_and_the_model_is_told_why() {
    let program = support::small_task();
    let whole = play(&program, f64::INFINITY, &folds);
    let all = offered(&whole.asked[1], "pick");
    assert!(all.iter().any(|point| column(point) > 112));

    // The right corners of the cloth lie at 84 mm, its center at 0.
    let played = play(&program, 0.05, &folds);
    assert_eq!(played.report.steps, 1);
    let plan = &played.asked[1];
    let left: Vec<String> = all.iter().filter(|it| column(it) < 112).cloned().collect();
    assert_eq!(offered(plan, "pick"), left);
    let words = words_of(plan);
    assert!(
        words.contains(&format!("- Cloth corners: {}\n", left.join(", "))),
        "{words}"
    );
    let right = all.iter().find(|point| column(point) > 112).unwrap();
    let told = "Some points cannot be reached, and nothing can be done there. They are not among those listed: ";
    let why = format!("{right}: it lies 83 mm to the right, and the arm reaches 50 mm");
    assert!(words.contains(told) && words.contains(&why), "{words}");
    assert!(
        !words_of(&played.asked[0]).contains(told),
        "a stage without points is told of none"
    );
    assert!(!words_of(&whole.asked[1]).contains("reach"), "{words}");
    let scene = &played.lines[1]["scene"];
    assert_eq!(scene["corners"].as_array().unwrap().len(), left.len());
    let unreachable = scene["unreachable"].as_array().unwrap();
    assert_eq!(unreachable.len(), all.len() - left.len());
    assert!(
        whole.lines[1]["scene"]["unreachable"].is_null(),
        "nothing is out of reach"
    );
}

#[test]
fn an_estimate_shows_the_same_questions() {
    let program = support::small_task();
    let model = Answering {
        answer: &folds,
        asked: Mutex::default(),
    };
    let questions = with_job(&program, 0.05, &model, |job| {
        let models = Models {
            vision: &model,
            text: &model,
        };
        first_questions(job, models)
    })
    .unwrap();
    assert!(words_of(&questions[1].request).contains("Some points cannot be reached"));
}

#[test]
fn a_point_of_its_own_stays_where_it_is_and_is_not_offered() {
    let program = support::small_task();
    let played = play(&program, -0.02, &folds);
    let plan = &played.asked[1];
    let words = words_of(plan);
    let center = words.split("- Cloth center: ").nth(1).unwrap();
    let center = center.lines().next().unwrap().to_owned();
    assert!(!offered(plan, "place").contains(&center));
    assert!(
        words.contains(&format!("{center}: it lies 0 mm")),
        "{words}"
    );
}

#[test]
fn an_answer_that_names_a_point_out_of_reach_is_refused_as_not_offered() {
    let program = support::small_task();
    let whole = play(&program, f64::INFINITY, &folds);
    let all = offered(&whole.asked[1], "pick");
    let right = all
        .iter()
        .find(|point| column(point) > 112)
        .unwrap()
        .clone();
    let answer = |number: usize, request: &Request| match number {
        1 => format!("Pick Point = {right}\nPlace Point = {}", all[0]),
        _ => folds(number, request),
    };
    let played = play(&program, 0.05, &answer);
    assert_eq!(played.report.refusals.get("offered"), Some(&1));
    assert_eq!(played.report.steps, 1);
}

#[test]
fn where_nothing_is_left_the_rollout_ends_without_a_question() {
    let played = play(&support::small_task(), -1.0, &folds);
    assert_eq!(played.report.outcome, Outcome::NoCandidates);
    assert!(played.asked.is_empty());
    let why = played.lines[1]["stopped"].as_str().unwrap();
    assert!(
        why.starts_with("no point of `corners` is in reach: (")
            && why.contains("and the arm reaches -1000 mm"),
        "{why}"
    );
}

/// A task of two files: the shipped library, and a text.
struct Beside(&'static str);

impl Loader for Beside {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        match name {
            "tasks/own.fab" => Ok(self.0.to_owned()),
            _ => ProjectFiles.load(name),
        }
    }
}

#[test]
fn a_task_says_it_in_its_own_words() {
    const OWN: &str = r#"
use "lib/folding.fab"
task own extends folding {
    cloth grid(28, 28)
    horizon 1
    component reach_words when unreachable "The arm cannot go there: {{ unreachable }}."
    component free_words when not unreachable "The arm can go everywhere."
    stage plan {
        model text
        say   planner_role, reach_words, free_words, point_format, "Corners: {{ corners }}"
        read  action
    }
    without component center_pivoting
    stage describe { model vision show scene say "What is there?" read instruction from "Instructions: {instruction}" }
    verify { attempts 1 }
}
"#;
    let compiled = fab_compiler::compile("tasks/own.fab", &Beside(OWN)).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    let program = compiled.programs.into_iter().next().unwrap();
    let played = play(&program, 0.05, &folds);
    let words = words_of(&played.asked[1]);
    assert!(
        words.contains("The arm cannot go there: (") && !words.contains("can go everywhere"),
        "{words}"
    );
    assert!(!words.contains("Some points cannot be reached"), "{words}");
    let words = words_of(&play(&program, 1.0, &folds).asked[1]);
    assert!(words.contains("The arm can go everywhere."), "{words}");
}

/// Compiles a small fold with some more lines.
fn lifting(lines: &'static str) -> Program {
    let compiled = fab_compiler::compile("tasks/own.fab", &Beside(lines)).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    compiled.programs.into_iter().next().unwrap()
}

/// What may be chosen and what the picker states: its words in the prompt, the motion in the record, and a refusal.
#[test]
fn a_lift_is_asked_for_executed_and_refused_beyond_the_arm() {
    let program = lifting(
        r#"
use "lib/folding.fab"
task own extends folding {
    cloth grid(28, 28)
    picker put_down(speed: 250mm/s)
    subgoals { demonstrate { fold corner(back_left) -> center } }
    actions {
        pick: one of corners
        place: one of corners, center
        lift: one of 0mm, 30mm, 200mm
    }
}
"#,
    );
    let lifts = |first: &'static str| {
        move |number: usize, request: &Request| {
            let answer = folds(number, request);
            let lift = if number == 1 { first } else { "30 mm" };
            format!("{answer}\nLift = {lift}")
        }
    };
    let played = play(&program, f64::INFINITY, &lifts("30 mm"));
    assert_eq!(
        offered(&played.asked[1], "lift"),
        ["0 mm", "30 mm", "200 mm"]
    );
    let words = words_of(&played.asked[1]);
    assert!(words.contains("Lift = "), "{words}");
    for grip in [
        &played.lines[1]["action"][0],
        &played.lines[1]["executed"]["grips"][0],
    ] {
        let expected = serde_json::json!({"lift_m": 0.03, "speed_m_s": 0.25});
        assert_eq!(grip["manner"], expected);
    }
    let took_s = |played: &Played| played.lines[1]["executed"]["duration_s"].as_f64().unwrap();
    let drags = play(&program, f64::INFINITY, &lifts("0 mm"));
    assert_eq!(drags.lines[1]["action"][0]["manner"]["lift_m"], 0.0);
    // Up and down 30 mm at 250 mm/s.
    let longer_s = took_s(&played) - took_s(&drags);
    assert!((longer_s - 0.24).abs() < 0.05, "{longer_s}");

    let refused = play(&program, f64::INFINITY, &lifts("200 mm"));
    assert_eq!(refused.report.refusals.get("reachable"), Some(&1));
    assert_eq!(refused.report.steps, 1);
    let told = words_of(&refused.asked[2]);
    let why = "The cloth cannot be moved like this: `lift` of 200 mm is above the arm's 150 mm. Choose other values.";
    assert!(told.contains(why), "{told}");
}

#[test]
fn a_task_whose_manner_the_world_refuses_ends_before_the_first_question() {
    let stated = r#"
use "lib/folding.fab"
task own extends folding {
    cloth grid(28, 28)
    picker put_down(lift: 250mm)
    subgoals { demonstrate { fold corner(back_left) -> center } }
}
"#;
    let offered = r#"
use "lib/folding.fab"
task own extends folding {
    cloth grid(28, 28)
    subgoals { demonstrate { fold corner(back_left) -> center } }
    actions { pick: one of corners place: one of corners, center lift: one of 250mm, 200mm }
}
"#;
    for lines in [stated, offered] {
        let program = lifting(lines);
        let model = Answering {
            answer: &folds,
            asked: Mutex::default(),
        };
        let folder = tempfile::tempdir().unwrap();
        let failed = with_job(&program, 1.0, &model, |job| {
            let run = RunFolder::create(&folder.path().join("run")).unwrap();
            rollout::run(job, run, &mut |_| {}).unwrap_err().to_string()
        });
        let why = "`lift` of 250 mm is above the arm's 150 mm";
        assert!(
            failed.contains("cannot be executed in the world `sim`") && failed.contains(why),
            "{failed}"
        );
        assert!(model.asked.into_inner().unwrap().is_empty());
    }
}

fn smoothing(variant: Option<&str>) -> Program {
    let compiled = fab_compiler::compile("tasks/smoothing.fab", &ProjectFiles).unwrap();
    let mut programs = compiled.programs.into_iter();
    let mut program = programs
        .find(|program| program.variant.as_deref() == variant)
        .unwrap();
    program.cloth.dimx = 28;
    program.cloth.dimy = 28;
    program.goal = None;
    program
}

#[test]
fn a_place_that_follows_from_a_distance_is_checked_last_and_costs_an_attempt() {
    let program = smoothing(None);
    // In this task's picture +X is up, so an upward pull takes the uppermost corner out of reach.
    let answer = |number: usize, request: &Request| {
        let mut picks = offered(request, "pick");
        picks.sort_by_key(|pick| {
            let row = pick.split(", ").nth(1).unwrap().trim_end_matches(')');
            row.parse::<i32>().unwrap()
        });
        let distance = ["0.5", "0.1"][number.min(1)];
        format!(
            "Pick Point = {}\nDirection = 90 deg\nDistance = {distance} edge",
            picks[0]
        )
    };
    let played = play(&program, 0.11, &answer);
    assert_eq!(played.report.refusals.get("reachable"), Some(&1));
    assert_eq!((played.report.steps, played.report.queries), (1, 2));
    let words = words_of(&played.asked[1]);
    assert!(
        words.contains("0.5 edge in the direction 90 deg leads to (")
            && words.contains("which cannot be reached: it lies 212 mm"),
        "{words}"
    );
    let verdict = &played.lines[1]["attempts"][0]["result"]["verdict"];
    assert_eq!(verdict["check"], "reachable", "{}", played.lines[1]);

    let refused = |_: usize, request: &Request| answer(0, request);
    let played = play(&program, 0.11, &refused);
    assert_eq!(
        (played.report.steps, played.report.skipped_steps),
        (0, 1),
        "what is out of reach is never relaxed"
    );
    assert_eq!(played.report.refusals.get("reachable"), Some(&3));
}

#[test]
fn a_pick_anywhere_on_a_mask_is_checked_too() {
    let program = smoothing(Some("without_preprocessing"));
    let answer = |number: usize, _: &Request| {
        // The middle of the picture is the middle of the cloth.
        let row = [320, 400][number.min(1)];
        format!("Pick Point = (360, {row})\nDirection = 270 deg\nDistance = 0.1 edge")
    };
    let played = play(&program, 0.02, &answer);
    assert_eq!(played.report.refusals.get("reachable"), Some(&1));
    assert_eq!(played.report.steps, 1);
    assert!(words_of(&played.asked[1]).contains("The pick point (360, 320) cannot be reached: "));
}
