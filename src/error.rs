//! Errors, each told as *thing: expected, got — way out*.
//!
//! The shape follows hyperfine's error list: one enum, one sentence per variant, and a distinct exit code for each
//! kind, so that scripts can tell a wrong flag from a broken file.

use std::path::PathBuf;

/// An error: its place, the expected, the found, and the way out.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A flag or argument that cannot be used.
    #[error("{flag}: expected {expected}, got {got} — {way_out}")]
    Usage {
        /// The flag or argument as typed, e.g. `--frames`.
        flag: String,
        /// Accepted values.
        expected: String,
        /// The given value.
        got: String,
        /// The way out.
        way_out: String,
    },
    /// A file that cannot be read.
    #[error("{}: cannot be read: {source} — {way_out}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
        /// The way out.
        way_out: String,
    },
    /// A scene file whose content breaks the glTF specification or cannot be rendered.
    #[error("{}: {pointer}: expected {expected}, got {got} — {way_out}", file.display())]
    Scene {
        /// The scene file.
        file: PathBuf,
        /// Where in it, as a JSON pointer such as `/accessors/3/count`, or a node by name and frame.
        pointer: String,
        /// The requirement of the specification or the renderer.
        expected: String,
        /// The file's content.
        got: String,
        /// The way out.
        way_out: String,
    },
    /// A scene file with a feature that is not read.
    #[error("{}: {feature} is not supported — {way_out}", file.display())]
    Unsupported {
        /// The scene file.
        file: PathBuf,
        /// The extension or feature by its own name.
        feature: String,
        /// The way out.
        way_out: String,
    },
    /// A file that cannot be written.
    #[error("{}: cannot be written: {reason} — {way_out}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's or the encoder's message.
        reason: String,
        /// The way out.
        way_out: String,
    },
    /// An edit that cannot be made; nothing was changed.
    #[error("{place}: expected {expected}, got {got} — {way_out}")]
    Edit {
        /// Where in the step, e.g. `edits[0].move.to`.
        place: String,
        /// Accepted values.
        expected: String,
        /// The given value.
        got: String,
        /// The way out.
        way_out: String,
    },
    /// A run of edits with lines that could not be done.
    #[error("{file}: {bad} of {lines} lines could not be done — {way_out}")]
    BadLines {
        /// Source of the lines.
        file: String,
        /// Number of lines left out.
        bad: u64,
        /// Number of all lines.
        lines: u64,
        /// The way out.
        way_out: String,
    },
    /// `verify` found a sample or a radiosity that incremental update and full trace do not share.
    #[error("verify: {reason} — {way_out}")]
    Differs {
        /// The difference, its place and its size.
        reason: String,
        /// The way out.
        way_out: String,
    },
    /// A solve that ended with a larger error than it may leave; all files are written.
    #[error(
        "{place}: expected light with an error of at most {allowed:.1e} of its mean, got a bound of {bound:.1e} — {way_out}"
    )]
    Unconverged {
        /// The frame or the step.
        place: String,
        /// The tolerance.
        allowed: f64,
        /// Bound on the error; infinite where none is known.
        bound: f64,
        /// The way out.
        way_out: String,
    },
    /// `validate` found a result other than the known one.
    #[error("validate: {case}: expected {expected}, got {got} — {way_out}")]
    Unproven {
        /// The case and the estimator.
        case: String,
        /// The known result and its tolerance.
        expected: String,
        /// The result found.
        got: String,
        /// The way out.
        way_out: String,
    },
}

impl Error {
    /// The same of another flag, where one mechanism reads the values of several.
    pub fn of_flag(mut self, name: &str) -> Error {
        if let Error::Usage { flag, .. } = &mut self {
            *flag = name.into();
        }
        self
    }

    /// Fails where the light of a frame or a step has a larger error than it may.
    pub fn unless_converged(place: impl Fn() -> String, bound: f64, allowed: f32) -> Result<()> {
        let allowed = f64::from(allowed);
        if bound <= allowed {
            return Ok(());
        }
        Err(Error::Unconverged {
            place: place(),
            allowed,
            bound,
            way_out: "light can hardly leave the scene: give what encloses it reflectances below 1, or the enclosure an opening".into(),
        })
    }

    /// Standard output that takes no more.
    pub fn printed(source: &std::io::Error) -> Error {
        Error::Write {
            path: "standard output".into(),
            reason: source.to_string(),
            way_out: match source.kind() {
                std::io::ErrorKind::BrokenPipe => "keep reading until the program ends",
                _ => "free some space, or send it elsewhere",
            }
            .into(),
        }
    }

    /// The program's exit code for this kind of error: 1 differs or unproven, 2 usage, 3 read, 4 scene, 5 unsupported, 6 write,
    /// 7 edits that could not be made, 8 light that did not converge.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Differs { .. } | Error::Unproven { .. } => 1,
            Error::Usage { .. } => 2,
            Error::Read { .. } => 3,
            Error::Scene { .. } => 4,
            Error::Unsupported { .. } => 5,
            Error::Write { .. } => 6,
            Error::Edit { .. } | Error::BadLines { .. } => 7,
            Error::Unconverged { .. } => 8,
        }
    }
}

/// A result with an [`Error`].
pub type Result<T> = std::result::Result<T, Error>;
