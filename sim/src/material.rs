//! A cloth as textile laboratories measure it.
//!
//! Plain data with bounds, and what follows from it for a grid: stiffnesses, the gap between layers, the number of
//! substeps. `textile` moves a cloth with these numbers; without a material a cloth is the recorded scene's (the
//! other numbers of [`Params`](crate::Params)).

use crate::bending::{Friction, GENTLE_PER_M};
use serde::{Deserialize, Serialize};

/// Acceleration by which a bending length is converted to a rigidity, m/s^2.
pub const BENDING_GRAVITY_M_S2: f64 = 9.81;
/// Thinnest gap between layers that contacts of particles hold, metres; a thinner cloth has this one.
pub const MIN_GAP_M: f32 = 0.001;
/// Thickest gap between layers, metres; a thicker cloth has this one.
pub const MAX_GAP_M: f32 = 0.003;
/// Fewest substeps of a step of 0.01 s. Fewer let a fast fold slide over what it should rest on.
const MIN_SUBSTEPS_PER_S: f64 = 2000.0;
/// Most substeps of one step, which bounds its time.
pub(crate) const MAX_SUBSTEPS: u32 = 100;
// Product of substep and highest angular frequency of bending. An explicit step of a linear spring is stable below
// 2; the rest is for folds, which are stiffer than a gentle bend.
const STABLE: f64 = 1.2;
// Most of the stiffness of shear, as acceleration per length error times the square of a substep. What is stiffer gives more at
// the sides of a sheet than the whole sheet does.
pub(crate) const MOST_SHEAR: f32 = 8.0;
// Warn when the cloth gives this many times more on the bias than declared.
const MORE_BIAS: f32 = 1.05;
// Warn when the threads alone make the bending length on the bias this many times longer than declared.
const SOFT_BIAS: f32 = 1.05;
// The bounds below were found by trial: `tests/suite/textile/declarable.rs` measures materials from all ranges, and 342 cantilevers
// on the bias, whose table is not kept, had warps of 15 to 65 mm, wefts from a quarter of that on, and biases of 0.7 to 1.6 of what
// the threads allow.
//
// Largest spacing, as a share of the shortest bending length, at which cantilevers stay within 10 %: 10 mm at 6.25 mm.
const COARSE_SHARE: f32 = 0.625;
// Largest spacing, as a share of the shorter bending length, at which loops and folds stay within 10 %.
const SHARP_SHARE: f32 = 0.5;
// Most substeps per second with which momentum stays within 0.005 in 0.4 s, whatever else is declared. Bends are taken ahead of
// where particles are, so the forces of stiff ones have a moment.
const STEADY_SUBSTEPS_PER_S: f64 = 4000.0;
// Weight below which, and bending length above which, layers may not lie down on each other.
const LIGHT_KG_M2: f32 = 0.06;
const STIFF_M: f32 = 0.05;
// Warn when a strip on the bias shows less than this share of its bending length by plate theory.
const MOST_CURLED_SHARE: f64 = 0.93;
// Least that strips show of what plate theory has them show.
const LEAST_OF_CURLED: f64 = 0.86;
// Warn when shear is stiffer than this share of the threads, which it shortens.
const SHARED_BY_THREADS: f32 = 0.04;
// How much more a sheared cloth gives for each such share, at most.
const GIVEN_BY_THREADS: f32 = 1.3;
// Warn when a crease opens this much wider than declared, degrees.
const WIDE_CREASE_DEG: f32 = 5.0;
/// Width of a strip on the bias, metres. Wider than others, since the cells at its zigzag rims are missing, and twist with
/// them.
pub(crate) const BIAS_STRIP_M: f32 = 0.04;
// Loads of the extensions E100 and EB5 of FAST, newtons per metre of width.
pub(crate) const THREAD_LOAD_N_M: f64 = 98.1;
pub(crate) const BIAS_LOAD_N_M: f64 = 4.905;

/// What was measured of a woven or knitted cloth. Each value is what a laboratory reports, in SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Mass per area, kg/m^2 (ISO 3801).
    pub weight_kg_m2: f32,
    /// Distance between the middles of two layers that lie on each other, metres (ISO 5084).
    pub thickness_m: f32,
    /// Bending length, metres (Peirce 1930; ASTM D1388, option A). A strip's bending rigidity per width is
    /// `weight * 9.81 m/s^2 * length^3`.
    pub bending_length_m: Directions,
    /// Angle to which a fold that was pressed flat opens again, degrees: 180 is flat, 0 stays folded (ISO 2313). Internal
    /// friction of bending follows from it.
    pub crease_recovery_deg: f32,
    /// How much the cloth gives under the loads of FAST, as a share of its length: along its threads under 98.1 N/m
    /// (E100), along their diagonal under 4.9 N/m (EB5). The cloth's resistance to shear follows from the second.
    pub stretch: Directions,
    /// Coulomb friction on the table.
    pub table_friction: f32,
    /// Coulomb friction between layers.
    pub self_friction: f32,
}

/// A value along each direction of a woven cloth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Directions {
    /// Along the warp: the cloth's first side, from left to right in the grid.
    pub warp: f32,
    /// Along the weft: from back to front in the grid.
    pub weft: f32,
    /// At 45 degrees to both.
    pub bias: f32,
}

/// Says why a cloth of a material cannot be simulated, with the bound.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// A value is no number, or none of a cloth.
    #[error("the material's `{field}` is `{value}`, outside `{low}` to `{high}`{unit}")]
    OutOfBounds {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f32,
        /// Least value allowed.
        low: f32,
        /// Greatest value allowed.
        high: f32,
        /// Unit of all three after a blank, or nothing.
        unit: &'static str,
    },
    /// Bending is so stiff that a step would need too many substeps.
    #[error(
        "a cloth with a bending length of up to `{}` mm needs `{substeps}` substeps at a spacing of `{}` mm, more than `{MAX_SUBSTEPS}`; a spacing from `{}` mm on would do",
        mm(*length_m), mm(*spacing_m), least_mm(*least_spacing_m)
    )]
    TooStiff {
        /// Longest bending length, metres.
        length_m: f32,
        /// Substeps that a step would need.
        substeps: u32,
        /// Distance between particles, metres.
        spacing_m: f32,
        /// Least spacing at which `MAX_SUBSTEPS` are enough, metres.
        least_spacing_m: f32,
    },
}

/// A way in which a simulated cloth differs from its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialWarning {
    /// Layers keep another distance than the thickness.
    Gap {
        /// The declared thickness, metres.
        thickness_m: f32,
        /// The distance that they keep, metres.
        gap_m: f32,
    },
    /// Bends are sharper than the particles can follow.
    Coarse {
        /// The bending length that is met worst, metres.
        length_m: f32,
        /// Spacing up to which a bending length is met within 10 %, metres.
        spacing_m: f32,
    },
    /// Loops and folds are sharper than the particles can follow, and creases open too little.
    Sharp {
        /// The shorter bending length of warp and weft, metres.
        length_m: f32,
        /// Spacing up to which they are met, metres.
        spacing_m: f32,
    },
    /// A cloth that nothing touches changes its momentum, and a light one's layers do not lie flat: bending is too stiff for the step.
    Unsteady {
        /// The longest bending length, metres.
        length_m: f32,
        /// Spacing from which on momentum is kept, metres.
        spacing_m: f32,
        /// Whether layers may not lie down on each other either.
        is_light: bool,
    },
    /// A strip on the bias curls across or twists, and bends more than a wide cloth.
    Curls {
        /// The bending length of a wide cloth, metres.
        bias_m: f32,
        /// The least that a strip shows, metres.
        least_m: f32,
    },
    /// A cloth with slack threads gives more on the bias, since a longer diagonal pulls threads together.
    SlackThreads {
        /// By how much more at most, as a share of what is declared.
        more: f32,
    },
    /// A crease opens wider than its material's.
    Crease {
        /// The declared angle, degrees.
        declared_deg: f32,
        /// That of the simulated cloth, degrees.
        least_deg: f32,
    },
    /// The cloth gives more on the bias than its material: substeps hold no stiffer a resistance to shear.
    Shear {
        /// The declared extension on the bias, a share of the length.
        declared: f32,
        /// That of the simulated cloth.
        shown: f32,
    },
    /// The bias is softer than the threads that bend in it allow.
    SoftBias {
        /// The declared bending length, metres.
        bias_m: f32,
        /// That of the threads alone, metres.
        least_m: f32,
    },
}

impl std::fmt::Display for MaterialWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            MaterialWarning::Gap { thickness_m, gap_m } => write!(
                f,
                "layers keep `{}` mm apart and not the thickness of `{}` mm; contacts hold `{}` to `{}` mm",
                mm(*gap_m),
                mm(*thickness_m),
                mm(MIN_GAP_M),
                mm(MAX_GAP_M)
            ),
            MaterialWarning::Coarse {
                length_m,
                spacing_m,
            } => write!(
                f,
                "a bending length of `{}` mm is met within 10 % only at a spacing of up to `{}` mm",
                mm(*length_m),
                most_mm(*spacing_m)
            ),
            MaterialWarning::Sharp {
                length_m,
                spacing_m,
            } => write!(
                f,
                "loops and folds of a bending length of `{}` mm are met within 10 % only at a spacing of up to `{}` mm; creases open too little",
                mm(*length_m),
                most_mm(*spacing_m)
            ),
            MaterialWarning::Unsteady {
                length_m,
                spacing_m,
                is_light,
            } => {
                write!(
                    f,
                    "with a bending length of `{}` mm a cloth in the air may change its momentum by more than `0.005` in 0.4 s",
                    mm(*length_m)
                )?;
                if *is_light {
                    f.write_str(", and layers of one so light may not lie down on each other")?;
                }
                write!(f, "; a spacing of `{}` mm would do", least_mm(*spacing_m))
            }
            MaterialWarning::Curls { bias_m, least_m } => write!(
                f,
                "a strip on the bias curls or twists: with a width of `{}` mm it shows a bending length of as little as `{}` mm and not `{}` mm; long loops and folds of the cloth tip over",
                mm(BIAS_STRIP_M),
                mm(*least_m),
                mm(*bias_m)
            ),
            MaterialWarning::SlackThreads { more } => write!(
                f,
                "on the bias the cloth gives up to `{:.0}` % more than declared: threads as slack as these give in where it shears",
                (100.0 * more).ceil()
            ),
            MaterialWarning::Crease {
                declared_deg,
                least_deg,
            } => write!(
                f,
                "a crease opens to `{least_deg:.0}` degrees and not to `{declared_deg}`: bends below `{GENTLE_PER_M}`/m leave none"
            ),
            MaterialWarning::Shear { declared, shown } => write!(
                f,
                "on the bias the cloth gives by `{shown:.3}` and not by `{declared}` of its length, since one of this weight is not held stiffer at this spacing: in a fold it shears more easily than the real one"
            ),
            MaterialWarning::SoftBias { bias_m, least_m } => write!(
                f,
                "on the bias the cloth has a bending length of `{}` mm and not `{}` mm: with these of warp and weft it cannot be less",
                mm(*least_m),
                mm(*bias_m)
            ),
        }
    }
}

/// Writes a length in millimetres, with at most one decimal from 10 mm on and two below.
fn mm(metres: f32) -> f64 {
    let per_mm = if metres < 0.01 { 100.0 } else { 10.0 };
    (1000.0 * per_mm * f64::from(metres)).round() / per_mm
}

/// Writes the largest spacing that would do, rounded down so that it does.
fn most_mm(spacing_m: f32) -> f64 {
    (1e4 * f64::from(spacing_m) + 0.001).floor() / 10.0
}

/// Writes the least spacing that would do, rounded up so that it does.
fn least_mm(spacing_m: f32) -> f64 {
    (1e4 * f64::from(spacing_m) - 0.001).ceil() / 10.0
}

/// Stiffnesses of a cloth on a grid, for particles of mass 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stiffness {
    /// Acceleration per second difference of positions along warp and weft, and per mixed difference of a cell, 1/s^2.
    pub bend: [f32; 3],
    /// Inverse stiffness of the edges along warp and weft, s^2.
    pub stretch: [f32; 2],
    /// Acceleration per length error of the diagonals of a cell, 1/s^2.
    pub shear: f32,
}

impl Material {
    /// Tells whether every number is finite and could be that of a cloth.
    pub fn check_values(&self) -> Result<(), MaterialError> {
        let Material {
            bending_length_m: bending,
            stretch,
            ..
        } = self;
        #[rustfmt::skip] // a table, one field a line
        let rows = [
            ("weight_kg_m2", self.weight_kg_m2, [0.005, 5.0], " kg/m^2"),
            ("thickness_m", self.thickness_m, [1e-5, 0.02], " m"),
            ("bending_length_m.warp", bending.warp, [0.002, 0.2], " m"),
            ("bending_length_m.weft", bending.weft, [0.002, 0.2], " m"),
            ("bending_length_m.bias", bending.bias, [0.002, 0.2], " m"),
            ("crease_recovery_deg", self.crease_recovery_deg, [0.0, 180.0], " degrees"),
            ("stretch.warp", stretch.warp, [0.0, 1.0], ""),
            ("stretch.weft", stretch.weft, [0.0, 1.0], ""),
            ("stretch.bias", stretch.bias, [0.0, 1.0], ""),
            ("table_friction", self.table_friction, [0.0, 10.0], ""),
            ("self_friction", self.self_friction, [0.0, 10.0], ""),
        ];
        for (field, value, [low, high], unit) in rows {
            // A value that is no number is outside too.
            if !(low..=high).contains(&value) {
                return Err(MaterialError::OutOfBounds {
                    field,
                    value,
                    low,
                    high,
                    unit,
                });
            }
        }
        Ok(())
    }

    /// Tells whether a cloth of this material can be simulated with particles this far apart, in steps of 0.01 s.
    ///
    /// Fails with the bound that is exceeded; returns in what the simulated cloth differs from the material.
    pub fn check(&self, spacing_m: f32) -> Result<Vec<MaterialWarning>, MaterialError> {
        self.check_step(spacing_m, 0.01)?;
        let mut warnings = Vec::new();
        if self.gap_m() != self.thickness_m {
            warnings.push(MaterialWarning::Gap {
                thickness_m: self.thickness_m,
                gap_m: self.gap_m(),
            });
        }
        let Directions { warp, weft, bias } = self.bending_length_m;
        let softest_m = warp.min(weft).min(bias);
        if spacing_m > COARSE_SHARE * softest_m * 1.0001 {
            warnings.push(MaterialWarning::Coarse {
                length_m: softest_m,
                spacing_m: COARSE_SHARE * softest_m,
            });
        }
        let thread_m = warp.min(weft);
        if spacing_m > SHARP_SHARE * thread_m * 1.0001 {
            warnings.push(MaterialWarning::Sharp {
                length_m: thread_m,
                spacing_m: SHARP_SHARE * thread_m,
            });
        }
        let coarser = (self.substeps_per_s(spacing_m) / STEADY_SUBSTEPS_PER_S).sqrt() as f32;
        if coarser > 1.0 {
            let length_m = warp.max(weft).max(bias);
            warnings.push(MaterialWarning::Unsteady {
                length_m,
                spacing_m: spacing_m * coarser,
                is_light: self.weight_kg_m2 < LIGHT_KG_M2 && length_m > STIFF_M,
            });
        }
        let shown = self.least_bias_stretch(spacing_m);
        if shown > MORE_BIAS * self.stretch.bias {
            warnings.push(MaterialWarning::Shear {
                declared: self.stretch.bias,
                shown,
            });
        }
        let slackest = self.stretch.warp.max(self.stretch.weft);
        let shear_n_m = self.shear_n_m().min(self.most_shear_n_m(spacing_m));
        let shared = (shear_n_m / THREAD_LOAD_N_M) as f32 * slackest;
        if shared > SHARED_BY_THREADS {
            warnings.push(MaterialWarning::SlackThreads {
                more: GIVEN_BY_THREADS * shared,
            });
        }
        let least_m = self.least_bias_m();
        if least_m > SOFT_BIAS * bias {
            warnings.push(MaterialWarning::SoftBias {
                bias_m: bias,
                least_m,
            });
        }
        let curl = self.curl();
        if curl < MOST_CURLED_SHARE {
            let bias_m = bias.max(least_m);
            warnings.push(MaterialWarning::Curls {
                bias_m,
                least_m: bias_m * (LEAST_OF_CURLED * curl) as f32,
            });
        }
        let least_deg = self.least_recovery_deg(spacing_m);
        if least_deg > self.crease_recovery_deg + WIDE_CREASE_DEG {
            warnings.push(MaterialWarning::Crease {
                declared_deg: self.crease_recovery_deg,
                least_deg,
            });
        }
        Ok(warnings)
    }

    /// Tells whether a step of this length can be computed.
    pub(crate) fn check_step(&self, spacing_m: f32, step_secs: f32) -> Result<(), MaterialError> {
        self.check_values()?;
        let substeps = self.substeps(spacing_m, step_secs);
        if substeps <= MAX_SUBSTEPS {
            return Ok(());
        }
        let Directions { warp, weft, bias } = self.bending_length_m;
        // The frequency falls with the square of the spacing.
        let share = (f64::from(substeps) / f64::from(MAX_SUBSTEPS)).sqrt() as f32;
        Err(MaterialError::TooStiff {
            length_m: warp.max(weft).max(bias),
            substeps,
            spacing_m,
            least_spacing_m: spacing_m * share,
        })
    }

    /// Returns the distance between layers that lie on each other, metres.
    pub fn gap_m(&self) -> f32 {
        self.thickness_m.clamp(MIN_GAP_M, MAX_GAP_M)
    }

    /// Returns the number of substeps that a step is computed in.
    pub(crate) fn substeps(&self, spacing_m: f32, step_secs: f32) -> u32 {
        let needed = f64::from(step_secs) * self.substeps_per_s(spacing_m);
        (needed - 1e-6).ceil().max(1.0) as u32
    }

    fn substeps_per_s(&self, spacing_m: f32) -> f64 {
        let [warp, weft, twist] = self.bend(spacing_m);
        // A chessboard of particles up and down bends all families the most.
        let highest = (16.0 * (warp + weft + twist)).sqrt();
        (highest / STABLE).max(MIN_SUBSTEPS_PER_S)
    }

    /// Returns the rigidity of shear, N/m.
    ///
    /// FAST: the load over four times the extension on the bias (123 / EB5, in N/m and percent).
    fn shear_n_m(&self) -> f64 {
        BIAS_LOAD_N_M / (4.0 * f64::from(self.stretch.bias))
    }

    /// Returns the most of it that the substeps of a slow step hold.
    fn most_shear_n_m(&self, spacing_m: f32) -> f64 {
        let per_s = self.substeps_per_s(spacing_m);
        f64::from(MOST_SHEAR) * per_s * per_s * self.mass_kg(spacing_m)
    }

    /// Returns how little the cloth can give on the bias, as a share of its length.
    pub(crate) fn least_bias_stretch(&self, spacing_m: f32) -> f32 {
        (BIAS_LOAD_N_M / (4.0 * self.most_shear_n_m(spacing_m))) as f32
    }

    /// Returns the bending length on the bias of the threads alone, metres.
    pub(crate) fn least_bias_m(&self) -> f32 {
        let [warp, weft, _] = self.cubes();
        (0.25 * (warp + weft)).cbrt() as f32
    }

    /// Returns the least angle to which a crease opens, degrees.
    pub(crate) fn least_recovery_deg(&self, spacing_m: f32) -> f32 {
        let friction = Friction::new(self.crease_recovery_deg, spacing_m);
        friction.map_or(180.0, |friction| friction.farthest.to_degrees())
    }

    /// Returns how much of its bending length on the bias a strip shows that is free to curl and to twist, as a share.
    ///
    /// Of a plate that bends by `bias = s + t` as a cylinder, with `s = (warp + weft) / 4`, a narrow strip shows `4 h t / (h + t)`, with
    /// `h = warp * weft / (warp + weft)`. How near an overhang of two bending lengths comes to that is a guess from its
    /// length by the strip's width, which the cantilevers bear out.
    fn curl(&self) -> f64 {
        let [warp, weft, _] = self.cubes();
        let (twist, threads) = (self.twist(), warp * weft / (warp + weft));
        let narrow = 4.0 * threads * twist / ((threads + twist) * (0.25 * (warp + weft) + twist));
        let bias_m = self.bending_length_m.bias.max(self.least_bias_m());
        let slender = f64::from(2.0 * bias_m / BIAS_STRIP_M).powi(2);
        (1.0 - slender / (slender + 1.0) * (1.0 - narrow)).cbrt()
    }

    /// Returns the mass of a particle.
    fn mass_kg(&self, spacing_m: f32) -> f64 {
        f64::from(self.weight_kg_m2) * f64::from(spacing_m).powi(2)
    }

    /// Returns accelerations per difference of positions, as [`Stiffness::bend`].
    fn bend(&self, spacing_m: f32) -> [f64; 3] {
        let per_cube = BENDING_GRAVITY_M_S2 / f64::from(spacing_m).powi(4);
        let [warp, weft, _] = self.cubes();
        // A cell's mixed difference takes four times the twist rigidity.
        [warp, weft, 4.0 * self.twist()].map(|cube| per_cube * cube)
    }

    /// Returns the stiffnesses on a grid.
    pub(crate) fn stiffness(&self, spacing_m: f32) -> Stiffness {
        let mass = self.mass_kg(spacing_m);
        let along = |extension: f32| (mass * f64::from(extension) / THREAD_LOAD_N_M) as f32;
        Stiffness {
            bend: self.bend(spacing_m).map(|stiffness| stiffness as f32),
            stretch: [along(self.stretch.warp), along(self.stretch.weft)],
            shear: (self.shear_n_m() / mass) as f32,
        }
    }

    /// Returns the rigidity of twist as the cube of a length, m^3; none where the bias is softer than its threads allow.
    ///
    /// A strip on the bias bends as a cylinder, and both threads and the twist of cells resist: bias = (warp + weft) / 4 + twist
    /// (Cooper 1960). One that is much narrower than its overhang could curl across, too, and would be softer.
    fn twist(&self) -> f64 {
        let [warp, weft, bias] = self.cubes();
        (bias - 0.25 * (warp + weft)).max(0.0)
    }

    fn cubes(&self) -> [f64; 3] {
        let Directions { warp, weft, bias } = self.bending_length_m;
        [warp, weft, bias].map(|length| f64::from(length).powi(3))
    }
}
