//! Describes the pulls of `collect_pulls` by the stand-in's features and windows, for refitting its estimate.
//!
//! `cargo run --release -p fab-agent --example describe_pulls -- FOLDER... OUT`
//!
//! In: folders of `collect_pulls`, with different starts. Out: in the folder OUT, `pulls.csv` with a line per pull that the stand-in considers: its
//! start, step, true coverage before and gain, and [`FEATURES`]; and `windows.u8` with the picture around its pick, `[3][24][24]`
//! bytes of which 255 is a whole. `scripts/fit-pulls.py` fits the estimate to them.

use fab_base::parallel::in_parallel;
use fab_model::{Message, Part, Png, Speaker};
use fab_standins::geometric::{FEATURES, Offer, offers};
use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

type Failure = Box<dyn Error + Send + Sync>;

/// What stands before the features in the first line of a description.
const HEAD: &str = "start,step,coverage,gain,";

fn main() -> Result<(), Failure> {
    /// What stands before the kind.
    const NUMBERS: usize = 8;
    let mut states: BTreeMap<(PathBuf, String), Vec<Vec<f64>>> = BTreeMap::new();
    let mut folders: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    let out = folders.pop().filter(|_| !folders.is_empty());
    let out = out.ok_or("give FOLDER... OUT")?;
    let described = std::fs::read_to_string(out.join("pulls.csv"));
    if described.is_ok_and(|pulls| !pulls.starts_with(HEAD)) {
        let out = out.display();
        return Err(
            format!("`{out}` holds collected pulls, and is no place for a description").into(),
        );
    }
    for folder in folders {
        for line in std::fs::read_to_string(folder.join("pulls.csv"))?.lines() {
            let numbers: Vec<f64> = line
                .split(',')
                .take(NUMBERS)
                .map(|word| word.parse())
                .collect::<Result<_, _>>()?;
            let [seed, step, ..] = numbers[..] else {
                return Err(format!("`{line}` is no line of collect_pulls").into());
            };
            let state = (folder.clone(), format!("{seed}-{step}"));
            states.entry(state).or_default().push(numbers);
        }
    }
    let states: Vec<_> = states.into_iter().collect();
    let threads = std::thread::available_parallelism()?.get();
    let described = in_parallel(
        states.len(),
        threads,
        |index| {
            let ((folder, name), pulls) = &states[index];
            let at = folder.join(name);
            let words = std::fs::read_to_string(at.with_extension("txt"))?;
            let picture = Png::new(std::fs::read(at.with_extension("png"))?);
            let question = Message {
                speaker: Speaker::User,
                parts: vec![Part::Text(words), Part::Image(picture)],
            };
            let offered = offers(&[question])?;
            let (mut lines, mut windows) = (String::new(), Vec::new());
            for pull in pulls {
                let [seed, step, before, gain, u, v, deg, far] = pull[..] else {
                    return Err(format!("a pull of `{name}` is no line of collect_pulls").into());
                };
                let is_it = |offer: &&Offer| {
                    [f64::from(offer.pick.u), f64::from(offer.pick.v)] == [u, v]
                        && offer.direction_deg == deg
                        && offer.distance == far
                };
                if let Some(offer) = offered.iter().find(is_it) {
                    let features = offer.features.map(|value| format!("{value:.5}"));
                    let features = features.join(",");
                    writeln!(lines, "{seed},{step},{before},{gain},{features}")?;
                    windows.extend(
                        offer
                            .window
                            .iter()
                            .map(|share| (255.0 * share).round() as u8),
                    );
                }
            }
            Ok::<_, Failure>(Some((lines, windows)))
        },
        |_| {},
    )?;
    let (lines, windows): (Vec<String>, Vec<Vec<u8>>) = described.into_iter().flatten().unzip();
    let head = format!("{HEAD}{}\n", FEATURES.join(","));
    std::fs::create_dir_all(&out)?;
    std::fs::write(out.join("pulls.csv"), head + &lines.concat())?;
    std::fs::write(out.join("windows.u8"), windows.concat())?;
    Ok(())
}
