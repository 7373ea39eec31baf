//! A moving picture in one file: its frames are stills in a folder beside it until the last is done, then one file.
//!
//! `out.mp4` has its stills in `out.mp4.frames`, each whole as soon as it is rendered; when all are there they are joined,
//! and the folder goes. One run at a time holds it, by a [`lock`](crate::io::lock). So a run that is cut, or an encoder that
//! fails, loses no frame: they are PNG files by their numbers. Frames play in the order of the list, at the rate at which they
//! are the animation in its own time: `--frames 0-46x2` at 24 frames a second plays at 12.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::lock::FolderLock;
use crate::io::part::{self, PartFile};
use crate::io::pattern::Container;
use crate::io::{apng, destination, ffmpeg, file, gif, manifest, range};

/// A moving picture to be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClipFile {
    path: PathBuf,
    container: Container,
}

impl ClipFile {
    /// A moving picture in this file.
    pub fn new(path: &Path, container: Container) -> ClipFile {
        ClipFile {
            path: path.into(),
            container,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder of its stills.
    fn folder(&self) -> PathBuf {
        let mut name = self.path.file_name().unwrap_or_default().to_os_string();
        name.push(".frames");
        self.path.with_file_name(name)
    }

    /// The folder and the stem of the manifest of its stills.
    pub fn manifest(&self) -> (PathBuf, String) {
        (self.folder(), "frames".into())
    }

    /// The still of a frame.
    pub fn still(&self, frame: u32) -> PathBuf {
        self.folder().join(format!("{frame:04}.png"))
    }

    /// Finds out whether it can be written, before any work depends on it.
    ///
    /// # Errors
    /// [`Error::Write`] when the file cannot be made, or its encoder is not there.
    pub fn check(&self) -> Result<()> {
        if self.container == Container::Mp4 {
            ffmpeg::check().map_err(|reason| Error::Write {
                path: self.path.clone(),
                reason,
                way_out: "install ffmpeg (https://ffmpeg.org, or e.g. apt install ffmpeg), or write -o out.gif or \
                          -o out.apng, which need none"
                    .into(),
            })?;
        }
        file::check(&self.path)
    }

    /// Keeps other runs out of the folder of the stills until the lock is dropped.
    ///
    /// # Errors
    /// [`Error::Write`] where another run holds it.
    pub fn lock(&self) -> Result<FolderLock> {
        FolderLock::of(&self.folder()).map_err(|reason| Error::Write {
            path: self.path.clone(),
            reason,
            way_out: "wait until that run is done, or name another file".into(),
        })
    }

    /// Joins the stills of these frames into the file, and takes them away.
    pub fn join(&self, frames: &[u32], fps: f64) -> Result<()> {
        let stills: Vec<PathBuf> = frames.iter().map(|frame| self.still(*frame)).collect();
        let gone: Vec<u32> = frames
            .iter()
            .copied()
            .filter(|frame| !self.still(*frame).is_file())
            .collect();
        if !gone.is_empty() {
            let gone = range::text(&gone);
            return Err(Error::Write {
                path: self.path.clone(),
                reason: format!(
                    "{} lost frames {gone} while the run went on",
                    self.folder().display()
                ),
                way_out: "render again, and leave the folder of the frames alone until the end"
                    .into(),
            });
        }
        self.join_files(&stills, frames, fps)?;
        for still in &stills {
            // A still that cannot be removed is no loss.
            let _ = fs::remove_file(still);
        }
        for manifest in manifest::family(&self.folder(), "frames") {
            let _ = fs::remove_file(manifest);
        }
        part::sweep(&self.folder());
        let _ = fs::remove_dir(self.folder());
        Ok(())
    }

    /// Joins these pictures of frames into the file.
    pub fn join_files(&self, stills: &[PathBuf], frames: &[u32], fps: f64) -> Result<()> {
        let fps = pace(frames, fps);
        let written = file::whole(&self.path, |part| match self.container {
            Container::Mp4 => ffmpeg::join(stills, fps, part.path()),
            Container::Gif => encode(part, |out| gif::join(stills, fps, out)),
            Container::Apng => encode(part, |out| apng::join(stills, fps, out)),
        });
        let folder = stills
            .first()
            .map_or(Path::new("."), |still| destination::folder(still));
        written.map_err(|reason| Error::Write {
            path: self.path.clone(),
            reason,
            way_out: format!(
                "all frames are in {}: join them with another program, or render to .png files",
                folder.display()
            ),
        })
    }
}

/// Writes through a buffer, to its end.
fn encode(
    part: &mut PartFile,
    join: impl FnOnce(&mut dyn Write) -> std::result::Result<(), String>,
) -> std::result::Result<(), String> {
    let file = part.file().map_err(|error| error.to_string())?;
    let mut out = std::io::BufWriter::new(file);
    join(&mut out)?;
    out.flush().map_err(|error| error.to_string())
}

/// Frames a second at which these frames of an animation play in its own time: fewer where some are left out evenly.
fn pace(frames: &[u32], fps: f64) -> f64 {
    let mut steps = frames.windows(2).map(|pair| pair[1].checked_sub(pair[0]));
    match steps.next().flatten() {
        Some(step) if step > 0 && steps.all(|other| other == Some(step)) => fps / f64::from(step),
        _ => fps,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stills_have_a_folder_beside_the_file() {
        let clip = ClipFile::new(Path::new("out/door.mp4"), Container::Mp4);
        assert_eq!(clip.still(7), Path::new("out/door.mp4.frames/0007.png"));
    }

    #[test]
    fn the_folder_goes_with_what_a_killed_run_left_in_it() {
        let home = tempfile::tempdir().expect("a folder");
        let clip = ClipFile::new(&home.path().join("x.apng"), Container::Apng);
        fs::create_dir(clip.folder()).expect("a folder");
        let still = image::RgbImage::new(2, 2).save(clip.still(0));
        still.expect("a picture");
        fs::write(clip.folder().join(".sweeplight-abc.part"), "half").expect("a file");
        clip.join(&[0], 24.0).expect("a moving picture");
        assert!(clip.path().is_file() && !clip.folder().exists());
    }

    #[test]
    fn frames_that_are_left_out_evenly_play_slower() {
        assert_eq!(pace(&[0, 2, 4], 24.0), 12.0);
        assert_eq!(pace(&[5, 6], 24.0), 24.0);
        assert_eq!(pace(&[0, 2, 5], 24.0), 24.0);
        assert_eq!(pace(&[4, 2, 0], 24.0), 24.0);
        assert_eq!(pace(&[3], 24.0), 24.0);
    }
}
