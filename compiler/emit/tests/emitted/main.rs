//! Emitted files: verifiers that agree in three languages, prompts that render alike, files that fit together.

#![allow(clippy::unwrap_used)]

mod case;
#[path = "../../../tests/suite/common/mod.rs"]
mod common;
mod docs;
mod drivers;
mod files;
mod oracle;
mod programs;
mod prompts;
#[path = "../../../../tests/recorded_data.rs"]
#[allow(dead_code)]
mod recorded_data;
mod table;
mod truth;
mod verifiers;
