//! A client of a service, over its two topics of DDS.
//!
//! In: requests, each with a note of its sender. Out: each response with the note of its request. The middlewares of
//! ROS 2 do not agree on where a message says to which request it belongs, so [`Rmw`] decides: rmw_fastrtps beside the
//! message, in its inline QoS; rmw_cyclonedds in 16 bytes in front of it. Nothing here waits for an answer.

use super::Ros2Error;
use super::link::{Link, Quality, Writer};
use fab_arm::settings::Rmw;
use rustdds::{GUID, RTPSEntity, SampleIdentity, Timestamp, WriteOptionsBuilder};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::hash::{BuildHasher, RandomState};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A service of ROS.
pub(crate) trait Service: 'static {
    /// Its type in DDS without `_Request_` or `_Response_`, e.g. `std_srvs::srv::dds_::Trigger`.
    const TYPE: &'static str;
    /// What it is asked.
    type Request: Serialize + Send;
    /// What it answers.
    type Response: DeserializeOwned + Send;
}

/// What rmw_cyclonedds puts in front of a request; a response begins with the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Heading {
    client: u64,
    request: i64,
}

/// A message with its heading.
#[derive(Serialize, Deserialize)]
struct Headed<T> {
    heading: Heading,
    message: T,
}

enum Requests<T: Serialize> {
    Inline(Writer<T>),
    Headed(Writer<Headed<T>>, u64),
}

/// The requests without a response, by their number.
struct Pending<N> {
    notes: BTreeMap<i64, N>,
    last: i64,
}

/// A client of a service, which notes an `N` with each request.
pub(crate) struct Client<S: Service, N> {
    requests: Requests<S::Request>,
    pending: Arc<Mutex<Pending<N>>>,
    request_topic: String,
    response_topic: String,
}

impl<S: Service, N: Send + 'static> Client<S, N> {
    /// Opens the topics of the service `name`; whether it is there shows later.
    ///
    /// - `take`: gets each response with the note of its request, on a thread of its own.
    pub(crate) fn open(
        link: &Link,
        name: &str,
        rmw: Rmw,
        take: impl Fn(N, S::Response) + Send + 'static,
    ) -> Result<Self, Ros2Error> {
        let request_topic = format!("rq{name}Request");
        let response_topic = format!("rr{name}Reply");
        let types = [
            format!("{}_Request_", S::TYPE),
            format!("{}_Response_", S::TYPE),
        ];
        let pending = Arc::new(Mutex::new(Pending {
            notes: BTreeMap::new(),
            last: 0,
        }));
        let answered = Arc::clone(&pending);
        let requests = match rmw {
            Rmw::Fastrtps => {
                let writer: Writer<S::Request> =
                    link.writer(&request_topic, &types[0], Quality::Service)?;
                let client = writer.guid();
                link.listen::<S::Response>(
                    &response_topic,
                    &types[1],
                    Quality::Service,
                    move |heard| {
                        // A response that cannot be read is one that did not come: whoever waits for it says so.
                        let Ok((response, info)) = heard else { return };
                        let number = info.related_sample_identity();
                        let number = number.and_then(|identity| number_of(identity, client));
                        let note = number.and_then(|it| lock(&answered).notes.remove(&it));
                        if let Some(note) = note {
                            take(note, response);
                        }
                    },
                )?;
                Requests::Inline(writer)
            }
            Rmw::Cyclonedds => {
                let client = RandomState::new().hash_one(&request_topic);
                link.listen::<Headed<S::Response>>(
                    &response_topic,
                    &types[1],
                    Quality::Service,
                    move |heard| {
                        let Ok((Headed { heading, message }, _)) = heard else {
                            return;
                        };
                        if heading.client != client {
                            return;
                        }
                        let note = lock(&answered).notes.remove(&heading.request);
                        if let Some(note) = note {
                            take(note, message);
                        }
                    },
                )?;
                let writer = link.writer(&request_topic, &types[0], Quality::Service)?;
                Requests::Headed(writer, client)
            }
        };
        Ok(Client {
            requests,
            pending,
            request_topic,
            response_topic,
        })
    }

    /// Sends a request.
    pub(crate) fn send(&self, request: S::Request, note: N) -> Result<(), String> {
        // Locked while it is sent, so that its response finds the note.
        let mut pending = lock(&self.pending);
        let stamped = WriteOptionsBuilder::new().source_timestamp(Timestamp::now());
        let number = match &self.requests {
            Requests::Inline(writer) => {
                let sent = writer.write_with_options(request, stamped.build());
                let identity = sent.map_err(|error| error.to_string())?;
                i64::from(identity.sequence_number)
            }
            Requests::Headed(writer, client) => {
                pending.last += 1;
                let heading = Heading {
                    client: *client,
                    request: pending.last,
                };
                let headed = Headed {
                    heading,
                    message: request,
                };
                let sent = writer.write_with_options(headed, stamped.build());
                sent.map_err(|error| error.to_string())?;
                heading.request
            }
        };
        pending.notes.insert(number, note);
        Ok(())
    }

    /// Returns whether a server was found, or why the one that was found is another.
    pub(crate) fn is_found(&self, link: &Link) -> Result<bool, String> {
        let (read, written) = (
            link.read_as(&self.request_topic),
            link.written_as(&self.response_topic),
        );
        let expected = format!("{}_Request_", S::TYPE);
        if let Some(other) = read.iter().find(|found| **found != expected) {
            return Err(format!("it takes `{other}`, and not `{expected}`"));
        }
        Ok(!read.is_empty() && !written.is_empty())
    }
}

fn number_of(identity: SampleIdentity, client: GUID) -> Option<i64> {
    (identity.writer_guid == client).then(|| i64::from(identity.sequence_number))
}

fn lock<N>(pending: &Mutex<Pending<N>>) -> MutexGuard<'_, Pending<N>> {
    pending.lock().unwrap_or_else(PoisonError::into_inner)
}
