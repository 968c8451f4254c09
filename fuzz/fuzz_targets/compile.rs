//! Compiles any bytes, as the entry and as every file that it uses.

#![no_main]

#[path = "../../compiler/tests/suite/common/promises.rs"]
mod promises;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        promises::hold(text);
    }
});
