//! The head of an HTTP/1.1 request (RFC 9112).

use std::io::{BufRead, BufReader, Read};

/// Largest head of a request. Browsers send about 1 kB.
const MAX_HEAD_BYTES: u64 = 16 << 10;

/// What a request asks for.
#[derive(Debug, PartialEq)]
pub struct Request {
    /// The method, such as GET.
    pub method: String,
    /// The target, such as `/page/index.html?x`.
    pub target: String,
    /// The value of the header `Host`. `None` unless there is exactly one.
    pub host: Option<String>,
}

impl Request {
    /// Reads the head of a request. Returns `None` if it is incomplete, too long, or no HTTP/1.
    pub fn read(stream: impl Read) -> Option<Self> {
        let mut lines = BufReader::new(stream.take(MAX_HEAD_BYTES)).lines().map_while(Result::ok);
        let first = lines.next()?;
        let mut words = first.split(' ');
        let (method, target, version) = (words.next()?, words.next()?, words.next()?);
        if words.next().is_some() || !version.starts_with("HTTP/1.") {
            return None;
        }
        let mut hosts = Vec::new();
        loop {
            let line = lines.next()?;
            if line.is_empty() {
                break;
            }
            let (name, value) = line.split_once(':')?;
            if name.eq_ignore_ascii_case("host") {
                hosts.push(value.trim().to_owned());
            }
        }
        let host = hosts.pop().filter(|_| hosts.is_empty());
        Some(Self { method: method.to_owned(), target: target.to_owned(), host })
    }

    /// Returns whether the request names this machine. A foreign name for its address would let pages of that site
    /// read the files (DNS rebinding).
    pub fn is_local(&self) -> bool {
        let Some(host) = &self.host else { return false };
        let (name, port) = host.split_once(':').unwrap_or((host, "0"));
        let is_port = !port.is_empty() && port.bytes().all(|byte| byte.is_ascii_digit());
        ["127.0.0.1", "localhost"].contains(&name) && is_port
    }
}
