use sim::*;
fn main() {
    let n: usize = std::env::args()
        .nth(1)
        .map(|s| s.parse().unwrap())
        .unwrap_or(50);
    let r: usize = std::env::args()
        .nth(2)
        .map(|s| s.parse().unwrap())
        .unwrap_or(3);
    for _ in 0..r {
        let t = std::time::Instant::now();
        let c = diagonal_fold(
            Grid::new(n, n, 0.00625).unwrap(),
            &Params::default(),
            &|| false,
        )
        .unwrap();
        let s = t.elapsed().as_secs_f64();
        println!(
            "{} steps {} ms/step {:.3} digest {}",
            n,
            c.steps(),
            1000. * s / c.steps() as f64,
            &c.digest()[..16]
        );
    }
}
