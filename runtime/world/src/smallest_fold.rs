//! Finds the smallest fold that a cloth keeps, by trying.
//!
//! In: a cloth, and a fold of it that went back. Out: how far the same point must be carried in the same direction for
//! the fold to stay. Longer ways are tried until one stays, and the boundary is then halved down to 2 mm. Close to the
//! boundary a fold may stay by chance, so some longer ways are tried too: if one of them goes back, the search goes on
//! beyond it.

use crate::metrics::cloth_moved;
use crate::start::Start;
use crate::{Grip, World, WorldError};
use fab_base::interrupt::Interrupt;
use fab_program::SmallestFold;

/// How near the answer is to the boundary, millimetres; less than half of the distance of two particles.
const RESOLUTION_MM: u32 = 2;

/// The shortest way whose growth is tried, millimetres, so that a tiny step needs few trials.
const SHORTEST_MM: u32 = 10;

/// How much longer ways must stay too, millimetres.
const BEYOND_MM: [u32; 4] = [2, 5, 10, 20];

/// How many boundaries are looked for; what is beyond the last one is not tried.
const MOST_BOUNDARIES: u32 = 4;

/// Returns the smallest fold that stays, and that stays when it is carried a little farther; tries at most about 80.
///
/// - `cloth`: where the cloth lies before the fold; each trial begins there, at rest.
/// - `grip`: the fold that goes back.
///
/// Ways up to the diagonal of the flat cloth are tried, or up to what the world can reach.
pub fn find(
    cloth: &Start,
    grip: &Grip,
    world: &mut dyn World,
    interrupt: &Interrupt,
) -> Result<SmallestFold, WorldError> {
    let way = grip.place - grip.pick;
    let length_mm = way.x.hypot(way.y) * 1000.0;
    // Two points on top of each other have no direction.
    if length_mm < 1.0 {
        return Ok(SmallestFold::NoneUpTo { mm: 0 });
    }
    let mut stays = |mm: u32| {
        let place = grip.pick + way * (f64::from(mm) / length_mm);
        world.reset(cloth)?;
        let executed = world.act(&Grip { place, ..*grip }.into(), interrupt)?;
        let after = world.particles().unwrap_or_default();
        let moved = cloth_moved(&cloth.positions, &after, &executed);
        Ok(moved
            .and_then(|moved| moved.held)
            .is_some_and(|held| !held.went_back))
    };
    let [right_m, front_m] =
        [cloth.grid.dimx, cloth.grid.dimy].map(|count| f64::from(count - 1) * cloth.grid.spacing_m);
    let longest = (right_m.hypot(front_m) * 1000.0).floor() as u32;
    let mut went_back = length_mm.floor() as u32;
    let mut boundaries = 0;
    loop {
        boundaries += 1;
        let mut stayed = loop {
            let next = (went_back.max(SHORTEST_MM) * 3 / 2).min(longest);
            if next <= went_back {
                return Ok(SmallestFold::NoneUpTo { mm: went_back });
            }
            match stays(next) {
                Ok(true) => break next,
                Ok(false) => went_back = next,
                // It leads out of the world's reach.
                Err(WorldError::Motion { .. }) => {
                    return Ok(SmallestFold::NoneUpTo { mm: went_back });
                }
                Err(error) => return Err(error),
            }
        };
        while stayed - went_back > RESOLUTION_MM {
            let middle = went_back.midpoint(stayed);
            match stays(middle)? {
                true => stayed = middle,
                false => went_back = middle,
            }
        }
        let mut goes_back = None;
        for beyond in BEYOND_MM.map(|more| stayed + more) {
            match stays(beyond) {
                Ok(true) | Err(WorldError::Motion { .. }) => {}
                Ok(false) => goes_back = Some(beyond),
                Err(error) => return Err(error),
            }
        }
        match goes_back.filter(|beyond| *beyond < longest && boundaries < MOST_BOUNDARIES) {
            Some(beyond) => went_back = beyond,
            None => return Ok(SmallestFold::From { mm: stayed }),
        }
    }
}

#[cfg(test)]
#[path = "tests/smallest_fold.rs"]
mod tests;
