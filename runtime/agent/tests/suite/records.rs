//! Tests that rollouts' own types can read the example of `docs/records.md`.
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::record::{Line, RECORD_FILE, Record, RecordError, SPENT_FILE, Spent};
use fab_agent::rollout::event;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;

/// The lines of both files on the page, without its event.
fn examples() -> Vec<String> {
    let is_line = |block: &String| !block.contains("\"at_s\"");
    blocks().into_iter().filter(is_line).collect()
}

/// The blocks of the page, each on one line.
fn blocks() -> Vec<String> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/records.md");
    let page = std::fs::read_to_string(page).unwrap();
    let blocks = page.split("```json\n").skip(1);
    let texts = blocks.map(|block| block.split("```").next().unwrap());
    let values = texts.map(|text| serde_json::from_str::<Value>(text).unwrap());
    values.map(|value| value.to_string()).collect()
}

/// Reads a line and writes it again: nothing in it is unknown, and nothing is added.
fn read_and_written<T: DeserializeOwned + Serialize>(line: &str) {
    let read: T = serde_json::from_str(line).unwrap();
    assert_eq!(serde_json::to_string(&read).unwrap(), line);
}

#[test]
fn the_event_of_the_page_is_one() {
    let blocks = blocks();
    let mut events = blocks.iter().filter(|block| block.contains("\"at_s\""));
    read_and_written::<event::Line>(events.next().unwrap());
}

#[test]
fn the_example_of_the_page_is_a_record() {
    let examples = examples();
    let (lines, spent) = examples.split_at(3);
    lines.iter().for_each(|line| read_and_written::<Line>(line));
    spent
        .iter()
        .for_each(|line| read_and_written::<Spent>(line));

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(RECORD_FILE);
    std::fs::write(&file, lines.join("\n") + "\n").unwrap();
    std::fs::write(folder.path().join(SPENT_FILE), spent.join("\n") + "\n").unwrap();
    let record = Record::read(folder.path()).unwrap();
    assert_eq!(record.header.world, "sim");
    assert_eq!((record.steps.len(), record.spent.len()), (1, 1));
    assert!(record.steps[0].is_taken());
    let report = record.end.unwrap().report;
    assert_eq!((report.outcome, report.steps), (Outcome::HorizonReached, 1));
    assert_eq!(record.took.unwrap().spent.calls, 0);
}

#[test]
fn a_record_that_cannot_be_read_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(RECORD_FILE);
    let read = || Record::read(folder.path());
    assert!(matches!(read(), Err(RecordError::Absent(_))));
    let examples = examples();
    let (header, step) = (&examples[0], &examples[1]);

    // A line that was cut off was not written.
    std::fs::write(&file, format!("{header}\n{step}\n{{\"type\":\"st")).unwrap();
    let record = read().unwrap();
    assert_eq!((record.steps.len(), record.end), (1, None));

    for (text, why) in [
        (format!("{step}\n"), "it does not begin with a header"),
        (format!("{header}\n{header}\n"), "it has two headers"),
        (format!("{header}\n{{}}\n{step}\n"), "line 2 is damaged"),
        (
            header.replace("\"schema\":4", "\"schema\":9") + "\n",
            "its lines have version 9, and this program reads version 4",
        ),
    ] {
        std::fs::write(&file, text).unwrap();
        let error = read().unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}

#[test]
fn a_torn_record_is_gone_on_with_and_another_version_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let [file, spent_file] = [RECORD_FILE, SPENT_FILE].map(|name| folder.path().join(name));
    let examples = examples();
    let (lines, spent) = examples.split_at(3);
    let [header, step, end] = [0, 1, 2].map(|at| serde_json::from_str::<Line>(&lines[at]).unwrap());

    // Both files are cut in the middle of a line: resuming continues after their whole lines.
    std::fs::write(&file, format!("{}\n{{\"type\":\"st", lines[0])).unwrap();
    std::fs::write(&spent_file, format!("{}\n{{\"type\":\"st", spent[0])).unwrap();
    let mut run = RunFolder::reopen(folder.path()).unwrap();
    [header, step, end]
        .iter()
        .for_each(|line| run.append(line).unwrap());
    let took = spent[1..]
        .iter()
        .map(|line| serde_json::from_str::<Spent>(line).unwrap());
    took.for_each(|line| run.spend(&line).unwrap());
    drop(run);
    let record = Record::read(folder.path()).unwrap();
    assert_eq!((record.steps.len(), record.spent.len()), (1, 1));
    assert!(record.end.is_some() && record.took.is_some());

    // Another version is named, whatever its lines hold.
    let foreign = "{\"type\":\"header\",\"schema\":1,\"models\":[]}\n";
    std::fs::write(&file, foreign).unwrap();
    let version = RecordError::Version(1);
    assert_eq!(Record::read(folder.path()), Err(version));

    // A line of JSON that this version does not write.
    let foreign = format!(
        "{}\n",
        lines[0].replace("\"repetition\":0", "\"repetition\":\"first\"")
    );
    std::fs::write(&file, &foreign).unwrap();
    let error = RunFolder::reopen(folder.path()).unwrap_err().to_string();
    let why = "line 1 is not as this version of fabc writes it: invalid type: string";
    assert!(error.contains(why), "{error}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), foreign);
}
