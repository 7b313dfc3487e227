//! From a URL to a store.

use std::time::Duration;

use object_store::aws::AmazonS3Builder;
use object_store::azure::MicrosoftAzureBuilder;
use object_store::gcp::GoogleCloudStorageBuilder;
use object_store::local::LocalFileSystem;
use object_store::path::Path as ObjectPath;
use object_store::{ObjectStore, ObjectStoreScheme, RetryConfig};
use url::Url;

use super::health::reason;
use crate::cache::CacheError;

/// The store at `text`, and where in it. Settings of the environment (`AWS_*`, `GOOGLE_*`, `AZURE_*`) say all else.
///
/// # Errors
/// [`CacheError::NoStore`].
pub fn open(text: &str) -> Result<(Box<dyn ObjectStore>, ObjectPath), CacheError> {
    let url = Url::parse(text).map_err(|error| refused(text, &error.to_string()))?;
    if url.password().is_some() || url.query().is_some() || url.fragment().is_some() {
        let place = format!("{}://{}", url.scheme(), url.host_str().unwrap_or_default());
        return Err(refused(&place, "more than a place; credentials belong into the environment"));
    }
    let (scheme, path) = ObjectStoreScheme::parse(&url).map_err(|_| refused(text, "a scheme that no store has"))?;
    let store: object_store::Result<Box<dyn ObjectStore>> = match scheme {
        ObjectStoreScheme::Local => Ok(Box::new(LocalFileSystem::new())),
        ObjectStoreScheme::AmazonS3 => {
            AmazonS3Builder::from_env().with_url(text).with_retry(retry()).build().map(|s| Box::new(s) as _)
        }
        ObjectStoreScheme::GoogleCloudStorage => {
            GoogleCloudStorageBuilder::from_env().with_url(text).with_retry(retry()).build().map(|s| Box::new(s) as _)
        }
        ObjectStoreScheme::MicrosoftAzure => {
            MicrosoftAzureBuilder::from_env().with_url(text).with_retry(retry()).build().map(|s| Box::new(s) as _)
        }
        _ => return Err(refused(text, "a scheme that no store has")),
    };
    Ok((store.map_err(|error| refused(text, &reason(&error)))?, path))
}

/// A request ends after 30 s (`AWS_TIMEOUT` and the like say otherwise), and is not tried for much longer: baking is the
/// better try.
fn retry() -> RetryConfig {
    RetryConfig { max_retries: 3, retry_timeout: Duration::from_secs(10), ..RetryConfig::default() }
}

fn refused(url: &str, found: &str) -> CacheError {
    CacheError::NoStore { url: url.to_owned(), found: found.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schemes_of_stores_are_known_and_others_refused() {
        let (_, path) = open("file:///a/b%20c").expect("a folder");
        assert_eq!(path.as_ref(), "a/b c");
        let (_, path) = open("s3://bucket/some/prefix").expect("a bucket");
        assert_eq!(path.as_ref(), "some/prefix");
        for wrong in ["://", "s3://", "http://host/a", "https://host/a", "memory:///a", "ftp://host/a", "C://x"] {
            assert!(matches!(open(wrong), Err(CacheError::NoStore { .. })), "{wrong}");
        }
    }

    #[test]
    fn secrets_in_a_url_are_refused_and_not_repeated() {
        for wrong in ["s3://user:hunter2@bucket/a", "az://container/a?sig=hunter2", "s3://bucket/a#hunter2"] {
            let error = open(wrong).map(|_| ()).expect_err("an error").to_string();
            assert!(error.contains("credentials") && !error.contains("hunter2"), "{error}");
        }
    }
}
