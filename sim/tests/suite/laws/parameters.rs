//! Bad parameters are rejected by name, or harmless.

use super::*;
use fab_sim::{SimError, StartError};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Returns the default parameters with one unchecked change; `axis` is an index into lists.
fn with(field: usize, axis: usize, value: f32) -> Params {
    let mut params = Params::default();
    let own: [&mut f32; 18] = [
        &mut params.step_secs,
        &mut params.damping_per_s,
        &mut params.max_acceleration_m_s2,
        &mut params.sleep_speed_m_s,
        &mut params.rest_speed_m_s,
        &mut params.stretch,
        &mut params.shear,
        &mut params.bend,
        &mut params.table_contact_m,
        &mut params.table_friction,
        &mut params.self_contact_m,
        &mut params.self_contact_softness,
        &mut params.self_friction,
        &mut params.picker_radius_m,
        &mut params.picker_skin_m,
        &mut params.picker_capture_m,
        &mut params.picker_travel_m,
        &mut params.picker_grasp_height_m,
    ];
    match field {
        0..18 => *own.into_iter().nth(field).unwrap() = value,
        18 => params.picker_lift_height_m = value,
        19 => params.gravity_m_s2[axis] = value,
        20 => params.picker_home_m[axis] = value,
        21 => params.substeps = value as u32,
        _ => params.sweeps = value as u32,
    }
    params
}

const FIELDS: usize = 23;

#[test]
fn every_field_is_tried() {
    let Value::Object(fields) = serde_json::to_value(Params::default()).unwrap() else {
        panic!("parameters are an object");
    };
    assert_eq!(fields.len(), FIELDS);
    let defaults = serde_json::to_value(Params::default()).unwrap();
    for field in 0..FIELDS {
        let changed = serde_json::to_value(with(field, 0, 77.0)).unwrap();
        let differ = fields
            .keys()
            .filter(|name| changed[*name] != defaults[*name]);
        assert_eq!(differ.count(), 1, "field {field}");
    }
}

#[test]
fn numbers_out_of_bounds_are_refused_by_name_value_and_bounds() {
    let cases = [
        (
            json!({"substeps": 0}),
            "the parameter `substeps` is `0`, outside `1` to `100`",
        ),
        (
            json!({"substeps": 4_000_000_000u32}),
            "`substeps` is `4000000000`",
        ),
        (
            json!({"sweeps": 101}),
            "the parameter `sweeps` is `101`, outside `1` to `100`",
        ),
        (
            json!({"step_secs": 0.0}),
            "the parameter `step_secs` is `0`, outside `0.0001` to `0.1` s",
        ),
        (json!({"step_secs": 1e39}), "`step_secs` is `inf`"),
        (
            json!({"table_friction": -0.1}),
            "`table_friction` is `-0.1`, outside `0` to `100`",
        ),
        (
            json!({"gravity_m_s2": [0, 0, -980]}),
            "`gravity_m_s2` is `-980`, outside `-100` to `100` m/s^2",
        ),
        (
            json!({"damping_per_s": 500}),
            "`damping_per_s` is `500`, outside `0` to `400` per second",
        ),
        (
            json!({"self_contact_m": 11.25}),
            "`self_contact_m` is `11.25`, outside `0.001` to `0.1` m",
        ),
        (
            json!({"picker_travel_m": 0}),
            "`picker_travel_m` is `0`, outside `0.00001` to `1` m",
        ),
    ];
    for (changes, expected) in cases {
        let said = serde_json::from_value::<Params>(changes.clone())
            .unwrap_err()
            .to_string();
        assert!(said.contains(expected), "{changes}: {said}");
    }
    let whole = serde_json::to_value(Params::default()).unwrap();
    assert_eq!(
        serde_json::from_value::<Params>(whole).unwrap(),
        Params::default()
    );
}

#[test]
fn a_simulator_with_bad_parameters_is_refused_or_never_steps() {
    let params = with(0, 0, f32::NAN);
    let fault = params.check().unwrap_err();
    assert_eq!((fault.field, fault.value.as_str()), ("step_secs", "NaN"));
    let grid = grid(4, 4);
    let refused = Simulator::from_positions(grid, &at_height(grid, 0.1), &params).unwrap_err();
    assert_eq!(refused, StartError::Params(fault.clone()));
    let mut cloth = Simulator::flat(grid, &params);
    let before = cloth.positions();
    assert_eq!(cloth.step().unwrap_err(), SimError::Params(fault.clone()));
    let picked = cloth.pick_and_place([0.0, 0.0], [0.1, 0.0], &|| false);
    assert_eq!(picked.unwrap_err(), SimError::Params(fault.clone()));
    assert_eq!(
        cloth.crumple(1, &|| false).unwrap_err(),
        SimError::Params(fault)
    );
    assert_eq!(cloth.positions(), before);
    assert_eq!(cloth.steps(), 0);
}

/// Numbers of every kind: any bits, and numbers near bounds.
fn any_number() -> impl Strategy<Value = f32> {
    let special = [
        0.0,
        -0.0,
        1e-45,
        1e-6,
        1e-4,
        1e-3,
        0.01,
        0.1,
        1.0,
        2.0,
        10.0,
        100.0,
        1e9,
        f32::MAX,
        f32::INFINITY,
    ];
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        prop::sample::select(special.to_vec()),
        prop::sample::select(special.to_vec()).prop_map(|value| -value),
        -1.0f32..1.0,
        0.0f32..100.0,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Changes up to two fields at once, because many are harmless alone.
    #[test]
    fn any_numbers_are_refused_or_simulate_to_finite_places_or_named_errors(
        fields in prop::array::uniform2(0..FIELDS), axis in 0usize..3, values in prop::array::uniform2(any_number()),
    ) {
        let [one, two] = [0, 1].map(|k| with(fields[k], axis, values[k]));
        let mut params = serde_json::to_value(&one).unwrap();
        let name = serde_json::to_value(Params::default()).unwrap().as_object().unwrap().iter()
            .find(|(name, value)| serde_json::to_value(&two).unwrap()[*name] != **value)
            .map(|(name, _)| name.clone());
        if let Some(name) = name {
            params[name.as_str()] = serde_json::to_value(&two).unwrap()[name.as_str()].clone();
        }
        // JSON cannot express numbers that are not finite; such a number is tried alone.
        let params = serde_json::from_value::<Params>(params).unwrap_or(one);
        let mut cloth = Simulator::flat(grid(6, 5), &params);
        if let Err(fault) = params.check() {
            prop_assert_eq!(cloth.step().unwrap_err(), SimError::Params(fault));
            return Ok(());
        }
        cloth.hold(&[0]).unwrap();
        for step in 0..20 {
            let lift = [0.0, 0.001, if step < 10 { 0.005 } else { 0.0 }];
            match cloth.step_held(lift) {
                Ok(()) => prop_assert!(cloth.positions().iter().flatten().all(|v| v.is_finite())),
                Err(SimError::NonFinite { .. }) => break,
                Err(other) => prop_assert!(false, "{}", other),
            }
        }
    }
}
