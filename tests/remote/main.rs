//! Tests of `bake --remote` with a fake server whose faults the tests choose, and with buildbox-casd.
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
#[path = "../common/skip.rs"]
mod skip;
mod work;
