//! The bake as a WebAssembly module without generated bindings. JavaScript writes a request into memory from
//! [`allocate`], calls [`call`], and reads the response. `message` describes both; `npm/roughcast/lib/wasm.js` is the
//! other side.
//!
//! An instance answers one call and is dropped with its memory: a module's memory never shrinks, and a panic leaves an
//! instance in an unknown state. Nothing is freed here for that reason.
//!
//! The crate is built twice: for a memory of one thread, and with `atomics` for a memory that the threads of a bake
//! share.

mod bake;
mod command;
mod map;
mod message;
#[cfg(all(target_arch = "wasm32", target_feature = "atomics"))]
mod threads;

use std::mem::ManuallyDrop;

pub use command::answer;

/// Functions that JavaScript provides.
#[cfg(target_arch = "wasm32")]
mod host {
    #[link(wasm_import_module = "roughcast")]
    unsafe extern "C" {
        /// Takes the share of the work that is done, in [0, 1].
        pub safe fn progress(share: f32);
        /// Takes the message of a panic as UTF-8.
        pub unsafe fn panicked(text: *const u8, length: usize);
    }
}

/// Returns the address of `length` bytes for a request.
#[unsafe(no_mangle)]
pub extern "C" fn allocate(length: usize) -> *mut u8 {
    ManuallyDrop::new(vec![0_u8; length]).as_mut_ptr()
}

/// Answers the request at `request` with `threads` threads. Returns the address of the response: its length in four
/// bytes, little endian, and the message. A module without shared memory has one thread, whatever `threads` is.
///
/// # Safety
/// `request` is what [`allocate`] returned for `length`, and no call has taken it yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn call(request: *mut u8, length: usize, threads: usize) -> *const u8 {
    report_panics();
    // SAFETY: `allocate` made this memory as a vector of `length` bytes and gave it away; the caller promises both.
    let request = unsafe { Vec::from_raw_parts(request, length, length) };
    #[cfg(all(target_arch = "wasm32", target_feature = "atomics"))]
    // Without a pool, rayon works on the calling thread, as in the other module.
    let _pool = (threads > 1).then(|| threads::pool(threads));
    #[cfg(not(all(target_arch = "wasm32", target_feature = "atomics")))]
    let _ = threads;
    let response = answer(&request, &progress);
    ManuallyDrop::new(response).as_ptr()
}

/// Reports progress to JavaScript. In a pool without other threads, also does the work that the pool has deferred, such
/// as freeing memory.
fn progress(share: f32) {
    while rayon::current_num_threads() == 1 && rayon::yield_now() == Some(rayon::Yield::Executed) {}
    #[cfg(target_arch = "wasm32")]
    host::progress(share);
    #[cfg(not(target_arch = "wasm32"))]
    let _ = share;
}

/// Hands the message of a panic to JavaScript, which would otherwise see a trap without a reason.
fn report_panics() {
    #[cfg(target_arch = "wasm32")]
    std::panic::set_hook(Box::new(|info| {
        let text = info.to_string();
        // SAFETY: JavaScript reads the text before the call returns.
        unsafe { host::panicked(text.as_ptr(), text.len()) };
    }));
}
