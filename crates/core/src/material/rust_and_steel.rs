//! A material of two populations, for tests.

use crate::bump::{NormalLayout, NormalMap};
use crate::image::{Image, Rgba, Samples};
use crate::material::base::{Base, BaseRows};
use crate::material::bump_map::BumpMap;
use crate::material::reflectance::{Factored, Metalness, ReflectanceRows, ReflectanceSource};
use crate::mip::Wrap;

/// Width and height.
pub const SIDE: u32 = 64;

/// Returns an image whose texel (x, y) has the channels that `texel` returns.
fn image(texel: impl Fn(u32, u32) -> [u8; 3]) -> Image {
    let samples = (0..SIDE * SIDE).flat_map(|i| texel(i % SIDE, i / SIDE)).collect();
    Image { width: SIDE, height: SIDE, channels: 3, samples: Samples::U8(samples) }
}

/// Returns whether a texel is mirror steel. All others are rust.
pub fn is_steel(x: u32, y: u32) -> bool {
    (x / 8 + y / 8).is_multiple_of(2)
}

/// Rust with bumps beside mirror steel, which lies flat, in squares of eight texels.
pub struct RustAndSteel {
    pub bump_map: BumpMap,
    orm: Image,
    colour: Image,
}

impl RustAndSteel {
    pub fn new() -> Self {
        let slope = |x: u32, y: u32| [40 * (x % 2) as u8 + 20 * (y % 2) as u8, 50 * (y % 2) as u8];
        let normal = |x, y| {
            let [u, v] = if is_steel(x, y) { [0, 0] } else { slope(x, y) };
            [128 + u, 100 + v, 220]
        };
        let normals = NormalMap::new(image(normal), NormalLayout::Xyz, false).unwrap();
        Self {
            bump_map: BumpMap::Normals(normals),
            orm: image(|x, y| if is_steel(x, y) { [255, 40, 255] } else { [255, 200, 0] }),
            colour: image(|x, y| if is_steel(x, y) { [200, 200, 200] } else { [90, 40, 20] }),
        }
    }

    /// Returns the base lobe, with or without its reflectance.
    pub fn base(&self, has_reflectance: bool) -> Base<'_> {
        let wrap = [Wrap::Repeat; 2];
        let source = ReflectanceSource {
            roughness: Some(&self.orm),
            metalness: Metalness::new(Some(&self.orm), 1.0),
            base_colour: Factored { image: Some(&self.colour), factor: [1.0; 3] },
            specular: Factored { image: None, factor: 1.0 },
            specular_colour: Factored { image: None, factor: [1.0; 3] },
        };
        let reflectance = ReflectanceRows::new(&source, (SIDE, SIDE), wrap).filter(|_| has_reflectance);
        let rows = BaseRows::new(SIDE, SIDE, Some(Rgba(&self.orm)), 1.0, None, wrap);
        Base::new(rows.with_reflectance(reflectance))
    }
}
