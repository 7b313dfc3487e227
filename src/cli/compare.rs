//! `roughcast compare`.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Value, json};

use super::options::{effort, finite, unit_interval};
use super::outcome::Outcome;
use super::progress::ProgressLine;
use super::render::RenderError;
use super::render::columns::{file_name, read_back};
use super::render::input::Input;
use crate::bake::{BakeError, BakedAsset, Source, bake_asset};
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::compare::{Comparison, OURS, Ours, chart, compare, csv, page};
use crate::gltf::document::Document;
use crate::gltf::material::{LayerKind, materials};
use crate::render::{Material, Subject};
use crate::run::Progress;
use crate::settings::{Form, Model, Settings};
use crate::text::printable;

/// Chart lobe error against cost: every model, every peer and the best single lobe, on your own material.
///
/// Writes compare.html (everything), compare-MATERIAL.svg, compare.csv and compare.json. All values except the bake
/// times are equal in every run.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  roughcast compare helmet.glb -o charts\n  \
    roughcast compare wool_normal.png -o charts --roughness 0.3 --max-error 0.02")]
pub struct Args {
    /// .gltf or .glb, whose materials are charted, or a standalone normal or height map.
    input: PathBuf,
    /// Output folder.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Texels of each mip level that are measured: more texels take longer and give more exact errors.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=4096), value_name = "N")]
    texels: u16,
    /// INPUT is an image of heights, not of normals.
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
    match compare_all(args) {
        Err(error) => {
            writeln!(err, "error: {}: {error}", args.input.display())?;
            Ok(Outcome::Failed)
        }
        Ok((comparisons, files)) => {
            if args.json {
                writeln!(out, "{}", text(&report(&comparisons)))?;
            } else if !args.quiet {
                files.iter().try_for_each(|path| writeln!(out, "{}", printable(&path.display().to_string())))?;
                comparisons.iter().try_for_each(|comparison| out.write_all(summary(comparison).as_bytes()))?;
            }
            Ok(Outcome::Done)
        }
    }
}

fn summary(comparison: &Comparison) -> String {
    let mut text = format!("{}\n", printable(&comparison.material));
    for entry in &comparison.entries {
        let chosen = if entry.chosen { "  chosen" } else { "" };
        text += &format!("  {:<18} {:.3}{chosen}\n", entry.name, entry.error);
    }
    text
}

fn report(comparisons: &[Comparison]) -> Value {
    json!({ "version": env!("CARGO_PKG_VERSION"), "materials": comparisons })
}

fn text(value: &Value) -> String {
    format!("{value:#}")
}

fn compare_all(args: &Args) -> Result<(Vec<Comparison>, Vec<PathBuf>), RenderError> {
    let input = Input::read(Some(&args.input), args.height.then_some(args.height_scale))?;
    let comparisons =
        input.with_source(Subject::Plane, Some(args.roughness), |source| compare_document(args, source))?;
    let mut files = vec![
        ("compare.html".to_owned(), page(&comparisons, env!("CARGO_PKG_VERSION"))),
        ("compare.csv".to_owned(), csv(&comparisons).map_err(RenderError::Table)?),
        ("compare.json".to_owned(), text(&report(&comparisons)) + "\n"),
    ];
    let mut taken = BTreeSet::new();
    for comparison in &comparisons {
        let name = file_name("", &comparison.material, &mut taken);
        files.push((format!("compare-{name}.svg"), chart(comparison)));
    }
    let mut guard = input.guard(Some(&args.input));
    let mut outputs = Vec::with_capacity(files.len());
    for (name, text) in files {
        outputs.push((guard.reserve_file(&args.output.join(name))?, text));
    }
    outputs.iter().try_for_each(|(output, text)| output.write(text.as_bytes()))?;
    Ok((comparisons, outputs.iter().map(|(output, _)| output.path().to_owned()).collect()))
}

fn compare_document(args: &Args, source: &Source<'_>) -> Result<Vec<Comparison>, RenderError> {
    let root: Value = source.document.json().value("")?.unwrap_or_default();
    let materials = materials(&root).into_iter().collect::<Result<Vec<_>, _>>()?;
    let has_base = |layers: &[crate::gltf::material::Layer]| layers.iter().any(|l| l.kind == LayerKind::Base);
    let bumpy: Vec<usize> = materials.iter().filter(|m| has_base(&m.layers)).map(|m| m.index).collect();
    if bumpy.is_empty() {
        return Err(RenderError::NoBumps);
    }
    let progress = ProgressLine::new(bumpy.len(), args.quiet);
    let mut comparisons = Vec::new();
    for (done, &index) in bumpy.iter().enumerate() {
        // Bytes and times are to be those of one material, so the other materials lose their bumps.
        let mut document = Document::parse(&source.document.to_bytes().map_err(BakeError::from)?)?;
        for other in materials.iter().map(|m| m.index).filter(|other| *other != index) {
            document.json_mut().set(&format!("/materials/{other}"), &json!({}))?;
        }
        let advance = |share: f32, what: &str| progress.advance(done, share, what);
        comparisons.extend(compare_material(args, &Source { document: &document, ..*source }, &advance)?);
    }
    progress.finish();
    Ok(comparisons)
}

/// Bakes and scores the one material of `source` that has bumps.
fn compare_material(
    args: &Args,
    source: &Source<'_>,
    advance: &dyn Fn(f32, &str),
) -> Result<Option<Comparison>, RenderError> {
    let settings = Settings::default()
        .with_form(Form::Strict)
        .with_target(Target::Basis)
        .with_max_error(args.max_error)
        .with_max_texels(args.max_texels)
        .with_provenance(false);
    let material = |baked: &BakedAsset| -> Result<(String, Material), RenderError> {
        read_back(source, baked, args.max_texels)?.into_iter().next().ok_or(RenderError::NoBumps)
    };
    let plain = bake_asset(source, &settings.with_model(Model::None).with_target(Target::Float), &|_| {})?;
    let (name, truth) = material(&plain)?;
    let models = [(Model::None, "none"), (Model::Isotropic, "isotropic"), (Model::Anisotropic, "anisotropic")];
    let named = |(model, name): (Model, &str)| {
        [(Effort::Fast, "fast"), (Effort::Best, "best")]
            .map(|(effort, quality)| (model, effort, format!("ours, {name}, {quality}")))
    };
    let auto = (Model::Auto, args.quality, "ours, auto".to_owned());
    let mut ours = Vec::with_capacity(OURS);
    for (model, effort, label) in models.into_iter().flat_map(named).chain([auto]) {
        let start = Instant::now();
        let baked = bake_asset(source, &settings.with_model(model).with_effort(effort), &|_| {})?;
        let seconds = start.elapsed().as_secs_f64();
        ours.push(Ours {
            name: label,
            material: material(&baked)?.1,
            file_bytes: baked.report.textures.iter().map(|t| t.bytes as u64).sum(),
            seconds,
            chosen: model == Model::Auto,
        });
        advance(ours.len() as f32 / (2 * OURS) as f32, &name);
    }
    let scored = |share: f32| advance(0.5 + 0.5 * share, &name);
    Ok(ours.try_into().ok().and_then(|ours| compare(&name, &truth, ours, usize::from(args.texels), &scored)))
}
