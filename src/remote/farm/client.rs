//! The connection: headers, TLS, what the server can do, how long a call may take, and what was done through it.

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
use super::retry::{Attempts, random};
use crate::remote::{Counts, Options};

/// What calls go through.
pub type Service = InterceptedService<Channel, Headers>;

/// The longest message: what servers send in one piece is far below.
pub const MAX_MESSAGE: usize = 16 << 20;

/// What a call may take besides the time for its bytes.
const PATIENCE: Duration = Duration::from_secs(60);

/// The slowest connection that is waited for, in bytes per second.
const SLOWEST: u64 = 50_000;

/// What one message may hold where the server names no bound: gRPC's own is 4 MiB, of which some is framing.
const BATCH: u64 = 3 << 20;

/// The most memory for large blobs on their way, in MiB, however many actions there are at a time.
const ROOM: u32 = 512;

/// A connection.
pub struct Client {
    service: Service,
    url: String,
    secrets: Vec<String>,
    /// Instance of the server.
    pub instance: String,
    /// The most bytes in a batch of blobs.
    pub batch: u64,
    /// Whether blobs go compressed.
    pub is_zstd: bool,
    /// MiB that blobs on their way may take.
    budget: Semaphore,
    /// How often something is tried again.
    retries: u32,
    /// What was done.
    counts: Mutex<Counts>,
}

impl Client {
    /// Connects and asks what the server can do.
    pub async fn connect(options: &Options) -> Result<Self, RemoteError> {
        let channel = endpoint(options)?.connect_lazy();
        let client = Self {
            service: InterceptedService::new(channel, Headers::new(options)?),
            url: options.url.clone(),
            secrets: options.headers.iter().map(|header| header.value.clone()).collect(),
            instance: options.instance.clone(),
            batch: BATCH,
            is_zstd: false,
            budget: Semaphore::new(ROOM as usize),
            retries: options.retries,
            counts: Mutex::default(),
        };
        let found = client.attempts().at(|| client.capabilities()).await?;
        client.with(&found)
    }

    async fn capabilities(&self) -> Result<api::ServerCapabilities, RemoteError> {
        let mut client = api::CapabilitiesClient::new(self.service());
        let request = api::GetCapabilitiesRequest { instance_name: self.instance.clone() };
        self.call("GetCapabilities", 0, client.get_capabilities(request)).await
    }

    fn with(self, found: &api::ServerCapabilities) -> Result<Self, RemoteError> {
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
            batch: bound.map_or(BATCH, |bound| bound.min(BATCH)),
            is_zstd: cache.supported_compressors.contains(&(api::compressor::Value::Zstd as i32)),
            ..self
        })
    }

    /// Attempts at something, as many as the caller allows.
    pub fn attempts(&self) -> Attempts<'_> {
        Attempts::new(self.retries, &self.counts)
    }

    /// Gives `change` the numbers of what was done, to be added to or read.
    pub fn count<T>(&self, change: impl FnOnce(&mut Counts) -> T) -> T {
        change(&mut self.counts.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// What a generated client takes.
    pub fn service(&self) -> Service {
        self.service.clone()
    }

    /// The client of blobs.
    pub fn storage(&self) -> api::ContentAddressableStorageClient<Service> {
        api::ContentAddressableStorageClient::new(self.service()).max_decoding_message_size(MAX_MESSAGE)
    }

    /// The name of something in the server's instance.
    pub fn resource(&self, name: &str) -> String {
        if self.instance.is_empty() { name.to_owned() } else { format!("{}/{name}", self.instance) }
    }

    /// Waits until there is memory for `bytes`, or for the one blob that is larger than all of it.
    pub async fn budget(&self, bytes: u64) -> Option<SemaphorePermit<'_>> {
        let megabytes = u32::try_from(bytes >> 20).unwrap_or(ROOM).clamp(1, ROOM);
        // Never closed.
        self.budget.acquire_many(megabytes).await.ok()
    }

    /// Awaits a call that moves `bytes`.
    pub async fn call<T>(
        &self,
        name: &'static str,
        bytes: u64,
        call: impl Future<Output = Result<Response<T>, Status>>,
    ) -> Result<T, RemoteError> {
        self.within(name, bytes, async { call.await.map(Response::into_inner) }).await
    }

    /// Awaits something that moves `bytes`.
    pub async fn within<T>(
        &self,
        name: &'static str,
        bytes: u64,
        call: impl Future<Output = Result<T, Status>>,
    ) -> Result<T, RemoteError> {
        let limit = PATIENCE + Duration::from_secs(bytes / SLOWEST);
        let late = |_| Status::deadline_exceeded(format!("no answer within {} s", limit.as_secs()));
        let result = tokio::time::timeout(limit, call).await.map_err(late).flatten();
        result.map_err(|status| self.error(name, &status))
    }

    /// What a status tells, without the values of headers: of the connection, or of the server's refusal.
    pub fn error(&self, call: &'static str, status: &Status) -> RemoteError {
        if let Some(error) = std::error::Error::source(status) {
            // The innermost says why.
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
    let mut tls = ClientTlsConfig::new();
    tls = match &options.tls.authority {
        Some(path) => tls.ca_certificate(Certificate::from_pem(read(path)?)),
        None => tls.with_native_roots(),
    };
    if let Some((certificate, key)) = &options.tls.identity {
        tls = tls.identity(Identity::from_pem(read(certificate)?, read(key)?));
    }
    Ok(tls)
}

/// Headers that every call carries.
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
        // Servers show these to those who look for what is running.
        let tool =
            api::ToolDetails { tool_name: "roughcast".to_owned(), tool_version: env!("CARGO_PKG_VERSION").to_owned() };
        let invocation = format!("{:016x}{:016x}", random(), random());
        let about = api::RequestMetadata {
            tool_details: Some(tool),
            tool_invocation_id: invocation,
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
