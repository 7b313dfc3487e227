//! Stands for the stores that machines share in builds without them.

use super::entry::{Entry, Fits, Stored};
use super::error::CacheError;
use crate::digest::Digest;

/// There is none.
#[derive(Debug)]
pub enum Shared {}

impl Shared {
    /// Refuses.
    ///
    /// # Errors
    /// [`CacheError::NotBuilt`].
    pub fn open(url: &str) -> Result<Self, CacheError> {
        Err(CacheError::NotBuilt { url: url.to_owned() })
    }

    pub fn entry(&self, _id: Digest, _fits: Fits<'_>) -> Result<Option<Entry>, CacheError> {
        match *self {}
    }

    pub fn blobs(&self, _wanted: &[&Stored]) -> Vec<Result<Option<Vec<u8>>, CacheError>> {
        match *self {}
    }

    pub fn put(&self, _entry: &Entry, _blobs: &[&[u8]]) -> Result<(), CacheError> {
        match *self {}
    }
}
