//! Options of commands with a cache.

use std::path::{Path, PathBuf};

use crate::cache::{Cache, CacheError};

/// Where baked outputs are kept.
#[derive(Debug, clap::Args)]
pub struct CacheOptions {
    /// Keep outputs in this folder, and take outputs from it that were baked before; several runs may share it. A URL
    /// names an object store that machines share: s3://bucket/prefix, gs://, az:// or file://. With both, the folder is
    /// looked up first.
    #[arg(long, value_name = "DIR|URL")]
    cache: Vec<PathBuf>,
    /// Largest size of that folder; the outputs that were not used for longest are removed first. K, M, G and T are
    /// powers of 1024.
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "10G")]
    cache_size: u64,
}

impl CacheOptions {
    /// Opens the cache, if the user names one.
    ///
    /// # Errors
    /// [`CacheError`] where the name is no cache.
    pub fn open(&self) -> Result<Option<Cache>, CacheError> {
        let (urls, folders): (Vec<&PathBuf>, Vec<&PathBuf>) = self.cache.iter().partition(|path| is_url(path));
        for named in [&urls, &folders] {
            if let [first, second, ..] = named[..] {
                let text = |path: &Path| path.display().to_string();
                return Err(CacheError::TwoOfAKind { first: text(first), second: text(second) });
            }
        }
        if self.cache.is_empty() {
            return Ok(None);
        }
        let url = urls.first().and_then(|path| path.to_str());
        Cache::new(self.folder(), url, self.cache_size).map(Some)
    }

    /// Returns the folder, if the user names one.
    pub fn folder(&self) -> Option<&Path> {
        self.cache.iter().find(|path| !is_url(path)).map(PathBuf::as_path)
    }
}

fn is_url(path: &Path) -> bool {
    path.to_str().is_some_and(|text| text.contains("://"))
}

/// Parses a number of bytes, with K, M, G or T for powers of 1024.
fn size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let power = match text[digits.len()..].to_ascii_uppercase().as_str() {
        "" => Some(0),
        "K" => Some(1),
        "M" => Some(2),
        "G" => Some(3),
        "T" => Some(4),
        _ => None,
    };
    let bytes = power.and_then(|power| digits.parse::<u64>().ok()?.checked_mul(1 << (10 * power)));
    bytes.ok_or_else(|| format!("expected a number of bytes such as 500M or 10G, found {text:?}"))
}
