//! How far an action moved the cloth, and how much of that stayed.
//!
//! In: every particle before and after an action, and what was done. Out: distances along the table, as seen from
//! above: a corner that was lifted and put back has moved 0 mm.

use crate::{Executed, Grasp};
use serde::{Deserialize, Serialize};

/// How far an action moved the cloth along the table, millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClothMoved {
    /// The particle that was held; null if none was, if several were, or if the world does not tell which.
    pub held: Option<HeldMoved>,
    /// How far the particle that moved most lies from its place before the action.
    pub farthest_mm: f64,
    /// How far the whole cloth slid: the length of the way whose x and y are the medians over all particles. It is
    /// no slide where more than half of the cloth was folded over, or where the cloth turned.
    pub slid_mm: f64,
    /// How far the particle that moved most lies from where it would lie if the whole cloth had only slid.
    pub folded_mm: f64,
}

/// How far an action moved the particle that was held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldMoved {
    /// From its place before the action to its place at the release.
    pub carried_mm: f64,
    /// From its place before the action to its place after it, when the cloth rests.
    pub stayed_mm: f64,
    /// Whether it went back more than half of its way, once the slide of the whole cloth is taken off.
    pub sprang_back: bool,
    /// Whether the cloth lies as before, wherever it slid to: once the slide is taken off, no particle lies farther from its old
    /// place than half of what the held one was carried (or a tenth of it with the slide, or 1 mm, if that is more).
    pub went_back: bool,
}

/// Measures an action.
///
/// - `before`, `after`: `[n_particles]` positions, grid order, world frame, metres.
///
/// `None` if the counts differ, there is no particle, or a coordinate is not finite.
pub fn cloth_moved(
    before: &[[f32; 3]],
    after: &[[f32; 3]],
    executed: &Executed,
) -> Option<ClothMoved> {
    let mut numbers = before.iter().chain(after).flatten();
    if before.len() != after.len() || !numbers.all(|it| it.is_finite()) {
        return None;
    }
    let ways = || {
        let pairs = before.iter().zip(after);
        pairs.map(|(before, after)| way(before.map(f64::from), after.map(f64::from)))
    };
    let slid = [
        median(ways().map(|way| way[0]))?,
        median(ways().map(|way| way[1]))?,
    ];
    let farthest_mm = |from: [f64; 2]| ways().map(|way| mm(less(way, from))).fold(0.0, f64::max);
    let folded_mm = farthest_mm(slid);
    let held = || {
        let [done] = executed.grips[..] else {
            return None;
        };
        let Grasp::Particle(particle) = done.grasp else {
            return None;
        };
        let from = before.get(particle as usize)?.map(f64::from);
        let carried = way(from, done.released_at?.into());
        let stayed = way(from, after.get(particle as usize)?.map(f64::from));
        let half_mm = mm(less(carried, slid)) / 2.0;
        Some(HeldMoved {
            carried_mm: mm(carried),
            stayed_mm: mm(stayed),
            sprang_back: mm(less(stayed, slid)) < half_mm,
            // A rim that was dragged is bent a little.
            went_back: folded_mm < half_mm.max(mm(carried) / 10.0).max(1.0),
        })
    };
    Some(ClothMoved {
        held: held(),
        farthest_mm: farthest_mm([0.0; 2]),
        slid_mm: mm(slid),
        folded_mm,
    })
}

/// Returns the mean of the two middle values, or the middle one; `None` of nothing.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let lower = middle.saturating_sub(usize::from(values.len().is_multiple_of(2)));
    Some((values.get(lower)? + values.get(middle)?) / 2.0)
}

/// Returns the way along the table.
fn way(from: [f64; 3], to: [f64; 3]) -> [f64; 2] {
    less([to[0], to[1]], [from[0], from[1]])
}

fn less(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn mm(way_m: [f64; 2]) -> f64 {
    way_m[0].hypot(way_m[1]) * 1000.0
}

#[cfg(test)]
#[path = "tests/cloth_moved.rs"]
mod tests;
