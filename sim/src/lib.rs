//! Simulates a cloth on a table, and cameras that look down on it; all on the CPU.
//!
//! A [`Simulator`] is one cloth, one table and one picker. A [`TopDownCamera`] draws colour and depth of any
//! positions, simulated or not, and a [`SlantedView`] shows them to a person. Nothing here knows of tasks, prompts or models.
//!
//! Lay a cloth, fold one corner onto the opposite one, and take a picture before and after:
//!
//! ```
//! use fab_sim::{Frame, Grid, Look, Params, Simulator, TopDownCamera};
//!
//! // 24 by 24 particles, 6.25 mm apart: a cloth of 14 cm.
//! let grid = Grid::new(24, 24, 0.00625)?;
//! let mut cloth = Simulator::flat(grid, &Params::default());
//! let camera = TopDownCamera::new(0.65, 45f32.to_radians(), 128)?;
//! let flat = camera.render(grid, &cloth.positions(), &Look::default());
//!
//! let (back_left, front_right) = (0, grid.particle_count() - 1);
//! let [from, onto] = [back_left, front_right].map(|corner| {
//!     let [x, y, _] = cloth.positions()[corner];
//!     [x, y]
//! });
//! let never = || false; // asked after each step whether to stop
//! let done = cloth.pick_and_place(from, onto, &never)?;
//! assert_eq!(done.grasped, Some(back_left));
//!
//! let [x, y, _] = cloth.positions()[back_left];
//! assert!((x - onto[0]).hypot(y - onto[1]) < 0.02);
//!
//! // Seen from above, the folded cloth covers about half of what it covered before.
//! let folded = camera.render(grid, &cloth.positions(), &Look::default());
//! let cloth_pixels = |frame: &Frame| frame.depth_m.iter().filter(|depth| **depth < 0.646).count();
//! let share = cloth_pixels(&folded) as f64 / cloth_pixels(&flat) as f64;
//! assert!((0.4..0.7).contains(&share), "{share}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! World frame: right-handed, z up, origin at the table's centre, metres, seconds. A step lasts 0.01 s. Particle
//! index: `iy * dimx + ix`, with `ix` along +X and `iy` along -Y of the flat cloth. A [`Mask`] leaves particles
//! of the grid out, for a T-shirt or a hole; [`mesh`] cuts the rest into triangles.
//!
//! # Architecture invariant
//!
//! Equal starts and actions give equal bits on any machine, in any build and on any number of threads. So the
//! solver calls no platform `sin` or `exp`, fuses no arithmetic, and adds in a fixed order. The loops over
//! particles are also compiled for AVX2 and chosen at run time; they give the same bits at any width.
//!
//! To read the code, start with [`Simulator`], then `picker` (the route), `solver` (the order of all passes),
//! `layout` and `sides` (how particles are stored), `springs`, `cells`, `neighbours`, `contacts`, and `crumple`. A cloth
//! of a material goes through `textile`: `bending`, `shear`, `lines`, `faces`; [`measure`] reads it as a laboratory would.
//! Every number that may be set is in [`Params`].

mod bending;
mod camera;
mod cells;
mod contacts;
mod crossings;
mod crumple;
mod digest;
mod error;
mod faces;
mod grid;
mod layout;
mod lines;
mod mask;
mod material;
pub mod measure;
pub mod mesh;
mod motion;
mod neighbours;
mod params;
mod picker;
mod planes;
mod raster;
mod scenario;
mod scene;
mod shear;
mod sides;
mod simulator;
mod slanted;
mod snapshot;
mod solver;
mod springs;
mod textile;

pub use camera::{CameraError, Frame, ImageUp, Look, MAX_SIZE_PX, MIN_SIZE_PX, TopDownCamera};
pub use crossings::crossings;
pub use crumple::{Crumpled, Lift};
pub use error::{MAX_START_DEPTH_M, MAX_START_STRETCH, SimError, StartError};
pub use grid::{Grid, GridError, MAX_DIM, MAX_SPACING_M, MIN_DIM, MIN_SPACING_M};
pub use mask::{Mask, MaskError};
pub use material::{Directions, MAX_GAP_M, MIN_GAP_M, Material, MaterialError, MaterialWarning};
pub use params::{
    ALGORITHM_VERSION, DROP_LEG_STEPS, Params, ParamsError, ParamsFault, REACH_M, Route,
};
pub use picker::Manner;
pub use scenario::diagonal_fold;
pub use scene::Marker;
pub use simulator::{Aim, PickAndPlace, RestShortcut, Simulator};
pub use slanted::{Picture, SlantedCamera, SlantedView};
pub use snapshot::{Snapshot, Texture};

/// Digest of this crate's sources, 16 hex digits: equal results need equal code.
pub const CODE_DIGEST: &str = env!("SIM_CODE_DIGEST");
