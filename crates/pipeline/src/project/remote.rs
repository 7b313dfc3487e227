//! `[remote]`: the server that bakes, by the names that its flags have after `--remote-`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Declares the keys, each once.
macro_rules! remote_values {
    ($($(#[$doc:meta])* $field:ident: $type:ty,)*) => {
        /// A server, as far as a file describes it. The file has no key for secrets.
        #[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case", deny_unknown_fields)]
        #[allow(missing_docs)]
        pub struct RemoteValues {
            $($(#[$doc])* pub $field: Option<$type>,)*
        }

        impl RemoteValues {
            /// Returns every name.
            pub fn names() -> Vec<String> {
                vec![$(stringify!($field).replace('_', "-")),*]
            }

            /// Returns the values of `later`, and those of `self` that `later` does not set.
            #[must_use]
            pub(super) fn overridden_by(self, later: Self) -> Self {
                Self { $($field: later.$field.or(self.$field)),* }
            }
        }
    };
}

remote_values! {
    /// `grpc[s]://host:port`.
    url: String,
    instance: String,
    platform: BTreeMap<String, String>,
    ca: PathBuf,
    cert: PathBuf,
    key: PathBuf,
    jobs: u32,
    timeout: u64,
    retries: u32,
    tool: PathBuf,
}

impl RemoteValues {
    /// Returns the values with files relative to `folder`.
    pub fn in_folder(self, folder: &Path) -> Self {
        let join = |path: Option<PathBuf>| path.map(|path| folder.join(path));
        Self { ca: join(self.ca), cert: join(self.cert), key: join(self.key), tool: join(self.tool), ..self }
    }
}
