//! moto's S3 server on the loopback interface, with a minimal HTTP client for its buckets.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::ports::free_port;
use super::skip::missing_tool;

/// URL of the cache in every test. Each test has its own server.
pub const URL: &str = "s3://bucket/some/prefix";

pub struct Moto {
    server: Child,
    port: u16,
}

impl Moto {
    /// Starts a server with an empty bucket. Returns `None` if moto is not installed.
    pub fn start() -> Option<Self> {
        let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/object-store/venv/bin/moto_server");
        if !tool.is_file() {
            missing_tool("tests of shared caches need `bash tools/object-store/install`");
            return None;
        }
        let port = free_port();
        let mut command = Command::new(tool);
        command.args(["-H", "127.0.0.1", "-p", &port.to_string()]).stdout(Stdio::null()).stderr(Stdio::null());
        let server = Self { server: command.spawn().expect("moto starts"), port };
        let start = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(start.elapsed() < Duration::from_secs(120), "moto does not answer");
            sleep(Duration::from_millis(50));
        }
        server.request("PUT", "", b"");
        Some(server)
    }

    pub fn endpoint(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    /// Returns the names of all objects below `some/prefix/<kind>`.
    pub fn objects(&self, kind: &str) -> Vec<String> {
        let list = self.request("GET", &format!("?list-type=2&prefix=some/prefix/{kind}/"), b"");
        let list = String::from_utf8(list).expect("XML");
        let keys = list.split("<Key>").skip(1);
        keys.map(|rest| rest.split('<').next().expect("a name").to_owned()).collect()
    }

    pub fn get(&self, object: &str) -> Vec<u8> {
        self.request("GET", &format!("/{object}"), b"")
    }

    pub fn put(&self, object: &str, bytes: &[u8]) {
        self.request("PUT", &format!("/{object}"), bytes);
    }

    /// Kills the server.
    pub fn kill(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }

    /// Sends a request and returns the body of the answer. moto requires a signature but does not check it.
    fn request(&self, method: &str, path: &str, body: &[u8]) -> Vec<u8> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("moto answers");
        let head = format!(
            "{method} /bucket{path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Length: {}\r\nConnection: close\r\n\
             Authorization: AWS4-HMAC-SHA256 Credential=key/20260101/us-east-1/s3/aws4_request, SignedHeaders=host, \
             Signature=0\r\n\r\n",
            self.port,
            body.len()
        );
        stream.write_all(&[head.as_bytes(), body].concat()).expect("moto reads");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("moto writes");
        assert!(answer.starts_with(b"HTTP/1.1 200"), "{method} {path}: {}", String::from_utf8_lossy(&answer));
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").expect("a header");
        answer.split_off(end + 4)
    }
}

impl Drop for Moto {
    fn drop(&mut self) {
        self.kill();
    }
}
