//! The object-store cache in builds without the feature `object-store`.

use super::entry::{Entry, Fits, Stored};
use super::error::CacheError;
use crate::digest::Digest;

/// An object-store cache, which cannot exist in this build.
#[derive(Debug)]
pub enum ObjectStoreCache {}

impl ObjectStoreCache {
    /// Fails.
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
