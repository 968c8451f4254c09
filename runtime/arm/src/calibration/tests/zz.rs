//! Temporary.
use super::*;
type Change = fn(&mut Vec<Pair>);
const ROBOT: &str = "\
name = \"lab\"
model = \"j2n6s200\"
driver = \"simulated\"
calibration = \"lab.toml\"

[table]
center_m = [0.45, 0.0, 0.02]

[workspace]
min_m = [0.15, -0.525, 0.01]
max_m = [0.75, 0.525, 0.5]
rest_m = [0.30, -0.40, 0.25]

[fingers]
count = 2
open = 0.0
closed = 6400.0
tolerance = 200.0

[camera]
source = \"directory\"
folder = \"shots\"
window_px = [80, 0, 480]

[camera.intrinsics]
size_px = [640, 480]
focal_px = [600.0, 600.0]
middle_px = [320.0, 240.0]
";

/// The arm's reading at a pixel, with the camera a metre above; off by half a millimetre in varying directions.
fn touched(pixel: [f64; 2], index: i32) -> Pair {
    let off = |salt: i32| f64::from((index * 7 + salt) % 5 - 2) * 0.00025;
    let round = |number: f64| (number * 10_000.0).round() / 10_000.0;
    let base_m = [
        round(0.45 - (pixel[1] - 240.0) / 600.0 + off(1)),
        round(-(pixel[0] - 320.0) / 600.0 + off(3)),
        round(0.02 + off(0)),
    ];
    Pair { pixel, base_m }
}


#[test]
fn zz_prints() {
    let cases: [(&str, Change); 9] = [
        ("a point 23 mm off", |it| it[6].base_m[0] += 0.023),
        ("a pixel swapped", |it| it[1].pixel.reverse()),
        ("a sign lost", |it| it[3].base_m[1] *= -1.0),
        ("all x and y swapped", |it| {
            it.iter_mut().for_each(|it| it.base_m.swap(0, 1))
        }),
        ("both signs lost", |it| {
            it.iter_mut()
                .for_each(|it| (it.base_m[0], it.base_m[1]) = (-it.base_m[0], -it.base_m[1]))
        }),
        ("millimetres", |it| {
            it.iter_mut()
                .for_each(|it| it.base_m = it.base_m.map(|m| (m * 1000.0).round()))
        }),
        ("two rows 25 mm apart", |it| {
            *it = (0..16)
                .map(|n| {
                    touched(
                        [
                            100.0 + f64::from(n % 8) * 60.0,
                            230.0 + 15.0 * f64::from(n / 8),
                        ],
                        n,
                    )
                })
                .collect()
        }),
        ("one line", |it| {
            *it = (0..16)
                .map(|n| touched([100.0 + f64::from(n) * 30.0, 230.0], 0))
                .collect()
        }),
        ("seven points", |it| it.truncate(7)),
    ];

    let pairs = (0..16).map(|index| {
        let at = |step: i32| 0.1 + 0.8 * f64::from(step) / 3.0;
        touched([80.0 + 480.0 * at(index % 4), 480.0 * at(index / 4)], index)
    });
    let pairs: Vec<Pair> = pairs.collect();
    let settings = Settings::parse(ROBOT).unwrap();
    let terms = Terms { limit_mm: LIMIT_MM, size_px: [640, 480], intrinsics: settings.camera.intrinsics.clone() };
    let good = Calibration::make(terms.clone(), pairs.clone(), "2026-11-22", None).unwrap();
    println!("{:?} {} {:?}", good.left_out_mm, good.left_out_rms_mm(), good.over_table(&settings));
    for (name, change) in cases {
        let mut pairs = pairs.clone();
        change(&mut pairs);
        let said = Calibration::make(terms.clone(), pairs, "2026-11-22", None).and_then(|it| it.over_table(&settings));
        println!("{name}:\nerror: the points are refused and no calibration is written\n{}\n`lab.points.png` shows the points\n", said.unwrap_err());
    }
    let shipped = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for robot in ["tests/fixtures/arms/seven.toml", "tasks/real/simulated.toml"] {
        let files = crate::world::Files::load(&shipped.join(robot)).unwrap();
        println!("{robot} {:?} {}", files.calibration.over_table(&files.settings), files.calibration.left_out_rms_mm());
    }
}
