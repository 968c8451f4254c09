//! A pick anywhere on the cloth: what a model is told, what is rejected, what is drawn at random.

use super::steered::{answer, play_with, steered_but};
use super::support::{self, words_of};
use fab_agent::outcome::Outcome;
use fab_agent::scene::Scene;
use fab_program::space;
use fab_program::{Program, Value};
use fab_world::start::Start;

/// The steered task with a pick anywhere, and its choices in the prompt.
fn free() -> Program {
    steered_but(&[
        ("one of corners, home", "any of cloth"),
        (
            "last_words, \"{{",
            "last_words, \"Pick {{ pick.choices }}. {{",
        ),
    ])
}

#[test]
fn any_pixel_of_the_cloth_may_be_picked_and_no_other() {
    let beside = answer("(5, 5)", "180 deg", "10 mm");
    let inside = answer("(90, 131)", "180 deg", "10 mm");
    let played = play_with(&free(), &[&beside, &inside], |trial| {
        trial.horizon = Some(1);
    });
    assert_eq!(played.report.outcome, Outcome::HorizonReached);
    assert_eq!((played.report.steps, played.report.queries), (1, 2));
    let asked = words_of(&played.asked[0]);
    assert!(asked.contains("Pick any point on the cloth."), "{asked}");
    let told = words_of(&played.asked[1]);
    let expected = "The pick point (5, 5) is not on the cloth. Choose any point on the cloth.";
    assert!(told.contains(expected), "{told}");
    let pick = &played.steps[0]["action"][0]["pick_px"];
    assert_eq!(*pick, serde_json::json!([90, 131]));
    let schema = played.asked[0].schema.as_ref().unwrap();
    assert!(schema["properties"]["pick"]["pattern"].is_string());
    assert_eq!(schema["properties"]["pick"].get("enum"), None);
}

#[test]
#[ignore = "long"]
fn the_random_pick_is_a_pixel_of_the_cloth_each_as_likely() {
    let program = free();
    let mut world = support::world(&program).unwrap();
    world.reset(&Start::flat(&program.cloth)).unwrap();
    let scene = Scene::of(&program, &world.observe().unwrap(), None).unwrap();
    let cloth = scene.cloth().unwrap();
    let mut drawn = std::collections::BTreeSet::new();
    for number in 0..cloth.area_px() as u64 {
        let proposal = space::sample(&program, &scene, &mut |n| number % n).unwrap();
        let Some(Value::Point(pixel)) = proposal.get("pick") else {
            panic!("a pick is a point")
        };
        assert_eq!(cloth.distance_px(*pixel), 0.0);
        drawn.insert((pixel.u, pixel.v));
    }
    assert_eq!(drawn.len(), cloth.area_px());
}
