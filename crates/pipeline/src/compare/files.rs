//! Bakes the materials of a file with every model, compares them, and writes charts and tables.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::{Value, json};

use super::report::ComparisonReport;
use super::verdict::verdict;
use super::{Comparison, OURS, Ours, chart, compare, csv, page};
use crate::bake::{BakeError, BakedAsset, Source, bake_asset};
use crate::codec::Target;
use crate::codec::uastc::Effort;
use crate::gltf::document::Document;
use crate::gltf::material::{Layer, LayerKind, materials};
use crate::output::{Guard, PublishError};
use crate::readback::{Input, ReadBackError, file_name, read_back};
use crate::render::{Material, SceneName};
use crate::report::LayerReport;
use crate::settings::{Model, Settings, SettingsError};

/// What is compared, and where the charts are written.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// .gltf or .glb files, or images.
    pub inputs: Vec<PathBuf>,
    /// The folder of the charts.
    pub output: PathBuf,
    /// Texels of each level that are measured.
    pub texels: usize,
    /// Distance between heights 0 and 1, in widths of the map, if the input is an image of heights.
    pub height_scale: Option<f32>,
    /// Roughness of a standalone map, 0 to 1.
    pub roughness: f32,
    /// The error bound by which the marked model is chosen, 0 to 1.
    pub max_error: f32,
    /// The quality of the bake that is marked.
    pub quality: Effort,
    /// Width in pixels of the pictures that are judged, at most [`MAX_PICTURE_WIDTH`](super::MAX_PICTURE_WIDTH); 0 for
    /// no pictures.
    pub picture_width: u32,
    /// Largest number of texels of an input image.
    pub max_texels: u64,
}

/// The charts that were written.
#[derive(Clone, Debug)]
pub struct Charts {
    /// The files.
    pub files: Vec<PathBuf>,
    /// What the files show.
    pub report: ComparisonReport,
}

/// Why nothing is charted.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The input, or a material of its bake, cannot be read.
    #[error(transparent)]
    ReadBack(#[from] ReadBackError),
    /// A setting is out of its range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The input cannot be baked.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// The table cannot be made.
    #[error("expected to write compare.csv, found: {0}; free memory and try again")]
    Table(io::Error),
    /// A file cannot be written.
    #[error(transparent)]
    Publish(#[from] PublishError),
}

/// An input that cannot be charted, and why.
#[derive(Debug)]
pub struct FailedInput {
    /// The input.
    pub input: PathBuf,
    /// The reason. It is boxed, so that results stay small.
    pub error: Box<CompareError>,
}

/// Charts every material of the inputs, and writes the files. `progress` receives the finished share of the work and
/// the name of the material. If there are several inputs, names of materials begin with the name of the input.
///
/// # Errors
/// [`FailedInput`] for the first input that cannot be read or baked, or whose charts cannot be written.
pub fn compare_files(options: &CompareOptions, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<Charts, FailedInput> {
    let mut guard = Guard::default();
    let mut materials = Vec::new();
    for (i, path) in options.inputs.iter().enumerate() {
        let share = |share: f32, name: &str| progress((i as f32 + share) / options.inputs.len() as f32, name);
        let of_input = compare_input(options, path, &mut guard, &share)
            .map_err(|error| FailedInput { input: path.clone(), error: Box::new(error) })?;
        materials.extend(of_input);
    }
    let input = options.inputs.first().cloned().unwrap_or_default();
    write(&options.output, &mut guard, materials).map_err(|error| FailedInput { input, error: Box::new(error) })
}

/// Compares the materials of the input at `path`, which `guard` then protects.
fn compare_input(
    options: &CompareOptions,
    path: &Path,
    guard: &mut Guard,
    progress: &(dyn Fn(f32, &str) + Sync),
) -> Result<Vec<Comparison>, CompareError> {
    let input = Input::read(path, options.height_scale)?;
    let settings = input
        .settings(Settings::default())
        .with_glb(false)
        .with_target(Target::Basis)
        .with_max_error(options.max_error)?
        .with_max_texels(options.max_texels)
        .with_provenance(false);
    let mut comparisons = input.with_source(SceneName::Plane, Some(options.roughness), |source| {
        compare_document(options, source, &settings, progress)
    })?;
    input.protect(guard, path);
    if options.inputs.len() > 1 {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        comparisons.iter_mut().for_each(|comparison| comparison.material = format!("{file}: {}", comparison.material));
    }
    Ok(comparisons)
}

fn write(output: &Path, guard: &mut Guard, comparisons: Vec<Comparison>) -> Result<Charts, CompareError> {
    let report = ComparisonReport::new(comparisons);
    let comparisons = &report.materials;
    let mut files = vec![
        ("compare.html".to_owned(), page(comparisons, report.version)),
        ("compare.csv".to_owned(), csv(comparisons).map_err(CompareError::Table)?),
        ("compare.json".to_owned(), report.to_json() + "\n"),
    ];
    let mut taken = BTreeSet::new();
    for comparison in comparisons {
        let name = file_name("", &comparison.material, &mut taken);
        files.push((format!("compare-{name}.svg"), chart(comparison)));
    }
    let mut outputs = Vec::with_capacity(files.len());
    for (name, text) in files {
        outputs.push((guard.reserve_file(&output.join(name))?, text));
    }
    outputs.iter().try_for_each(|(output, text)| output.write(text.as_bytes()))?;
    Ok(Charts { files: outputs.iter().map(|(output, _)| output.path().to_owned()).collect(), report })
}

fn compare_document(
    options: &CompareOptions,
    source: &Source<'_>,
    settings: &Settings,
    progress: &(dyn Fn(f32, &str) + Sync),
) -> Result<Vec<Comparison>, CompareError> {
    let root: Value = source.document.json().value("").map_err(BakeError::from)?.unwrap_or_default();
    let materials = materials(&root).into_iter().collect::<Result<Vec<_>, _>>().map_err(BakeError::from)?;
    let has_base = |layers: &[Layer]| layers.iter().any(|layer| layer.kind == LayerKind::Base);
    let bumpy: Vec<usize> =
        materials.iter().filter(|material| has_base(&material.layers)).map(|material| material.index).collect();
    if bumpy.is_empty() {
        return Err(ReadBackError::NoBumps.into());
    }
    let mut comparisons = Vec::new();
    for (done, &index) in bumpy.iter().enumerate() {
        // Bytes and times are to be those of one material, so the other materials lose their bumps.
        let copy = source.document.to_bytes().map_err(BakeError::from)?;
        let mut document = Document::parse(&copy).map_err(BakeError::from)?;
        for other in materials.iter().map(|material| material.index).filter(|other| *other != index) {
            document.json_mut().set(&format!("/materials/{other}"), &json!({})).map_err(BakeError::from)?;
        }
        let advance = |share: f32, name: &str| progress((done as f32 + share) / bumpy.len() as f32, name);
        comparisons.extend(compare_material(options, &Source { document: &document, ..*source }, settings, &advance)?);
    }
    Ok(comparisons)
}

/// Bakes and scores the one material of `source` that has bumps.
fn compare_material(
    options: &CompareOptions,
    source: &Source<'_>,
    settings: &Settings,
    advance: &(dyn Fn(f32, &str) + Sync),
) -> Result<Option<Comparison>, CompareError> {
    let material = |baked: &BakedAsset| -> Result<(String, Material), ReadBackError> {
        read_back(source, baked, options.max_texels)?.into_iter().next().ok_or(ReadBackError::NoBumps)
    };
    let plain = bake_asset(source, &settings.with_model(Model::None).with_target(Target::Float), &|_| {})?;
    let (name, truth) = material(&plain)?;
    let models = [Model::None, Model::Isotropic, Model::Anisotropic];
    let named = |model: Model| {
        [Effort::Fast, Effort::Best].map(|effort| (model, effort, format!("ours, {}, {}", model.name(), effort.name())))
    };
    let auto = (Model::Auto, options.quality, "ours, auto".to_owned());
    let mut ours = Vec::with_capacity(OURS);
    let mut layer = None;
    for (model, effort, label) in models.into_iter().flat_map(named).chain([auto]) {
        let start = Instant::now();
        let baked = bake_asset(source, &settings.with_model(model).with_quality(effort), &|_| {})?;
        let seconds = start.elapsed().as_secs_f64();
        ours.push(Ours {
            name: label,
            material: material(&baked)?.1,
            file_bytes: baked.report.textures.iter().map(|texture| texture.bytes as u64).sum(),
            seconds,
            chosen: model == Model::Auto,
        });
        if model == Model::Auto {
            let made = |layer: &LayerReport| layer.layer == LayerKind::Base && layer.model.is_some();
            layer = baked.report.layers.into_iter().find(made);
        }
        advance(ours.len() as f32 / (2 * OURS) as f32, &name);
    }
    let scored = |share: f32| advance(0.5 + 0.5 * share, &name);
    let comparison = ours
        .try_into()
        .ok()
        .and_then(|ours| compare(&name, &truth, ours, options.texels, options.picture_width, &scored));
    Ok(comparison.map(|comparison| {
        let verdict = layer.and_then(|layer| verdict(&comparison.entries, &layer, options.max_error));
        Comparison { verdict, ..comparison }
    }))
}
