//! CPU time and memory that this process has used; unknown where the system does not report them.

/// Returns the CPU time of all threads, user and system, seconds.
#[cfg(unix)]
pub fn cpu_s() -> Option<f64> {
    use nix::sys::resource::{UsageWho, getrusage};
    use nix::sys::time::TimeValLike;

    let used = getrusage(UsageWho::RUSAGE_SELF).ok()?;
    let micros = used.user_time().num_microseconds() + used.system_time().num_microseconds();
    Some(micros as f64 * 1e-6)
}

/// Returns `None`.
#[cfg(not(unix))]
pub fn cpu_s() -> Option<f64> {
    None
}

/// Returns the largest resident memory, megabytes of 10^6 bytes; Linux alone tells it.
pub fn peak_mb() -> Option<f64> {
    // `getrusage` would start from the memory of the parent program.
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 * 1e-6)
}
