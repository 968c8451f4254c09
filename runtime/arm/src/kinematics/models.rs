//! The supported arms, read from `models.toml`.
//!
//! In: a model's name. Out: its [`Chain`], or the names of the supported models. `models.toml` holds the figures and
//! the source of each; only their units are converted here.

use super::chain::{Chain, Joint};
use super::shape::Capsule;
use fab_base::wording::quoted;
use nalgebra::{Isometry3, Point3};
use serde::Deserialize;

const MODELS: &str = include_str!("models.toml");

/// An unknown model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is not a known model of an arm: {}", quoted(.available))]
pub struct UnknownModel {
    /// The requested name.
    pub name: String,
    /// The supported models.
    pub available: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    chain: Vec<ChainFigures>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChainFigures {
    models: Vec<String>,
    hand_xyz_m: [f64; 3],
    hand_rpy_deg: [f64; 3],
    joint: Vec<JointFigures>,
    shape: Vec<ShapeFigures>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointFigures {
    xyz_m: [f64; 3],
    rpy_deg: [f64; 3],
    limits_deg: Option<[f64; 2]>,
    max_speed_deg_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShapeFigures {
    link: usize,
    from_m: [f64; 3],
    to_m: [f64; 3],
    radius_m: f64,
}

impl Chain {
    /// Returns the names of the supported models.
    pub fn models() -> Vec<String> {
        read()
            .chain
            .into_iter()
            .flat_map(|chain| chain.models)
            .collect()
    }

    /// Returns the chain of a model, e.g. `j2n6s200`.
    pub fn of_model(name: &str) -> Result<Chain, UnknownModel> {
        let figures = read()
            .chain
            .into_iter()
            .find(|chain| chain.models.iter().any(|model| model == name))
            .ok_or_else(|| UnknownModel {
                name: name.to_owned(),
                available: Chain::models(),
            })?;
        let last_from_tool = isometry(figures.hand_xyz_m, figures.hand_rpy_deg);
        let shapes = figures.shape.into_iter().map(shape).collect();
        Ok(Chain::new(
            name,
            figures.joint.into_iter().map(joint).collect(),
            last_from_tool,
            shapes,
        ))
    }
}

fn read() -> File {
    toml::from_str(MODELS).expect("models.toml is part of the program and a test reads it")
}

fn joint(figures: JointFigures) -> Joint {
    Joint {
        parent_from_joint_at_zero: isometry(figures.xyz_m, figures.rpy_deg),
        limits_rad: figures.limits_deg.map(|limits| limits.map(f64::to_radians)),
        max_speed_rad_s: figures.max_speed_deg_s.to_radians(),
    }
}

fn shape(figures: ShapeFigures) -> Capsule {
    Capsule {
        link: figures.link,
        from: Point3::from(figures.from_m),
        to: Point3::from(figures.to_m),
        radius_m: figures.radius_m,
    }
}

fn isometry(xyz_m: [f64; 3], rpy_deg: [f64; 3]) -> Isometry3<f64> {
    super::frame(xyz_m, rpy_deg.map(f64::to_radians))
}
