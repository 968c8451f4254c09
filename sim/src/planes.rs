//! Vectors of many particles, kept as one plane per coordinate.
//!
//! Loops over contiguous planes are what the compiler turns into SIMD code;
//! loops over `[x, y, z]` triples are not.

/// One plane of `[n_particles]` per coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Planes {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
}

impl Planes {
    /// Makes planes of zeros.
    pub fn zeros(n_particles: usize) -> Planes {
        Planes {
            x: vec![0.0; n_particles],
            y: vec![0.0; n_particles],
            z: vec![0.0; n_particles],
        }
    }

    /// Splits points into planes.
    pub fn from_points(points: &[[f32; 3]]) -> Planes {
        Planes {
            x: points.iter().map(|p| p[0]).collect(),
            y: points.iter().map(|p| p[1]).collect(),
            z: points.iter().map(|p| p[2]).collect(),
        }
    }

    /// Returns the points in particle order.
    pub fn to_points(&self) -> Vec<[f32; 3]> {
        (0..self.len()).map(|i| self.get(i)).collect()
    }

    /// Returns the number of particles.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Returns one particle's vector.
    pub fn get(&self, particle: usize) -> [f32; 3] {
        [self.x[particle], self.y[particle], self.z[particle]]
    }

    /// Replaces one particle's vector.
    pub fn set(&mut self, particle: usize, value: [f32; 3]) {
        self.x[particle] = value[0];
        self.y[particle] = value[1];
        self.z[particle] = value[2];
    }

    /// Changes the number of particles; new values are zero.
    pub fn resize(&mut self, n_particles: usize) {
        self.x.resize(n_particles, 0.0);
        self.y.resize(n_particles, 0.0);
        self.z.resize(n_particles, 0.0);
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
