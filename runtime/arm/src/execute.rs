//! Carries the segments of a pick and place out, one after the other, each asked for, written down, and verified.
//!
//! In: segments that were all checked before the first. Out: what was between the fingers and where they closed and
//! opened, verified; else the error, the last segment that is verified, and whether the arm is verified to be stopped.
//! Whatever goes wrong, and be it a panic, the arm is told to stop before anything else happens.

use super::driver::{Arm, ArmError, ArmState, Between, Halt, Opening};
use super::log::{ArmLog, Entry, LogError};
use super::route::{Act, Name, Segment};
use super::supervisor::{Asked, Supervisor, Watchdog};
use fab_base::interrupt::Interrupt;
use nalgebra::{Isometry3, Point3};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How long to wait between two looks at a person who does not hold the key, seconds.
const HOLD_S: f64 = 0.05;

/// Everything around the arm while it moves.
pub struct Execution<'e> {
    /// The arm, within its limits.
    pub arm: &'e mut dyn Arm,
    /// Its journal.
    pub log: &'e mut ArmLog,
    /// Who gives leave.
    pub supervisor: &'e mut dyn Supervisor,
    /// Who stops it when this program hangs.
    pub watchdog: &'e mut dyn Watchdog,
    /// A request to end.
    pub interrupt: &'e Interrupt,
    /// Speed of the tool, m/s.
    pub speed_m_s: f64,
    /// Which pick and place of the run it is, from 1.
    pub number: u32,
}

/// What was done, all of it verified.
#[derive(Clone, Debug, PartialEq)]
pub struct Done {
    /// What was between the fingers when they had closed.
    pub between: Between,
    /// Where the tool was when they closed, base frame, metres.
    pub grasped_at: Point3<f64>,
    /// Where it was when they opened again; where nothing was grasped, where they closed.
    pub released_at: Point3<f64>,
    /// How long it took, seconds.
    pub duration_s: f64,
}

/// What is known of a pick and place that was not carried out to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Why.
    pub why: ArmError,
    /// The segment in which it ended; none where none was begun.
    pub in_segment: Option<Name>,
    /// The last segment that is verified to be done.
    pub verified: Option<Name>,
    /// Whether the arm takes no motion any more; none where it was not told to stop.
    pub stopped: Option<Result<(), ArmError>>,
}

impl std::fmt::Display for Broken {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.in_segment {
            Some(name) => write!(f, "in `{}`: {}", name.text(), self.why)?,
            None => write!(f, "{}", self.why)?,
        }
        match self.verified {
            Some(name) => write!(f, "; verified up to `{}`", name.text())?,
            None => f.write_str("; no motion of this action is verified")?,
        }
        match &self.stopped {
            Some(Ok(())) => f.write_str("; the arm is verified to be stopped"),
            Some(Err(error)) => write!(f, "; {error}"),
            None => Ok(()),
        }
    }
}

impl Execution<'_> {
    /// Carries the segments out.
    ///
    /// - `points`: where it picks and places, base frame, for the person who is asked.
    /// - `without_cloth`: what follows where nothing was between the fingers.
    pub fn run(
        &mut self,
        points: [Point3<f64>; 2],
        segments: &[Segment],
        without_cloth: &[Segment],
    ) -> Result<Done, Broken> {
        let begun_s = self.arm.now_s();
        let mut verified = None;
        let nothing_moved = |why| Broken {
            why,
            in_segment: None,
            verified: None,
            stopped: None,
        };
        if self.interrupt.is_raised() {
            return Err(nothing_moved(ArmError::Interrupted));
        }
        let asked = Asked::Action {
            number: self.number,
            points,
            segments,
        };
        if !self.supervisor.allows(asked) {
            return Err(nothing_moved(self.no_leave()));
        }
        let mut between = Between::Unknown;
        let mut grasped_at = points[0];
        let mut released_at = None;
        let mut rest: Vec<Segment> = segments.to_vec();
        rest.reverse();
        while let Some(segment) = rest.pop() {
            let done = match self.segment(&segment) {
                Ok(done) => done,
                Err(why) => {
                    if let ArmError::Unwritten(_) = why {
                        verified = Some(segment.name);
                    }
                    return Err(self.broken(why, segment.name, verified));
                }
            };
            verified = Some(segment.name);
            match segment.name {
                Name::Grasp => {
                    between = done.between;
                    grasped_at = done.at;
                    if between == Between::Nothing {
                        rest = without_cloth.iter().rev().copied().collect();
                    }
                }
                Name::Release => released_at = Some(done.at),
                _ => {}
            }
        }
        Ok(Done {
            between,
            grasped_at,
            released_at: released_at.unwrap_or(grasped_at),
            duration_s: self.arm.now_s() - begun_s,
        })
    }

    /// Carries one segment out: again from where the arm is, where a person lets the key go on its way.
    fn segment(&mut self, segment: &Segment) -> Result<SegmentDone, ArmError> {
        if !self.supervisor.allows(Asked::Segment(segment)) {
            return Err(self.no_leave());
        }
        loop {
            while !self.supervisor.is_holding() {
                if self.interrupt.is_raised() {
                    return Err(ArmError::Interrupted);
                }
                self.arm.wait(HOLD_S);
            }
            let from = self.arm.state()?;
            let journal = |error: LogError| ArmError::Journal(error.to_string());
            let begun = self.log.begin(self.number, segment, &from.tool);
            begun.map_err(journal)?;
            match self.motion(segment) {
                Err(ArmError::Paused) => continue,
                Err(why) => return Err(why),
                Ok((tool, between)) => {
                    let at_m: [f64; 3] = tool.translation.vector.into();
                    let unwritten = |error: LogError| ArmError::Unwritten(error.to_string());
                    self.log.write(&Entry::Done { at_m }).map_err(unwritten)?;
                    return Ok(SegmentDone {
                        at: Point3::from(at_m),
                        between,
                    });
                }
            }
        }
    }

    /// Says why there is no leave to move: a question that is put when the program is asked to end has no answer.
    fn no_leave(&self) -> ArmError {
        match self.interrupt.is_raised() {
            true => ArmError::Interrupted,
            false => ArmError::NotConfirmed,
        }
    }

    /// Moves, under every eye that watches.
    fn motion(&mut self, segment: &Segment) -> Result<(Isometry3<f64>, Between), ArmError> {
        self.watchdog.watch().map_err(ArmError::Watchdog)?;
        let (interrupt, supervisor) = (self.interrupt, &mut *self.supervisor);
        let watchdog = &mut *self.watchdog;
        let mut watch = |_: &ArmState| {
            watchdog
                .beat()
                .map_err(|why| Halt::Stop(ArmError::Watchdog(why)))?;
            if interrupt.is_raised() {
                return Err(Halt::Stop(ArmError::Interrupted));
            }
            match supervisor.is_holding() {
                true => Ok(()),
                false => Err(Halt::Pause),
            }
        };
        let (arm, speed_m_s) = (&mut *self.arm, self.speed_m_s);
        let act = || match segment.act {
            Act::Move(to) => {
                let moved = arm.move_tool(&to, speed_m_s, &mut watch);
                moved.map(|state| (state.tool, Between::Unknown))
            }
            Act::Hand(opening) => {
                let moved = arm.move_fingers(opening, &mut watch);
                moved.and_then(|between| Ok((arm.state()?.tool, between)))
            }
        };
        // Whatever breaks while the arm moves, it is stopped before anything else, and told with what is verified.
        let moved = catch_unwind(AssertUnwindSafe(act))
            .unwrap_or_else(|panic| Err(ArmError::Panicked(words(panic.as_ref()))));
        match &moved {
            // The driver has seen that the arm is at rest, under the same eyes.
            Ok(_) | Err(ArmError::Paused) => self.watchdog.rest(),
            Err(_) => {}
        }
        moved
    }

    /// Stops the arm, and writes down what is known.
    fn broken(&mut self, why: ArmError, in_segment: Name, verified: Option<Name>) -> Broken {
        // What was refused before it moved leaves the arm at rest, and enabled for whoever looks after it.
        let moved = !matches!(
            why,
            ArmError::Refused(_) | ArmError::NotConfirmed | ArmError::Journal(_)
        );
        let stopped = moved.then(|| self.arm.stop());
        self.watchdog.rest();
        // The error that is told is the one that ended the motion.
        let _ = self.log.write(&Entry::Halted {
            why: why.to_string(),
            stopped: stopped.as_ref().map(Result::is_ok),
        });
        Broken {
            why,
            in_segment: Some(in_segment),
            verified,
            stopped,
        }
    }
}

/// What one segment came to.
struct SegmentDone {
    at: Point3<f64>,
    between: Between,
}

/// Returns what a panic said.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "without words".to_owned())
}

/// Returns what follows where nothing was between the fingers: up, and out of the camera's view.
pub fn without_cloth(segments: &[Segment], pick: &Point3<f64>, retreat_m: f64) -> Vec<Segment> {
    let Some(Act::Move(over)) = segments
        .iter()
        .find(|segment| segment.name == Name::OverPick)
        .map(|segment| segment.act)
    else {
        return Vec::new();
    };
    let mut up = over;
    up.translation.vector.z = pick.z + retreat_m;
    let act = |name, act| Segment { name, act };
    let mut tail = vec![
        act(Name::Up, Act::Move(up)),
        act(Name::Release, Act::Hand(Opening::Open)),
        act(Name::Away, Act::Move(over)),
    ];
    tail.extend(segments.iter().filter(|segment| segment.name == Name::Rest));
    tail
}
