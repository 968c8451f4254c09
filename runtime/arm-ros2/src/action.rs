//! A client of an action server, over three services and the topic of its goals' states.
//!
//! In: goals and cancellations. Out: the state of each goal, from the server's responses and its list of states.
//! `feedback` is not used: readings come from topics. Nothing here waits for a goal.

use super::Ros2Error;
use super::link::{Link, Quality, topic_name};
use super::messages::{
    CancelGoalRequest, CancelGoalResponse, GetResultRequest, GetResultResponse, GoalInfo,
    GoalStatusArray, Message, SendGoalRequest, SendGoalResponse, Uuid,
};
use super::service::{Client, Service};
use fab_arm::port::{Ending, GoalState};
use fab_arm::settings::Rmw;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::hash::{BuildHasher, RandomState};
use std::marker::PhantomData;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Interval at which a server is probed until it answers.
const ASK_EVERY: Duration = Duration::from_millis(200);
const POLL: Duration = Duration::from_millis(10);

/// The messages of one action.
pub(crate) trait Action: Send + Sync + 'static {
    /// The types in DDS of its two services of its own.
    const TYPES: [&'static str; 2];
    /// A goal.
    type Goal: Serialize + Send;
    /// A result.
    type Result: DeserializeOwned + Send;
}

struct SendGoal<A>(PhantomData<A>);

impl<A: Action> Service for SendGoal<A> {
    const TYPE: &'static str = A::TYPES[0];
    type Request = SendGoalRequest<A::Goal>;
    type Response = SendGoalResponse;
}

struct GetResult<A>(PhantomData<A>);

impl<A: Action> Service for GetResult<A> {
    const TYPE: &'static str = A::TYPES[1];
    type Request = GetResultRequest;
    type Response = GetResultResponse<A::Result>;
}

struct CancelGoal;

impl Service for CancelGoal {
    const TYPE: &'static str = "action_msgs::srv::dds_::CancelGoal";
    type Request = CancelGoalRequest;
    type Response = CancelGoalResponse;
}

type Id = [u8; 16];

/// The goals of a server, as far as it reported.
#[derive(Default)]
struct Ledger {
    goals: BTreeMap<Id, GoalState>,
    /// How often a cancellation was answered.
    n_cancelled: u64,
}

impl Ledger {
    /// Notes a status of `action_msgs/GoalStatus`; a goal that has ended stays so.
    fn update(&mut self, id: Id, status: i8) {
        let state = match status {
            1..=3 => GoalState::Active,
            4 => GoalState::Ended(Ending::Succeeded),
            5 => GoalState::Ended(Ending::Preempted),
            // A server that does not know its goal was started anew.
            _ => GoalState::Ended(Ending::Aborted),
        };
        if let Some(last) = self.goals.get_mut(&id)
            && !matches!(last, GoalState::Ended(_))
        {
            *last = state;
        }
    }
}

type Shared = Arc<Mutex<Ledger>>;

/// A connection to an action server.
pub(crate) struct ActionClient<A: Action> {
    name: String,
    goals: Client<SendGoal<A>, Id>,
    /// Kept for its thread's sake: results are asked for when a goal is accepted.
    _results: Arc<Client<GetResult<A>, Id>>,
    cancels: Client<CancelGoal, ()>,
    ledger: Shared,
}

impl<A: Action> ActionClient<A> {
    /// Opens the topics of the action `name`; whether a server is there shows later.
    pub(crate) fn open(link: &Link, name: &str, rmw: Rmw) -> Result<Self, Ros2Error> {
        let ledger = Shared::default();
        let service = |part: &str| format!("{name}/_action/{part}");
        let ended = Arc::clone(&ledger);
        let results = Client::open(
            link,
            &service("get_result"),
            rmw,
            move |id, response: GetResultResponse<A::Result>| {
                lock(&ended).update(id, response.status);
            },
        )?;
        let results: Arc<Client<GetResult<A>, Id>> = Arc::new(results);
        let (accepted, asked) = (Arc::clone(&ledger), Arc::clone(&results));
        let goals = Client::open(
            link,
            &service("send_goal"),
            rmw,
            move |id, response: SendGoalResponse| {
                if !response.accepted {
                    lock(&accepted)
                        .goals
                        .insert(id, GoalState::Ended(Ending::Rejected));
                    return;
                }
                lock(&accepted).update(id, 1);
                let goal_id = Uuid { uuid: id };
                // If it cannot be sent, the list of states tells how the goal ends.
                let _ = asked.send(GetResultRequest { goal_id }, id);
            },
        )?;
        let cancelled = Arc::clone(&ledger);
        let cancels = Client::open(
            link,
            &service("cancel_goal"),
            rmw,
            move |(), response: CancelGoalResponse| {
                let mut ledger = lock(&cancelled);
                ledger.n_cancelled += 1;
                for goal in response.goals_canceling {
                    // Also those of others: their ends show that everything was cancelled.
                    let last = ledger.goals.entry(goal.goal_id.uuid);
                    last.or_insert(GoalState::Active);
                }
            },
        )?;
        let listed = Arc::clone(&ledger);
        let states = topic_name(&service("status"));
        link.listen::<GoalStatusArray>(
            &states,
            GoalStatusArray::TYPE,
            Quality::Latched,
            move |heard| {
                // Responses carry the same; a list only makes up for a lost one.
                let Ok((list, _)) = heard else { return };
                let mut ledger = lock(&listed);
                for state in list.status_list {
                    ledger.update(state.goal_info.goal_id.uuid, state.status);
                }
            },
        )?;
        Ok(ActionClient {
            name: name.to_owned(),
            goals,
            _results: results,
            cancels,
            ledger,
        })
    }

    /// Sends a goal; returns its id.
    pub(crate) fn send(&self, goal: A::Goal) -> Result<String, String> {
        let id = unique_id();
        lock(&self.ledger).goals.insert(id, GoalState::Sent);
        let goal_id = Uuid { uuid: id };
        self.goals.send(SendGoalRequest { goal_id, goal }, id)?;
        Ok(text_of(&id))
    }
}

/// What all action clients have in common, whatever their messages.
pub(crate) trait Server {
    /// Returns the action's name, e.g. `/joint_trajectory_controller/follow_joint_trajectory`.
    fn name(&self) -> &str;
    /// Returns whether a server was found, or why the one that was found is another.
    fn is_found(&self, link: &Link) -> Result<bool, String>;
    /// Returns the state of a goal that was sent by this client.
    fn state(&self, id: &str) -> Option<GoalState>;
    /// Returns whether a goal is in this state, of this client or one that a cancellation named.
    fn has_goals(&self, state: GoalState) -> bool;
    /// Requests the cancellation of a goal.
    fn cancel(&self, id: &str) -> Result<(), String>;
    /// Requests the cancellation of every goal of the server, whoever sent it, and waits until it is answered.
    fn cancel_all(&self, deadline: Instant) -> Result<(), String>;
    /// Asks until the server answers; `false` if the deadline comes first.
    ///
    /// The question is the cancellation of a goal that nobody sent, which has no other effect. So a server that does
    /// not hear this client, or writes its answers for another middleware, is found before a goal is sent.
    fn wait_until_it_answers(&self, deadline: Instant) -> bool;
}

impl<A: Action> Server for ActionClient<A> {
    fn name(&self) -> &str {
        &self.name
    }

    fn is_found(&self, link: &Link) -> Result<bool, String> {
        self.goals.is_found(link)
    }

    fn state(&self, id: &str) -> Option<GoalState> {
        let id = id_of(id)?;
        lock(&self.ledger).goals.get(&id).cloned()
    }

    fn has_goals(&self, state: GoalState) -> bool {
        lock(&self.ledger).goals.values().any(|it| *it == state)
    }

    fn cancel(&self, id: &str) -> Result<(), String> {
        let id = id_of(id).ok_or("it was not sent from here")?;
        self.cancels.send(cancellation(id), ())
    }

    fn cancel_all(&self, deadline: Instant) -> Result<(), String> {
        let before = lock(&self.ledger).n_cancelled;
        // An id of zeros means all.
        self.cancels.send(cancellation([0; 16]), ())?;
        while lock(&self.ledger).n_cancelled == before {
            if Instant::now() >= deadline {
                return Err(format!(
                    "the server `{}` does not answer it: is the controller still running?",
                    self.name
                ));
            }
            std::thread::sleep(POLL);
        }
        Ok(())
    }

    fn wait_until_it_answers(&self, deadline: Instant) -> bool {
        let before = lock(&self.ledger).n_cancelled;
        let mut asked: Option<Instant> = None;
        while lock(&self.ledger).n_cancelled == before {
            if Instant::now() >= deadline {
                return false;
            }
            if asked.is_none_or(|at| at.elapsed() >= ASK_EVERY) {
                asked = Some(Instant::now());
                if self.cancels.send(cancellation(unique_id()), ()).is_err() {
                    return false;
                }
            }
            std::thread::sleep(POLL);
        }
        true
    }
}

fn cancellation(id: Id) -> CancelGoalRequest {
    CancelGoalRequest {
        goal_info: GoalInfo {
            goal_id: Uuid { uuid: id },
            ..GoalInfo::default()
        },
    }
}

/// Returns a random id, in the form of a UUID of version 4.
fn unique_id() -> Id {
    let half = || RandomState::new().hash_one(Instant::now());
    let mut id = [0; 16];
    id[..8].copy_from_slice(&half().to_le_bytes());
    id[8..].copy_from_slice(&half().to_le_bytes());
    id[6] = id[6] & 0x0f | 0x40;
    id[8] = id[8] & 0x3f | 0x80;
    id
}

fn text_of(id: &Id) -> String {
    id.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn id_of(text: &str) -> Option<Id> {
    let number = u128::from_str_radix(text, 16).ok()?;
    (text.len() == 32).then(|| number.to_be_bytes())
}

fn lock(ledger: &Mutex<Ledger>) -> MutexGuard<'_, Ledger> {
    ledger.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
#[path = "tests/action.rs"]
mod tests;
