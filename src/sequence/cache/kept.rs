//! A preparation in the cache: what is written of it, and read part by part while it is built.

use crate::archive::{ArchiveReader, ArchiveWriter, check};
use crate::error::{Error, Result};
use crate::mesh::RadiosityMesh;
use crate::report::Seconds;
use crate::sequence::prepared::{KeyLight, Prepared};
use crate::settings::{Memory, Settings};
use crate::solver::{Radiosity, Solution};
use crate::visibility::MissIds;
use glam::{DVec3, Vec3, Vec3A};
use std::fs::File;
use std::io;
use std::path::PathBuf;

/// Seconds of a preparation that are kept, and the numbers of its key light.
const NUMBERS: usize = 9;

/// What is kept of a preparation beside its lists.
#[derive(Clone, Debug, Default)]
pub(crate) struct Keeping {
    /// Elements that were cut, and sides of which light reaches some.
    pub(crate) counts: [u64; 2],
    /// Warnings that were found on the way.
    pub(crate) warnings: Vec<String>,
    /// Seconds that tracing the static hits took, and a pilot.
    pub(crate) trace_seconds: f64,
    pub(crate) pilot_seconds: f64,
}

/// A file of the cache that is being read.
pub(crate) struct KeptPreparation {
    path: PathBuf,
    reader: ArchiveReader,
}

/// Whether static hits are kept at all.
pub(crate) fn keeps_hits(settings: &Settings) -> bool {
    !settings.image.is_phong() && settings.solve.memory == Memory::Full
}

/// Writes a preparation.
///
/// # Errors
/// What the system refuses.
pub(super) fn store(
    file: &mut File,
    label: &[u8],
    prepared: &Prepared,
    keeping: &Keeping,
) -> io::Result<()> {
    let mut to = ArchiveWriter::new(file, label)?;
    to.list(&keeping.counts)?;
    to.list(&[keeping.trace_seconds, keeping.pilot_seconds])?;
    to.list(keeping.warnings.join("\n").as_bytes())?;
    prepared.patches.store(&mut to)?;
    prepared.swept.store(&mut to)?;
    if keeps_hits(&prepared.settings) {
        prepared.back.store(&mut to)?;
    }
    store_key(&prepared.key, &mut to)?;
    to.finish()
}

/// Writes the key light.
fn store_key(key: &KeyLight, to: &mut ArchiveWriter) -> io::Result<()> {
    let light = &key.light;
    to.number(key.seconds.is_some().into())?;
    to.list(&numbers(&key.seconds.unwrap_or_default(), light))?;
    to.number(light.shots)?;
    to.column(&light.reflected, |r| Vec3::from(*r))?;
    to.list(&light.indirect)?;
    to.list(&light.uniform.shot)?;
    to.list(&light.uniform.received)
}

/// The numbers of a key light; 32 bits are the same in 64.
fn numbers(seconds: &Seconds, light: &Radiosity) -> [f64; NUMBERS] {
    let [x, y, z] = light.ambient.to_array().map(f64::from);
    [
        seconds.place,
        seconds.trace,
        seconds.solve,
        seconds.precompute,
        light.sweeps.into(),
        light.residual.into(),
        x,
        y,
        z,
    ]
}

impl KeptPreparation {
    pub(super) fn new(path: PathBuf, reader: ArchiveReader) -> KeptPreparation {
        KeptPreparation { path, reader }
    }

    /// Reads a part of the file.
    ///
    /// # Errors
    /// [`Error::Read`] with the words of what does not fit.
    pub(crate) fn read<T>(
        &mut self,
        part: impl FnOnce(&mut ArchiveReader) -> std::result::Result<T, String>,
    ) -> Result<T> {
        part(&mut self.reader).map_err(|reason| Error::Read {
            path: self.path.clone(),
            source: io::Error::other(reason),
            way_out: "remove the file: it is made anew".into(),
        })
    }

    /// Reads what stands before the lists.
    pub(crate) fn begin(&mut self) -> Result<Keeping> {
        self.read(|from| {
            let counts: Vec<u64> = from.list_of(2)?;
            let seconds: Vec<f64> = from.list_of(2)?;
            let warnings = String::from_utf8_lossy(&from.list::<u8>()?).into_owned();
            Ok(Keeping {
                counts: [counts[0], counts[1]],
                warnings: warnings.lines().map(String::from).collect(),
                trace_seconds: seconds[0],
                pilot_seconds: seconds[1],
            })
        })
    }

    /// Reads the key light, which stands at the end.
    pub(crate) fn key(mut self, patches: &RadiosityMesh) -> Result<KeyLight> {
        let rows = patches.sides.len();
        let key = self.read(|from| key_light(rows, from))?;
        let KeptPreparation { path, reader } = self;
        let end = reader.finish();
        end.map(|()| key).map_err(|reason| Error::Read {
            path,
            source: io::Error::other(reason),
            way_out: "remove the file: it is made anew".into(),
        })
    }
}

/// Reads the key light of so many sides.
fn key_light(rows: usize, from: &mut ArchiveReader) -> std::result::Result<KeyLight, String> {
    let known = from.number()? != 0;
    let numbers: Vec<f64> = from.list_of(NUMBERS)?;
    let shots = from.number()?;
    let reflected: Vec<Vec3> = from.list()?;
    let indirect: Vec<Vec3> = from.list()?;
    let shot: Vec<DVec3> = from.list()?;
    let received: Vec<DVec3> = from.list()?;
    let lengths = [reflected.len(), indirect.len()];
    let lit = lengths == [rows + MissIds::KINDS, rows];
    check(lit || lengths == [0; 2], "a light of another length")?;
    let uniform = [shot.len(), received.len()];
    check(
        uniform == [rows; 2] || uniform == [0; 2],
        "a light of another length",
    )?;
    let seconds = Seconds {
        place: numbers[0],
        trace: numbers[1],
        solve: numbers[2],
        precompute: numbers[3],
        ..Seconds::default()
    };
    Ok(KeyLight {
        light: Radiosity {
            reflected: reflected.into_iter().map(Vec3A::from).collect(),
            indirect,
            sweeps: numbers[4] as u32,
            shots,
            residual: numbers[5] as f32,
            ambient: Vec3::new(numbers[6] as f32, numbers[7] as f32, numbers[8] as f32),
            uniform: Solution { shot, received },
        },
        seconds: known.then_some(seconds),
    })
}
