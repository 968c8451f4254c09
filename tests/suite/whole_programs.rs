//! What programs can express beyond the shipped folds: layers, examples, directions, goals judged during the rollout.
//!
//! Each test changes one thing in a small shipped task and plays it with scripted models.

use super::support::{self, Scripted, Trial};
use fab_agent::examples::Examples;
use fab_agent::outcome::Outcome;
use fab_agent::rollout::{Ended, Event};
use fab_agent::scene::{Scene, SceneError};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::{Part, Request, Speaker};
use fab_program::scene::SceneView;
use fab_program::space;
use fab_program::{
    ActionField, Choices, Comparison, Direction, End, Example, Extractor, FileRef, Goal, ImageUp,
    Keypoint, Layer, Layers, LengthChoice, LengthUnit, LiteralText, Mark, Metric, Moment, Picture,
    PixelPoint, Point, Program, Spot,
};
use fab_world::start::Start;
use fab_world::{Grip, Look};
use serde_json::{Value, json};
use std::path::Path;

/// The result of a rollout with scripted replies.
struct Played {
    report: Ended,
    said: Vec<Request>,
    grips: Vec<(PixelPoint, Grip)>,
    /// The journal's step lines.
    steps: Vec<Value>,
}

fn play(program: &Program, folder: &Path, replies: &[&str]) -> Played {
    let (vision, text) = (Scripted::new(&[]), Scripted::new(replies));
    let trial = Trial::new(program, folder, Look::default());
    let mut grips = Vec::new();
    let mut watch = |event: Event| {
        if let Event::Motion { line, .. } = event {
            let actions = line.action.iter().flatten();
            grips.extend(actions.map(|it| (it.place_px, it.grip)));
        }
    };
    let models = Models {
        vision: &vision,
        text: &text,
    };
    let run = folder.join("run");
    let report = trial.run(models, &run, &mut watch);
    let journal = std::fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    let lines = journal
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    Played {
        report,
        said: text.asked.into_inner().unwrap(),
        grips,
        steps: lines.filter(|line| line["type"] == "step").collect(),
    }
}

/// The small task without its stage about pictures, so that one answer makes a step.
fn planning() -> Program {
    let mut program = support::small_task();
    program.stages.remove(0);
    // Its question mentions what the removed stage read.
    program.stages[0].say.clear();
    program
}

/// The scene of a program's flat cloth.
fn flat_scene(program: &Program) -> Result<Scene, SceneError> {
    let mut world = support::world(program).unwrap();
    world.reset(&Start::flat(&program.cloth)).unwrap();
    Scene::of(program, &world.observe().unwrap(), None)
}

fn corners(program: &Program) -> Vec<PixelPoint> {
    flat_scene(program).unwrap().points("corners").unwrap()
}

fn answer(pick: PixelPoint, place: PixelPoint) -> String {
    format!("Pick Point = {pick}\nPlace Point = {place}")
}

fn pictures(request: &Request) -> Vec<image::RgbImage> {
    let parts = request.messages.iter().flat_map(|message| &message.parts);
    let bytes = parts.filter_map(|part| match part {
        Part::Image(png) => Some(png.bytes()),
        Part::Text(_) => None,
    });
    bytes
        .map(|bytes| image::load_from_memory(bytes).unwrap().into_rgb8())
        .collect()
}

#[test]
fn an_exhausted_step_executes_the_newest_answer_that_passes_the_relaxed_checks() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = planning();
    program.horizon = 1;
    program.verify.relaxed = vec!["moves".to_owned()];
    let corners = corners(&program);
    let nowhere = answer(PixelPoint::new(1, 2), corners[0]);
    let still = [0, 1].map(|index| answer(corners[index], corners[index]));
    let played = play(&program, folder.path(), &[&still[0], &still[1], &nowhere]);
    assert_eq!(
        (played.report.outcome, played.report.steps),
        (Outcome::HorizonReached, 1)
    );
    assert_eq!(
        played.steps[0]["accepted"],
        json!({ "stage": "plan", "attempt": 2, "without": ["moves"] })
    );
    assert_eq!(played.steps[0]["action"][0]["pick_px"], json!(corners[1]));
}

#[test]
fn an_exhausted_step_ends_the_rollout_where_no_answer_passes_the_relaxed_checks() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = planning();
    program.verify.relaxed = vec!["moves".to_owned()];
    let nowhere = answer(PixelPoint::new(1, 2), PixelPoint::new(3, 4));
    let played = play(&program, folder.path(), &[nowhere.as_str(); 3]);
    assert_eq!(
        (played.report.outcome, played.report.steps),
        (Outcome::AttemptsExhausted, 0)
    );
    assert_eq!(played.steps[0]["accepted"], Value::Null);
}

fn words(text: &str) -> LiteralText {
    LiteralText {
        text: text.to_owned(),
        declared_in: "example.fab".to_owned(),
        line: 1,
    }
}

#[test]
fn examples_are_told_as_turns_with_their_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::RgbImage::from_pixel(5, 4, image::Rgb([9, 8, 7]));
    picture.save(folder.path().join("shown.png")).unwrap();
    let mut program = planning();
    program.stages[0].examples = vec![Example {
        say: vec![words("Which points?")],
        images: vec![FileRef {
            path: "shown.png".to_owned(),
        }],
        reply: words("Pick Point = (1, 1)\nPlace Point = (2, 2)"),
    }];
    let played = play(&program, folder.path(), &[]);
    assert_eq!(played.report.outcome, Outcome::ModelFailed);
    use Speaker::{Assistant, System, User};
    let messages = played.said[0].messages.iter();
    let speakers: Vec<Speaker> = messages.map(|message| message.speaker).collect();
    assert_eq!(speakers, [System, User, Assistant, User]);
    assert_eq!(pictures(&played.said[0]), [picture]);
    std::fs::remove_file(folder.path().join("shown.png")).unwrap();
    let missing = Examples::load(&program, folder.path()).unwrap_err();
    assert!(missing.to_string().contains("shown.png"), "{missing}");
}

/// Dots on the corners, and a ring around the last place.
fn layers() -> Vec<Layer> {
    let layer = |name: &str, rgb, mark| Layer {
        name: name.to_owned(),
        rgb,
        mark,
        words: name.to_owned(),
    };
    let dots = Mark::Dot {
        at: vec![Spot::Points {
            keypoint: "corners".to_owned(),
        }],
        radius_px: 2,
    };
    let place = Point::Last { end: End::Place };
    let ring = Mark::Ring {
        at: vec![Spot::One { point: place }],
        radius_px: 6,
        width_px: 1,
    };
    vec![layer("dots", RED, dots), layer("ring", BLUE, ring)]
}

const RED: [u8; 3] = [255, 0, 0];
const BLUE: [u8; 3] = [0, 0, 255];

#[test]
fn layers_are_drawn_and_those_of_the_last_action_only_after_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = planning();
    program.horizon = 2;
    program.layers = layers();
    program.stages[0].show = [Layers::Drawn, Layers::Absent]
        .map(|layers| Picture::Scene { layers })
        .to_vec();
    let corners = corners(&program);
    let played = play(&program, folder.path(), &[&answer(corners[0], corners[1])]);
    assert_eq!((played.said.len(), played.report.steps), (2, 1));
    let counted = |picture: &image::RgbImage, rgb: [u8; 3]| {
        picture.pixels().filter(|pixel| pixel.0 == rgb).count()
    };
    let (before, after) = (pictures(&played.said[0]), pictures(&played.said[1]));
    for corner in &corners {
        let pixel = before[0].get_pixel(corner.u as u32, corner.v as u32);
        assert_eq!(pixel.0, RED, "{corner}");
    }
    assert_eq!(counted(&before[0], BLUE), 0);
    let rim = after[0].get_pixel(corners[1].u as u32 + 6, corners[1].v as u32);
    // Only where the thin ring meets the middle of a pixel, that has its full colour.
    assert_eq!((rim.0, counted(&after[0], BLUE)), (BLUE, 4));
    for bare in [&before[1], &after[1]] {
        assert_eq!((counted(bare, RED), counted(bare, BLUE)), (0, 0));
    }
}

/// Makes a program's answers state a direction, a distance and a word instead of the place point.
fn steer(program: &mut Program) {
    let mut field = |name: &str, choices| {
        program.actions.push(ActionField {
            name: name.to_owned(),
            choices,
        });
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let directions = [
        (0.0, [1.0, 0.0]),
        (90.0, [0.0, -1.0]),
        (225.0, [-half, half]),
    ];
    let directions = directions.map(|(deg, vector)| Direction { deg, vector });
    let lengths = vec![LengthChoice {
        value: 60.0,
        m: 0.06,
    }];
    field(
        "direction",
        Choices::Directions {
            choices: directions.to_vec(),
        },
    );
    field(
        "distance",
        Choices::Lengths {
            unit: LengthUnit::find("mm").unwrap(),
            choices: lengths,
        },
    );
    field(
        "reach",
        Choices::Words {
            choices: vec!["high".to_owned(), "low".to_owned()],
        },
    );
    program.actions.retain(|field| field.name != "place");
    program.verify.checks.clear();
    program.horizon = 1;
}

/// An answer with a pick point, one of the directions, and the first choice of every other field.
fn steered(program: &Program, pick: PixelPoint, direction: usize) -> String {
    let mut lines = vec![format!("Pick Point = {pick}")];
    for field in &program.actions[1..] {
        let index = match field.name.as_str() {
            "direction" => direction,
            _ => 0,
        };
        let value = space::text(field, &space::declared(field)[index]);
        lines.push(space::statement(field, &value));
    }
    lines.join("\n")
}

#[test]
#[ignore = "long"]
fn a_direction_and_a_distance_lead_along_the_table_as_the_picture_shows_it() {
    for (up, rightwards, upwards) in [
        (ImageUp::Y, [1.0, 0.0], [0.0, 1.0]),
        (ImageUp::X, [0.0, -1.0], [1.0, 0.0]),
    ] {
        let mut program = planning();
        program.camera.up = up;
        steer(&mut program);
        let pick = corners(&program)[0];
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let ways = [[1.0, 0.0], [0.0, 1.0], [-half, -half]];
        for (index, [right, above]) in ways.into_iter().enumerate() {
            let folder = tempfile::tempdir().unwrap();
            let reply = steered(&program, pick, index);
            let played = play(&program, folder.path(), &[&reply]);
            assert_eq!(played.report.outcome, Outcome::HorizonReached, "{reply}");
            let (place_px, grip) = played.grips[0];
            let way = grip.place - grip.pick;
            for axis in 0..2 {
                let expected = 0.06 * (right * rightwards[axis] + above * upwards[axis]);
                assert!((way[axis] - expected).abs() < 1e-6, "{up:?} {index}: {way}");
            }
            let px = 0.06 * program.camera.px_per_m();
            let seen = [place_px.u - pick.u, place_px.v - pick.v].map(f64::from);
            let off = (seen[0] - px * right).hypot(seen[1] + px * above);
            assert!(off < 2.5, "{up:?} {index}: {seen:?}, {px} px");
            let fields = &played.steps[0]["attempts"][0]["result"]["fields"];
            assert_eq!(fields[2], json!(["distance", { "length": 60.0 }]));
            assert_eq!(fields[3], json!(["reach", "high"]));
        }
    }
}

#[test]
fn a_goal_on_coverage_ends_the_rollout_with_the_step_that_reaches_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = planning();
    program.horizon = 3;
    program.goal = Some(Goal {
        metric: Metric::Coverage,
        is: Comparison::Less,
        limit: 0.9,
    });
    let corners = corners(&program);
    let off = |point: &&PixelPoint| point.distance_px(corners[0]);
    let farthest = corners.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
    let reply = answer(corners[0], *farthest.unwrap());
    let played = play(&program, folder.path(), &[&reply]);
    assert_eq!(
        (played.report.outcome, played.report.steps),
        (Outcome::GoalReached, 1)
    );
    let coverage = played.report.measures.coverage.unwrap();
    assert!((0.3..0.9).contains(&coverage), "{coverage}");
    assert!(played.report.measures.normalized_improvement.unwrap() < 0.0);
    assert_eq!(played.steps[0]["coverage"].as_f64(), Some(coverage));
    assert_eq!(played.report.goal_reached, Some(true));
}

#[test]
fn a_task_without_subgoals_and_experts_runs() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = planning();
    program.subgoals = None;
    program.horizon = 1;
    let corners = corners(&program);
    let played = play(&program, folder.path(), &[&answer(corners[0], corners[1])]);
    assert_eq!(played.report.outcome, Outcome::HorizonReached);
    assert_eq!(played.report.mean_particle_distance_mm, None);
    assert!(folder.path().join("run/sheet.png").is_file());
}

#[test]
fn a_colour_that_is_not_in_view_is_an_empty_mask_unless_it_is_the_cloth() {
    let underside = Keypoint {
        name: "underside".to_owned(),
        moment: Moment::Now,
        extractor: Extractor::ColorMask {
            hue_deg: [280.0, 340.0],
            saturation: [0.196, 1.0],
            value: [0.294, 1.0],
        },
    };
    let mut program = planning();
    program.keypoints.push(underside.clone());
    let scene = flat_scene(&program).unwrap();
    assert_eq!(scene.area_px("underside"), Some(0.0));
    let anywhere = PixelPoint::new(9, 9);
    assert_eq!(scene.distance_px("underside", anywhere), None);
    program.keypoints.insert(0, underside);
    assert!(matches!(
        flat_scene(&program),
        Err(SceneError::OutOfView(mask, _)) if mask == "underside"
    ));
}

#[test]
fn the_pictures_pinned_for_shipped_tasks_fit_them() {
    for name in ["double_straight", "double_triangle"] {
        let program = support::task(name);
        let mut world = support::world(&program).unwrap();
        let folder = support::root().join("tasks");
        let interrupt = Interrupt::default();
        let set = SubgoalSet::obtain(&program, &folder, world.as_mut(), &interrupt);
        assert_eq!(set.unwrap().origin, Origin::Pinned, "{name}");
        let mut slower = program.clone();
        slower.manner.speed_m_s = Some(0.1);
        let set = SubgoalSet::obtain(&slower, &folder, world.as_mut(), &interrupt);
        assert_eq!(set.unwrap().origin, Origin::PinnedByOther, "{name}");
    }
}
