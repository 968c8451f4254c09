//! Tests of arrays: their orders, types and shapes, and what is no array.

use super::*;

#[test]
fn positions_survive_the_file_format() {
    let positions = vec![[0.1, -0.2, 0.3], [f32::MIN_POSITIVE, 4.0, -5.5]];
    assert_eq!(decode(&encode(&positions)), Some(positions));
}

#[test]
fn cut_bytes_are_no_positions() {
    let bytes = encode(&[[0.1, -0.2, 0.3]; 7]);
    for length in 0..bytes.len() {
        assert_eq!(decode(&bytes[..length]), None, "{length} bytes");
    }
}

/// Makes a file with a header as NumPy writes it.
fn file(kind: &str, fortran_order: &str, shape: &str, body: &[u8]) -> Vec<u8> {
    let header =
        format!("{{'descr': {kind}, 'fortran_order': {fortran_order}, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), body].concat()
}

fn little(numbers: impl IntoIterator<Item = f32>) -> Vec<u8> {
    numbers.into_iter().flat_map(f32::to_le_bytes).collect()
}

#[test]
fn arrays_of_each_order_and_type_are_the_same_numbers() {
    let rows: Vec<f32> = (0..24).map(|it| it as f32).collect();
    // Shape (2, 3, 4): the first index runs fastest in a file stored column by column.
    let columns = (0..24).map(|at| rows[at % 2 * 12 + at / 2 % 3 * 4 + at / 6]);
    let columns: Vec<f32> = columns.collect();
    let big = |numbers: &[f32]| numbers.iter().flat_map(|it| it.to_be_bytes()).collect();
    let doubles: Vec<u8> = rows
        .iter()
        .flat_map(|it| f64::from(*it).to_be_bytes())
        .collect();
    let files: [(&str, &str, Vec<u8>); 5] = [
        ("'<f4'", "False", little(rows.clone())),
        ("'<f4'", "True", little(columns.clone())),
        ("'>f4'", "False", big(&rows)),
        ("'>f4'", "True", big(&columns)),
        ("'>f8'", "False", doubles),
    ];
    let wanted: Vec<f64> = rows.iter().map(|it| f64::from(*it)).collect();
    for (kind, order, body) in files {
        let bytes = file(kind, order, "(2, 3, 4)", &body);
        let decoded = decode_floats(&bytes);
        assert_eq!(
            decoded,
            Ok((vec![2, 3, 4], wanted.clone())),
            "{kind} {order}"
        );
    }
    let empty = file("'<f4'", "True", "(0, 3)", &[]);
    assert_eq!(decode_positions(&empty), Ok(Vec::new()));
}

#[test]
fn positions_with_an_inverse_mass_lose_it() {
    let rows = little([0.1, 0.2, 0.3, 1.0, 0.4, 0.5, 0.6, 0.0]);
    let columns = little([0.1, 0.4, 0.2, 0.5, 0.3, 0.6, 1.0, 0.0]);
    let wanted = Some(vec![[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]);
    assert_eq!(decode(&file("'<f4'", "False", "(2, 4)", &rows)), wanted);
    assert_eq!(decode(&file("'<f4'", "True", "(2, 4)", &columns)), wanted);
}

#[test]
fn what_cannot_be_read_says_its_true_reason() {
    let halves = file("'<f2'", "False", "(900, 3)", &[0; 5400]);
    let objects = file("'|O'", "False", "(4, 3)", b"\x80\x04]q\0.");
    let whole = file("'<i8'", "False", "(2, 3)", &[0; 48]);
    let flat = file("'<f4'", "False", "(12,)", &[0; 48]);
    let rows: [(&[u8], &str); 7] = [
        (&halves, "its numbers are of type '<f2'"),
        (&objects, "its numbers are of type '|O'"),
        (&whole, "its numbers are of type '<i8'"),
        (&flat, "it has the shape [12], not [particles, 3]"),
        (b"PK\x03\x04\x14\0", "it is a zip archive, such as `.npz`"),
        (b"\x80\x04\x95", "it is a Python pickle"),
        (b"0.1 0.2 0.3", "it does not begin as a .npy file does"),
    ];
    for (bytes, reason) in rows {
        let why = decode_positions(bytes).expect_err(reason);
        assert!(why.starts_with(reason), "{why}");
    }
}
