//! Holds no code: `Cargo.toml` beside it asks for features of other crates.
