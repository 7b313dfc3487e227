//! Options of commands that keep what they bake.

use std::io::{self, Write};
use std::path::PathBuf;

use crate::cache::Cache;

/// Where what was baked is kept.
#[derive(Debug, clap::Args)]
pub struct CacheOptions {
    /// Keep outputs in this folder, and take from it what was baked before. Several runs may share it.
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    /// Largest size of that folder; what was not used for longest goes first. K, M, G and T are powers of 1024.
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "10G")]
    cache_size: u64,
}

impl CacheOptions {
    /// The cache, if one is named.
    pub fn cache(&self) -> Option<Cache> {
        self.cache.as_deref().map(Cache::new)
    }

    /// Brings `cache` back to its size.
    ///
    /// # Errors
    /// When `err` cannot be written to.
    pub fn trim(&self, cache: &Cache, err: &mut dyn Write) -> io::Result<()> {
        cache.trim(self.cache_size).or_else(|error| writeln!(err, "warning: {error}"))
    }
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
