//! Crumpled starts: made by a world, and kept, since that takes seconds.
//!
//! In: a program's cloth, a seed, a world. Out: a [`Start`], from the cache or crumpled anew. Equal cloths,
//! seeds and worlds give equal bits.

use crate::start::Start;
use crate::{World, WorldError, metrics};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;

/// Most lifts for one start. One suffices for most; five take some ten seconds.
pub(crate) const MOST_LIFTS: u32 = 5;
/// Coverages that a start may have: those of the 40 recorded starts go from 0.325 to 0.625 (protocol, section 5).
const COVERAGES: std::ops::RangeInclusive<f64> = 0.32..=0.63;

/// Tells whether a heap covers as much of the table as recorded starts do, by SoftGym's measure.
///
/// A world lifts a heap again that does not, from where it lies, at most [`MOST_LIFTS`] times in all. SoftGym lifts
/// once and keeps what comes; here single heaps would lie too open for a start. Equal on every machine: the
/// measure has basic operations alone.
///
/// - `positions`: `[dimy * dimx]`, grid order, world frame, metres.
/// - `cloth`: the start that was lifted, for its grid and outline.
pub(crate) fn is_start(positions: &[[f32; 3]], cloth: &Start) -> bool {
    metrics::outlined_coverage(positions, &cloth.grid, cloth.outline.as_ref())
        .is_some_and(|covered| COVERAGES.contains(&covered))
}

/// Says how much of the table a crumpled start covers if that is other than recorded starts do: a stiff cloth may open
/// again after each lift.
pub fn unlike_recorded(start: &Start) -> Option<String> {
    let covered =
        metrics::outlined_coverage(&start.positions, &start.grid, start.outline.as_ref())?;
    let [least, most] = [COVERAGES.start(), COVERAGES.end()].map(|it| it * 100.0);
    (!COVERAGES.contains(&covered)).then(|| {
        format!(
            "this start covers {:.0} % of the flat cloth, recorded ones cover {least:.0} to {most:.0} %; another seed may lie otherwise",
            covered * 100.0
        )
    })
}

/// A crumpled start, and how it was had.
#[derive(Clone, Debug)]
pub struct Crumpled {
    /// The start.
    pub start: Start,
    /// Why it could not be kept for the next time, where that happened.
    pub not_kept: Option<String>,
}

/// Returns the crumpled start that a seed makes of a flat one.
///
/// `announce` is called before a start is crumpled anew. Fails where the world cannot lay or crumple the
/// cloth, or where `interrupt` is raised.
pub fn start(
    flat: &Start,
    seed: u64,
    world: &dyn World,
    cache: &Cache,
    interrupt: &Interrupt,
    announce: &mut dyn FnMut(),
) -> Result<Crumpled, WorldError> {
    let key = key(flat, seed, world);
    if let Some(positions) = cache.positions(&key, flat.positions.len()) {
        return Ok(Crumpled {
            start: flat.crumpled(seed, positions),
            not_kept: None,
        });
    }
    announce();
    let start = world.crumple(flat, seed, interrupt)?;
    let kept = cache.put_positions(&key, &start.positions);
    Ok(Crumpled {
        start,
        not_kept: kept.err(),
    })
}

/// Covers everything that the start depends on, the code that computes it included.
fn key(flat: &Start, seed: u64, world: &dyn World) -> String {
    Cache::key([
        "crumpled start, format 1",
        &world.parameters(),
        &world.code(),
        &flat.digest(),
        &seed.to_string(),
        include_str!("crumple.rs"),
        include_str!("metrics/grid_coverage.rs"),
        include_str!("start/mod.rs"),
        include_str!("start/outline.rs"),
        include_str!("simulated.rs"),
    ])
}

#[cfg(test)]
#[path = "tests/crumple.rs"]
mod tests;
