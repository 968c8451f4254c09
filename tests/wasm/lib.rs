//! The compiler and the detectors behind functions that take and give numbers, so that a host needs no bindings.
//!
//! The host puts the bytes of a JSON object, calls [`compile`] or [`keypoints`], which return a length, and gets as many
//! bytes of another one.
//!
//! - `compile`: `{"entry": NAME, "files": {NAME: TEXT}}` to `{"programs": […], "diagnostics": […]}`;
//! - `keypoints`: `[{"width": PX, "levels": HEX, "max": N, "harris": YES}]` to what [`keypoints::of`] finds in each.

mod keypoints;

use fab_compiler::{LoadError, Loader, diag};
use serde_json::{Value, json};
use std::sync::Mutex;

static INPUT: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static OUTPUT: Mutex<Vec<u8>> = Mutex::new(Vec::new());

/// Texts by name, as the host gave them.
struct Files<'v>(&'v Value);

impl Loader for Files<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        let text = self.0.get(name).and_then(Value::as_str);
        text.map(str::to_owned).ok_or_else(|| LoadError {
            message: format!("there is no file `{name}`"),
        })
    }
}

/// Takes one more byte of the input.
#[unsafe(no_mangle)]
pub extern "C" fn put(byte: u32) {
    if let Ok(mut input) = INPUT.lock() {
        input.push(byte as u8);
    }
}

/// Compiles the input, forgets it, and returns the length of the output, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn compile() -> u32 {
    answer(|input| {
        let entry = input["entry"].as_str().unwrap_or_default();
        match fab_compiler::compile(entry, &Files(&input["files"])) {
            Ok(compiled) => json!({
                "programs": compiled.programs,
                "diagnostics": diag::to_json(&compiled.diagnostics, &compiled.sources),
            }),
            Err(error) => json!({ "error": error.message }),
        }
    })
}

/// Finds the keypoints of pictures, forgets them, and returns the length of the output, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn keypoints() -> u32 {
    answer(|input| {
        let pictures = input.as_array().map(Vec::as_slice).unwrap_or_default();
        pictures.iter().map(keypoints::of).collect()
    })
}

/// Returns one byte of the output.
#[unsafe(no_mangle)]
pub extern "C" fn get(at: u32) -> u32 {
    let output = OUTPUT.lock().ok();
    let byte = output.and_then(|output| output.get(at as usize).copied());
    byte.map_or(0, u32::from)
}

fn answer(call: impl Fn(&Value) -> Value) -> u32 {
    let input = INPUT.lock().map(|mut input| std::mem::take(&mut *input));
    let text = match serde_json::from_slice(&input.unwrap_or_default()) {
        Ok(input) => call(&input).to_string(),
        Err(error) => json!({ "error": error.to_string() }).to_string(),
    };
    let length = text.len() as u32;
    if let Ok(mut output) = OUTPUT.lock() {
        *output = text.into_bytes();
    }
    length
}
