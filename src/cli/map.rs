//! `roughcast map`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::ValueEnum;

use super::options::texture::{TextureOptions, finite, unit_interval};
use super::terminal::outcome::Outcome;
use crate::api::BumpTexels;
use crate::bump::NormalLayout;
use crate::lobe::Family;
use crate::mip::Wrap;
use crate::report::MapReport;
use crate::standalone::{MapFileError, MapOptions, WrittenMap, bake_map_file};
use crate::text::printable;

/// Bake one standalone normal or height map into KTX2 files.
///
/// OUT is the bump map: normals, or offsets with --profile pyramid. Its other textures are written beside OUT, as
/// OUT.roughness.ktx2 and so on. The roughness of lost bumps is added to the roughness of the surface, which
/// --roughness-factor or --roughness gives.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  roughcast map wool_normal.png -o wool.ktx2 --roughness wool_rough.png\n  \
    roughcast map wool_depth.png -o wool.ktx2 --height --height-scale 0.02 --profile pyramid")]
pub struct Args {
    /// PNG, JPEG, EXR, TIFF, TGA, HDR, WebP or KTX2.
    image: PathBuf,
    /// The KTX2 file to write, with the extension .ktx2.
    #[arg(short, long, value_name = "OUT.ktx2")]
    output: PathBuf,
    /// The image holds heights, not normals.
    #[arg(long)]
    height: bool,
    /// Distance between heights 0 and 1, in widths of the map.
    #[arg(long, value_parser = finite, default_value_t = 0.05, value_name = "S", allow_hyphen_values = true)]
    height_scale: f32,
    /// How a height map continues beyond its border, across and down: one mode, or two with a comma.
    #[arg(long, value_parser = wrap_modes, default_value = "repeat", value_name = "MODE")]
    wrap: [Wrap; 2],
    /// The channels that hold the normal; auto takes two where the third is missing or empty.
    #[arg(long, value_enum, default_value_t = NormalLayout::Auto)]
    channels: NormalLayout,
    /// Green points down the image (DirectX convention).
    #[arg(long)]
    green_down: bool,
    /// EXR: the layer, or the channel as layer.channel.
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// The roughness map of the base lobe (green channel, or grey), which is roughened by the lost bumps. Without this
    /// option and --roughness-factor, the profile portable has normals only.
    #[arg(long, value_parser = roughness_map, value_name = "IMAGE")]
    roughness: Option<PathBuf>,
    /// The roughness of the base lobe, 0 to 1, as a number; multiplies --roughness.
    #[arg(long, value_parser = unit_interval, allow_negative_numbers = true, value_name = "R")]
    roughness_factor: Option<f32>,
    /// Print what was written as JSON.
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    /// Print all notes, not only those that ask for something.
    #[arg(short, long, conflicts_with_all = ["quiet", "json"])]
    verbose: bool,
    /// The lobe that the engine shades with.
    #[arg(long, value_enum, default_value_t = Family::Ggx)]
    lobe: Family,
    #[command(flatten)]
    texture: TextureOptions,
}

/// Bakes the map and prints what was written.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let options = args.options();
    if let Err(reason) = options.settings.target.check_available() {
        writeln!(err, "error: {reason}")?;
        return Ok(Outcome::Usage);
    }
    match bake_map_file(&options) {
        Err(error) => {
            writeln!(err, "error: {error}")?;
            Ok(if matches!(error, MapFileError::NotKtx2 { .. }) { Outcome::Usage } else { Outcome::Failed })
        }
        Ok(WrittenMap { report, .. }) => {
            if args.json {
                writeln!(out, "{}", serde_json::to_string_pretty(&report).map_err(io::Error::other)?)?;
            } else if !args.quiet {
                write!(out, "{}", summary(&report, args.verbose))?;
            }
            Ok(Outcome::Done)
        }
    }
}

impl Args {
    fn options(&self) -> MapOptions {
        MapOptions {
            image: self.image.clone(),
            texels: if self.height {
                BumpTexels::Heights { scale: self.height_scale, wrap: self.wrap }
            } else {
                BumpTexels::Normals { layout: self.channels, is_green_down: self.green_down }
            },
            layer: self.layer.clone(),
            roughness: self.roughness.clone(),
            roughness_factor: self.roughness_factor,
            output: self.output.clone(),
            settings: self.texture.settings().with_lobe(self.lobe),
        }
    }
}

/// Returns a line for each file, the model, and the notes. Without `is_verbose`, notes that ask for nothing are left
/// out.
fn summary(report: &MapReport, is_verbose: bool) -> String {
    let mut text = String::new();
    for texture in &report.textures {
        text += &format!(
            "{}: {}, {} x {}, {} levels, {:.1} kB\n",
            printable(&texture.path),
            texture.content.name(),
            texture.width,
            texture.height,
            texture.levels,
            texture.bytes as f64 / 1e3
        );
    }
    if let Some(choice) = &report.choice {
        text += &format!("model {}{}\n", report.model.name(), choice.summary());
    }
    for note in report.notes.iter().filter(|note| is_verbose || note.asks_for_action) {
        text += &format!("note: {}\n", printable(&note.text));
    }
    text
}

/// Takes the path of an image. `compare` and `render` have an option of the same name for a number.
fn roughness_map(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match text.parse::<f32>() {
        Ok(_) if !path.exists() => {
            Err(format!("expected an image, found a number; for one roughness, use --roughness-factor {text}"))
        }
        _ => Ok(path),
    }
}

fn wrap_modes(text: &str) -> Result<[Wrap; 2], String> {
    let mode = |name: &str| {
        let name = name.trim();
        Wrap::from_str(name, false).map_err(|_| format!("expected repeat, mirror or clamp, found {name:?}"))
    };
    match text.split_once(',') {
        None => mode(text).map(|m| [m; 2]),
        Some((across, down)) => Ok([mode(across)?, mode(down)?]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::FileFormat;

    #[test]
    fn the_help_names_every_image_format() {
        let command = <Args as clap::Args>::augment_args(clap::Command::new("map"));
        let image = command.get_arguments().find(|argument| argument.get_id() == "image").expect("the argument IMAGE");
        let help = image.get_help().expect("a help text").to_string();
        for name in FileFormat::short_names() {
            assert!(help.contains(name), "{name} is missing in: {help}");
        }
    }
}
