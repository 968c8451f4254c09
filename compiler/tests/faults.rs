//! dev
#[path = "../../tests/suite/faults.rs"]
mod faults;
