//! The bake of a document.

use std::collections::HashMap;
use std::io;
use std::path::Path;

use roughcast_core::bake::{Files, Source, bake_asset, output_stem};
use roughcast_core::gltf::document::Document;
use roughcast_core::settings::values::Values;
use serde::Deserialize;

use crate::command::{Refusal, Reply, Response, first, run_report, settings};
use crate::message::File;

/// The header of a request.
#[derive(Deserialize)]
pub struct Request {
    /// The file name of the document without its extension, which provenance records.
    stem: String,
    /// The name of the output document without its extension, if it is another one.
    output: Option<String>,
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
    settings.target.check_available().map_err(|error| error.to_string())?;
    let stem = output_stem(&request.stem);
    let output = request.output.as_ref().unwrap_or(&stem);
    let document = Document::parse(document.bytes).map_err(|error| error.to_string())?;
    let source = Source { stem: &stem, output_stem: output, document: &document, files: &beside };
    let baked = bake_asset(&source, &settings, progress).map_err(|error| error.to_string())?;
    let copies = baked.copies.iter().map(|path| path.display().to_string()).collect();
    let mut outputs = vec![(format!("{output}.{}", baked.container.extension()), baked.document)];
    outputs.extend(baked.files.into_iter().map(|file| (file.path.display().to_string(), file.bytes)));
    let run = run_report(&request.settings, &settings);
    Ok((Reply::Baked { copies, run, report: baked.report }, outputs))
}

#[cfg(test)]
mod tests {
    use roughcast_core::bake::DocumentProvenance;

    use super::*;

    #[test]
    fn a_named_output_records_its_source() {
        let document = File { path: "model.glb", bytes: include_bytes!("../../../fixtures/waves/waves.glb") };
        let source_of = |header: &str| {
            let request: Request = serde_json::from_str(header).unwrap();
            let (_, files) = bake(&request, &[document], &|_| {}).unwrap();
            let baked = Document::parse(&files[0].1).unwrap();
            (files[0].0.clone(), DocumentProvenance::read(&baked).unwrap().source.unwrap())
        };
        let pair = |output: &str, source: &str| (output.to_owned(), source.to_owned());
        assert_eq!(source_of(r#"{"stem":"model","settings":{}}"#), pair("model.glb", "model.glb"));
        let named = r#"{"stem":"model","output":"baked","settings":{}}"#;
        assert_eq!(source_of(named), pair("baked.glb", "model.glb"));
    }
}
