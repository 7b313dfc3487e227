//! Uploads of blobs that a server does not have: small blobs in batches, large blobs in chunks, each blob once.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::watch;

use super::api;
use super::client::Client;
use super::digest::{Blob, Digest};
use super::error::RemoteError;
use super::retry::random_id;

/// Digests in one request. A message of 4 MiB holds about 50 000.
const DIGESTS_PER_REQUEST: usize = 10_000;

/// Bytes in a chunk of a large blob.
const CHUNK: usize = 1 << 20;

/// The blobs that the server is known to have, and those that are being sent.
#[derive(Default)]
pub struct Uploads(Mutex<HashMap<Digest, State>>);

enum State {
    /// A caller sends the blob. The channel closes when the caller has succeeded or failed.
    Sending(watch::Receiver<()>),
    /// The server has the blob.
    Present,
}

/// Blobs that one caller sends, and for which other callers wait.
struct Reservation<'u> {
    uploads: &'u Uploads,
    blobs: Vec<Blob>,
    /// Closes when the reservation is dropped.
    _ended: watch::Sender<()>,
}

impl Drop for Reservation<'_> {
    fn drop(&mut self) {
        let mut states = self.uploads.states();
        for blob in &self.blobs {
            if matches!(states.get(&blob.digest), Some(State::Sending(_))) {
                states.remove(&blob.digest);
            }
        }
    }
}

impl Uploads {
    /// Ensures that the server has all of `blobs`. Returns when it has them, whoever sent them.
    pub async fn send(&self, blobs: &[Blob], client: &Client) -> Result<(), RemoteError> {
        loop {
            let (reservation, others) = self.reserve(blobs);
            if !reservation.blobs.is_empty() {
                let missing = client.attempts().at(|| missing(&reservation.blobs, client)).await?;
                send(&missing, client).await?;
                let mut states = self.states();
                for blob in reservation.blobs.iter().filter(|blob| blob.is_file()) {
                    states.insert(blob.digest, State::Present);
                }
            }
            drop(reservation);
            if others.is_empty() {
                return Ok(());
            }
            for mut other in others {
                // The channel closes without a message, so the result is always an error.
                let _ = other.changed().await;
            }
            // Blobs that another caller failed to send are reserved by this caller in the next round.
        }
    }

    /// Forgets that the server has `blobs`, since the server says that it lost some.
    pub fn forget(&self, blobs: &[Blob]) {
        let mut states = self.states();
        for blob in blobs {
            if matches!(states.get(&blob.digest), Some(State::Present)) {
                states.remove(&blob.digest);
            }
        }
    }

    fn reserve(&self, blobs: &[Blob]) -> (Reservation<'_>, Vec<watch::Receiver<()>>) {
        let (ended, end) = watch::channel(());
        let (mut mine, mut others) = (Vec::new(), Vec::new());
        let mut states = self.states();
        for blob in blobs {
            match states.get(&blob.digest) {
                Some(State::Present) => {}
                // The blob is listed twice.
                Some(State::Sending(other)) if other.same_channel(&end) => {}
                Some(State::Sending(other)) => others.push(other.clone()),
                None => {
                    states.insert(blob.digest, State::Sending(end.clone()));
                    mine.push(blob.clone());
                }
            }
        }
        (Reservation { uploads: self, blobs: mine, _ended: ended }, others)
    }

    fn states(&self) -> MutexGuard<'_, HashMap<Digest, State>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the blobs of `blobs` that the server does not have.
async fn missing(blobs: &[Blob], client: &Client) -> Result<Vec<Blob>, RemoteError> {
    let mut found = Vec::new();
    for part in blobs.chunks(DIGESTS_PER_REQUEST) {
        let mut service = client.storage();
        let request = api::FindMissingBlobsRequest {
            instance_name: client.instance.clone(),
            blob_digests: part.iter().map(|blob| blob.digest.to_api()).collect(),
            ..api::FindMissingBlobsRequest::default()
        };
        let answer = client.call("FindMissingBlobs", 0, service.find_missing_blobs(request)).await?;
        let digests: HashSet<Digest> = answer.missing_blob_digests.iter().filter_map(Digest::from_api).collect();
        found.extend(part.iter().filter(|blob| digests.contains(&blob.digest)).cloned());
    }
    Ok(found)
}

async fn send(blobs: &[Blob], client: &Client) -> Result<(), RemoteError> {
    let (mut batch, mut bytes) = (Vec::new(), 0);
    for blob in blobs {
        // A digest and framing are added to the bytes.
        let cost = blob.digest.bytes + 200;
        if cost > client.batch / 2 {
            let _permit = client.budget(blob.digest.bytes).await;
            let content = blob.read()?;
            client.attempts().at(|| write(blob.digest, &content, client)).await?;
            client.count(|counts| {
                counts.uploaded_blobs += 1;
                counts.uploaded_bytes += blob.digest.bytes;
            });
            continue;
        }
        if bytes + cost > client.batch {
            send_batch(&std::mem::take(&mut batch), client).await?;
            bytes = 0;
        }
        batch.push(blob);
        bytes += cost;
    }
    send_batch(&batch, client).await
}

async fn send_batch(blobs: &[&Blob], client: &Client) -> Result<(), RemoteError> {
    if blobs.is_empty() {
        return Ok(());
    }
    let mut requests = Vec::with_capacity(blobs.len());
    for blob in blobs {
        let (digest, data) = (Some(blob.digest.to_api()), blob.read()?.to_vec());
        requests.push(api::batch_update_blobs_request::Request { digest, data, compressor: 0 });
    }
    let bytes: u64 = blobs.iter().map(|blob| blob.digest.bytes).sum();
    let request = api::BatchUpdateBlobsRequest {
        instance_name: client.instance.clone(),
        requests,
        ..api::BatchUpdateBlobsRequest::default()
    };
    let update = || async {
        let mut service = client.storage();
        let answer = client.call("BatchUpdateBlobs", bytes, service.batch_update_blobs(request.clone())).await?;
        let statuses = answer.responses.into_iter().filter_map(|response| response.status);
        match statuses.into_iter().find(|status| status.code != 0) {
            Some(status) => {
                Err(client.error("BatchUpdateBlobs", &tonic::Status::new(status.code.into(), status.message)))
            }
            None => Ok(()),
        }
    };
    client.attempts().at(update).await?;
    client.count(|counts| {
        counts.uploaded_blobs += blobs.len() as u64;
        counts.uploaded_bytes += bytes;
    });
    Ok(())
}

/// Sends one blob in chunks.
async fn write(digest: Digest, content: &Arc<[u8]>, client: &Client) -> Result<(), RemoteError> {
    let (kind, bytes): (_, Arc<[u8]>) = if client.is_zstd {
        // Level 1 is fast enough not to slow down the transfer. Higher levels are slower than the network.
        let compressed = zstd::bulk::compress(content, 1).map_err(|error| RemoteError::Malformed {
            expected: "to compress a blob for the server",
            found: error.to_string(),
        })?;
        ("compressed-blobs/zstd", compressed.into())
    } else {
        ("blobs", Arc::clone(content))
    };
    let id = random_id();
    let (a, b, c, d, e) = (&id[..8], &id[8..12], &id[12..16], &id[16..20], &id[20..]);
    let name = client.resource(&format!("uploads/{a}-{b}-{c}-{d}-{e}/{kind}/{}", digest.path()));
    let (length, chunks) = (bytes.len(), bytes.len().div_ceil(CHUNK).max(1));
    let sent = Arc::clone(&bytes);
    let requests = (0..chunks).map(move |chunk| {
        let (start, end) = (chunk * CHUNK, ((chunk + 1) * CHUNK).min(length));
        api::WriteRequest {
            // Only the first request needs the name.
            resource_name: if chunk == 0 { name.clone() } else { String::new() },
            write_offset: start as i64,
            finish_write: end == length,
            data: sent.get(start..end).unwrap_or_default().to_vec(),
        }
    });
    let mut service = api::ByteStreamClient::new(client.service());
    let call = service.write(tokio_stream::iter(requests));
    let answer = client.call("ByteStream.Write", length as u64, call).await?;
    // The size is -1 or the length of the blob if the server had the blob already and read no further.
    let committed = answer.committed_size;
    if committed == length as i64 || committed == digest.bytes as i64 || committed == -1 {
        return Ok(());
    }
    Err(RemoteError::Status {
        call: "ByteStream.Write",
        code: tonic::Code::DataLoss,
        message: format!("{committed} bytes of {length} arrived"),
    })
}
