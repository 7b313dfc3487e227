//! The threads of the module that is built for shared memory. JavaScript starts them: WebAssembly itself cannot.

use std::ffi::c_void;
use std::hint::black_box;

use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Functions that JavaScript provides.
mod host {
    use std::ffi::c_void;

    #[link(wasm_import_module = "roughcast")]
    unsafe extern "C" {
        /// Starts a worker that calls [`super::run_thread`] with `thread`.
        pub unsafe fn spawn(thread: *mut c_void);
    }
}

/// Bytes of memory that the allocator has before other threads start. Pages that are not used cost no memory.
const RESERVE: usize = 1 << 30;

/// Makes a pool of `threads` threads, of which the calling thread is one. JavaScript starts the others. The pool does
/// the parallel work of the calling thread, and ends when it is dropped.
///
/// The memory grows first. In Chromium and Node, a thread traps at an atomic instruction in memory that another thread
/// has just added, and JavaScript then bakes again on one thread. The allocator keeps freed memory.
pub fn pool(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    // A refused reserve is no failure: the memory then grows as it is needed.
    let mut reserve = Vec::<u8>::new();
    let _ = reserve.try_reserve_exact(RESERVE);
    drop(black_box(reserve));
    let spawn = |thread: ThreadBuilder| {
        // SAFETY: JavaScript gives the address to one call of `run_thread`, in an instance of the same memory.
        unsafe { host::spawn(Box::into_raw(Box::new(thread)).cast()) };
        Ok(())
    };
    ThreadPoolBuilder::new().num_threads(threads).use_current_thread().spawn_handler(spawn).build()
}

/// Works for a pool until the pool ends.
///
/// # Safety
/// `thread` is what `spawn` was called with, and no other call has taken it. The calling instance has a stack and
/// thread-local memory of its own.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn run_thread(thread: *mut c_void) {
    // SAFETY: `pool` made the box and gave it away; the caller promises that this is its only owner.
    unsafe { Box::from_raw(thread.cast::<ThreadBuilder>()) }.run();
}
