//! The generated messages and clients under short names.

pub use bazel_remote_apis::build::bazel::remote::execution::v2::{
    Action, ActionResult, BatchReadBlobsRequest, BatchUpdateBlobsRequest, Command, Digest, Directory, DirectoryNode,
    ExecuteOperationMetadata, ExecuteRequest, ExecuteResponse, FileNode, FindMissingBlobsRequest,
    GetActionResultRequest, GetCapabilitiesRequest, Platform, RequestMetadata, ServerCapabilities, ToolDetails, Tree,
    WaitExecutionRequest, batch_update_blobs_request, compressor, digest_function, execution_stage, platform,
};
pub use bazel_remote_apis::build::bazel::remote::execution::v2::{
    action_cache_client::ActionCacheClient, capabilities_client::CapabilitiesClient,
    content_addressable_storage_client::ContentAddressableStorageClient, execution_client::ExecutionClient,
};
pub use bazel_remote_apis::google::bytestream::byte_stream_client::ByteStreamClient;
pub use bazel_remote_apis::google::bytestream::{ReadRequest, WriteRequest};
pub use bazel_remote_apis::google::longrunning::{Operation, operation};
pub use bazel_remote_apis::google::protobuf::Duration;
pub use bazel_remote_apis::google::rpc::Status;
