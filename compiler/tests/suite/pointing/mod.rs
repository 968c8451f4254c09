//! Points in every frame: written, read, offered, rejected.

mod answers;
mod frames;
mod prompts;

use crate::common;
use crate::common::Known;
use fab_program::facts::Facts;
use fab_program::pointing::{CoordinateUnit, Frame, Order, Pointing};
use fab_program::{PixelPoint, Program};
use std::sync::LazyLock;

/// Makes a frame of a square picture with this side, sent in another size.
fn frame(unit: CoordinateUnit, order: Order, side: u32, sent: u32) -> Frame {
    Frame {
        unit,
        order,
        size: [side; 2],
        sent: [sent; 2],
    }
}

fn points(of: &[[i32; 2]]) -> Vec<PixelPoint> {
    of.iter().map(|point| PixelPoint::from(*point)).collect()
}

pub fn known() -> Known {
    let corners = points(&[[41, 167], [167, 41], [57, 58], [0, 223]]);
    Known {
        points: vec![("corners", corners), ("center", points(&[[112, 112]]))],
        regions: vec![("cloth", [0, 0, 223, 223])],
        texts: [("instruction".to_owned(), "Fold it".to_owned())].into(),
        last: None,
        unreachable: Vec::new(),
    }
}

/// The small task, compiled once.
fn program() -> &'static Program {
    static PROGRAM: LazyLock<Program> = LazyLock::new(|| common::program("task.fab", common::TASK));
    &PROGRAM
}

fn in_frame<'a>(known: &'a Known, pointing: Pointing) -> Facts<'a> {
    Facts {
        pointing,
        ..known.facts()
    }
}

/// Reads the numbers between brackets without knowing the frame: first, second.
fn numbers(text: &str) -> [f64; 2] {
    let inside = &text[1..text.len() - 1];
    let (first, second) = inside.split_once(", ").unwrap();
    [first.parse().unwrap(), second.parse().unwrap()]
}
