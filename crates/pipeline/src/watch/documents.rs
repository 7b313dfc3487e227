//! Which documents of the watched folder are outputs of earlier bakes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::look::{Look, Seen};
use crate::project;

/// What is known of documents, so that a document that does not change is read once.
#[derive(Debug, Default)]
pub struct Documents {
    known: HashMap<PathBuf, (Seen, bool)>,
}

impl Documents {
    /// Returns whether an earlier bake wrote the document at `path`.
    pub fn is_baked(&mut self, path: &Path) -> bool {
        let look = Look::at(path);
        if let Some((seen, is_baked)) = self.known.get(path)
            && seen.is_unchanged(look)
        {
            return *is_baked;
        }
        let since = SystemTime::now();
        let is_baked = project::is_baked(path);
        self.known.insert(path.to_owned(), (Seen::new(Look::at(path), true, since), is_baked));
        is_baked
    }
}
