//! Draws an input in scenes, and writes the pictures.

use std::path::PathBuf;

use super::columns::{Column, Columns, columns, title_of};
use super::error::PictureError;
use super::folder::{Folder, Shown};
use super::gallery::page;
use super::report::{ColumnReport, PicturesReport, RENDER_FORMAT, RowReport, SheetReport};
use crate::lobe::Family;
use crate::readback::{Input, MapKind};
use crate::render::{
    Advance, Crop, Difference, EnvironmentFilter, Filter, Picture, Reflection, SceneName, Shader, Tone, filtered,
    highlight, relative_l1, supersampled,
};
use crate::settings::Settings;

/// What is drawn, and how.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    /// A .gltf or .glb file, or an image; `None` draws the waves.
    pub input: Option<PathBuf>,
    /// The folder of the pictures.
    pub output: PathBuf,
    /// The scenes; empty for plane and sphere, or for the scenes of the paper if there is no input.
    pub scenes: Vec<SceneName>,
    /// Distances from the eye to the surface, in repeats of the map; empty for distances that suit the scene.
    pub distances: Vec<f64>,
    /// The lobe that shades, and for which the columns are baked.
    pub reflection: Reflection,
    /// How texture filtering averages texels.
    pub filter: Filter,
    /// What filters the surroundings that a lobe reflects.
    pub environment: EnvironmentFilter,
    /// Width of a picture in pixels.
    pub width: u32,
    /// Samples per pixel of the supersampled column.
    pub samples: u32,
    /// Distance between heights 0 and 1, in widths of the map, if the input is an image of heights.
    pub height_scale: Option<f32>,
    /// Roughness of a standalone map or of the waves; `None` for the roughness that suits the scene.
    pub roughness: Option<f32>,
    /// Whether pictures are also written as OpenEXR.
    pub has_exr: bool,
    /// The settings of the bakes. The reflection decides on the family of lobes.
    pub settings: Settings,
}

impl PictureOptions {
    fn scenes(&self) -> &[SceneName] {
        match (self.scenes.as_slice(), &self.input) {
            ([], Some(_)) => &[SceneName::Plane, SceneName::Sphere],
            ([], None) => &[SceneName::Lake, SceneName::Pattern, SceneName::Highlight],
            (named, _) => named,
        }
    }

    fn shader(&self, f0: f64) -> Shader {
        Shader { reflection: self.reflection, filter: self.environment, f0 }
    }

    /// Returns the settings of the bakes. The paper takes its lobes for normal distributions.
    fn bake_settings(&self) -> Settings {
        self.settings.with_lobe(match self.reflection {
            Reflection::Ggx => Family::Ggx,
            Reflection::Beckmann | Reflection::BlinnPhong | Reflection::BlinnPhongPrinted => Family::Beckmann,
        })
    }
}

/// The share of the work that is bakes, as the bar of progress shows it.
const BAKES: f32 = 0.25;

/// Draws every material of the input in every scene, and writes the pictures and the page that shows them all.
/// `progress` receives the finished share of the work and the name of the material, from any thread.
///
/// # Errors
/// [`PictureError`] for the first file that cannot be read, baked or written.
pub fn draw_pictures(
    options: &PictureOptions,
    progress: &(dyn Fn(f32, &str) + Sync),
) -> Result<PicturesReport, PictureError> {
    let path = options.input.as_deref();
    let input = path.map_or_else(Input::waves, |path| Input::read(path, options.height_scale))?;
    let mut folder = Folder::new(&options.output, options.has_exr, input.guard(path));
    let scenes = options.scenes();
    let settings = options.bake_settings();
    let mut sheets = Vec::new();
    let mut baked: Option<(SceneName, Vec<Columns>)> = None;
    for (index, &scene) in scenes.iter().enumerate() {
        let progress = |share: f32, name: &str| progress((index as f32 + share) / scenes.len() as f32, name);
        if scene == SceneName::Highlight {
            sheets.push(draw_highlight(options.width, &mut folder)?);
            continue;
        }
        let reusable = baked.take().filter(|(earlier, _)| are_baked_alike(&input, options.roughness, *earlier, scene));
        let start = if reusable.is_some() { 0.0 } else { BAKES };
        let materials = match reusable {
            Some((_, materials)) => materials,
            None => input.with_source(scene, options.roughness, |source| {
                columns(source, &settings, &|share| progress(start * share, "bakes"))
            })?,
        };
        for (done, columns) in materials.iter().enumerate() {
            let advance = |share: f32| {
                let drawn = (done as f32 + share) / materials.len() as f32;
                progress(start + (1.0 - start) * drawn, &columns.name);
            };
            sheets.push(draw_material(options, scene, columns, &mut folder, &advance)?);
        }
        baked = Some((scene, materials));
    }
    let gallery = folder.write_text("index.html", page(&sheets, env!("CARGO_PKG_VERSION")))?;
    Ok(PicturesReport { format_version: RENDER_FORMAT, gallery, sheets })
}

/// Returns whether the materials of `input` are the same in two scenes.
fn are_baked_alike(input: &Input, roughness: Option<f32>, a: SceneName, b: SceneName) -> bool {
    let is_as_rough = roughness.is_some() || a.roughness() == b.roughness();
    match input {
        Input::Asset { .. } => true,
        Input::Map { kind: MapKind::Waves, .. } => is_as_rough && a.wave_height() == b.wave_height(),
        Input::Map { .. } => is_as_rough,
    }
}

/// Draws the paper's figure 14, which shows no material.
fn draw_highlight(width: u32, folder: &mut Folder<'_>) -> Result<SheetReport, PictureError> {
    const TITLE: &str = "Highlights of Phong and Blinn-Phong";
    let tone = Tone { exposure: 1.0 };
    let [phong, blinn_phong] = highlight(width);
    let mut panels = Vec::new();
    for (name, picture, heading) in
        [("phong", phong, "Phong, outline of Blinn-Phong"), ("blinn-phong", blinn_phong, "Blinn-Phong")]
    {
        folder.write_picture(&format!("{}.{name}", SceneName::Highlight.name()), &picture, &tone)?;
        panels.push(Shown { heading: heading.to_owned(), picture, crop: None, labels: Vec::new(), tone });
    }
    let path = folder.write_sheet(SceneName::Highlight.name(), TITLE, "", &[panels])?;
    Ok(SheetReport { path, title: TITLE.to_owned(), material: None, scene: SceneName::Highlight, rows: Vec::new() })
}

/// Draws one material in one scene.
fn draw_material(
    options: &PictureOptions,
    scene: SceneName,
    columns: &Columns,
    folder: &mut Folder<'_>,
    advance: Advance<'_>,
) -> Result<SheetReport, PictureError> {
    let distances = if options.distances.is_empty() { scene.distances() } else { options.distances.as_slice() };
    let stem = format!("{}.{}", columns.name, scene.name());
    let mut rows = Vec::new();
    let mut sheet = Vec::new();
    for (done, &distance) in distances.iter().enumerate() {
        let advance = |share: f32| advance((done as f32 + share) / distances.len() as f32);
        if let Some((row, panels)) = draw_row(options, scene, distance, columns, (folder, &stem), &advance)? {
            rows.push(row);
            sheet.push(panels);
        }
    }
    let title = format!("{}, {}", columns.title, scene.name());
    let subtitle = "Below each picture its framed region, enlarged 4 times. Error: relative L1 of radiance.";
    let path = folder.write_sheet(&stem, &title, subtitle, &sheet)?;
    Ok(SheetReport { path, title, material: Some(columns.name.clone()), scene, rows })
}

/// Draws a material at one distance. Returns `None` if the scene shows no material.
fn draw_row(
    options: &PictureOptions,
    scene: SceneName,
    distance: f64,
    columns: &Columns,
    (folder, stem): (&mut Folder<'_>, &str),
    advance: Advance<'_>,
) -> Result<Option<(RowReport, Vec<Shown>)>, PictureError> {
    let Some(scene) = scene.scene(options.width, distance) else { return Ok(None) };
    let shader = options.shader(scene.f0);
    // Filtered columns take little time beside the supersampled column.
    let truth = supersampled(&scene, &columns.plain, &shader, options.samples, advance);
    let tone = Tone::expose_for(&truth.picture, scene.key);
    // The halves of the samples differ by twice the expected error of their mean.
    let noise = relative_l1(&truth.half, &truth.picture);
    let truth = truth.picture;
    let pictures: Vec<(&'static str, Picture)> = columns
        .filtered()
        .map(|Column { name, material }| (name, filtered(&scene, material, &shader, options.filter, &|_| {})))
        .collect();
    let crop = Crop::most_different(&pictures.iter().map(|(_, picture)| picture).collect::<Vec<_>>(), &truth, &tone);
    let shown = |name: &str, picture: Picture, labels: Vec<String>| {
        let heading = format!("{}, distance {distance}", title_of(name));
        Shown { heading, picture, crop: Some(crop), labels, tone }
    };
    let stem = format!("{stem}.d{distance}");
    let mut reports = Vec::new();
    let mut panels = Vec::new();
    for (name, picture) in pictures {
        let path = folder.write_picture(&format!("{stem}.{name}"), &picture, &tone)?;
        let difference = Difference::between(&picture, &truth, &tone);
        let labels = vec![
            format!("error {:.3} (lower is better)", difference.relative_l1),
            format!("SSIM {:.3} (higher is better)", difference.ssim),
        ];
        reports.push(ColumnReport { name, path, difference });
        panels.push(shown(name, picture, labels));
    }
    let supersampled = folder.write_picture(&format!("{stem}.supersampled"), &truth, &tone)?;
    let size = truth.size;
    panels.push(shown("supersampled", truth, vec![format!("noise {noise:.3}")]));
    Ok(Some((RowReport { distance, columns: reports, supersampled, noise, size, crop }, panels)))
}
