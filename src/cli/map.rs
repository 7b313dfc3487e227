//! `roughcast map`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::json;

use super::notes::asks_for_action;
use super::options::{TextureOptions, finite, unit_interval};
use super::outcome::Outcome;
use crate::bake::{BakeError, BakedMap, BakedTexture, BaseRoughness, bake_map, output_stem_of};
use crate::bump::{HeightMap, NormalLayout, NormalMap};
use crate::decode::{DecodeError, decode, decode_colours};
use crate::digest::digest;
use crate::image::{DecodeOptions, Image, MapError};
use crate::input_file::read_file;
use crate::ktx2::{Key, Provenance, SourceDigest};
use crate::lobe::Family;
use crate::material::{BumpMap, notes};
use crate::mip::Wrap;
use crate::output::{Guard, PublishError};
use crate::report::Content;
use crate::settings::Settings;
use crate::text::printable;

/// Bake one standalone normal or height map into KTX2 files.
///
/// OUT is the bump map: normals, or offsets with --profile pyramid. Its other textures are written beside OUT, as
/// OUT.roughness.ktx2 and so on.
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
    /// The roughness map of the base lobe (green channel, or grey), which is roughened by the lost bumps.
    #[arg(long, value_name = "IMAGE")]
    roughness: Option<PathBuf>,
    /// The roughness of the base lobe, 0 to 1; multiplies --roughness.
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

/// Why the map is not baked.
#[derive(Debug, thiserror::Error)]
enum MapCommandError {
    #[error("{}: expected a readable file, found: {error}; check the path", path.display())]
    Read { path: PathBuf, error: io::Error },
    #[error("{}: {error}", path.display())]
    Decode { path: PathBuf, error: DecodeError },
    #[error("{}: {error}", path.display())]
    Map { path: PathBuf, error: MapError },
    #[error(transparent)]
    Bake(#[from] BakeError),
    #[error(transparent)]
    Publish(#[from] PublishError),
    #[error(
        "-o {}: expected the name of a .ktx2 file, found another extension; name it {}",
        path.display(), path.with_extension("ktx2").display()
    )]
    NotKtx2 { path: PathBuf },
}

/// Bakes the map and prints what was written.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let settings = args.texture.settings().with_family(args.lobe);
    if let Err(reason) = settings.target.check_available() {
        writeln!(err, "error: {reason}")?;
        return Ok(Outcome::Usage);
    }
    match bake(args, &settings) {
        Err(error) => {
            writeln!(err, "error: {error}")?;
            Ok(if matches!(error, MapCommandError::NotKtx2 { .. }) { Outcome::Usage } else { Outcome::Failed })
        }
        Ok(written) => {
            if args.json {
                writeln!(out, "{}", serde_json::to_string_pretty(&written.json()).map_err(io::Error::other)?)?;
            } else if !args.quiet {
                write!(out, "{}", written.summary(args.verbose))?;
            }
            Ok(Outcome::Done)
        }
    }
}

struct Written {
    baked: BakedMap,
    files: Vec<(PathBuf, u64)>,
}

impl Written {
    fn json(&self) -> serde_json::Value {
        let textures = self.baked.textures.iter().zip(&self.files).map(|(texture, (path, bytes))| {
            json!({
                "path": path.display().to_string(),
                "content": texture.content,
                "width": texture.mip_chain.width,
                "height": texture.mip_chain.height,
                "levels": texture.mip_chain.level_count(),
                "bytes": bytes,
                "range": texture.range,
            })
        });
        json!({
            "model": self.baked.model,
            "choice": self.baked.choice,
            "notes": self.baked.notes,
            "textures": textures.collect::<Vec<_>>(),
        })
    }

    /// Returns a line for each file, the model, and the notes. Without `is_verbose`, notes that ask for nothing are
    /// left out.
    fn summary(&self, is_verbose: bool) -> String {
        let mut text = String::new();
        for (texture, (path, bytes)) in self.baked.textures.iter().zip(&self.files) {
            let mip_chain = &texture.mip_chain;
            text += &format!(
                "{}: {}, {} x {}, {} levels, {:.1} kB\n",
                printable(&path.display().to_string()),
                texture.content.name(),
                mip_chain.width,
                mip_chain.height,
                mip_chain.level_count(),
                *bytes as f64 / 1e3
            );
        }
        if let Some(choice) = &self.baked.choice {
            text += &format!("model {}{}\n", self.baked.model.name(), choice.summary());
        }
        let is_shown = |note: &&String| is_verbose || asks_for_action(note, self.baked.choice.as_ref());
        for note in self.baked.notes.iter().filter(is_shown) {
            text += &format!("note: {}\n", printable(note));
        }
        text
    }
}

fn bake(args: &Args, settings: &Settings) -> Result<Written, MapCommandError> {
    let mut guard = Guard::default();
    [Some(&args.image), args.roughness.as_ref()].into_iter().flatten().for_each(|input| guard.add_source(input));
    let first = guard.reserve_file(&args.output)?;
    if !args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("ktx2")) {
        return Err(MapCommandError::NotKtx2 { path: args.output.clone() });
    }
    let bytes = read(&args.image)?;
    let image = decoded(&args.image, &bytes, args.layer.clone(), settings, decode)?;
    let mut sources = vec![source_digest(&args.image, &bytes)];
    let is_jpeg = notes::is_jpeg(&bytes);
    drop(bytes);
    let failed = |error| MapCommandError::Map { path: args.image.clone(), error };
    let bump_map = if args.height {
        let slope = args.height_scale * image.width as f32;
        BumpMap::Heights { map: HeightMap::new(image).map_err(failed)?, slope_per_step: [slope; 2], wrap: args.wrap }
    } else {
        BumpMap::Normals(NormalMap::new(image, args.channels, args.green_down).map_err(failed)?)
    };
    let base = match (&args.roughness, args.roughness_factor) {
        (None, None) => None,
        (image, factor) => {
            let mut load = |path: &PathBuf| {
                let bytes = read(path)?;
                let image = decoded(path, &bytes, None, settings, decode_colours)?;
                let failed = |error| MapCommandError::Map { path: path.clone(), error };
                let image = image.into_finite_colours().map_err(failed)?;
                sources.push(source_digest(path, &bytes));
                Ok::<_, MapCommandError>(image)
            };
            Some(BaseRoughness { image: image.as_ref().map(&mut load).transpose()?, factor: factor.unwrap_or(1.0) })
        }
    };
    let mut baked = bake_map(&bump_map, base.as_ref(), settings)?;
    // The decoded images take more memory than the baked levels and are not needed any more.
    drop((bump_map, base));
    if is_jpeg {
        baked.notes.push(notes::JPEG.to_owned());
    }
    let mut outputs = vec![first];
    for texture in baked.textures.iter().skip(1) {
        outputs.push(guard.reserve_file(&beside(&args.output, texture.content))?);
    }
    let keys: Vec<_> =
        baked.textures.iter().map(|texture| texture_keys(texture, args, &baked, &sources, settings)).collect();
    let mut written = Vec::new();
    for (texture, (output, keys)) in baked.textures.iter_mut().zip(outputs.into_iter().zip(keys)) {
        let bytes = texture.mip_chain.take_ktx2(&keys).map_err(|error| BakeError::Encode(error.into()))?;
        output.write(&bytes)?;
        written.push((output.path().to_owned(), bytes.len() as u64));
    }
    Ok(Written { baked, files: written })
}

impl Args {
    /// Returns how the images are read, for the provenance.
    fn reading(&self) -> serde_json::Value {
        let mut reading = if self.height {
            json!({ "height": true, "heightScale": self.height_scale, "wrap": self.wrap })
        } else {
            json!({ "channels": format!("{:?}", self.channels).to_lowercase(), "greenDown": self.green_down })
        };
        reading["layer"] = json!(self.layer);
        reading["roughnessFactor"] = json!(self.roughness_factor);
        reading
    }
}

fn read(path: &Path) -> Result<Vec<u8>, MapCommandError> {
    read_file(path).map_err(|error| MapCommandError::Read { path: path.to_owned(), error })
}

fn decoded(
    path: &Path,
    bytes: &[u8],
    layer: Option<String>,
    settings: &Settings,
    decode: fn(&[u8], &DecodeOptions) -> Result<Image, DecodeError>,
) -> Result<Image, MapCommandError> {
    let extension = path.extension().map(|e| e.to_string_lossy().into_owned());
    let options = DecodeOptions { max_pixels: settings.max_texels, layer, extension };
    decode(bytes, &options).map_err(|error| MapCommandError::Decode { path: path.to_owned(), error })
}

fn source_digest(path: &Path, bytes: &[u8]) -> SourceDigest {
    let uri = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    SourceDigest { uri, blake3: digest(bytes) }
}

fn texture_keys(
    texture: &BakedTexture,
    args: &Args,
    baked: &BakedMap,
    sources: &[SourceDigest],
    settings: &Settings,
) -> Vec<Key> {
    let mut recorded = settings.to_json(baked.model);
    recorded["range"] = json!(texture.range);
    recorded["map"] = args.reading();
    if settings.provenance {
        Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            content: texture.content.name().to_owned(),
            settings: recorded,
            lobe_errors: texture.lobe_errors.clone(),
            sources: sources.to_vec(),
        }
        .keys()
    } else {
        Vec::new()
    }
}

/// Returns the path of another texture beside `output`: `wool.ktx2` becomes `wool.roughness.ktx2`.
fn beside(output: &Path, content: Content) -> PathBuf {
    let stem = output_stem_of(output);
    output.with_file_name(format!("{stem}.{}.ktx2", content.name()))
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
