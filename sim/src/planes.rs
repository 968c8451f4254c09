//! Vectors of many particles, kept as one plane per coordinate.
//!
//! Loops over contiguous planes are what the compiler turns into SIMD code;
//! loops over `[x, y, z]` triples are not.

/// One plane of values per coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Planes {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
}

impl Planes {
    /// Makes planes of zeros.
    pub fn zeros(n: usize) -> Planes {
        Planes {
            x: vec![0.0; n],
            y: vec![0.0; n],
            z: vec![0.0; n],
        }
    }

    /// Returns the number of values in a plane.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Returns one vector.
    pub fn get(&self, i: usize) -> [f32; 3] {
        [self.x[i], self.y[i], self.z[i]]
    }

    /// Replaces one vector.
    pub fn set(&mut self, i: usize, value: [f32; 3]) {
        self.x[i] = value[0];
        self.y[i] = value[1];
        self.z[i] = value[2];
    }

    /// Changes the number of values; new ones are zero.
    pub fn resize(&mut self, n: usize) {
        self.x.resize(n, 0.0);
        self.y.resize(n, 0.0);
        self.z.resize(n, 0.0);
    }

    /// Tells whether any particle is farther than `limit` from where it is in `other`, or not a number.
    pub fn differs_beyond(&self, other: &Planes, limit: f32) -> bool {
        let n = self.len();
        let (ax, ay, az) = (&self.x[..n], &self.y[..n], &self.z[..n]);
        let (bx, by, bz) = (&other.x[..n], &other.y[..n], &other.z[..n]);
        let mut beyond = false;
        for i in 0..n {
            let (dx, dy, dz) = (ax[i] - bx[i], ay[i] - by[i], az[i] - bz[i]);
            let within = dx * dx + dy * dy + dz * dz <= limit * limit;
            beyond |= !within;
        }
        beyond
    }
}
