//! The inextensible elastica under its own weight, integrated apart from the simulator.
//!
//! A strip of bending length `c` is a rod whose direction `angle(s)` obeys `angle'' = (H sin(angle) - V(s) cos(angle)) / c^3`,
//! where `H` and `V` are the force across a section divided by the weight per length, and `V' = 1` (Plaut, Textile
//! Research Journal 2015; Peirce 1930). Lengths here are in bending lengths, so that `c = 1`. What is unknown at one
//! end is found by Newton's method from many starts.

/// The end of a rod.
#[derive(Clone, Copy, Debug)]
struct End {
    x: f64,
    y: f64,
    angle: f64,
    curvature: f64,
    /// Upright part of the force, in weights of a bending length of strip.
    upright: f64,
    highest: f64,
    lowest: f64,
}

/// Integrates a rod from a point by Runge and Kutta's fourth-order method.
fn rod(angle: f64, curvature: f64, force: [f64; 2], length: f64) -> End {
    rod_of_width(angle, curvature, force, length, |_| 1.0)
}

/// Integrates a strip whose width changes along it, in widths of the one that the force is per.
fn rod_of_width(
    angle: f64,
    curvature: f64,
    [h, v]: [f64; 2],
    length: f64,
    width: impl Fn(f64) -> f64,
) -> End {
    const STEPS: usize = 120;
    let step = length / STEPS as f64;
    // Place, angle, moment, and the upright part of the force.
    let slope = |s: f64, [_, _, a, m, v]: [f64; 5]| {
        let width = width(s);
        [
            a.cos(),
            a.sin(),
            m / width,
            h * a.sin() - v * a.cos(),
            width,
        ]
    };
    let add = |y: [f64; 5], d: [f64; 5], by: f64| [0, 1, 2, 3, 4].map(|i| y[i] + by * d[i]);
    let mut y = [0.0, 0.0, angle, curvature * width(0.0), v];
    let (mut highest, mut lowest) = (0.0f64, 0.0f64);
    for i in 0..STEPS {
        let s = i as f64 * step;
        let k1 = slope(s, y);
        let k2 = slope(s + 0.5 * step, add(y, k1, 0.5 * step));
        let k3 = slope(s + 0.5 * step, add(y, k2, 0.5 * step));
        let k4 = slope(s + step, add(y, k3, step));
        y = [0, 1, 2, 3, 4].map(|i| y[i] + step / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        highest = highest.max(y[1]);
        lowest = lowest.min(y[1]);
    }
    End {
        x: y[0],
        y: y[1],
        angle: y[2],
        curvature: y[3] / width(length),
        upright: y[4],
        highest,
        lowest,
    }
}

/// Finds where a function of `N` unknowns is nothing, from a start; `None` if Newton's method does not get there.
fn root<const N: usize>(f: impl Fn([f64; N]) -> [f64; N], start: [f64; N]) -> Option<[f64; N]> {
    let mut at = start;
    for _ in 0..40 {
        let value = f(at);
        if value.iter().all(|v| v.abs() < 1e-9) {
            return Some(at);
        }
        // The matrix of derivatives with the value beside it, solved by Gauss.
        let mut rows = [[0.0; 8]; N];
        for column in 0..N {
            let mut moved = at;
            moved[column] += 1e-6;
            let there = f(moved);
            for row in 0..N {
                rows[row][column] = (there[row] - value[row]) / 1e-6;
            }
        }
        for row in 0..N {
            rows[row][N] = -value[row];
        }
        for pivot in 0..N {
            let best = (pivot..N)
                .max_by(|&a, &b| rows[a][pivot].abs().total_cmp(&rows[b][pivot].abs()))?;
            rows.swap(pivot, best);
            if rows[pivot][pivot].abs() < 1e-14 {
                return None;
            }
            for row in 0..N {
                if row != pivot {
                    let share = rows[row][pivot] / rows[pivot][pivot];
                    let pivot_row = rows[pivot];
                    for (value, other) in rows[row].iter_mut().zip(pivot_row) {
                        *value -= share * other;
                    }
                }
            }
        }
        let step: [f64; N] = std::array::from_fn(|i| rows[i][N] / rows[i][i]);
        let size = step.iter().map(|s| s.abs()).fold(0.0, f64::max);
        let share = (0.5 / size).min(1.0);
        for i in 0..N {
            at[i] += share * step[i];
        }
        if !at.iter().all(|v| v.is_finite() && v.abs() < 100.0) {
            return None;
        }
    }
    None
}

/// Returns the tip's angle below the horizontal, seen from the clamp, of a rod that juts out by `length`, radians.
pub fn cantilever_rad(length: f64) -> f64 {
    // The section at `s` carries what is beyond it.
    let bent = |k: f64| rod(0.0, k, [0.0, -length], length);
    // The curvature at the clamp is between nothing and that of a rod that stays straight; it ends without any.
    let (mut low, mut high) = (-0.5 * length * length, 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if bent(middle).curvature > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    let end = bent(low);
    (-end.y).atan2(end.x)
}

/// Returns how far a loop of length `length` hangs below its clamp, whose ends point up at `clamp_rad`.
pub fn loop_depth(clamp_rad: f64, length: f64) -> f64 {
    let half = 0.5 * length;
    let shape = |[k, h]: [f64; 2]| rod(clamp_rad, k, [h, -half], half);
    let closes = |unknown: [f64; 2]| {
        let end = shape(unknown);
        [end.x, end.angle + std::f64::consts::PI]
    };
    let starts =
        (0..4).flat_map(|k| (0..5).map(move |h| [0.5 - f64::from(k), -2.0 + f64::from(h)]));
    // Of all shapes in balance the one that hangs deepest: the others are upside down.
    let depths = starts
        .filter_map(|start| root(closes, start))
        .map(|found| -shape(found).lowest);
    depths
        .filter(|depth| *depth < half)
        .fold(f64::NAN, f64::max)
}

/// Returns the height of a fold whose upper layer comes to rest `gap` above the lower one: both ends of the free part
/// are without curvature, as flat cloth is.
pub fn fold_height(gap: f64) -> f64 {
    let shape = |[v, h, s]: [f64; 3]| rod(0.0, 0.0, [h, v], s);
    let lands = |unknown: [f64; 3]| {
        let end = shape(unknown);
        [end.angle - std::f64::consts::PI, end.y - gap, end.curvature]
    };
    let mut heights = Vec::new();
    for v in 0..3 {
        for h in 0..4 {
            for s in 0..2 {
                let start = [-3.0 + f64::from(v), -2.0 + f64::from(h), 3.0 + f64::from(s)];
                if let Some(found) = root(lands, start)
                    && (0.5..8.0).contains(&found[2])
                {
                    let end = shape(found);
                    // Not through the table, and without further turns.
                    if end.lowest > -1e-3 {
                        heights.push(end.highest);
                    }
                }
            }
        }
    }
    heights.sort_by(f64::total_cmp);
    *heights.first().unwrap_or(&f64::NAN)
}

/// Returns how far the end of a strip has to be carried so that the fold stays, where nothing but the end touches the layer
/// below, `gap` under it, and friction holds it from sliding into the fold.
pub fn least_carry(gap: f64, friction: f64) -> f64 {
    // From the fold whose end just lies flat, which needs no friction, to the one whose end is at the limit of the cone.
    let mut at = [-3.73, 4.7];
    let mut carry = f64::NAN;
    for step in 0..=20 {
        let share = friction * f64::from(step) / 20.0;
        let shape = |[v, s]: [f64; 2]| rod(0.0, 0.0, [-share * (v + s), v], s);
        let rests = |unknown: [f64; 2]| {
            let end = shape(unknown);
            [end.curvature, end.y - gap]
        };
        let Some(found) = root(rests, at) else {
            return f64::NAN;
        };
        at = found;
        carry = found[1] - shape(found).x;
    }
    carry
}

/// Returns how far a corner has to be carried along the diagonal so that the fold stays, where the flap lies flat from where it
/// touches, `gap` above the layer below, and friction under that part holds it.
///
/// The corner bends as a cylinder across the diagonal, so it is a strip whose width is twice the distance from its point.
pub fn least_corner_carry(gap: f64, friction: f64) -> f64 {
    // Where the strip is as wide as the force is per: about at the fold.
    const FOLD: f64 = 2.4;
    let mut at = [-3.73, -0.03, 4.65];
    let mut carry = f64::NAN;
    // From an even strip to a corner in 4 steps, then by the distance from where the layer below lifts off to the point,
    // from far to near.
    for step in 0..200 {
        let taper = (0.25 * f64::from(step)).min(1.0);
        let whole = 14.0 - 0.05 * f64::from((step - 4).max(0));
        let width = |s: f64| 1.0 + taper * ((whole - s).max(1e-9) / (whole - FOLD) - 1.0);
        let shape = |[v, h, s]: [f64; 3]| rod_of_width(0.0, 0.0, [h, v], s, width);
        let lands = |unknown: [f64; 3]| {
            let end = shape(unknown);
            [end.angle - std::f64::consts::PI, end.y - gap, end.curvature]
        };
        let Some(found) = root(lands, at) else {
            return f64::NAN;
        };
        at = found;
        let end = shape(found);
        let flat = whole - found[2];
        let weight = 0.5 * flat * flat / (whole - FOLD);
        if found[1].abs() > friction * (end.upright + weight) {
            return carry;
        }
        carry = whole - end.x + flat;
    }
    f64::NAN
}
