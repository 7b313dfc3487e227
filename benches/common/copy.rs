//! Copies, which bound what any kernel can reach with the bandwidth of memory.

use rayon::prelude::*;

/// Bytes that a thread copies at a time.
const CHUNK: usize = 1 << 20;

/// Fills `target` from `source`, and a longer target with a constant behind the source. All threads together read and
/// write every byte once.
pub fn copied(source: &[u8], mut target: Vec<u8>) -> Vec<u8> {
    let common = source.len().min(target.len());
    let (copy, rest) = target.split_at_mut(common);
    let chunks = source.par_chunks(CHUNK);
    copy.par_chunks_mut(CHUNK).zip(chunks).for_each(|(target, source)| target.copy_from_slice(&source[..target.len()]));
    rest.par_chunks_mut(CHUNK).for_each(|target| target.fill(1));
    target
}
