//! An arm as data: a URDF file, and what a settings file says beside it.
//!
//! In: the section `[arm]` of the settings, and the URDF and mesh files that it names; or the name of a model that is shipped
//! (`shipped`). Out: a [`Chain`] with shapes; else
//! all faults. A URDF's numbers are doubted: a joint without limits, a link without a shape or a mesh that cannot be read
//! would let an arm go where it must not, so each is refused. No program is run to find or expand a file.

mod hull;
mod mesh;
mod shipped;
mod urdf;

pub use shipped::UnknownModel;

use super::kinematics;
use super::kinematics::chain::{Chain, Joint, MAX_JOINTS, MIN_JOINTS};
use super::kinematics::shape::Capsule;
use super::settings::declare::{ANGLE, above, from, section};
use fab_base::files;
use fab_program::nearest::nearest;
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use urdf::{Robot, Shape};

/// The longest URDF file and the longest mesh accepted, bytes.
const MAX_URDF_BYTES: u64 = 4 << 20;
const MAX_MESH_BYTES: u64 = 32 << 20;

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
        max_speed_deg_s: Option<f64>, above(0.0, 720.0);
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
    /// Its frame, in the frame of the chain's joint.
    joint_from_link: Isometry3<f64>,
    /// Whether it is behind the last joint's own link: a part of the hand.
    is_hand: bool,
    /// How far it slides, in the frame of the chain's joint, metres; each is one end.
    slides_m: Vec<Vector3<f64>>,
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
        let is_fixed = |joint: &&&urdf::Joint| joint.kind == "fixed";
        let moving: Vec<&urdf::Joint> = path
            .iter()
            .filter(|joint| !is_fixed(joint))
            .copied()
            .collect();
        let names: Vec<String> = moving.iter().map(|joint| joint.name.clone()).collect();
        if !(MIN_JOINTS..=MAX_JOINTS).contains(&moving.len()) {
            self.faults.push(format!(
                "the chain from `arm.base_link` to `arm.tip_link` has {} joints that move: {}; expected {MIN_JOINTS} or \
                 {MAX_JOINTS}, because fewer do not bring the hand to every pose, and more are not supported",
                moving.len(),
                listed(&names)
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
                self.check_axis(joint);
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
        let home_rad = self.home(&joints, &names);
        let shapes = self.shapes(&moving, &joints, &last_from_tool);
        Some(Chain::new(
            &self.robot.name,
            names,
            joints,
            last_from_tool,
            shapes,
            &home_rad,
        ))
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
            let above: Vec<&urdf::Joint> = self
                .robot
                .joints
                .iter()
                .filter(|joint| joint.child == *at)
                .collect();
            let wrong = match above[..] {
                [joint] if path.len() > self.robot.joints.len() => {
                    format!(
                        "the joint `{}` is in a circle of joints; expected a tree",
                        joint.name
                    )
                }
                [joint] => {
                    path.push(joint);
                    at = &joint.parent;
                    continue;
                }
                [] => format!(
                    "`arm.tip_link`, `{tip}`, does not hang from `arm.base_link`, `{base}`: the chain upwards ends at `{at}`"
                ),
                [one, other, ..] => format!(
                    "the link `{at}` hangs from two joints, `{}` and `{}`; expected a tree",
                    one.name, other.name
                ),
            };
            self.faults.push(wrong);
            return None;
        }
        path.reverse();
        for joint in &path {
            for link in [&joint.parent, &joint.child] {
                if !self.robot.links.contains_key(link) {
                    self.faults.push(format!(
                        "the joint `{}` names the link `{link}`, which `{}` does not hold",
                        joint.name,
                        self.file.display()
                    ));
                }
            }
        }
        self.faults.is_empty().then_some(path)
    }

    fn check_kind(&mut self, joint: &urdf::Joint) {
        if !["revolute", "continuous"].contains(&joint.kind.as_str()) {
            self.faults.push(format!(
                "the joint `{}` is `{}`; expected `revolute`, `continuous` or `fixed` between `arm.base_link` and \
                 `arm.tip_link`: no other joint is supported there",
                joint.name, joint.kind
            ));
        }
        if let Some(other) = &joint.mimics {
            self.faults.push(format!(
                "the joint `{}` follows `{other}`; expected one that moves by itself",
                joint.name
            ));
        }
    }

    /// Checks that a joint that moves has an axis.
    fn check_axis(&mut self, joint: &urdf::Joint) {
        if let Err(why) = &joint.axis {
            self.faults.push(format!(
                "the joint `{}` cannot be used: {why}; expected the direction about which it turns, or along which it slides",
                joint.name
            ));
        }
    }

    fn stated(&self, joint: &urdf::Joint) -> Option<&'b JointLimits> {
        self.arm
            .joint
            .iter()
            .find(|limits| limits.name == joint.name)
    }

    /// Returns the least and the largest angle of a joint, radians.
    fn limits(&mut self, joint: &urdf::Joint) -> Option<[f64; 2]> {
        let given = joint.limits.filter(|_| joint.kind != "continuous");
        let given = given.map(|limits| limits.map(f64::to_degrees));
        let stated = self.stated(joint);
        let ends = [
            stated.and_then(|it| it.min_deg).or(given.map(|it| it[0])),
            stated.and_then(|it| it.max_deg).or(given.map(|it| it[1])),
        ];
        let name = &joint.name;
        let [least, most] = match ends {
            [None, None] if joint.kind == "continuous" => return None,
            [Some(least), Some(most)] => [least, most],
            _ => {
                self.faults.push(format!(
                    "the joint `{name}` has no limits; expected `min_deg` and `max_deg` of an `[[arm.joint]]` with `name = \
                     \"{name}\"`"
                ));
                return None;
            }
        };
        // NaN must fail these checks.
        let are_limits = least < most && least >= -MAX_LIMIT_DEG && most <= MAX_LIMIT_DEG;
        if !are_limits {
            self.faults.push(format!(
                "the limits of the joint `{name}` are `{least:.3}` to `{most:.3}` deg; expected the first below the second, \
                 and both within {MAX_LIMIT_DEG} deg: state others in an `[[arm.joint]]`"
            ));
        }
        if let Some([low, high]) = given
            && (least < low - EXACT_DEG || most > high + EXACT_DEG)
        {
            self.faults.push(format!(
                "the `[[arm.joint]]` of `{name}` allows `{least}` to `{most}` deg; expected no more than the URDF does, \
                 {low:.3} to {high:.3} deg"
            ));
        }
        Some([least, most].map(f64::to_radians))
    }

    /// Returns the highest speed of a joint, rad/s.
    fn max_speed(&mut self, joint: &urdf::Joint) -> f64 {
        let name = &joint.name;
        let given = joint.max_speed.map(f64::to_degrees);
        let stated = self.stated(joint).and_then(|it| it.max_speed_deg_s);
        let Some(speed) = stated.or(given) else {
            self.faults.push(format!(
                "the joint `{name}` has no highest speed; expected `max_speed_deg_s` of an `[[arm.joint]]` with `name = \
                 \"{name}\"`"
            ));
            return 1.0;
        };
        let is_speed = speed > 0.0 && speed <= MAX_SPEED_DEG_S;
        if !is_speed {
            self.faults.push(format!(
                "the highest speed of the joint `{name}` is `{speed:.3}` deg/s; expected above 0 and at most \
                 {MAX_SPEED_DEG_S}: state another in an `[[arm.joint]]`"
            ));
        }
        if let Some(given) = given
            && speed > given + EXACT_DEG
        {
            self.faults.push(format!(
                "the `[[arm.joint]]` of `{name}` allows `{speed}` deg/s; expected no more than the URDF does, {given:.1}"
            ));
        }
        speed.to_radians()
    }

    /// Checks that every `[[arm.joint]]` is of a joint of the chain, and of another one.
    fn check_names(&mut self, names: &[String]) {
        for (index, limits) in self.arm.joint.iter().enumerate() {
            let name = &limits.name;
            if !names.contains(name) {
                self.faults.push(format!(
                    "`arm.joint[{index}].name` is `{name}`; expected a joint between `arm.base_link` and `arm.tip_link`: {}",
                    listed(names)
                ));
            }
            if self.arm.joint[..index]
                .iter()
                .any(|other| other.name == *name)
            {
                self.faults
                    .push(format!("there are two `[[arm.joint]]` of `{name}`"));
            }
        }
    }

    /// Returns the home posture, radians.
    fn home(&mut self, joints: &[Joint], names: &[String]) -> Vec<f64> {
        let home_deg = &self.arm.home_deg;
        if home_deg.len() != joints.len() {
            self.faults.push(format!(
                "`arm.home_deg` holds {} angles; expected {}, one for each joint: {}",
                home_deg.len(),
                joints.len(),
                listed(names)
            ));
        }
        for ((at_deg, joint), name) in home_deg.iter().zip(joints).zip(names) {
            let limits = joint.limits_rad.map(|limits| limits.map(f64::to_degrees));
            if let Some([least, most]) = limits
                && !(least - EXACT_DEG..=most + EXACT_DEG).contains(at_deg)
            {
                self.faults.push(format!(
                    "`arm.home_deg` holds `{at_deg}` for the joint `{name}`; expected {least:.1} to {most:.1}, its limits"
                ));
            }
        }
        home_deg.iter().map(|it| it.to_radians()).collect()
    }

    /// Returns the shapes of the links that the joints move, and of the hand. A link that is drawn must have one, and so
    /// must whatever leads from one joint to another place; a frame, or a joint at the place of the next, needs none.
    fn shapes(
        &mut self,
        moving: &[&'b urdf::Joint],
        joints: &[Joint],
        last_from_tool: &Isometry3<f64>,
    ) -> Vec<Capsule> {
        let mut shapes: Vec<Capsule> = Vec::new();
        let mut named = Vec::new();
        for (index, joint) in moving.iter().enumerate() {
            let is_last = index + 1 == moving.len();
            let (n_shapes, n_faults) = (shapes.len(), self.faults.len());
            for link in self.carried(joint, moving, is_last) {
                named.push(link.name);
                // Stated shapes of the hand are in place of all that the URDF has for it.
                let is_hand = link.is_hand && self.arm.hand.is_empty();
                let n_faults = self.faults.len();
                let found = self.link_shapes(&link);
                let must_have =
                    self.robot.links[link.name].is_visible && (is_hand || !link.is_hand);
                if must_have && found.is_empty() && self.faults.len() == n_faults {
                    self.has_no_shape(link.name);
                }
                let is_around_mesh = self.is_mesh(link.name);
                for (from, to, radius_m) in found {
                    let to_frame = if is_hand {
                        last_from_tool.inverse()
                    } else {
                        Isometry3::identity()
                    };
                    shapes.push(Capsule {
                        link: if is_hand { moving.len() } else { index },
                        from: to_frame * from,
                        to: to_frame * to,
                        radius_m,
                        is_around_mesh,
                    });
                }
            }
            let way_m = joints.get(index + 1).map_or(0.0, |next| {
                next.parent_from_joint_at_zero.translation.vector.norm()
            });
            let is_bare = shapes.len() == n_shapes && self.faults.len() == n_faults;
            if is_bare && way_m > FRAME_M {
                self.has_no_shape(&joint.child);
            }
        }
        shapes.extend(self.arm.hand.iter().map(|hand| Capsule {
            link: moving.len(),
            from: Point3::from(hand.from_m),
            to: Point3::from(hand.to_m),
            radius_m: hand.radius_m,
            is_around_mesh: false,
        }));
        if !shapes.iter().any(|shape| shape.link == moving.len()) {
            self.faults.push(format!(
                "the hand has no shape: `{}` has none behind `{}`; expected an `[[arm.hand]]` that contains hand and fingers \
                 in every opening",
                self.file.display(),
                moving.last().map_or("", |joint| &joint.child)
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
        let mut carried = vec![Carried {
            name: &joint.child,
            joint_from_link: Isometry3::from_parts(Translation3::identity(), z_to(joint).inverse()),
            is_hand: false,
            slides_m: vec![Vector3::zeros()],
        }];
        let mut next = 0;
        while next < carried.len() {
            let from = &carried[next];
            next += 1;
            let (name, joint_from_link, slides_m) =
                (from.name, from.joint_from_link, from.slides_m.clone());
            for below in self
                .robot
                .joints
                .iter()
                .filter(|below| below.parent == name)
            {
                let is_of_chain = moving.iter().any(|it| it.name == below.name);
                let is_known = carried.iter().any(|it| it.name == below.child);
                if is_of_chain || is_known || !self.robot.links.contains_key(&below.child) {
                    continue;
                }
                let joint_from_below = joint_from_link * below.parent_from_joint;
                let mut ends_m = vec![Vector3::zeros()];
                match (below.kind.as_str(), below.limits) {
                    ("fixed", _) => {}
                    _ if is_last && !self.arm.hand.is_empty() => continue,
                    ("prismatic", Some([lower, upper])) if is_last && upper - lower < 1.0 => {
                        let along = joint_from_below * axis(below).into_inner();
                        self.check_axis(below);
                        ends_m = vec![along * lower, along * upper];
                    }
                    (kind, _) if is_last => {
                        self.faults.push(format!(
                            "the joint `{}` of the hand is `{kind}`; expected `fixed`, `prismatic` with limits, or an \
                             `[[arm.hand]]` that contains hand and fingers in every opening",
                            below.name
                        ));
                        continue;
                    }
                    (kind, _) => {
                        self.faults.push(format!(
                            "the joint `{}` is `{kind}` and moves `{}` beside the chain from `arm.base_link` to \
                             `arm.tip_link`; expected none that moves there",
                            below.name, below.child
                        ));
                        continue;
                    }
                }
                carried.push(Carried {
                    name: &below.child,
                    joint_from_link: joint_from_below,
                    is_hand: is_last,
                    slides_m: slides_m
                        .iter()
                        .flat_map(|before| ends_m.iter().map(move |end| before + end))
                        .collect(),
                });
            }
        }
        carried
    }

    /// Returns the capsules of a link, in the frame of the chain's joint.
    fn link_shapes(&mut self, link: &Carried<'b>) -> Vec<hull::Ends> {
        let stated = self
            .arm
            .shape
            .iter()
            .filter(|shape| shape.link == link.name);
        let mut clouds: Vec<(Vec<Point3<f64>>, f64)> = stated
            .map(|shape| (vec![shape.from_m.into(), shape.to_m.into()], shape.radius_m))
            .collect();
        if clouds.is_empty() {
            for collision in &self.robot.links[link.name].collisions {
                let cloud = collision.as_ref().map_err(Clone::clone).and_then(|it| {
                    let (points, radius_m) = self.cloud(&it.shape)?;
                    let placed = points.into_iter().map(|point| it.link_from_shape * point);
                    Ok((placed.collect(), radius_m))
                });
                match cloud {
                    Ok(cloud) => clouds.push(cloud),
                    Err(why) => self.faults.push(format!(
                        "the link `{name}` has a shape that cannot be used: {why}; expected another, or an `[[arm.shape]]` \
                         with `link = \"{name}\"`",
                        name = link.name
                    )),
                }
            }
        }
        let capsule = |(points, radius_m): (Vec<Point3<f64>>, f64)| {
            let at_ends = link.slides_m.iter().flat_map(|slide| {
                let placed = move |point| link.joint_from_link * point + slide;
                points.iter().map(placed)
            });
            hull::capsule(&at_ends.collect::<Vec<_>>(), radius_m)
        };
        clouds.into_iter().filter_map(capsule).collect()
    }

    /// Returns whether the shape of a link is a mesh, and not stated otherwise.
    fn is_mesh(&self, link: &str) -> bool {
        let is_stated = self.arm.shape.iter().any(|shape| shape.link == link);
        let mut shapes = self.robot.links[link].collisions.iter().flatten();
        !is_stated && shapes.any(|it| matches!(it.shape, Shape::Mesh { .. }))
    }

    /// Returns the points, and the radius of balls around them, that contain a shape.
    fn cloud(&self, shape: &Shape) -> Result<(Vec<Point3<f64>>, f64), String> {
        Ok(match shape {
            Shape::Balls { middles, radius_m } => (middles.clone(), *radius_m),
            Shape::Mesh { file, scale } => {
                let wrong = |why: String| format!("the mesh `{file}`: {why}");
                let format = mesh::Format::of(file).map_err(wrong)?;
                let path = self.mesh_path(file)?;
                let bytes = files::read(&path, MAX_MESH_BYTES).map_err(wrong)?;
                let corners = mesh::corners(format, &bytes).map_err(wrong)?;
                let scaled = |it: Point3<f64>| Point3::from(it.coords.component_mul(scale));
                let corners: Vec<_> = corners.into_iter().map(scaled).collect();
                let far = corners
                    .iter()
                    .map(|it| it.coords.amax())
                    .fold(0.0, f64::max);
                if far > urdf::MAX_M {
                    return Err(wrong(format!(
                        "a corner is `{far:.1}` m from its middle; expected at most {}: is it in millimetres, without \
                         `scale=\"0.001 0.001 0.001\"`?",
                        urdf::MAX_M
                    )));
                }
                (corners, 0.0)
            }
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

/// Returns a joint's axis; z if it has none, which is a fault.
fn axis(joint: &urdf::Joint) -> Unit<Vector3<f64>> {
    joint.axis.as_ref().copied().unwrap_or(Vector3::z_axis())
}

/// Returns the rotation that brings z to a joint's axis.
fn z_to(joint: &urdf::Joint) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between_axis(&Vector3::z_axis(), &axis(joint))
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI))
}

/// Words the name that was probably meant.
fn did_you_mean<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> String {
    nearest(name, names).map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
}

fn listed(names: &[String]) -> String {
    if names.is_empty() {
        "none".to_owned()
    } else {
        format!("`{}`", names.join("`, `"))
    }
}

#[cfg(test)]
mod tests;
