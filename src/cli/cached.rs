//! Options of commands that keep what they bake.

use std::path::{Path, PathBuf};

use crate::cache::{Cache, CacheError};

/// Where what was baked is kept.
#[derive(Debug, clap::Args)]
pub struct CacheOptions {
    /// Keep outputs in this folder, and take from it what was baked before; several runs may share it. A URL names a store
    /// that machines share: s3://bucket/prefix, gs://, az:// or file://. Given both, the folder is in front of the store.
    #[arg(long, value_name = "DIR|URL")]
    cache: Vec<PathBuf>,
    /// Largest size of that folder; what was not used for longest goes first. K, M, G and T are powers of 1024.
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "10G")]
    cache_size: u64,
}

impl CacheOptions {
    /// The cache, if one is named.
    ///
    /// # Errors
    /// [`CacheError`] where what is named cannot be one.
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

    /// The folder, if one is named.
    pub fn folder(&self) -> Option<&Path> {
        self.cache.iter().find(|path| !is_url(path)).map(PathBuf::as_path)
    }
}

fn is_url(path: &Path) -> bool {
    path.to_str().is_some_and(|text| text.contains("://"))
}

/// A number of bytes, with K, M, G or T for powers of 1024.
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
