//! Draws an input in scenes, and writes the pictures.

use rayon::prelude::*;

use super::columns::{Columns, columns};
use super::error::PictureError;
use super::folder::{Folder, PictureFiles, Shown};
use super::gallery::page;
use super::options::PictureOptions;
use super::report::{ColumnReport, PicturesReport, RENDER_FORMAT, RowReport, SheetReport};
use super::row::{DrawnColumn, DrawnRow};
use crate::readback::{Input, MapKind};
use crate::render::{Displayed, Scene, SceneName, Tone, highlight};

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
    let settings = input.settings(options.bake_settings());
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
        let progress = |share: f32, name: &str| progress(start + (1.0 - start) * share, name);
        sheets.extend(draw_scene(options, scene, &materials, &mut folder, &progress)?);
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
    let [phong, blinn_phong] = highlight(width).map(|picture| Displayed::new(picture, &Tone { exposure: 1.0 }));
    let mut panels = Vec::new();
    for (name, picture, heading) in
        [("phong", &phong, "Phong, outline of Blinn-Phong"), ("blinn-phong", &blinn_phong, "Blinn-Phong")]
    {
        let files = folder.encode_picture(&format!("{}.{name}", SceneName::Highlight.name()), picture);
        folder.write_picture(files)?;
        panels.push(Shown { heading: heading.to_owned(), picture, crop: None, labels: Vec::new() });
    }
    let sheet = folder.encode_sheet(SceneName::Highlight.name(), TITLE, "", &[panels]);
    let path = folder.write(sheet)?;
    Ok(SheetReport { path, title: TITLE.to_owned(), material: None, scene: SceneName::Highlight, rows: Vec::new() })
}

/// Draws `materials` in a scene and writes a sheet for each. Materials that look alike are drawn once.
fn draw_scene(
    options: &PictureOptions,
    name: SceneName,
    materials: &[Columns],
    folder: &mut Folder<'_>,
    progress: &(dyn Fn(f32, &str) + Sync),
) -> Result<Vec<SheetReport>, PictureError> {
    let distances = if options.distances.is_empty() { name.distances() } else { options.distances.as_slice() };
    // Materials share the scenes, whose surroundings take long to blur.
    let scenes: Vec<(f64, Scene)> =
        distances.iter().filter_map(|&distance| Some((distance, name.scene(options.width, distance)?))).collect();
    let groups = alike(materials);
    let mut sheets = Vec::new();
    for (done, group) in groups.iter().enumerate() {
        let drawn = &materials[group[0]];
        let rows: Vec<DrawnRow> = scenes
            .iter()
            .enumerate()
            .map(|(row, (distance, scene))| {
                let advance = |share: f32| {
                    let of_group = (row as f32 + share) / scenes.len() as f32;
                    progress((done as f32 + of_group) / groups.len() as f32, &drawn.name);
                };
                DrawnRow::new(options, scene, *distance, drawn, &advance)
            })
            .collect();
        for &index in group {
            sheets.push((index, write_material(name, &materials[index], &rows, folder)?));
        }
    }
    sheets.sort_by_key(|(index, _)| *index);
    Ok(sheets.into_iter().map(|(_, sheet)| sheet).collect())
}

/// Returns the indices of `materials` in groups that look alike.
fn alike(materials: &[Columns]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, columns) in materials.iter().enumerate() {
        match groups.iter_mut().find(|group| columns.look_like(&materials[group[0]])) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}

/// Writes the pictures and the sheet of a material.
fn write_material(
    scene: SceneName,
    columns: &Columns,
    rows: &[DrawnRow],
    folder: &mut Folder<'_>,
) -> Result<SheetReport, PictureError> {
    let stem = format!("{}.{}", columns.name, scene.name());
    let title = format!("{}, {}", columns.title, scene.name());
    let subtitle = "Below each picture its framed region, enlarged 4 times. Error: relative L1 of radiance.";
    let panels: Vec<Vec<Shown<'_>>> = rows.iter().map(DrawnRow::panels).collect();
    let encoder = &*folder;
    let (encoded_rows, sheet) = rayon::join(
        || rows.par_iter().map(|row| encode_row(row, &stem, encoder)).collect::<Vec<_>>(),
        || encoder.encode_sheet(&stem, &title, subtitle, &panels),
    );
    let reports =
        rows.iter().zip(encoded_rows).map(|(row, files)| write_row(row, files, folder)).collect::<Result<_, _>>()?;
    let path = folder.write(sheet)?;
    Ok(SheetReport { path, title, material: Some(columns.name.clone()), scene, rows: reports })
}

/// The files of a row.
struct RowFiles {
    /// Those of each column with filtered textures.
    columns: Vec<PictureFiles>,
    supersampled: PictureFiles,
}

/// Encodes each picture of a row.
fn encode_row(row: &DrawnRow, stem: &str, folder: &Folder<'_>) -> RowFiles {
    let encode = |name: &str, picture| folder.encode_picture(&format!("{stem}.d{}.{name}", row.distance), picture);
    let columns = row.columns.par_iter().map(|column| encode(column.name, &column.picture)).collect();
    RowFiles { columns, supersampled: encode("supersampled", &row.truth) }
}

/// Writes the files of a row.
fn write_row(row: &DrawnRow, files: RowFiles, folder: &mut Folder<'_>) -> Result<RowReport, PictureError> {
    let mut columns = Vec::new();
    for (DrawnColumn { name, difference, .. }, files) in row.columns.iter().zip(files.columns) {
        columns.push(ColumnReport { name, path: folder.write_picture(files)?, difference: *difference });
    }
    let supersampled = folder.write_picture(files.supersampled)?;
    let DrawnRow { distance, noise, crop, .. } = *row;
    Ok(RowReport { distance, columns, supersampled, noise, size: row.truth.picture.size, crop })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mip::Level;
    use crate::render::{Bumps, LostBumps, Material, Texture};

    fn columns(scale: f64, portable_scale: f64) -> Columns {
        let texture = || Texture::with_mips(Level { width: 1, height: 1, texels: vec![[0.1, 0.2, 0.9, 1.0]] });
        let material = |scale| Material {
            bumps: Bumps::Normals { texture: texture(), scale, has_z: true },
            roughness: None,
            roughness_factor: 1.0,
            anisotropy: None,
            lost: LostBumps::RoughenedTextures,
        };
        Columns {
            name: String::new(),
            title: String::new(),
            plain: material(scale),
            portable: Some(material(portable_scale)),
            pyramid: None,
        }
    }

    #[test]
    fn materials_are_drawn_together_if_all_their_columns_are_equal() {
        let materials = [columns(1.0, 1.0), columns(2.0, 1.0), columns(1.0, 1.0), columns(1.0, 2.0), columns(2.0, 1.0)];
        assert_eq!(alike(&materials), [vec![0, 2], vec![1, 4], vec![3]]);
        assert!(alike(&[]).is_empty());
    }
}
