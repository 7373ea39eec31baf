//! Where the pictures of a run go: files by number, a single one, or the stills of a moving picture.
//!
//! A name with a marker, `door_####.png`, is a sequence. A name without one is one file, as it is typed: `door.png` is the
//! picture where there is one frame, and an animated PNG where there are more; `door.apng`, `door.gif` and `door.mp4` are
//! moving pictures of however many frames. OpenEXR has none: `door.exr` is a sequence where there are more frames than
//! one, and so is a name without an extension.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::io::clip::ClipFile;
use crate::io::destination::{self, Destination};
use crate::io::file;
use crate::io::lock::FolderLock;
use crate::io::pattern::Container;
use crate::io::pattern::{self, FileKind, Pattern};

/// A place for the pictures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageOutput {
    /// A file for each frame.
    Sequence(Pattern),
    /// The file of the only frame.
    Single(PathBuf, FileKind),
    /// A moving picture.
    Clip(ClipFile),
}

impl ImageOutput {
    /// Where a run of so many frames puts what a pattern asks for.
    pub fn of(pattern: Pattern, frames: usize) -> ImageOutput {
        let clip = |path: &Path, container| ImageOutput::Clip(ClipFile::new(path, container));
        match (pattern.one(), pattern.container(), pattern.kind()) {
            (Some(path), Some(container), _) => clip(path, container),
            (Some(path), None, kind) if frames == 1 => ImageOutput::Single(path.into(), kind),
            (Some(path), None, FileKind::Png) => clip(path, Container::Apng),
            _ => ImageOutput::Sequence(pattern),
        }
    }

    /// The format of its pictures.
    pub fn kind(&self) -> FileKind {
        match self {
            ImageOutput::Sequence(pattern) => pattern.kind(),
            ImageOutput::Single(_, kind) => *kind,
            ImageOutput::Clip(_) => FileKind::Png,
        }
    }

    /// The file of one frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        match self {
            ImageOutput::Sequence(pattern) => pattern.path(frame),
            ImageOutput::Single(path, _) => path.clone(),
            ImageOutput::Clip(clip) => clip.still(frame),
        }
    }

    /// The file of a preview of one frame; moving pictures have none.
    pub fn preview(&self, frame: u32, shots: u64) -> Option<PathBuf> {
        match self {
            ImageOutput::Clip(_) => None,
            other => Some(pattern::preview_of(&other.path(frame), shots)),
        }
    }

    /// The file of all frames, where there is one.
    pub fn whole(&self) -> Option<&Path> {
        match self {
            ImageOutput::Clip(clip) => Some(clip.path()),
            _ => None,
        }
    }

    /// The folder and the stem of the manifest of its pictures; pipes and devices have none.
    pub fn manifest(&self) -> Option<(PathBuf, String)> {
        match self {
            ImageOutput::Sequence(pattern) => Some(pattern.manifest()),
            ImageOutput::Single(path, _) => {
                let is_file = matches!(Destination::of(path), Destination::File(_));
                is_file.then(|| beside(path))
            }
            ImageOutput::Clip(clip) => Some(clip.manifest()),
        }
    }

    /// The folder and the stem of the manifest of the whole, where that is one file of all frames.
    pub fn manifest_of_whole(&self) -> Option<(PathBuf, String)> {
        match self {
            ImageOutput::Clip(clip) => Some(beside(clip.path())),
            _ => None,
        }
    }

    /// Finds out whether it can be written, before any work depends on it.
    pub fn check(&self) -> Result<()> {
        match self {
            ImageOutput::Clip(clip) => clip.check(),
            other => file::check(&other.path(0)),
        }
    }

    /// Every file that it writes for these frames, but for previews.
    pub fn files<'a>(&'a self, frames: &'a [u32]) -> impl Iterator<Item = PathBuf> + 'a {
        let whole = match self {
            ImageOutput::Clip(clip) => Some(clip.path().to_path_buf()),
            _ => None,
        };
        let stills = frames.iter().map(|frame| self.path(*frame));
        whole.into_iter().chain(stills)
    }

    /// Keeps other runs away from what needs all frames, where that is a moving picture.
    pub fn lock(&self) -> Result<Option<FolderLock>> {
        match self {
            ImageOutput::Clip(clip) => clip.lock().map(Some),
            _ => Ok(None),
        }
    }

    /// Brings to its end what needs all frames.
    pub fn finish(&self, frames: &[u32], fps: f64) -> Result<()> {
        match self {
            ImageOutput::Clip(clip) => clip.join(frames, fps),
            _ => Ok(()),
        }
    }
}

/// The folder and the stem of the manifest of a file.
fn beside(path: &Path) -> (PathBuf, String) {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    (destination::folder(path).into(), stem.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output(text: &str, frames: usize) -> ImageOutput {
        ImageOutput::of(Pattern::parse(text).expect(text), frames)
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
            let clip = ImageOutput::Clip(ClipFile::new(Path::new(name), container));
            assert_eq!(output(name, 2), clip);
        }
        assert!(matches!(output("a.gif", 1), ImageOutput::Clip(_)));
    }
}
