//! From a normal map in memory to all levels of its pyramid, beside copies of the map that write as many bytes, on the same
//! threads.

use std::hint::black_box;
use std::path::Path;

use rayon::prelude::*;
use roughcast::bump::NormalOffsets;
use roughcast::map::{DecodeOptions, NormalLayout, NormalMap, decode};
use roughcast::pyramid::{Moments, Shaped, ShapedMoments, build, level_sizes};
use serde_json::Value;

use crate::Failure;
use crate::clock::Time;

/// Bytes that a thread copies at a time.
const CHUNK: usize = 1 << 20;

/// Times `contender` once, after a run that wakes the threads.
///
/// # Errors
/// Where the image cannot be read, or nothing has that name.
pub fn measure(contender: &str, image: &Path) -> Result<Value, Failure> {
    let image = decode(&std::fs::read(image)?, &DecodeOptions::default())?;
    let (width, height) = (image.width, image.height);
    let read = image.bytes().len();
    let coarser: usize = level_sizes(width, height)[1..].iter().map(|(w, h)| *w as usize * *h as usize).sum();
    let map = NormalMap::new(image, NormalLayout::Auto, false)?;
    let copy = |texel: usize| {
        let source = vec![1_u8; read.max(CHUNK)];
        Box::new(move || drop(copied(black_box(&source), coarser * texel))) as Box<dyn Fn() + '_>
    };
    let work: Box<dyn Fn() + '_> = match contender {
        "moments" => Box::new(|| drop(build(&NormalOffsets::new(black_box(&map))))),
        "shape" => Box::new(|| drop(build(&Shaped(NormalOffsets::new(black_box(&map)))))),
        "copy of moments" => copy(size_of::<Moments>()),
        "copy of shape" => copy(size_of::<ShapedMoments>()),
        _ => return Err("expected moments, shape, copy of moments or copy of shape".into()),
    };
    work();
    let ((), time) = Time::of(work);
    Ok(time.to_json())
}

/// `size` bytes from all of `source`, over and over, into memory that is new, as the kernels do it.
fn copied(source: &[u8], size: usize) -> Vec<u8> {
    let mut target = vec![0; size];
    let chunks = source.len() / CHUNK;
    target.par_chunks_mut(CHUNK).enumerate().for_each(|(k, target)| {
        target.copy_from_slice(&source[k % chunks * CHUNK..][..target.len()]);
    });
    target
}
