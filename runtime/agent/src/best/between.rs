//! Tries directions and lengths between those that the action space offers.
//!
//! In: a finished search. Out: values half-way to the neighbours of a chosen one that would have left the cloth better after
//! that step. Points stay those that were chosen. The task's checks hold for these values too.

use super::offers::{self, Offers, Situation};
use super::tree::Tree;
use super::unoffered::{Allowance, Better, Lacking, Measured};
use super::{BestError, Choice, Found, Search, unless_stopped};
use crate::action::Action;
use fab_program::{Choices, Direction, LengthChoice, Program, Proposal, Value};
use fab_world::simulated::trials::{Trial, try_motions};

/// Tries values that are not offered in the steps of the best actions, beginning with the step that limits; returns the
/// best of the first step that has a better one.
pub(super) fn between(
    search: &Search<'_>,
    tree: &Tree,
    found: &Found,
    allowance: &mut Allowance,
) -> Result<Option<Better>, BestError> {
    let (Some(limiting), Some(end)) = (found.limiting(), tree.best_end()) else {
        return Ok(None);
    };
    let path = tree.path(end);
    let others = (0..path.len() - 1).filter(|&index| index != limiting);
    for index in std::iter::once(limiting).chain(others) {
        if allowance.ends(search) {
            break;
        }
        let around = [path[index], path[index + 1]];
        let better = unless_stopped(in_step(search, tree, around, allowance))?.flatten();
        if let Some(better) = better {
            return Ok(Some(Better { index, ..better }));
        }
    }
    Ok(None)
}

/// Tries values in one step, from the state before it; `after` is the state that the offered action led to.
fn in_step(
    search: &Search<'_>,
    tree: &Tree,
    [before, after]: [usize; 2],
    allowance: &mut Allowance,
) -> Result<Option<Better>, BestError> {
    let Some(Choice::Act { proposal, .. }) = &tree.nodes[after].choice else {
        return Ok(None);
    };
    let (program, proposals) = extended(search.program, proposal);
    let (mut world, _) = tree.world_at(search, before)?;
    let (scene, observation) = tree.scene_at(search, before, &mut world)?;
    let step = tree.step_of(search, before);
    let at = Situation {
        program: &program,
        scene: &scene,
        observation: &observation,
        step,
        last: tree.nodes[before].last.as_ref(),
        wanted: Vec::new(),
        draw: String::new(),
        interrupt: search.interrupt,
    };
    let mut candidates = Vec::new();
    for proposal in proposals {
        if offers::accepted(&at, &proposal, &mut Offers::default())?.is_some()
            && let Some(action) = Action::lower(&program, &proposal, &scene, &observation)
        {
            candidates.push((proposal, action.motion));
        }
    }
    candidates.truncate(allowance.left());
    let due: Vec<Trial<'_>> = candidates
        .iter()
        .map(|(_, motion)| Trial {
            from: &world,
            motion: *motion,
        })
        .collect();
    let done = try_motions(
        &due,
        search.limits.threads,
        search.interrupt,
        |_, end| -> Result<_, BestError> {
            let positions = &end.state.positions;
            Ok(tree
                .aim
                .value(positions)
                .zip(tree.aim.behind(positions, step)))
        },
    )?;
    allowance.spend(done.iter().flatten().count(), search);
    let (measure, offered) = (tree.aim.measure, &tree.nodes[after]);
    let best = candidates
        .into_iter()
        .zip(done)
        .filter_map(|((proposal, _), done)| {
            let (value, behind) = done.flatten()?;
            Some((proposal, value, behind))
        })
        .filter(|(_, _, behind)| *behind < offered.behind - measure.least_gain())
        .min_by(|a, b| a.2.total_cmp(&b.2));
    Ok(best.map(|(proposal, value, behind)| Better {
        index: 0,
        step,
        lacking: Lacking::Values(needed(search.program, &program, &proposal)),
        value: measure.on_the_way(value, behind),
        instead_of: measure.on_the_way(offered.value, offered.behind),
        measured: Measured::AfterStep,
    }))
}

/// Returns the program with values between those offered, next to the chosen ones, and the answers that use one.
fn extended(program: &Program, chosen: &Proposal) -> (Program, Vec<Proposal>) {
    let mut extended = program.clone();
    let mut proposals = vec![Proposal::default()];
    for field in &mut extended.actions {
        let Some(value) = chosen.get(&field.name) else {
            continue;
        };
        let mut values = vec![value.clone()];
        match (&mut field.choices, value) {
            (Choices::Directions { choices }, Value::Direction { deg }) => {
                let more = directions(choices, *deg);
                values.extend(more.iter().map(|it| Value::Direction { deg: it.deg }));
                choices.extend(more);
                choices.sort_by(|a, b| a.deg.total_cmp(&b.deg));
            }
            (Choices::Lengths { choices, .. }, Value::Length { length }) => {
                let more = lengths(choices, *length);
                values.extend(more.iter().map(|it| Value::Length { length: it.value }));
                choices.extend(more);
                choices.sort_by(|a, b| a.value.total_cmp(&b.value));
            }
            _ => {}
        }
        let name = &field.name;
        proposals = proposals
            .iter()
            .flat_map(|shorter| {
                values.iter().map(move |value| {
                    let mut proposal = shorter.clone();
                    proposal.fields.push((name.clone(), value.clone()));
                    proposal
                })
            })
            .collect();
    }
    proposals.retain(|proposal| proposal != chosen);
    (extended, proposals)
}

/// Returns the directions half-way to the offered neighbours of one.
fn directions(offered: &[Direction], deg: f64) -> Vec<Direction> {
    let apart = |other: &Direction| (other.deg - deg).rem_euclid(360.0);
    let others = offered.iter().filter(|other| other.deg != deg);
    let gaps = others.map(apart);
    let next = gaps.clone().reduce(f64::min);
    let previous = gaps.reduce(f64::max).map(|gap| gap - 360.0);
    let mut between: Vec<Direction> = [previous, next]
        .into_iter()
        .flatten()
        .map(|gap| {
            let deg = (deg + gap / 2.0).rem_euclid(360.0);
            let (sin, cos) = deg.to_radians().sin_cos();
            Direction {
                deg,
                vector: [cos, -sin],
            }
        })
        .collect();
    between.dedup_by(|a, b| a.deg == b.deg);
    between
}

/// Returns the lengths half-way to the offered neighbours of one.
fn lengths(offered: &[LengthChoice], length: f64) -> Vec<LengthChoice> {
    let at = |wanted: f64| offered.iter().find(|it| it.value == wanted);
    let values = || offered.iter().map(|it| it.value);
    let below = values().filter(|it| *it < length).reduce(f64::max);
    let above = values().filter(|it| *it > length).reduce(f64::min);
    let chosen = at(length);
    let between = [below, above]
        .into_iter()
        .flatten()
        .filter_map(|neighbour| {
            let (a, b) = (chosen?, at(neighbour)?);
            Some(LengthChoice {
                // As it is written: 0.15, and not 0.15000000000000002.
                value: ((a.value + b.value) / 2.0 * 1e9).round() / 1e9,
                m: (a.m + b.m) / 2.0,
            })
        });
    between.collect()
}

/// Returns, for each field whose value is not offered, its choices with that value.
fn needed(program: &Program, extended: &Program, proposal: &Proposal) -> Vec<(String, Choices)> {
    let fields = proposal.fields.iter().filter_map(|(name, value)| {
        let (old, new) = (program.field(name)?, extended.field(name)?);
        let choices = match (&old.choices, &new.choices, value) {
            (
                Choices::Directions { choices },
                Choices::Directions { choices: more },
                Value::Direction { deg },
            ) if choices.iter().all(|it| it.deg != *deg) => {
                let kept = more
                    .iter()
                    .filter(|it| it.deg == *deg || choices.contains(it));
                Choices::Directions {
                    choices: kept.cloned().collect(),
                }
            }
            (
                Choices::Lengths { choices, unit },
                Choices::Lengths { choices: more, .. },
                Value::Length { length },
            ) if choices.iter().all(|it| it.value != *length) => {
                let kept = more
                    .iter()
                    .filter(|it| it.value == *length || choices.contains(it));
                Choices::Lengths {
                    unit: *unit,
                    choices: kept.cloned().collect(),
                }
            }
            _ => return None,
        };
        Some((name.clone(), choices))
    });
    fields.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(offered: &[f64], chosen: f64) -> Vec<f64> {
        let vector = [0.0; 2];
        let offered: Vec<Direction> = offered
            .iter()
            .map(|&deg| Direction { deg, vector })
            .collect();
        let between = directions(&offered, chosen);
        between.iter().map(|it| it.deg).collect()
    }

    #[test]
    fn values_between_are_half_way_to_both_neighbours() {
        assert_eq!(degrees(&[0.0, 90.0, 180.0, 270.0], 0.0), [315.0, 45.0]);
        assert_eq!(degrees(&[0.0, 90.0, 180.0, 270.0], 180.0), [135.0, 225.0]);
        assert_eq!(degrees(&[10.0], 10.0), [0.0; 0]);
        let offered = [0.1, 0.25, 0.5].map(|value| LengthChoice {
            value,
            m: value * 2.0,
        });
        let half_way = |length| -> Vec<[f64; 2]> {
            let between = lengths(&offered, length);
            between.iter().map(|it| [it.value, it.m]).collect()
        };
        assert_eq!(half_way(0.25), [[0.175, 0.35], [0.375, 0.75]]);
        assert_eq!(half_way(0.5), [[0.375, 0.75]]);
    }
}
