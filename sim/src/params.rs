//! Every number of the solver, the contacts and the picker, in one struct.
//!
//! The defaults are those of the PyFleX scene that the paper's folding data
//! comes from, where such a number exists; the others were chosen by replaying
//! recorded demonstrations and say so.

use crate::material::{Material, MaterialError};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sha2::{Digest, Sha256};

/// Names the arithmetic that moves the recorded scene's cloth. Raise it whenever a change of code changes its results.
pub const ALGORITHM_VERSION: u32 = 2;

/// Names the arithmetic that moves cloths of a material. Raise it whenever a change of code changes their results.
pub const TEXTILE_VERSION: u32 = 1;

/// Farthest a particle may start, and the picker may be sent, from the table's centre along an axis, metres.
pub const REACH_M: f32 = 2.0;

/// Most substeps, and most sweeps, that bound the time of a step.
const MAX_COUNT: u32 = 100;

/// Numbers that decide how the cloth and the picker move.
///
/// "PyFleX" marks a value of the scene behind the recorded data; "trial" marks
/// one chosen by replaying recorded demonstrations. What is read from a file is within the bounds of
/// [`Params::check`]; a simulator refuses to step with anything else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
// `remote` keeps the derived reader as a function of its own, so that `Deserialize` can check what it read.
#[serde(default, deny_unknown_fields, remote = "Self")]
pub struct Params {
    /// Length of one step, seconds. PyFleX: 0.01.
    pub step_secs: f32,
    /// Substeps per step, 1 to 100; more make contacts and the sleeping rule sharper. A cloth of a material has more where
    /// its stiffness needs them. PyFleX: 4.
    pub substeps: u32,
    /// Gauss-Seidel sweeps over all springs per substep, 1 to 100. Fewer leave the cloth slack, more make it too
    /// stiff to drape; PyFleX runs 30 slower-converging Jacobi passes. Trial: 6, of 5 to 9.
    pub sweeps: u32,
    /// Acceleration of everything, world frame, m/s^2; a tilted one makes the table a slope. PyFleX: 9.8, down.
    pub gravity_m_s2: [f32; 3],
    /// Share of the velocity lost per second; calms the spring-back of a released stack. PyFleX: 1.0. Trial: 2.4, of 0.5
    /// to 3.
    pub damping_per_s: f32,
    /// Largest change of velocity, m/s^2; softens the pop of a compressed stack at release. PyFleX: 100.
    pub max_acceleration_m_s2: f32,
    /// Particles slower than this at the end of a substep go back to where it began, m/s, if the table or another
    /// layer bears them. It stands for static friction, and lets a settled cloth become still. PyFleX: 0.02.
    pub sleep_speed_m_s: f32,
    /// A cloth with the picker away and nothing held, of which no particle moves faster than this over a whole
    /// step, stays exactly where it is, m/s. Just above the hop of a lone particle at the sleep speed (0.02 m/s
    /// for one substep of four), which otherwise never ends. Trial: 0.007 halves the time of a replay and
    /// leaves its errors as they are (18 recordings, means within 0.4 mm).
    pub rest_speed_m_s: f32,
    /// Share of a stretch spring's error removed per sweep (neighbours along a side). PyFleX: 2.0, more than a sweep can
    /// remove. Trial: 0.98, of 0.85 to 1.
    pub stretch: f32,
    /// Share of a shear spring's error removed per sweep (both diagonals of each cell). PyFleX: 1.0.
    pub shear: f32,
    /// Share of a bend spring's error removed per sweep (particles two apart along a side). PyFleX: 0.5.
    /// Trial: 0.4, of 0.33 to 0.5.
    pub bend: f32,
    /// Height of a particle resting on the table, metres. PyFleX: 0.005 (collision distance).
    pub table_contact_m: f32,
    /// Coulomb friction of the table and of the picker's sphere. PyFleX: 0.75.
    pub table_friction: f32,
    /// Distance kept between particles that are not neighbours at rest, metres; makes the layer gap.
    /// Pairs that are closer than this in the flat cloth never collide. PyFleX: 0.01125.
    pub self_contact_m: f32,
    /// Share of a self-contact's penetration removed per sweep. Hard contacts (1.0) throw a folded
    /// stack open when it is released, soft ones let layers slide. Trial: 0.26, of 0.1 to 1.
    pub self_contact_softness: f32,
    /// Coulomb friction between layers. PyFleX: 1.0.
    pub self_friction: f32,
    /// Radius of the picker's sphere, metres. SoftGym's folding environment: 0.05.
    pub picker_radius_m: f32,
    /// Gap between the sphere's surface and a particle in contact with it, metres. PyFleX: 0.005.
    pub picker_skin_m: f32,
    /// How far from the sphere's centre a particle can be grasped, metres.
    /// SoftGym: radius + threshold 0.005 + particle radius 0.00625.
    pub picker_capture_m: f32,
    /// Travel of the picker per step, metres. Foldsformer: 0.005, which is 0.5 m/s.
    pub picker_travel_m: f32,
    /// Height of the sphere's centre when it grasps, and when it releases what it puts down, metres. Not used by a
    /// picker that drops. Foldsformer: 0.05.
    pub picker_grasp_height_m: f32,
    /// Height of the sphere's centre while it carries, metres. The held particle keeps its offset, so it
    /// rises by the difference to the grasp height only. Foldsformer: 0.1.
    pub picker_lift_height_m: f32,
    /// Where the sphere waits between actions, world frame, metres. Foldsformer: (0.5, 0.5, 0.5), y up.
    pub picker_home_m: [f32; 3],
    /// How the picker goes about it.
    #[serde(skip_serializing_if = "Route::is_default")]
    pub picker_route: Route,
    /// A measured textile. It replaces sweeps, springs, contact distances, frictions and sleeping speeds above;
    /// `None` is the recorded scene's cloth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
}

/// How a picker grasps, travels and releases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Route {
    /// Grasps and releases at one height, at one speed: `picker_grasp_height_m`, `picker_travel_m` (Foldsformer).
    #[default]
    PutDown,
    /// Grasps at the height of the cloth and releases at the height that it carries at; each way takes
    /// [`DROP_LEG_STEPS`] steps, however long it is (SoftGym, as the paper's smoothing uses it).
    Drop,
}

/// Steps of each way of a picker that drops (SoftGym: `action_repeat` 100).
pub const DROP_LEG_STEPS: u32 = 100;

impl Route {
    // Left out of the hash, so that it is what it was before there was a choice.
    fn is_default(&self) -> bool {
        *self == Route::default()
    }
}

impl Default for Params {
    fn default() -> Params {
        Params {
            step_secs: 0.01,
            substeps: 4,
            sweeps: 6,
            gravity_m_s2: [0.0, 0.0, -9.8],
            damping_per_s: 2.4,
            max_acceleration_m_s2: 100.0,
            sleep_speed_m_s: 0.02,
            rest_speed_m_s: 0.007,
            stretch: 0.98,
            shear: 1.0,
            bend: 0.4,
            table_contact_m: 0.005,
            table_friction: 0.75,
            self_contact_m: 0.01125,
            self_contact_softness: 0.26,
            self_friction: 1.0,
            picker_radius_m: 0.05,
            picker_skin_m: 0.005,
            picker_capture_m: 0.06125,
            picker_travel_m: 0.005,
            picker_grasp_height_m: 0.05,
            picker_lift_height_m: 0.1,
            picker_home_m: [0.5, -0.5, 0.5],
            picker_route: Route::PutDown,
            material: None,
        }
    }
}

/// A parameter that no simulation can run with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the parameter `{field}` is `{value}`, outside `{low}` to `{high}`{unit}")]
pub struct ParamsError {
    /// Name of the field.
    pub field: &'static str,
    /// Its value.
    pub value: String,
    /// Least value allowed.
    pub low: f32,
    /// Greatest value allowed.
    pub high: f32,
    /// Unit of all three after a blank, or nothing.
    pub unit: &'static str,
}

/// Numbers that no cloth can be stepped with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParamsFault {
    /// A parameter is out of bounds.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// The material is none, or cannot be simulated on this grid.
    #[error(transparent)]
    Material(#[from] MaterialError),
}

impl Params {
    /// Returns the default cloth with the picker of SoftGym's smoothing environment: a small sphere that drops what
    /// it carries (protocol, section 2: radius 0.01, capture 0.02125, home 0.2 above the table's centre).
    pub fn with_dropping_picker() -> Params {
        Params {
            picker_radius_m: 0.01,
            picker_capture_m: 0.02125,
            picker_home_m: [0.0, 0.0, 0.2],
            picker_route: Route::Drop,
            ..Params::default()
        }
    }

    /// Tells whether every number is finite and within bounds that keep a step finite in time and size.
    ///
    /// Fails on the first field that is not. The bounds are far beyond what resembles cloth: they exclude
    /// typing errors and units mixed up, and promise nothing about how well the cloth behaves.
    pub fn check(&self) -> Result<(), ParamsError> {
        let counts = [("substeps", self.substeps), ("sweeps", self.sweeps)];
        for (field, count) in counts {
            if !(1..=MAX_COUNT).contains(&count) {
                return Err(ParamsError {
                    field,
                    value: count.to_string(),
                    low: 1.0,
                    high: MAX_COUNT as f32,
                    unit: "",
                });
            }
        }
        let one = std::slice::from_ref::<f32>;
        // More damping would turn a velocity round within a substep, and make it grow.
        let all_speed = self.substeps as f32 / self.step_secs;
        // The search for contacts sorts by squares of `self_contact_m`, which have to hold few particles each.
        #[rustfmt::skip] // a table, one field a line
        let rows = [
            ("step_secs", one(&self.step_secs), [1e-4, 0.1], " s"),
            ("gravity_m_s2", &self.gravity_m_s2, [-100.0, 100.0], " m/s^2"),
            ("damping_per_s", one(&self.damping_per_s), [0.0, all_speed], " per second"),
            ("max_acceleration_m_s2", one(&self.max_acceleration_m_s2), [0.0, 1e9], " m/s^2"),
            ("sleep_speed_m_s", one(&self.sleep_speed_m_s), [0.0, 10.0], " m/s"),
            ("rest_speed_m_s", one(&self.rest_speed_m_s), [0.0, 10.0], " m/s"),
            ("stretch", one(&self.stretch), [0.0, 10.0], ""),
            ("shear", one(&self.shear), [0.0, 10.0], ""),
            ("bend", one(&self.bend), [0.0, 10.0], ""),
            ("table_contact_m", one(&self.table_contact_m), [0.0, 1.0], " m"),
            ("table_friction", one(&self.table_friction), [0.0, 100.0], ""),
            ("self_contact_m", one(&self.self_contact_m), [1e-3, 0.1], " m"),
            ("self_contact_softness", one(&self.self_contact_softness), [0.0, 1.0], ""),
            ("self_friction", one(&self.self_friction), [0.0, 100.0], ""),
            ("picker_radius_m", one(&self.picker_radius_m), [0.0, 1.0], " m"),
            ("picker_skin_m", one(&self.picker_skin_m), [0.0, 1.0], " m"),
            ("picker_capture_m", one(&self.picker_capture_m), [0.0, 1.0], " m"),
            ("picker_travel_m", one(&self.picker_travel_m), [1e-5, 1.0], " m"),
            ("picker_grasp_height_m", one(&self.picker_grasp_height_m), [0.0, 1.0], " m"),
            ("picker_lift_height_m", one(&self.picker_lift_height_m), [0.0, 1.0], " m"),
            ("picker_home_m", &self.picker_home_m, [-REACH_M, REACH_M], " m"),
        ];
        for (field, values, [low, high], unit) in rows {
            if let Some(value) = values.iter().find(|value| !(low..=high).contains(value)) {
                return Err(ParamsError {
                    field,
                    value: value.to_string(),
                    low,
                    high,
                    unit,
                });
            }
        }
        Ok(())
    }

    /// Returns the height of a particle that rests on the table, metres.
    ///
    /// Half the gap between layers of the material; without one, `table_contact_m`.
    pub fn rest_height_m(&self) -> f32 {
        match &self.material {
            Some(material) => 0.5 * material.gap_m(),
            None => self.table_contact_m,
        }
    }

    /// Tells whether a cloth with this distance between particles can be stepped: its numbers, and its material on
    /// such a grid.
    pub fn check_on(&self, spacing_m: f32) -> Result<(), ParamsFault> {
        self.check()?;
        if let Some(material) = &self.material {
            material.check_step(spacing_m, self.step_secs)?;
        }
        Ok(())
    }

    /// Returns 16 hex digits that change with any parameter and with the arithmetic that moves such a cloth.
    pub fn hash(&self) -> String {
        let json = serde_json::to_string(self).expect("a struct of numbers always has a JSON text");
        let version = match self.material {
            None => ALGORITHM_VERSION.to_string(),
            Some(_) => format!("{ALGORITHM_VERSION}.{TEXTILE_VERSION}"),
        };
        let digest = Sha256::digest(format!("{version} {json}"));
        crate::digest::hex(&digest[..8])
    }
}

impl Serialize for Params {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Params::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for Params {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Params, D::Error> {
        let params = Params::deserialize(deserializer)?;
        params.check().map_err(serde::de::Error::custom)?;
        if let Some(material) = &params.material {
            material.check_values().map_err(serde::de::Error::custom)?;
        }
        Ok(params)
    }
}
