#![no_main]

#[path = "../entries.rs"]
mod entries;

// A panic that the library contains is none; one that it does not ends the process.
libfuzzer_sys::fuzz_target!(init: std::panic::set_hook(Box::new(|_| ())), |bytes: &[u8]| entries::texture(bytes));
