//! Crops of levels of bakes in half floats, and the errors of blocks of their normals.

use std::error::Error;

use rayon::prelude::*;
use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::bump::{NormalLayout, NormalMap};
use roughcast::codec::uastc::{Effort, Lobe, Metric, decode_block};
use roughcast::codec::{PayloadFormat, Target as Payload, Texels, encode};
use roughcast::image::{Image, Samples};
use roughcast::ktx2::Ktx2;
use roughcast::lobe::{Alpha, Family, Roughness, SquaredAlpha};
use roughcast::material::BumpMap;
use roughcast::metric::{Decoded, Surface, mean_errors, shown_lobe};
use roughcast::report::Content;
use roughcast::settings::{Model, Settings};

use crate::format::Kind;
use crate::gaps::Gaps;
use crate::objective::{Reading, Target, total_variation};
use crate::search::{Found, search};
use crate::{LEVELS, Sums};

/// Texels along a side of a crop of a level.
const CROP: u32 = 16;
const READINGS: [Reading; 2] = [Reading::Encoder, Reading::Normalised];

/// A crop of one level of a bake, with exact lobes.
pub struct Crop {
    pub level: u32,
    surface: Surface,
    normals: Image,
    roughness: Option<Image>,
    anisotropy: Option<Image>,
    /// Where the crop begins.
    at: (u32, u32),
}

/// Returns crops of [`LEVELS`] of the bake of `image` in half floats.
pub fn crops(image: &Image, alpha: f32) -> Result<Vec<Crop>, Box<dyn Error>> {
    let map = || NormalMap::new(image.clone(), NormalLayout::Auto, false);
    let base = BaseRoughness { image: None, factor: Roughness::from(Alpha(alpha)).0 };
    let settings =
        Settings::default().with_model(Model::Anisotropic).with_target(Payload::Float).with_provenance(false);
    let baked = bake_map(&BumpMap::Normals(map()?), Some(&base), &settings)?;
    let files = baked.textures.iter().map(|t| Ok((t.content, t.mip_chain.to_ktx2(&[])?)));
    let files = files.collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    let crop = |level| {
        let of = |content| -> Result<Option<Image>, Box<dyn Error>> {
            let file = files.iter().find(|f| f.0 == content);
            file.map(|(_, bytes)| Ok(Ktx2::parse(bytes)?.decode_level(level)?)).transpose()
        };
        let normals = of(Content::Normal)?.ok_or("the bake has no normals")?;
        let at = ((normals.width - CROP) / 8 * 4, (normals.height - CROP) / 8 * 4);
        let surface = Surface::of_map(&map()?, SquaredAlpha::isotropic(Alpha(alpha))).magnified();
        Ok(Crop {
            level,
            surface,
            normals,
            roughness: of(Content::Roughness)?,
            anisotropy: of(Content::Anisotropy)?,
            at,
        })
    };
    LEVELS.into_iter().map(crop).collect()
}

impl Crop {
    /// Returns the vector of a texel of the crop in [-1, 1].
    fn normal(&self, x: u32, y: u32) -> [f32; 3] {
        [0, 1, 2].map(|c| 2.0 * self.normals.sample(self.at.0 + x, self.at.1 + y, c).unwrap_or(1.0) - 1.0)
    }

    fn lobe(&self, x: u32, y: u32) -> Lobe {
        let sample = |image: &Image, c| image.sample(self.at.0 + x, self.at.1 + y, c).unwrap_or(1.0);
        let roughness = self.roughness.as_ref().map_or(1.0, |image| sample(image, 1));
        let anisotropy = self.anisotropy.as_ref().map(|image| [0, 1, 2].map(|c| sample(image, c)));
        let [uu, uv, vv] = shown_lobe(roughness, anisotropy).map(|a| a as f32);
        Lobe { uu, uv, vv }
    }

    /// Returns the blocks of the encoder.
    fn encoded(&self, effort: Effort) -> Vec<[u8; 16]> {
        let row = |y: u32, out: &mut [[f32; 4]]| {
            for (x, texel) in (0..).zip(out) {
                let [r, g, b] = self.normal(x, y).map(|c| 0.5 * c + 0.5);
                *texel = [r, g, b, 1.0];
            }
        };
        let lobes = |y: u32, out: &mut [Lobe]| (0..).zip(out).for_each(|(x, lobe)| *lobe = self.lobe(x, y));
        let texels = Texels { width: CROP, height: CROP, row: &row, lobes: Some(&lobes) };
        let bytes = encode(&texels, PayloadFormat::UastcRgb, Metric::Direction, effort).unwrap_or_default();
        bytes.as_chunks().0.to_vec()
    }

    /// Returns the targets of block `k`.
    pub fn targets(&self, k: usize, reading: Reading) -> [Target; 16] {
        std::array::from_fn(|i| {
            let (x, y) = texel_of(k, i);
            reading.target(self.normal(x, y), self.lobe(x, y))
        })
    }

    /// Returns the errors of the encoder's blocks and of both floors, and adds to `gaps`.
    pub fn measure(&self, kinds: &[Kind], effort: usize, gaps: &mut Gaps) -> Sums {
        let encoded = [Effort::Fast, Effort::Best].map(|effort| self.encoded(effort));
        let colours = encoded.clone().map(|blocks| blocks.iter().map(colours_of).collect::<Vec<_>>());
        let found: Vec<[Found; 2]> = (0..encoded[0].len())
            .into_par_iter()
            .map(|k| {
                let given = [encoded[0][k], encoded[1][k]];
                READINGS.map(|reading| search(kinds, &self.targets(k, reading), reading, &given, effort))
            })
            .collect();
        let mut sums = Sums::default();
        for (k, found) in found.iter().enumerate() {
            for (r, reading) in READINGS.into_iter().enumerate() {
                let targets = self.targets(k, reading);
                let variation = |colours: &[[u8; 3]; 16]| -> f64 {
                    let errors = targets.iter().zip(colours);
                    errors.map(|(t, &c)| f64::from(total_variation(t.squared(&reading.entry(c))))).sum()
                };
                let [fast, best] = [0, 1].map(|e| variation(&colours[e][k]));
                if reading == Reading::Encoder {
                    gaps.add(kinds, &encoded[1][k], best, &found[r]);
                }
                let own = [fast, best, variation(&found[r].colours)];
                sums.variations[r].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            }
        }
        let floors = [0, 1].map(|r| found.iter().map(|found| found[r].colours).collect::<Vec<_>>());
        let decoded = |normal| Decoded {
            normal,
            roughness: self.roughness.clone(),
            roughness_factor: 1.0,
            anisotropy: self.anisotropy.clone(),
        };
        let images = colours.iter().chain(&floors).map(|blocks| self.image(blocks));
        let decoded: Vec<Decoded> = std::iter::once(self.normals.clone()).chain(images).map(decoded).collect();
        let texels: Vec<(u32, u32)> = (0..CROP * CROP).map(|i| (self.at.0 + i % CROP, self.at.1 + i / CROP)).collect();
        let size = (self.normals.width, self.normals.height);
        sums.errors = mean_errors(&self.surface, Family::Ggx, size, &texels, |(x, y), _, reference| {
            let mut errors = [1.0; 5];
            for (error, decoded) in errors.iter_mut().zip(&decoded) {
                *error = decoded.lobe(Family::Ggx, x, y).map_or(1.0, |lobe| reference.error(&lobe));
            }
            errors
        });
        sums
    }

    /// Returns a level with the colours of the crop's blocks, and black elsewhere.
    fn image(&self, blocks: &[[[u8; 3]; 16]]) -> Image {
        let (width, height) = (self.normals.width, self.normals.height);
        let mut samples = vec![0; 3 * width as usize * height as usize];
        for (k, colours) in blocks.iter().enumerate() {
            for (i, colour) in colours.iter().enumerate() {
                let (x, y) = texel_of(k, i);
                let at = 3 * ((self.at.1 + y) * width + self.at.0 + x) as usize;
                samples[at..at + 3].copy_from_slice(colour);
            }
        }
        Image { width, height, channels: 3, samples: Samples::U8(samples) }
    }
}

/// Returns where texel `i` of block `k` stands in a crop.
fn texel_of(k: usize, i: usize) -> (u32, u32) {
    let (k, i) = (k as u32, i as u32);
    (k % (CROP / 4) * 4 + i % 4, k / (CROP / 4) * 4 + i / 4)
}

fn colours_of(block: &[u8; 16]) -> [[u8; 3]; 16] {
    decode_block(block).unwrap_or([[0; 4]; 16]).map(|[r, g, b, _]| [r, g, b])
}
