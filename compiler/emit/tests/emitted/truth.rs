//! Reads the truth tables in `fixtures/truth`, which were worked out by hand.
//!
//! A file may contain a task, then `---`, then its table; new files are found automatically. The other tables are for
//! the programs of [`super::programs`].
//!
//! A line sets a fact for the lines after it, or judges an action:
//!
//! ```text
//! corners = 10,10 90,10            points; nothing behind the sign: none found
//! region cloth = 0,0 100,100       two corners, both included
//! area cloth = 5000
//! step = 2
//! last = 10,10 90,10 45deg         pick, place, the directions; `none`
//! without center                   the scene lacks it
//! judge pick=10,10 place=90,10: accept / accept
//! ```

use super::case::{Case, Scene};
use fab_program::Proposal;
use fab_program::facts::ExecutedAction;
use fab_program::{Choices, PixelPoint, Program, Value};

/// Returns each case with its line, its verdict, and its verdict with fewer checks.
pub fn read(program: &Program, text: &str) -> Vec<(String, Case, [String; 2])> {
    let mut state = Case {
        scene: Scene::default(),
        step: 1,
        last: None,
        proposal: Proposal::default(),
    };
    let mut cases = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        if line.starts_with('#') {
            continue;
        }
        if let Some(judged) = line.strip_prefix("judge ") {
            let (action, verdicts) = judged.split_once(": ").unwrap();
            let (full, relaxed) = verdicts.split_once(" / ").unwrap();
            let mut case = state.clone();
            case.proposal = proposal(program, action);
            let expected = [full, relaxed].map(|it| match it {
                "accept" => it.to_owned(),
                it if it.starts_with("missing:") => it.to_owned(),
                it => format!("check:{it}"),
            });
            cases.push((line.to_owned(), case, expected));
        } else if let Some(name) = line.strip_prefix("without ") {
            state.scene.points.remove(name);
            state.scene.regions.remove(name);
            state.scene.areas.remove(name);
        } else {
            set(program, &mut state, line);
        }
    }
    cases
}

fn set(program: &Program, state: &mut Case, line: &str) {
    let (what, value) = line.split_once(" =").unwrap_or_else(|| panic!("{line}"));
    let words: Vec<&str> = value.split_whitespace().collect();
    match what.split_once(' ') {
        Some(("region", name)) => {
            let (a, b) = (point(words[0]), point(words[1]));
            state
                .scene
                .regions
                .insert(name.to_owned(), [a.u, a.v, b.u, b.v]);
        }
        Some(("area", name)) => {
            state
                .scene
                .areas
                .insert(name.to_owned(), words[0].parse().unwrap());
        }
        None if what == "step" => state.step = words[0].parse().unwrap(),
        None if what == "last" => {
            state.last = (words[0] != "none").then(|| ExecutedAction {
                pick: point(words[0]),
                place: point(words[1]),
                proposal: turned(program, &words[2..]),
            });
        }
        None => {
            let points = words.iter().map(|word| point(word)).collect();
            state.scene.points.insert(what.to_owned(), points);
        }
        Some(_) => panic!("{line}"),
    }
}

/// Returns an action of which only the directions are known.
fn turned(program: &Program, words: &[&str]) -> Proposal {
    let directions = program
        .actions
        .iter()
        .filter(|field| matches!(field.choices, Choices::Directions { .. }));
    let fields = directions.zip(words).map(|(field, word)| {
        let deg = word.strip_suffix("deg").unwrap().parse().unwrap();
        (field.name.clone(), Value::Direction { deg })
    });
    Proposal {
        fields: fields.collect(),
    }
}

fn proposal(program: &Program, action: &str) -> Proposal {
    let fields = action.split(' ').map(|stated| {
        let (name, value) = stated.split_once('=').unwrap();
        let value = match &program.field(name).unwrap().choices {
            Choices::Points { .. } | Choices::Region { .. } => Value::Point(point(value)),
            Choices::Directions { .. } => Value::Direction {
                deg: value.parse().unwrap(),
            },
            Choices::Lengths { .. } => Value::Length {
                length: value.parse().unwrap(),
            },
            Choices::Words { .. } => Value::Word(value.to_owned()),
        };
        (name.to_owned(), value)
    });
    Proposal {
        fields: fields.collect(),
    }
}

fn point(text: &str) -> PixelPoint {
    let (u, v) = text.split_once(',').unwrap();
    PixelPoint::new(u.parse().unwrap(), v.parse().unwrap())
}
