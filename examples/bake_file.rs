//! Bakes one glTF document into a folder: `cargo run --release --example bake_file -- fixtures/brushed/brushed.gltf
//! out`.

use std::error::Error;
use std::path::{Component, Path, PathBuf};
use std::{env, fs};

use roughcast::{Settings, bake_asset_with_progress};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [source, output] = arguments.as_slice() else {
        return Err("expected a .gltf or .glb file and a folder".into());
    };
    let folder = source.parent().unwrap_or(Path::new(""));
    let stem = source.file_stem().and_then(|stem| stem.to_str()).ok_or("expected a file name in UTF-8")?;
    let read = |path: &Path| fs::read(folder.join(path));
    let progress = |share: f32| eprintln!("{:3.0} %", 100.0 * share);
    let baked = bake_asset_with_progress(stem, &fs::read(source)?, &read, &Settings::default(), &progress)?;

    write(output, Path::new(&format!("{stem}.{}", baked.container.extension())), &baked.document)?;
    for file in &baked.files {
        write(output, &file.path, &file.bytes)?;
    }
    for path in &baked.copies {
        write(output, path, &read(path)?)?;
    }
    for layer in &baked.report.layers {
        println!("{}: {:?}", layer.material, layer.model);
        for note in &layer.notes {
            println!("  {:?}: {note}", note.kind);
        }
    }
    Ok(())
}

/// Writes a file below `folder`. A document may name files outside its own folder, which this refuses to write.
fn write(folder: &Path, path: &Path, bytes: &[u8]) -> Result<(), Box<dyn Error>> {
    if !path.components().all(|part| matches!(part, Component::Normal(_))) {
        return Err(format!("{}: expected a path below the document's folder", path.display()).into());
    }
    let path = folder.join(path);
    fs::create_dir_all(path.parent().unwrap_or(folder))?;
    Ok(fs::write(path, bytes)?)
}
