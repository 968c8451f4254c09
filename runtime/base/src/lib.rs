//! The runtime's foundation: journals, the first difference of two documents, files and what they really are, particle
//! positions, a cache, hashes, seeded chance, threads, a queue that cannot block, interrupts, programs that answer
//! lines, names of enumerations, tables, foreign text made visible.
//!
//! Nothing here knows about tasks, models, cloths or arms.
//!
//! A journal is written line by line and can be read back after a crash:
//!
//! ```
//! use fab_base::jsonl::{Appender, Reader};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("steps.jsonl");
//! Appender::open(&path)?.append(&[0.25, 0.5])?;
//! // The next line is cut off while it is written.
//! std::fs::write(&path, [&std::fs::read(&path)?[..], b"[0.7"].concat())?;
//!
//! let mut lines = Reader::open(&path, 1 << 20)?;
//! assert_eq!(lines.read::<Vec<f64>>()?, Some(vec![0.25, 0.5]));
//! assert_eq!(lines.read::<Vec<f64>>()?, None);
//!
//! // The line that comes next stands where the half one was.
//! let mut journal = Appender::open(&path)?;
//! journal.keep(lines.whole_bytes());
//! journal.append(&[0.75, 1.0])?;
//! assert_eq!(std::fs::read_to_string(&path)?, "[0.25,0.5]\n[0.75,1.0]\n");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cache;
pub mod chance;
pub mod child;
pub mod difference;
pub mod digest;
pub mod files;
pub mod interrupt;
pub mod jsonl;
pub mod kinds;
mod named;
pub mod npy;
pub mod parallel;
pub mod table;
pub mod wording;
