//! Ports of servers that cannot choose a port themselves.

use std::net::TcpListener;
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

/// Returns a loopback port on which nothing listens, a different one on each call. It is below the ephemeral ports, so
/// that no connection of a test takes it before the server does.
pub fn free_port() -> u16 {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    loop {
        let call = CALLS.fetch_add(1, Ordering::Relaxed);
        let port = 20_000 + (process::id().wrapping_mul(64).wrapping_add(call) % 12_000) as u16;
        if TcpListener::bind(("127.0.0.1", port)).is_ok() {
            return port;
        }
    }
}
