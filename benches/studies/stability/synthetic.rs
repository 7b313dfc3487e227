//! Bump maps made from formulas.

use roughcast::bump::{Moments, NormalLayout, NormalMap, Offset};
use roughcast::image::{Image, MapError, Samples};
use roughcast::mip::{Level, Merge, Pyramid};

/// Random numbers in [0, 1) that are equal on every machine.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Makes level 0 of `width` x `height` texels without variance.
pub fn level(width: u32, height: u32, mut slope: impl FnMut(u32, u32) -> [f64; 2]) -> Level<Moments> {
    let texels = (0..width * height).map(|i| {
        let [u, v] = slope(i % width, i / width);
        Moments::flat(Offset { u: u as f32, v: v as f32 })
    });
    Level { width, height, texels: texels.collect() }
}

/// Returns all texels of one level of a pyramid.
pub fn texels<T: Merge>(pyramid: &Pyramid<Level<T>>, level: usize) -> Vec<T> {
    let (width, height) = pyramid.sizes()[level];
    let mut out = vec![T::default(); width as usize * height as usize];
    for (y, row) in out.chunks_exact_mut(width as usize).enumerate() {
        pyramid.row(level, y as u32, row);
    }
    out
}

/// Returns x, y and z of the unit normals of slopes.
pub fn normals(level: &Level<Moments>) -> Vec<f64> {
    let normal = |m: &Moments| {
        let (u, v) = (f64::from(m.mean.u), f64::from(m.mean.v));
        let z = 1.0 / (u * u + v * v + 1.0).sqrt();
        [-u * z, -v * z, z]
    };
    level.texels.iter().flat_map(normal).collect()
}

/// Makes a map of three channels.
pub fn map(size: u32, samples: Samples) -> Result<NormalMap, MapError> {
    NormalMap::new(Image { width: size, height: size, channels: 3, samples }, NormalLayout::Xyz, false)
}
