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
}
