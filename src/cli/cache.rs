//! `--cache`, and the command that looks into a cache and prunes it.

use std::path::PathBuf;

use clap::Args;

use crate::cli::help;
use crate::cli::values::number;
use crate::sequence::cache::shelf::Prune;

/// Bytes of a gigabyte.
const GIGABYTE: f64 = 1e9;

/// The folder in which preparations are kept.
#[derive(Debug, Args)]
pub(super) struct CacheFlag {
    /// Folder that keeps the preparation of a scene (mesh, static hits, key light) for later runs; several may use it at once.
    /// See: sweeplight cache --help
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub(super) cache: Option<PathBuf>,
}

/// Tell what is in the folder of --cache, or prune it
///
/// With --prune alone goes what this version cannot use, and what killed runs left.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct CacheArgs {
    /// The folder
    folder: PathBuf,
    /// Remove what this version cannot use, and what the other flags name
    #[arg(long)]
    prune: bool,
    /// Remove what no run has used for so many days, from 0
    #[arg(long, value_name = "DAYS", requires = "prune", allow_negative_numbers = true,
          value_parser = number("days from 0", |days: &f64| (0.0..=1e6).contains(days), "30"))]
    older_than: Option<f64>,
    /// Remove what was unused for the longest, until the rest takes so many gigabytes at most, from 0
    #[arg(long, value_name = "GB", requires = "prune", allow_negative_numbers = true,
          value_parser = number("gigabytes from 0", |size: &f64| (0.0..=1e9).contains(size), "10"))]
    keep: Option<f64>,
    /// Print JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

impl CacheArgs {
    /// What is wanted, and whether it is answered as JSON.
    pub(super) fn filled(self) -> (Prune, bool) {
        let wanted = Prune {
            folder: self.folder,
            removes: self.prune,
            older_than: self.older_than,
            keep: self.keep.map(|size| (size * GIGABYTE) as u64),
        };
        (wanted, self.json)
    }
}
