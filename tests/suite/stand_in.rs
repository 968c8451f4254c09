//! The stand-in in whole rollouts: what it must not depend on, and what stops it.

use super::support::{self, Trial};
use fab_agent::outcome::Outcome;
use fab_agent::rollout::Event;
use fab_agent::subgoals::SubgoalSet;
use fab_model::Models;
use fab_program::Program;
use fab_standins::Geometric;
use fab_world::Look;
use serde_json::Value;

/// The result of a rollout of the small task: its outcome, and where each pick and place was, metres.
type Played = (Outcome, Vec<[f64; 4]>);

/// Runs a program; `change` may alter the pictures that the stand-in is shown.
fn play(program: &Program, look: &Look, change: &dyn Fn(&mut SubgoalSet)) -> Played {
    let folder = tempfile::tempdir().unwrap();
    let mut trial = Trial::new(program, folder.path(), look.clone());
    change(&mut trial.subgoals);
    let mut points = Vec::new();
    let mut watch = |event: Event| {
        if let Event::Motion { line, .. } = event
            && let Some([action]) = line.action.as_deref()
        {
            let (pick, place) = (action.grip.pick, action.grip.place);
            points.push([pick.x, pick.y, place.x, place.y]);
        }
    };
    let models = Models {
        vision: &Geometric,
        text: &Geometric,
    };
    let report = trial.run(models, &folder.path().join("run"), &mut watch);
    (report.outcome, points)
}

/// Whether two rollouts picked and placed at the same points, to within `limit_m`.
fn alike(a: &Played, b: &Played, limit_m: f64) -> bool {
    let near =
        |(a, b): (&[f64; 4], &[f64; 4])| a.iter().zip(b).all(|(a, b)| (a - b).abs() < limit_m);
    a.0 == b.0 && a.1.len() == b.1.len() && a.1.iter().zip(&b.1).all(near)
}

fn small() -> (Program, Played) {
    let program = support::small_task();
    let played = play(&program, &Look::default(), &|_| {});
    assert_eq!((played.0, played.1.len()), (Outcome::HorizonReached, 2));
    (program, played)
}

#[test]
#[ignore = "long"]
fn the_tasks_name_changes_nothing() {
    let (program, played) = small();
    let renamed = Program {
        task: "all_corners_inward".to_owned(),
        ..program
    };
    assert_eq!(play(&renamed, &Look::default(), &|_| {}), played);
}

#[test]
#[ignore = "long"]
fn the_cloths_colour_changes_nothing() {
    let (program, played) = small();
    let look = Look {
        top: [40, 90, 200],
        underside: [60, 160, 70],
        ..Look::default()
    };
    assert!(alike(&play(&program, &look, &|_| {}), &played, 1e-9));
}

#[test]
#[ignore = "long"]
fn another_camera_height_leads_to_the_same_points_on_the_table() {
    let (program, played) = small();
    let mut higher = program;
    higher.camera.height_m = 0.75;
    for keypoint in &mut higher.keypoints {
        if let fab_program::Extractor::DepthMask { below_m } = &mut keypoint.extractor {
            *below_m = 0.746;
        }
    }
    let seen = play(&higher, &Look::default(), &|_| {});
    assert!(alike(&seen, &played, 0.008), "{seen:?} against {played:?}");
}

#[test]
#[ignore = "long"]
fn without_its_arrow_the_rollout_ends_by_name() {
    let (program, _) = small();
    let erased = play(&program, &Look::default(), &|subgoals| {
        subgoals.arrows.fill(None)
    });
    assert_eq!(erased, (Outcome::MalformedReply, Vec::new()));
}

#[test]
#[ignore = "long"]
fn swapped_pictures_do_not_lead_to_the_same_fold() {
    let (program, played) = small();
    let swapped = play(&program, &Look::default(), &|subgoals| {
        subgoals.pictures.swap(0, 1)
    });
    assert_ne!(swapped.1.first(), played.1.first());
}

#[test]
#[ignore = "long"]
fn mirrored_pictures_lead_to_the_mirrored_fold() {
    let (program, played) = small();
    let side = f64::from(program.camera.image_px);
    let mirrored = play(&program, &Look::default(), &|subgoals| {
        subgoals
            .pictures
            .iter_mut()
            .for_each(image::imageops::flip_horizontal_in_place);
        let flip = |[u, v]: [f64; 2]| [side - u, v];
        subgoals
            .arrows
            .iter_mut()
            .flatten()
            .for_each(|arrow| *arrow = arrow.map(flip));
    });
    let ([px, py, qx, qy], [mpx, mpy, mqx, mqy]) = (played.1[0], mirrored.1[0]);
    let off = [px + mpx, py - mpy, qx + mqx, qy - mqy];
    assert!(
        off.iter().all(|off| off.abs() < 0.005),
        "{played:?} and {mirrored:?}"
    );
}

#[test]
fn stand_ins_that_choose_answer_what_a_shipped_task_asks() {
    let folder = tempfile::tempdir().unwrap();
    let file = support::project("tasks/sash.fab");
    let run = |model: &str| {
        let mut run = support::fabc(folder.path());
        support::finish(run.args(["run", &file, "--json", "--model", model]))
    };
    let report: Value = serde_json::from_str(&run("random:1").stdout).unwrap();
    assert_eq!(report["malformed_replies"], 0, "{report:#}");
    assert!(report["steps"].as_u64() > Some(0), "{report:#}");

    let said = run("imperfect:1:5");
    assert_eq!(said.code, 3, "{}", said.stderr);
    for words in [
        "not readable: Your answer states no pick point.",
        "the answer: I would pull it a little to the side.",
        "refused by `offered`: The pick point (111, 111) is not one of the offered points.",
    ] {
        assert!(said.stderr.contains(words), "{}", said.stderr);
    }
}
