//! Unit tests of `outbox`.

#![allow(clippy::unwrap_used)]

use super::*;
use std::sync::mpsc::channel;

const SOON: Duration = Duration::from_millis(20);
const LONG: Duration = Duration::from_secs(600);

#[test]
fn a_writer_that_blocks_blocks_nobody() {
    let (release, blocked) = channel::<()>();
    let (begin, begun) = channel();
    let mut outbox = Outbox::new(2, move |item: u32| {
        begin.send(item).unwrap();
        let _ = blocked.recv();
        Ok(())
    });
    let late = outbox.write(0, SOON).unwrap_err();
    assert!(late.starts_with("it was not written within"), "{late}");
    // One is in the writer's hands, and two wait.
    assert_eq!(begun.recv(), Ok(0));
    assert_eq!((outbox.send(1), outbox.send(2)), (Ok(()), Ok(())));
    assert_eq!(outbox.send(3), Err("its reader does not read".to_owned()));
    drop(release);
}

#[test]
fn items_are_written_in_their_order_and_a_failure_is_told() {
    let (sender, written) = channel();
    let mut outbox = Outbox::new(4, move |item: u32| match item {
        9 => Err("the disk is full".to_owned()),
        item => sender.send(item).map_err(|error| error.to_string()),
    });
    outbox.send(1).unwrap();
    outbox.write(2, LONG).unwrap();
    assert_eq!(outbox.write(9, LONG), Err("the disk is full".to_owned()));
    for item in [3, 4, 5] {
        outbox.send(item).unwrap();
    }
    drop(outbox);
    assert_eq!(written.iter().collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
}
