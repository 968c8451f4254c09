//! The cloth's triangles and its `.obj` text.

use fab_sim::mesh::{self, MeshError};
use fab_sim::{Grid, Mask, Params};
use proptest::prelude::*;
use std::io::Write;
use std::process::{Command, Stdio};

fn twice_signed_area(positions: &[[f32; 3]], [a, b, c]: [usize; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|index| positions[index].map(f64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[test]
fn a_cell_becomes_two_triangles_and_diagonals_alternate() {
    let mask = Mask::parse("###\n###\n", 0.01).unwrap();
    assert_eq!(
        mesh::triangles(&mask),
        [[0, 4, 1], [0, 3, 4], [1, 4, 2], [2, 4, 5]]
    );
    // A cell with only three corners has none.
    let mask = Mask::parse("###\n###\n##.\n", 0.01).unwrap();
    assert_eq!(mesh::triangles(&mask).len(), 6);
}

#[test]
fn the_text_of_a_small_mesh_is_exactly_this() {
    let mask = Mask::parse("###\n###\n.##\n", 0.01).unwrap();
    let mut positions = mask.grid().flat_positions(&Params::default());
    positions[4][2] = 0.1;
    // The missing one is never read.
    positions[6] = [f32::NAN; 3];
    let expected = "\
# Cloth: metres, z up.
o cloth
v -0.01 0.01 0.005
v 0 0.01 0.005
v 0.01 0.01 0.005
v -0.01 0 0.005
v 0 0 0.1
v 0.01 0 0.005
v 0 -0.01 0.005
v 0.01 -0.01 0.005
vt 0 1
vt 0.5 1
vt 1 1
vt 0 0.5
vt 0.5 0.5
vt 1 0.5
vt 0.5 0
vt 1 0
f 1/1 5/5 2/2
f 1/1 4/4 5/5
f 2/2 5/5 3/3
f 3/3 5/5 6/6
f 5/5 8/8 6/6
f 5/5 7/7 8/8
";
    assert_eq!(mesh::obj(&mask, &positions), Ok(expected.to_owned()));
}

#[test]
fn positions_that_are_no_mesh_are_refused_with_their_values() {
    let mask = Mask::full(Grid::new(3, 3, 0.01).unwrap());
    let mut positions = mask.grid().flat_positions(&Params::default());
    positions[5][1] = f32::INFINITY;
    assert_eq!(
        mesh::obj(&mask, &positions),
        Err(MeshError::NonFinite {
            particle: 5,
            value: f32::INFINITY
        })
    );
    positions.pop();
    let error = mesh::obj(&mask, &positions).unwrap_err();
    assert_eq!(
        error,
        MeshError::WrongCount {
            expected: 9,
            got: 8
        }
    );
}

#[test]
#[ignore = "needs Python with trimesh"]
fn peer_trimesh_reads_the_mesh_of_a_square_with_a_hole() {
    let python = std::env::var_os("FABC_PEER_PYTHON").expect("make test-all names a Python");
    let outline = include_str!("../../outlines/square_with_hole.txt");
    let mask = Mask::parse(outline, 0.00625).unwrap();
    let positions = mask.grid().flat_positions(&Params::default());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/peers/read_mesh.py");
    let mut reader = Command::new(python)
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let text = mesh::obj(&mask, &positions).unwrap();
    let mut input = reader.stdin.take().unwrap();
    input.write_all(text.as_bytes()).unwrap();
    drop(input);
    let output = reader.wait_with_output().unwrap();
    assert!(output.status.success());
    let read: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(read["vertices"], mask.count());
    assert_eq!(read["faces"], mesh::triangles(&mask).len());
    assert_eq!(read["faces_up"], true, "{read}");
    assert_eq!(read["winding_agrees"], true, "{read}");
    assert_eq!(read["euler_number"], 0, "{read}");
    let number = |pointer: &str| read.pointer(pointer).unwrap().as_f64().unwrap();
    assert!((number("/area_m2") - mesh::flat_area_m2(&mask)).abs() < 1e-6);
    for (pointer, expected) in [
        ("/bounds_m/0/0", -0.153125),
        ("/bounds_m/0/2", 0.005),
        ("/bounds_m/1/1", 0.153125),
        ("/uv_of_back_right/0", 1.0),
        ("/uv_of_back_right/1", 1.0),
    ] {
        assert!(
            (number(pointer) - expected).abs() < 1e-6,
            "{pointer}: {read}"
        );
    }
}

/// Masks of many sizes: frames and whole rectangles.
fn masks() -> impl Strategy<Value = Mask> {
    let hole = (6usize..20, 6usize..20, 1usize..4).prop_map(|(dimx, dimy, rim)| {
        let grid = Grid::new(dimx, dimy, 0.01).unwrap();
        let rim = rim + 1;
        Mask::from_fn(grid, |ix, iy| {
            ix < rim || iy < rim || ix + rim >= dimx || iy + rim >= dimy
        })
        .unwrap()
    });
    let full = (2usize..20, 2usize..20)
        .prop_map(|(dimx, dimy)| Mask::full(Grid::new(dimx, dimy, 0.01).unwrap()));
    prop_oneof![hole, full]
}

proptest! {
    /// The flat cloth's triangles face up, and their areas add up to the area of the cloth.
    #[test]
    fn triangles_face_up_and_fill_the_flat_cloth(mask in masks()) {
        let positions = mask.grid().flat_positions(&Params::default());
        let triangles = mesh::triangles(&mask);
        let mut area_m2 = 0.0;
        for &corners in &triangles {
            prop_assert!(corners.iter().all(|&corner| mask.has(corner)));
            let twice = twice_signed_area(&positions, corners);
            prop_assert!((twice - 1e-4).abs() < 1e-8, "{corners:?}: {twice}");
            area_m2 += 0.5 * twice;
        }
        let flat_m2 = mesh::flat_area_m2(&mask);
        prop_assert!((area_m2 - flat_m2).abs() < 1e-5 * flat_m2, "{area_m2} {flat_m2}");
    }

    /// When read back, the text has every existing particle's bits and as many faces as there are triangles.
    #[test]
    fn the_text_reads_back_to_the_same_bits(mask in masks(), scale in -1e3f32..1e3) {
        let mut positions = mask.grid().flat_positions(&Params::default());
        for point in &mut positions {
            *point = point.map(|value| value * scale);
        }
        let text = mesh::obj(&mask, &positions).unwrap();
        let read: Vec<[f32; 3]> = text
            .lines()
            .filter_map(|line| line.strip_prefix("v "))
            .map(|line| {
                let numbers: Vec<f32> = line.split(' ').map(|word| word.parse().unwrap()).collect();
                numbers.try_into().unwrap()
            })
            .collect();
        let there = (0..positions.len()).filter(|&index| mask.has(index));
        let expected: Vec<[f32; 3]> = there.map(|index| positions[index]).collect();
        prop_assert_eq!(read, expected);
        let n_faces = text.lines().filter(|line| line.starts_with("f ")).count();
        prop_assert_eq!(n_faces, mesh::triangles(&mask).len());
    }
}
