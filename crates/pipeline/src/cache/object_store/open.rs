//! Opening of object stores by their URLs.

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

/// Returns the store of the URL `text`, and the path in it. The environment (`AWS_*`, `GOOGLE_*`, `AZURE_*`) has all
/// other settings.
///
/// # Errors
/// [`CacheError::NoStore`].
pub fn open(text: &str) -> Result<(Box<dyn ObjectStore>, ObjectPath), CacheError> {
    let url = Url::parse(text).map_err(|error| refused(text, &error.to_string()))?;
    if url.password().is_some() || url.query().is_some() || url.fragment().is_some() {
        let location = format!("{}://{}", url.scheme(), url.host_str().unwrap_or_default());
        return Err(refused(
            &location,
            "a password, a query or a fragment; credentials belong into environment variables",
        ));
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

/// Returns the rules for retries. A request ends after 30 s unless `AWS_TIMEOUT` or a similar variable has another
/// time. Retries end soon, because baking takes less time than waiting.
fn retry() -> RetryConfig {
    RetryConfig { max_retries: 3, retry_timeout: Duration::from_secs(10), ..RetryConfig::default() }
}

fn refused(url: &str, found: &str) -> CacheError {
    CacheError::NoStore { url: url.to_owned(), found: found.to_owned() }
}

#[cfg(test)]
mod tests;
