//! HTTP/1.1 responses. Each ends its connection, so that a body needs no other end.

use std::io::{self, Read, Write};

use super::site::Content;

/// What every response says: browsers must not guess types, keep copies, or pass content to pages of other sites.
const COMMON: &str = "cache-control: no-store\r\nx-content-type-options: nosniff\r\n\
                      cross-origin-resource-policy: same-origin\r\nconnection: close\r\n";

/// Why a request gets no content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The request is no HTTP/1.
    BadRequest,
    /// The request names another host.
    Forbidden,
    /// There is no such file.
    NotFound,
    /// The method is neither GET nor HEAD.
    Method,
}

impl Refusal {
    /// Writes the response.
    ///
    /// # Errors
    /// When the client cannot be written to.
    pub fn write(self, out: &mut dyn Write) -> io::Result<()> {
        let (status, allow) = match self {
            Self::BadRequest => ("400 Bad Request", ""),
            Self::Forbidden => ("403 Forbidden", ""),
            Self::NotFound => ("404 Not Found", ""),
            Self::Method => ("405 Method Not Allowed", "allow: GET, HEAD\r\n"),
        };
        let length = status.len() + 1;
        let head = format!("HTTP/1.1 {status}\r\n{allow}content-type: text/plain\r\ncontent-length: {length}\r\n");
        write!(out, "{head}{COMMON}\r\n{status}\n")
    }
}

/// Writes content, or only its head.
///
/// # Errors
/// When the client cannot be written to, or the file cannot be read.
pub fn write_content(content: Content, has_body: bool, out: &mut dyn Write) -> io::Result<()> {
    let Content { kind, length, mut body } = content;
    write!(out, "HTTP/1.1 200 OK\r\ncontent-type: {kind}\r\ncontent-length: {length}\r\n{COMMON}\r\n")?;
    if has_body {
        // A file that has grown since it was opened must not exceed the length in the head.
        io::copy(&mut body.by_ref().take(length), out)?;
    }
    Ok(())
}

/// Writes the head of a stream of events.
///
/// # Errors
/// When the client cannot be written to.
pub fn write_event_stream(out: &mut dyn Write) -> io::Result<()> {
    write!(out, "HTTP/1.1 200 OK\r\ncontent-type: text/event-stream\r\n{COMMON}\r\n")
}

/// Tells a page that no events will come, so that the page does not ask again.
///
/// # Errors
/// When the client cannot be written to.
pub fn write_no_events(out: &mut dyn Write) -> io::Result<()> {
    write!(out, "HTTP/1.1 204 No Content\r\n{COMMON}\r\n")
}
