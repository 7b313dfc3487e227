//! `bake --remote` against a server in this process that misbehaves as it is told, and against buildbox-casd.
#![cfg(unix)]

mod casd;
mod fake;
mod faults;
mod hostile;
#[path = "../common/ports.rs"]
mod ports;
mod scene;
mod secrets;
mod services;
mod work;
