//! An arm as data: a URDF file, and what a settings file says beside it.
//!
//! In: the section `[arm]` of the settings, and the URDF and mesh files that it names; or the name of a model that is
//! shipped (`shipped`). Out: a [`Chain`] with shapes; else all faults. A URDF's numbers are doubted: a joint without limits,
//! a link without a shape or a mesh that cannot be read would let an arm go where it must not, so each is refused. No
//! program is run to find or expand a file.

mod hull;
mod mesh;
mod shipped;
mod urdf;

use super::kinematics;
use super::kinematics::chain::{Angles, Chain, Joint, MAX_JOINTS, MIN_JOINTS};
use super::kinematics::shape::Capsule;
use super::settings::declare::{ANGLE, from, section};
use fab_base::files;
use fab_base::wording::quoted;
use fab_program::nearest::nearest;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use urdf::{Robot, Shape};

/// The longest URDF file accepted, bytes.
const MAX_URDF_BYTES: u64 = 4 << 20;

/// The largest angle that a joint's limits may name, degrees: cables allow two turns, and not more.
const MAX_LIMIT_DEG: f64 = 720.0;

/// The highest speed that a joint may have, deg/s; the fastest arms of a lab reach 430.
const MAX_SPEED_DEG_S: f64 = 720.0;

/// Joints that are no farther apart have nothing between them, metres.
const FRAME_M: f64 = 1e-3;

/// Slack of comparisons of angles, degrees: URDF files round pi.
const EXACT_DEG: f64 = 1e-3;

section! {
    /// The section `[arm]`: an arm of another kind than those that are shipped.
    pub struct ArmDescription {
        /// The URDF file, relative to the settings, with xacro expanded. Meshes are `.stl` or `.obj`; a package is a
        /// folder of its name above the file.
        urdf: PathBuf;
        /// The link whose frame is the base frame; its z points up.
        base_link: String;
        /// The link that carries the hand; between the two turn six or seven joints, and no other moves.
        tip_link: String;
        /// The tool's place in the frame of `tip_link`: between the fingertips.
        tool_xyz_m: [f64; 3] = [0.0, 0.0, 0.0], from(-1.0, 1.0);
        /// Its rotation there about fixed x, y, z; the tool's z points out of the hand.
        tool_rpy_deg: [f64; 3] = [0.0, 0.0, 0.0], ANGLE;
        /// The joints' angles in a posture over the table with the hand down; of several postures the one
        /// to which a search from there leads is taken.
        home_deg: Vec<f64>, from(-720.0, 720.0);
        /// Limits of joints that the URDF lacks, or tighter ones; looser ones are refused.
        joint: Vec<JointLimits> = [];
        /// Capsules that contain a link, in place of its collision shapes in the URDF; a link that is
        /// drawn or long and has none is refused, because nothing would keep it off the table.
        shape: Vec<LinkShape> = [];
        /// Capsules that contain hand and fingers in every opening, in place of the shapes that the URDF has behind the
        /// last joint; needed if it has none there, or if fingers turn.
        hand: Vec<HandShape> = [];
    }

    /// Limits of a joint that the URDF lacks, or tighter ones.
    pub struct JointLimits {
        /// The joint's name in the URDF.
        name: String;
        /// The least angle.
        min_deg: Option<f64>, from(-720.0, 720.0);
        /// The largest.
        max_deg: Option<f64>, from(-720.0, 720.0);
        /// The highest speed.
        max_speed_deg_s: Option<f64>, from(1.0, 720.0);
    }

    /// A capsule around a link.
    pub struct LinkShape {
        /// The link's name in the URDF.
        link: String;
        /// One end of the capsule's line, in the link's frame.
        from_m: [f64; 3], from(-2.0, 2.0);
        /// The other.
        to_m: [f64; 3], from(-2.0, 2.0);
        /// Its radius.
        radius_m: f64, from(0.005, 0.5);
    }

    /// A capsule around the hand.
    pub struct HandShape {
        /// One end of the capsule's line, in the tool frame.
        from_m: [f64; 3], from(-1.0, 1.0);
        /// The other.
        to_m: [f64; 3], from(-1.0, 1.0);
        /// Its radius.
        radius_m: f64, from(0.005, 0.5);
    }
}

/// A link that a joint of the chain carries.
struct Carried<'b> {
    name: &'b str,
    /// Its frame in that of the chain's joint; each end of its way if it slides.
    joint_from_link: Vec<Isometry3<f64>>,
    /// Whether it is behind the last joint's own link: a part of the hand.
    is_hand: bool,
}

/// Balls whose hull contains a shape, in the link's frame.
struct Cloud {
    middles: Vec<Point3<f64>>,
    radius_m: f64,
    is_mesh: bool,
}

impl ArmDescription {
    /// Builds the arm; fails with all faults.
    ///
    /// - `folder`: the folder of the settings.
    pub(crate) fn chain(&self, folder: &Path) -> Result<Chain, Vec<String>> {
        let file = folder.join(&self.urdf);
        let text = files::read_text(&file, MAX_URDF_BYTES);
        self.chain_of(&file, text)
    }

    /// Builds the arm of a URDF file's text.
    fn chain_of(&self, file: &Path, text: Result<String, String>) -> Result<Chain, Vec<String>> {
        let robot = text.and_then(|text| urdf::read(&text));
        let robot = robot.map_err(|why| {
            vec![format!(
                "`arm.urdf`, `{}`, cannot be used: {why}",
                file.display()
            )]
        })?;
        let mut builder = Builder {
            arm: self,
            robot: &robot,
            file,
            faults: Vec::new(),
        };
        match builder.build() {
            Some(chain) if builder.faults.is_empty() => Ok(chain),
            _ => Err(builder.faults),
        }
    }

    fn tip_from_tool(&self) -> Isometry3<f64> {
        kinematics::frame(self.tool_xyz_m, self.tool_rpy_deg.map(f64::to_radians))
    }
}

/// Builds a chain, and collects what is wrong.
struct Builder<'b> {
    arm: &'b ArmDescription,
    robot: &'b Robot,
    file: &'b Path,
    faults: Vec<String>,
}

impl<'b> Builder<'b> {
    fn build(&mut self) -> Option<Chain> {
        let path = self.path()?;
        let moving = path.iter().filter(|joint| joint.kind != "fixed");
        let moving: Vec<&urdf::Joint> = moving.copied().collect();
        let names: Vec<String> = moving.iter().map(|joint| joint.name.clone()).collect();
        if !(MIN_JOINTS..=MAX_JOINTS).contains(&moving.len()) {
            self.faults.push(format!(
                "the chain from `arm.base_link` to `arm.tip_link` has {} joints that move: {}; expected {MIN_JOINTS} or \
                 {MAX_JOINTS}, because fewer do not bring the hand to every pose, and more are not supported",
                moving.len(),
                quoted(&names)
            ));
            return None;
        }
        let mut joints = Vec::new();
        let mut joint_from_link = Isometry3::identity();
        for joint in &path {
            let at_joint = joint_from_link * joint.parent_from_joint;
            joint_from_link = at_joint;
            if joint.kind != "fixed" {
                self.check_kind(joint);
                let turned = z_to(joint);
                joints.push(Joint {
                    parent_from_joint_at_zero: at_joint * turned,
                    limits_rad: self.limits(joint),
                    max_speed_rad_s: self.max_speed(joint),
                });
                joint_from_link = Isometry3::from_parts(Translation3::identity(), turned.inverse());
            }
        }
        let last_from_tool = joint_from_link * self.arm.tip_from_tool();
        self.check_names(&names);
        let home = self.home(&joints, &names);
        let shapes = self.shapes(&moving, &joints, &last_from_tool);
        Some(Chain {
            model: self.robot.name.clone(),
            names,
            joints,
            home,
            last_from_tool,
            shapes,
        })
    }

    /// Returns the joints between base and tip, fixed ones included.
    fn path(&mut self) -> Option<Vec<&'b urdf::Joint>> {
        let (base, tip) = (&self.arm.base_link, &self.arm.tip_link);
        for (key, name) in [("base_link", base), ("tip_link", tip)] {
            if !self.robot.links.contains_key(name) {
                let near = did_you_mean(name, self.robot.links.keys().map(String::as_str));
                self.faults.push(format!(
                    "`arm.{key}` is `{name}`; expected a link of `{}`{near}",
                    self.file.display()
                ));
            }
        }
        if !self.faults.is_empty() {
            return None;
        }
        let mut path = Vec::new();
        let mut at = tip;
        while at != base {
            let joints = self.robot.joints.iter();
            let above: Vec<&urdf::Joint> = joints.filter(|joint| joint.child == *at).collect();
            match above[..] {
                [joint] if path.len() < self.robot.joints.len() => {
                    path.push(joint);
                    at = &joint.parent;
                }
                _ => {
                    self.faults.push(format!(
                        "`arm.tip_link`, `{tip}`, does not hang from `arm.base_link`, `{base}`: the link `{at}` hangs from {} \
                         joints; expected one at each link, and no circle",
                        above.len()
                    ));
                    return None;
                }
            }
        }
        path.reverse();
        Some(path)
    }

    fn check_kind(&mut self, joint: &urdf::Joint) {
        let is = match &joint.mimics {
            Some(other) => format!("follows `{other}`"),
            None if ["revolute", "continuous"].contains(&joint.kind.as_str()) => return,
            None => format!("is `{}`", joint.kind),
        };
        self.faults.push(format!(
            "the joint `{}` {is}; expected `revolute`, `continuous` or `fixed` between `arm.base_link` and `arm.tip_link`, \
             and one that moves by itself: no other joint is supported there",
            joint.name
        ));
    }

    fn stated(&self, joint: &urdf::Joint) -> Option<&'b JointLimits> {
        self.arm
            .joint
            .iter()
            .find(|limits| limits.name == joint.name)
    }

    /// Returns the least and the largest angle of a joint, radians.
    fn limits(&mut self, joint: &urdf::Joint) -> Option<[f64; 2]> {
        let (name, stated) = (&joint.name, self.stated(joint));
        let given = joint.limits.filter(|_| joint.kind != "continuous");
        let given = given.map(|limits| limits.map(f64::to_degrees));
        let least = stated.and_then(|it| it.min_deg).or(given.map(|it| it[0]));
        let most = stated.and_then(|it| it.max_deg).or(given.map(|it| it[1]));
        let [low, high] = given.unwrap_or([-MAX_LIMIT_DEG, MAX_LIMIT_DEG]);
        let [low, high] = [low.max(-MAX_LIMIT_DEG), high.min(MAX_LIMIT_DEG)];
        let are = match (least, most) {
            (None, None) if joint.kind == "continuous" => return None,
            (Some(least), Some(most)) => {
                // NaN must fail this check.
                let are_within = low - EXACT_DEG <= least && most <= high + EXACT_DEG;
                if least < most && are_within {
                    return Some([least, most].map(f64::to_radians));
                }
                format!("are `{least:.3}` to `{most:.3}` deg")
            }
            _ => "are not known".to_owned(),
        };
        self.faults.push(format!(
            "the limits of the joint `{name}` {are}; expected the first below the second, and both within {low:.3} to \
             {high:.3} deg: `min_deg` and `max_deg` of an `[[arm.joint]]` with `name = \"{name}\"` state tighter ones"
        ));
        None
    }

    /// Returns the highest speed of a joint, rad/s.
    fn max_speed(&mut self, joint: &urdf::Joint) -> f64 {
        let name = &joint.name;
        let given = joint.max_speed.map(f64::to_degrees);
        let speed = self
            .stated(joint)
            .and_then(|it| it.max_speed_deg_s)
            .or(given);
        let most = given.unwrap_or(MAX_SPEED_DEG_S).min(MAX_SPEED_DEG_S);
        if let Some(speed) = speed
            && speed > 0.0
            && speed <= most + EXACT_DEG
        {
            return speed.to_radians();
        }
        let is = speed.map_or("not known".to_owned(), |speed| {
            format!("`{speed:.3}` deg/s")
        });
        self.faults.push(format!(
            "the highest speed of the joint `{name}` is {is}; expected above 0 and at most {most:.1} deg/s: \
             `max_speed_deg_s` of an `[[arm.joint]]` with `name = \"{name}\"` states a lower one"
        ));
        1.0
    }

    /// Checks that every `[[arm.joint]]` is of a joint of the chain, and of another one.
    fn check_names(&mut self, names: &[String]) {
        let stated: Vec<&String> = self.arm.joint.iter().map(|limits| &limits.name).collect();
        for (index, name) in stated.iter().enumerate() {
            if !names.contains(name) || stated[..index].contains(name) {
                self.faults.push(format!(
                    "`arm.joint[{index}].name` is `{name}`; expected a joint between `arm.base_link` and `arm.tip_link` that \
                     no other `[[arm.joint]]` names: {}",
                    quoted(names)
                ));
            }
        }
    }

    /// Returns the home posture, radians.
    fn home(&mut self, joints: &[Joint], names: &[String]) -> Angles {
        let mut home = Angles::default();
        let home_deg = &self.arm.home_deg;
        if home_deg.len() != joints.len() {
            self.faults.push(format!(
                "`arm.home_deg` holds {} angles; expected {}, one for each joint: {}",
                home_deg.len(),
                joints.len(),
                quoted(names)
            ));
        }
        let joints = joints.iter().zip(names).zip(&mut home);
        for (((joint, name), home), at_deg) in joints.zip(home_deg) {
            *home = at_deg.to_radians();
            let limits = joint.limits_rad.map(|limits| limits.map(f64::to_degrees));
            if let Some([least, most]) = limits
                && !(least - EXACT_DEG..=most + EXACT_DEG).contains(at_deg)
            {
                self.faults.push(format!(
                    "`arm.home_deg` holds `{at_deg}` for the joint `{name}`; expected {least:.1} to {most:.1}, its limits"
                ));
            }
        }
        home
    }

    /// Returns the shapes of the links that the joints move, and of the hand. A link that is drawn must have one, and so
    /// must whatever leads from one joint to another place; a frame, or a joint at the place of the next, needs none.
    fn shapes(
        &mut self,
        moving: &[&'b urdf::Joint],
        joints: &[Joint],
        last_from_tool: &Isometry3<f64>,
    ) -> Vec<Capsule> {
        let hand = moving.len();
        let mut shapes: Vec<Capsule> = Vec::new();
        let mut named = Vec::new();
        for (index, joint) in moving.iter().enumerate() {
            let before = (shapes.len(), self.faults.len());
            for carried in self.carried(joint, moving, index + 1 == hand) {
                named.push(carried.name);
                // Stated shapes of the hand are in place of all that the URDF has for it.
                let is_hand = carried.is_hand && self.arm.hand.is_empty();
                let n_faults = self.faults.len();
                let mut found = self.link_shapes(&carried, index);
                let must_have = is_hand || !carried.is_hand;
                let is_visible = self.robot.links[carried.name].is_visible;
                if must_have && is_visible && found.is_empty() && self.faults.len() == n_faults {
                    self.has_no_shape(carried.name);
                }
                for shape in found.iter_mut().filter(|_| is_hand) {
                    shape.link = hand;
                    *shape = shape.at(&last_from_tool.inverse());
                }
                shapes.extend(found);
            }
            let next = joints.get(index + 1);
            let way_m = next.map_or(0.0, |it| {
                it.parent_from_joint_at_zero.translation.vector.norm()
            });
            if way_m > FRAME_M && before == (shapes.len(), self.faults.len()) {
                self.has_no_shape(&joint.child);
            }
        }
        shapes.extend(self.arm.hand.iter().map(|stated| Capsule {
            link: hand,
            ends: [stated.from_m, stated.to_m].map(Point3::from),
            radius_m: stated.radius_m,
            is_around_mesh: false,
        }));
        if !shapes.iter().any(|shape| shape.link == hand) {
            self.faults.push(format!(
                "the hand has no shape: `{}` has none behind the last joint; expected an `[[arm.hand]]` that contains hand \
                 and fingers in every opening",
                self.file.display()
            ));
        }
        for (index, shape) in self.arm.shape.iter().enumerate() {
            if !named.contains(&shape.link.as_str()) {
                self.faults.push(format!(
                    "`arm.shape[{index}].link` is `{}`; expected a link that a joint of the arm moves{}",
                    shape.link,
                    did_you_mean(&shape.link, named.iter().copied())
                ));
            }
        }
        shapes
    }

    fn has_no_shape(&mut self, name: &str) {
        self.faults.push(format!(
            "the link `{name}` has no shape, so nothing would keep it off the table; expected a `<collision>` in the URDF, \
             or an `[[arm.shape]]` with `link = \"{name}\"`"
        ));
    }

    /// Returns the links that hang from a joint of the chain and from no later one of it.
    fn carried(
        &mut self,
        joint: &'b urdf::Joint,
        moving: &[&urdf::Joint],
        is_last: bool,
    ) -> Vec<Carried<'b>> {
        let turned = Isometry3::from_parts(Translation3::identity(), z_to(joint).inverse());
        let mut carried = vec![Carried {
            name: &joint.child,
            joint_from_link: vec![turned],
            is_hand: false,
        }];
        let mut next = 0;
        while next < carried.len() {
            let name = carried[next].name;
            for below in self.robot.joints.iter().filter(|it| it.parent == name) {
                let is_of_chain = moving.iter().any(|it| it.name == below.name);
                if is_of_chain || carried.iter().any(|it| it.name == below.child) {
                    continue;
                }
                let places = self.places(below, is_last);
                let frames = carried[next].joint_from_link.iter();
                let below_frames = frames.flat_map(|frame| {
                    let joint_from_below = frame * below.parent_from_joint;
                    places.iter().map(move |place| joint_from_below * place)
                });
                let joint_from_link: Vec<_> = below_frames.collect();
                if !joint_from_link.is_empty() {
                    carried.push(Carried {
                        name: &below.child,
                        joint_from_link,
                        is_hand: is_last,
                    });
                }
            }
            next += 1;
        }
        carried
    }

    /// Returns where a joint beside the chain holds what it carries, in the joint's frame: in one place, at both ends if it
    /// slides, and nowhere if that does not count or is not supported.
    fn places(&mut self, joint: &urdf::Joint, is_last: bool) -> Vec<Isometry3<f64>> {
        match (joint.kind.as_str(), joint.limits) {
            ("fixed", _) => vec![Isometry3::identity()],
            _ if is_last && !self.arm.hand.is_empty() => Vec::new(),
            ("prismatic", Some(ends_m)) if is_last && ends_m[1] - ends_m[0] < 1.0 => {
                let place = |at_m| Translation3::from(joint.axis.into_inner() * at_m).into();
                ends_m.map(place).to_vec()
            }
            (kind, _) => {
                self.faults.push(format!(
                    "the joint `{}` is `{kind}` and moves `{}` beside the chain from `arm.base_link` to `arm.tip_link`; \
                     expected `fixed`; or in the hand `prismatic` with limits, or an `[[arm.hand]]` that contains hand and \
                     fingers in every opening",
                    joint.name, joint.child
                ));
                Vec::new()
            }
        }
    }

    /// Returns the capsules of a link, in the frame of the chain's joint.
    ///
    /// - `joint`: its index.
    fn link_shapes(&mut self, link: &Carried<'b>, joint: usize) -> Vec<Capsule> {
        let name = link.name;
        let stated = self.arm.shape.iter().filter(|shape| shape.link == name);
        let mut clouds: Vec<Cloud> = stated
            .map(|shape| Cloud {
                middles: vec![shape.from_m.into(), shape.to_m.into()],
                radius_m: shape.radius_m,
                is_mesh: false,
            })
            .collect();
        if clouds.is_empty() {
            for collision in &self.robot.links[name].collisions {
                let collision = collision.as_ref().map_err(Clone::clone);
                match collision.and_then(|collision| self.cloud(collision)) {
                    Ok(cloud) => clouds.push(cloud),
                    Err(why) => self.faults.push(format!(
                        "the link `{name}` has a shape that cannot be used: {why}; expected another, or an `[[arm.shape]]` \
                         with `link = \"{name}\"`"
                    )),
                }
            }
        }
        let capsule = |cloud: Cloud| {
            let frames = link.joint_from_link.iter();
            let placed = frames.flat_map(|frame| cloud.middles.iter().map(move |it| frame * it));
            let placed: Vec<Point3<f64>> = placed.collect();
            let (from, to, radius_m) = hull::capsule(&placed, cloud.radius_m)?;
            Some(Capsule {
                link: joint,
                ends: [from, to],
                radius_m,
                is_around_mesh: cloud.is_mesh,
            })
        };
        clouds.into_iter().filter_map(capsule).collect()
    }

    /// Returns balls that contain a shape.
    fn cloud(&self, collision: &urdf::Collision) -> Result<Cloud, String> {
        let (middles, radius_m, is_mesh) = match &collision.shape {
            Shape::Balls { middles, radius_m } => (middles.clone(), *radius_m, false),
            Shape::Mesh { file, scale } => {
                let wrong = |why: String| format!("the mesh `{file}`: {why}");
                let path = self.mesh_path(file)?;
                let corners = mesh::read(&path).map_err(wrong)?;
                let scaled = corners.iter().map(|it| it.coords.component_mul(scale));
                let scaled: Vec<_> = scaled.map(Point3::from).collect();
                let far = scaled.iter().map(|it| it.coords.amax()).fold(0.0, f64::max);
                if far > urdf::MAX_M {
                    return Err(wrong(format!(
                        "a corner is `{far:.1}` m from its middle; expected at most {}: is it in millimetres, without \
                         `scale=\"0.001 0.001 0.001\"`?",
                        urdf::MAX_M
                    )));
                }
                (scaled, 0.0, true)
            }
        };
        let placed = middles.iter().map(|it| collision.link_from_shape * it);
        Ok(Cloud {
            middles: placed.collect(),
            radius_m,
            is_mesh,
        })
    }

    /// Finds the file of a mesh. A package is a folder of its name above the URDF file; no program is asked for it.
    fn mesh_path(&self, file: &str) -> Result<PathBuf, String> {
        let beside = self.file.parent().unwrap_or(Path::new(""));
        let Some(rest) = file.strip_prefix("package://") else {
            let path = file.strip_prefix("file://").unwrap_or(file);
            return if path.contains("://") {
                Err(format!("`{file}` is no file"))
            } else {
                Ok(beside.join(path))
            };
        };
        // The folder of a bare name is empty, which has no absolute path.
        let file = std::path::absolute(self.file).map_err(|why| why.to_string())?;
        let mut paths = file.ancestors().skip(1).map(|folder| folder.join(rest));
        paths.find(|path| path.is_file()).ok_or_else(|| {
            format!(
                "there is no `{rest}` in any folder above `{}`",
                self.file.display()
            )
        })
    }
}

/// Returns the rotation that brings z to a joint's axis.
fn z_to(joint: &urdf::Joint) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), &joint.axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI))
}

/// Words the name that was probably meant.
fn did_you_mean<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> String {
    nearest(name, names).map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
}

#[cfg(test)]
mod tests;
