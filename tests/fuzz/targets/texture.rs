#![no_main]

#[path = "../entries.rs"]
mod entries;

// The library catches panics of decoders, so the panic hook must not abort. A panic that escapes ends the process.
libfuzzer_sys::fuzz_target!(init: std::panic::set_hook(Box::new(|_| ())), |bytes: &[u8]| entries::texture(bytes));
