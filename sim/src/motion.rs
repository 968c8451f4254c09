//! How particles move on their own: free flight, and what speed a substep's displacement amounts to.
//!
//! In and out: one plane of values per coordinate, by slot. The solver says in which order.

#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

/// Tells whether every value is a finite number.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
pub(crate) fn all_finite(values: &[f32]) -> bool {
    values
        .iter()
        .fold(true, |all, value| all & value.is_finite())
}

/// Moves one coordinate of free particles as if nothing touched them.
///
/// - `keep`: share of the velocity that damping leaves; `gain`: what gravity adds to it, m/s.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
pub(crate) fn fly(
    position: &mut [f32],
    velocity: &[f32],
    weight: &[f32],
    dt: f32,
    keep: f32,
    gain: f32,
) {
    let n = position.len();
    let (velocity, weight) = (&velocity[..n], &weight[..n]);
    for i in 0..n {
        position[i] += weight[i] * dt * (keep * velocity[i] + gain);
    }
}

/// Derives velocities from displacements, limits their change, and puts slow particles to sleep that something bears.
///
/// - `support`: by slot, whether another layer touches the particle; the height up to which the table bears one.
/// - `limits`: the largest change of velocity, m/s, and the square of the sleep speed.
// Separate slices, so that the compiler knows that they do not overlap.
#[allow(clippy::too_many_arguments)]
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
pub(crate) fn derive_velocities(
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
    velocities: [&mut [f32]; 3],
    began: [&[f32]; 3],
    support: (&[f32], f32),
    per_dt: f32,
    limits: [f32; 2],
) {
    let n = x.len();
    let ((layered, table_m), [max_change, sleep_2]) = (support, limits);
    let layered = &layered[..n];
    let (y, z) = (&mut y[..n], &mut z[..n]);
    let [vx, vy, vz] = velocities;
    let (vx, vy, vz) = (&mut vx[..n], &mut vy[..n], &mut vz[..n]);
    let (x0, y0, z0) = (&began[0][..n], &began[1][..n], &began[2][..n]);
    for i in 0..n {
        let ux = (x[i] - x0[i]) * per_dt - vx[i];
        let uy = (y[i] - y0[i]) * per_dt - vy[i];
        let uz = (z[i] - z0[i]) * per_dt - vz[i];
        let change = (ux * ux + uy * uy + uz * uz).sqrt();
        let share = if change > max_change {
            max_change / change
        } else {
            1.0
        };
        let wx = vx[i] + share * ux;
        let wy = vy[i] + share * uy;
        let wz = vz[i] + share * uz;
        let supported = (layered[i] > 0.0) | (z[i] < table_m);
        let sleeps = (wx * wx + wy * wy + wz * wz < sleep_2) & supported;
        x[i] = if sleeps { x0[i] } else { x[i] };
        y[i] = if sleeps { y0[i] } else { y[i] };
        z[i] = if sleeps { z0[i] } else { z[i] };
        vx[i] = if sleeps { 0.0 } else { wx };
        vy[i] = if sleeps { 0.0 } else { wy };
        vz[i] = if sleeps { 0.0 } else { wz };
    }
}
