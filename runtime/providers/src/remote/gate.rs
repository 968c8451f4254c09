//! Limits concurrent calls to one provider, over all rollouts.
//!
//! In: calls that begin and end. Out: permission to begin. The width grows by one after as many successes as it is
//! wide, up to a maximum, and is halved when the provider reports overload.

use super::INTERRUPT_POLL;
use fab_base::interrupt::Interrupt;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Lets a limited number of calls through at once; shared by all users of one provider.
#[derive(Debug)]
pub struct Gate {
    most: usize,
    state: Mutex<State>,
    freed: Condvar,
}

#[derive(Debug)]
struct State {
    width: usize,
    under_way: usize,
    successes: usize,
    /// How often it was narrowed: an overload of calls that were already in flight then does not narrow it again.
    narrowed: u64,
}

/// The result of a call as evidence of load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Load {
    /// The provider answered.
    Answered,
    /// It reported overload.
    TooMuch,
}

/// Permission for one call, held until it is dropped.
#[derive(Debug)]
pub(super) struct Pass<'g> {
    gate: &'g Gate,
    narrowed: u64,
}

impl Gate {
    /// Makes a gate for at most `most` concurrent calls, but at least one; it starts fully open.
    pub fn new(most: usize) -> Gate {
        let most = most.max(1);
        Gate {
            most,
            state: Mutex::new(State {
                width: most,
                under_way: 0,
                successes: 0,
                narrowed: 0,
            }),
            freed: Condvar::new(),
        }
    }

    /// Returns the current limit on concurrent calls.
    pub fn width(&self) -> usize {
        self.state().width
    }

    /// Waits until a call may begin; `None` if the user interrupts.
    pub(super) fn enter(&self, interrupt: &Interrupt) -> Option<Pass<'_>> {
        let mut state = self.state();
        loop {
            if interrupt.is_raised() {
                return None;
            }
            if state.under_way < state.width {
                state.under_way += 1;
                return Some(Pass {
                    gate: self,
                    narrowed: state.narrowed,
                });
            }
            let waited = self.freed.wait_timeout(state, INTERRUPT_POLL);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// A panic cannot leave the counts inconsistent, because each change is complete.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Pass<'_> {
    /// Reports how the call ended; without a report nothing changes.
    pub(super) fn tell(&self, load: Load) {
        let mut state = self.gate.state();
        match load {
            Load::TooMuch if state.narrowed == self.narrowed => {
                state.width = (state.width / 2).max(1);
                state.successes = 0;
                state.narrowed += 1;
            }
            Load::TooMuch => {}
            Load::Answered => {
                state.successes += 1;
                if state.successes >= state.width && state.width < self.gate.most {
                    state.width += 1;
                    state.successes = 0;
                }
            }
        }
    }
}

impl Drop for Pass<'_> {
    fn drop(&mut self) {
        self.gate.state().under_way -= 1;
        self.gate.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn end(gate: &Gate, load: Load) {
        let pass = gate.enter(&Interrupt::default()).expect("not stopped");
        pass.tell(load);
    }

    #[test]
    fn the_width_halves_on_overload_and_grows_by_one_after_as_many_successes() {
        let gate = Gate::new(8);
        end(&gate, Load::TooMuch);
        assert_eq!(gate.width(), 4);
        for _ in 0..3 {
            end(&gate, Load::Answered);
        }
        assert_eq!(gate.width(), 4);
        end(&gate, Load::Answered);
        assert_eq!(gate.width(), 5);
        for _ in 0..200 {
            end(&gate, Load::Answered);
        }
        assert_eq!(gate.width(), 8);
        for _ in 0..9 {
            end(&gate, Load::TooMuch);
        }
        assert_eq!(gate.width(), 1);
    }

    #[test]
    fn calls_that_were_under_way_together_narrow_it_once() {
        let gate = Gate::new(8);
        let interrupt = Interrupt::default();
        let passes: Vec<_> = (0..8).filter_map(|_| gate.enter(&interrupt)).collect();
        for pass in &passes {
            pass.tell(Load::TooMuch);
        }
        assert_eq!(gate.width(), 4);
    }

    #[test]
    fn no_more_calls_are_under_way_than_the_gate_is_wide() {
        let gate = Gate::new(3);
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..12 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let pass = gate.enter(&Interrupt::default());
                        most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                        std::thread::yield_now();
                        now.fetch_sub(1, Ordering::SeqCst);
                        drop(pass);
                    }
                });
            }
        });
        assert_eq!(most.into_inner(), 3);
    }

    #[test]
    fn an_interrupt_ends_the_waiting() {
        let gate = Gate::new(1);
        let interrupt = Interrupt::default();
        let held = gate.enter(&interrupt);
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| gate.enter(&interrupt).is_none());
            interrupt.raise();
            assert!(waiting.join().expect("no panic"));
        });
        drop(held);
    }
}
