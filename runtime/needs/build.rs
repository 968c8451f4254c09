//! Asks `scripts/deps.sh` what the build of OpenCV's bindings lacks, and ends the build with its answer.
//!
//! In: the checkout's script. Out: nothing, or an error of one line. A package outside of a checkout has no script to
//! ask, and checks nothing.

use std::path::Path;
use std::process::Command;

const SCRIPT: &str = "../../scripts/deps.sh";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // A vendored copy may be beside another project's scripts.
    if !Path::new("../../runtime/needs/build.rs").is_file() || !Path::new(SCRIPT).is_file() {
        return;
    }
    let answer = Command::new("sh").args([SCRIPT, "--for-bindings"]).output();
    // The script knows no system without `sh`.
    if let Ok(answer) = answer
        && !answer.status.success()
    {
        let missing = String::from_utf8_lossy(&answer.stderr).replace('\n', " ");
        println!(
            "cargo::error={}",
            missing.trim().trim_start_matches("fabc: ")
        );
    }
}
