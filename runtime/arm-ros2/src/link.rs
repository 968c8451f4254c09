//! A DDS participant of this program: what it writes and reads, each topic by its name in ROS.
//!
//! In: the domain. Out: a [`Link`], through which messages are sent, and received on threads that end with it.

use super::Ros2Error;
use fab_arm::settings::Ros2Settings;
use rustdds::mio1::{Events, Interest, Poll, Token};
use rustdds::no_key::{DataReader, DataWriter};
use rustdds::policy::{Durability, History};
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, Publisher, QosPolicies, QosPolicyBuilder,
    SampleInfo, Subscriber, Topic, TopicKind,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long a thread may take to notice that its link was closed.
const NOTICE: Duration = Duration::from_millis(100);

/// The longest that writing may wait for a slow reader.
const BLOCKING: rustdds::Duration = rustdds::Duration::from_millis(100);

/// What is asked of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// The newest messages, and some may be lost; as ROS's profile for sensor data.
    Sensor,
    /// Every message; as ROS's profile for services.
    Service,
    /// The last message, also to those that come late; as ROS's profile for the states of goals.
    Latched,
}

impl Quality {
    fn policies(self) -> QosPolicies {
        let (durability, depth) = match self {
            // Two, so that a picture is not lost while the one before is read.
            Quality::Sensor => (Durability::Volatile, 2),
            Quality::Service => (Durability::Volatile, 10),
            Quality::Latched => (Durability::TransientLocal, 1),
        };
        let policies = QosPolicyBuilder::new()
            .durability(durability)
            .history(History::KeepLast { depth });
        match self {
            Quality::Sensor => policies.best_effort().build(),
            Quality::Service | Quality::Latched => policies.reliable(BLOCKING).build(),
        }
    }
}

/// Sends messages of one topic.
pub(crate) type Writer<T> = DataWriter<T>;

/// A participant.
pub(crate) struct Link {
    participant: DomainParticipant,
    publisher: Publisher,
    subscriber: Subscriber,
    is_open: Arc<AtomicBool>,
}

impl Link {
    /// Joins the domain of the settings.
    pub(crate) fn open(settings: &Ros2Settings) -> Result<Link, Ros2Error> {
        let refused = |error: String| Ros2Error::Refused {
            what: format!("the DDS domain {} could not be joined", settings.domain),
            why: error,
        };
        let mut builder = DomainParticipantBuilder::new(settings.domain);
        if let Some(address) = &settings.interface {
            let address: Ipv4Addr = address.parse().map_err(|_| {
                Ros2Error::Setting(format!(
                    "`ros2.interface` is `{address}`; expected an IPv4 address of this machine, e.g. `192.168.1.10`"
                ))
            })?;
            builder = builder.with_only_networks([address]);
        }
        let participant = builder.build();
        let participant = participant.map_err(|error| refused(error.to_string()))?;
        let qos = Quality::Service.policies();
        let publisher = participant.create_publisher(&qos);
        let publisher = publisher.map_err(|error| refused(error.to_string()))?;
        let subscriber = participant.create_subscriber(&qos);
        let subscriber = subscriber.map_err(|error| refused(error.to_string()))?;
        Ok(Link {
            participant,
            publisher,
            subscriber,
            is_open: Arc::new(AtomicBool::new(true)),
        })
    }

    fn topic(&self, name: &str, type_name: &str, quality: Quality) -> Result<Topic, Ros2Error> {
        let topic = self.participant.create_topic(
            name.to_owned(),
            type_name.to_owned(),
            &quality.policies(),
            TopicKind::NoKey,
        );
        topic.map_err(|error| refused(name, error.to_string()))
    }

    /// Opens a topic for writing.
    pub(crate) fn writer<T: Serialize>(
        &self,
        name: &str,
        type_name: &str,
        quality: Quality,
    ) -> Result<Writer<T>, Ros2Error> {
        let topic = self.topic(name, type_name, quality)?;
        let writer = self.publisher.create_datawriter_no_key_cdr(&topic, None);
        writer.map_err(|error| refused(name, error.to_string()))
    }

    /// Passes every message of a topic to `take` on a thread of its own, or why one could not be read.
    pub(crate) fn listen<T: DeserializeOwned + Send + 'static>(
        &self,
        name: &str,
        type_name: &str,
        quality: Quality,
        mut take: impl FnMut(Result<(T, SampleInfo), String>) + Send + 'static,
    ) -> Result<(), Ros2Error> {
        let topic = self.topic(name, type_name, quality)?;
        let reader: Result<DataReader<T>, _> =
            self.subscriber.create_datareader_no_key_cdr(&topic, None);
        let mut reader = reader.map_err(|error| refused(name, error.to_string()))?;
        let poll = Poll::new().and_then(|poll| {
            poll.registry()
                .register(&mut reader, Token(0), Interest::READABLE)?;
            Ok(poll)
        });
        let mut poll = poll.map_err(|error| refused(name, error.to_string()))?;
        let is_open = Arc::clone(&self.is_open);
        let listened = std::thread::Builder::new()
            .name("fabc-ros2".to_owned())
            .spawn(move || {
                let mut events = Events::with_capacity(1);
                while is_open.load(Ordering::Relaxed) {
                    loop {
                        match reader.take_next_sample() {
                            Ok(Some(sample)) => {
                                let info = sample.sample_info().clone();
                                take(Ok((sample.into_value(), info)));
                            }
                            Ok(None) => break,
                            Err(error) => {
                                take(Err(error.to_string()));
                                break;
                            }
                        }
                    }
                    // An interrupted wait is as good as one that ends early.
                    let _ = poll.poll(&mut events, Some(NOTICE));
                }
            });
        listened.map_err(|error| refused(name, error.to_string()))?;
        Ok(())
    }

    /// Returns the types under which others read this topic of DDS.
    pub(crate) fn read_as(&self, name: &str) -> Vec<String> {
        let readers = self.participant.discovered_readers().into_iter();
        let topics = readers.map(|reader| reader.subscription_topic_data);
        let named = topics.filter(|topic| topic.topic_name == name);
        named.map(|topic| topic.type_name().clone()).collect()
    }

    /// Returns the types under which others write this topic of DDS.
    pub(crate) fn written_as(&self, name: &str) -> Vec<String> {
        let writers = self.participant.discovered_writers().into_iter();
        let topics = writers.map(|writer| writer.publication_topic_data);
        let named = topics.filter(|topic| topic.topic_name == name);
        named.map(|topic| topic.type_name).collect()
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.is_open.store(false, Ordering::Relaxed);
    }
}

fn refused(name: &str, why: String) -> Ros2Error {
    Ros2Error::Refused {
        what: format!("the topic `{name}` could not be opened"),
        why,
    }
}

/// Returns the name in DDS of a topic of ROS.
pub(crate) fn topic_name(name: &str) -> String {
    format!("rt{name}")
}
