//! Times the kernel from a normal map in memory to all levels of its pyramid, and copies that read the map and write as
//! many bytes on the same threads.

use std::hint::black_box;
use std::path::Path;

use roughcast::bump::{Moments, NormalLayout, NormalMap, NormalOffsets, Shaped, ShapedMoments};
use roughcast::decode::decode;
use roughcast::image::DecodeOptions;
use roughcast::mip::{build, level_sizes};
use serde_json::Value;

use crate::Failure;
use crate::clock::Time;
use crate::common::copy::copied;

/// Times `contender` once, after a run that wakes the threads.
///
/// # Errors
/// When the image cannot be read, or no contender has that name.
pub fn measure(contender: &str, image: &Path) -> Result<Value, Failure> {
    let image = decode(&std::fs::read(image)?, &DecodeOptions::default())?;
    let (width, height) = (image.width, image.height);
    let read = image.bytes().len();
    let mip_tail: usize = level_sizes(width, height)[1..].iter().map(|(w, h)| *w as usize * *h as usize).sum();
    let map = NormalMap::new(image, NormalLayout::Auto, false)?;
    let source = vec![1; read];
    // The copy goes into new memory, as in the kernels, or into memory that was written before.
    let copy_to_new = |texel| drop(copied(black_box(&source), vec![0; mip_tail * texel]));
    let mut kept = vec![0; if contender == "copy in place" { mip_tail * size_of::<Moments>() } else { 0 }];
    let mut work: Box<dyn FnMut() + '_> = match contender {
        "moments" => Box::new(|| drop(build(&NormalOffsets::new(black_box(&map))))),
        "shape" => Box::new(|| drop(build(&Shaped(NormalOffsets::new(black_box(&map)))))),
        "copy of moments" => Box::new(|| copy_to_new(size_of::<Moments>())),
        "copy of shape" => Box::new(|| copy_to_new(size_of::<ShapedMoments>())),
        "copy in place" => Box::new(|| {
            let target = std::mem::take(&mut kept);
            kept = copied(black_box(&source), target);
        }),
        _ => return Err("expected moments, shape, copy of moments, copy of shape or copy in place".into()),
    };
    work();
    let ((), time) = Time::of(work);
    Ok(time.to_json())
}
