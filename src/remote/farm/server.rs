//! A server that is connected to.

use std::sync::OnceLock;

use tokio::runtime::{Builder, Runtime};

use super::action::Digests;
use super::client::Client;
use super::digest::Blob;
use super::error::RemoteError;
use super::upload::Uploads;
use crate::remote::{Counts, Options};

/// A server, and what it has been sent.
pub struct Remote {
    pub(super) runtime: Runtime,
    pub(super) client: Client,
    pub(super) options: Options,
    /// What workers run.
    pub(super) tool: Blob,
    pub(super) digests: Digests,
    pub(super) uploads: Uploads,
    /// Why the server is taken to be gone, once it is: what was not begun by then need not find out again.
    pub(super) gone: OnceLock<RemoteError>,
}

impl Remote {
    /// Connects to a server and asks what it can do.
    ///
    /// # Errors
    /// [`RemoteError`]: it is not there, does not let the caller in, or cannot run actions by SHA-256; or the tool cannot be
    /// read.
    pub fn connect(options: Options) -> Result<Self, RemoteError> {
        let tool = Blob::of_file(&options.tool)?;
        // These move bytes; everything else is done by the threads that wait for it.
        let mut builder = Builder::new_multi_thread();
        let runtime = builder.worker_threads(2).enable_all().build().map_err(|e| RemoteError::Start(e.into()))?;
        let client = runtime.block_on(Client::connect(&options))?;
        let (digests, uploads) = (Digests::default(), Uploads::default());
        Ok(Self { runtime, client, options, tool, digests, uploads, gone: OnceLock::new() })
    }

    /// What was done so far.
    pub fn counts(&self) -> Counts {
        self.client.count(|counts| *counts)
    }
}
