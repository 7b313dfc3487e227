//! What can go wrong between here and a worker, and whether to try again.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use tonic::Code;

/// Why an action, or all of them, failed. Messages of servers are cut and free of the caller's secrets.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RemoteError {
    /// A file to be sent cannot be read.
    #[error("expected a readable file at {}, found: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: Arc<io::Error>,
    },
    /// A file that was written to since it was planned.
    #[error("expected {} to stay as it is during the bake, found that it changed; bake again", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// This machine gives no threads.
    #[error("expected to start threads for --remote, found: {0}")]
    Start(Arc<io::Error>),
    /// Options that no connection can be made with.
    #[error("{0}")]
    Options(String),
    /// Nobody answers.
    #[error("expected a server of the Remote Execution API at {url}, found: {reason}")]
    Unreachable {
        /// Where.
        url: String,
        /// What the connection says.
        reason: String,
    },
    /// A server that cannot do what is needed.
    #[error("expected a server that {expected}, found {found}")]
    Capabilities {
        /// What it must do.
        expected: &'static str,
        /// What it does.
        found: String,
    },
    /// A call that the server refused.
    #[error("{call}: expected the server to answer, found {}: {message}", name(*code))]
    Status {
        /// The call.
        call: &'static str,
        /// Its status.
        code: Code,
        /// The server's words.
        message: String,
    },
    /// Nothing came back in time.
    #[error("expected the result of an action within {} s, found none; --remote-timeout waits longer", limit.as_secs())]
    Late {
        /// How long it was waited for.
        limit: Duration,
    },
    /// The server ended an action that took too long.
    #[error(
        "expected the job to end in the time that the server gives it, found that it was stopped; --remote-timeout asks for more"
    )]
    Stopped,
    /// Other bytes than their digest tells.
    #[error("expected the bytes of {digest} from the server, found others")]
    Damaged {
        /// The digest.
        digest: String,
    },
    /// An answer that makes no sense.
    #[error("expected {expected} from the server, found {found}")]
    Malformed {
        /// What it should have been.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// The tool ended well, and its outputs are not there.
    #[error("expected the outputs of the job from the server, found none although the tool ended well")]
    NoOutputs,
    /// The tool did not get as far as baking.
    #[error("expected the tool to run on the worker, found exit code {code}: {text}; {}", hint(*code))]
    Tool {
        /// Its exit code.
        code: i32,
        /// The end of what it said.
        text: String,
    },
    /// The caller's cache, which results go through.
    #[error("{0}")]
    Cache(String),
    /// The caller has gone.
    #[error("expected to wait for the server, found that the bake ended")]
    Cancelled,
}

impl RemoteError {
    /// Whether trying again may help.
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Status { code, .. } => !matches!(
                code,
                Code::InvalidArgument
                    | Code::PermissionDenied
                    | Code::Unauthenticated
                    | Code::Unimplemented
                    | Code::OutOfRange
                    | Code::AlreadyExists
            ),
            // A process that was killed, by whomever.
            Self::Tool { code, .. } => *code >= 128 || *code < 0,
            Self::Changed { .. }
            | Self::Start(_)
            | Self::Unreachable { .. }
            | Self::Late { .. }
            | Self::Damaged { .. }
            | Self::Cache(_)
            | Self::Cancelled => true,
            Self::Read { .. }
            | Self::Options(_)
            | Self::Capabilities { .. }
            | Self::Stopped
            | Self::Malformed { .. }
            | Self::NoOutputs => false,
        }
    }

    /// Whether blobs that were there are no more: they are to be sent again.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Status { code: Code::FailedPrecondition | Code::NotFound, .. })
    }

    /// Whether the server itself is out of reach.
    pub fn is_gone(&self) -> bool {
        matches!(self, Self::Unreachable { .. })
    }
}

/// The name of a status in the specification.
fn name(code: Code) -> &'static str {
    match code {
        Code::Ok => "OK",
        Code::Cancelled => "CANCELLED",
        Code::Unknown => "UNKNOWN",
        Code::InvalidArgument => "INVALID_ARGUMENT",
        Code::DeadlineExceeded => "DEADLINE_EXCEEDED",
        Code::NotFound => "NOT_FOUND",
        Code::AlreadyExists => "ALREADY_EXISTS",
        Code::PermissionDenied => "PERMISSION_DENIED",
        Code::ResourceExhausted => "RESOURCE_EXHAUSTED",
        Code::FailedPrecondition => "FAILED_PRECONDITION",
        Code::Aborted => "ABORTED",
        Code::OutOfRange => "OUT_OF_RANGE",
        Code::Unimplemented => "UNIMPLEMENTED",
        Code::Internal => "INTERNAL",
        Code::Unavailable => "UNAVAILABLE",
        Code::DataLoss => "DATA_LOSS",
        Code::Unauthenticated => "UNAUTHENTICATED",
    }
}

fn hint(code: i32) -> &'static str {
    match code {
        126 | 127 => "--remote-tool takes a static build for the workers' system",
        _ => "--remote-tool takes a tool of this version",
    }
}
