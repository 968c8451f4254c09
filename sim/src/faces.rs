//! Contacts of a cloth with itself: particles on faces.
//!
//! In: positions. Out: positions corrected in place, one contact after another in a fixed order. A particle rests on
//! a corner of a cell of another layer, so that a layer is closed however far its particles are apart, and layers
//! may lie closer than particles do. Which side of a layer a particle is on is taken from the positions before they
//! can have crossed, and holds until the next search. Searches follow from the positions alone.

use crate::layout::Layout;
use crate::neighbours::Neighbours;
use crate::planes::Planes;

// How far a particle may be from a layer that it is said to touch before long, metres, beyond the gap.
const MARGIN_M: f32 = 0.004;
// Farthest part of a cell beside its nearest corner, and beyond the rim of the cloth, in cells.
const REACH: f32 = 0.55;
const RIM: f32 = 0.25;
// More pairs than this per particle are dropped.
const MAX_PAIRS_PER_PARTICLE: usize = 96;
// How readily a hand gives way upwards, where a free particle counts 1.
const HAND: f32 = 1.0;
const TINY: f32 = 1e-20;

/// A particle beside a corner of a cell.
#[derive(Clone, Copy, Debug)]
struct Contact {
    /// Particle, then the corner and its two neighbours, as slots.
    slots: [u32; 4],
    /// How much of the touched point is each corner's.
    shares: [f32; 3],
    /// From the layer to the particle.
    normal: [f32; 3],
    /// From the touched point to the particle where the two stick to each other.
    sticks_at: [f32; 3],
    /// Depths, and shifts by friction, that were corrected in this substep.
    pressed: f32,
    rubbed: [f32; 3],
}

/// Contacts of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Faces {
    stride: usize,
    columns: usize,
    gap_m: f32,
    friction: f32,
    present: Vec<bool>,
    neighbours: Neighbours,
    contacts: Vec<Contact>,
    searched_at: Planes,
    is_stale: bool,
}

impl Faces {
    /// Makes a cloth that touches itself nowhere.
    pub fn new(layout: &Layout, gap_m: f32, friction: f32) -> Faces {
        let spacing_m = layout.grid().spacing_m;
        let (aside, above) = (0.75 * spacing_m, gap_m + MARGIN_M);
        let reach_m = (aside * aside + above * above).sqrt();
        Faces {
            stride: layout.stride(),
            columns: layout.grid().dimx,
            gap_m,
            friction,
            present: (0..layout.len())
                .map(|slot| layout.is_present(slot))
                .collect(),
            // All but those that an edge joins: also a fold along one row of particles must not close altogether.
            neighbours: Neighbours::within(layout, reach_m, 2.0, MAX_PAIRS_PER_PARTICLE),
            contacts: Vec::new(),
            searched_at: Planes::zeros(layout.len()),
            is_stale: true,
        }
    }

    /// Forgets what was found, so that nothing depends on what came before.
    pub fn forget(&mut self) {
        self.is_stale = true;
    }

    /// Searches anew if a particle may have come near a layer unseen since the last search.
    ///
    /// - `now`: where the particles are; `began`: where they were when the substep began.
    pub fn search(&mut self, now: &Planes, began: &Planes) {
        if !self.is_stale && !now.differs_beyond(&self.searched_at, 0.5 * MARGIN_M) {
            return;
        }
        self.is_stale = false;
        self.searched_at.clone_from(began);
        self.contacts.clear();
        let pairs = self.neighbours.find(began);
        let faces = Search {
            stride: self.stride,
            columns: self.columns,
            reach_m: self.gap_m + MARGIN_M,
            present: &self.present,
            positions: began,
        };
        for &[i, j] in pairs {
            for (i, j) in [(i, j), (j, i)] {
                self.contacts.extend(faces.contact(i as usize, j as usize));
            }
        }
    }

    /// Returns the fastest that a particle moves past a layer that it may touch, m/s.
    ///
    /// - `soon_m`: particles below this height count with all their speed: the table may stop the layer below
    ///   before it stops them.
    pub fn fastest(
        &self,
        positions: &Planes,
        velocities: &Planes,
        fall_secs: f32,
        soon_m: f32,
    ) -> f32 {
        let mut fastest_2 = 0.0f32;
        for contact in &self.contacts {
            let [i, a, b, c] = contact.slots.map(|slot| velocities.get(slot as usize));
            let [sa, sb, sc] = contact.shares;
            let apart = [0, 1, 2].map(|k| i[k] - (sa * a[k] + sb * b[k] + sc * c[k]));
            let slot = contact.slots[0] as usize;
            let lands = positions.z[slot] + fall_secs * i[2] < soon_m;
            let past = dot(apart, apart).max(if lands { dot(i, i) } else { 0.0 });
            fastest_2 = fastest_2.max(past);
        }
        fastest_2.sqrt()
    }

    /// Forgets what a substep has corrected.
    pub fn begin_substep(&mut self) {
        for contact in &mut self.contacts {
            contact.pressed = 0.0;
            contact.rubbed = [0.0; 3];
        }
    }

    /// Pushes every touching particle and layer apart once, with friction; returns the deepest that one was, metres.
    ///
    /// A contact within the cone of friction goes back to where it stuck at the last search: measured from where the
    /// substep began, what one contact leaves over of another's correction would add up to creep.
    pub fn resolve(&mut self, positions: &mut Planes, inverse_mass: &[f32]) -> f32 {
        let mut deepest = 0.0;
        let n = positions.len();
        let (x, y, z) = (
            &mut positions.x[..n],
            &mut positions.y[..n],
            &mut positions.z[..n],
        );
        let w = &inverse_mass[..n];
        for contact in &mut self.contacts {
            let [i, a, b, c] = contact.slots.map(|slot| slot as usize);
            let [sa, sb, sc] = contact.shares;
            let [nx, ny, nz] = contact.normal;
            let apart = [
                x[i] - (sa * x[a] + sb * x[b] + sc * x[c]),
                y[i] - (sa * y[a] + sb * y[b] + sc * y[c]),
                z[i] - (sa * z[a] + sb * z[b] + sc * z[c]),
            ];
            let depth = self.gap_m - (apart[0] * nx + apart[1] * ny + apart[2] * nz);
            if depth <= 0.0 && contact.pressed <= 0.0 {
                contact.sticks_at = apart;
                continue;
            }
            let depth = depth.max(0.0);
            if depth > deepest {
                deepest = depth;
            }
            contact.pressed += depth;
            // A hand that lowers what it holds onto a layer gives way upwards; else it would push its particle through.
            let free = |slot: usize| if w[slot] > 0.0 { w[slot] } else { HAND };
            let (wi, wa, wb, wc) = (free(i), free(a), free(b), free(c));
            let weight = wi + sa * sa * wa + sb * sb * wb + sc * sc * wc;
            let off = minus(apart, contact.sticks_at);
            let off_normal = dot(off, contact.normal);
            // Positive against the slip.
            let asked =
                [0, 1, 2].map(|k| contact.rubbed[k] + off[k] - off_normal * contact.normal[k]);
            let length = (dot(asked, asked) + TINY).sqrt();
            let share = self.friction * contact.pressed / length;
            let share = if share < 1.0 { share } else { 1.0 };
            let mut along = [0.0; 3];
            for k in 0..3 {
                let rubbed = share * asked[k];
                along[k] = rubbed - contact.rubbed[k];
                contact.rubbed[k] = rubbed;
                contact.sticks_at[k] += asked[k] - rubbed;
            }
            let per = 1.0 / weight;
            let push = [
                per * (depth * nx - along[0]),
                per * (depth * ny - along[1]),
                per * (depth * nz - along[2]),
            ];
            for (slot, share) in [(i, 1.0), (a, -sa), (b, -sb), (c, -sc)] {
                if w[slot] <= 0.0 {
                    z[slot] += (HAND * share * per * depth * nz).max(0.0);
                    continue;
                }
                let part = share;
                x[slot] += part * push[0];
                y[slot] += part * push[1];
                z[slot] += part * push[2];
            }
        }
        deepest
    }
}

/// What a search reads.
struct Search<'a> {
    stride: usize,
    columns: usize,
    reach_m: f32,
    present: &'a [bool],
    positions: &'a Planes,
}

impl Search<'_> {
    /// Returns the contact of particle `i` with the cells around particle `j`, if it is above or below one of them
    /// and nearest to that corner.
    fn contact(&self, i: usize, j: usize) -> Option<Contact> {
        let s = self.stride;
        let (point, corner) = (self.positions.get(i), self.positions.get(j));
        let p = minus(point, corner);
        let column = j % s;
        let left = (column > 0 && self.present[j - 1]).then(|| j - 1);
        let right = (column + 1 < self.columns && self.present[j + 1]).then_some(j + 1);
        let back = (j >= s && self.present[j - s]).then(|| j - s);
        let front = (j + s < self.present.len() && self.present[j + s]).then_some(j + s);
        let (b, e1, rim_b) = self.toward(p, corner, left, right)?;
        let (c, e2, rim_c) = self.toward(p, corner, back, front)?;
        if b == i || c == i {
            return None;
        }
        let (a11, a12, a22) = (dot(e1, e1), dot(e1, e2), dot(e2, e2));
        let (b1, b2) = (dot(p, e1), dot(p, e2));
        let det = a11 * a22 - a12 * a12;
        if det <= 1e-3 * a11 * a22 {
            return None;
        }
        let u = (b1 * a22 - b2 * a12) / det;
        let v = (b2 * a11 - b1 * a12) / det;
        let inside =
            |value: f32, rim: bool| value > if rim { -RIM } else { -0.05 } && value < REACH;
        if !(inside(u, rim_b) && inside(v, rim_c)) {
            return None;
        }
        let normal = cross(e1, e2);
        let per = 1.0 / (dot(normal, normal) + TINY).sqrt();
        let height = dot(p, normal) * per;
        if height.abs() > self.reach_m {
            return None;
        }
        let per = if height < 0.0 { -per } else { per };
        let (u, v) = (u.max(0.0), v.max(0.0));
        Some(Contact {
            slots: [i as u32, j as u32, b as u32, c as u32],
            shares: [1.0 - u - v, u, v],
            normal: normal.map(|n| n * per),
            sticks_at: [0, 1, 2].map(|k| {
                let [b, c] = [b, c].map(|slot| self.positions.get(slot)[k]);
                point[k] - ((1.0 - u - v) * corner[k] + u * b + v * c)
            }),
            pressed: 0.0,
            rubbed: [0.0; 3],
        })
    }

    /// Returns the neighbour of a corner on the side of `p`, the edge to it, and whether the cloth ends there on
    /// the other side of the corner.
    #[inline(always)]
    fn toward(
        &self,
        p: [f32; 3],
        corner: [f32; 3],
        before: Option<usize>,
        after: Option<usize>,
    ) -> Option<(usize, [f32; 3], bool)> {
        let edge = |slot: usize| minus(self.positions.get(slot), corner);
        match (before, after) {
            (Some(before), Some(after)) => {
                let (e, f) = (edge(before), edge(after));
                Some(if dot(p, minus(f, e)) < 0.0 {
                    (before, e, false)
                } else {
                    (after, f, false)
                })
            }
            (Some(one), None) | (None, Some(one)) => Some((one, edge(one), true)),
            (None, None) => None,
        }
    }
}

#[inline(always)]
fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
