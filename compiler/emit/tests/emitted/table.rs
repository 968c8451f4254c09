//! Generates cases until every check has rejected its share, most of them close to a limit.

use super::case::{Case, Scene};
use super::oracle;
use fab_program::Proposal;
use fab_program::facts::ExecutedAction;
use fab_program::space;
use fab_program::{KeypointShape, PixelPoint, Program, Value};

/// The cases per program that are judged with nothing missing.
pub const CASES: usize = 10_000;

/// The most cases in which something is missing.
pub const MISSING: usize = 300;

/// The smallest share that each check rejects of the cases that reach it.
const REFUSED: f64 = 0.32;

/// The most cases that are tried for one table.
const TRIES: usize = 4_000_000;

/// Side of the square that contains all points, pixels; small, so many are close together.
const SIDE_PX: u32 = 60;

/// A sequence of pseudo-random numbers that is the same on every machine and in every run.
pub struct Chance(u64);

impl Chance {
    pub fn of(seed: u64) -> Chance {
        Chance(seed)
    }

    /// Returns a number below `end` (splitmix64).
    pub fn below(&mut self, end: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % u64::from(end)) as u32
    }

    fn one_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }

    fn point(&mut self) -> PixelPoint {
        PixelPoint::new(self.below(SIDE_PX) as i32, self.below(SIDE_PX) as i32)
    }

    /// Returns a pixel at most 3 away on each axis.
    fn beside(&mut self, point: PixelPoint) -> PixelPoint {
        let mut step = || self.below(7) as i32 - 3;
        PixelPoint::new(point.u + step(), point.v + step())
    }

    fn one_of<T: Clone>(&mut self, list: &[T]) -> Option<T> {
        let count = list.len() as u32;
        (count > 0).then(|| list[self.below(count) as usize].clone())
    }
}

/// Returns the table of a program.
pub fn generate(program: &Program, seed: u64) -> Vec<Case> {
    let mut chance = Chance::of(seed);
    let mut wanted = quotas(program.verify.checks.len());
    let mut missing = MISSING;
    let mut close_to = vec![CASES / 50; oracle::comparisons(program)];
    let mut cases = Vec::with_capacity(CASES + MISSING);
    // The latest case with each outcome: most new cases differ little from one of these.
    let mut latest: Vec<Option<Case>> = vec![None; wanted.len()];
    for _ in 0..TRIES {
        if wanted.iter().all(|wanted| *wanted == 0) {
            break;
        }
        let outcome = chance.below(latest.len() as u32) as usize;
        let case = match &latest[outcome] {
            Some(known) if !chance.one_in(4) => changed(program, known, &mut chance),
            _ => case(program, &mut chance),
        };
        let outcome = oracle::judge(program, &case);
        let Some(said) = outcome.verdict else {
            if missing > 0 {
                missing -= 1;
                cases.push(case);
            }
            continue;
        };
        latest[said] = Some(case.clone());
        if wanted[said] == 0 || !is_welcome(said, &outcome.margins, &close_to, &mut chance) {
            continue;
        }
        wanted[said] -= 1;
        for (comparison, margin) in &outcome.margins {
            if *margin <= 1.0 {
                close_to[*comparison] = close_to[*comparison].saturating_sub(1);
            }
        }
        cases.push(case);
    }
    let left: usize = wanted.iter().sum();
    assert_eq!(left, 0, "{}: still wanted {wanted:?}", program.task);
    cases
}

/// Prefers cases close to the last limit that still needs some, then cases close to any limit.
fn is_welcome(
    said: usize,
    margins: &[(usize, f64)],
    close_to: &[usize],
    chance: &mut Chance,
) -> bool {
    if said == 0 {
        return true;
    }
    // Few cases reach the last checks, so those are not spent on the limits of the first.
    let mut from_the_last = margins.iter().rev();
    match from_the_last.find(|(comparison, _)| close_to[*comparison] > 0) {
        Some((_, margin)) => *margin <= 1.0 || chance.one_in(3000),
        None => margins.iter().any(|(_, margin)| *margin <= 1.0) || chance.one_in(40),
    }
}

/// Changes one thing of a case a little.
fn changed(program: &Program, case: &Case, chance: &mut Chance) -> Case {
    let mut case = case.clone();
    match chance.below(8) {
        0 => case.step = 1 + chance.below(9),
        1 => {
            let field = chance.below(program.actions.len() as u32) as usize;
            let choices = space::choices(&program.actions[field], &case.scene);
            if let Some(value) = chance.one_of(&choices) {
                case.proposal.fields[field].1 = value;
            }
        }
        2 => {
            if let Some(last) = &mut case.last {
                last.pick = chance.beside(last.pick);
                last.place = chance.beside(last.place);
            } else {
                case.last = self::case(program, chance).last;
            }
        }
        3 => {
            for sides in case.scene.regions.values_mut() {
                let side = chance.below(4) as usize;
                sides[side] += chance.below(7) as i32 - 3;
                // A rectangle keeps its sides in order.
                *sides = [
                    sides[0].min(sides[2]),
                    sides[1].min(sides[3]),
                    sides[0].max(sides[2]),
                    sides[1].max(sides[3]),
                ];
            }
            for area in case.scene.areas.values_mut() {
                *area = (*area + f64::from(chance.below(41)) / 2.0 - 10.0).max(0.0);
            }
        }
        _ => {
            let lists: Vec<String> = case.scene.points.keys().cloned().collect();
            if let Some(list) = chance.one_of(&lists) {
                let points = case.scene.points.entry(list).or_default();
                if !points.is_empty() {
                    let index = chance.below(points.len() as u32) as usize;
                    let (from, to) = (points[index], chance.beside(points[index]));
                    points[index] = to;
                    // A choice of this point moves with it.
                    for (_, value) in &mut case.proposal.fields {
                        if *value == Value::Point(from) {
                            *value = Value::Point(to);
                        }
                    }
                }
            }
        }
    }
    case
}

/// Returns how many cases each check must reject, `offered` first, and last how many must be accepted.
fn quotas(checks: usize) -> Vec<usize> {
    let mut left = CASES;
    let mut quotas = Vec::new();
    for _ in 0..=checks {
        let refused = (left as f64 * REFUSED).ceil() as usize;
        quotas.push(refused);
        left -= refused;
    }
    quotas.push(left);
    quotas
}

fn case(program: &Program, chance: &mut Chance) -> Case {
    let mut scene = Scene::default();
    for keypoint in &program.keypoints {
        // One scene in 30 lacks it.
        if chance.one_in(30) {
            continue;
        }
        let name = keypoint.name.clone();
        let count = match keypoint.extractor.shape() {
            KeypointShape::Point => 1,
            KeypointShape::Points => chance.below(7),
            KeypointShape::Mask | KeypointShape::Box | KeypointShape::Outline => {
                let (a, b) = (chance.point(), chance.point());
                let sides = [a.u.min(b.u), a.v.min(b.v), a.u.max(b.u), a.v.max(b.v)];
                scene
                    .areas
                    .insert(name.clone(), f64::from(chance.below(1400)) / 2.0);
                scene.regions.insert(name, sides);
                continue;
            }
        };
        let points = (0..count).map(|_| chance.point()).collect();
        scene.points.insert(name, points);
    }
    let last = (!chance.one_in(3)).then(|| ExecutedAction {
        proposal: proposal(program, &scene, chance),
        pick: chance.point(),
        place: chance.point(),
    });
    let mut proposal = proposal(program, &scene, chance);
    if chance.one_in(8) {
        let field = chance.below(program.actions.len() as u32) as usize;
        spoil(&mut proposal.fields[field].1);
    }
    Case {
        scene,
        step: 1 + chance.below(9),
        last,
        proposal,
    }
}

fn proposal(program: &Program, scene: &Scene, chance: &mut Chance) -> Proposal {
    let fields = program.actions.iter().map(|field| {
        let choices = space::choices(field, scene);
        let value = chance.one_of(&choices);
        (
            field.name.clone(),
            value.unwrap_or(Value::Point(PixelPoint::new(0, 0))),
        )
    });
    Proposal {
        fields: fields.collect(),
    }
}

/// Changes a value by the smallest step that its type allows.
fn spoil(value: &mut Value) {
    match value {
        Value::Point(point) => point.u += 1,
        Value::Direction { deg: number } | Value::Length { length: number } => {
            *number = number.next_up();
        }
        Value::Word(word) => word.push(' '),
    }
}
