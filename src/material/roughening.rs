//! Roughness mips: the lost bumps folded into the material's own lobe, texel by texel (DESIGN: portable profile).

use rayon::prelude::*;

use crate::codec::EncodeError;
use crate::lobe::{Anisotropy, Roughness, SquaredAlpha, isotropic_distance};
use crate::material::base::{Base, BaseTexel};
use crate::material::bumps::Bumps;
use crate::material::lobes::{Lobes, base_lobe};
use crate::material::mip_chain::{Encoding, MipChain, encode_mip_chain};
use crate::math::symmetric::Symmetric2;
use crate::settings::{Model, Settings};
use crate::simd::map_row;

/// Axis ratio from which on a direction is worth keeping: a circle in the ellipse's place is off by 0.13.
const CLEARLY_ANISOTROPIC: f32 = 1.5;

/// A material's lobe roughened by its bumps.
pub struct Roughening<'a> {
    base: Base<'a>,
    lobes: Lobes<'a>,
    /// Whether the material's own lobe is anisotropic.
    is_anisotropic: bool,
}

/// Textures that hold a folded lobe.
pub struct RoughenedTextures {
    /// Roughness in green; red and blue as in the material's own texture, averaged.
    pub roughness: MipChain,
    /// Direction in red and green, strength in blue; only for the anisotropic model.
    pub anisotropy: Option<MipChain>,
}

/// Rows of a level that notes are made from: all of a small one. They tell of what many texels do. Their number is odd, so that
/// they meet all of what repeats by powers of two.
fn looked_at(height: u32) -> impl IndexedParallelIterator<Item = u32> {
    let count = height.min(65);
    (0..count).into_par_iter().map(move |i| (u64::from(i) * u64::from(height) / u64::from(count)) as u32)
}

impl<'a> Roughening<'a> {
    /// Joins `base` with `bumps` on the same grid. `slope_scale` multiplies offsets (`normalTexture.scale`).
    pub fn new<'b: 'a>(base: Base<'a>, bumps: &Bumps<'b>, slope_scale: f32, settings: &Settings) -> Self {
        let is_anisotropic = base.finest().is_anisotropic();
        let lobes = Lobes::new(&base, bumps, slope_scale, settings);
        Self { base, lobes, is_anisotropic }
    }

    /// Gives its memory back on two threads: the system takes it page by page, which takes 30 ms after 4096 x 4096.
    pub fn drop_all(self) {
        rayon::join(|| drop(self.base), || drop(self.lobes));
    }

    /// The lobes of all levels.
    pub fn lobes(&self) -> &Lobes<'a> {
        &self.lobes
    }

    /// The material's own lobe, averaged over its map.
    pub fn base_lobe(&self) -> SquaredAlpha {
        base_lobe(&self.base.whole())
    }

    /// Sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        self.base.sizes()
    }

    /// Whether the material is anisotropic by itself.
    pub fn is_anisotropic(&self) -> bool {
        self.is_anisotropic
    }

    /// About how many texels over all levels have a lobe under `model` that is wider than an engine can show.
    pub fn texels_above_one(&self, model: Model) -> u64 {
        let is_too_wide = |lobe: SquaredAlpha| match model {
            Model::Anisotropic => lobe.exceeds_one(),
            _ => lobe.isotropic_exceeds_one(),
        };
        let levels = self.sizes().into_iter().enumerate();
        let in_level = |(level, (width, height)): (usize, (u32, u32))| -> u64 {
            let in_row =
                |y| self.alphas(level, y, width as usize).into_iter().filter(|lobe| is_too_wide(*lobe)).count() as u64;
            let rows = looked_at(height);
            let read = rows.len() as u64;
            rows.map(in_row).sum::<u64>() * u64::from(height) / read
        };
        levels.map(in_level).sum()
    }

    /// Mean distance by which noise of covariance `noise` in the bumps moves lobes of level 1, where it weighs most.
    pub fn noise_loss(&self, noise: Symmetric2) -> f32 {
        let Some(&(width, height)) = self.sizes().get(1) else { return 0.0 };
        let noise = noise.scaled([self.lobes.slope_scale(); 2]);
        let moved = |full: SquaredAlpha| {
            let noisier = full.roughen(noise);
            f64::from(isotropic_distance(full.closest_isotropic(), noisier.closest_isotropic()))
        };
        let in_row = |y| self.alphas(1, y, width as usize).into_iter().map(moved).sum::<f64>();
        let rows: Vec<f64> = looked_at(height).map(in_row).collect();
        (rows.iter().sum::<f64>() / (f64::from(width) * rows.len() as f64)) as f32
    }

    /// The share of texels of levels 2 and coarser whose stored direction points away from that of the texel to their
    /// right or below, where both lobes are clearly elliptical: filtering between them loses the direction.
    pub fn opposed_share(&self) -> f32 {
        let reference = self.reference();
        let direction = |full: SquaredAlpha| match full.axis_ratio() > CLEARLY_ANISOTROPIC {
            true => Anisotropy::of(full, reference).direction,
            false => [0.0; 2],
        };
        let opposed = |a: [f32; 2], b: [f32; 2]| a[0] * b[0] + a[1] * b[1] < 0.0;
        let (mut count, mut total) = (0.0, 0.0);
        for (level, (width, height)) in self.sizes().into_iter().enumerate().skip(2) {
            let directions = |y: u32, out: &mut Vec<[f32; 2]>| {
                out.clear();
                out.extend(self.alphas(level, y, width as usize).into_iter().map(direction));
            };
            let in_row = |(row, below): &mut (Vec<[f32; 2]>, Vec<[f32; 2]>), y: u32| {
                directions(y, row);
                directions((y + 1).min(height - 1), below);
                let right = row.iter().skip(1).chain(row.last());
                row.iter()
                    .zip(right)
                    .zip(below.iter())
                    .filter(|((a, r), b)| opposed(**a, **r) || opposed(**a, **b))
                    .count()
            };
            let (rows, texels) = (looked_at(height), f64::from(width) * f64::from(height));
            let read = rows.len() as f64 * f64::from(width);
            count += rows.map_init(Default::default, in_row).sum::<usize>() as f64 * texels / read;
            total += texels;
        }
        if total > 0.0 { (count / total) as f32 } else { 0.0 }
    }

    /// The axis of the whole map, which directions agree with.
    fn reference(&self) -> [f32; 2] {
        self.lobes.whole().squared_alpha.0.eigen().axis
    }

    /// The textures under `model`, which is [`Model::Isotropic`] or [`Model::Anisotropic`]; anything else counts as
    /// isotropic.
    pub fn bake(&self, model: Model, encoding: Encoding) -> Result<RoughenedTextures, EncodeError> {
        let sizes = self.sizes();
        let roughness = encode_mip_chain(&sizes, encoding.of_surface(), &self.roughness_rows(model))?;
        let anisotropy = (model == Model::Anisotropic)
            .then(|| encode_mip_chain(&sizes, encoding, &self.anisotropy_rows()))
            .transpose()?;
        Ok(RoughenedTextures { roughness, anisotropy })
    }

    /// Rows of the roughness texture under `model`.
    pub fn roughness_rows(&self, model: Model) -> impl Fn(usize, u32, &mut [[f32; 4]]) + Sync {
        let axis = self.reference();
        move |level, y, out| {
            if self.lobes.are_base(level) && !self.is_anisotropic {
                return self.base.finest().isotropic_row(y, out);
            }
            let (mut red_blue, full) = (vec![[0.0; 2]; out.len()], self.alphas(level, y, out.len()));
            self.base.red_blue(level, y, &mut red_blue);
            let texels =
                red_blue.iter().zip(&full).map(|([red, blue], SquaredAlpha(a))| [*red, *blue, a.uu, a.uv, a.vv]);
            let lobe = |uu, uv, vv| SquaredAlpha(Symmetric2::new(uu, uv, vv));
            let store = |texel: &mut [f32; 4], [red, green, blue]: [f32; 3]| *texel = [red, green, blue, 1.0];
            // Roots side by side: one by one they take as long as all the rest.
            if model == Model::Anisotropic {
                let of =
                    |[red, blue, uu, uv, vv]: [f32; 5]| [red, Anisotropy::of(lobe(uu, uv, vv), axis).roughness.0, blue];
                map_row(texels, out, of, store);
            } else {
                let of = |[red, blue, uu, uv, vv]: [f32; 5]| {
                    [red, Roughness::from(lobe(uu, uv, vv).closest_isotropic()).0.min(1.0), blue]
                };
                map_row(texels, out, of, store);
            }
        }
    }

    /// Rows of the anisotropy texture.
    pub fn anisotropy_rows(&self) -> impl Fn(usize, u32, &mut [[f32; 4]]) + Sync {
        let axis = self.reference();
        move |level, y, out| {
            map_row(
                self.alphas(level, y, out.len()).iter().map(|SquaredAlpha(a)| [a.uu, a.uv, a.vv]),
                out,
                |[uu, uv, vv]| {
                    let full = SquaredAlpha(Symmetric2::new(uu, uv, vv));
                    let Anisotropy { strength, direction: [u, v], .. } = Anisotropy::of(full, axis);
                    [0.5 * u + 0.5, 0.5 * v + 0.5, strength]
                },
                |texel, [u, v, strength]| *texel = [u, v, strength, 1.0],
            );
        }
    }

    /// Rows of squared alphas, uu, uv, vv: of the material's own lobe, or, with the bumps `folded` in, of any size.
    pub fn lobe_rows(&self, roughened: bool) -> impl Fn(usize, u32, &mut [[f32; 4]]) + Sync {
        move |level, y, out| {
            let lobes =
                if roughened { self.alphas(level, y, out.len()) } else { self.base_alphas(level, y, out.len()) };
            out.iter_mut().zip(lobes).for_each(|(texel, SquaredAlpha(a))| *texel = [a.uu, a.uv, a.vv, 0.0]);
        }
    }

    /// Whether red and blue of the material's own roughness texture are the same everywhere, so that a smaller texture
    /// loses nothing of them.
    pub fn is_plain(&self) -> bool {
        self.base.is_plain()
    }

    /// The folded lobes of a row.
    fn alphas(&self, level: usize, y: u32, width: usize) -> Vec<SquaredAlpha> {
        if self.lobes.are_base(level) {
            return self.base_alphas(level, y, width);
        }
        let mut alphas = vec![SquaredAlpha::default(); width];
        self.lobes.squared_alphas(level, y, &mut alphas);
        alphas
    }

    /// The material's own lobes of a row.
    fn base_alphas(&self, level: usize, y: u32, width: usize) -> Vec<SquaredAlpha> {
        let mut own = vec![BaseTexel::default(); width];
        self.base.row(level, y, &mut own);
        own.iter().map(base_lobe).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn notes_see_every_phase_of_a_pattern() {
        for height in [128, 512, 1024, 2048, 4096] {
            for period in [2, 8, 32, 64] {
                let phases: BTreeSet<u32> = looked_at(height).map(|y| y % period).collect();
                assert_eq!(phases.len() as u32, period, "{height} rows");
            }
        }
        assert_eq!(looked_at(20).collect::<Vec<_>>(), (0..20).collect::<Vec<_>>());
    }
}
