//! `fabc sim time`: measures the time per step of one fixed fold, with every step computed.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::materials::MaterialArguments;
use clap::Args;
use fab_base::parallel::in_parallel;
use fab_sim::{SimError, diagonal_fold};
use serde_json::json;
use std::time::Instant;

#[derive(Args)]
pub struct TimeArguments {
    /// Particles along each side of the cloth.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(25..=200))]
    pub size: u32,
    #[command(flatten)]
    pub cloth: MaterialArguments,
    /// Cloths folded side by side.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=super::MAX_THREADS))]
    pub threads: u16,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// How often the fold is timed; the median is reported.
const REPEATS: usize = 3;

pub fn run(arguments: &TimeArguments, io: &Io) -> Result<Exit, Failure> {
    let grid = super::square(arguments.size)?;
    let (params, _) = arguments.cloth.params(io)?;
    let interrupt = io.interrupt()?;
    let threads = usize::from(arguments.threads);
    let (mut cpu_ms, mut wall_ms) = (Vec::new(), Vec::new());
    let mut ends = Vec::new();
    for repeat in 1..=REPEATS {
        io.progress(&format!("fold {repeat} of {REPEATS}"));
        let (began, cpu_before) = (Instant::now(), cpu_s());
        let fold = |_| match diagonal_fold(grid, &params, &|| interrupt.is_raised()) {
            Ok(cloth) => Ok(Some(cloth)),
            Err(SimError::Interrupted { .. }) => Ok(None),
            Err(error) => Err(Failure::environment(error)),
        };
        let folded = in_parallel(threads, threads, fold, |_| {});
        let wall_s = began.elapsed().as_secs_f64();
        let cpu_s = cpu_s().zip(cpu_before).map(|(now, then)| now - then);
        io.progress("");
        for cloth in folded? {
            let cloth = cloth.ok_or_else(Failure::interrupted)?;
            let counts = (cloth.substeps(), cloth.spring_count());
            ends.push((cloth.digest(), cloth.steps(), counts));
        }
        let all_steps = ends[0].1 as f64 * threads as f64;
        wall_ms.push(1000.0 * wall_s / all_steps);
        cpu_ms.extend(cpu_s.map(|cpu_s| 1000.0 * cpu_s / all_steps));
    }
    let (digest, steps, (substeps, constraints)) = ends[0].clone();
    if ends.iter().any(|end| end.0 != digest) {
        return Err(Failure::environment(
            "two equal folds ended with different bits; this machine cannot be trusted",
        ));
    }
    let hash = params.hash();
    let [cpu, wall] = [median(cpu_ms), median(wall_ms)];
    let self_contact = params.self_contact_m > 0.0;
    let document = json!({
        "params": hash,
        "material": arguments.cloth.material,
        "size": arguments.size,
        "threads": threads,
        "repeats": REPEATS,
        "particles": grid.particle_count(),
        "steps": steps,
        "substeps": substeps,
        "constraints": constraints,
        "self_contact": self_contact,
        "cpu_ms_per_step": cpu,
        "wall_ms_per_step": wall,
        "digest": digest,
    });
    io.either(arguments.json, &document, || {
        let number = |value: Option<f64>| match value {
            Some(value) => format!("{value:.3}"),
            None => "unknown here".to_owned(),
        };
        let [cpu, wall] = [cpu, wall].map(number);
        let (size, contact) = (arguments.size, if self_contact { "on" } else { "off" });
        format!(
            "{size} x {size} particles, {steps} steps of {substeps} substeps, {constraints} springs, self-contact {contact}\n\
             CPU ms per step   {cpu}   (median of {REPEATS})\n\
             wall ms per step  {wall}   ({threads} side by side)\n\
             digest {digest}\n\
             simulator parameters {hash}"
        )
    });
    Ok(Exit::Done)
}

/// Returns the median; `None` without values.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Returns the CPU time of all threads, user and system, seconds.
fn cpu_s() -> Option<f64> {
    use nix::sys::resource::{UsageWho, getrusage};
    use nix::sys::time::TimeValLike;

    let used = getrusage(UsageWho::RUSAGE_SELF).ok()?;
    let micros = used.user_time().num_microseconds() + used.system_time().num_microseconds();
    Some(micros as f64 * 1e-6)
}
