//! The proof that an action space is consistent: well-formed spaces pass, and planted contradictions are found.

use crate::spaces;
use fab_compiler::proof::{self, Flaw};
use fab_program::scene::SceneView;
use fab_program::space;
use fab_program::{
    ActionField, Choices, Extractor, Keypoint, LengthUnit, Moment, PixelPoint, Program, Value,
};
use proptest::prelude::*;

/// Returns the program of these fields and `pick`.
fn with(lines: &[&str]) -> Program {
    let lines = ["pick points corners"].iter().chain(lines);
    spaces::program(lines.map(|line| spaces::field(line)).collect())
}

fn words(choices: &[&str]) -> Program {
    let choices = choices.iter().map(|choice| (*choice).to_owned()).collect();
    let mut program = with(&["distance lengths mm 10"]);
    program.actions.push(ActionField {
        name: "grip".to_owned(),
        choices: Choices::Words { choices },
    });
    program
}

fn only(program: &Program) -> Flaw {
    let flaws = proof::flaws(program);
    assert_eq!(flaws.len(), 1, "{flaws:#?}");
    flaws.into_iter().next().unwrap()
}

#[test]
fn the_spaces_of_the_fixtures_are_consistent() {
    for name in ["points", "paper", "grip", "region"] {
        assert_eq!(proof::flaws(&spaces::space(name)), [], "{name}");
    }
}

#[test]
fn directions_a_tenth_of_a_degree_apart_are_consistent() {
    for line in [
        "direction directions 6.1 6.2",
        "direction directions 0 84.5 152.2 219.9",
        "direction directions 0 0.1 240.1 295.4",
    ] {
        assert_eq!(proof::flaws(&with(&[line])), [], "{line}");
    }
}

#[test]
fn choices_that_are_written_alike_are_flaws() {
    for (line, shown) in [
        ("angle directions 10 33.33331 33.33332", "33.3333 deg"),
        ("distance lengths edge 0.33333 0.33334", "0.3333 edge"),
        ("distance lengths m 0.00001 0.00002", "0 m"),
        ("grip words soft | Soft", "soft"),
        ("grip words very soft | very_soft", "very_soft"),
    ] {
        let flaws = proof::flaws(&with(&[line]));
        let is_told = |flaw: &Flaw| flaw.value == shown && flaw.message.contains("told apart");
        assert!(flaws.iter().any(is_told), "{line}: {flaws:#?}");
    }
}

#[test]
fn words_that_answers_cannot_carry_are_flaws() {
    let long = "x".repeat(101);
    for (word, why) in [
        ("", "is empty"),
        (&*long, "is longer than 100 bytes"),
        ("soft|firm", "means something else"),
        ("soft\nfirm", "line break"),
        ("\"soft\"", "means something else"),
        ("12", "has no letter"),
        (" soft", "begin and end"),
        ("pick", "is also the name of a field"),
        ("Distance", "is also the name of a field"),
    ] {
        let flaws = proof::flaws(&words(&["firm", word]));
        let is_told =
            |flaw: &Flaw| flaw.field == "grip" && flaw.value == word && flaw.message.contains(why);
        assert!(flaws.iter().any(is_told), "{word:?}: {flaws:#?}");
    }
    // The reader looks for offered words between blanks; no rule covers this one.
    let flaws = proof::flaws(&words(&["a", "a\u{a0}b"]));
    let is_told =
        |flaw: &Flaw| flaw.value.starts_with("a\u{a0}") && flaw.message.contains("read as `a`");
    assert!(flaws.iter().any(is_told), "{flaws:#?}");
}

#[test]
fn numbers_that_contradict_their_other_form_are_flaws() {
    let mut program = with(&["direction directions 0 90"]);
    let Choices::Directions { choices } = &mut program.actions[1].choices else {
        unreachable!("it was declared so")
    };
    choices[1].vector = [0.0, 1.0];
    assert!(only(&program).message.contains("has another direction"));

    let mut program = with(&["distance lengths edge 0.25 0.5"]);
    let Choices::Lengths { choices, .. } = &mut program.actions[1].choices else {
        unreachable!("it was declared so")
    };
    choices[1].m = 0.5;
    assert!(only(&program).message.contains("is not 0.5 m"));

    for (line, why) in [
        ("direction directions 0 400", "between 0 and 360"),
        ("direction directions 0 359.99999", "is read as `0 deg`"),
        ("direction directions 0 NaN", "between 0 and 360"),
        ("distance lengths mm 5 -1", "not a length"),
        ("distance lengths mm 5 1e7", "not a length"),
        ("distance lengths mm 5 inf", "not a length"),
    ] {
        let flaws = proof::flaws(&with(&[line]));
        let is_told = |flaw: &Flaw| flaw.message.contains(why);
        assert!(flaws.iter().any(is_told), "{line}: {flaws:#?}");
    }
}

#[test]
fn fields_that_are_mistaken_for_each_other_are_flaws() {
    for lines in [
        &["pick_point points corners"][..],
        &["Pick words a | b"],
        &["distance lengths mm 1", "distance lengths mm 1"],
        &["angle directions 0 90", "tip_angle directions 0 45"],
    ] {
        // The last one is right, because the longer name claims its own places.
        let is_right = lines.len() == 2 && lines[0].starts_with("angle ");
        let flaws = proof::flaws(&with(lines));
        assert_eq!(flaws.is_empty(), is_right, "{lines:?}: {flaws:#?}");
    }
}

#[test]
fn fields_without_choices_or_with_too_many_are_flaws() {
    let mut program = words(&[]);
    assert!(only(&program).message.contains("no choices"));
    let many: Vec<f64> = (0..=proof::MAX_CHOICES).map(|index| index as f64).collect();
    program.actions[2].choices = spaces::lengths(length_unit("mm"), &many);
    assert!(only(&program).message.contains("1001 choices"));
    program.actions[2].choices = spaces::lengths(length_unit("mm"), &many[1..]);
    assert_eq!(proof::flaws(&program), []);
    let field = |index: usize| spaces::field(&format!("field{index} words a | b"));
    program.actions.extend((0..proof::MAX_FIELDS).map(field));
    assert!(only(&program).message.contains("at most 16 fields"));
}

#[test]
fn fixed_points_that_cannot_be_read_are_flaws() {
    let mut program = with(&[]);
    program.keypoints.push(Keypoint {
        name: "corners".to_owned(),
        moment: Moment::Now,
        extractor: Extractor::Fixed {
            points: vec![PixelPoint::new(3, 4), PixelPoint::new(2_000_000, 4)],
        },
    });
    assert_eq!(only(&program).value, "(2000000, 4)");
}

/// A scene of three points, or of none.
struct Points(Vec<PixelPoint>);

impl SceneView for Points {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        (keypoint == "corners").then(|| self.0.clone())
    }
    fn distance_px(&self, _: &str, _: PixelPoint) -> Option<f64> {
        None
    }
    fn area_px(&self, _: &str) -> Option<f64> {
        None
    }
}

#[test]
fn the_sampler_draws_every_offered_value_equally_often() {
    let program = with(&["direction directions 0 45 90", "grip words soft | firm"]);
    let point = |u| PixelPoint::new(u, 7);
    // A point that is found twice is offered once.
    let scene = Points(vec![point(1), point(2), point(1), point(3)]);
    let mut drawn = std::collections::BTreeMap::new();
    for index in 0..18 {
        let mut rest = index;
        let mut below = |n: u64| {
            let digit = rest % n;
            rest /= n;
            digit
        };
        let proposal = space::sample(&program, &scene, &mut below).unwrap();
        *drawn.entry(format!("{proposal:?}")).or_insert(0) += 1;
    }
    assert_eq!(drawn.len(), 3 * 3 * 2);
    assert!(drawn.values().all(|times| *times == 1));
    let too_large = space::sample(&program, &scene, &mut |_| u64::MAX).unwrap();
    assert!(space::choices(&program.actions[0], &scene).contains(&too_large.fields[0].1));
    let nothing = space::sample(&program, &Points(Vec::new()), &mut |_| 0);
    assert_eq!(nothing, None);
}

/// A scene in which every mask is four pixels.
struct Four;

impl SceneView for Four {
    fn points(&self, _: &str) -> Option<Vec<PixelPoint>> {
        None
    }
    fn distance_px(&self, _: &str, point: PixelPoint) -> Option<f64> {
        Some(if point.u == 5 && (0..4).contains(&point.v) {
            0.0
        } else {
            1.0
        })
    }
    fn area_px(&self, _: &str) -> Option<f64> {
        Some(4.0)
    }
    fn region_pixel(&self, _: &str, number: u64) -> Option<PixelPoint> {
        (number < 4).then(|| PixelPoint::new(5, number as i32))
    }
}

#[test]
fn of_a_region_every_pixel_is_offered_and_drawn_equally_often() {
    let program = spaces::program(vec![spaces::field("pick region cloth")]);
    let field = &program.actions[0];
    let mut drawn: Vec<Value> = Vec::new();
    for index in 0..4 {
        let proposal = space::sample(&program, &Four, &mut |n| index % n).unwrap();
        drawn.push(proposal.fields[0].1.clone());
    }
    let expected: Vec<Value> = (0..4)
        .map(|v| Value::Point(PixelPoint::new(5, v)))
        .collect();
    assert_eq!(drawn, expected);
    assert!(
        drawn
            .iter()
            .all(|value| space::is_offered(field, value, &Four))
    );
    let beside = Value::Point(PixelPoint::new(6, 0));
    assert!(!space::is_offered(field, &beside, &Four));
    let none = space::sample(&program, &Points(Vec::new()), &mut |_| 0);
    assert_eq!(none, None, "an unknown region offers nothing");
}

fn length_unit(name: &str) -> LengthUnit {
    LengthUnit::find(name).unwrap()
}

/// Valid choices.
fn choices() -> impl Strategy<Value = Choices> {
    let tenths = |most: u32| prop::collection::btree_set(0..most, 1..20);
    let as_tenths = |set: std::collections::BTreeSet<u32>| -> Vec<f64> {
        set.into_iter()
            .map(|value| f64::from(value) / 10.0)
            .collect()
    };
    let unit = prop::sample::select(["mm", "cm", "m", "edge"].map(length_unit).to_vec());
    prop_oneof![
        Just(Choices::Points {
            keypoints: vec!["corners".to_owned(), "center".to_owned()]
        }),
        Just(Choices::Region {
            mask: "cloth".to_owned()
        }),
        tenths(3600).prop_map(move |set| spaces::directions(&as_tenths(set))),
        (unit, tenths(5000)).prop_map(move |(unit, set)| spaces::lengths(unit, &as_tenths(set))),
        // Thirds and the like, which are rounded when written.
        (2u32..50).prop_map(|n| {
            let parts: Vec<f64> = (0..n)
                .map(|part| 360.0 * f64::from(part) / f64::from(n))
                .collect();
            spaces::directions(&parts)
        }),
        (2u32..50).prop_map(|n| {
            let parts: Vec<f64> = (1..=n).map(|part| f64::from(part) / f64::from(n)).collect();
            spaces::lengths(LengthUnit::EDGE, &parts)
        }),
        prop::collection::btree_set("[a-zé][a-z0-9é]{0,8}([ -][a-z]{1,6})?", 1..12).prop_map(
            |set| {
                let plain = |word: &str| word.replace('-', " ");
                let mut choices: Vec<String> = Vec::new();
                for word in set {
                    if !choices.iter().any(|other| plain(other) == plain(&word)) {
                        choices.push(word);
                    }
                }
                Choices::Words { choices }
            }
        ),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    #[ignore = "long"]
    fn well_formed_choices_are_consistent(
        choices in prop::collection::vec(choices(), 1..5),
        first in 0usize..6,
    ) {
        // No name is a unit, or a word that the generator is likely to make.
        let names = ["pick", "place_two", "direction_of_it", "distanceto", "gripping_force_zz", "last_oneqq"];
        let actions = choices.into_iter().enumerate().map(|(index, choices)| ActionField {
            name: names[(first + index) % names.len()].to_owned(),
            choices,
        });
        let program = spaces::program(actions.collect());
        let flaws = proof::flaws(&program);
        prop_assert!(flaws.is_empty(), "{:#?}\n{}", flaws, space::format_with("(x, y)", &program.actions));
    }
}

#[test]
fn every_word_that_the_reader_knows_can_be_a_choice() {
    let words: std::collections::BTreeSet<String> = std::fs::read_dir("program/src/reply")
        .unwrap()
        .map(|file| file.unwrap().path())
        .filter(|path| path.is_file())
        .flat_map(|path| {
            let source = std::fs::read_to_string(path).unwrap();
            let words = source.split(|letter: char| !letter.is_ascii_lowercase());
            words.map(str::to_owned).collect::<Vec<_>>()
        })
        .filter(|word| !word.is_empty())
        .collect();
    assert!(words.contains("none") && words.contains("instead"));
    for word in words {
        let grip = ActionField {
            name: "gripping_force".to_owned(),
            choices: Choices::Words {
                choices: vec![word, "zzz".to_owned()],
            },
        };
        let flaws = proof::flaws(&spaces::program(vec![grip]));
        assert!(flaws.is_empty(), "{flaws:#?}");
    }
}
