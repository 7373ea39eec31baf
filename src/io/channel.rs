//! One channel of an EXR file beside the picture: its name and a value for each pixel.

/// A channel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageChannel {
    /// Layer and channel, e.g. `albedo.R`.
    pub name: String,
    /// A value for each pixel, row by row from the top left.
    pub values: Vec<f32>,
    /// Whether halves would lose what it says.
    pub exact: bool,
}
