//! What stands in a picture: the cloth and the picker's marker as triangles.
//!
//! In: positions, and how a camera projects a point. Out: projected, shaded triangles for `raster`. Where a camera
//! stands and what lies behind the triangles is the camera's business.

use crate::mask::Mask;
use crate::mesh;
use crate::raster::{Shade, Vertex};

/// A projected point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Pixels from the image's left edge.
    pub column: f32,
    /// Pixels from the image's top edge.
    pub row: f32,
    /// One over the distance along the optical axis, 1/m.
    pub inverse_depth: f32,
}

impl Seen {
    /// Returns it as a corner of a triangle.
    pub(crate) fn vertex(self, shade: Shade) -> Vertex {
        Vertex {
            column: self.column,
            row: self.row,
            inverse_depth: self.inverse_depth,
            shade,
        }
    }
}

/// Projects a point of the world frame, metres; `None` where it cannot be drawn.
pub(crate) type Project<'a> = dyn Fn([f32; 3]) -> Option<Seen> + 'a;

/// Adds the cloth's triangles to a list; of a cell that cannot be drawn whole, neither.
///
/// - `positions`: `[dimy * dimx]` points in grid order, world frame, metres.
/// - `is_shown`: whether to draw a triangle, by the indices of its corners.
/// - `vertex_of`: projects and shades a particle, by its index and its point; `None` if it cannot be drawn.
pub(crate) fn add_cloth(
    triangles: &mut Vec<[Vertex; 3]>,
    mask: &Mask,
    positions: &[[f32; 3]],
    is_shown: &dyn Fn([usize; 3]) -> bool,
    vertex_of: &dyn Fn(usize, [f32; 3]) -> Option<Vertex>,
) {
    let vertex = |index: usize| match mask.has(index) {
        true => vertex_of(index, positions[index]),
        false => None,
    };
    let count = positions.len().min(mask.grid().particle_count());
    let vertices: Vec<Option<Vertex>> = (0..count).map(vertex).collect();
    triangles.reserve(2 * vertices.len());
    for cell in mesh::cells(mask) {
        let triangle = |corners: [usize; 3]| {
            // The mesh is anticlockwise as seen from above, the raster takes clockwise for the top.
            let [first, second, third] = corners.map(|index| vertices.get(index)?.as_ref());
            Some([*first?, *third?, *second?])
        };
        if let [Some(one), Some(other)] = cell.map(triangle) {
            let both = cell.into_iter().zip([one, other]);
            triangles.extend(
                both.filter(|(corners, _)| is_shown(*corners))
                    .map(|it| it.1),
            );
        }
    }
}

/// Returns a vector that is normal to the cloth at a particle and points away from its underside, and its length.
pub(crate) fn normal(mask: &Mask, positions: &[[f32; 3]], index: usize) -> ([f32; 3], f32) {
    let dimx = mask.grid().dimx;
    let column = index % dimx;
    // Beyond an edge stands the particle itself, so that the slope there is that of one side.
    let at = |neighbour: Option<usize>| {
        let there = neighbour.filter(|&neighbour| mask.has(neighbour));
        let point = positions.get(there.unwrap_or(index));
        point.copied().unwrap_or_default()
    };
    let between = |a: [f32; 3], b: [f32; 3]| [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let left = (column > 0).then(|| index - 1);
    let right = (column + 1 < dimx).then_some(index + 1);
    let u = between(at(left), at(right));
    // Rows of the grid run along -Y.
    let v = between(at(Some(index + dimx)), at(index.checked_sub(dimx)));
    let normal = cross(u, v);
    (normal, dot(normal, normal).sqrt())
}

/// Where the picker grasps, drawn as a ball with a thin rod above it.
///
/// It is smaller than the sphere that the cloth feels, which would hide what is grasped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// The lowest point, world frame, metres.
    pub tip: [f32; 3],
    /// Whether it holds the cloth.
    pub holds: bool,
}

/// Radius of the marker's ball, metres: about one and a half cells of the cloth.
const BALL_M: f32 = 0.009;
/// Radius of the marker's rod, metres.
const ROD_M: f32 = 0.003;
/// Height of the rod's end above the tip, metres.
const ROD_END_M: f32 = 0.09;
/// Half the sides of the ball's and the rod's cross section.
const HALF_SIDES: usize = 8;
/// Cosine and sine of the `k`th of `2 * HALF_SIDES` equal parts of a turn.
const TURN: [[f32; 2]; 2 * HALF_SIDES] = {
    // Written out, since this crate calls no platform sine.
    const C: f32 = 0.923_879_5;
    const S: f32 = 0.382_683_43;
    const R: f32 = std::f32::consts::FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [C, S],
        [R, R],
        [S, C],
        [0.0, 1.0],
        [-S, C],
        [-R, R],
        [-C, S],
        [-1.0, 0.0],
        [-C, -S],
        [-R, -R],
        [-S, -C],
        [0.0, -1.0],
        [S, -C],
        [R, -R],
        [C, -S],
    ]
};

impl Marker {
    /// Returns the colour in light: dark grey while open, blue while it holds the cloth.
    pub fn colour(&self) -> [u8; 3] {
        match self.holds {
            true => [35, 95, 200],
            false => [70, 74, 82],
        }
    }

    /// Projects its triangles; those with a corner that cannot be drawn are left out.
    pub(crate) fn triangles(&self, project: &Project<'_>) -> Vec<[Vertex; 3]> {
        let [x, y, z] = self.tip;
        // Profiles of solids of revolution: radius and height above the tip.
        let half_turn = &TURN[..=HALF_SIDES];
        let ball: Vec<[f32; 2]> = half_turn
            .iter()
            .map(|[c, s]| [BALL_M * s, BALL_M * (1.0 - c)])
            .collect();
        let rod = [[ROD_M, 1.5 * BALL_M], [ROD_M, ROD_END_M], [0.0, ROD_END_M]];
        let mut triangles = Vec::new();
        for profile in [&ball[..], &rod] {
            let vertex = |ring: usize, side: usize| {
                let [radius, height] = profile[ring];
                let [c, s] = TURN[side % TURN.len()];
                let seen = project([x + radius * c, y + radius * s, z + height])?;
                let outward = match profile.len() > rod.len() {
                    true => [radius * c, radius * s, height - BALL_M],
                    false => [c, s, 0.0],
                };
                let light = 0.72 + 0.4 * dot(outward, LIGHT) / dot(outward, outward).sqrt();
                let colour = in_light(self.colour().map(|channel| f32::from(channel) * light));
                Some(seen.vertex(Shade {
                    top: colour,
                    underside: colour,
                }))
            };
            for ring in 1..profile.len() {
                for side in 0..TURN.len() {
                    let corners = [
                        vertex(ring - 1, side),
                        vertex(ring - 1, side + 1),
                        vertex(ring, side + 1),
                        vertex(ring, side),
                    ];
                    if let [Some(a), Some(b), Some(c), Some(d)] = corners {
                        triangles.extend([[a, b, c], [a, c, d]]);
                    }
                }
            }
        }
        triangles
    }
}

/// Limits a colour to what a picture holds; never quite black, which stands for shadow while triangles are drawn.
pub(crate) fn in_light([red, green, blue]: [f32; 3]) -> [f32; 3] {
    [red.clamp(1.0, 255.0), green.min(255.0), blue.min(255.0)]
}

/// Where the light comes from in the pictures for people: from the left, behind and above. A unit vector.
pub(crate) const LIGHT: [f32; 3] = [-0.48, 0.36, 0.8];

pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
