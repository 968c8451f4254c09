//! Tests of a pick and place from its first segment to its last, and of everything that ends it early.

use super::*;
use crate::driver::{ArmError, HandContents};
use crate::journal::{ARM_FILE, Begun, Entry};
use crate::route::SegmentName;
use crate::supervisor::{MotionRequest, NoWatchdog, Unattended};
use fab_world::start::Start;
use std::fs;

fn entries(folder: &Path) -> Vec<Entry> {
    let text = fs::read_to_string(folder.join(ARM_FILE)).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
    lines.collect()
}

fn begun(folder: &Path) -> Vec<SegmentName> {
    let names = entries(folder).into_iter().filter_map(|entry| match entry {
        Entry::Begin(Begun { segment, .. }) => Some(segment),
        _ => None,
    });
    names.collect()
}

/// Acts at the `looks`th check during the motion of one segment.
struct At<F: FnMut() -> bool> {
    segment: usize,
    looks: u32,
    now: usize,
    looked: u32,
    act: F,
}

impl<F: FnMut() -> bool> At<F> {
    fn new(segment: usize, looks: u32, act: F) -> At<F> {
        At {
            segment,
            looks,
            now: 0,
            looked: 0,
            act,
        }
    }
}

impl<F: FnMut() -> bool> Supervisor for At<F> {
    fn confirm_cloth(&mut self, _: &Start) -> bool {
        true
    }

    fn confirm(&mut self, asked: MotionRequest<'_>) -> bool {
        if let MotionRequest::Segment(_) = asked {
            self.now += 1;
        }
        true
    }

    fn motion_allowed(&mut self) -> bool {
        if self.now == self.segment {
            self.looked += 1;
            if self.looked == self.looks {
                return (self.act)();
            }
        }
        true
    }
}

#[test]
fn a_pick_and_place_ends_where_it_says() {
    let mut bench = Bench::with(&[]);
    let names: Vec<SegmentName> = bench
        .route()
        .segments
        .iter()
        .map(|segment| segment.name)
        .collect();
    let done = bench.run(&mut Unattended, &mut NoWatchdog).unwrap();
    assert_eq!(done.contents, HandContents::Something);
    assert!((done.grasped_at - Point3::from(PICK_M)).norm() < 0.003);
    assert!((done.released_at - Point3::from(PLACE_M)).norm() < 0.003);
    assert!((bench.cloth.borrow().at - Point3::from(PLACE_M)).norm() < 0.003);
    assert!(bench.off_m(bench.settings.workspace.rest_m) < 0.003);
    assert_eq!(begun(bench.folder()), names);
    let entries = entries(bench.folder());
    for pair in entries.chunks(2) {
        assert!(
            matches!(pair, [Entry::Begin(_), Entry::Done { .. }]),
            "{pair:?}"
        );
    }
}

#[test]
fn a_stated_manner_is_how_the_arm_goes_about_it() {
    let cases = [
        (By::Trajectories, 0.0, 0.0),
        (By::Trajectories, 0.06, 0.03),
        (By::Trajectories, 0.02, 0.08),
    ];
    for (by, lift_m, release_m) in cases {
        let mut usual = Bench::driven(by, &[]);
        let usual = usual.run(&mut Unattended, &mut NoWatchdog);
        let usual_s = usual.unwrap().duration_s;
        let mut bench = Bench::driven(by, &[]);
        bench.manner = Manner {
            lift_m: Some(lift_m),
            speed_m_s: Some(0.03),
            release_height_m: Some(release_m),
            press_m: None,
        };
        let done = bench.run(&mut Unattended, &mut NoWatchdog).unwrap();
        assert_eq!(done.contents, HandContents::Something);
        assert!(bench.off_m(bench.settings.workspace.rest_m) < 0.003);
        let grasped_m = PICK_M[2] + bench.settings.motion.grasp_m;
        let heights: Vec<(SegmentName, f64)> = entries(bench.folder())
            .into_iter()
            .filter_map(|entry| match entry {
                Entry::Begin(Begun { segment, to_m, .. }) => Some((segment, to_m?[2] - grasped_m)),
                _ => None,
            })
            .collect();
        let height_m = |name| heights.iter().find(|(it, _)| *it == name).map(|it| it.1);
        let is = |name, expected_m: f64| {
            let height_m = height_m(name).unwrap();
            assert!((height_m - expected_m).abs() < 1e-9, "{name:?}: {height_m}");
        };
        is(SegmentName::Over, lift_m);
        is(SegmentName::DownToPlace, release_m);
        assert_eq!(height_m(SegmentName::Lift).is_some(), lift_m > 0.0);
        // The hand never goes down again before it goes up from the cloth.
        assert!(height_m(SegmentName::Up).unwrap() >= release_m);
        assert!(
            done.duration_s > usual_s + 1.0,
            "{} {usual_s}",
            done.duration_s
        );
    }
}

#[test]
fn every_motion_is_written_down_before_it_begins() {
    struct Counter(usize);
    impl Supervisor for Counter {
        fn confirm_cloth(&mut self, _: &Start) -> bool {
            true
        }
        fn confirm(&mut self, asked: MotionRequest<'_>) -> bool {
            self.0 += usize::from(matches!(asked, MotionRequest::Segment(_)));
            true
        }
    }
    struct Looking<'l>(&'l Path, usize);
    impl Watchdog for Looking<'_> {
        fn watch(&mut self) -> Result<(), String> {
            self.1 += 1;
            self.beat()
        }
        fn beat(&mut self) -> Result<(), String> {
            let last = entries(self.0).pop();
            assert!(matches!(last, Some(Entry::Begin(_))), "{last:?}");
            assert_eq!(begun(self.0).len(), self.1);
            Ok(())
        }
        fn rest(&mut self) {}
        fn stop(&mut self) -> Result<(), String> {
            unreachable!("the arm is stopped without it")
        }
    }
    let mut bench = Bench::with(&[]);
    let folder = bench.folder().to_owned();
    let mut counter = Counter(0);
    let mut watchdog = Looking(&folder, 0);
    bench.run(&mut counter, &mut watchdog).unwrap();
    assert_eq!(counter.0, watchdog.1);
}

#[test]
#[ignore = "long"]
fn an_interrupt_stops_the_arm_in_every_segment() {
    let count = Bench::with(&[]).route().segments.len();
    for segment in 1..=count {
        for looks in [1, 2, 5] {
            let mut bench = Bench::with(&[]);
            let interrupt = bench.interrupt.clone();
            let mut raiser = At::new(segment, looks, || {
                interrupt.raise();
                true
            });
            let name = bench.route().segments[segment - 1].name;
            let broken = bench.run(&mut raiser, &mut NoWatchdog).unwrap_err();
            assert_eq!(broken.why, ArmError::Interrupted, "{segment}");
            assert_eq!(broken.stopped, Some(Ok(())), "{segment}");
            assert_eq!(broken.in_segment, Some(name));
            bench.stays_stopped();
            let last = entries(bench.folder()).pop();
            assert!(
                matches!(
                    last,
                    Some(Entry::Halted {
                        stopped: Some(true),
                        ..
                    })
                ),
                "{last:?}"
            );
        }
    }
}

#[test]
fn a_mistake_of_this_program_stops_the_arm() {
    for segment in [1, 3, 6, 9] {
        let mut bench = Bench::with(&[]);
        let mut breaks = At::new(segment, 4, || panic!("a mistake"));
        let broken = bench.run(&mut breaks, &mut NoWatchdog).unwrap_err();
        assert_eq!(broken.why, ArmError::Panicked("a mistake".to_owned()));
        assert_eq!(broken.stopped, Some(Ok(())));
        bench.stays_stopped();
    }
}

#[test]
#[ignore = "long"]
fn a_key_that_is_let_go_ends_no_segment() {
    let count = Bench::with(&[]).route().segments.len();
    for segment in 1..=count {
        let mut bench = Bench::with(&[]);
        // The key is released at the sixth check, and held again at the next.
        let mut lets_go = At::new(segment, 6, || false);
        let done = bench.run(&mut lets_go, &mut NoWatchdog).unwrap();
        assert_eq!(done.contents, HandContents::Something, "{segment}");
        assert!((bench.cloth.borrow().at - Point3::from(PLACE_M)).norm() < 0.003);
        assert!(bench.off_m(bench.settings.workspace.rest_m) < 0.003);
        let again = usize::from(lets_go.looked >= 6);
        assert_eq!(begun(bench.folder()).len(), count + again, "{segment}");
    }
}

#[test]
fn an_arm_does_not_move_while_the_key_is_not_held() {
    struct Never(Interrupt, u32);
    impl Supervisor for Never {
        fn confirm_cloth(&mut self, _: &Start) -> bool {
            true
        }
        fn confirm(&mut self, _: MotionRequest<'_>) -> bool {
            true
        }
        fn motion_allowed(&mut self) -> bool {
            self.1 += 1;
            if self.1 > 100 {
                self.0.raise();
            }
            false
        }
    }
    let mut bench = Bench::with(&[]);
    let mut never = Never(bench.interrupt.clone(), 0);
    let broken = bench.run(&mut never, &mut NoWatchdog).unwrap_err();
    assert_eq!(broken.why, ArmError::Interrupted);
    assert!(bench.off_m(bench.settings.workspace.rest_m) < 1e-6);
    bench.stays_stopped();
}

#[test]
fn an_empty_grasp_takes_the_short_way() {
    let mut bench = Bench::with(&[]);
    bench.take_cloth_away();
    let done = bench.run(&mut Unattended, &mut NoWatchdog).unwrap();
    assert_eq!(done.contents, HandContents::Nothing);
    let names = begun(bench.folder());
    let tail = [
        SegmentName::Grasp,
        SegmentName::Up,
        SegmentName::Release,
        SegmentName::Away,
        SegmentName::Rest,
    ];
    assert_eq!(names[names.len() - 5..], tail);
    assert!(bench.off_m(bench.settings.workspace.rest_m) < 0.003);
}

#[test]
fn a_watchdog_that_does_not_answer_stops_the_arm() {
    struct Deaf(u32);
    impl Watchdog for Deaf {
        fn watch(&mut self) -> Result<(), String> {
            Ok(())
        }
        fn beat(&mut self) -> Result<(), String> {
            self.0 += 1;
            match self.0 > 30 {
                true => Err("it is gone".to_owned()),
                false => Ok(()),
            }
        }
        fn rest(&mut self) {}
        fn stop(&mut self) -> Result<(), String> {
            Err("it is gone".to_owned())
        }
    }
    let mut bench = Bench::with(&[]);
    let broken = bench.run(&mut Unattended, &mut Deaf(0)).unwrap_err();
    assert_eq!(
        broken.why,
        ArmError::Failed("the watchdog does not answer: it is gone".to_owned())
    );
    bench.stays_stopped();
}

/// Counts what it was told.
#[derive(Default)]
struct Counting {
    is_watching: bool,
    n_stops: u32,
}

impl Watchdog for Counting {
    fn watch(&mut self) -> Result<(), String> {
        self.is_watching = true;
        Ok(())
    }
    fn beat(&mut self) -> Result<(), String> {
        Ok(())
    }
    fn rest(&mut self) {
        self.is_watching = false;
    }
    fn stop(&mut self) -> Result<(), String> {
        self.n_stops += 1;
        Err("no answer".to_owned())
    }
}

#[test]
fn a_watchdog_is_called_off_when_a_stop_is_verified_and_not_before() {
    for (lost, words) in [
        (&[][..], "; the arm is verified to be stopped"),
        (
            &[(FaultKind::LostStop, 0.0); 3][..],
            "; the arm was told to stop, and the stop could not be verified: use the physical stop (the service `in/stop`: no \
             answer within 1 s; the watchdog did not stop it: no answer)",
        ),
        (
            &[(FaultKind::Silence, 0.3)][..],
            "may be down; the watchdog did not stop it: no answer)",
        ),
    ] {
        let mut bench = Bench::with(lost);
        let interrupt = bench.interrupt.clone();
        let mut raiser = At::new(3, 2, || {
            interrupt.raise();
            true
        });
        let mut watchdog = Counting::default();
        let broken = bench.run(&mut raiser, &mut watchdog).unwrap_err();
        assert!(broken.to_string().ends_with(words), "{broken}");
        let is_verified = broken.stopped == Some(Ok(()));
        assert_eq!(watchdog.is_watching, !is_verified, "{broken}");
        assert_eq!(watchdog.n_stops, u32::from(!is_verified), "{broken}");
    }
}
