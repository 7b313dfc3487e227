//! Measurements that `run.py` cannot take from outside. Each subcommand prints one line of JSON.
//!
//! Each process measures one thing once, so that runs alternate and each has its own peak memory.

mod basisu;
mod clock;
mod common;
mod decoders;
mod encoders;
mod inputs;
mod kernels;
mod lobes;
mod mosaic;
mod pack;
mod quality;

use std::error::Error;
use std::path::Path;

use serde_json::Value;

/// An error that ends a measurement.
type Failure = Box<dyn Error>;

const USAGE: &str = "expected one of
  inputs asset FOLDER SIZE COUNT [DATA]   COUNT assets with maps of SIZE x SIZE
  inputs jpeg NORMAL.png OUT.jpg
  encode CONTENDER IMAGE                  one level to UASTC
  quality IMAGE...                        what each encoder leaves of the maps
  lobes IMAGE...                          what each encoder adds to the lobe error of normal maps
  kernel CONTENDER NORMAL.png             offsets to all levels, or a copy of as many bytes
  decode DECODER IMAGE
  images in turn|side by side IMAGE IMAGE what a bake decodes
  pack IMAGE OUT.ktx2                     what `ktx create` does";

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let report: Value = match arguments[..] {
        ["inputs", "asset", folder, size, count, ref data @ ..] => {
            inputs::assets(Path::new(folder), size.parse()?, count.parse()?, data.first().map(|data| Path::new(*data)))?
        }
        ["inputs", "jpeg", image, out] => inputs::jpeg(Path::new(image), Path::new(out))?,
        ["encode", contender, image] => encoders::measure(contender, Path::new(image))?,
        ["quality", ref images @ ..] => quality::measure(images)?,
        ["lobes", ref images @ ..] => lobes::measure(images)?,
        ["kernel", contender, image] => kernels::measure(contender, Path::new(image))?,
        ["decode", decoder, image] => decoders::measure(decoder, Path::new(image))?,
        ["images", order, first, second] => decoders::images(order, [first, second].map(Path::new))?,
        ["pack", image, out] => pack::measure(Path::new(image), Path::new(out))?,
        _ => return Err(USAGE.into()),
    };
    println!("{report}");
    Ok(())
}
