//! Sending blobs that a server does not have: the small together, the large in pieces, each once.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::watch;

use super::api;
use super::client::Client;
use super::digest::{Blob, Digest};
use super::error::RemoteError;
use super::retry::random;

/// Digests per question: a message of 4 MiB holds some 50 000.
const QUESTION: usize = 10_000;

/// Bytes per piece of a large blob.
const PIECE: usize = 1 << 20;

/// What is known to be there, or on its way.
#[derive(Default)]
pub struct Uploads(Mutex<HashMap<Digest, State>>);

enum State {
    /// Somebody sends it; the channel closes when that has ended.
    Sending(watch::Receiver<()>),
    There,
}

/// Blobs that one caller sends and others wait for.
struct Reservation<'u> {
    uploads: &'u Uploads,
    blobs: Vec<Blob>,
    /// Closed when this is dropped.
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
    /// Sees to it that the server has all of `blobs`. Returns when it has them, whoever sent them.
    pub async fn send(&self, blobs: &[Blob], client: &Client) -> Result<(), RemoteError> {
        loop {
            let (reserve, others) = self.reserve(blobs);
            if !reserve.blobs.is_empty() {
                let missing = client.attempts().at(|| missing(&reserve.blobs, client)).await?;
                send(&missing, client).await?;
                let mut states = self.states();
                for blob in reserve.blobs.iter().filter(|blob| blob.is_file()) {
                    states.insert(blob.digest, State::There);
                }
            }
            drop(reserve);
            if others.is_empty() {
                return Ok(());
            }
            for mut other in others {
                // Closed, and nothing was ever sent.
                let _ = other.changed().await;
            }
            // What others failed to send is claimed now.
        }
    }

    /// Forgets that `blobs` are there, since the server says otherwise.
    pub fn forget(&self, blobs: &[Blob]) {
        let mut states = self.states();
        for blob in blobs {
            if matches!(states.get(&blob.digest), Some(State::There)) {
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
                Some(State::There) => {}
                // Twice among `blobs`.
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

/// Those of `blobs` that the server does not have.
async fn missing(blobs: &[Blob], client: &Client) -> Result<Vec<Blob>, RemoteError> {
    let mut found = Vec::new();
    for part in blobs.chunks(QUESTION) {
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
        // A digest and framing besides.
        let cost = blob.digest.bytes + 200;
        if cost > client.batch / 2 {
            let _room = client.budget(blob.digest.bytes).await;
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

/// Sends one blob in pieces.
async fn write(digest: Digest, content: &Arc<[u8]>, client: &Client) -> Result<(), RemoteError> {
    let (kind, bytes): (_, Arc<[u8]>) = if client.is_zstd {
        // Level 1: the wire is faster than higher levels.
        let compressed = zstd::bulk::compress(content, 1).map_err(|error| RemoteError::Malformed {
            expected: "to compress a blob for the server",
            found: error.to_string(),
        })?;
        ("compressed-blobs/zstd", compressed.into())
    } else {
        ("blobs", Arc::clone(content))
    };
    let id = format!("{:016x}{:016x}", random(), random());
    let (a, b, c, d, e) = (&id[..8], &id[8..12], &id[12..16], &id[16..20], &id[20..]);
    let name = client.resource(&format!("uploads/{a}-{b}-{c}-{d}-{e}/{kind}/{}", digest.path()));
    let (length, pieces) = (bytes.len(), bytes.len().div_ceil(PIECE).max(1));
    let sent = Arc::clone(&bytes);
    let requests = (0..pieces).map(move |piece| {
        let (start, end) = (piece * PIECE, ((piece + 1) * PIECE).min(length));
        api::WriteRequest {
            // Only the first needs it.
            resource_name: if piece == 0 { name.clone() } else { String::new() },
            write_offset: start as i64,
            finish_write: end == length,
            data: sent.get(start..end).unwrap_or_default().to_vec(),
        }
    });
    let mut service = api::ByteStreamClient::new(client.service());
    let call = service.write(tokio_stream::iter(requests));
    let answer = client.call("ByteStream.Write", length as u64, call).await?;
    // -1 or the length of the blob: the server had it already, and read no further.
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
