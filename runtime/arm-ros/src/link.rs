//! This program's ROS node, with its threads.
//!
//! In: the master's address. Out: a [`Link`], through which ordinary code starts asynchronous work and waits for it
//! with a time limit.

use super::RosError;
use fab_arm::settings::RosSettings;
use roslibrust::ros1::{MasterClient, NodeHandle, RosMasterError};
use std::future::Future;
use std::pin::pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tokio::runtime::{Builder, Runtime};

/// The longest that unregistering from the master may delay the end of the process.
const LEAVE_TIMEOUT: Duration = Duration::from_millis(500);

/// A ROS node of this program.
pub(super) struct Link {
    /// `None` only while this is dropped.
    runtime: Option<Runtime>,
    /// `None` only while this is dropped.
    node: Option<NodeHandle>,
    settings: RosSettings,
    name: String,
}

impl Link {
    /// Registers a node; `role` is part of its name.
    pub(super) fn open(
        settings: &RosSettings,
        role: &str,
        timeout: Duration,
    ) -> Result<Link, RosError> {
        let unreachable = |why: String| RosError::Master {
            address: settings.master.clone(),
            why,
        };
        let runtime = Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("fabc-ros")
            .enable_all()
            .build()
            .map_err(|error| unreachable(error.to_string()))?;
        let mut link = Link {
            runtime: Some(runtime),
            node: None,
            settings: settings.clone(),
            name: format!("/fabc_{role}_{}", unique_number()),
        };
        let (address, name) = (settings.master.clone(), link.name.clone());
        let opened = link.run(
            timeout,
            async move { NodeHandle::new(&address, &name).await },
        );
        let node = match opened {
            Some(Ok(node)) => node,
            Some(Err(error)) => return Err(unreachable(error.to_string())),
            None => return Err(unreachable(format!("no answer within {timeout:?}"))),
        };
        link.node = Some(node);
        link.check_host()?;
        Ok(link)
    }

    /// Returns the node; everything that registers with the master starts from it.
    pub(super) fn node(&self) -> NodeHandle {
        self.node
            .clone()
            .expect("a link has its node until it is dropped")
    }

    /// Starts work that runs until the link is dropped.
    pub(super) fn spawn(&self, work: impl Future<Output = ()> + Send + 'static) {
        if let Some(runtime) = &self.runtime {
            runtime.spawn(work);
        }
    }

    /// Does work and waits for it; abandons it and returns `None` if it takes longer than `timeout`.
    ///
    /// Waits on a channel, which unlike `block_on` also works within another runtime.
    pub(super) fn run<F>(&self, timeout: Duration, work: F) -> Option<F::Output>
    where
        F: Future<Output: Send + 'static> + Send + 'static,
    {
        let (sender, receiver) = mpsc::channel();
        self.spawn(async move {
            if let Ok(output) = tokio::time::timeout(timeout, work).await {
                // After the deadline nobody is waiting any more.
                let _ = sender.send(output);
            }
        });
        receiver.recv_timeout(timeout).ok()
    }

    /// Asks the master whether a service is offered; `None` if it does not answer.
    pub(super) fn offers(&self, service: &str, timeout: Duration) -> Option<bool> {
        let (address, name) = (self.settings.master.clone(), self.name.clone());
        let service = service.to_owned();
        let found = self.run(timeout, async move {
            let master = MasterClient::new(address, "http://localhost:1", name).await?;
            master.lookup_service(service).await
        });
        match found? {
            Ok(_) => Some(true),
            Err(RosMasterError::ServerCommunicationFailure(_)) => None,
            // The master reports that nobody offers it.
            Err(_) => Some(false),
        }
    }

    /// Returns the host at which other nodes look for this one.
    pub(super) fn host(&self) -> String {
        let node = self.node();
        let address = self.run(LEAVE_TIMEOUT, async move { node.get_client_uri().await });
        let address = address.and_then(Result::ok).unwrap_or_default();
        let host = address.trim_start_matches("http://");
        host.rsplit_once(':')
            .map_or(host, |(host, _)| host)
            .to_owned()
    }

    fn check_host(&self) -> Result<(), RosError> {
        let found = self.host();
        match &self.settings.host {
            Some(expected) if *expected != found => Err(RosError::Host {
                expected: expected.clone(),
                found,
            }),
            _ => Ok(()),
        }
    }
}

impl Drop for Link {
    /// Unregisters in a separate thread, which may block, for example if the master's machine is down.
    fn drop(&mut self) {
        let (Some(runtime), node) = (self.runtime.take(), self.node.take()) else {
            return;
        };
        let (sender, receiver) = mpsc::channel();
        runtime.spawn_blocking(move || {
            drop(node);
            let _ = sender.send(());
        });
        let _ = receiver.recv_timeout(LEAVE_TIMEOUT);
        runtime.shutdown_background();
    }
}

/// Returns a number that is practically unique, also among this machine's processes.
pub(super) fn unique_number() -> String {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    let since_epoch = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    format!("{}_{}_{call}", std::process::id(), since_epoch.as_millis())
}

/// Returns the output of a future that never waits.
pub(super) fn at_once<F: Future>(work: F) -> Option<F::Output> {
    match pin!(work).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => Some(output),
        Poll::Pending => None,
    }
}
