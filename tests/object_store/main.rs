//! Tests of object-store caches: in a folder by `file://`, in moto's S3 server, and in servers with faults.

mod damage;
mod down;
mod folder;
mod machine;
mod moto;
#[path = "../common/ports.rs"]
mod ports;
mod sharing;
#[path = "../common/skip.rs"]
mod skip;
