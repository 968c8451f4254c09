//! The arms that are shipped: each is a URDF file, and what a section `[arm]` says beside it.
//!
//! In: a model's name. Out: its [`Chain`].

use super::ArmDescription;
use crate::kinematics::chain::Chain;
use crate::settings::declare;
use std::path::Path;

/// The files of an arm.
struct Files {
    /// The prefix of all names in them.
    prefix: &'static str,
    urdf: &'static str,
    section: &'static str,
}

const BENT_WRIST: Files = Files {
    prefix: "j2n6s200",
    urdf: include_str!("jaco/j2n6s200.urdf"),
    section: include_str!("jaco/j2n6s200.toml"),
};

const SPHERICAL_WRIST: Files = Files {
    prefix: "j2s6s200",
    urdf: include_str!("jaco/j2s6s200.urdf"),
    section: include_str!("jaco/j2s6s200.toml"),
};

/// The models. Two or three fingers change the prefix of the names alone.
const MODELS: [(&str, Files); 3] = [
    ("j2n6s200", BENT_WRIST),
    ("j2n6s300", BENT_WRIST),
    ("j2s6s200", SPHERICAL_WRIST),
];

impl Chain {
    /// Returns the names of the shipped models.
    pub fn models() -> Vec<&'static str> {
        MODELS.iter().map(|(model, _)| *model).collect()
    }

    /// Returns the chain of a shipped model, e.g. `j2n6s200`; `None` if there is no such model.
    pub fn of_model(name: &str) -> Option<Chain> {
        let (_, files) = MODELS.iter().find(|(model, _)| *model == name)?;
        let [urdf, section] =
            [files.urdf, files.section].map(|text| text.replace(files.prefix, name));
        let section: ArmDescription =
            declare::read(&section).expect("a test reads every shipped section");
        let chain = section.chain_of(Path::new(&section.urdf), Ok(urdf));
        Some(chain.expect("a test builds every shipped arm"))
    }
}
