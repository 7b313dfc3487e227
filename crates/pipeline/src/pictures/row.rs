//! A row of a sheet: pictures of a material at one distance, one for each kind of mips, and one supersampled.

use super::columns::{Column, Columns, title_of};
use super::folder::Shown;
use super::options::PictureOptions;
use crate::render::{Advance, Crop, Difference, Picture, SceneName, Tone, filtered, relative_l1, supersampled};

/// A drawn row.
pub struct DrawnRow {
    /// From the eye to the surface, in repeats of the map.
    pub distance: f64,
    /// The pictures with filtered textures.
    pub columns: Vec<DrawnColumn>,
    /// The supersampled picture.
    pub truth: Picture,
    /// Expected relative L1 of `truth` against a picture with infinitely many samples.
    pub noise: f64,
    /// The tone mapping of all pictures.
    pub tone: Tone,
    /// The region that is shown enlarged.
    pub crop: Crop,
}

/// A picture with filtered textures.
pub struct DrawnColumn {
    /// The name of its column.
    pub name: &'static str,
    /// The picture.
    pub picture: Picture,
    /// Its difference from the supersampled picture.
    pub difference: Difference,
}

impl DrawnRow {
    /// Draws `columns` at one distance. Returns `None` if the scene shows no material.
    pub fn new(
        options: &PictureOptions,
        scene: SceneName,
        distance: f64,
        columns: &Columns,
        advance: Advance<'_>,
    ) -> Option<Self> {
        let scene = scene.scene(options.width, distance)?;
        let shader = options.shader(scene.f0);
        // Only the supersampled column reports progress, since it takes most of the time.
        let truth = supersampled(&scene, &columns.plain, &shader, options.samples, advance);
        let tone = Tone::expose_for(&truth.picture, scene.key);
        // The halves of the samples differ by twice the expected error of their mean.
        let noise = relative_l1(&truth.half, &truth.picture);
        let truth = truth.picture;
        let columns: Vec<DrawnColumn> = columns
            .filtered()
            .map(|Column { name, material }| {
                let picture = filtered(&scene, material, &shader, options.filter, &|_| {});
                let difference = Difference::between(&picture, &truth, &tone);
                DrawnColumn { name, picture, difference }
            })
            .collect();
        let pictures: Vec<&Picture> = columns.iter().map(|column| &column.picture).collect();
        let crop = Crop::most_different(&pictures, &truth, &tone);
        Some(Self { distance, columns, truth, noise, tone, crop })
    }

    /// Returns the pictures with what a sheet says of them.
    pub fn panels(&self) -> Vec<Shown<'_>> {
        let shown = |name: &str, picture, labels| {
            let heading = format!("{}, distance {}", title_of(name), self.distance);
            Shown { heading, picture, crop: Some(self.crop), labels, tone: self.tone }
        };
        let columns = self.columns.iter().map(|DrawnColumn { name, picture, difference }| {
            let labels = vec![
                format!("error {:.3} (lower is better)", difference.relative_l1),
                format!("SSIM {:.3} (higher is better)", difference.ssim),
            ];
            shown(name, picture, labels)
        });
        let truth = shown("supersampled", &self.truth, vec![format!("noise {:.3}", self.noise)]);
        columns.chain([truth]).collect()
    }
}
