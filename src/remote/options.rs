//! Where the server is and how it is spoken to.

use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

/// How a server is reached and what it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// `grpc://host:port`, or `grpcs://host:port` with TLS.
    pub url: String,
    /// Instance of the server; empty is its default.
    pub instance: String,
    /// What workers must be, by name.
    pub platform: Vec<(String, String)>,
    /// Headers of every call.
    pub headers: Vec<Header>,
    /// Certificates, as PEM files.
    pub tls: Tls,
    /// The most actions at a time.
    pub jobs: usize,
    /// What an action may take, from its upload to its result.
    pub timeout: Option<Duration>,
    /// How often something that failed is tried again.
    pub retries: u32,
    /// The tool that workers run.
    pub tool: PathBuf,
}

/// Certificates of a connection with TLS.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tls {
    /// Authorities that sign the server's; the system's where none is named.
    pub authority: Option<PathBuf>,
    /// The caller's certificate and its key.
    pub identity: Option<(PathBuf, PathBuf)>,
}

/// A header. Its value may be a secret, and is never shown.
#[derive(Clone, PartialEq, Eq)]
pub struct Header {
    /// Its name, in lower case.
    pub name: String,
    /// Its value.
    pub value: String,
}

impl fmt::Debug for Header {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}=...", self.name)
    }
}
