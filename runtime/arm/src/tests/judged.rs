//! Judges settings and plans by kinematics that are not the driver's: the vendor's table of Denavit-Hartenberg
//! parameters. The driver's chain comes from the vendor's URDF files, and shares no number or code with this.
//!
//! Nothing that is accepted may be below the table, outside of its box, or inside of a keep-out zone.

use super::*;
use crate::plan::Plan;
use crate::route::{Act, Segment};
use fab_base::chance::Chance;
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// How far a judged place may be off, metres: the table's lengths have four digits.
const EXACT_M: f64 = 2e-4;

/// The least radius of a link, metres: half of the KA-58 actuator's width.
const LINK_M: f64 = 0.03;

/// An arm by its Denavit-Hartenberg parameters, metres and radians: `alpha`, `a`, `d`, and the offset of `theta`.
///
/// Kinova, "JACO2 advanced specification guide", 6 degrees of freedom, classic convention. The first angle counts the
/// other way round.
struct Table([[f64; 4]; 6]);

impl Table {
    fn of(model: &str) -> Table {
        let (d1, d2, d3, d6, e2) = (0.2755, 0.4100, 0.2073, 0.1600, 0.0098);
        let (bend, d4b, d5b, d6b, fifth) = match model {
            // Two bends of 60 degrees; the frames stand where their axes meet.
            "j2n6s200" | "j2n6s300" => {
                let d4 = 0.0741;
                let share = (PI / 6.0).sin() / (PI / 3.0).sin();
                (
                    PI / 3.0,
                    d3 + share * d4,
                    2.0 * share * d4,
                    share * d4 + d6,
                    PI,
                )
            }
            // A spherical wrist.
            _ => (FRAC_PI_2, d3 + 0.10375, 0.0, 0.10375 + d6, 0.0),
        };
        Table([
            [FRAC_PI_2, 0.0, d1, 0.0],
            [PI, d2, 0.0, -FRAC_PI_2],
            [FRAC_PI_2, 0.0, -e2, FRAC_PI_2],
            [bend, 0.0, -d4b, 0.0],
            [bend, 0.0, -d5b, fifth],
            [PI, 0.0, -d6b, FRAC_PI_2],
        ])
    }

    /// Returns where the frames' origins are, from the shoulder to the tool, metres, base frame.
    fn origins(&self, joints_rad: &[f64]) -> Vec<Vector3<f64>> {
        let mut turned = Rotation3::identity();
        let mut at = Vector3::zeros();
        let mut origins = Vec::new();
        for (index, ([alpha, a, d, offset], angle)) in self.0.iter().zip(joints_rad).enumerate() {
            let sign = if index == 0 { -1.0 } else { 1.0 };
            turned *= Rotation3::from_axis_angle(&Vector3::z_axis(), sign * angle + offset);
            at += turned * Vector3::new(*a, 0.0, *d);
            turned *= Rotation3::from_axis_angle(&Vector3::x_axis(), *alpha);
            origins.push(at);
        }
        origins
    }
}

/// A table's surface, judged by itself.
struct Ground {
    height: [f64; 3],
}

impl Ground {
    fn above_m(&self, point: &Vector3<f64>) -> f64 {
        point.z - self.height[0] - self.height[1] * point.x - self.height[2] * point.y
    }
}

/// Checks joint angles on the way; the error says what is where it may not be.
fn judge(settings: &Settings, ground: &Ground, joints_rad: &[f64]) -> Result<Vector3<f64>, String> {
    let origins = Table::of(&settings.model).origins(joints_rad);
    let tool = origins[5];
    let workspace = &settings.workspace;
    if ground.above_m(&tool) < -EXACT_M {
        return Err(format!("the tool at {tool} is below the table"));
    }
    for axis in 0..2 {
        let range = workspace.min_m[axis] - EXACT_M..=workspace.max_m[axis] + EXACT_M;
        if !range.contains(&tool[axis]) {
            return Err(format!("the tool at {tool} is outside of the box"));
        }
    }
    if tool.z > workspace.max_m[2] + EXACT_M {
        return Err(format!("the tool at {tool} is above the box"));
    }
    for (index, pair) in origins.windows(2).enumerate() {
        for part in 0..=10 {
            let point = pair[0].lerp(&pair[1], f64::from(part) / 10.0);
            // The hand's last centimetres touch the table; the links before it are held off by their radius.
            let least_m = if index < 3 { LINK_M } else { -EXACT_M };
            if ground.above_m(&point) < least_m {
                return Err(format!("link {index} at {point} is below the table"));
            }
            let is_in = |zone: &crate::settings::KeepOut| {
                (0..3).all(|axis| (zone.min_m[axis]..=zone.max_m[axis]).contains(&point[axis]))
            };
            if let Some(zone) = workspace.keep_out.iter().find(|zone| is_in(zone)) {
                return Err(format!("link {index} at {point} is in `{}`", zone.name));
            }
        }
    }
    Ok(tool)
}

/// Judges every point of a plan that is accepted, the way home included; returns whether it is.
fn judged_plan(settings: &Settings, height: [f64; 3], points: [Point3<f64>; 2]) -> bool {
    let ground = Ground { height };
    let guard = Guard::new(settings, Surface::tilted(height));
    let turn_rad = settings.motion.hand_turn_deg.to_radians();
    let rest = crate::kinematics::tool_down::tool_down(&settings.workspace.rest_m.into(), turn_rad);
    let rest_m = settings.workspace.rest_m.into();
    let Ok(from) = ArmState::hand_down(settings, &rest_m) else {
        return false;
    };
    let (plan, route) = Plan::make(settings, &guard, &from, points, &Default::default());
    let told = || format!("{settings:#?}\n{height:?} {points:?}");
    let Some(route) = route else {
        assert!(plan.refusal().is_some());
        return false;
    };
    let speed_m_s = settings.motion.speed_m_s;
    let joints_of = |degrees: &[f64]| degrees.iter().map(|it| it.to_radians()).collect();
    let walk = |from: &ArmState, segments: &[Segment]| {
        let mut at = from.clone();
        for segment in segments {
            let Act::Move(to) = segment.act else { continue };
            let motion = guard.motion(&at, &to, speed_m_s).unwrap();
            let start = at.tool.translation.vector;
            let way = to.translation.vector - start;
            let waypoints = &motion.get().waypoints;
            for pair in waypoints.windows(2) {
                for part in 0..4 {
                    let part = f64::from(part) / 4.0;
                    let at_s = pair[0].at_s + part * (pair[1].at_s - pair[0].at_s);
                    let between = pair[0].towards(&pair[1], at_s);
                    let tool = judge(settings, &ground, &between);
                    let tool =
                        tool.unwrap_or_else(|why| panic!("{:?}: {why}\n{}", segment.name, told()));
                    let along = (tool - start).dot(&way) / way.norm_squared();
                    let off_m = (tool - start - way * along.clamp(0.0, 1.0)).norm();
                    assert!(off_m < 0.001, "{off_m} m beside the line\n{}", told());
                }
            }
            let joints_rad = &waypoints.last().unwrap().joints_rad;
            let last = judge(settings, &ground, joints_rad).unwrap();
            assert!(
                (last - to.translation.vector).norm() < EXACT_M,
                "{}",
                told()
            );
            at.joints_rad.clone_from(joints_rad);
            at.tool = to;
        }
        at
    };
    let start = ArmState {
        joints_rad: joints_of(&plan.segments[0].joints_deg),
        ..from
    };
    let start = ArmState {
        tool: Isometry3::from_parts(Point3::from(plan.segments[0].to_m).into(), rest.rotation),
        ..start
    };
    let Route {
        segments,
        after_missed_grasp,
        ..
    } = &route;
    let grasp = segments
        .iter()
        .position(|it| it.name == crate::route::SegmentName::Grasp);
    let grasped = walk(&start, &segments[1..=grasp.unwrap()]);
    walk(&grasped, &segments[grasp.unwrap()..]);
    walk(&grasped, after_missed_grasp);
    true
}

fn between(chance: &mut Chance, least: f64, most: f64) -> f64 {
    least + (most - least) * chance.fraction()
}

/// One of the values, evenly.
fn one<T: Copy>(chance: &mut Chance, values: &[T]) -> T {
    values[chance.below(values.len())]
}

/// A number, now and then one that cannot be meant.
fn number(chance: &mut Chance, usual: f64, odd: f64) -> String {
    let value = match chance.fraction() < odd {
        true => one(
            chance,
            &[
                0.0,
                -usual,
                10.0 * usual,
                0.001,
                usual + 0.05,
                usual - 0.03,
                f64::NAN,
                f64::INFINITY,
                1e300,
            ],
        ),
        false => usual,
    };
    match value {
        value if value.is_nan() => "nan".to_owned(),
        value if value.is_infinite() => "inf".to_owned(),
        value => format!("{value:?}"),
    }
}

/// Three coordinates, now and then more or fewer.
fn place(chance: &mut Chance, usual: [f64; 3], odd: f64) -> String {
    let mut numbers: Vec<String> = usual.iter().map(|it| number(chance, *it, odd)).collect();
    match chance.fraction() {
        share if share < odd / 2.0 => numbers.push("0.4".to_owned()),
        share if share < odd => _ = numbers.pop(),
        _ => {}
    }
    format!("[{}]", numbers.join(", "))
}

/// The text of settings; with `odd` at 0 most of them can be used.
pub(super) fn settings_text(chance: &mut Chance, odd: f64) -> String {
    let (model, count) = one(chance, &[("j2n6s200", 2), ("j2n6s300", 3), ("j2s6s200", 2)]);
    let table_m = between(chance, -0.05, 0.15);
    let below_m = between(chance, 0.0031, 0.0099);
    let tolerance_m = between(chance, 0.0005, 0.003);
    let lift_m = between(chance, 0.004, 0.08);
    let travel_m = between(chance, 0.09, 0.2);
    let turn_deg = between(chance, -180.0, 180.0);
    let n_zones = chance.below(3);
    let zones: Vec<String> = (0..n_zones)
        .map(|index| {
            let corner = [
                between(chance, 0.1, 0.8),
                between(chance, -0.6, 0.6),
                between(chance, -0.1, 0.6),
            ];
            let size = [0; 3].map(|_| between(chance, 0.01, 0.15));
            let far = [0, 1, 2].map(|axis| corner[axis] + size[axis]);
            format!(
                "{{ name = 'zone {index}', min_m = {}, max_m = {} }}",
                place(chance, corner, odd),
                place(chance, far, odd)
            )
        })
        .collect();
    let rest = [
        between(chance, 0.2, 0.45),
        -between(chance, 0.25, 0.42),
        table_m + between(chance, 0.1, 0.25),
    ];
    format!(
        "name = 'lab'\nmodel = '{model}'\ndriver = 'simulated'\ncalibration = 'lab.toml'\n\
         table = {{ center_m = {} }}\n\
         fingers = {{ count = {count}, open = 0.0, closed = 6400.0, tolerance = {} }}\n\
         camera = {{ source = 'simulated', window_px = [0, 0, 720] }}\n\
         tolerance = {{ position_m = {} }}\n\
         [workspace]\nmin_m = {}\nmax_m = {}\nrest_m = {}\nkeep_out = [{}]\n\
         [motion]\npre_pick_m = {}\ngrasp_m = {}\nlift_m = {}\nretreat_m = {}\ntravel_m = {}\nhand_turn_deg = {}\n",
        place(chance, [0.45, 0.0, table_m], odd),
        number(chance, 100.0, odd),
        number(chance, tolerance_m, odd),
        place(chance, [0.15, -0.525, table_m - below_m], odd),
        place(chance, [0.75, 0.525, table_m + 0.45], odd),
        place(chance, rest, odd),
        zones.join(", "),
        number(chance, 0.006, odd),
        number(chance, 0.0, odd),
        number(chance, lift_m, odd),
        number(chance, 0.05, odd),
        number(chance, travel_m, odd),
        number(chance, turn_deg, odd),
    )
}

/// A point over the table that a hand may be sent to, sometimes below it or out of reach.
pub(super) fn target(chance: &mut Chance, height: [f64; 3]) -> Point3<f64> {
    let radius_m = between(chance, 0.25, 0.7);
    let (sin, cos) = between(chance, -1.2, 1.2).sin_cos();
    let [x, y] = [radius_m * cos, radius_m * sin];
    let above_m = match chance.below(8) {
        0 => -0.05,
        1 => -0.001,
        2 => 0.03,
        _ => 0.0,
    };
    Point3::new(x, y, height[0] + height[1] * x + height[2] * y + above_m)
}

/// Judges so many settings, and a plan with each that is accepted.
fn judge_settings(cases: u64) {
    let mut chance = Chance::seeded(24);
    let (mut accepted, mut planned) = (0, 0);
    for _ in 0..cases {
        let Ok(settings) = Settings::parse(&settings_text(&mut chance, 0.03)) else {
            continue;
        };
        accepted += 1;
        let workspace = &settings.workspace;
        let table_m = settings.table.center_m[2];
        assert!(
            (0.0..=0.0101).contains(&(table_m - workspace.min_m[2])),
            "{settings:#?}"
        );
        assert!(workspace.rest_m[2] > table_m + 0.004, "{settings:#?}");
        let gaps = [settings.motion.pre_pick_m, settings.motion.lift_m];
        let least_m = settings.motion.grasp_m + settings.tolerance.position_m;
        assert!(gaps.iter().all(|gap_m| *gap_m > least_m), "{settings:#?}");
        let height = [table_m, 0.0, 0.0];
        let points = [0; 2].map(|_| target(&mut chance, height));
        planned += u64::from(judged_plan(&settings, height, points));
    }
    // A check that refused everything would pass.
    assert!(
        accepted > cases / 10 && accepted < 9 * cases / 10,
        "{accepted}"
    );
    assert!(planned > cases / 100, "{planned}");
}

/// Judges so many plans that are allowed, over tables that are tilted by up to 3 degrees.
fn judge_plans(cases: u64) {
    let mut chance = Chance::seeded(2024);
    let (mut asked, mut allowed) = (0, 0);
    while allowed < cases {
        // A check that refused everything would never end.
        assert!(asked < 20 * cases, "{allowed} of {asked}");
        let Ok(settings) = Settings::parse(&settings_text(&mut chance, 0.0)) else {
            continue;
        };
        for _ in 0..5 {
            asked += 1;
            let tilt = between(&mut chance, 0.0, 3f64.to_radians().tan());
            let way_rad = between(&mut chance, 0.0, 2.0 * PI);
            let [along_x, along_y] = [tilt * way_rad.cos(), tilt * way_rad.sin()];
            let [x, y, z] = settings.table.center_m;
            let height = [z - along_x * x - along_y * y, along_x, along_y];
            let points = [0; 2].map(|_| target(&mut chance, height));
            allowed += u64::from(judged_plan(&settings, height, points));
        }
    }
}

#[test]
fn a_hundred_settings_keep_everything_above_the_table() {
    judge_settings(100);
}

#[test]
#[ignore = "long"]
fn many_settings_keep_everything_above_the_table() {
    judge_settings(600);
}

#[test]
fn some_plans_stay_above_the_table() {
    judge_plans(12);
}

#[test]
#[ignore = "long"]
fn many_plans_stay_above_the_table() {
    judge_plans(150);
}
