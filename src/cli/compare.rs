//! `roughcast compare`.

use std::io::{self, Write};
use std::path::PathBuf;

use super::options::texture::{effort, finite, unit_interval};
use super::terminal::outcome::Outcome;
use super::terminal::progress::ProgressLine;
use crate::codec::uastc::Effort;
use crate::compare::{CompareOptions, Comparison, FailedInput, MAX_PICTURE_WIDTH, compare_files};
use crate::run::Progress;
use crate::settings::Settings;
use crate::text::printable;

/// Chart lobe and picture error against cost: every model, every peer and the best single lobe, on your own material.
///
/// Writes compare.html (everything), compare-MATERIAL.svg, compare.csv and compare.json. Errors: lower is better. All
/// values except the bake times are equal in every run.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  roughcast compare helmet.glb -o charts\n  \
    roughcast compare wool_normal.png sand_normal.png -o charts --roughness 0.3 --max-error 0.02")]
pub struct Args {
    /// .gltf or .glb files, whose materials are charted, or standalone normal or height maps.
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Output folder.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Texels of each mip level that are measured: more texels take longer and give more exact errors.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=4096), value_name = "N")]
    texels: u16,
    /// The inputs are images of heights, not of normals.
    #[arg(long)]
    height: bool,
    /// Distance between heights 0 and 1, in widths of the map.
    #[arg(long, value_parser = finite, default_value_t = 0.05, value_name = "S", allow_hyphen_values = true)]
    height_scale: f32,
    /// Roughness of a standalone map, 0 to 1.
    #[arg(long, value_parser = unit_interval, allow_negative_numbers = true, default_value_t = 0.3, value_name = "R")]
    roughness: f32,
    /// The error bound by which --model auto chooses the marked model.
    #[arg(long, default_value_t = Settings::default().max_error, value_parser = unit_interval, value_name = "E",
        allow_negative_numbers = true)]
    max_error: f32,
    /// The quality of the bake that is marked.
    #[arg(long, value_parser = effort(), default_value = "fast", value_name = "QUALITY")]
    quality: Effort,
    /// Width in pixels of the spheres that are drawn for the picture errors; 0 draws none. Most of their time is the
    /// truth, 512 samples per pixel.
    #[arg(long, default_value_t = 96, value_parser = picture_width, value_name = "PX")]
    picture_width: u32,
    /// Largest number of texels of an input image.
    #[arg(long, default_value_t = 1 << 28, value_name = "N")]
    max_texels: u64,
    /// Print the numbers as JSON.
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
}

/// Charts the materials and prints the results.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let progress = ProgressLine::new(1, args.quiet);
    let charts = compare_files(&args.options(), &|share, name| progress.advance(0, share, name));
    progress.finish();
    match charts {
        Err(FailedInput { input, error }) => {
            writeln!(err, "error: {}: {error}", input.display())?;
            Ok(Outcome::Failed)
        }
        Ok(charts) => {
            if args.json {
                writeln!(out, "{}", charts.report.to_json())?;
            } else if !args.quiet {
                charts.files.iter().try_for_each(|path| writeln!(out, "{}", printable(&path.display().to_string())))?;
                let mut comparisons = charts.report.materials.iter();
                comparisons.try_for_each(|comparison| out.write_all(summary(comparison).as_bytes()))?;
            }
            Ok(Outcome::Done)
        }
    }
}

impl Args {
    fn options(&self) -> CompareOptions {
        CompareOptions {
            inputs: self.inputs.clone(),
            output: self.output.clone(),
            texels: self.texels.into(),
            height_scale: self.height.then_some(self.height_scale),
            roughness: self.roughness,
            max_error: self.max_error,
            quality: self.quality,
            picture_width: self.picture_width,
            max_texels: self.max_texels,
        }
    }
}

fn summary(comparison: &Comparison) -> String {
    let mut text = format!("{}\n", printable(&comparison.material));
    text.extend(comparison.verdict.iter().map(|verdict| format!("  {verdict}\n")));
    for entry in &comparison.entries {
        let chosen = if entry.chosen { "  chosen" } else { "" };
        let picture = entry.picture_error.map_or(String::new(), |error| format!("  picture {error:.3}"));
        text += &format!("  {:<23} lobe {:.3}{picture}{chosen}\n", entry.name, entry.error);
    }
    text
}

/// Parses the width of pictures, or 0 for none. Pictures of fewer than 8 pixels show nothing.
fn picture_width(text: &str) -> Result<u32, String> {
    let is_possible = |width: &u32| *width == 0 || (8..=MAX_PICTURE_WIDTH).contains(width);
    let width = text.parse().ok().filter(is_possible);
    width.ok_or_else(|| format!("expected 0 or 8 to {MAX_PICTURE_WIDTH}, found {text:?}"))
}
