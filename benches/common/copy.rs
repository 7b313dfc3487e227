//! What memory lets any kernel reach.

use rayon::prelude::*;

/// Bytes that a thread copies at a time.
const CHUNK: usize = 1 << 20;

/// `target` filled with `source`, as far as they go, and the rest of it with a constant: every byte is read once and written
/// once, by all threads.
pub fn copied(source: &[u8], mut target: Vec<u8>) -> Vec<u8> {
    let common = source.len().min(target.len());
    let (copy, rest) = target.split_at_mut(common);
    let chunks = source.par_chunks(CHUNK);
    copy.par_chunks_mut(CHUNK).zip(chunks).for_each(|(target, source)| target.copy_from_slice(&source[..target.len()]));
    rest.par_chunks_mut(CHUNK).for_each(|target| target.fill(1));
    target
}
