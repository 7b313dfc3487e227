//! The connection to a server: headers, TLS, capabilities of the server, time limits of calls, and counts.

use std::fs;
use std::future::Future;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use prost::Message;
use tokio::sync::{Semaphore, SemaphorePermit};
use tonic::metadata::{Ascii, Binary, MetadataKey, MetadataValue};
use tonic::service::Interceptor;
use tonic::service::interceptor::InterceptedService;
use tonic::transport::{Certificate, Channel, ClientTlsConfig, Endpoint, Identity};
use tonic::{Request, Response, Status};

use super::api;
use super::error::RemoteError;
use super::retry::{Attempts, random_id};
use crate::remote::{Counts, Options};

/// The transport of all calls.
pub type Service = InterceptedService<Channel, Headers>;

/// Longest message that is accepted. Messages of servers are far shorter.
pub const MAX_MESSAGE: usize = 16 << 20;

/// Time limit of a call, to which the time for its bytes is added.
const CALL_TIMEOUT: Duration = Duration::from_secs(60);

/// Slowest accepted connection, in bytes per second.
const MIN_BYTES_PER_SECOND: u64 = 50_000;

/// Most bytes of a batch of blobs if the server names no bound. The limit of gRPC is 4 MiB for a message with its
/// framing.
const MAX_BATCH: u64 = 3 << 20;

/// Memory budget of large blobs in transfer, in MiB, for all actions together.
const MEMORY_BUDGET: u32 = 512;

/// A connection to a server.
pub struct Client {
    service: Service,
    url: String,
    secrets: Vec<String>,
    /// The server's instance.
    pub instance: String,
    /// Most bytes in a batch of blobs.
    pub batch: u64,
    /// Whether blobs are transferred compressed.
    pub is_zstd: bool,
    /// Permits for memory of blobs in transfer, in MiB.
    budget: Semaphore,
    /// Number of further attempts after a failure.
    retries: u32,
    /// Numbers of what was done.
    counts: Mutex<Counts>,
}

impl Client {
    /// Connects and asks for the server's capabilities.
    pub async fn connect(options: &Options) -> Result<Self, RemoteError> {
        let channel = endpoint(options)?.connect_lazy();
        let client = Self {
            service: InterceptedService::new(channel, Headers::new(options)?),
            url: options.url.clone(),
            secrets: options.headers.iter().map(|header| header.value.clone()).collect(),
            instance: options.instance.clone(),
            batch: MAX_BATCH,
            is_zstd: false,
            budget: Semaphore::new(MEMORY_BUDGET as usize),
            retries: options.retries,
            counts: Mutex::default(),
        };
        let found = client.attempts().at(|| client.capabilities()).await?;
        client.with_capabilities(&found)
    }

    async fn capabilities(&self) -> Result<api::ServerCapabilities, RemoteError> {
        let mut client = api::CapabilitiesClient::new(self.service());
        let request = api::GetCapabilitiesRequest { instance_name: self.instance.clone() };
        self.call("GetCapabilities", 0, client.get_capabilities(request)).await
    }

    fn with_capabilities(self, found: &api::ServerCapabilities) -> Result<Self, RemoteError> {
        let sha256 = api::digest_function::Value::Sha256 as i32;
        let (Some(cache), Some(execution)) = (&found.cache_capabilities, &found.execution_capabilities) else {
            return Err(RemoteError::Capabilities {
                expected: "stores blobs and executes actions",
                found: "one that does not".into(),
            });
        };
        if !execution.exec_enabled {
            return Err(RemoteError::Capabilities {
                expected: "executes actions",
                found: "one that stores blobs only".into(),
            });
        }
        let executes = execution.digest_function == sha256 || execution.digest_functions.contains(&sha256);
        if !(executes && cache.digest_functions.contains(&sha256)) {
            return Err(RemoteError::Capabilities {
                expected: "names blobs by SHA-256",
                found: "one with other functions".into(),
            });
        }
        let bound = u64::try_from(cache.max_batch_total_size_bytes).ok().filter(|bound| *bound > 0);
        Ok(Self {
            batch: bound.map_or(MAX_BATCH, |bound| bound.min(MAX_BATCH)),
            is_zstd: cache.supported_compressors.contains(&(api::compressor::Value::Zstd as i32)),
            ..self
        })
    }

    /// Returns as many attempts as the caller allows.
    pub fn attempts(&self) -> Attempts<'_> {
        Attempts::new(self.retries, &self.counts)
    }

    /// Gives `change` access to the counts.
    pub fn count<T>(&self, change: impl FnOnce(&mut Counts) -> T) -> T {
        change(&mut self.counts.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the transport for a generated client.
    pub fn service(&self) -> Service {
        self.service.clone()
    }

    /// Returns the client of the content-addressable storage.
    pub fn storage(&self) -> api::ContentAddressableStorageClient<Service> {
        api::ContentAddressableStorageClient::new(self.service()).max_decoding_message_size(MAX_MESSAGE)
    }

    /// Returns the name of a resource in the server's instance.
    pub fn resource(&self, name: &str) -> String {
        if self.instance.is_empty() { name.to_owned() } else { format!("{}/{name}", self.instance) }
    }

    /// Waits for a permit for `bytes` of memory. A blob larger than the whole budget gets all permits.
    pub async fn budget(&self, bytes: u64) -> Option<SemaphorePermit<'_>> {
        let megabytes = u32::try_from(bytes >> 20).unwrap_or(MEMORY_BUDGET).clamp(1, MEMORY_BUDGET);
        // The semaphore is never closed.
        self.budget.acquire_many(megabytes).await.ok()
    }

    /// Awaits a call that transfers `bytes`.
    pub async fn call<T>(
        &self,
        name: &'static str,
        bytes: u64,
        call: impl Future<Output = Result<Response<T>, Status>>,
    ) -> Result<T, RemoteError> {
        self.within(name, bytes, async { call.await.map(Response::into_inner) }).await
    }

    /// Awaits a stream or a call that transfers `bytes`, within its time limit.
    pub async fn within<T>(
        &self,
        name: &'static str,
        bytes: u64,
        call: impl Future<Output = Result<T, Status>>,
    ) -> Result<T, RemoteError> {
        let limit = CALL_TIMEOUT + Duration::from_secs(bytes / MIN_BYTES_PER_SECOND);
        let late = |_| Status::deadline_exceeded(format!("no answer within {} s", limit.as_secs()));
        let result = tokio::time::timeout(limit, call).await.map_err(late).flatten();
        result.map_err(|status| self.error(name, &status))
    }

    /// Returns the error of a status: of the connection, or of the server's refusal. Values of headers are removed.
    pub fn error(&self, call: &'static str, status: &Status) -> RemoteError {
        if let Some(error) = std::error::Error::source(status) {
            // The innermost cause is the reason.
            let causes = std::iter::successors(Some(error), |error| error.source());
            let reason = causes.last().unwrap_or(error).to_string();
            return RemoteError::Unreachable { url: self.url.clone(), reason };
        }
        let hidden = |text: String, secret: &String| text.replace(secret.as_str(), "...");
        let secrets = self.secrets.iter().filter(|secret| !secret.is_empty());
        let message = secrets.fold(status.message().to_owned(), hidden);
        RemoteError::Status { call, code: status.code(), message: message.chars().take(500).collect() }
    }
}

fn endpoint(options: &Options) -> Result<Endpoint, RemoteError> {
    let wrong =
        |reason: String| RemoteError::Options(format!("{}: expected grpc://host:port, found {reason}", options.url));
    if options.url.contains('@') {
        let reason =
            "--remote: expected grpc://host:port, found a user or a password in it; --remote-header-file is for them";
        return Err(RemoteError::Options(reason.to_owned()));
    }
    let (scheme, rest) = options.url.split_once("://").ok_or_else(|| wrong("no scheme".into()))?;
    let is_tls = match scheme {
        "grpc" => false,
        "grpcs" => true,
        other => return Err(wrong(format!("{other}://"))),
    };
    let url = format!("{}://{rest}", if is_tls { "https" } else { "http" });
    let endpoint = Endpoint::from_shared(url).map_err(|error| wrong(error.to_string()))?;
    let endpoint = endpoint.connect_timeout(Duration::from_secs(10)).tcp_keepalive(Some(Duration::from_secs(30)));
    if is_tls { endpoint.tls_config(tls(options)?).map_err(|e| wrong(e.to_string())) } else { Ok(endpoint) }
}

fn tls(options: &Options) -> Result<ClientTlsConfig, RemoteError> {
    let read =
        |path: &Path| fs::read(path).map_err(|error| RemoteError::Read { path: path.to_owned(), error: error.into() });
    let tls = ClientTlsConfig::new();
    let mut tls = match &options.tls.authority {
        Some(path) => tls.ca_certificate(Certificate::from_pem(read(path)?)),
        None => tls.with_native_roots(),
    };
    if let Some((certificate, key)) = &options.tls.identity {
        tls = tls.identity(Identity::from_pem(read(certificate)?, read(key)?));
    }
    Ok(tls)
}

/// Headers of every call.
#[derive(Clone)]
pub struct Headers {
    named: Arc<[(MetadataKey<Ascii>, MetadataValue<Ascii>)]>,
    about: MetadataValue<Binary>,
}

impl Headers {
    fn new(options: &Options) -> Result<Self, RemoteError> {
        let mut named = Vec::with_capacity(options.headers.len());
        for header in &options.headers {
            let name = header.name.parse::<MetadataKey<Ascii>>();
            let value = header.value.parse::<MetadataValue<Ascii>>();
            let (Ok(name), Ok(mut value)) = (name, value) else {
                let reason = format!("--remote-header {}: expected a header of gRPC, found none", header.name);
                return Err(RemoteError::Options(reason));
            };
            value.set_sensitive(true);
            named.push((name, value));
        }
        // Servers show these details to users who look for what is running.
        let tool =
            api::ToolDetails { tool_name: "roughcast".to_owned(), tool_version: env!("CARGO_PKG_VERSION").to_owned() };
        let about = api::RequestMetadata {
            tool_details: Some(tool),
            tool_invocation_id: random_id(),
            ..api::RequestMetadata::default()
        };
        Ok(Self { named: named.into(), about: MetadataValue::from_bytes(&about.encode_to_vec()) })
    }
}

impl Interceptor for Headers {
    fn call(&mut self, mut request: Request<()>) -> Result<Request<()>, Status> {
        let metadata = request.metadata_mut();
        for (name, value) in self.named.iter() {
            metadata.append(name.clone(), value.clone());
        }
        metadata.insert_bin("build.bazel.remote.execution.v2.requestmetadata-bin", self.about.clone());
        Ok(request)
    }
}
