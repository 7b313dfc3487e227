//! `[remote]`: the server that bakes, by the names that its flags have after `--remote-`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A server, as far as a file says. Secrets have no place in it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[allow(missing_docs)]
pub struct RemoteValues {
    /// `grpc[s]://host:port`.
    pub url: Option<String>,
    pub instance: Option<String>,
    pub platform: Option<BTreeMap<String, String>>,
    pub ca: Option<PathBuf>,
    pub cert: Option<PathBuf>,
    pub key: Option<PathBuf>,
    pub jobs: Option<u32>,
    pub timeout: Option<u64>,
    pub retries: Option<u32>,
    pub tool: Option<PathBuf>,
}

impl RemoteValues {
    /// Every name.
    pub fn names() -> Vec<String> {
        match serde_json::to_value(Self::default()) {
            Ok(Value::Object(members)) => members.into_iter().map(|(name, _)| name).collect(),
            // A struct is an object.
            _ => Vec::new(),
        }
    }

    /// The same with files relative to `folder`.
    pub fn in_folder(self, folder: &Path) -> Self {
        let join = |path: Option<PathBuf>| path.map(|path| folder.join(path));
        Self { ca: join(self.ca), cert: join(self.cert), key: join(self.key), tool: join(self.tool), ..self }
    }
}
