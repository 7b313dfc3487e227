//! Errors between this machine and a worker, and whether another attempt may help.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use tonic::Code;

/// Why an action, or all actions, failed. Messages of servers are shortened and contain none of the caller's secrets.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RemoteError {
    /// A file that is to be sent cannot be read.
    #[error("expected a readable file at {}, found: {error}; check the path", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: Arc<io::Error>,
    },
    /// A file was changed after it was planned.
    #[error("expected {} to stay as it is during the bake, found that it changed; bake again", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// This machine cannot start threads.
    #[error("expected to start threads for --remote, found: {0}; end other processes or raise their limit")]
    Start(Arc<io::Error>),
    /// The options do not allow a connection.
    #[error("{0}")]
    Options(String),
    /// The server does not answer.
    #[error("expected a server of the Remote Execution API at {url}, found: {reason}; check the URL and the network")]
    Unreachable {
        /// The URL of the server.
        url: String,
        /// The reason of the connection's failure.
        reason: String,
    },
    /// The server lacks a needed capability.
    #[error("expected a server that {expected}, found {found}; name another server with --remote")]
    Capabilities {
        /// The needed capability.
        expected: &'static str,
        /// What the server offers.
        found: String,
    },
    /// The server refused a call.
    #[error("{call}: expected the server to answer, found {}: {message}; {}", name(*code), remedy(*code))]
    Status {
        /// The name of the call.
        call: &'static str,
        /// The status of the answer.
        code: Code,
        /// The server's message.
        message: String,
    },
    /// The result did not arrive in time.
    #[error("expected the result of an action within {} s, found none; --remote-timeout waits longer", limit.as_secs())]
    Late {
        /// The time limit.
        limit: Duration,
    },
    /// The server stopped an action that took too long.
    #[error(
        "expected the job to end in the time that the server gives it, found that it was stopped; --remote-timeout asks for \
         more"
    )]
    Stopped,
    /// The bytes of a blob do not have its digest.
    #[error(
        "expected the bytes of {digest} from the server, found others; bake again, or check the store of the server"
    )]
    Damaged {
        /// The digest.
        digest: String,
    },
    /// An answer cannot be understood.
    #[error("expected {expected} from the server, found {found}; update the server, or bake without --remote")]
    Malformed {
        /// What was expected.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// The tool succeeded, but its outputs are missing.
    #[error(
        "expected the outputs of the job from the server, found none although the tool ended well; check the server's \
         workers"
    )]
    NoOutputs,
    /// The tool could not begin to bake.
    #[error("expected the tool to run on the worker, found exit code {code}: {text}; {}", hint(*code))]
    Tool {
        /// The exit code of the tool.
        code: i32,
        /// The end of the tool's messages.
        text: String,
    },
    /// The disk cache that receives the results failed.
    #[error("{0}")]
    Cache(String),
    /// The caller has ended.
    #[error("expected to wait for the server, found that the bake ended; bake again")]
    Cancelled,
}

impl RemoteError {
    /// Returns whether the error is transient, so that another attempt may succeed.
    pub fn is_transient(&self) -> bool {
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
            // The process was killed.
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

    /// Returns whether the server lost blobs that it had, which must then be sent again.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Status { code: Code::FailedPrecondition | Code::NotFound, .. })
    }

    /// Returns whether the server cannot be reached.
    pub fn is_unreachable(&self) -> bool {
        matches!(self, Self::Unreachable { .. })
    }
}

/// Returns the name of a status in the specification of gRPC.
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

/// Returns what the user can do about a status.
fn remedy(code: Code) -> &'static str {
    match code {
        Code::Unauthenticated | Code::PermissionDenied => "check the headers and certificates of --remote",
        Code::InvalidArgument | Code::Unimplemented | Code::NotFound => "check the options of --remote",
        _ => "bake again, or look at the server's log",
    }
}

fn hint(code: i32) -> &'static str {
    match code {
        126 | 127 => "--remote-tool takes a static build for the workers' system",
        _ => "--remote-tool takes a tool of this version",
    }
}
