//! A small reference renderer that compares materials as engines shade them with supersampled ground truth.
//!
//! A [`Scene`] is drawn with a [`Material`] in two ways. [`filtered`] shades one sample per pixel through mips as
//! hardware filters them. [`supersampled`] shades many samples of the unfiltered level 0. [`Difference`] measures the
//! difference of the two pictures. The paper's example images are [`SceneName::Lake`] (its figures 8 and 9),
//! [`SceneName::Pattern`] (10 and 11) and [`highlight`] (14). This module takes texels, never files.

mod camera;
mod crop;
mod difference;
mod displayed;
mod draw;
mod environment;
mod facets;
mod font;
mod highlight;
mod lobe_filter;
mod material;
mod patch;
mod quasirandom;
mod sample_sums;
mod sampler;
mod samples;
mod scene;
mod shade;
mod shape;
mod sheet;
mod supersampled;
#[cfg(test)]
mod tests;
mod tone;
mod waves;

pub use camera::Camera;
pub use crop::{Crop, MAGNIFICATION};
pub use difference::{Difference, relative_l1};
pub use displayed::Displayed;
pub use draw::{Advance, Picture, filtered};
pub use environment::{Environment, Radiance, Surroundings};
pub use highlight::highlight;
pub use material::{BaseAnisotropy, Bumps, LostBumps, Material, Point, RangedTexture};
pub use sampler::{Filter, Footprint, Texel, Texture};
pub use scene::{Light, Scene, SceneName};
pub use shade::{EnvironmentFilter, Reflection, Shader, View};
pub use shape::{Hit, Shape};
pub use sheet::{Panel, Sheet};
pub use supersampled::{Supersampled, supersampled};
pub use tone::Tone;
pub use waves::waves;
