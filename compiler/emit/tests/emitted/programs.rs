//! Programs for testing the emitted verifiers: shipped ones, and two that use everything there is.

use super::common::{TASK, program, workspace};
use Comparison::{AtLeast, AtMost, Greater, Less};
use fab_compiler::{LoadError, Loader};
use fab_program::{
    ActionField, Check, Choices, Comparison, Condition, Direction, End, Extractor, Heading,
    Keypoint, Length, LengthChoice, LengthUnit, Moment, Number, Point, PointMeasure, Program,
    Template,
};

/// Reads the files of the shipped tasks.
struct Shipped;

impl Loader for Shipped {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(workspace().join(name)).map_err(|error| LoadError {
            message: error.to_string(),
        })
    }
}

/// Returns a shipped program.
pub fn shipped(task: &str) -> Program {
    let mut compiled = fab_compiler::compile(&format!("tasks/{task}.fab"), &Shipped).unwrap();
    compiled.programs.remove(0)
}

/// Returns the programs of `fixtures/truth` that are written above their tables, each with its table.
pub fn written() -> Vec<(Program, String)> {
    let folder = workspace().join("compiler/emit/tests/fixtures/truth");
    let files = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    let texts = files
        .iter()
        .map(|file| std::fs::read_to_string(file).unwrap());
    texts
        .filter_map(|text| {
            let (task, table) = text.split_once("---\n")?;
            Some((program("task.fab", task), table.to_owned()))
        })
        .collect()
}

/// Returns every program, by name.
pub fn all() -> Vec<Program> {
    let written = written().into_iter().map(|(program, _)| program);
    let made = [
        shipped("double_straight"),
        shipped("double_triangle"),
        steered(),
        placed(),
        boxed(),
    ];
    made.into_iter().chain(written).collect()
}

/// Returns the program of that name.
pub fn named(name: &str) -> Program {
    let found = all().into_iter().find(|program| program.task == name);
    found.unwrap_or_else(|| panic!("there is no program {name}"))
}

/// A task whose action has a direction and a length, and words that are reserved in Rust and Python.
pub fn steered() -> Program {
    let mut program = base("steered");
    let px_per_m = program.camera.px_per_m();
    program.keypoints.push(Keypoint {
        name: "frame".to_owned(),
        moment: Moment::Now,
        extractor: Extractor::BoundingBox {
            mask: "cloth".to_owned(),
        },
    });
    let degrees = [
        0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0, 350.0, 10.0,
    ];
    program.actions = vec![
        field("pick", points(&["corners"])),
        field(
            "direction",
            Choices::Directions {
                choices: degrees.map(direction).to_vec(),
            },
        ),
        field(
            "distance",
            Choices::Lengths {
                unit: LengthUnit::find("cm").unwrap(),
                choices: [(2.0, 0.02), (2.05, 0.0205), (5.5, 0.055), (10.0, 0.1)]
                    .map(|(value, m)| LengthChoice { value, m })
                    .to_vec(),
            },
        ),
        field("grip", words(&["soft", "firm", "say \"é\" {{\n\\"])),
        field("type", words(&["a", "b"])),
    ];
    let steer = || Heading::Field {
        field: "direction".to_owned(),
    };
    let metres = |scale| Length::Field {
        field: "distance".to_owned(),
        scale,
    };
    let mirrored = mirror(chosen("pick"), keypoint("center"));
    let landing = Point::Carried {
        from: Box::new(chosen("pick")),
        direction: "direction".to_owned(),
        distance: "distance".to_owned(),
        px_per_m,
    };
    program.verify.checks = vec![
        check("on_cloth", None, within(chosen("pick"), "cloth", 3.0)),
        check(
            "ahead",
            None,
            angle(
                steer(),
                from_to(chosen("pick"), keypoint("center")),
                AtMost,
                60.0,
            ),
        ),
        check(
            "turn",
            Some(Condition::Last),
            angle(
                steer(),
                Heading::Last {
                    field: "direction".to_owned(),
                },
                Less,
                90.0,
            ),
        ),
        check(
            "east",
            None,
            Condition::Any {
                of: vec![
                    angle(
                        steer(),
                        Heading::Constant { vector: [1.0, 0.0] },
                        AtLeast,
                        10.5,
                    ),
                    word("grip", "soft"),
                ],
            },
        ),
        check("lands", None, within(landing, "frame", 0.0)),
        check("long", None, lengths(metres(1.0), Greater, constant(0.02))),
        check(
            "short",
            None,
            lengths(metres(px_per_m), AtMost, distance(chosen("pick"), mirrored)),
        ),
        check(
            "lambda",
            Some(Condition::Not {
                of: Box::new(word("type", "a")),
            }),
            Condition::Not {
                of: Box::new(Condition::Any {
                    of: vec![
                        word("grip", "say \"é\" {{\n\\"),
                        number(Number::Step, Greater, 5.0),
                    ],
                }),
            },
        ),
    ];
    program.verify.relaxed = vec!["ahead".to_owned(), "lands".to_owned()];
    program
}

/// A task whose action has two points, with numbers, mirrored points and the previous action.
pub fn placed() -> Program {
    let mut program = base("placed");
    program.actions = vec![
        field("pick", points(&["corners"])),
        field("place", points(&["corners", "center"])),
        field("lambda", words(&["yes", "no"])),
    ];
    let coverage = || Number::Coverage {
        mask: "cloth".to_owned(),
        flat_px: 700.0,
    };
    let count = Number::Count {
        keypoint: "corners".to_owned(),
    };
    let last = |end| Point::Last { end };
    let opposite = mirror(chosen("place"), keypoint("center"));
    let forth = from_to(chosen("pick"), chosen("place"));
    let back = from_to(chosen("place"), chosen("pick"));
    let down = Heading::Constant { vector: [0.0, 1.0] };
    program.verify.checks = vec![
        check("many", None, number(count, AtLeast, 3.0)),
        check("early", None, number(Number::Step, Less, 7.0)),
        check(
            "open",
            None,
            all_of(vec![
                number(coverage(), Greater, 0.25),
                number(coverage(), AtMost, 0.8),
            ]),
        ),
        check(
            "far",
            None,
            lengths(
                distance(chosen("pick"), chosen("place")),
                AtLeast,
                constant(10.0),
            ),
        ),
        check(
            "near",
            None,
            lengths(
                constant(35.0),
                Greater,
                distance(chosen("pick"), chosen("place")),
            ),
        ),
        check(
            "fresh",
            Some(Condition::Last),
            all_of(vec![
                lengths(
                    distance(chosen("pick"), last(End::Place)),
                    Greater,
                    constant(4.0),
                ),
                lengths(
                    distance(chosen("place"), last(End::Pick)),
                    AtLeast,
                    constant(3.0),
                ),
            ]),
        ),
        check(
            "opposite",
            Some(number(Number::Step, Greater, 1.0)),
            Condition::Any {
                of: vec![
                    Condition::Not {
                        of: Box::new(Condition::Last),
                    },
                    lengths(distance(last(End::Pick), opposite), Less, constant(25.0)),
                ],
            },
        ),
        check(
            "aside",
            None,
            all_of(vec![
                angle(
                    forth,
                    from_to(chosen("pick"), keypoint("center")),
                    Greater,
                    0.0,
                ),
                angle(back, down, AtLeast, 90.0),
            ]),
        ),
    ];
    program.verify.relaxed = vec!["aside".to_owned()];
    program
}

/// A pick anywhere on the cloth, and half boxes around the last place and its mirror.
fn boxed() -> Program {
    let place = || Point::Last { end: End::Place };
    let reach = |b| of_points("chebyshev", chosen("pick"), b);
    let mirrored = mirror(place(), keypoint("center"));
    let apart = all_of(vec![
        lengths(reach(place()), Greater, constant(50.0)),
        lengths(reach(mirrored), AtLeast, constant(50.0)),
    ]);
    let mut program = base("boxed");
    program.actions[0].choices = Choices::Region {
        mask: "cloth".to_owned(),
    };
    program.verify.checks = vec![check("apart", Some(Condition::Last), apart)];
    program
}

fn base(task: &str) -> Program {
    let mut program = program("task.fab", TASK);
    program.task = task.to_owned();
    program.templates.push(Template {
        name: "refused".to_owned(),
        when: None,
        text: "Choose again.".to_owned(),
        variables: Vec::new(),
        declared_in: "task.fab".to_owned(),
        line: 1,
    });
    program
}

fn field(name: &str, choices: Choices) -> ActionField {
    ActionField {
        name: name.to_owned(),
        choices,
    }
}

fn points(keypoints: &[&str]) -> Choices {
    Choices::Points {
        keypoints: keypoints.iter().map(|name| (*name).to_owned()).collect(),
    }
}

fn words(choices: &[&str]) -> Choices {
    Choices::Words {
        choices: choices.iter().map(|word| (*word).to_owned()).collect(),
    }
}

fn direction(deg: f64) -> Direction {
    let vector = match deg {
        0.0 => [1.0, 0.0],
        90.0 => [0.0, -1.0],
        180.0 => [-1.0, 0.0],
        270.0 => [0.0, 1.0],
        _ => [deg.to_radians().cos(), -deg.to_radians().sin()],
    };
    Direction { deg, vector }
}

/// Makes a check whose message says nothing about the scene.
pub fn check(name: &str, when: Option<Condition>, holds: Condition) -> Check {
    Check {
        name: name.to_owned(),
        when,
        holds,
        message: "refused".to_owned(),
    }
}

pub fn number(left: Number, is: Comparison, limit: f64) -> Condition {
    Condition::Number { left, is, limit }
}

fn all_of(of: Vec<Condition>) -> Condition {
    Condition::All { of }
}

fn word(field: &str, is: &str) -> Condition {
    Condition::Word {
        field: field.to_owned(),
        is: is.to_owned(),
    }
}

fn within(point: Point, region: &str, margin_px: f64) -> Condition {
    Condition::Within {
        point,
        region: region.to_owned(),
        margin_px,
    }
}

fn lengths(left: Length, is: Comparison, right: Length) -> Condition {
    Condition::Lengths { left, is, right }
}

fn angle(a: Heading, b: Heading, is: Comparison, limit_deg: f64) -> Condition {
    let limit_cos = match limit_deg {
        90.0 => 0.0,
        _ => limit_deg.to_radians().cos(),
    };
    Condition::Angle {
        a,
        b,
        is,
        limit_deg,
        limit_cos,
    }
}

fn constant(value: f64) -> Length {
    Length::Constant { value }
}

fn distance(a: Point, b: Point) -> Length {
    of_points("distance", a, b)
}

fn of_points(measure: &str, a: Point, b: Point) -> Length {
    Length::OfPoints(PointMeasure::new(measure, vec![a, b]).unwrap())
}

fn from_to(from: Point, to: Point) -> Heading {
    Heading::FromTo { from, to }
}

fn chosen(field: &str) -> Point {
    Point::Action {
        field: field.to_owned(),
    }
}

fn keypoint(name: &str) -> Point {
    Point::Keypoint {
        name: name.to_owned(),
    }
}

fn mirror(of: Point, about: Point) -> Point {
    Point::Mirror {
        of: Box::new(of),
        about: Box::new(about),
    }
}
