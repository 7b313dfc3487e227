//! Encoded mip chains.

use std::mem;

use crate::codec::uastc::{Effort, Lobe, Metric};
use crate::codec::{EncodeError, ORM, PayloadFormat, Texels, encode, fallback};
use crate::ktx2::{Key, Ktx2Writer, LevelWriter, StoredLevel};
use crate::memory::{self, OutOfMemory};
use crate::mip::level_sizes;
use crate::settings::{Form, Settings};

/// A texture with all its levels encoded.
#[derive(Clone)]
pub struct MipChain {
    /// How texels are stored.
    pub format: PayloadFormat,
    /// Levels finer than level 0 that were left out.
    pub trimmed: usize,
    /// Columns of level 0.
    pub width: u32,
    /// Rows of level 0.
    pub height: u32,
    /// Level 0 first.
    levels: Vec<StoredLevel>,
    /// Level 0 as a PNG file, if the settings ask for one.
    pub fallback: Option<Vec<u8>>,
}

/// The first level whose blocks are searched thoroughly under each effort. It has 1/256 of the texels of level 0.
pub(crate) const THOROUGH_LEVEL: usize = 4;

/// How to encode a mip chain.
#[derive(Clone, Copy)]
pub struct Encoding {
    /// How texels are stored.
    pub format: PayloadFormat,
    /// The metric of the UASTC encoder.
    pub metric: Metric,
    /// Search effort of block encoders and of compression.
    pub effort: Effort,
    /// How much signal-to-noise ratio each UASTC level may lose for fewer bytes, in dB.
    pub rdo: Option<f64>,
    /// Finest level that is written. If its size does not suit the format, the next finer level that suits is written,
    /// too.
    pub finest: usize,
    /// Whether level 0 is also written as a PNG.
    pub fallback: bool,
}

impl Encoding {
    /// Returns the encoding of `settings` for texels of `channels` channels.
    pub fn of(settings: &Settings, channels: u32) -> Self {
        Self {
            format: settings.target.format(channels),
            metric: Metric::Rgb,
            effort: settings.quality,
            rdo: settings.rdo,
            finest: 0,
            fallback: settings.gltf == Form::Fallback,
        }
    }

    /// Weights the channels of an ORM texture: occlusion, roughness, metalness.
    pub fn with_orm_metric(self) -> Self {
        Self { metric: ORM, ..self }
    }

    /// Returns the encoding of normals.
    pub fn of_normals(settings: &Settings) -> Self {
        Self { format: settings.target.normal_format(), metric: Metric::Direction, ..Self::of(settings, 3) }
    }

    /// Returns the encoding of sRGB colours; `None` if the target has no format for them.
    pub fn of_colours(settings: &Settings, has_alpha: bool) -> Option<Self> {
        let metric = if has_alpha { Metric::Rgba } else { Metric::Rgb };
        let format = settings.target.colour_format(has_alpha)?;
        Some(Self { format, metric, ..Self::of(settings, 3) })
    }

    /// Leaves out levels finer than `finest`.
    pub fn starting_at(self, finest: usize) -> Self {
        Self { finest, ..self }
    }

    /// Returns the encoding of `level`. Far levels take little time even if the search is thorough, and their blocks
    /// hold many parts of a material.
    pub fn at(self, level: usize) -> Self {
        Self { effort: if level < THOROUGH_LEVEL { self.effort } else { Effort::Best }, ..self }
    }

    /// Returns which of the levels of `sizes` becomes level 0.
    pub fn first(&self, sizes: &[(u32, u32)]) -> usize {
        let suits = |&(width, height): &(u32, u32)| is_whole(self.format, width, height);
        sizes.iter().take(self.finest + 1).rposition(suits).unwrap_or(0)
    }
}

/// Why maps have no common grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// The grid would be larger than an image may be.
    #[error(
        "expected maps whose common grid has at most {limit} texels, found {width} x {height}; scale one of them down"
    )]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The limit on texels.
        limit: u64,
    },
    /// There is no memory for the levels over the grid.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

/// Returns the smallest grid that holds all of `sizes` and that the target's blocks allow: KHR_texture_basisu and BCn
/// need multiples of 4, also at the first level that is at most as large as [`Settings::max_size`].
///
/// # Errors
/// [`GridError`] if the grid has more texels, before rounding up, than the settings allow an image, or if there is no
/// memory for the levels that a bake keeps.
pub fn grid(settings: &Settings, sizes: impl IntoIterator<Item = (u32, u32)>) -> Result<(u32, u32), GridError> {
    let (width, height) = sizes.into_iter().fold((1, 1), |a, b| (a.0.max(b.0), a.1.max(b.1)));
    let limit = settings.max_texels;
    if u64::from(width) * u64::from(height) > limit {
        return Err(GridError::TooLarge { width, height, limit });
    }
    let texels = u64::from(width) * u64::from(height);
    memory::check(kept_bytes(texels, settings.rdo.is_some(), settings.profile.has_pyramid()))?;
    let edge = settings.target.format(3).codec().block_edge;
    let on_level = |level: usize| [width, height].map(|size| size.next_multiple_of(edge << level));
    let fits = |level: &usize| settings.max_size.is_none_or(|most| on_level(*level).iter().all(|n| n >> level <= most));
    // Settings have a least size of a block, which every grid has at this level at the latest.
    let level = (0..MAX_HALVINGS).find(fits).unwrap_or(0);
    let [width, height] = on_level(level);
    Ok((width, height))
}

/// More than the halvings of any image: its sides are below 2^24 texels.
const MAX_HALVINGS: usize = 24;

/// Returns the first level of a grid of `size` texels that is at most as large as [`Settings::max_size`].
pub fn first_within(settings: &Settings, (width, height): (u32, u32)) -> usize {
    let Some(most) = settings.max_size else { return 0 };
    let sizes = level_sizes(width, height);
    sizes.iter().position(|(width, height)| *width.max(height) <= most).unwrap_or(sizes.len() - 1)
}

/// Returns about how many bytes a bake of the default quality keeps in memory for the levels over a grid of `texels`,
/// beside its images: moments and base lobes up to level 1 of 4096^2, merged lobes up to level 1 of 8192^2. With
/// `has_rdo` a level is held as RGBA8 beside three copies of its blocks. With `has_pyramid` the lobes of levels 1 and
/// coarser are copied.
pub fn kept_bytes(texels: u64, has_rdo: bool, has_pyramid: bool) -> u64 {
    let rewritten = if has_rdo { 7 * texels } else { 0 };
    let copied = if has_pyramid { 8 * texels } else { 0 };
    12 * texels.min(1 << 24) + 8 * texels.min(1 << 26) + rewritten + copied
}

/// Returns whether level 0 may have the size.
fn is_whole(format: PayloadFormat, width: u32, height: u32) -> bool {
    let edge = format.codec().block_edge;
    width.is_multiple_of(edge) && height.is_multiple_of(edge)
}

/// Writes row y of a level to a slice of values: `(level, y, out)`.
pub type LevelRow<'a> = dyn Fn(usize, u32, &mut [[f32; 4]]) + Sync + 'a;

/// Writes the lobes about the normals of row y of a level: `(level, y, out)`.
pub type LobeRow<'a> = dyn Fn(usize, u32, &mut [Lobe]) + Sync + 'a;

/// The texels of all levels of a texture.
#[derive(Clone, Copy)]
pub struct LevelRows<'a> {
    /// Their values.
    pub values: &'a LevelRow<'a>,
    /// The lobes about the normals that they hold, if they are known.
    pub lobes: Option<&'a LobeRow<'a>>,
}

/// Encodes the levels of `sizes` that `encoding` asks for.
pub fn encode_mip_chain(
    sizes: &[(u32, u32)],
    encoding: Encoding,
    rows: LevelRows<'_>,
) -> Result<MipChain, EncodeError> {
    let first = encoding.first(sizes);
    let kept = &sizes[first..];
    let (width, height) = kept[0];
    let png = || {
        let row = |y: u32, out: &mut [[f32; 4]]| (rows.values)(first, y, out);
        let texels = Texels { width, height, row: &row, lobes: None };
        let has_alpha = encoding.format.has_alpha();
        encoding.fallback.then(|| fallback(&texels, has_alpha, encoding.effort)).transpose()
    };
    let (levels, fallback) = rayon::join(|| encode_levels(kept, first, encoding, BAND_BYTES, rows), png);
    let (levels, fallback) = (levels?, fallback?);
    Ok(MipChain { format: encoding.format, trimmed: first, width, height, levels, fallback })
}

/// Encoded bytes of a band of a level. One band at most waits for compression, which has one thread. Level 0 of 4096^2
/// has four bands.
const BAND_BYTES: usize = 1 << 22;

/// Encodes the levels from `finest` on, which have `sizes`, in bands of `max_bytes` bytes. The next band is encoded
/// while a band is compressed.
fn encode_levels(
    sizes: &[(u32, u32)],
    finest: usize,
    encoding: Encoding,
    max_bytes: usize,
    rows: LevelRows<'_>,
) -> Result<Vec<StoredLevel>, EncodeError> {
    let Encoding { format, effort, .. } = encoding;
    let mut levels = Vec::with_capacity(sizes.len());
    let mut encoded: Option<(LevelWriter, Vec<u8>)> = None;
    let compressed = |encoded: Option<(LevelWriter, Vec<u8>)>| match encoded {
        Some((mut level, band)) => level.push(&band).map(|()| Some(level)),
        None => Ok(None),
    };
    for (level, &(width, height)) in sizes.iter().enumerate() {
        // A band has whole rows of blocks. Rate-distortion optimisation compares all blocks of a level, so it has one
        // band.
        let block_row = format.level_bytes(width, EDGE);
        let band_rows = if encoding.rdo.is_some() { height } else { EDGE * (max_bytes / block_row).max(1) as u32 };
        for first in (0..height).step_by(band_rows as usize) {
            let values = |y: u32, out: &mut [[f32; 4]]| (rows.values)(finest + level, first + y, out);
            let lobes = rows.lobes.map(|row| move |y: u32, out: &mut [Lobe]| row(finest + level, first + y, out));
            let lobes = lobes.as_ref().map(|row| row as &(dyn Fn(u32, &mut [Lobe]) + Sync));
            let texels = Texels { width, height: band_rows.min(height - first), row: &values, lobes };
            let (band, last) =
                rayon::join(|| encode_band(&texels, encoding.at(finest + level)), || compressed(encoded.take()));
            let storing = match last? {
                Some(storing) if first > 0 => storing,
                finished => {
                    levels.extend(finished.map(LevelWriter::finish).transpose()?);
                    LevelWriter::new(format.level_bytes(width, height), format, effort)?
                }
            };
            encoded = Some((storing, band?));
        }
    }
    levels.extend(compressed(encoded)?.map(LevelWriter::finish).transpose()?);
    Ok(levels)
}

/// Texels along the edge of a block. Formats without blocks are encoded in bands of as many rows.
pub(crate) const EDGE: u32 = 4;

fn encode_band(texels: &Texels<'_>, encoding: Encoding) -> Result<Vec<u8>, EncodeError> {
    let Encoding { format, metric, effort, .. } = encoding;
    let mut blocks = encode(texels, format, metric, effort)?;
    if let (Some(lower_rate), Some(loss)) = (format.codec().lower_rate, encoding.rdo) {
        lower_rate(&mut blocks, texels, metric, loss)?;
    }
    Ok(blocks)
}

impl MipChain {
    /// Returns the KTX2 file of the mip chain.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn to_ktx2(&self, keys: &[Key]) -> Result<Vec<u8>, OutOfMemory> {
        self.clone().take_ktx2(keys)
    }

    /// Returns the KTX2 file of the mip chain and leaves the mip chain without levels.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn take_ktx2(&mut self, keys: &[Key]) -> Result<Vec<u8>, OutOfMemory> {
        let Self { format, width, height, .. } = *self;
        Ktx2Writer { format, width, height, levels: mem::take(&mut self.levels), keys }.into_bytes()
    }

    /// Returns the number of levels.
    pub fn level_count(&self) -> usize {
        level_sizes(self.width, self.height).len()
    }
}

#[cfg(test)]
mod tests;
