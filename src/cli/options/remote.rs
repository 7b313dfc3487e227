//! Options of baking on a server.

use std::collections::BTreeMap;
use std::env;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::project::{NamedServer, RemoteValues};
use crate::remote::{Header, Options, Tls};

/// The variable with headers, one in each line.
const HEADERS: &str = "ROUGHCAST_REMOTE_HEADER";

/// The most actions at a time. Each action has a thread, which waits.
const MOST_JOBS: u32 = 4096;

/// Where jobs are run.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Remote options")]
pub struct RemoteOptions {
    /// Bake on workers of this server of the Remote Execution API v2: grpc://HOST:PORT, or grpcs:// with TLS. Jobs that
    /// --cache has are not sent. [default: `url` of [remote] in the roughcast.toml of the first input, if this file is
    /// in the working folder or --config names it. The file may set the other options, too]
    #[arg(long, value_name = "URL")]
    remote: Option<String>,
    /// Bake on this machine, even if roughcast.toml names a server.
    #[arg(long, conflicts_with = "remote")]
    no_remote: bool,
    /// Instance of the server.
    #[arg(long, value_name = "NAME", requires = "remote")]
    remote_instance: Option<String>,
    /// A property that workers must have, such as OSFamily=linux. May be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, requires = "remote")]
    remote_platform: Vec<(String, String)>,
    /// A header of every call, such as authorization=... May be given several times. Other users can see command lines,
    /// so prefer --remote-header-file, or the variable ROUGHCAST_REMOTE_HEADER with one header in each line.
    #[arg(long, value_name = "NAME=VALUE", requires = "remote")]
    remote_header: Vec<Secret>,
    /// A file with one header in each line.
    #[arg(long, value_name = "FILE", requires = "remote")]
    remote_header_file: Option<PathBuf>,
    /// Certificates (PEM) that sign the certificate of the server, instead of those of the system.
    #[arg(long, value_name = "FILE", requires = "remote")]
    remote_ca: Option<PathBuf>,
    /// Certificate (PEM) by which the server knows the caller.
    #[arg(long, value_name = "FILE", requires_all = ["remote", "remote_key"])]
    remote_cert: Option<PathBuf>,
    /// Key (PEM) of that certificate.
    #[arg(long, value_name = "FILE", requires_all = ["remote", "remote_cert"])]
    remote_key: Option<PathBuf>,
    /// The most actions at a time. [default: 64]
    #[arg(long, value_name = "N", requires = "remote",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_JOBS)))]
    remote_jobs: Option<u32>,
    /// The longest time of an action, from its upload to its result. The server gets it as the limit of the execution.
    /// [default: the limit of the server, and an hour]
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..), requires = "remote")]
    remote_timeout: Option<u64>,
    /// How often a call is repeated after an error that may pass, with growing pauses: 8 times take half a minute.
    /// [default: 8]
    #[arg(long, value_name = "N", requires = "remote")]
    remote_retries: Option<u32>,
    /// The tool that workers run: a static build of this version for their system. [default: the running tool]
    #[arg(long, value_name = "FILE", requires = "remote")]
    remote_tool: Option<PathBuf>,
}

/// A text that is never shown.
#[derive(Clone)]
struct Secret(String);

impl From<String> for Secret {
    fn from(text: String) -> Self {
        Self(text)
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("...")
    }
}

/// Why the options cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RemoteOptionError {
    /// A line that is no header. The line may be a secret.
    #[error("{origin}: expected NAME=VALUE, found a line without a name (not shown, it may be a secret); correct it")]
    Header {
        /// The file, variable or flag of the line.
        origin: String,
    },
    /// A file that cannot be read.
    #[error("--remote-header-file: expected a readable file at {}, found: {error}; check the path", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: std::io::Error,
    },
    /// A server that a configuration beside the assets names. The assets may be of strangers.
    #[error(
        "{}: expected no [remote] in a roughcast.toml that came with assets, found url = {url:?}; name this file with \
         --config if you trust the server, or bake on this machine with --no-remote",
        config.display()
    )]
    ServerOfAssets {
        /// The configuration that came with the assets.
        config: PathBuf,
        /// The server.
        url: String,
    },
    /// The running tool cannot be found.
    #[error("--remote: expected to find the running tool, found: {0}; name one with --remote-tool")]
    Tool(std::io::Error),
}

impl RemoteOptions {
    /// Returns how the server is reached, if one is named. `named` holds where there is no flag.
    ///
    /// # Errors
    /// [`RemoteOptionError`].
    pub fn options(&self, named: Option<&NamedServer>) -> Result<Option<Options>, RemoteOptionError> {
        if self.no_remote {
            return Ok(None);
        }
        let file = self.trusted(named)?;
        let Some(url) = self.remote.clone().or(file.url) else { return Ok(None) };
        let headers = self.headers()?;
        let tool = match self.remote_tool.clone().or(file.tool) {
            Some(tool) => tool,
            None => env::current_exe().map_err(RemoteOptionError::Tool)?,
        };
        let platform = match self.remote_platform.is_empty() {
            true => file.platform.into_iter().flatten().collect(),
            false => self.remote_platform.clone(),
        };
        let (cert, key) = (self.remote_cert.clone().or(file.cert), self.remote_key.clone().or(file.key));
        let timeout = self.remote_timeout.or(file.timeout);
        Ok(Some(Options {
            url,
            instance: self.remote_instance.clone().or(file.instance).unwrap_or_default(),
            platform,
            headers,
            tls: Tls { authority: self.remote_ca.clone().or(file.ca), identity: cert.zip(key) },
            jobs: self.remote_jobs.or(file.jobs).unwrap_or(64).min(MOST_JOBS) as usize,
            timeout: timeout.map(Duration::from_secs),
            retries: self.remote_retries.or(file.retries).unwrap_or(8),
            tool,
        }))
    }

    /// Returns what a configuration sets for the server: nothing if the user did not choose the configuration.
    fn trusted(&self, named: Option<&NamedServer>) -> Result<RemoteValues, RemoteOptionError> {
        match named {
            Some(NamedServer { values, is_trusted: true, .. }) => Ok(values.clone()),
            Some(NamedServer { values: RemoteValues { url: Some(url), .. }, config, .. }) if self.remote.is_none() => {
                Err(RemoteOptionError::ServerOfAssets { config: config.clone(), url: url.clone() })
            }
            _ => Ok(RemoteValues::default()),
        }
    }

    /// Returns the headers of the variable, the file and the flags. If a name occurs again, the last header holds.
    fn headers(&self) -> Result<Vec<Header>, RemoteOptionError> {
        let mut headers = BTreeMap::new();
        let mut add = |text: &str, origin: &str| {
            for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
                let pair = line.split_once('=').map(|(name, value)| (name.trim(), value.trim()));
                let Some((name, value)) = pair.filter(|(name, _)| !name.is_empty()) else {
                    return Err(RemoteOptionError::Header { origin: origin.to_owned() });
                };
                headers.insert(name.to_ascii_lowercase(), value.to_owned());
            }
            Ok(())
        };
        if let Ok(text) = env::var(HEADERS) {
            add(&text, HEADERS)?;
        }
        if let Some(path) = &self.remote_header_file {
            let read = |path: &Path| fs::read_to_string(path);
            let text = read(path).map_err(|error| RemoteOptionError::Read { path: path.clone(), error })?;
            add(&text, &path.display().to_string())?;
        }
        for Secret(text) in &self.remote_header {
            add(text, "--remote-header")?;
        }
        Ok(headers.into_iter().map(|(name, value)| Header { name, value }).collect())
    }
}

fn pair(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').filter(|(name, _)| !name.is_empty());
    pair.map(|(name, value)| (name.to_owned(), value.to_owned())).ok_or_else(|| "expected NAME=VALUE".to_owned())
}
