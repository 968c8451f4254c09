//! Executes the segments of a pick and place, one after the other. Each is confirmed, logged and verified.
//!
//! In: a route, checked as a whole beforehand. Out: what the fingers held, and where they closed and
//! opened; else the error, the last verified segment, and whether the arm is verified to be stopped. On any error, and
//! on a panic, the arm is stopped before anything else happens.

use super::driver::{ArmError, ArmState, Halt, HandContents};
use super::journal::{Entry, Journal};
use super::limits::Limited;
use super::port::Port;
use super::route::{Act, Route, Segment, SegmentName};
use super::supervisor::{MotionRequest, Supervisor, Watchdog};
use fab_base::interrupt::Interrupt;
use nalgebra::Point3;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Interval between two checks of the supervisor while motion is not allowed, seconds.
const ALLOWED_POLL_S: f64 = 0.05;

/// Everything that is needed to execute one pick and place.
pub struct Execution<'e, P: Port + ?Sized> {
    /// The arm, within its limits.
    pub arm: &'e mut Limited<P>,
    /// Its journal.
    pub log: &'e mut Journal,
    /// Who confirms motion.
    pub supervisor: &'e mut dyn Supervisor,
    /// Stops the arm if this program hangs.
    pub watchdog: &'e mut dyn Watchdog,
    /// The user's request to end.
    pub interrupt: &'e Interrupt,
    /// The number of the pick and place within the run, from 1.
    pub number: u32,
}

/// A pick and place that was completed and verified.
#[derive(Clone, Debug, PartialEq)]
pub struct CompletedAction {
    /// What was between the closed fingers.
    pub contents: HandContents,
    /// Where the tool was when they closed, base frame, metres.
    pub grasped_at: Point3<f64>,
    /// Where it was when they opened again; equal to `grasped_at` if they did not.
    pub released_at: Point3<f64>,
    /// How long it took, seconds.
    pub duration_s: f64,
}

/// A pick and place that was not completed.
#[derive(Clone, Debug, PartialEq)]
pub struct FailedAction {
    /// Why.
    pub why: ArmError,
    /// The segment in which it ended; `None` if none was started.
    pub in_segment: Option<SegmentName>,
    /// The last segment that was verified.
    pub verified: Option<SegmentName>,
    /// Whether the stop of the arm was verified; `None` if no stop was requested.
    pub stopped: Option<Result<(), ArmError>>,
}

impl std::fmt::Display for FailedAction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.in_segment {
            Some(name) => write!(f, "in `{}`: {}", name.name(), self.why)?,
            None => write!(f, "{}", self.why)?,
        }
        match self.verified {
            Some(name) => write!(f, "; verified up to `{}`", name.name())?,
            None => f.write_str("; no motion of this action is verified")?,
        }
        match &self.stopped {
            Some(Ok(())) => f.write_str("; the arm is verified to be stopped"),
            Some(Err(error)) => write!(f, "; {error}"),
            None => Ok(()),
        }
    }
}

impl<P: Port + ?Sized> Execution<'_, P> {
    /// Executes the segments.
    ///
    /// - `points`: pick and place, metres, base frame, for the supervisor's question.
    /// - `route`: checked as a whole; a motion is checked again only if the arm is not where the motion begins.
    pub fn run(
        &mut self,
        points: [Point3<f64>; 2],
        route: &Route,
    ) -> Result<CompletedAction, FailedAction> {
        let Route {
            segments,
            after_missed_grasp,
            motions,
        } = route;
        self.arm.plan(motions);
        let begun_s = self.arm.arm().now_s();
        let mut verified = None;
        let nothing_moved = |why| FailedAction {
            why,
            in_segment: None,
            verified: None,
            stopped: None,
        };
        if self.interrupt.is_raised() {
            return Err(nothing_moved(ArmError::Interrupted));
        }
        let asked = MotionRequest::Action {
            number: self.number,
            points,
            segments,
        };
        if !self.supervisor.confirm(asked) {
            return Err(nothing_moved(self.not_confirmed()));
        }
        let mut contents = HandContents::Unknown;
        let mut grasped_at = points[0];
        let mut released_at = None;
        let mut rest: Vec<Segment> = segments.clone();
        rest.reverse();
        while let Some(segment) = rest.pop() {
            let done = match self.segment(&segment) {
                Ok(done) => done,
                Err(why) => {
                    if let ArmError::JournalAfterMotion(_) = why {
                        verified = Some(segment.name);
                    }
                    return Err(self.fail(why, segment.name, verified));
                }
            };
            verified = Some(segment.name);
            match segment.name {
                SegmentName::Grasp => {
                    contents = done.contents;
                    grasped_at = done.at;
                    if contents == HandContents::Nothing {
                        rest = after_missed_grasp.iter().rev().copied().collect();
                    }
                }
                SegmentName::Release => released_at = Some(done.at),
                _ => {}
            }
        }
        Ok(CompletedAction {
            contents,
            grasped_at,
            released_at: released_at.unwrap_or(grasped_at),
            duration_s: self.arm.arm().now_s() - begun_s,
        })
    }

    /// Executes one segment, and restarts it from the current pose after a pause.
    fn segment(&mut self, segment: &Segment) -> Result<CompletedSegment, ArmError> {
        if !self.supervisor.confirm(MotionRequest::Segment(segment)) {
            return Err(self.not_confirmed());
        }
        loop {
            while !self.supervisor.motion_allowed() {
                if self.interrupt.is_raised() {
                    return Err(ArmError::Interrupted);
                }
                self.arm.arm().wait(ALLOWED_POLL_S);
            }
            let begun = self.log.begin(self.number, segment);
            begun.map_err(|error| ArmError::JournalBeforeMotion(error.to_string()))?;
            match self.motion(segment) {
                Err(ArmError::Paused) => continue,
                Err(why) => return Err(why),
                Ok(done) => {
                    let at_m = done.at.into();
                    let written = self.log.write(&Entry::Done { at_m });
                    written.map_err(|error| ArmError::JournalAfterMotion(error.to_string()))?;
                    return Ok(done);
                }
            }
        }
    }

    /// Returns why motion was not confirmed: an interrupted question has no answer.
    fn not_confirmed(&self) -> ArmError {
        if self.interrupt.is_raised() {
            ArmError::Interrupted
        } else {
            ArmError::NotConfirmed
        }
    }

    /// Moves while watchdog, interrupt and supervisor are checked.
    fn motion(&mut self, segment: &Segment) -> Result<CompletedSegment, ArmError> {
        self.watchdog.watch().map_err(silent_watchdog)?;
        let (interrupt, supervisor) = (self.interrupt, &mut *self.supervisor);
        let watchdog = &mut *self.watchdog;
        let mut watch = |_: &ArmState| {
            watchdog
                .beat()
                .map_err(|why| Halt::Stop(silent_watchdog(why)))?;
            if interrupt.is_raised() {
                return Err(Halt::Stop(ArmError::Interrupted));
            }
            if supervisor.motion_allowed() {
                Ok(())
            } else {
                Err(Halt::Pause)
            }
        };
        let (arm, speed_m_s) = (&mut *self.arm, segment.speed_m_s);
        let act = || {
            let (state, contents) = match segment.act {
                Act::Move(to) => {
                    let state = arm.move_tool(&to, speed_m_s, &mut watch)?;
                    (state, HandContents::Unknown)
                }
                Act::Hand(opening) => {
                    let contents = arm.move_fingers(opening, &mut watch)?;
                    (arm.arm().state()?, contents)
                }
            };
            let at = state.tool.translation.vector.into();
            Ok(CompletedSegment { at, contents })
        };
        // A panic becomes an error, so that the arm is stopped before anything else happens.
        let moved = catch_unwind(AssertUnwindSafe(act))
            .unwrap_or_else(|panic| Err(ArmError::Panicked(panic_message(panic.as_ref()))));
        match &moved {
            // The driver has verified that the arm is at rest.
            Ok(_) | Err(ArmError::Paused) => self.watchdog.rest(),
            Err(_) => {}
        }
        moved
    }

    /// Stops the arm and logs the failure.
    fn fail(
        &mut self,
        why: ArmError,
        in_segment: SegmentName,
        verified: Option<SegmentName>,
    ) -> FailedAction {
        // A motion that was refused before it started leaves the arm at rest and enabled.
        let moved = !matches!(
            why,
            ArmError::Refused(_) | ArmError::NotConfirmed | ArmError::JournalBeforeMotion(_)
        );
        let mut stopped = moved.then(|| self.arm.arm().stop());
        match &mut stopped {
            // The watchdog goes on watching until a stop is verified, and has a connection of its own to try.
            Some(Err(ArmError::NotStopped(why))) => match self.watchdog.stop() {
                Ok(()) => why.push_str("; the arm acknowledged a stop by the watchdog"),
                Err(error) => why.push_str(&format!("; the watchdog did not stop it: {error}")),
            },
            Some(Err(_)) => {}
            Some(Ok(())) | None => self.watchdog.rest(),
        }
        // A failure to log must not hide the error that ended the motion.
        let _ = self.log.write(&Entry::Halted {
            why: why.to_string(),
            stopped: stopped.as_ref().map(Result::is_ok),
        });
        FailedAction {
            why,
            in_segment: Some(in_segment),
            verified,
            stopped,
        }
    }
}

/// A segment that was completed and verified.
struct CompletedSegment {
    at: Point3<f64>,
    contents: HandContents,
}

fn silent_watchdog(why: String) -> ArmError {
    ArmError::Failed(format!("the watchdog does not answer: {why}"))
}

/// Returns the message of a panic.
fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "without words".to_owned())
}
