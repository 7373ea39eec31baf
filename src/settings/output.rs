//! The files of a run.

use std::path::PathBuf;

/// The files of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Output {
    /// Patterns of image files, e.g. `dir/name_####.exr`; none stands for `frames/<scene>_####.png`.
    pub images: Vec<String>,
    /// Files of the report: a page where the name ends in .html or .htm, else JSON.
    pub reports: Vec<PathBuf>,
    /// An image after each power of two of a progressive solve's shots as well.
    pub preview: bool,
    /// EXR channels as 32-bit floats instead of 16-bit halves.
    pub exr_float: bool,
    /// Fate of files that are there already.
    pub existing: Existing,
    /// Part of the frames that is rendered; `None` is all of them.
    pub shard: Option<Shard>,
    /// Whether each frame is claimed before it is rendered, so that several runs share the frames.
    pub claim: bool,
    /// Folder in which preparations are kept from run to run.
    pub cache: Option<PathBuf>,
}

/// Fate of files that are there already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Those that are whole and show what this run would write stay.
    #[default]
    Resume,
    /// All are written again.
    Overwrite,
    /// All stay, whatever they show.
    Keep,
}

/// A part of the frames: the `part`-th of so many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Shard {
    /// Number of the part, from 1.
    pub part: u32,
    /// Number of parts.
    pub parts: u32,
}

impl Shard {
    /// The frames of this part: neighbours, so that each has the most in common with the one before.
    ///
    /// ```
    /// use sweeplight::settings::Shard;
    /// assert_eq!(Shard { part: 2, parts: 3 }.of(&[0, 1, 2, 3, 4]), [1, 2]);
    /// ```
    pub fn of(self, frames: &[u32]) -> &[u32] {
        let end = |part: u32| frames.len() * part as usize / self.parts.max(1) as usize;
        &frames[end(self.part.saturating_sub(1))..end(self.part)]
    }
}
