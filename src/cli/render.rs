//! `roughcast render`.

use std::io::{self, Write};
use std::path::PathBuf;

use super::options::texture::{TextureOptions, finite, unit_interval};
use super::terminal::outcome::Outcome;
use super::terminal::progress::ProgressLine;
use crate::pictures::{ColumnReport, PictureOptions, RowReport, SheetReport, draw_pictures};
use crate::render::{EnvironmentFilter, Filter, Reflection, SceneName};
use crate::run::Progress;
use crate::text::printable;

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
    /// Output folder: a sheet of all columns for each scene, each picture alone, and index.html, which shows them all.
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
    #[arg(long, value_enum, default_value_t = EnvironmentFilter::Facets)]
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

/// Draws the scenes and prints their errors.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    if let Err(reason) = args.texture.settings().target.check_available() {
        writeln!(err, "error: {reason}")?;
        return Ok(Outcome::Usage);
    }
    let progress = ProgressLine::new(1, args.quiet);
    let drawn = draw_pictures(&args.options(), &|share, name| progress.advance(0, share, name));
    progress.finish();
    match drawn {
        Err(error) => {
            let file = args.input.as_ref().map_or(String::new(), |path| format!("{}: ", path.display()));
            writeln!(err, "error: {file}{error}")?;
            Ok(Outcome::Failed)
        }
        Ok(report) => {
            if args.json {
                writeln!(out, "{}", serde_json::to_string_pretty(&report).map_err(io::Error::other)?)?;
            } else if !args.quiet {
                report.sheets.iter().try_for_each(|sheet| out.write_all(summary(sheet).as_bytes()))?;
                writeln!(out, "{}", printable(&report.gallery))?;
            }
            Ok(Outcome::Done)
        }
    }
}

impl Args {
    fn options(&self) -> PictureOptions {
        PictureOptions {
            input: self.input.clone(),
            output: self.output.clone(),
            scenes: self.scene.clone(),
            distances: self.distance.clone(),
            reflection: self.lobe,
            filter: self.filter,
            environment: self.environment,
            width: self.width,
            samples: self.samples,
            height_scale: self.height.then_some(self.height_scale),
            roughness: self.roughness,
            has_exr: self.exr,
            settings: self.texture.settings(),
        }
    }
}

fn summary(sheet: &SheetReport) -> String {
    let mut text = format!("{}\n", printable(&sheet.path));
    for RowReport { distance, columns, noise, .. } in &sheet.rows {
        for ColumnReport { name, difference, .. } in columns {
            text += &format!(
                "  distance {distance}, {name:<8}  relative L1 {:.3} (lower is better)  SSIM {:.3} (higher is better)\n",
                difference.relative_l1, difference.ssim
            );
        }
        text += &format!("  distance {distance}, noise of the supersampled column: relative L1 {noise:.3}\n");
    }
    text
}

/// Parses a distance at which the map is in the picture.
fn distance(text: &str) -> Result<f64, String> {
    let number = f64::from(finite(text)?);
    if (1e-3..=1e4).contains(&number) { Ok(number) } else { Err(format!("expected 0.001 to 10000, found {number}")) }
}
