//! Server-sent events: pages that reload when an asset was baked again.

use std::io::Write;
use std::net::TcpStream;
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value;

use super::response::write_event_stream;

/// The pages that listen for events.
#[derive(Clone, Debug, Default)]
pub struct Events(Arc<Mutex<Vec<TcpStream>>>);

impl Events {
    /// Makes all pages reload.
    pub fn report_bake(&self) {
        self.send(b"data: baked\n\n", None);
    }

    /// Adds a page.
    pub(super) fn add(&self, mut page: TcpStream) {
        if write_event_stream(&mut page).is_ok() {
            // A comment finds the pages that were closed.
            self.send(b":\n\n", Some(page));
        }
    }

    /// Returns whether a page listens.
    #[cfg(test)]
    pub(super) fn has_pages(&self) -> bool {
        !self.0.lock().unwrap_or_else(PoisonError::into_inner).is_empty()
    }

    /// Sends `message` to all pages, drops those that are closed, and adds `page`.
    fn send(&self, message: &[u8], page: Option<TcpStream>) {
        let mut pages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pages.retain_mut(|page| page.write_all(message).is_ok());
        pages.extend(page);
    }
}

/// Returns whether a line of `roughcast watch --json` reports new outputs.
pub fn reports_outputs(line: &str) -> bool {
    let event = serde_json::from_str(line).ok().and_then(|line: Value| Some(line.get("event")?.as_str()?.to_owned()));
    event.is_some_and(|event| ["baked", "removed"].contains(&event.as_str()))
}
