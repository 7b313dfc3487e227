//! Caches that machines share: in a folder by `file://`, in moto's S3 server, and in servers that do not do what they should.

mod damage;
mod down;
mod folder;
mod machine;
mod moto;
#[path = "../common/ports.rs"]
mod ports;
mod sharing;
