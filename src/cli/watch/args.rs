//! Arguments of `roughcast watch`.

use std::path::PathBuf;

use crate::cli::cached::CacheOptions;
use crate::cli::selection::Selection;

/// Bake a folder of glTF assets, and bake again what changes.
///
/// Outputs are always those of a bake of the folder as it is: they change with the glTF files, their images and buffers
/// and roughcast.toml, and go when their asset goes. Those of an asset that cannot be baked stay as they were last baked.
/// Ctrl-C ends it when the asset at work is done.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast watch assets -o baked --on-change 'touch reload.txt'")]
pub struct Args {
    /// The folder; it may come later.
    #[arg(value_name = "DIR")]
    pub(super) folder: PathBuf,
    /// Print what happens as JSON, one object per line (docs/pipeline.md).
    #[arg(long)]
    pub(super) json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    pub(super) quiet: bool,
    /// Run a command of the shell after outputs changed. ROUGHCAST_OUTPUTS has the documents that were written,
    /// ROUGHCAST_REMOVED the files that were removed, one per line.
    #[arg(long, value_name = "COMMAND")]
    pub(super) on_change: Option<String>,
    /// Look at all files every so many milliseconds, where the system has no events (network drives, some containers).
    #[arg(long, value_name = "MS", num_args = 0..=1, require_equals = true, default_missing_value = "1000",
        value_parser = clap::value_parser!(u64).range(10..))]
    pub(super) poll: Option<u64>,
    /// A file is whole when it has not changed for so many milliseconds.
    #[arg(long, value_name = "MS", default_value_t = 50)]
    pub(super) settle: u64,
    #[command(flatten)]
    pub(super) cache: CacheOptions,
    #[command(flatten)]
    pub(super) selection: Selection,
}
