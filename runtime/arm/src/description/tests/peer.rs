//! Compares arms of other makers with MuJoCo, which reads the same URDF files by itself: where the tool is, where inverse
//! kinematics leads, and how low the links' meshes come along plans.
//!
//! The descriptions are not part of this repository; `scripts/test-long.sh` fetches them.

use super::*;
use crate::driver::ArmState;
use crate::guard::Guard;
use crate::plan::Plan;
use crate::route::{Act, Route, SegmentName};
use fab_base::chance::Chance;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Vector3};
use serde::Deserialize;
use std::io::Write;
use std::process::{Command, Stdio};

/// How many poses of each arm are compared.
const POSES: usize = 1000;

/// How many plans of each arm are judged.
const PLANS: usize = 400;

/// Every so many points of a plan's path one is judged; the path's points are 10 mm apart.
const JUDGED: usize = 4;

/// How far the two may differ, metres: URDF files round to 11 digits, and MuJoCo keeps meshes in single precision.
const EXACT_M: f64 = 1e-6;

/// How far the inverse kinematics may be off, metres.
const SOLVED_M: f64 = 2e-4;

/// An arm of another maker.
struct Arm {
    settings: Settings,
    urdf: PathBuf,
    meshes: PathBuf,
    _folder: tempfile::TempDir,
}

#[derive(Deserialize)]
struct Row {
    position_m: [f64; 3],
    rotation: [[f64; 3]; 3],
    lowest_m: f64,
}

impl Arm {
    fn of(name: &str, package: &str) -> Arm {
        let robots = std::env::var_os("FABC_PEER_ROBOTS")
            .expect("make test-all names the descriptions of robots");
        let robots = Path::new(&robots).join("example-robot-data");
        let folder = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(&robots, folder.path().join("example-robot-data")).unwrap();
        let file = folder.path().join(format!("{name}.toml"));
        std::fs::copy(arms().join(format!("{name}.toml")), &file).unwrap();
        let settings = Settings::load(&file).unwrap();
        let urdf = folder.path().join(&settings.arm.as_ref().unwrap().urdf);
        let meshes = robots.join("robots").join(package).join("meshes");
        let meshes = [
            meshes.join(name).join("collision"),
            meshes.join("collision"),
        ];
        Arm {
            settings,
            urdf,
            meshes: meshes.into_iter().find(|it| it.is_dir()).unwrap(),
            _folder: folder,
        }
    }

    fn ask_mujoco(&self, angles: &[Vec<f64>]) -> Vec<Row> {
        let python = std::env::var_os("FABC_PEER_PYTHON").expect("make test-all names a Python");
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/urdf_poses.py");
        let mut peer = Command::new(python)
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let question = serde_json::json!({
            "urdf": self.urdf,
            "meshes": self.meshes,
            "joints": self.settings.chain().names(),
            "tip": self.settings.arm.as_ref().unwrap().tip_link,
            "angles": angles,
        });
        let mut input = peer.stdin.take().unwrap();
        input.write_all(question.to_string().as_bytes()).unwrap();
        drop(input);
        let output = peer.wait_with_output().unwrap();
        assert!(output.status.success());
        let rows: Vec<Row> = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(rows.len(), angles.len());
        rows
    }

    /// Returns where MuJoCo has the tool.
    fn tool(&self, row: &Row) -> Isometry3<f64> {
        let columns = Matrix3::from(row.rotation).transpose();
        let tip = Isometry3::from_parts(
            Vector3::from(row.position_m).into(),
            Rotation3::from_matrix_unchecked(columns).into(),
        );
        tip * self.settings.arm.as_ref().unwrap().tip_from_tool()
    }

    /// Angles within the limits, spread over all postures.
    fn samples(&self) -> Vec<Vec<f64>> {
        let mut chance = Chance::seeded(7);
        let joints = self.settings.chain().joints();
        let mut sample = || {
            let angle = |joint: &crate::kinematics::chain::Joint| {
                let [least, most] = joint.limits_rad.unwrap();
                least + (most - least) * chance.fraction()
            };
            joints.iter().map(angle).collect()
        };
        (0..POSES).map(|_| sample()).collect()
    }

    fn inverse_kinematics_leads_where_mujoco_says(&self) {
        let chain = self.settings.chain();
        let angles = self.samples();
        let home = self.settings.arm.as_ref().unwrap().home_deg.iter();
        let home: Vec<f64> = home.map(|it| it.to_radians()).collect();
        let mut solved = Vec::new();
        for (angles, row) in angles.iter().zip(self.ask_mujoco(&angles)) {
            let (ours, theirs) = (chain.base_from_tool(angles).unwrap(), self.tool(&row));
            let off_m = (ours.translation.vector - theirs.translation.vector).norm();
            assert!(off_m < EXACT_M, "{ours} {theirs}");
            assert!(
                ours.rotation.angle_to(&theirs.rotation) < EXACT_M,
                "{ours} {theirs}"
            );
            solved.push(chain.solve(&theirs, &home).unwrap());
        }
        let targets = self.ask_mujoco(&angles);
        for (target, row) in targets.iter().zip(self.ask_mujoco(&solved)) {
            let (target, landed) = (self.tool(target), self.tool(&row));
            let off_m = (target.translation.vector - landed.translation.vector).norm();
            assert!(off_m <= 1e-4, "{off_m} m off {target}");
            let off_deg = target.rotation.angle_to(&landed.rotation).to_degrees();
            assert!(off_deg <= 0.1, "{off_deg} degrees off {target}");
        }
        for angles in &solved {
            assert!(chain.is_within_limits(angles));
        }
    }

    /// Judges the paths of plans by the meshes of the links: none may come below the table.
    ///
    /// - `tips_m`: how far the URDF's fingertips reach past the tool; the settings state the table by the tool's height at
    ///   which they touch it.
    fn plans_stay_above_the_table(&self, tips_m: f64) {
        let settings = &self.settings;
        let guard = Guard::level(settings);
        let table_m = settings.table.center_m[2];
        let from = ArmState::hand_down(settings, &settings.workspace.rest_m.into()).unwrap();
        let mut chance = Chance::seeded(2024);
        let mut angles: Vec<Vec<f64>> = Vec::new();
        let (mut asked, mut allowed, mut refusal) = (0, 0, String::new());
        while allowed < PLANS {
            asked += 1;
            assert!(asked < 4 * PLANS, "{allowed} of {asked}: {refusal}");
            let mut target = || {
                let radius_m = 0.25 + 0.45 * chance.fraction();
                let (sin, cos) = (-1.0 + 2.0 * chance.fraction()).sin_cos();
                let below_m = if chance.below(8) == 0 { 0.02 } else { 0.0 };
                Point3::new(radius_m * cos, radius_m * sin, table_m - below_m)
            };
            let points = [target(), target()];
            let (plan, route) = Plan::make(settings, &guard, &from, points, &Default::default());
            let Some(route) = route else {
                refusal = plan.refusal().unwrap();
                continue;
            };
            allowed += 1;
            let joints_deg = &plan.segments[0].joints_deg;
            let start = ArmState {
                tool: Isometry3::from_parts(
                    Point3::from(plan.segments[0].to_m).into(),
                    from.tool.rotation,
                ),
                joints_rad: joints_deg.iter().map(|it| it.to_radians()).collect(),
                ..from.clone()
            };
            let Route {
                segments,
                after_missed_grasp,
                ..
            } = &route;
            let grasp = segments
                .iter()
                .position(|it| it.name == SegmentName::Grasp)
                .unwrap();
            let mut walk = |at: &ArmState, segments: &[crate::route::Segment]| {
                let mut at = at.clone();
                for segment in segments {
                    let Act::Move(to) = segment.act else { continue };
                    let motion = guard.motion(&at, &to, settings.motion.speed_m_s).unwrap();
                    let path = motion.get().waypoints.iter().map(|it| &it.joints_rad);
                    let path: Vec<_> = path.collect();
                    angles.extend(path.iter().step_by(JUDGED).copied().cloned());
                    angles.extend(path.last().copied().cloned());
                    at.joints_rad.clone_from(path.last().unwrap());
                    at.tool = to;
                }
                at
            };
            let grasped = walk(&start, &segments[1..=grasp]);
            walk(&grasped, &segments[grasp..]);
            walk(&grasped, after_missed_grasp);
        }
        for rows in angles.chunks(50_000) {
            for (angles, row) in rows.iter().zip(self.ask_mujoco(rows)) {
                let tool = self.tool(&row);
                assert!(
                    tool.translation.z > table_m - SOLVED_M,
                    "{angles:?}: the tool at {tool}"
                );
                let least_m = table_m - tips_m - SOLVED_M;
                let lowest_m = row.lowest_m;
                assert!(lowest_m > least_m, "{angles:?}: a link at {lowest_m}");
            }
        }
    }
}

#[test]
#[ignore = "needs Python with mujoco, and example-robot-data"]
fn peer_robots_mujoco_lands_where_a_ur5_was_sent() {
    Arm::of("ur5", "ur_description").inverse_kinematics_leads_where_mujoco_says();
}

#[test]
#[ignore = "needs Python with mujoco, and example-robot-data"]
fn peer_robots_mujoco_lands_where_a_panda_was_sent() {
    Arm::of("panda", "panda_description").inverse_kinematics_leads_where_mujoco_says();
}

#[test]
#[ignore = "needs Python with mujoco, and example-robot-data"]
fn peer_robots_mujoco_finds_plans_of_a_ur5_above_the_table() {
    // Its URDF has no hand.
    Arm::of("ur5", "ur_description").plans_stay_above_the_table(0.0);
}

#[test]
#[ignore = "needs Python with mujoco, and example-robot-data"]
fn peer_robots_mujoco_finds_plans_of_a_panda_above_the_table() {
    // The finger's joint, the rubber tip's middle and half its height, less the tool's place.
    let tips_m = 0.0584 + 0.045_25 + 0.009_25 - 0.1034;
    Arm::of("panda", "panda_description").plans_stay_above_the_table(tips_m);
}

/// Every description of the collection is read: what is wrong with parts that no arm uses is no fault.
#[test]
#[ignore = "needs example-robot-data"]
fn peer_robots_every_description_is_read() {
    let robots = std::env::var_os("FABC_PEER_ROBOTS").expect("make test-all names them");
    let (mut folders, mut read) = (vec![PathBuf::from(robots)], 0);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|it| it == "urdf") {
                let text = std::fs::read_to_string(&path).unwrap();
                let robot = super::super::urdf::read(&text);
                robot.unwrap_or_else(|why| panic!("{}: {why}", path.display()));
                read += 1;
            }
        }
    }
    assert!(read >= 60, "{read}");
}
