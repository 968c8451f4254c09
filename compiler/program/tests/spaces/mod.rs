//! The action spaces of `answers/spaces.txt`.

#![allow(dead_code, clippy::unwrap_used)]

use fab_program::units::LengthUnit;
use fab_program::{ActionField, Choices, Direction, LengthChoice};

/// The cloth's longer side in all of them, metres.
pub const EDGE_M: f64 = 0.625;

/// Returns the fields of an action space.
pub fn space(name: &str) -> Vec<ActionField> {
    let all = include_str!("../answers/spaces.txt");
    let (_, space) = all.split_once(&format!("= {name}\n")).expect(name);
    let lines = space.lines().take_while(|line| !line.starts_with("= "));
    lines.map(field).collect()
}

fn field(line: &str) -> ActionField {
    let (name, rest) = line.split_once(' ').unwrap();
    let (kind, values) = rest.split_once(' ').unwrap();
    let numbers =
        |values: &str| -> Vec<f64> { values.split(' ').map(|it| it.parse().unwrap()).collect() };
    let choices = match kind {
        "points" => Choices::Points {
            keypoints: values.split(' ').map(str::to_owned).collect(),
        },
        "region" => Choices::Region {
            mask: values.to_owned(),
        },
        "directions" => Choices::Directions {
            choices: numbers(values)
                .into_iter()
                .map(|deg| Direction {
                    deg,
                    vector: [deg.to_radians().cos(), -deg.to_radians().sin()],
                })
                .collect(),
        },
        "lengths" => {
            let (unit, values) = values.split_once(' ').unwrap();
            let unit = LengthUnit::find(unit).unwrap();
            Choices::Lengths {
                unit,
                choices: numbers(values)
                    .into_iter()
                    .map(|value| LengthChoice {
                        value,
                        m: value * unit.size_with(EDGE_M),
                    })
                    .collect(),
            }
        }
        _ => Choices::Words {
            choices: values.split(" | ").map(str::to_owned).collect(),
        },
    };
    ActionField {
        name: name.to_owned(),
        choices,
    }
}
