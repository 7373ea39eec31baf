//! Where the pictures of a run go: files by number, a single one, or the stills of a moving picture.
//!
//! A name with a marker, `door_####.png`, is a sequence. A name without one is one file, as it is typed: `door.png` is the
//! picture where there is one frame, and an animated PNG where there are more; `door.apng`, `door.gif` and `door.mp4` are
//! moving pictures of however many frames. OpenEXR has none: `door.exr` is a sequence where there are more frames than
//! one, and so is a name without an extension.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::io::clip::{Clip, Container};
use crate::io::file;
use crate::io::lock::FolderLock;
use crate::io::pattern::{self, Kind, Pattern};

/// A place for the pictures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// A file for each frame.
    Sequence(Pattern),
    /// The file of the only frame.
    Single(PathBuf, Kind),
    /// A moving picture.
    Clip(Clip),
}

impl Output {
    /// Where a run of so many frames puts what a pattern asks for.
    pub fn of(pattern: Pattern, frames: usize) -> Output {
        let clip = |path: &Path, container| Output::Clip(Clip::new(path, container));
        match (pattern.one(), pattern.container(), pattern.kind()) {
            (Some(path), Some(container), _) => clip(path, container),
            (Some(path), None, kind) if frames == 1 => Output::Single(path.into(), kind),
            (Some(path), None, Kind::Png) => clip(path, Container::Apng),
            _ => Output::Sequence(pattern),
        }
    }

    /// The format of its pictures.
    pub fn kind(&self) -> Kind {
        match self {
            Output::Sequence(pattern) => pattern.kind(),
            Output::Single(_, kind) => *kind,
            Output::Clip(_) => Kind::Png,
        }
    }

    /// The file of one frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        match self {
            Output::Sequence(pattern) => pattern.path(frame),
            Output::Single(path, _) => path.clone(),
            Output::Clip(clip) => clip.still(frame),
        }
    }

    /// The file of a preview of one frame; moving pictures have none.
    pub fn preview(&self, frame: u32, shots: u64) -> Option<PathBuf> {
        match self {
            Output::Clip(_) => None,
            other => Some(pattern::preview_of(&other.path(frame), shots)),
        }
    }

    /// Finds out whether it can be written, before any work depends on it.
    pub fn check(&self) -> Result<()> {
        match self {
            Output::Clip(clip) => clip.check(),
            other => file::check(&other.path(0)),
        }
    }

    /// Every file that it writes for these frames, but for previews.
    pub fn files<'a>(&'a self, frames: &'a [u32]) -> impl Iterator<Item = PathBuf> + 'a {
        let whole = match self {
            Output::Clip(clip) => Some(clip.path().to_path_buf()),
            _ => None,
        };
        let stills = frames.iter().map(|frame| self.path(*frame));
        whole.into_iter().chain(stills)
    }

    /// Keeps other runs away from what needs all frames, where that is a moving picture.
    pub fn lock(&self) -> Result<Option<FolderLock>> {
        match self {
            Output::Clip(clip) => clip.lock().map(Some),
            _ => Ok(None),
        }
    }

    /// Brings to its end what needs all frames.
    pub fn finish(&self, frames: &[u32], fps: f64) -> Result<()> {
        match self {
            Output::Clip(clip) => clip.join(frames, fps),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output(text: &str, frames: usize) -> Output {
        Output::of(Pattern::parse(text).expect(text), frames)
    }

    #[test]
    fn one_name_is_one_file_where_that_can_be() {
        assert_eq!(output("a.png", 1).path(7), Path::new("a.png"));
        assert_eq!(output("a.exr", 1).path(7), Path::new("a.exr"));
        assert_eq!(output("a.exr", 2).path(7), Path::new("a_0007.exr"));
        assert_eq!(output("a", 1).path(7), Path::new("a_0007.png"));
        assert_eq!(output("a_####.png", 1).path(7), Path::new("a_0007.png"));
        for (name, container) in [
            ("a.png", Container::Apng),
            ("a.apng", Container::Apng),
            ("a.GIF", Container::Gif),
            ("a.mp4", Container::Mp4),
        ] {
            let clip = Output::Clip(Clip::new(Path::new(name), container));
            assert_eq!(output(name, 2), clip);
        }
        assert!(matches!(output("a.gif", 1), Output::Clip(_)));
    }
}
