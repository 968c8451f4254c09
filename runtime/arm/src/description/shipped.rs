//! The arms that are shipped: each is a URDF file, and what a section `[arm]` says beside it.
//!
//! In: a model's name. Out: its [`Chain`].

use super::ArmDescription;
use crate::kinematics::chain::Chain;
use crate::settings::declare;
use std::path::Path;

/// The models. Two or three fingers change the prefix of the names alone.
const MODELS: [&str; 3] = ["j2n6s200", "j2n6s300", "j2s6s200"];

impl Chain {
    /// Returns the names of the shipped models.
    pub fn models() -> Vec<&'static str> {
        MODELS.to_vec()
    }

    /// Returns the chain of a shipped model, e.g. `j2n6s200`; `None` if there is no such model.
    pub fn of_model(name: &str) -> Option<Chain> {
        let (prefix, urdf, section) = match name {
            "j2n6s200" | "j2n6s300" => (
                "j2n6s200",
                include_str!("jaco/j2n6s200.urdf"),
                include_str!("jaco/j2n6s200.toml"),
            ),
            "j2s6s200" => (
                "j2s6s200",
                include_str!("jaco/j2s6s200.urdf"),
                include_str!("jaco/j2s6s200.toml"),
            ),
            _ => return None,
        };
        let [urdf, section] = [urdf, section].map(|text| text.replace(prefix, name));
        let section: ArmDescription =
            declare::read(&section).expect("a test reads every shipped section");
        let chain = section.chain_of(Path::new(&section.urdf), Ok(urdf));
        Some(chain.expect("a test builds every shipped arm"))
    }
}
