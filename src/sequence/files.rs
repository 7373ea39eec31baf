//! The files of a run: which of them are there and which are to be made, held while the work goes on.

use super::observer::{self, Event};
use super::written::WrittenFiles;
use super::{fingerprint, outputs};
use crate::error::Result;
use crate::io::claim;
use crate::io::destination::Destination;
use crate::io::lock::FolderLock;
use crate::io::manifest::{self, FileRecord, FileState, Manifest};
use crate::io::output::ImageOutput;
use crate::io::part;
use crate::io::range;
use crate::report::Report;
use crate::scene::Animation;
use crate::settings::{Aov, Existing, Settings};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Where the pictures of a run go, which of them are there, and which are to be made.
pub(super) struct Files {
    places: Vec<RunOutput>,
    manifests: Vec<Manifest>,
    /// Fingerprint of what the pictures show.
    pub(super) fingerprint: String,
    /// The frames of the run.
    frames: Vec<u32>,
    /// The frames to render, in the order of the list.
    pub(super) todo: Vec<u32>,
    /// Those of them that no file needs: the layer `recomputed` of the next one compares with them.
    passed: HashSet<u32>,
    written: WrittenFiles,
    /// How many of the frames to make other runs have made.
    others: usize,
    existing: Existing,
    preview: bool,
    _locks: Vec<FolderLock>,
}

/// One output of a run.
struct RunOutput {
    output: ImageOutput,
    /// The manifest of its pictures, and that of all of them in one file.
    manifest: Option<usize>,
    manifest_of_whole: Option<usize>,
    /// Frames whose pictures stay.
    kept: HashSet<u32>,
}

impl Files {
    /// The files of these frames, once it is known that they can be written, that none of them is read or written twice,
    /// and that no other run writes them; and which of them an earlier run has left.
    ///
    /// # Errors
    /// [`Error::Usage`](crate::error::Error::Usage) and [`Error::Write`](crate::error::Error::Write).
    pub(super) fn begin(
        settings: &Settings,
        animation: &Animation,
        frames: &[u32],
        watch: &(dyn Fn(Event) + Sync),
    ) -> Result<Files> {
        let outputs = outputs::separate(settings, animation, frames)?;
        let claims = settings.output.claim;
        let mut locks = Vec::new();
        for output in &outputs {
            output.check()?;
            locks.extend(output.lock()?);
        }
        let mut files = Files::survey(settings, animation, frames, outputs, watch)?;
        files._locks = locks;
        files.hold(claims)?;
        files.sweep(claims);
        Ok(files)
    }

    /// The same without a look whether they can be written, and open to other runs.
    pub(super) fn foreseen(
        settings: &Settings,
        animation: &Animation,
        frames: &[u32],
    ) -> Result<Files> {
        let outputs = outputs::separate(settings, animation, frames)?;
        Files::survey(settings, animation, frames, outputs, &observer::silence)
    }

    /// The files of these outputs, and which of them are there.
    fn survey(
        settings: &Settings,
        animation: &Animation,
        frames: &[u32],
        outputs: Vec<ImageOutput>,
        watch: &(dyn Fn(Event) + Sync),
    ) -> Result<Files> {
        let shard = settings.output.shard;
        let mut files = Files {
            places: Vec::new(),
            manifests: Vec::new(),
            fingerprint: fingerprint::of(settings, animation)?,
            frames: shard.map_or(frames, |shard| shard.of(frames)).to_vec(),
            todo: Vec::new(),
            passed: HashSet::new(),
            written: WrittenFiles::default(),
            others: 0,
            existing: settings.output.existing,
            preview: settings.output.preview,
            _locks: Vec::new(),
        };
        for output in outputs {
            files.look(settings, output);
        }
        files.plan(settings, frames, watch);
        Ok(files)
    }

    /// Looks at what is there of an output.
    fn look(&mut self, settings: &Settings, output: ImageOutput) {
        let manifest = self.manifest(output.manifest(), settings);
        let manifest_of_whole = self.manifest(output.manifest_of_whole(), settings);
        let whole = output
            .whole()
            .is_some_and(|path| self.stays(manifest_of_whole, path, &self.fingerprint_of_whole()));
        let stays =
            |frame: &u32| whole || self.stays(manifest, &output.path(*frame), &self.fingerprint);
        let kept = self.frames.iter().copied().filter(stays).collect();
        self.places.push(RunOutput {
            output,
            manifest,
            manifest_of_whole,
            kept,
        });
    }

    /// Whether a file stays.
    fn stays(&self, manifest: Option<usize>, path: &Path, fingerprint: &str) -> bool {
        let state = manifest.map(|manifest| self.manifests[manifest].state(path, fingerprint));
        match self.existing {
            Existing::Overwrite => false,
            Existing::Keep => state.is_some_and(|state| state != FileState::Missing),
            // Previews have no line: they are made with their frame.
            Existing::Resume => state == Some(FileState::UpToDate) && !self.preview,
        }
    }

    /// The first picture of a frame, which stands for all when it is claimed.
    pub(super) fn picture(&self, frame: u32) -> PathBuf {
        let first = self.places.first();
        first.map_or(PathBuf::new(), |place| place.output.path(frame))
    }

    /// Whether other runs have made a frame since it was last looked at.
    pub(super) fn others_made(&mut self, frame: u32) -> bool {
        self.manifests.iter_mut().for_each(Manifest::read_again);
        for at in 0..self.places.len() {
            let place = &self.places[at];
            let picture = place.output.path(frame);
            if self.stays(place.manifest, &picture, &self.fingerprint) {
                self.places[at].kept.insert(frame);
            }
        }
        let made = self.places.iter().all(|place| place.kept.contains(&frame));
        self.others += usize::from(made);
        made
    }

    /// Removes what runs that were killed beside this one have left, once all frames are there.
    pub(super) fn sweep_up(&self) {
        self.sweep(false);
        self.written.folders().for_each(part::sweep);
    }

    /// Removes claims that killed runs have left; those on frames to be made are taken over where frames are claimed.
    fn sweep(&self, claims: bool) {
        let todo: HashSet<u32> = self.todo.iter().copied().collect();
        let left = |frame: &&u32| !(claims && todo.contains(frame));
        for frame in self.frames.iter().filter(left) {
            claim::sweep(&claim::path_of(&self.picture(*frame)));
        }
    }

    /// The manifest at a place; one serves all outputs there.
    fn manifest(&mut self, at: Option<(PathBuf, String)>, settings: &Settings) -> Option<usize> {
        let (folder, stem) = at?;
        let manifest = match settings.output.claim {
            true => Manifest::read_claiming(&folder, &stem, &claim::host()),
            false => Manifest::read(&folder, &stem, settings.output.shard),
        };
        let known = self.manifests.iter();
        let mut known = known.map(Manifest::path);
        Some(
            known
                .position(|path| path == manifest.path())
                .unwrap_or_else(|| {
                    self.manifests.push(manifest);
                    self.manifests.len() - 1
                }),
        )
    }

    /// Chooses the frames to render, and tells how many stay.
    fn plan(&mut self, settings: &Settings, all: &[u32], watch: &(dyn Fn(Event) + Sync)) {
        let stays = |frame: &u32| self.places.iter().all(|place| place.kept.contains(frame));
        let missing: HashSet<u32> = self.frames.iter().copied().filter(|f| !stays(f)).collect();
        let kept = self.frames.len() - missing.len();
        if kept > 0 {
            watch(Event::Kept {
                kept,
                total: self.frames.len(),
                known: settings.output.existing == Existing::Resume,
            });
        }
        if settings.film.aovs.contains(&Aov::Recomputed) {
            let before = all.windows(2).filter(|pair| missing.contains(&pair[1]));
            self.passed = before
                .map(|pair| pair[0])
                .filter(|f| !missing.contains(f))
                .collect();
        }
        let wanted = |frame: &u32| missing.contains(frame) || self.passed.contains(frame);
        self.todo = all.iter().copied().filter(wanted).collect();
    }

    /// Keeps other runs away from the manifests. A moving picture's stills have a lock already.
    fn hold(&mut self, claims: bool) -> Result<()> {
        if self.todo.is_empty() {
            return Ok(());
        }
        for place in &self.places {
            let manifest = match &place.output {
                ImageOutput::Clip(_) => place.manifest_of_whole,
                _ => place.manifest,
            };
            let Some(manifest) = manifest.map(|at| &mut self.manifests[at]) else {
                continue;
            };
            match claims {
                true => manifest.share()?,
                false => manifest.hold()?,
            }
        }
        Ok(())
    }

    /// The frames that movers are swept over: the layer `recomputed` speaks of samples that any frame of the list contests.
    pub(super) fn swept(&self, settings: &Settings, all: &[u32]) -> Vec<u32> {
        match settings.film.aovs.contains(&Aov::Recomputed) {
            true => all.to_vec(),
            false => self.todo.clone(),
        }
    }

    /// The frames to make, without those that are rendered for the next one alone.
    pub(super) fn to_make(&self) -> Vec<u32> {
        let made = self.todo.iter().filter(|frame| !self.passes(**frame));
        made.copied().collect()
    }

    /// The first picture of each output that it will have.
    pub(super) fn first_pictures(&self) -> Vec<PathBuf> {
        let places = self.places.iter().map(|place| &place.output);
        let first = |output: &ImageOutput| match output.whole() {
            Some(whole) => Some(whole.to_path_buf()),
            None => self.frames.first().map(|frame| output.path(*frame)),
        };
        places.filter_map(first).collect()
    }

    /// Number of frames that an earlier run has left, or another has made.
    pub(super) fn kept(&self) -> usize {
        self.frames.len() - self.count()
    }

    /// Writes into a report whose frames these are, and how many were kept.
    pub(super) fn tell(&self, report: &mut Report) {
        report.kept = self.kept() as u64;
        report.fingerprint = Some(self.fingerprint.clone());
    }

    /// Number of frames to make, without those that other runs have made.
    pub(super) fn count(&self) -> usize {
        self.todo.len() - self.passed.len() - self.others
    }

    /// Whether a frame is rendered for the next one alone.
    pub(super) fn passes(&self, frame: u32) -> bool {
        self.passed.contains(&frame)
    }

    /// The outputs that a frame is to be written to, by their numbers.
    pub(super) fn outputs(&self, frame: u32) -> Vec<(usize, ImageOutput)> {
        let places = self.places.iter().enumerate();
        let missing = places.filter(|(_, place)| !place.kept.contains(&frame));
        missing
            .map(|(at, place)| (at, place.output.clone()))
            .collect()
    }

    /// Notes a picture that is there, in an output, with the checksum of its bytes.
    pub(super) fn keep(
        &mut self,
        frame: u32,
        place: usize,
        path: PathBuf,
        blake3: String,
    ) -> Result<()> {
        let Destination::File(file) = Destination::of(&path) else {
            return Ok(());
        };
        self.written.note(frame, file);
        let fingerprint = self.fingerprint.clone();
        self.add(
            self.places[place].manifest,
            frame,
            &path,
            (fingerprint, blake3),
        )
    }

    /// Adds a line to a manifest.
    fn add(
        &mut self,
        manifest: Option<usize>,
        frame: u32,
        path: &Path,
        (fingerprint, blake3): (String, String),
    ) -> Result<()> {
        let Some(manifest) = manifest else {
            return Ok(());
        };
        self.manifests[manifest].add(&FileRecord {
            file: manifest::name(path).into_owned(),
            frame,
            fingerprint,
            blake3,
        })
    }

    /// Brings to its end what needs all frames.
    pub(super) fn finish(&mut self, fps: f64) -> Result<()> {
        let fingerprint = self.fingerprint_of_whole();
        for at in 0..self.places.len() {
            let place = &self.places[at];
            let missing = self.frames.iter().any(|frame| !place.kept.contains(frame));
            let stills = |place: &RunOutput| place.output.path(self.frames[0]).is_file();
            let Some(path) = place.output.whole().map(PathBuf::from) else {
                continue;
            };
            if self.frames.is_empty() || !(missing || stills(place)) {
                continue;
            }
            let of_whole = place.manifest_of_whole;
            if let Some(manifest) = place.manifest {
                self.manifests[manifest].release();
            }
            self.places[at].output.finish(&self.frames, fps)?;
            if let Ok(blake3) = manifest::checksum_of(&path) {
                self.add(
                    of_whole,
                    self.frames[0],
                    &path,
                    (fingerprint.clone(), blake3),
                )?;
            }
        }
        Ok(())
    }

    /// Fingerprint of a file of all frames.
    fn fingerprint_of_whole(&self) -> String {
        let frames = range::text(&self.frames);
        manifest::checksum(format!("{} {frames}", self.fingerprint).as_bytes())
    }

    /// Insists that the pictures are still where they were written.
    ///
    /// # Errors
    /// As [`WrittenFiles::check`].
    pub(super) fn check_kept(&self) -> Result<()> {
        self.written.check()
    }
}
