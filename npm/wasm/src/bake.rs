//! The bake of a document.

use std::collections::HashMap;
use std::io;
use std::path::Path;

use roughcast_core::api::bake_asset_with_progress;
use roughcast_core::bake::{Files, output_stem};
use roughcast_core::settings::values::Values;
use serde::Deserialize;

use crate::command::{Refusal, Reply, Response, first, run_report, settings};
use crate::message::File;

/// The header of a request.
#[derive(Deserialize)]
pub struct Request {
    /// The file name of the document without its extension.
    stem: String,
    settings: Values,
}

/// The files beside the document.
struct Beside<'m>(HashMap<&'m Path, &'m [u8]>);

impl Files for Beside<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.get(path).map(|bytes| bytes.to_vec()).ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn known_length(&self, path: &Path) -> Option<u64> {
        self.0.get(path).map(|bytes| bytes.len() as u64)
    }

    fn is_missing(&self, path: &Path) -> bool {
        !self.0.contains_key(path)
    }
}

/// Bakes the first of `files`. The response has the new document, new files, the names of files that did not change,
/// and the reports of the run and of the document.
pub fn bake(request: &Request, files: &[File<'_>], progress: &dyn Fn(f32)) -> Result<Response, Refusal> {
    let document = first(files)?;
    let beside = Beside(files.iter().skip(1).map(|file| (Path::new(file.path), file.bytes)).collect());
    let settings = settings(&request.settings).map_err(|error| error.to_string())?;
    let stem = output_stem(&request.stem);
    let baked = bake_asset_with_progress(&stem, document.bytes, &beside, &settings, progress)
        .map_err(|error| error.to_string())?;
    let copies = baked.copies.iter().map(|path| path.display().to_string()).collect();
    let mut outputs = vec![(format!("{stem}.{}", baked.container.extension()), baked.document)];
    outputs.extend(baked.files.into_iter().map(|file| (file.path.display().to_string(), file.bytes)));
    let run = run_report(&request.settings, &settings);
    Ok((Reply::Baked { copies, run, report: baked.report }, outputs))
}
