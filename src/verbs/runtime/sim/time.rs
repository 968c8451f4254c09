//! `fabc sim time`: measures the time per step of one fixed fold, with every step computed.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::materials;
use crate::verbs::runtime::sim::SPACING_M;
use crate::verbs::runtime::sim::parallel::in_parallel;
use clap::Args;
use fab_sim::{Grid, Params, SimError, diagonal_fold};
use fab_world::simulated;
use serde_json::json;
use std::time::Instant;

/// Arguments of `sim time`.
#[derive(Args)]
pub struct TimeArguments {
    /// Particles along each side of the cloth.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(25..=200))]
    pub size: u32,
    /// A cloth of a shipped material, or of `FILE.fab:NAME`; the recorded scene's cloth otherwise.
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Cloths folded side by side.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=super::MAX_THREADS))]
    pub threads: u16,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// How often the fold is timed; the median is reported.
const REPEATS: usize = 3;

/// Times the fold and reports.
pub fn run(arguments: &TimeArguments, io: &Io) -> Result<Exit, Failure> {
    let dim = arguments.size as usize;
    let grid = Grid::new(dim, dim, SPACING_M as f32)
        .map_err(|error| Failure::usage(format!("`--size {dim}`: {error}")))?;
    let material = arguments.material.as_deref();
    let material = material.map(|name| materials::find(name, io)).transpose()?;
    let params = Params {
        material: material.as_ref().map(simulated::material),
        ..Params::default()
    };
    let interrupt = io.interrupt()?;
    let threads = usize::from(arguments.threads);
    let (mut cpu_ms, mut wall_ms) = (Vec::new(), Vec::new());
    let (mut steps, mut counts, mut digest) = (0, [0; 2], None);
    for repeat in 1..=REPEATS {
        io.progress(&format!("fold {repeat} of {REPEATS}"));
        let (began, cpu_before) = (Instant::now(), usage::cpu_s());
        let folded = in_parallel(
            threads,
            threads,
            |_| match diagonal_fold(grid, &params, &|| interrupt.is_raised()) {
                Ok(cloth) => {
                    let counts = [cloth.substeps() as usize, cloth.spring_count()];
                    Ok(Some((cloth.steps(), cloth.digest(), counts)))
                }
                Err(SimError::Interrupted { .. }) => Ok(None),
                Err(error) => Err(Failure::environment(error)),
            },
            |_| {},
        );
        let wall_s = began.elapsed().as_secs_f64();
        let cpu_s = usage::cpu_s().zip(cpu_before).map(|(now, then)| now - then);
        io.progress("");
        for result in folded? {
            let Some((taken, end, counted)) = result else {
                return Err(Failure::interrupted());
            };
            (steps, counts) = (taken, counted);
            if *digest.get_or_insert_with(|| end.clone()) != end {
                return Err(Failure::environment(
                    "two equal folds ended with different bits; this machine cannot be trusted",
                ));
            }
        }
        let all_steps = steps as f64 * threads as f64;
        wall_ms.push(1000.0 * wall_s / all_steps);
        cpu_ms.extend(cpu_s.map(|cpu_s| 1000.0 * cpu_s / all_steps));
    }
    let [n_substeps, n_springs] = counts;
    let result = json!({
        "params": params.hash(),
        "material": arguments.material,
        "size": dim,
        "threads": threads,
        "repeats": REPEATS,
        "particles": grid.particle_count(),
        "steps": steps,
        "substeps": n_substeps,
        "constraints": n_springs,
        "self_contact": params.self_contact_m > 0.0,
        "cpu_ms_per_step": median(cpu_ms),
        "wall_ms_per_step": median(wall_ms),
        "peak_mb": usage::peak_mb(),
        "digest": digest,
    });
    if arguments.json {
        io.json(&result);
    } else {
        let number = |name: &str| match result[name].as_f64() {
            Some(value) => format!("{value:.3}"),
            None => "unknown here".to_owned(),
        };
        io.data(&format!(
            "{dim} x {dim} particles, {steps} steps of {n_substeps} substeps, {n_springs} springs, self-contact {}\n\
             CPU ms per step   {}   (median of {REPEATS})\n\
             wall ms per step  {}   ({threads} side by side)\n\
             peak memory MB    {}\n\
             digest {}\n\
             simulator parameters {}",
            if params.self_contact_m > 0.0 {
                "on"
            } else {
                "off"
            },
            number("cpu_ms_per_step"),
            number("wall_ms_per_step"),
            number("peak_mb"),
            result["digest"].as_str().unwrap_or_default(),
            params.hash(),
        ));
    }
    Ok(Exit::Done)
}

/// Returns the median; `None` without values.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Resources used by this process.
#[cfg(unix)]
mod usage {
    use nix::sys::resource::{UsageWho, getrusage};
    use nix::sys::time::TimeValLike;

    /// Returns the CPU time of all threads, user and system, seconds.
    pub fn cpu_s() -> Option<f64> {
        let used = getrusage(UsageWho::RUSAGE_SELF).ok()?;
        let micros = used.user_time().num_microseconds() + used.system_time().num_microseconds();
        Some(micros as f64 * 1e-6)
    }

    /// Returns the largest resident memory, megabytes of 10^6 bytes.
    pub fn peak_mb() -> Option<f64> {
        high_water_mb().or_else(|| {
            let used = getrusage(UsageWho::RUSAGE_SELF).ok()?;
            Some(used.max_rss() as f64 * RSS_UNIT_BYTES * 1e-6)
        })
    }

    /// macOS counts in bytes, other systems in KiB.
    const RSS_UNIT_BYTES: f64 = if cfg!(target_os = "macos") {
        1.0
    } else {
        1024.0
    };

    /// Reads Linux's own value; there, `getrusage` starts from the memory of the parent program.
    fn high_water_mb() -> Option<f64> {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("VmHWM:"))?;
        let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
        Some(kib * 1024.0 * 1e-6)
    }
}

/// Resources used by this process: unknown on this system.
#[cfg(not(unix))]
mod usage {
    /// Returns `None`.
    pub fn cpu_s() -> Option<f64> {
        None
    }

    /// Returns `None`.
    pub fn peak_mb() -> Option<f64> {
        None
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_median_is_the_middle_value() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![]), None);
    }

    #[test]
    #[cfg(unix)]
    fn work_uses_cpu_time_and_memory() {
        let before = usage::cpu_s().unwrap();
        let began = Instant::now();
        while usage::cpu_s().unwrap() - before < 0.02 {
            assert!(began.elapsed().as_secs() < 60, "no CPU time is counted");
        }
        let peak_mb = usage::peak_mb().unwrap();
        assert!((0.5..100_000.0).contains(&peak_mb), "{peak_mb} MB");
    }
}
