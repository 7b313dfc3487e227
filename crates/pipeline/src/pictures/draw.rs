//! Draws an input in scenes, and writes the pictures.

use std::path::PathBuf;

use super::columns::{Column, Columns, columns};
use super::error::PictureError;
use super::folder::{Folder, Shown};
use super::report::{ColumnReport, PicturesReport, RowReport, SheetReport};
use crate::lobe::Family;
use crate::readback::Input;
use crate::render::{
    Advance, Difference, EnvironmentFilter, Filter, Reflection, SceneName, Shader, Tone, filtered, highlight,
    relative_l1, supersampled,
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

/// Draws every material of the input in every scene, and writes the pictures. `progress` receives the finished share of
/// the work and the name of the material, from any thread.
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
    let mut sheets = Vec::new();
    for (index, &scene) in scenes.iter().enumerate() {
        if scene == SceneName::Highlight {
            sheets.push(draw_highlight(options.width, &mut folder)?);
            continue;
        }
        let settings = options.bake_settings();
        let materials = input.with_source(scene, options.roughness, |source| columns(source, &settings))?;
        for (done, columns) in materials.iter().enumerate() {
            let advance = |share: f32| {
                let share_of_scene = (done as f32 + share) / materials.len() as f32;
                progress((index as f32 + share_of_scene) / scenes.len() as f32, &columns.name);
            };
            sheets.push(draw_material(options, scene, columns, &mut folder, &advance)?);
        }
    }
    Ok(PicturesReport::new(sheets))
}

/// Draws the paper's figure 14, which shows no material.
fn draw_highlight(width: u32, folder: &mut Folder<'_>) -> Result<SheetReport, PictureError> {
    let [phong, blinn_phong] = highlight(width);
    let shown = |name, picture, label: &str| Shown {
        name,
        picture,
        labels: vec![label.to_owned()],
        tone: Tone { exposure: 1.0 },
    };
    let panels =
        vec![shown("phong", phong, "Phong, outline of Blinn-Phong"), shown("blinn-phong", blinn_phong, "Blinn-Phong")];
    let path = folder.write(SceneName::Highlight.name(), &[(None, panels)])?;
    Ok(SheetReport { path, material: None, scene: SceneName::Highlight, rows: Vec::new() })
}

/// Draws one material in one scene.
fn draw_material(
    options: &PictureOptions,
    scene_name: SceneName,
    columns: &Columns,
    folder: &mut Folder<'_>,
    advance: Advance<'_>,
) -> Result<SheetReport, PictureError> {
    let distances = if options.distances.is_empty() { scene_name.distances() } else { options.distances.as_slice() };
    let mut rows = Vec::new();
    let mut shown = Vec::new();
    for (done, &distance) in distances.iter().enumerate() {
        let Some(scene) = scene_name.scene(options.width, distance) else { continue };
        let shader = options.shader(scene.f0);
        // Filtered columns take little time beside the supersampled column.
        let advance = |share: f32| advance((done as f32 + share) / distances.len() as f32);
        let truth = supersampled(&scene, &columns.plain, &shader, options.samples, &advance);
        let tone = Tone::expose_for(&truth.picture, scene.key);
        let mut row = RowReport {
            distance,
            columns: Vec::new(),
            // The halves of the samples differ by twice the expected error of their mean.
            noise: relative_l1(&truth.half, &truth.picture),
        };
        let mut panels = Vec::new();
        for Column { name, material } in columns.filtered() {
            let picture = filtered(&scene, material, &shader, options.filter, &|_| {});
            let difference = Difference::between(&picture, &truth.picture, &tone);
            let label = format!("L1 {:.3}  SSIM {:.3}", difference.relative_l1, difference.ssim);
            panels.push(Shown { name, picture, labels: vec![name.to_owned(), label], tone });
            row.columns.push(ColumnReport { name, difference });
        }
        let labels = vec!["supersampled".to_owned(), format!("noise {:.3}", row.noise)];
        panels.push(Shown { name: "supersampled", picture: truth.picture, labels, tone });
        rows.push(row);
        shown.push((Some(distance), panels));
    }
    let path = folder.write(&format!("{}.{}", columns.name, scene_name.name()), &shown)?;
    Ok(SheetReport { path, material: Some(columns.name.clone()), scene: scene_name, rows })
}
