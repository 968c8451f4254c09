//! Converts ROS message definitions to Rust types.

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    write_messages()?;
    Ok(())
}

/// Writes `messages.rs` from this package's own definitions only, whatever ROS the machine has.
fn write_messages() -> Result<(), Box<dyn Error>> {
    use std::path::Path;

    let definitions = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/msgs");
    println!("cargo::rerun-if-changed={}", definitions.display());
    let (source, _) =
        roslibrust_codegen::find_and_generate_ros_messages_without_ros_package_path(vec![
            definitions,
        ])?;
    let folder = std::env::var_os("OUT_DIR").ok_or("cargo sets no `OUT_DIR`")?;
    std::fs::write(Path::new(&folder).join("messages.rs"), source.to_string())?;
    Ok(())
}
