//! Options of a server: its address, headers and certificates, and its requirements for workers.

use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

/// Options of a server.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// `grpc://host:port`, or `grpcs://host:port` with TLS.
    pub url: String,
    /// The server's instance. An empty name is the default instance.
    pub instance: String,
    /// Properties that workers must have, as names and values.
    pub platform: Vec<(String, String)>,
    /// Headers of every call.
    pub headers: Vec<Header>,
    /// Certificates, as PEM files.
    pub tls: Tls,
    /// Most actions at a time.
    pub jobs: usize,
    /// Time limit of an action, from its upload to its result.
    pub timeout: Option<Duration>,
    /// Number of further attempts after a failure.
    pub retries: u32,
    /// The tool that workers run.
    pub tool: PathBuf,
}

/// Certificates of a connection with TLS.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tls {
    /// The authorities that sign the server's certificate. Without a file, these are the system's authorities.
    pub authority: Option<PathBuf>,
    /// The caller's certificate and its key.
    pub identity: Option<(PathBuf, PathBuf)>,
}

/// A header. Its value may be a secret and is never shown.
#[derive(Clone, PartialEq, Eq)]
pub struct Header {
    /// The name, in lower case.
    pub name: String,
    /// The value.
    pub value: String,
}

impl fmt::Debug for Header {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}=...", self.name)
    }
}
