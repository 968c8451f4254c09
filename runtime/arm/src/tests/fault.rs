//! The kinds of what may go wrong with a simulated arm.

use serde::{Deserialize, Serialize};

fab_base::named! {
    /// A kind of fault.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum FaultKind {
        /// The next goal does not arrive.
        LostGoal = "lost_goal",
        /// The next three goals do not arrive.
        LostGoals = "lost_goals",
        /// The result of the next goal does not arrive.
        LostResult = "lost_result",
        /// Nothing is heard of the next goal that causes a motion, which is carried out.
        LostStatus = "lost_status",
        /// The next cancellation does not arrive.
        LostCancel = "lost_cancel",
        /// The next stop gets no answer and has no effect.
        LostStop = "lost_stop",
        /// No reading arrives from then on.
        Silence = "silence",
        /// No reading arrives for 0.6 s.
        ShortSilence = "short_silence",
        /// The last reading is published again and again, with its stamp, from then on.
        RepeatedReading = "repeated_reading",
        /// The arm jams during a motion and never moves again.
        StuckJoint = "stuck_joint",
        /// Somebody presses the stop.
        PressedStop = "pressed_stop",
        /// The next motion ends 7 mm short of its goal, and the node reports it as reached.
        FallsShort = "falls_short",
        /// Every motion ends 7 mm short.
        FallsShortAlways = "falls_short_always",
        /// The node aborts the next goal that causes a motion.
        AbortedGoal = "aborted_goal",
        /// The arm leaves its path and keeps turning.
        Runaway = "runaway",
        /// The fingers never move again.
        StuckFingers = "stuck_fingers",
        /// The camera never delivers a picture again.
        NoPicture = "no_picture",
    }
}
