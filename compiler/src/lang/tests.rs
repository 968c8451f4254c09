//! Each row is whole and there once.

use super::{annotate, calls, material, rehearse, vocabulary};
use fab_program::samples;
use fab_program::vocabulary::CallOf;
use std::collections::BTreeSet;

fn makes<T>(rows: &[CallOf<T>]) {
    for row in rows {
        for args in samples::of(&row.signature) {
            (row.make)(&args);
        }
    }
}

#[test]
fn every_row_asks_only_for_the_arguments_that_it_declares() {
    makes(calls::CLOTHS);
    makes(calls::CAMERAS);
    makes(calls::CLOTH_POINTS);
    makes(annotate::MARKS);
    makes(rehearse::TWINS);
}

#[test]
fn every_property_is_stored_from_the_arguments_that_it_declares() {
    let before = material_of_zeros();
    for row in material::PROPERTIES {
        let mut stored = before.clone();
        (row.call.make)(&mut stored, &samples::of(&row.call.signature)[0]);
        assert_ne!(stored, before, "{}", row.call.signature.name);
    }
}

fn material_of_zeros() -> fab_program::Material {
    let colour = serde_json::json!({ "name": "", "rgb": [0, 0, 0] });
    let none = serde_json::json!({ "warp": 0.0, "weft": 0.0, "bias": 0.0 });
    serde_json::from_value(serde_json::json!({
        "name": "", "weight_kg_m2": 0.0, "thickness_m": 0.0, "bending_length_m": none,
        "crease_recovery_deg": 0.0, "stretch": none, "table_friction": 0.0, "self_friction": 0.0,
        "upper": colour, "under": colour,
    }))
    .expect("a material")
}

#[test]
fn no_row_stands_twice() {
    let known = vocabulary();
    let mut seen = BTreeSet::new();
    let calls = known
        .calls
        .iter()
        .map(|call| (call.kind, call.form.clone()));
    let words = known
        .words
        .iter()
        .map(|entry| (entry.set, entry.word.name.to_owned()));
    for row in calls.chain(words) {
        assert!(seen.insert(row.clone()), "{row:?}");
    }
}

#[test]
fn the_sections_are_the_words_that_begin_a_line_of_a_task() {
    let known = vocabulary();
    let sections: BTreeSet<&str> = known.sections.iter().map(|section| section.word).collect();
    let words = fab_grammar::words(fab_grammar::Kind::Task);
    assert_eq!(sections, words.iter().copied().collect());
}
