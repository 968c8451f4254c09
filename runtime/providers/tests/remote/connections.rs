//! Tests of failing connections: refused, cut, slow, endless.

use crate::support::*;
use fab_model::calls::{Billing, FailedCall, Fault};
use fab_model::{Model, ModelError};
use fab_providers::remote::most_calls;
use std::net::{Shutdown, TcpListener};
use std::thread;
use std::time::Duration;

fn fault_of(trial: &Trial, notes: &mut Notes) -> Fault {
    match trial.model().ask(&request(), notes).unwrap_err() {
        ModelError::Failed { fault, .. } => fault,
        other => panic!("{other}"),
    }
}

#[test]
fn a_host_that_takes_no_connection_is_unreachable_and_bills_nothing() {
    let free = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap();
    let trial = Trial::of(&format!("http://{free}"));
    let mut notes = Notes::new();
    assert_eq!(fault_of(&trial, &mut notes), Fault::Unreachable);
    let count = most_calls(Fault::Unreachable) as usize;
    assert_eq!(
        notes.faults(),
        vec![(Fault::Unreachable, Billing::No); count]
    );
}

#[test]
fn connections_that_are_cut_are_named_wherever_the_cut_comes() {
    let whole = good_body("there").to_string();
    let head = |length: usize| format!("HTTP/1.1 200 OK\r\ncontent-length: {length}\r\n\r\n");
    let half_of_body = format!("{}{}", head(whole.len()), &whole[..whole.len() / 2]);
    for said in [
        String::new(),
        "HTTP/1.1 200".to_owned(),
        head(10),
        half_of_body,
    ] {
        let sent = said.clone();
        let rude = Rude::acting(move |stream| {
            say(stream, &sent);
            let _ = stream.shutdown(Shutdown::Both);
        });
        let mut notes = Notes::new();
        let fault = fault_of(&Trial::of(&rude.url()), &mut notes);
        assert_eq!(fault, Fault::ConnectionCut, "after {said:?}");
        let count = most_calls(Fault::ConnectionCut) as usize;
        assert_eq!(rude.count(), count, "after {said:?}");
        assert_eq!(
            notes.faults(),
            vec![(Fault::ConnectionCut, Billing::Possibly); count]
        );
    }
}

#[test]
#[ignore = "long"]
fn a_server_that_says_nothing_or_drips_is_timed_out_by_the_whole_call() {
    let acts: [fn(&mut std::net::TcpStream); 2] = [
        |_| thread::sleep(Duration::from_secs(5)),
        |stream| {
            say(stream, "HTTP/1.1 200 OK\r\ncontent-length: 1000\r\n\r\n");
            for _ in 0..100 {
                say(stream, " ");
                thread::sleep(Duration::from_millis(50));
            }
        },
    ];
    for act in acts {
        let rude = Rude::acting(move |stream| {
            let mut own = stream.try_clone().unwrap();
            thread::spawn(move || act(&mut own));
        });
        let mut trial = Trial::of(&rude.url());
        trial.settings.timeout = Duration::from_millis(300);
        let mut notes = Notes::new();
        assert_eq!(fault_of(&trial, &mut notes), Fault::TimedOut);
        let count = most_calls(Fault::TimedOut) as usize;
        assert_eq!(rude.count(), count);
        assert_eq!(
            notes.faults(),
            vec![(Fault::TimedOut, Billing::Possibly); count]
        );
    }
}

#[test]
fn an_endless_reply_is_not_read_to_its_end() {
    let rude = Rude::acting(|stream| {
        say(stream, "HTTP/1.1 200 OK\r\n\r\n");
        let piece = " ".repeat(1 << 20);
        for _ in 0..40 {
            say(stream, &piece);
        }
    });
    let mut notes = Notes::new();
    let fault = fault_of(&Trial::of(&rude.url()), &mut notes);
    assert_eq!(fault, Fault::InvalidReply);
    let Told::Failed(FailedCall { why, .. }) = &notes.ends()[0] else {
        panic!("{:?}", notes.told);
    };
    assert!(why.contains("longer than the limit"), "{why}");
}

#[test]
fn what_is_no_http_is_a_failure_that_is_told() {
    let rude = Rude::acting(|stream| say(stream, "SSH-2.0-OpenSSH\r\n\r\n"));
    let mut notes = Notes::new();
    assert_eq!(
        fault_of(&Trial::of(&rude.url()), &mut notes),
        Fault::ConnectionCut
    );
}
