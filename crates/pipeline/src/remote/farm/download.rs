//! Downloads of blobs. Length and SHA-256 of each blob are verified.

use std::collections::HashMap;
use std::io::Read;

use tonic::Status;

use super::api;
use super::client::{Client, MAX_MESSAGE};
use super::digest::Digest;
use super::error::RemoteError;

/// Receives a blob.
pub type Take<'t> = &'t mut dyn FnMut(Digest, &[u8]) -> Result<(), RemoteError>;

/// Downloads `digests`, which are distinct, and gives each blob to `take` as soon as it arrives.
///
/// # Errors
/// [`RemoteError`], and those of `take`.
pub async fn fetch(digests: &[Digest], client: &Client, take: Take<'_>) -> Result<(), RemoteError> {
    let mut took = |digest: Digest, content: &[u8]| {
        client.count(|counts| {
            counts.downloaded_blobs += 1;
            counts.downloaded_bytes += digest.bytes;
        });
        take(digest, content)
    };
    let (mut batch, mut bytes) = (Vec::new(), 0);
    for digest in digests.iter().copied() {
        let cost = digest.bytes.saturating_add(200);
        if cost > client.batch / 2 {
            let _permit = client.budget(digest.bytes).await;
            let content = client.attempts().at(|| read(digest, client)).await?;
            took(digest, &content)?;
            continue;
        }
        if bytes + cost > client.batch {
            fetch_batch(&std::mem::take(&mut batch), client, &mut took).await?;
            bytes = 0;
        }
        batch.push(digest);
        bytes += cost;
    }
    fetch_batch(&batch, client, &mut took).await
}

/// Downloads one blob.
///
/// # Errors
/// [`RemoteError`].
pub async fn fetch_one(digest: Digest, client: &Client) -> Result<Vec<u8>, RemoteError> {
    let mut bytes = Vec::new();
    let mut take = |_, content: &[u8]| {
        bytes = content.to_vec();
        Ok(())
    };
    fetch(&[digest], client, &mut take).await?;
    Ok(bytes)
}

async fn fetch_batch(digests: &[Digest], client: &Client, take: Take<'_>) -> Result<(), RemoteError> {
    if digests.is_empty() {
        return Ok(());
    }
    let bytes = digests.iter().map(|digest| digest.bytes).sum();
    let _permit = client.budget(bytes).await;
    let request = api::BatchReadBlobsRequest {
        instance_name: client.instance.clone(),
        digests: digests.iter().map(|digest| digest.to_api()).collect(),
        ..api::BatchReadBlobsRequest::default()
    };
    let ask = || async {
        let mut service = client.storage();
        let answer = client.call("BatchReadBlobs", bytes, service.batch_read_blobs(request.clone())).await?;
        let responses = answer.responses.into_iter();
        let mut found: HashMap<Digest, _> =
            responses.filter_map(|response| Some((Digest::from_api(response.digest.as_ref()?)?, response))).collect();
        let mut blobs = Vec::with_capacity(digests.len());
        for digest in digests {
            let absent = || client.error("BatchReadBlobs", &Status::not_found("a blob is not in the answer"));
            let response = found.remove(digest).ok_or_else(absent)?;
            if let Some(status) = response.status.filter(|status| status.code != 0) {
                return Err(client.error("BatchReadBlobs", &Status::new(status.code.into(), status.message)));
            }
            blobs.push((*digest, verified(*digest, response.data)?));
        }
        Ok(blobs)
    };
    for (digest, content) in client.attempts().at(ask).await? {
        take(digest, &content)?;
    }
    Ok(())
}

/// Downloads one blob in chunks.
async fn read(digest: Digest, client: &Client) -> Result<Vec<u8>, RemoteError> {
    let kind = if client.is_zstd { "compressed-blobs/zstd" } else { "blobs" };
    let request = api::ReadRequest {
        resource_name: client.resource(&format!("{kind}/{}", digest.path())),
        ..api::ReadRequest::default()
    };
    // Data that cannot be compressed grows a little.
    let most = if client.is_zstd { digest.bytes.saturating_add(digest.bytes / 128 + 1024) } else { digest.bytes };
    let chunks = async {
        let mut service = api::ByteStreamClient::new(client.service()).max_decoding_message_size(MAX_MESSAGE);
        let mut stream = service.read(request).await?.into_inner();
        let mut content = Vec::new();
        while let Some(chunk) = stream.message().await? {
            content.extend_from_slice(&chunk.data);
            if content.len() as u64 > most {
                return Err(Status::data_loss("more bytes than the blob has"));
            }
        }
        Ok(content)
    };
    let content = client.within("ByteStream.Read", digest.bytes, chunks).await?;
    if !client.is_zstd {
        return verified(digest, content);
    }
    let mut plain = Vec::new();
    let decoder = zstd::stream::read::Decoder::new(content.as_slice());
    let done = decoder.and_then(|decoder| decoder.take(digest.bytes.saturating_add(1)).read_to_end(&mut plain));
    done.map_err(|_| RemoteError::Damaged { digest: digest.path() })?;
    verified(digest, plain)
}

fn verified(digest: Digest, content: Vec<u8>) -> Result<Vec<u8>, RemoteError> {
    if Digest::of(&content) == digest { Ok(content) } else { Err(RemoteError::Damaged { digest: digest.path() }) }
}
