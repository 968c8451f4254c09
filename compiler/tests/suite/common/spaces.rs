//! Programs that declare only an action space, read from the answers that the tests of `fab-program` collect.
//!
//! A space begins with `= NAME`. One field per line: `NAME points KEYPOINT…`, `NAME region MASK`, `NAME directions DEGREES…`,
//! `NAME lengths UNIT NUMBER…`, `NAME words WORD | WORD…`. The cloth's longer side is 625 mm.

#![allow(dead_code, clippy::unwrap_used)]

use fab_program::{
    ActionField, Choices, Cloth, ClothStart, Direction, Exhausted, LengthChoice, LengthUnit,
    Program, Verify,
};
use std::sync::LazyLock;

/// The cloth's longer side, metres.
pub const EDGE_M: f64 = 0.625;

/// Reads an action space.
pub fn space(name: &str) -> Program {
    let file = super::common::workspace().join("compiler/program/tests/answers/spaces.txt");
    let spaces = std::fs::read_to_string(&file).unwrap();
    let (_, space) = spaces.split_once(&format!("= {name}\n")).expect(name);
    let lines = space.lines().take_while(|line| !line.starts_with("= "));
    program(lines.map(field).collect())
}

/// Reads one line.
pub fn field(line: &str) -> ActionField {
    let (name, rest) = line.split_once(' ').unwrap();
    let (kind, rest) = rest.split_once(' ').unwrap();
    let numbers = |text: &str| -> Vec<f64> {
        text.split_whitespace()
            .map(|number| number.parse().unwrap())
            .collect()
    };
    let choices = match kind {
        "points" => Choices::Points {
            keypoints: rest.split_whitespace().map(str::to_owned).collect(),
        },
        "region" => Choices::Region {
            mask: rest.to_owned(),
        },
        "directions" => directions(&numbers(rest)),
        "lengths" => {
            let (unit, rest) = rest.split_once(' ').unwrap();
            let unit = LengthUnit::find(unit).unwrap();
            lengths(unit, &numbers(rest))
        }
        "words" => Choices::Words {
            choices: rest.split(" | ").map(str::to_owned).collect(),
        },
        _ => panic!("no kind `{kind}`"),
    };
    ActionField {
        name: name.to_owned(),
        choices,
    }
}

/// Offers directions.
pub fn directions(degrees: &[f64]) -> Choices {
    let choice = |deg: &f64| {
        let (sine, cosine) = deg.to_radians().sin_cos();
        Direction {
            deg: *deg,
            vector: [cosine, -sine],
        }
    };
    Choices::Directions {
        choices: degrees.iter().map(choice).collect(),
    }
}

/// Offers lengths.
pub fn lengths(unit: LengthUnit, values: &[f64]) -> Choices {
    let choice = |value: &f64| LengthChoice {
        value: *value,
        m: value * unit.size_with(EDGE_M),
    };
    Choices::Lengths {
        unit,
        choices: values.iter().map(choice).collect(),
    }
}

/// Returns a program with these fields.
pub fn program(actions: Vec<ActionField>) -> Program {
    static COMPILED: LazyLock<Program> =
        LazyLock::new(|| super::common::program("task.fab", super::common::TASK));
    let program = COMPILED.clone();
    Program {
        task: "test".to_owned(),
        sources: Vec::new(),
        cloth: Cloth {
            dimx: 51,
            dimy: 41,
            spacing_m: EDGE_M / 50.0,
            start: ClothStart::Flat,
            material: None,
        },
        subgoals: None,
        experts: Vec::new(),
        keypoints: Vec::new(),
        layers: Vec::new(),
        actions,
        templates: Vec::new(),
        stages: Vec::new(),
        demos: None,
        verify: Verify {
            result: None,
            checks: Vec::new(),
            attempts: 1,
            relaxed: Vec::new(),
            with_picture: false,
            exhausted: Exhausted::Ends,
        },
        horizon: 1,
        goal: None,
        ..program
    }
}
