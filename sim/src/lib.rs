//! Position-based cloth on a table, and a top-down RGB-D camera, on the CPU.
//!
//! A [`Simulator`] is one cloth, one table and one picker. Steps last 0.01 s;
//! equal starts and actions give equal bits on any machine, build and thread
//! count. A [`TopDownCamera`] draws any positions, simulated or not.
//!
//! ```
//! use sim::{Grid, Look, Params, Simulator, TopDownCamera};
//!
//! let grid = Grid::new(12, 12, 0.00625)?;
//! let mut cloth = Simulator::flat(grid, &Params::default());
//! let corner = cloth.positions()[0];
//! let done = cloth.pick_and_place([corner[0], corner[1]], [0.0, 0.0], &|| false)?;
//! assert_eq!(done.grasped, Some(0));
//!
//! let camera = TopDownCamera::new(0.65, 45f32.to_radians(), 64)?;
//! let frame = camera.render(grid, &cloth.positions(), &Look::default());
//! assert_eq!(frame.depth_m.len(), 64 * 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! World frame: right-handed, z up, origin at the table's centre, metres,
//! seconds. Particle index: `iy * dimx + ix`, `ix` along +X and `iy` along -Y
//! of the flat cloth. A [`Mask`] leaves particles of the grid out; [`mesh`] cuts
//! the rest into triangles. Nothing here knows of tasks, prompts or models.
//!
//! Read on in this order: [`Simulator`], then `picker` (the route), `crumple`, `solver`
//! (the order of all passes), `layout` and `sides` (where particles are kept), `springs`,
//! `cells`, `neighbours`, `contacts`, and every number in [`Params`]. Loops over particles are
//! compiled for AVX2 too and chosen at run time; without fused arithmetic and
//! with exact roots and quotients, they give the same bits at any width.

mod camera;
mod cells;
mod contacts;
mod crumple;
mod digest;
mod error;
mod grid;
mod layout;
mod mask;
pub mod mesh;
mod motion;
mod neighbours;
mod params;
mod picker;
mod planes;
mod raster;
mod scenario;
mod sides;
mod simulator;
mod snapshot;
mod solver;
mod springs;

pub use camera::{CameraError, Frame, ImageUp, Look, MAX_SIZE_PX, MIN_SIZE_PX, TopDownCamera};
pub use crumple::{Crumpled, Lift};
pub use error::{MAX_START_DEPTH_M, MAX_START_STRETCH, REACH_M, SimError, StartError};
pub use grid::{Grid, GridError, MAX_DIM, MAX_SPACING_M, MIN_DIM, MIN_SPACING_M};
pub use mask::{Mask, MaskError};
pub use params::{ALGORITHM_VERSION, DROP_LEG_STEPS, Params, ParamsError, Route};
pub use scenario::diagonal_fold;
pub use simulator::{Aim, PickAndPlace, RestShortcut, Simulator};
pub use snapshot::Snapshot;

/// Digest of this crate's sources, 16 hex digits: equal results need equal code.
pub const CODE_DIGEST: &str = env!("SIM_CODE_DIGEST");
