//! Everything that can go wrong, each told as *thing: expected, got — way out*.
//!
//! The shape follows hyperfine's error list: one enum, one sentence per variant, and a distinct exit code for each
//! kind, so that scripts can tell a wrong flag from a broken file.

use std::path::PathBuf;

/// What went wrong, where, what was expected, what was found and how to get on.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A flag or argument that cannot be used.
    #[error("{flag}: expected {expected}, got {got} — {way_out}")]
    Usage {
        /// The flag or argument as typed, e.g. `--frames`.
        flag: String,
        /// What would have been accepted.
        expected: String,
        /// What was given.
        got: String,
        /// How to get on.
        way_out: String,
    },
    /// A file that cannot be read.
    #[error("{}: cannot be read: {source} — {way_out}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
        /// How to get on.
        way_out: String,
    },
    /// A scene file whose content breaks the glTF specification or cannot be rendered.
    #[error("{}: {pointer}: expected {expected}, got {got} — {way_out}", file.display())]
    Scene {
        /// The scene file.
        file: PathBuf,
        /// Where in it, as a JSON pointer such as `/accessors/3/count`, or a node by name and frame.
        pointer: String,
        /// What the specification or the renderer asks for.
        expected: String,
        /// What the file holds.
        got: String,
        /// How to get on.
        way_out: String,
    },
    /// A scene file that uses something sweeplight does not read.
    #[error("{}: {feature} is not supported — {way_out}", file.display())]
    Unsupported {
        /// The scene file.
        file: PathBuf,
        /// The extension or feature by its own name.
        feature: String,
        /// How to get on.
        way_out: String,
    },
    /// A file that cannot be written.
    #[error("{}: cannot be written: {reason} — {way_out}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system or the encoder said.
        reason: String,
        /// How to get on.
        way_out: String,
    },
    /// An edit that cannot be made; nothing was changed.
    #[error("{place}: expected {expected}, got {got} — {way_out}")]
    Edit {
        /// Where in the step, e.g. `edits[0].move.to`.
        place: String,
        /// What would have been accepted.
        expected: String,
        /// What was given.
        got: String,
        /// How to get on.
        way_out: String,
    },
    /// A run of edits that was done but for some lines.
    #[error("{file}: {bad} of {lines} lines could not be done — {way_out}")]
    BadLines {
        /// Where the lines came from.
        file: String,
        /// How many were left out.
        bad: u64,
        /// How many there were.
        lines: u64,
        /// How to get on.
        way_out: String,
    },
    /// `verify` found a sample or a radiosity that incremental update and full trace do not share.
    #[error("verify: {reason} — {way_out}")]
    Differs {
        /// What differs, where, and by how much.
        reason: String,
        /// How to get on.
        way_out: String,
    },
    /// `validate` found an answer that is not the known one.
    #[error("validate: {case}: expected {expected}, got {got} — {way_out}")]
    Unproven {
        /// The case and how it was found.
        case: String,
        /// The known answer, and how far off it may be.
        expected: String,
        /// The answer found.
        got: String,
        /// How to get on.
        way_out: String,
    },
}

impl Error {
    /// The program's exit code for this kind of error: 1 differs or unproven, 2 usage, 3 read, 4 scene, 5 unsupported, 6 write,
    /// 7 edits that could not be made.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Differs { .. } | Error::Unproven { .. } => 1,
            Error::Usage { .. } => 2,
            Error::Read { .. } => 3,
            Error::Scene { .. } => 4,
            Error::Unsupported { .. } => 5,
            Error::Write { .. } => 6,
            Error::Edit { .. } | Error::BadLines { .. } => 7,
        }
    }
}

/// A result whose error names the thing, what was expected, what was got and the way out.
pub type Result<T> = std::result::Result<T, Error>;
