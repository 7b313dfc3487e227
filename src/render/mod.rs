//! A small reference renderer: what engines make of a material, beside the truth.
//!
//! A [`Scene`] is drawn with a [`Material`] in two ways: [`filtered`], one shaded sample per pixel through mips as hardware
//! filters them, and [`supersampled`], many samples of the unfiltered level 0. [`Difference`] tells how far the first is
//! from the second. The paper's example images are [`Subject::Lake`] (its figures 8 and 9), [`Subject::Pattern`] (10 and
//! 11) and [`highlight`] (14). This module takes texels, never files.

mod camera;
mod difference;
mod draw;
mod environment;
mod font;
mod highlight;
mod material;
mod sampler;
mod scene;
mod shade;
mod shape;
mod sheet;
#[cfg(test)]
mod tests;
mod tone;
mod waves;

pub use camera::Camera;
pub use difference::{Difference, relative_l1};
pub use draw::{Advance, Picture, Supersampled, filtered, supersampled};
pub use environment::{Environment, Radiance, Surroundings};
pub use highlight::highlight;
pub use material::{BaseAnisotropy, Bumps, LostBumps, Material, Point, Ranged};
pub use sampler::{Filter, Footprint, Texel, Texture};
pub use scene::{Light, Scene, Subject};
pub use shade::{EnvironmentFilter, Reflection, Shader, View};
pub use shape::{Hit, Shape};
pub use sheet::{Panel, Sheet};
pub use tone::Tone;
pub use waves::waves;
