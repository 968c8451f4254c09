//! How the gripper goes about a pick and place, where a task says so.
//!
//! A task states these values for every action, in `picker put_down(lift: 100mm)`, or offers them to the model as fields
//! of the action, `lift: one of 0mm, 30mm`. Either way they act on the simulator and on an arm.

use crate::vocabulary::{Arg, Args, Default as Without, Kind, Range};
use serde::{Deserialize, Serialize};

/// How the gripper goes about one pick and place. What is not stated is left to the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manner {
    /// How far the held point rises above where it was grasped before it is carried, metres; 0 drags it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lift_m: Option<f64>,
    /// Speed of the gripper while it holds the cloth, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_m_s: Option<f64>,
    /// How far above the height of its grasp the held point is let go, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release_height_m: Option<f64>,
    /// The length of the crease that the gripper presses after the release, metres; 0 presses nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub press_m: Option<f64>,
}

/// How far the cloth is lifted.
pub const LIFT: Arg = field(
    "lift",
    Range::new("a lift", (0.0, "mm"), (300.0, "mm")),
    "how far the held point rises above where it was grasped, before it is carried; 0 drags it over the table",
);

/// How fast the gripper carries.
pub const SPEED: Arg = field(
    "speed",
    Range::new("a speed", (20.0, "mm/s"), (1000.0, "mm/s")),
    "how fast the gripper moves while it holds the cloth",
);

/// From which height the cloth is let go.
pub const RELEASE_HEIGHT: Arg = field(
    "release_height",
    Range::new("a height", (0.0, "mm"), (300.0, "mm")),
    "how far above the height of its grasp the held point is let go; 0 puts it down",
);

/// How much of the crease is pressed.
pub const PRESS: Arg = field(
    "press",
    Range::new("a length", (0.0, "mm"), (1000.0, "mm")),
    "after the release, the gripper presses this much of the crease, half of it on each side of the middle between pick and place; 0 presses nothing",
);

/// Returns the place of a field's value.
type Slot = fn(&mut Manner) -> &mut Option<f64>;

const SLOTS: [(Arg, Slot); 4] = [
    (LIFT, |manner| &mut manner.lift_m),
    (SPEED, |manner| &mut manner.speed_m_s),
    (RELEASE_HEIGHT, |manner| &mut manner.release_height_m),
    (PRESS, |manner| &mut manner.press_m),
];

/// Every field of a manner.
pub const MANNERS: &[Arg] = &[SLOTS[0].0, SLOTS[1].0, SLOTS[2].0, SLOTS[3].0];

const fn field(name: &'static str, range: Range, doc: &'static str) -> Arg {
    Arg::named(name, Kind::Quantity(range), doc).or(Without::Nothing)
}

impl Manner {
    /// Roughly what `put_down` does where nothing is stated.
    pub const USUAL: Manner = Manner {
        lift_m: Some(0.05),
        speed_m_s: Some(0.5),
        release_height_m: Some(0.0),
        press_m: Some(0.0),
    };

    /// Returns what it states of a field, or the usual; metres, or metres per second. `None` for a name that is none of
    /// [`MANNERS`].
    pub fn or_usual(&self, name: &str) -> Option<f64> {
        self.get(name).or(Manner::USUAL.get(name))
    }

    /// Returns whether nothing is stated.
    pub fn is_default(&self) -> bool {
        *self == Manner::default()
    }

    /// Returns the manner that arguments named as in [`MANNERS`] state.
    pub fn from_args(args: &Args) -> Manner {
        let mut manner = Manner::default();
        for arg in MANNERS.iter().filter(|arg| args.is_given(arg.name)) {
            manner.set(arg.name, args.number(arg.name));
        }
        manner
    }

    /// Returns the fields that are stated, with their values in metres and seconds.
    pub fn stated(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let manner = *self;
        MANNERS
            .iter()
            .filter_map(move |arg| Some((arg.name, manner.get(arg.name)?)))
    }

    /// Returns the same manner with one field stated; a name that is none of [`MANNERS`] changes nothing.
    ///
    /// - `value`: metres, or metres per second.
    pub fn with(mut self, name: &str, value: f64) -> Manner {
        self.set(name, value);
        self
    }

    fn get(mut self, name: &str) -> Option<f64> {
        self.slot(name).and_then(|value| *value)
    }

    fn set(&mut self, name: &str, value: f64) {
        if let Some(slot) = self.slot(name) {
            *slot = Some(value);
        }
    }

    fn slot(&mut self, name: &str) -> Option<&mut Option<f64>> {
        let (_, slot) = SLOTS.iter().find(|(arg, _)| arg.name == name)?;
        Some(slot(self))
    }
}

/// Returns the row of a field that says how the gripper goes about it; `None` for any other field.
pub fn manner_field(name: &str) -> Option<&'static Arg> {
    MANNERS.iter().find(|arg| arg.name == name)
}
