//! Tests that the user's interrupt ends every kind of wait.

use crate::support::*;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Billing, CallRefused, Fault};
use fab_model::{Model, ModelError};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

#[test]
fn a_call_that_waits_for_its_reply_ends_and_counts_as_possibly_billed() {
    let interrupt = Interrupt::default();
    let raised = interrupt.clone();
    let rude = Rude::acting(move |stream| {
        raised.raise();
        let held = stream.try_clone().unwrap();
        // Far longer than the test may take: only the interrupt can end the call.
        thread::spawn(move || {
            thread::sleep(Duration::from_secs(3600));
            drop(held);
        });
    });
    let mut trial = Trial::of(&rude.url());
    trial.settings.timeout = Duration::from_secs(3600);
    trial.shared.interrupt = interrupt;
    let mut notes = Notes::new();
    let error = trial.model().ask(&request(), &mut notes).unwrap_err();
    assert!(
        matches!(error, ModelError::NotSent(CallRefused::Interrupted)),
        "{error}"
    );
    assert_eq!(notes.faults(), [(Fault::ConnectionCut, Billing::Possibly)]);
    assert_eq!(rude.count(), 1);
}

#[test]
fn nothing_is_sent_after_an_interrupt_between_two_tries() {
    let provider = Provider::playing(vec![status(429)]);
    let mut trial = Trial::of(provider.base_url());
    trial.settings.retry.first_wait = Duration::from_secs(200);
    let interrupt = trial.shared.interrupt.clone();
    // The message comes before the wait.
    trial.shared.tell = Arc::new(move |_| interrupt.raise());
    let mut notes = Notes::new();
    let error = trial.model().ask(&request(), &mut notes).unwrap_err();
    assert!(
        matches!(error, ModelError::NotSent(CallRefused::Interrupted)),
        "{error}"
    );
    assert_eq!((provider.calls(), notes.ends().len()), (1, 1));
}

#[test]
fn nothing_is_sent_or_told_where_the_interrupt_came_before() {
    let provider = Provider::playing(vec![good("there")]);
    let trial = Trial::of(provider.base_url());
    trial.shared.interrupt.raise();
    let mut notes = Notes::new();
    let error = trial.model().ask(&request(), &mut notes).unwrap_err();
    assert!(
        matches!(error, ModelError::NotSent(CallRefused::Interrupted)),
        "{error}"
    );
    assert!(provider.calls() == 0 && notes.told.is_empty());
}
