//! `roughcast render`.

pub(super) mod columns;
mod error;
pub(super) mod input;
mod output;

use std::io::{self, Write};
use std::path::PathBuf;

use clap::ValueEnum;
use serde::Serialize;

use super::options::{TextureOptions, finite, unit_interval};
use super::progress::ProgressLine;
use crate::cli::outcome::Outcome;
use crate::lobe::Family;
use crate::render::{
    Difference, EnvironmentFilter, Filter, Reflection, Shader, Subject, Tone, filtered, highlight, relative_l1,
    supersampled,
};
use crate::run::Progress;

use crate::text::printable;
use columns::{Column, Columns};
pub(super) use error::RenderError;
use input::Input;
use output::{Folder, Shown};

/// Draw a material before and after the bake beside the reference, and print the error of each picture.
///
/// Columns: plain (renormalised normal mips), portable and pyramid (the baked files, decoded as an engine decodes them)
/// and supersampled (many samples per pixel of the unfiltered map). Without INPUT, the scenes of the paper with waves.
/// Errors are the relative L1 of radiance, 0 being equal, and the structural similarity of what is displayed, 1 being
/// equal.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  roughcast render -o pictures --scene lake,highlight\n  \
    roughcast render wool_normal.png -o pictures --scene sphere --distance 1,8 --roughness 0.25\n  \
    roughcast render helmet.gltf -o pictures --lobe beckmann")]
#[command(mut_arg("profile", |profile| profile.default_value("both").help("Which baked columns to draw")))]
pub struct Args {
    /// .gltf or .glb, whose materials are drawn, or a standalone normal or height map.
    input: Option<PathBuf>,
    /// Output folder: a sheet of all columns for each scene, and each picture alone.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// What to draw. [default: plane,sphere for an input, else lake,pattern,highlight]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "SCENE")]
    scene: Vec<SceneName>,
    /// Distances from the eye to the surface, in repeats of the map; a row for each. [default: depends on the scene]
    #[arg(long, value_parser = distance, allow_negative_numbers = true, value_delimiter = ',', value_name = "D")]
    distance: Vec<f64>,
    /// The lobe that shades, and for which the columns are baked.
    #[arg(long, value_enum, default_value_t = Reflection::Ggx)]
    lobe: Reflection,
    /// How texture filtering averages texels.
    #[arg(long, value_enum, default_value_t = Filter::Anisotropic)]
    filter: Filter,
    /// What filters the surroundings that a lobe reflects.
    #[arg(long, value_enum, default_value_t = EnvironmentFilter::Ellipse)]
    environment: EnvironmentFilter,
    /// Width of a picture in pixels.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(8..=4096), value_name = "PX")]
    width: u32,
    /// Samples per pixel of the supersampled column.
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(2..=1 << 20), value_name = "N")]
    samples: u32,
    /// INPUT is an image of heights, not of normals.
    #[arg(long)]
    height: bool,
    /// Distance between heights 0 and 1, in widths of the map.
    #[arg(long, value_parser = finite, default_value_t = 0.05, value_name = "S", allow_hyphen_values = true)]
    height_scale: f32,
    /// Roughness of a standalone map or of the waves, 0 to 1. [default: depends on the scene]
    #[arg(long, value_parser = unit_interval, allow_negative_numbers = true, value_name = "R")]
    roughness: Option<f32>,
    /// Also write linear radiance as OpenEXR.
    #[arg(long)]
    exr: bool,
    /// Print what was written and the errors as JSON.
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    #[command(flatten)]
    texture: TextureOptions,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum SceneName {
    /// The moon over a lake: the paper's figures 8 and 9
    Lake,
    /// A pattern mirrored by a bumpy plane: the paper's figures 10 and 11
    Pattern,
    /// Phong against Blinn-Phong on a plane: the paper's figure 14
    Highlight,
    /// A plane in perspective, a point light and a room
    Plane,
    /// A sphere, a point light and a room
    Sphere,
}

/// Returns the family of lobes to bake for. The paper takes its lobes for normal distributions.
fn family(reflection: Reflection) -> Family {
    match reflection {
        Reflection::Ggx => Family::Ggx,
        Reflection::Beckmann | Reflection::BlinnPhong | Reflection::BlinnPhongPrinted => Family::Beckmann,
    }
}

impl Args {
    fn shader(&self, f0: f64) -> Shader {
        Shader { reflection: self.lobe, filter: self.environment, f0 }
    }

    fn scenes(&self) -> Vec<SceneName> {
        match (self.scene.as_slice(), &self.input) {
            ([], Some(_)) => vec![SceneName::Plane, SceneName::Sphere],
            ([], None) => vec![SceneName::Lake, SceneName::Pattern, SceneName::Highlight],
            (named, _) => named.to_vec(),
        }
    }
}

/// A sheet that was written.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct SheetReport {
    path: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    material: Option<String>,
    scene: &'static str,
    rows: Vec<Row>,
}

/// One distance.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Row {
    distance: f64,
    columns: Vec<Scored>,
    /// Expected relative L1 of the supersampled column against a column with infinitely many samples.
    noise: f64,
}

#[derive(Debug, Serialize)]
struct Scored {
    name: &'static str,
    #[serde(flatten)]
    difference: Difference,
}

/// Draws the scenes and prints their errors.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    if let Err(reason) = args.texture.settings().target.check_available() {
        writeln!(err, "error: {reason}")?;
        return Ok(Outcome::Usage);
    }
    match draw_all(args) {
        Err(error) => {
            let file = args.input.as_ref().map_or(String::new(), |path| format!("{}: ", path.display()));
            writeln!(err, "error: {file}{error}")?;
            Ok(Outcome::Failed)
        }
        Ok(sheets) => {
            if args.json {
                writeln!(out, "{}", serde_json::to_string_pretty(&sheets).map_err(io::Error::other)?)?;
            } else if !args.quiet {
                sheets.iter().try_for_each(|sheet| out.write_all(summary(sheet).as_bytes()))?;
            }
            Ok(Outcome::Done)
        }
    }
}

fn summary(sheet: &SheetReport) -> String {
    let mut text = format!("{}\n", printable(&sheet.path));
    for Row { distance, columns, noise } in &sheet.rows {
        for Scored { name, difference } in columns {
            text += &format!(
                "  distance {distance}, {name:<8}  relative L1 {:.3}  SSIM {:.3}\n",
                difference.relative_l1, difference.ssim
            );
        }
        text += &format!("  distance {distance}, noise of the supersampled column: relative L1 {noise:.3}\n");
    }
    text
}

fn draw_all(args: &Args) -> Result<Vec<SheetReport>, RenderError> {
    let input = Input::read(args.input.as_deref(), args.height.then_some(args.height_scale))?;
    let mut folder = Folder::new(&args.output, args.exr, input.guard(args.input.as_deref()));
    let scenes = args.scenes();
    let progress = ProgressLine::new(scenes.len(), args.quiet);
    let mut sheets = Vec::new();
    for (index, scene) in scenes.into_iter().enumerate() {
        let subject = match scene {
            SceneName::Lake => Subject::Lake,
            SceneName::Pattern => Subject::Pattern,
            SceneName::Plane => Subject::Plane,
            SceneName::Sphere => Subject::Sphere,
            SceneName::Highlight => {
                let [phong, blinn_phong] = highlight(args.width);
                let shown = |name, picture, label: &str| Shown {
                    name,
                    picture,
                    labels: vec![label.to_owned()],
                    tone: Tone { exposure: 1.0 },
                };
                let panels = vec![
                    shown("phong", phong, "Phong, outline of Blinn-Phong"),
                    shown("blinn-phong", blinn_phong, "Blinn-Phong"),
                ];
                let path = folder.write("highlight", &[(None, panels)])?;
                sheets.push(SheetReport { path, material: None, scene: "highlight", rows: Vec::new() });
                continue;
            }
        };
        let settings = args.texture.settings().with_family(family(args.lobe));
        let materials = input.columns(&settings, subject, args.roughness)?;
        for (done, columns) in materials.iter().enumerate() {
            let advance = |share: f32| {
                progress.advance(index, (done as f32 + share) / materials.len() as f32, &columns.name);
            };
            sheets.push(draw(args, subject, columns, &mut folder, &advance)?);
        }
    }
    progress.finish();
    Ok(sheets)
}

/// Draws one material in one scene.
fn draw(
    args: &Args,
    subject: Subject,
    columns: &Columns,
    folder: &mut Folder<'_>,
    advance: &(dyn Fn(f32) + Sync),
) -> Result<SheetReport, RenderError> {
    let distances = if args.distance.is_empty() { subject.distances() } else { args.distance.as_slice() };
    let mut rows = Vec::new();
    let mut shown = Vec::new();
    for (done, &distance) in distances.iter().enumerate() {
        let scene = subject.scene(args.width, distance);
        let shader = args.shader(scene.f0);
        // Filtered columns take little time beside the supersampled column.
        let advance = |share: f32| advance((done as f32 + share) / distances.len() as f32);
        let truth = supersampled(&scene, &columns.plain, &shader, args.samples, &advance);
        let tone = Tone::expose_for(&truth.picture, scene.key);
        let mut row = Row {
            distance,
            columns: Vec::new(),
            // The halves of the samples differ by twice the expected error of their mean.
            noise: relative_l1(&truth.half, &truth.picture),
        };
        let mut panels = Vec::new();
        for Column { name, material } in columns.filtered() {
            let picture = filtered(&scene, material, &shader, args.filter, &|_| {});
            let difference = Difference::between(&picture, &truth.picture, &tone);
            let label = format!("L1 {:.3}  SSIM {:.3}", difference.relative_l1, difference.ssim);
            panels.push(Shown { name, picture, labels: vec![name.to_owned(), label], tone });
            row.columns.push(Scored { name, difference });
        }
        let labels = vec!["supersampled".to_owned(), format!("noise {:.3}", row.noise)];
        panels.push(Shown { name: "supersampled", picture: truth.picture, labels, tone });
        rows.push(row);
        shown.push((Some(distance), panels));
    }
    let path = folder.write(&format!("{}.{}", columns.name, subject.name()), &shown)?;
    Ok(SheetReport { path, material: Some(columns.name.clone()), scene: subject.name(), rows })
}

/// Parses a distance at which the map is in the picture.
fn distance(text: &str) -> Result<f64, String> {
    let number = f64::from(finite(text)?);
    if (1e-3..=1e4).contains(&number) { Ok(number) } else { Err(format!("expected 0.001 to 10000, found {number}")) }
}
