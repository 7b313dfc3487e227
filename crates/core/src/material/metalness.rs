//! Mips of metalness where bright and dark texels of the base colour differ in metalness.
//!
//! An engine reads one base colour and one metalness, and multiplies them: F0 of a metal is their product. Means of
//! both do not have the mean product. With the metalness sum(c m) / sum(c), where c is the luminance of the base colour
//! and m the metalness of level 0, the mean colour is split between F0 and albedo as level 0 splits it.

use crate::image::Rgba;
use crate::material::reflectance::ReflectanceRows;
use crate::mip::{LinearResampled, MipTail, TexelRows};

/// Levels 1 and coarser of a metalness that counts by base colour.
pub struct MetalnessLevels(MipTail<ColouredTexel>);

/// Metalness times luminance, and luminance.
type ColouredTexel = [f32; 2];

/// Level 0.
pub struct ColouredRows<'r, 'a> {
    metalness: &'r LinearResampled<Rgba<'a>>,
    reflectance: &'r ReflectanceRows<'a>,
}

impl<'r, 'a> ColouredRows<'r, 'a> {
    /// Takes the texture whose blue is metalness; `None` if the metalness or the base colour of `reflectance` is
    /// constant.
    pub fn new(metalness: &'r LinearResampled<Rgba<'a>>, reflectance: &'r ReflectanceRows<'a>) -> Option<Self> {
        reflectance.metalness_varies_with_colour().then_some(Self { metalness, reflectance })
    }
}

impl TexelRows for ColouredRows<'_, '_> {
    type Texel = ColouredTexel;

    fn width(&self) -> u32 {
        self.metalness.width()
    }

    fn height(&self) -> u32 {
        self.metalness.height()
    }

    fn row(&self, y: u32, out: &mut [ColouredTexel]) {
        let mut texels = vec![[0.0; 4]; out.len()];
        self.metalness.row(y, &mut texels);
        let colours = self.reflectance.colour_row(y, out.len());
        for ((out, [_, _, metalness, _]), [colour]) in out.iter_mut().zip(texels).zip(colours) {
            *out = [metalness * colour, colour];
        }
    }
}

impl MetalnessLevels {
    /// Builds the levels over `level_0`.
    pub fn new(level_0: &ColouredRows<'_, '_>) -> Self {
        Self(MipTail::new(level_0))
    }

    /// Calls `write(x, metalness)` for the texels of row `y` of `level`, except black ones, whose metalness does not
    /// matter. `level_0` is what the levels were built over.
    pub fn row(&self, level_0: &ColouredRows<'_, '_>, level: usize, y: u32, mut write: impl FnMut(usize, f32)) {
        self.0.with_row(level_0, level, y, |row| {
            for (x, [product, colour]) in row.iter().enumerate().filter(|(_, [_, colour])| *colour > 0.0) {
                write(x, product / colour);
            }
        });
    }
}
