//! The services of the API of the fake server.

use bazel_remote_apis::build::bazel::remote::execution::v2 as re;
use bazel_remote_apis::google::bytestream::byte_stream_server::ByteStream;
use bazel_remote_apis::google::bytestream::{
    QueryWriteStatusRequest, QueryWriteStatusResponse, ReadRequest, ReadResponse, WriteRequest, WriteResponse,
};
use bazel_remote_apis::google::longrunning::{Operation, operation};
use bazel_remote_apis::google::protobuf::Any;
use bazel_remote_apis::google::rpc;
use prost::Message;
use tokio_stream::{Empty, Iter};
use tonic::{Request, Response, Status, Streaming, async_trait};

use super::fake::{Faults, State};

type Answer<T> = Result<Response<T>, Status>;

/// A stream of messages that are all known from the start.
type Known<T> = Iter<std::vec::IntoIter<Result<T, Status>>>;

fn known<T>(messages: Vec<Result<T, Status>>) -> Answer<Known<T>> {
    Ok(Response::new(tokio_stream::iter(messages)))
}

#[async_trait]
impl re::capabilities_server::Capabilities for State {
    async fn get_capabilities(&self, request: Request<re::GetCapabilitiesRequest>) -> Answer<re::ServerCapabilities> {
        self.call("GetCapabilities", &request)?;
        let sha256 = re::digest_function::Value::Sha256 as i32;
        let mut capabilities = re::ServerCapabilities {
            cache_capabilities: Some(re::CacheCapabilities {
                digest_functions: vec![sha256],
                max_batch_total_size_bytes: 1 << 20,
                ..re::CacheCapabilities::default()
            }),
            execution_capabilities: Some(re::ExecutionCapabilities {
                digest_function: sha256,
                exec_enabled: true,
                ..re::ExecutionCapabilities::default()
            }),
            ..re::ServerCapabilities::default()
        };
        if let Some(change) = self.faults.lock().expect("faults").capabilities {
            change(&mut capabilities);
        }
        Ok(Response::new(capabilities))
    }
}

#[async_trait]
impl re::action_cache_server::ActionCache for State {
    async fn get_action_result(&self, request: Request<re::GetActionResultRequest>) -> Answer<re::ActionResult> {
        self.call("GetActionResult", &request)?;
        let digest = request.into_inner().action_digest.unwrap_or_default();
        let known = self.actions.lock().expect("actions").get(&digest.hash).cloned();
        known.map(Response::new).ok_or_else(|| Status::not_found("no result"))
    }

    async fn update_action_result(&self, _: Request<re::UpdateActionResultRequest>) -> Answer<re::ActionResult> {
        Err(Status::unimplemented("not for clients"))
    }
}

#[async_trait]
impl re::content_addressable_storage_server::ContentAddressableStorage for State {
    type GetTreeStream = Empty<Result<re::GetTreeResponse, Status>>;
    type GetChunkMappingStream = Empty<Result<re::GetChunkMappingResponse, Status>>;

    async fn find_missing_blobs(
        &self,
        request: Request<re::FindMissingBlobsRequest>,
    ) -> Answer<re::FindMissingBlobsResponse> {
        self.call("FindMissingBlobs", &request)?;
        let blobs = self.blobs.lock().expect("blobs");
        let mut missing_blob_digests = request.into_inner().blob_digests;
        missing_blob_digests.retain(|digest| !blobs.contains_key(&digest.hash));
        Ok(Response::new(re::FindMissingBlobsResponse { missing_blob_digests }))
    }

    async fn batch_update_blobs(
        &self,
        request: Request<re::BatchUpdateBlobsRequest>,
    ) -> Answer<re::BatchUpdateBlobsResponse> {
        self.call("BatchUpdateBlobs", &request)?;
        let stored = request.into_inner().requests.into_iter().map(|blob| {
            let digest = self.store_written(blob.data);
            let is_right = blob.digest.as_ref() == Some(&digest);
            let code = if is_right { 0 } else { tonic::Code::InvalidArgument as i32 };
            re::batch_update_blobs_response::Response {
                digest: blob.digest,
                status: Some(rpc::Status { code, ..rpc::Status::default() }),
            }
        });
        Ok(Response::new(re::BatchUpdateBlobsResponse { responses: stored.collect() }))
    }

    async fn batch_read_blobs(
        &self,
        request: Request<re::BatchReadBlobsRequest>,
    ) -> Answer<re::BatchReadBlobsResponse> {
        self.call("BatchReadBlobs", &request)?;
        let responses = request.into_inner().digests.into_iter().map(|digest| {
            let data = self.read_blob(&digest.hash);
            let code = if data.is_some() { 0 } else { tonic::Code::NotFound as i32 };
            re::batch_read_blobs_response::Response {
                digest: Some(digest),
                data: data.unwrap_or_default(),
                status: Some(rpc::Status { code, ..rpc::Status::default() }),
                ..re::batch_read_blobs_response::Response::default()
            }
        });
        Ok(Response::new(re::BatchReadBlobsResponse { responses: responses.collect() }))
    }

    async fn get_tree(&self, _: Request<re::GetTreeRequest>) -> Answer<Self::GetTreeStream> {
        Err(Status::unimplemented("not asked for"))
    }

    async fn split_blob(&self, _: Request<re::SplitBlobRequest>) -> Answer<re::SplitBlobResponse> {
        Err(Status::unimplemented("not asked for"))
    }

    async fn splice_blob(&self, _: Request<re::SpliceBlobRequest>) -> Answer<re::SpliceBlobResponse> {
        Err(Status::unimplemented("not asked for"))
    }

    async fn get_chunk_mapping(&self, _: Request<re::GetChunkMappingRequest>) -> Answer<Self::GetChunkMappingStream> {
        Err(Status::unimplemented("not asked for"))
    }

    async fn register_chunk_mapping(
        &self,
        _: Request<Streaming<re::RegisterChunkMappingRequest>>,
    ) -> Answer<re::RegisterChunkMappingResponse> {
        Err(Status::unimplemented("not asked for"))
    }
}

#[async_trait]
impl ByteStream for State {
    type ReadStream = Known<ReadResponse>;

    async fn read(&self, request: Request<ReadRequest>) -> Answer<Self::ReadStream> {
        self.call("ByteStream.Read", &request)?;
        let name = request.into_inner().resource_name;
        let hash = name.rsplit('/').nth(1).unwrap_or_default();
        let mut bytes = self.read_blob(hash).ok_or_else(|| Status::not_found("no blob"))?;
        if name.contains("compressed-blobs/zstd/") {
            bytes = zstd::bulk::compress(&bytes, 1).expect("zstd");
        }
        known(bytes.chunks(1 << 20).map(|piece| Ok(ReadResponse { data: piece.to_vec() })).collect())
    }

    async fn write(&self, request: Request<Streaming<WriteRequest>>) -> Answer<WriteResponse> {
        self.call("ByteStream.Write", &request)?;
        let mut stream = request.into_inner();
        let (mut name, mut bytes) = (String::new(), Vec::new());
        while let Some(piece) = stream.message().await? {
            if name.is_empty() {
                name = piece.resource_name;
            }
            bytes.extend(piece.data);
        }
        let committed_size = bytes.len() as i64;
        if name.contains("compressed-blobs/zstd/") {
            bytes = zstd::stream::decode_all(bytes.as_slice()).expect("zstd");
        }
        let hash = name.rsplit('/').nth(1).unwrap_or_default().to_owned();
        if self.store_written(bytes).hash == hash {
            Ok(Response::new(WriteResponse { committed_size }))
        } else {
            Err(Status::invalid_argument("another digest"))
        }
    }

    async fn query_write_status(&self, _: Request<QueryWriteStatusRequest>) -> Answer<QueryWriteStatusResponse> {
        Err(Status::unimplemented("not asked for"))
    }
}

#[async_trait]
impl re::execution_server::Execution for State {
    type ExecuteStream = Known<Operation>;
    type WaitExecutionStream = Known<Operation>;

    async fn execute(&self, request: Request<re::ExecuteRequest>) -> Answer<Self::ExecuteStream> {
        self.call("Execute", &request)?;
        let request = request.into_inner();
        let digest = request.action_digest.unwrap_or_default();
        let name = format!("operations/{}", digest.hash);
        let queued = Operation { name: name.clone(), ..Operation::default() };
        let broken = || known(vec![Ok(queued.clone()), Err(Status::unavailable("the connection broke"))]);
        let (is_lost, is_broken, is_evicted) = {
            let mut faults = self.faults.lock().expect("faults");
            let mut once = |left: fn(&mut Faults) -> &mut u32| {
                let left = left(&mut faults);
                let is_due = *left > 0;
                *left -= u32::from(is_due);
                is_due
            };
            (once(|faults| &mut faults.lost), once(|faults| &mut faults.broken), once(|faults| &mut faults.evicted))
        };
        if is_lost {
            return broken();
        }
        if is_evicted {
            self.blobs.lock().expect("blobs").clear();
        }
        let change = self.faults.lock().expect("faults").result.unwrap_or(|_, result| result);
        let response = match tokio::task::block_in_place(|| self.run(&digest)) {
            Err(status) => re::ExecuteResponse {
                status: Some(rpc::Status {
                    code: status.code() as i32,
                    message: status.message().to_owned(),
                    ..rpc::Status::default()
                }),
                ..re::ExecuteResponse::default()
            },
            Ok(result) => {
                let result = change(self, result);
                if result.exit_code == 0 {
                    self.actions.lock().expect("actions").insert(digest.hash.clone(), result.clone());
                }
                re::ExecuteResponse { result: Some(result), ..re::ExecuteResponse::default() }
            }
        };
        let any = Any { type_url: "type.googleapis.com/ExecuteResponse".to_owned(), value: response.encode_to_vec() };
        let done =
            Operation { name, done: true, result: Some(operation::Result::Response(any)), ..Operation::default() };
        self.operations.lock().expect("operations").insert(done.name.clone(), done.clone());
        if is_broken { broken() } else { known(vec![Ok(queued), Ok(done)]) }
    }

    async fn wait_execution(&self, request: Request<re::WaitExecutionRequest>) -> Answer<Self::WaitExecutionStream> {
        self.call("WaitExecution", &request)?;
        let done = self.operations.lock().expect("operations").get(&request.into_inner().name).cloned();
        known(vec![Ok(done.ok_or_else(|| Status::not_found("no such operation"))?)])
    }
}

impl State {
    /// Stores a blob that a client writes, and counts the write.
    fn store_written(&self, bytes: Vec<u8>) -> re::Digest {
        let digest = self.put(bytes);
        *self.calls.lock().expect("calls").entry(digest.hash.clone()).or_default() += 1;
        digest
    }

    /// Returns a blob that a client reads, with the fault `read`.
    fn read_blob(&self, hash: &str) -> Option<Vec<u8>> {
        let change = self.faults.lock().expect("faults").read.unwrap_or(|bytes| bytes);
        self.get(hash).map(change)
    }
}
