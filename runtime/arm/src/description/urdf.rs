//! Reads what an arm's description in URDF says of links and joints.
//!
//! In: the text of a URDF file, whose xacro is already expanded. Out: joints, and the collision shapes of links; else why
//! it cannot be read. Inertia, colours and visual shapes are left out. Nothing is run, and no other file is opened.

use crate::kinematics;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use roxmltree::{Document, Node};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// The largest coordinate of a frame or a shape, metres.
pub(super) const MAX_M: f64 = 10.0;

/// The least length of a shape, metres.
const MIN_M: f64 = 1e-9;

/// Any finite number.
const ANY: RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;

/// The largest angle of a frame, radians.
const MAX_RAD: f64 = 100.0;

/// A robot's links and joints.
#[derive(Debug)]
pub(super) struct Robot {
    pub name: String,
    pub links: BTreeMap<String, Link>,
    pub joints: Vec<Joint>,
}

/// A link.
#[derive(Debug, Default)]
pub(super) struct Link {
    /// Its collision shapes; of one that cannot be read the reason, because a link that nobody uses may have one.
    pub collisions: Vec<Result<Collision, String>>,
    /// Whether something of it is drawn.
    pub is_visible: bool,
}

/// A shape, and its frame in the link's.
#[derive(Debug)]
pub(super) struct Collision {
    pub link_from_shape: Isometry3<f64>,
    pub shape: Shape,
}

/// A shape in its own frame; lengths in metres.
#[derive(Debug)]
pub(super) enum Shape {
    /// Balls whose hull contains it.
    Balls {
        middles: Vec<Point3<f64>>,
        radius_m: f64,
    },
    Mesh {
        file: String,
        scale: Vector3<f64>,
    },
}

/// A joint between two links.
#[derive(Debug)]
pub(super) struct Joint {
    pub name: String,
    /// `revolute`, `fixed` and so on.
    pub kind: String,
    pub parent: String,
    pub child: String,
    pub parent_from_joint: Isometry3<f64>,
    /// The axis about which it turns or along which it slides. That of another joint means nothing.
    pub axis: Unit<Vector3<f64>>,
    /// The least and the largest position, radians or metres.
    pub limits: Option<[f64; 2]>,
    /// rad/s or m/s; none if it is not stated or 0.
    pub max_speed: Option<f64>,
    /// The joint that it follows.
    pub mimics: Option<String>,
}

/// Reads a description.
pub(super) fn read(text: &str) -> Result<Robot, String> {
    let document = Document::parse(text).map_err(|why| why.to_string())?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        return Err(format!(
            "it begins with `<{}>`; expected `<robot>`",
            root.tag_name().name()
        ));
    }
    let is_xacro = |node: &Node| {
        let space = node.tag_name().namespace();
        space.is_some_and(|space| space.contains("xacro"))
    };
    if let Some(node) = root.descendants().find(is_xacro) {
        return Err(format!(
            "{}: it holds `<xacro:{}>`; expected a description that xacro has expanded: `xacro FILE > arm.urdf`",
            line(&node),
            node.tag_name().name()
        ));
    }
    let mut robot = Robot {
        name: root.attribute("name").unwrap_or("arm").to_owned(),
        links: BTreeMap::new(),
        joints: Vec::new(),
    };
    for node in root.children() {
        match node.tag_name().name() {
            "link" => {
                let name = attribute(&node, "name")?.to_owned();
                let link = read_link(&node);
                if robot.links.insert(name.clone(), link).is_some() {
                    return Err(format!("{}: there are two links `{name}`", line(&node)));
                }
            }
            "joint" => robot.joints.push(read_joint(&node)?),
            _ => {}
        }
    }
    for joint in &robot.joints {
        let mut links = [&joint.parent, &joint.child].into_iter();
        if let Some(link) = links.find(|link| !robot.links.contains_key(*link)) {
            let name = &joint.name;
            return Err(format!(
                "the joint `{name}` names the link `{link}`, which is not there"
            ));
        }
    }
    Ok(robot)
}

fn read_link(node: &Node) -> Link {
    let mut link = Link::default();
    for part in node.children() {
        match part.tag_name().name() {
            "visual" => link.is_visible = true,
            "collision" => link.collisions.push(read_collision(&part)),
            _ => {}
        }
    }
    link
}

fn read_collision(node: &Node) -> Result<Collision, String> {
    Ok(Collision {
        link_from_shape: origin(node)?,
        shape: read_shape(node)?,
    })
}

fn read_shape(collision: &Node) -> Result<Shape, String> {
    let geometry = child(collision, "geometry")
        .and_then(|geometry| geometry.children().find(Node::is_element))
        .ok_or_else(|| format!("{}: a `<collision>` has no shape", line(collision)))?;
    let length = |name: &str| {
        let [length] = required(&geometry, name, MIN_M..=MAX_M)?;
        Ok::<f64, String>(length)
    };
    let balls = |middles, radius_m| Shape::Balls { middles, radius_m };
    match geometry.tag_name().name() {
        "box" => {
            let half_m = Vector3::from(required(&geometry, "size", 0.0..=MAX_M)?) / 2.0;
            let sign = |corner: u8, axis: u8| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let signs = (0..8).map(|it| Vector3::new(sign(it, 0), sign(it, 1), sign(it, 2)));
            let corners = signs.map(|signs| Point3::from(half_m.component_mul(&signs)));
            Ok(balls(corners.collect(), 0.0))
        }
        "cylinder" | "capsule" => {
            let half_m = length("length")? / 2.0;
            let ends = [-half_m, half_m].map(|z| Point3::new(0.0, 0.0, z));
            Ok(balls(ends.to_vec(), length("radius")?))
        }
        "sphere" => Ok(balls(vec![Point3::origin()], length("radius")?)),
        "mesh" => Ok(Shape::Mesh {
            file: attribute(&geometry, "filename")?.to_owned(),
            scale: numbers(&geometry, "scale", ANY)?.unwrap_or([1.0; 3]).into(),
        }),
        other => Err(format!(
            "{}: `<{other}>` is no shape; expected `box`, `cylinder`, `capsule`, `sphere` or `mesh`",
            line(&geometry)
        )),
    }
}

fn read_joint(node: &Node) -> Result<Joint, String> {
    let link = |name: &str| {
        let part = child(node, name)
            .ok_or_else(|| format!("{}: a joint has no `<{name}>`", line(node)))?;
        Ok::<_, String>(attribute(&part, "link")?.to_owned())
    };
    let (name, kind) = (attribute(node, "name")?, attribute(node, "type")?);
    // The format's default.
    let mut axis = Vector3::x_axis();
    if let Some(stated) = child(node, "axis")
        && ["revolute", "continuous", "prismatic"].contains(&kind)
    {
        let xyz = Vector3::from(required(&stated, "xyz", ANY)?);
        axis = Unit::try_new(xyz, 1e-6)
            .ok_or_else(|| format!("{}: the axis of `{name}` has no direction", line(&stated)))?;
    }
    let (mut limits, mut max_speed) = (None, None);
    if let Some(limit) = child(node, "limit") {
        let number = |name: &str| {
            let number = numbers::<1>(&limit, name, ANY)?;
            Ok::<_, String>(number.map(|[number]| number))
        };
        let (lower, upper) = (number("lower")?, number("upper")?);
        if lower.is_some() || upper.is_some() {
            limits = Some([lower.unwrap_or(0.0), upper.unwrap_or(0.0)]);
        }
        max_speed = number("velocity")?.filter(|speed| *speed != 0.0);
    }
    let mimics = child(node, "mimic").map(|mimic| attribute(&mimic, "joint").map(str::to_owned));
    Ok(Joint {
        name: name.to_owned(),
        kind: kind.to_owned(),
        parent: link("parent")?,
        child: link("child")?,
        parent_from_joint: origin(node)?,
        axis,
        limits,
        max_speed,
        mimics: mimics.transpose()?,
    })
}

/// Reads the frame of an element in that of its parent; without one it is the same.
fn origin(node: &Node) -> Result<Isometry3<f64>, String> {
    let Some(origin) = child(node, "origin") else {
        return Ok(Isometry3::identity());
    };
    let xyz_m = numbers(&origin, "xyz", -MAX_M..=MAX_M)?;
    let rpy_rad = numbers(&origin, "rpy", -MAX_RAD..=MAX_RAD)?;
    let (xyz_m, rpy_rad) = (xyz_m.unwrap_or_default(), rpy_rad.unwrap_or_default());
    Ok(kinematics::frame(xyz_m, rpy_rad))
}

fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|part| part.tag_name().name() == name)
}

fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> Result<&'a str, String> {
    node.attribute(name).ok_or_else(|| lacks(node, name))
}

fn lacks(node: &Node, name: &str) -> String {
    let (line, element) = (line(node), node.tag_name().name());
    format!("{line}: `<{element}>` has no `{name}`")
}

/// Reads so many finite numbers of an attribute that must be there.
fn required<const N: usize>(
    node: &Node,
    name: &str,
    range: RangeInclusive<f64>,
) -> Result<[f64; N], String> {
    let found = numbers(node, name, range)?;
    found.ok_or_else(|| lacks(node, name))
}

/// Reads so many finite numbers of an attribute; `None` without it.
fn numbers<const N: usize>(
    node: &Node,
    name: &str,
    range: RangeInclusive<f64>,
) -> Result<Option<[f64; N]>, String> {
    let Some(text) = node.attribute(name) else {
        return Ok(None);
    };
    let found: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let found = found.unwrap_or_default();
    let are_numbers = found.iter().all(|it| it.is_finite() && range.contains(it));
    match <[f64; N]>::try_from(found) {
        Ok(found) if are_numbers => Ok(Some(found)),
        _ => Err(format!(
            "{}: `{name}` is `{}`; expected {N} finite number{} of {} to {}",
            line(node),
            text.chars().take(60).collect::<String>(),
            if N == 1 { "" } else { "s" },
            range.start(),
            range.end()
        )),
    }
}

fn line(node: &Node) -> String {
    let at = node.document().text_pos_at(node.range().start);
    format!("line {}", at.row)
}
