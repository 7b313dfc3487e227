//! A connected server.

use std::sync::OnceLock;

use tokio::runtime::{Builder, Runtime};

use super::action::Digests;
use super::client::Client;
use super::digest::Blob;
use super::error::RemoteError;
use super::upload::Uploads;
use crate::remote::{Counts, Options};

/// A connected server, and what was sent to it.
pub struct Remote {
    pub(super) runtime: Runtime,
    pub(super) client: Client,
    pub(super) options: Options,
    /// The tool that workers run.
    pub(super) tool: Blob,
    pub(super) digests: Digests,
    pub(super) uploads: Uploads,
    /// Why the server cannot be reached, once that is known. Jobs that begin later fail at once.
    pub(super) unreachable: OnceLock<RemoteError>,
}

impl Remote {
    /// Connects to a server and asks for its capabilities.
    ///
    /// # Errors
    /// [`RemoteError`] if the server cannot be reached, refuses the caller, or cannot execute actions by SHA-256, or if
    /// the tool cannot be read.
    pub fn connect(options: Options) -> Result<Self, RemoteError> {
        let tool = Blob::of_file(&options.tool)?;
        // These threads transfer bytes. The threads that wait for results do everything else.
        let mut builder = Builder::new_multi_thread();
        let runtime = builder.worker_threads(2).enable_all().build().map_err(|e| RemoteError::Start(e.into()))?;
        let client = runtime.block_on(Client::connect(&options))?;
        let (digests, uploads) = (Digests::default(), Uploads::default());
        Ok(Self { runtime, client, options, tool, digests, uploads, unreachable: OnceLock::new() })
    }

    /// Returns the numbers of what was done so far.
    pub fn counts(&self) -> Counts {
        self.client.count(|counts| *counts)
    }
}
