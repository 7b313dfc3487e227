//! A row of a sheet: pictures of a material at one distance, one for each kind of mips, and one supersampled.

use super::columns::{Column, Columns, title_of};
use super::folder::Shown;
use super::options::PictureOptions;
use crate::render::{Advance, Crop, Difference, Displayed, Scene, Tone, filtered, relative_l1, supersampled};

/// A drawn row.
pub struct DrawnRow {
    /// From the eye to the surface, in repeats of the map.
    pub distance: f64,
    /// The pictures with filtered textures.
    pub columns: Vec<DrawnColumn>,
    /// The supersampled picture.
    pub truth: Displayed,
    /// Expected relative L1 of `truth` against a picture with infinitely many samples.
    pub noise: f64,
    /// The region that is shown enlarged.
    pub crop: Crop,
}

/// A picture with filtered textures.
pub struct DrawnColumn {
    /// The name of its column.
    pub name: &'static str,
    /// The picture.
    pub picture: Displayed,
    /// Its difference from the supersampled picture.
    pub difference: Difference,
}

impl DrawnRow {
    /// Draws `columns` in `scene`, which shows them at the `distance`.
    pub fn new(
        options: &PictureOptions,
        scene: &Scene,
        distance: f64,
        columns: &Columns,
        advance: Advance<'_>,
    ) -> Self {
        let shader = options.shader(scene.f0);
        // Only the supersampled column reports progress, since it takes most of the time.
        let truth = supersampled(scene, &columns.plain, &shader, options.samples, advance);
        let tone = Tone::expose_for(&truth.picture, scene.key);
        // The halves of the samples differ by twice the expected error of their mean.
        let noise = relative_l1(&truth.half, &truth.picture);
        let truth = Displayed::new(truth.picture, &tone);
        let columns: Vec<DrawnColumn> = columns
            .filtered()
            .map(|Column { name, material }| {
                let picture = filtered(scene, material, &shader, options.filter, &|_| {});
                let picture = Displayed::new(picture, &tone);
                let difference = Difference::between(&picture, &truth);
                DrawnColumn { name, picture, difference }
            })
            .collect();
        let pictures: Vec<&Displayed> = columns.iter().map(|column| &column.picture).collect();
        let crop = Crop::most_different(&pictures, &truth);
        Self { distance, columns, truth, noise, crop }
    }

    /// Returns the pictures with what a sheet says of them.
    pub fn panels(&self) -> Vec<Shown<'_>> {
        let shown = |name: &str, picture, labels| {
            let heading = format!("{}, distance {}", title_of(name), self.distance);
            Shown { heading, picture, crop: Some(self.crop), labels }
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
