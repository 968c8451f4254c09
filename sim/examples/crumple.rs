//! Crumples a cloth by several seeds, prints what came of each, and draws it.
//!
//! `cargo run --example crumple -- DIMX DIMY SEEDS [FOLDER]`; the pictures are `FOLDER/SEED.png`.

use sim::{Grid, Look, Params, Simulator, TopDownCamera};
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [dimx, dimy, seeds, rest @ ..] = arguments.as_slice() else {
        return Err("usage: crumple DIMX DIMY SEEDS [FOLDER]".into());
    };
    let grid = Grid::new(dimx.parse()?, dimy.parse()?, 0.00625)?;
    for seed in 0..seeds.parse()? {
        let mut cloth = Simulator::flat(grid, &Params::default());
        let began = Instant::now();
        let done = cloth.crumple(seed, &|| false)?;
        let secs = began.elapsed().as_secs_f64();
        let positions = cloth.positions();
        for _ in 0..100 {
            cloth.step()?;
        }
        let after = cloth.positions();
        let stretch = stretches(grid, &positions);
        println!(
            "seed {seed:3}: particle {:4} by {:.2} m, {:4} steps, {secs:5.2} s, covers {:.3}, height {:.1} mm, \
             stretch mean {:.4} max {:.3}, moves {:.2} mm in the next second",
            done.lifts[0].particle,
            done.lifts[0].height_m,
            done.steps,
            coverage(grid, &positions)?,
            1000.0 * positions.iter().fold(0.0, |high: f32, p| high.max(p[2])),
            stretch.iter().sum::<f32>() / stretch.len() as f32,
            stretch.iter().fold(0.0, |most: f32, s| most.max(*s)),
            1000.0 * farthest(&positions, &after),
        );
        if let Some(folder) = rest.first() {
            draw(
                grid,
                &positions,
                &Path::new(folder).join(format!("{seed}.png")),
            )?;
        }
    }
    Ok(())
}

/// Returns the share of its own flat area that a cloth covers, seen from 10 m above.
fn coverage(grid: Grid, positions: &[[f32; 3]]) -> Result<f32, Box<dyn std::error::Error>> {
    let camera = TopDownCamera::new(10.0, 0.06, 512)?;
    let frame = camera.render(grid, positions, &Look::default());
    let pixels = frame.depth_m.iter().filter(|depth| **depth < 9.998).count();
    let metres_a_pixel = 10.0 / camera.focal_px();
    let flat_m2 = (grid.dimx - 1) as f32 * (grid.dimy - 1) as f32 * grid.spacing_m.powi(2);
    Ok(pixels as f32 * metres_a_pixel.powi(2) / flat_m2)
}

/// Returns the length of every edge over its length at rest.
fn stretches(grid: Grid, positions: &[[f32; 3]]) -> Vec<f32> {
    let length = |a: usize, b: usize| {
        let square = |axis: usize| (positions[a][axis] - positions[b][axis]).powi(2);
        (square(0) + square(1) + square(2)).sqrt() / grid.spacing_m
    };
    let mut all = Vec::new();
    for index in 0..positions.len() {
        if index % grid.dimx + 1 < grid.dimx {
            all.push(length(index, index + 1));
        }
        if index + grid.dimx < positions.len() {
            all.push(length(index, index + grid.dimx));
        }
    }
    all
}

/// Returns the longest way of any particle, metres.
fn farthest(from: &[[f32; 3]], to: &[[f32; 3]]) -> f32 {
    let way = |(p, q): (&[f32; 3], &[f32; 3])| {
        let square = |axis: usize| (p[axis] - q[axis]).powi(2);
        (square(0) + square(1) + square(2)).sqrt()
    };
    from.iter().zip(to).map(way).fold(0.0, f32::max)
}

fn draw(grid: Grid, positions: &[[f32; 3]], path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let camera = TopDownCamera::new(0.65, 45f32.to_radians(), 448)?;
    let frame = camera.render(grid, positions, &Look::default());
    let file = std::fs::File::create(path)?;
    let mut encoder = png::Encoder::new(file, frame.width, frame.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&frame.rgb)?;
    Ok(())
}
