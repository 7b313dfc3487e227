//! Running of an action: looking it up in the server's cache, having a worker run it, and waiting for the end.

use prost::Message;
use tonic::{Code, Status};

use super::api;
use super::client::{Client, MAX_MESSAGE};
use super::digest::Digest;
use super::error::RemoteError;

/// Returns the result of `action` if the server's cache has it.
///
/// # Errors
/// [`RemoteError`].
pub async fn cached_result(action: Digest, client: &Client) -> Result<Option<api::ActionResult>, RemoteError> {
    let mut service = api::ActionCacheClient::new(client.service()).max_decoding_message_size(MAX_MESSAGE);
    let request = api::GetActionResultRequest {
        instance_name: client.instance.clone(),
        action_digest: Some(action.to_api()),
        inline_stdout: true,
        ..api::GetActionResultRequest::default()
    };
    match client.call("GetActionResult", 0, service.get_action_result(request)).await {
        Ok(result) => Ok(Some(result)),
        // Some servers hide their cached results, and some have none.
        Err(RemoteError::Status { code: Code::NotFound | Code::Unimplemented | Code::PermissionDenied, .. }) => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

/// Has a worker run `action`. Calls `running` when a worker begins. If the connection breaks, waits for the same
/// execution.
///
/// # Errors
/// [`RemoteError`], with `NOT_FOUND` if the server lost the execution.
pub async fn execute(
    action: Digest,
    skip_cache_lookup: bool,
    client: &Client,
    running: &(dyn Fn() + Sync),
) -> Result<api::ExecuteResponse, RemoteError> {
    let mut service = api::ExecutionClient::new(client.service()).max_decoding_message_size(MAX_MESSAGE);
    let request = api::ExecuteRequest {
        instance_name: client.instance.clone(),
        skip_cache_lookup,
        action_digest: Some(action.to_api()),
        inline_stdout: true,
        inline_stderr: true,
        ..api::ExecuteRequest::default()
    };
    let failed = |call| move |status: Status| client.error(call, &status);
    let mut stream = service.execute(request).await.map_err(failed("Execute"))?.into_inner();
    let mut attempts = client.attempts();
    let mut name = String::new();
    loop {
        let broken = match stream.message().await {
            Ok(Some(operation)) if operation.done => return response(operation, client),
            Ok(Some(operation)) => {
                if is_running(&operation) {
                    running();
                }
                name = operation.name;
                continue;
            }
            Ok(None) => Status::unavailable("the stream ended before the action"),
            Err(status) => status,
        };
        attempts.after(client.error("Execute", &broken)).await?;
        if name.is_empty() {
            return Err(client.error("Execute", &broken));
        }
        let request = api::WaitExecutionRequest { name: name.clone() };
        stream = match service.wait_execution(request).await {
            Ok(stream) => stream.into_inner(),
            Err(status) if status.code() == Code::Unimplemented => return Err(client.error("Execute", &broken)),
            Err(status) => return Err(client.error("WaitExecution", &status)),
        };
    }
}

fn is_running(operation: &api::Operation) -> bool {
    let metadata = operation.metadata.as_ref().map(|any| api::ExecuteOperationMetadata::decode(any.value.as_slice()));
    let stage = api::execution_stage::Value::Executing as i32;
    metadata.is_some_and(|metadata| metadata.is_ok_and(|metadata| metadata.stage == stage))
}

fn response(operation: api::Operation, client: &Client) -> Result<api::ExecuteResponse, RemoteError> {
    let failed = |status: api::Status| client.error("Execute", &Status::new(status.code.into(), status.message));
    let any = match operation.result {
        Some(api::operation::Result::Response(any)) => any,
        Some(api::operation::Result::Error(status)) => return Err(failed(status)),
        None => return Err(RemoteError::Malformed { expected: "a result", found: "none".to_owned() }),
    };
    let response = api::ExecuteResponse::decode(any.value.as_slice())
        .map_err(|error| RemoteError::Malformed { expected: "an ExecuteResponse", found: error.to_string() })?;
    match response.status.clone() {
        Some(status) if status.code == Code::DeadlineExceeded as i32 => Err(RemoteError::Stopped),
        Some(status) if status.code != 0 => Err(failed(status)),
        _ => Ok(response),
    }
}
