//! A fake server of the API in this process. It keeps everything in memory, runs actions in temporary folders without a
//! sandbox, and has the faults that a test chooses.

use std::collections::HashMap;
use std::fs;
use std::net::{SocketAddr, TcpListener};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;

use bazel_remote_apis::build::bazel::remote::execution::v2 as re;
use bazel_remote_apis::google::bytestream::byte_stream_server::ByteStreamServer;
use bazel_remote_apis::google::longrunning::Operation;
use prost::Message;
use re::action_cache_server::ActionCacheServer;
use re::capabilities_server::CapabilitiesServer;
use re::content_addressable_storage_server::ContentAddressableStorageServer;
use re::execution_server::ExecutionServer;
use sha2::{Digest as _, Sha256};
use tokio::sync::oneshot;
use tonic::Status;
use tonic::transport::Server;

/// Faults of a server, and how often they occur.
#[derive(Default)]
pub struct Faults {
    /// Calls that fail with UNAVAILABLE, by name, and how often.
    pub unavailable: HashMap<&'static str, u32>,
    /// Number of executions whose stream breaks after the first message.
    pub broken: u32,
    /// Number of executions whose stream breaks and that the server forgets.
    pub lost: u32,
    /// Number of executions before which all blobs are removed.
    pub evicted: u32,
    /// Changes results of executions.
    pub result: Option<fn(&State, re::ActionResult) -> re::ActionResult>,
    /// Changes blobs that are read.
    pub read: Option<fn(Vec<u8>) -> Vec<u8>>,
    /// Header that every call needs.
    pub header: Option<(&'static str, &'static str)>,
    /// Changes the capabilities that the server reports.
    pub capabilities: Option<fn(&mut re::ServerCapabilities)>,
}

/// Data and counters of a server.
#[derive(Default)]
pub struct State {
    pub blobs: Mutex<HashMap<String, Vec<u8>>>,
    pub actions: Mutex<HashMap<String, re::ActionResult>>,
    pub faults: Mutex<Faults>,
    /// Finished executions, by name.
    pub operations: Mutex<HashMap<String, Operation>>,
    /// Number of times that each call was made, and that each blob was written.
    pub calls: Mutex<HashMap<String, u32>>,
}

/// A server, which stops when it is dropped.
pub struct Fake {
    pub state: Arc<State>,
    pub address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Fake {
    /// Starts a server on a free port.
    pub fn start() -> Self {
        Self::start_as(Server::builder())
    }

    /// Starts a server from `builder`.
    pub fn start_as(builder: Server) -> Self {
        let state = Arc::new(State::default());
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        listener.set_nonblocking(true).expect("a socket");
        let address = listener.local_addr().expect("an address");
        let (stop, stopped) = oneshot::channel();
        let serving = Arc::clone(&state);
        let thread = thread::spawn(move || {
            let mut threads = tokio::runtime::Builder::new_multi_thread();
            let runtime = threads.worker_threads(2).enable_all().build().expect("a runtime");
            runtime.block_on(async {
                let listener = tokio::net::TcpListener::from_std(listener).expect("a socket");
                let incoming = tonic::transport::server::TcpIncoming::from(listener);
                let mut builder = builder;
                let server = builder
                    .add_service(CapabilitiesServer::from_arc(Arc::clone(&serving)))
                    .add_service(ActionCacheServer::from_arc(Arc::clone(&serving)))
                    .add_service(
                        ContentAddressableStorageServer::from_arc(Arc::clone(&serving))
                            .max_decoding_message_size(16 << 20),
                    )
                    .add_service(ExecutionServer::from_arc(Arc::clone(&serving)))
                    .add_service(ByteStreamServer::from_arc(serving));
                let ended = async {
                    let _ = stopped.await;
                };
                server.serve_with_incoming_shutdown(incoming, ended).await.expect("a server");
            });
        });
        Self { state, address, stop: Some(stop), thread: Some(thread) }
    }

    /// Returns the URL of the server.
    pub fn url(&self) -> String {
        format!("grpc://{}", self.address)
    }

    /// Returns how often `call` was made.
    pub fn calls(&self, call: &str) -> u32 {
        self.state.calls.lock().expect("calls").get(call).copied().unwrap_or(0)
    }

    /// Returns the faults of the server for changes.
    pub fn faults(&self) -> MutexGuard<'_, Faults> {
        self.state.faults.lock().expect("faults")
    }
}

impl Drop for Fake {
    fn drop(&mut self) {
        drop(self.stop.take());
        let ended = self.thread.take().map(thread::JoinHandle::join);
        assert!(ended.is_none_or(|ended| ended.is_ok()) || thread::panicking(), "the server panicked");
    }
}

/// Returns the digest of `bytes` in the API's form.
pub fn digest(bytes: &[u8]) -> re::Digest {
    let hash = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    re::Digest { hash, size_bytes: bytes.len() as i64 }
}

impl State {
    /// Counts a call, and returns an error if a fault requires one.
    pub fn call<T>(&self, name: &'static str, request: &tonic::Request<T>) -> Result<(), Status> {
        *self.calls.lock().expect("calls").entry(name.to_owned()).or_default() += 1;
        let mut faults = self.faults.lock().expect("faults");
        if let Some((header, value)) = faults.header {
            let found = request.metadata().get(header).and_then(|found| found.to_str().ok()).unwrap_or("nothing");
            if found != value {
                return Err(Status::unauthenticated(format!("{header} is {found}")));
            }
        }
        match faults.unavailable.get_mut(name) {
            Some(left) if *left > 0 => {
                *left -= 1;
                Err(Status::unavailable("made to fail"))
            }
            _ => Ok(()),
        }
    }

    /// Stores a blob.
    pub fn put(&self, bytes: Vec<u8>) -> re::Digest {
        let digest = digest(&bytes);
        self.blobs.lock().expect("blobs").insert(digest.hash.clone(), bytes);
        digest
    }

    /// Returns a blob.
    pub fn get(&self, hash: &str) -> Option<Vec<u8>> {
        self.blobs.lock().expect("blobs").get(hash).cloned()
    }

    /// Returns a blob that an execution needs.
    fn input(&self, digest: Option<&re::Digest>) -> Result<Vec<u8>, Status> {
        let found = digest.and_then(|digest| self.get(&digest.hash));
        found.ok_or_else(|| Status::failed_precondition("a blob is missing"))
    }

    fn message<M: Message + Default>(&self, digest: Option<&re::Digest>) -> Result<M, Status> {
        M::decode(self.input(digest)?.as_slice()).map_err(|error| Status::invalid_argument(error.to_string()))
    }

    /// Runs an action.
    pub fn run(&self, action: &re::Digest) -> Result<re::ActionResult, Status> {
        let action: re::Action = self.message(Some(action))?;
        let command: re::Command = self.message(action.command_digest.as_ref())?;
        let folder = tempfile::tempdir().expect("a folder");
        self.stage(action.input_root_digest.as_ref(), folder.path())?;
        let mut words = command.arguments.iter();
        let mut process = Command::new(folder.path().join(words.next().expect("a tool")));
        let output = process.args(words).current_dir(folder.path()).env_clear().output().expect("the tool runs");
        let mut result = re::ActionResult {
            exit_code: output.status.code().unwrap_or(137),
            stdout_raw: output.stdout,
            stderr_raw: output.stderr,
            ..re::ActionResult::default()
        };
        for path in &command.output_paths {
            if folder.path().join(path).is_dir() {
                let mut children = Vec::new();
                let root = self.capture(&folder.path().join(path), &mut children);
                let tree = re::Tree { root: Some(root), children };
                let tree_digest = Some(self.put(tree.encode_to_vec()));
                result.output_directories.push(re::OutputDirectory {
                    path: path.clone(),
                    tree_digest,
                    ..re::OutputDirectory::default()
                });
            }
        }
        Ok(result)
    }

    fn stage(&self, folder: Option<&re::Digest>, to: &Path) -> Result<(), Status> {
        let folder: re::Directory = self.message(folder)?;
        fs::create_dir_all(to).expect("a folder");
        for file in &folder.files {
            fs::write(to.join(&file.name), self.input(file.digest.as_ref())?).expect("a file");
            if file.is_executable {
                fs::set_permissions(to.join(&file.name), fs::Permissions::from_mode(0o755)).expect("a file");
            }
        }
        folder.directories.iter().try_for_each(|below| self.stage(below.digest.as_ref(), &to.join(&below.name)))
    }

    fn capture(&self, from: &Path, children: &mut Vec<re::Directory>) -> re::Directory {
        let mut entries: Vec<_> = fs::read_dir(from).expect("a folder").map(|entry| entry.expect("an entry")).collect();
        entries.sort_by_key(fs::DirEntry::file_name);
        let mut folder = re::Directory::default();
        for entry in entries {
            let name = entry.file_name().into_string().expect("a name");
            if entry.path().is_dir() {
                let child = self.capture(&entry.path(), children);
                let digest = Some(digest(&child.encode_to_vec()));
                children.push(child);
                folder.directories.push(re::DirectoryNode { name, digest });
            } else {
                let digest = Some(self.put(fs::read(entry.path()).expect("a file")));
                folder.files.push(re::FileNode { name, digest, ..re::FileNode::default() });
            }
        }
        folder
    }
}
