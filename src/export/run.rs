//! The run of an export: one state after another, each solved from the one before.

use super::glb::{self, LitFile, Recording, Told};
use super::table::{COLUMNS, Table};
use crate::error::{Error, Result};
use crate::io::file;
use crate::scene::Animation;
use crate::sequence::Event;
use crate::sequence::begin;
use crate::sequence::threads::in_threads;
use crate::sequence::timeline;
use crate::session::Session;
use crate::settings::{Settings, TOLERANCE};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// What is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Export {
    /// The lit scene, a .glb file, in the first of the frames.
    pub scene: Option<PathBuf>,
    /// Whether that has all of the frames, and how far colours between its key frames may be off, as a share of white on the
    /// screen.
    pub animated: Option<f32>,
    /// The radiosity of every side in all of the frames: .csv or .npz.
    pub radiosity: Option<PathBuf>,
}

/// Most bytes of a table: ZIP files say their places in 32 bits.
const MOST_BYTES: u64 = 4_000_000_000;

/// Writes what is asked for, and tells what was written, a line a file.
///
/// # Errors
/// [`Error::Usage`] where a name has another ending, and what opening, solving and writing tell.
pub fn export(
    settings: &Settings,
    wanted: &Export,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<String> {
    in_threads(settings.solve.threads, || all(settings, wanted, watch))?
}

fn all(settings: &Settings, wanted: &Export, watch: &(dyn Fn(Event) + Sync)) -> Result<String> {
    check(wanted)?;
    check_inputs(settings, wanted, &[])?;
    watch(Event::Stage {
        name: "solve the light",
        total: 0,
    });
    let (mut session, _, completed) = begin::begin(settings, true, watch)?;
    let animation = &session.scene.animation;
    check_inputs(settings, wanted, &animation.sources)?;
    let exposures = begin::exposures(&completed, animation, watch)?;
    let mut frames = timeline::frames(settings, animation)?;
    if wanted.radiosity.is_none() && wanted.animated.is_none() {
        frames.truncate(1);
    }
    check_size(&session, frames.len(), wanted)?;
    watch(Event::Stage {
        name: "export",
        total: frames.len() as u64,
    });
    let mut work = Work::default();
    if let (Some(_), Some(first)) = (wanted.animated, frames.first()) {
        check_order(&frames)?;
        session.play(f64::from(*first) / settings.scene.fps);
        let seconds = frames
            .iter()
            .map(|frame| f64::from(*frame) / settings.scene.fps);
        let glowing = glowing(&session.scene.animation, seconds);
        let look = (exposures.at(*first), settings.image.size);
        let recording = Recording::of(&session, look, &glowing);
        check_memory(recording.bytes_of_frame(), frames.len())?;
        work.recording = Some(recording);
    }
    for frame in &frames {
        session.play(f64::from(*frame) / settings.scene.fps);
        session.apply(&[])?;
        let about = Told {
            frame: *frame,
            stops: exposures.at(*frame),
            size: settings.image.size,
        };
        work.take(&session, about, wanted)?;
        watch(Event::Advance(1));
    }
    if let (Some(tolerance), Some(first), Some(path)) =
        (wanted.animated, frames.first(), &wanted.scene)
    {
        let told = Told {
            frame: *first,
            stops: exposures.at(*first),
            size: settings.image.size,
        };
        work.write_animation(&session, (told, tolerance), path)?;
    }
    work.end(wanted)
}

/// What was written, and what is still to be.
#[derive(Default)]
struct Work {
    table: Table,
    recording: Option<Recording>,
    told: Vec<String>,
    unconverged: Option<Error>,
}

impl Work {
    /// Takes the state of a frame.
    fn take(&mut self, session: &Session, about: Told, wanted: &Export) -> Result<()> {
        if let Some(recording) = &mut self.recording {
            recording.add(session)?;
        } else if let Some(path) = wanted.scene.as_ref().filter(|_| self.told.is_empty()) {
            let lit = glb::lit(session, about, path)?;
            file::replace(path, &lit.bytes)?;
            self.told.push(line(path, about, &lit));
        }
        if wanted.radiosity.is_some() {
            self.table.add(about.frame, session);
        }
        let place = || format!("frame {}", about.frame);
        let converged = Error::unless_converged(place, session.residual(), TOLERANCE);
        if let Err(error) = converged {
            self.unconverged.get_or_insert(error);
        }
        Ok(())
    }

    /// Writes the scene with all of its frames.
    fn write_animation(
        &mut self,
        session: &Session,
        (told, tolerance): (Told, f32),
        path: &Path,
    ) -> Result<()> {
        let Some(recording) = &self.recording else {
            return Ok(());
        };
        let lit = glb::animated(session, recording, (told, tolerance), path)?;
        file::replace(path, &lit.bytes)?;
        self.told.push(line(path, told, &lit));
        Ok(())
    }

    /// Writes the table, and tells of all.
    fn end(mut self, wanted: &Export) -> Result<String> {
        if let Some(path) = &wanted.radiosity {
            let bytes = match is_npz(path) {
                true => self.table.npz().map_err(|error| Error::Write {
                    path: path.clone(),
                    reason: error.to_string(),
                    way_out: "name fewer --frames, or a .csv".into(),
                })?,
                false => self.table.csv().into_bytes(),
            };
            file::replace(path, &bytes)?;
            let (frames, sides) = (self.table.frames.len(), self.table.sides.len());
            let (path, bytes) = (path.display(), bytes.len());
            self.told.push(format!(
                "{path}: {} rows, {frames} frames of {sides} sides, {bytes} bytes",
                frames * sides
            ));
        }
        match self.unconverged {
            Some(error) => Err(error),
            None => Ok(self.told.join("\n")),
        }
    }
}

/// A line on a lit scene.
fn line(path: &Path, about: Told, lit: &LitFile) -> String {
    let keys = lit.keys.map(|(keys, error)| {
        format!(" and on, up to {keys} key frames an object that leave {error:.4} of white")
    });
    format!(
        "{}: frame {}{}, {} vertices, {} bytes; exposure {:.2} stops, {} vertices are clipped at white",
        path.display(),
        about.frame,
        keys.unwrap_or_default(),
        lit.vertices,
        lit.bytes.len(),
        about.stops,
        lit.clipped
    )
}

fn ends(path: &Path, ending: &str) -> bool {
    let found = path.extension().map(|found| found.to_ascii_lowercase());
    found.is_some_and(|found| found == ending)
}

fn is_npz(path: &Path) -> bool {
    ends(path, "npz")
}

/// A choice of files that cannot be made.
fn usage<T>(flag: &str, expected: &str, got: String, way_out: &str) -> Result<T> {
    Err(Error::Usage {
        flag: flag.into(),
        expected: expected.into(),
        got,
        way_out: way_out.into(),
    })
}

/// Refuses names that say nothing of their format, before anything is solved.
fn check(wanted: &Export) -> Result<()> {
    if let Some(path) = wanted.scene.as_ref().filter(|path| !ends(path, "glb")) {
        let got = format!("'{}'", path.display());
        return usage(
            "-o",
            "a file that ends in .glb",
            got,
            "write e.g. -o solved.glb",
        );
    }
    if wanted.animated.is_some() && wanted.scene.is_none() {
        let way_out = "write e.g. -o solved.glb";
        return usage("--animated", "-o beside it", "none".into(), way_out);
    }
    let tables = wanted.radiosity.as_ref();
    if let Some(path) = tables.filter(|path| !is_npz(path) && !ends(path, "csv")) {
        let got = format!("'{}'", path.display());
        let way_out = "write e.g. --radiosity light.npz";
        return usage(
            "--radiosity",
            "a file that ends in .csv or .npz",
            got,
            way_out,
        );
    }
    if wanted.scene.is_none() && wanted.radiosity.is_none() {
        let way_out = "write e.g. -o solved.glb";
        return usage(
            "export",
            "-o, --radiosity or both",
            "neither".into(),
            way_out,
        );
    }
    let paths = [&wanted.scene, &wanted.radiosity];
    paths
        .into_iter()
        .flatten()
        .try_for_each(|path| file::check(path))
}

/// Which materials emit at any of these times.
fn glowing(animation: &Animation, seconds: impl Iterator<Item = f64>) -> Vec<bool> {
    let mut glowing = vec![false; animation.materials.len()];
    for seconds in seconds {
        let pose = animation.pose(seconds);
        let emits = pose.emission.iter().map(|light| *light != Vec3::ZERO);
        glowing
            .iter_mut()
            .zip(emits)
            .for_each(|(glows, emits)| *glows |= emits);
    }
    glowing
}

/// Refuses frames that are no animation.
fn check_order(frames: &[u32]) -> Result<()> {
    if frames.windows(2).all(|pair| pair[0] < pair[1]) {
        return Ok(());
    }
    let expected = "frames in the order of time, each once";
    let way_out = "name them so, e.g. --frames 0-47, or leave --animated out";
    usage("--frames", expected, "others".into(), way_out)
}

/// Refuses frames that would not fit into memory.
fn check_memory(bytes_of_frame: usize, frames: usize) -> Result<()> {
    let bytes = bytes_of_frame as u64 * frames as u64;
    if bytes < MOST_BYTES {
        return Ok(());
    }
    let got = format!("{frames} frames of {:.1} MB", bytes_of_frame as f64 / 1e6);
    let way_out = "name fewer --frames, e.g. every fourth by 0-47x4, or take fewer --elements";
    usage("--animated", "less than 4 GB of colours", got, way_out)
}

/// Refuses names of files that are read.
fn check_inputs(settings: &Settings, wanted: &Export, sources: &[PathBuf]) -> Result<()> {
    let mut ledger = begin::inputs(settings, sources);
    let named = [("-o", &wanted.scene), ("--radiosity", &wanted.radiosity)];
    for (flag, path) in named {
        if let Some(path) = path {
            ledger.writes(path, flag)?;
        }
    }
    Ok(())
}

/// Refuses a table that would be too large for its format.
fn check_size(session: &Session, frames: usize, wanted: &Export) -> Result<()> {
    let numbers: usize = COLUMNS.iter().map(|(.., width)| width).sum();
    let sides = session.scene.patches.sides.len();
    let bytes = 4 * (numbers * sides) as u64 * frames as u64;
    if wanted.radiosity.is_none() || bytes < MOST_BYTES {
        return Ok(());
    }
    Err(Error::Usage {
        flag: "--radiosity".into(),
        expected: "less than 4 GB of numbers".into(),
        got: format!("{frames} frames of {sides} sides"),
        way_out: "name fewer --frames, or a larger --element-size".into(),
    })
}
