//! The symmetries of a square cloth.

/// One of the eight symmetries of the square: mirrored along X or not, then turned by quarters.
#[derive(Clone, Copy, Debug)]
pub struct Symmetry {
    mirror: f32,
    quarters: usize,
}

impl Symmetry {
    /// All of them: the identity, the three turns, and the same four after the mirror.
    pub const ALL: [Symmetry; 8] = {
        let mut all = [Symmetry {
            mirror: 1.0,
            quarters: 0,
        }; 8];
        let mut code = 1;
        while code < 8 {
            all[code].quarters = code % 4;
            if code >= 4 {
                all[code].mirror = -1.0;
            }
            code += 1;
        }
        all
    };

    /// Returns the image of a place beside the middle of the square.
    pub fn apply(self, [x, y]: [f32; 2]) -> [f32; 2] {
        (0..self.quarters).fold([self.mirror * x, y], |[x, y], _| [-y, x])
    }

    /// Returns the particle at the image of the place of particle `i`, in a flat cloth of `dim` particles a side.
    pub fn particle(self, i: usize, dim: usize) -> usize {
        let middle = (dim - 1) as f32 / 2.0;
        let [x, y] = self.apply([(i % dim) as f32 - middle, middle - (i / dim) as f32]);
        (middle - y).round() as usize * dim + (x + middle).round() as usize
    }
    /// Returns a cloth as it would be if it had been neither mirrored nor turned.
    pub fn undo(self, points: &[[f32; 3]], dim: usize) -> Vec<[f32; 3]> {
        let turns = (4 - self.quarters) % 4;
        let back = |[x, y, z]: [f32; 3]| {
            let [x, y] = (0..turns).fold([x, y], |[x, y], _| [-y, x]);
            [self.mirror * x, y, z]
        };
        (0..dim * dim)
            .map(|i| back(points[self.particle(i, dim)]))
            .collect()
    }
}
