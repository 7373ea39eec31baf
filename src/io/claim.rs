//! A claim on a frame: a file beside its picture that names who renders it, so that several runs share the frames.
//!
//! The file is made by one run alone, and locked for as long as that run lives: the system frees the lock however it ends. A
//! claim that nobody locks was left by a run that was killed, and is taken over. Where locks do not reach from machine to
//! machine, a lock that is free says nothing of an owner elsewhere: the owner touches its file now and then, and a file
//! that nobody touches for [`STALE`] is taken over. Whoever waits looks for changes, and compares no clocks.

use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use serde::{Deserialize, Serialize};

use crate::io::{destination, part};

/// The end of the names.
const EXTENSION: &str = ".claim";

/// An owner touches its claim so often.
const BEAT: Duration = Duration::from_secs(15);

/// A claim from another machine that nobody has touched for so long is nobody's: eight beats.
pub const STALE: Duration = Duration::from_secs(120);

/// Attempts to lock the file that is there, and not one that its last holder has just removed.
const ATTEMPTS: u32 = 8;

/// The longest text of a claim that is read.
const LONGEST: u64 = 4096;

/// Who renders a frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClaimOwner {
    /// Its machine.
    pub host: String,
    /// Its process there.
    pub pid: u32,
    /// Fingerprint of what it renders.
    pub fingerprint: String,
}

impl ClaimOwner {
    /// This process.
    pub fn here(fingerprint: &str) -> ClaimOwner {
        ClaimOwner {
            host: host(),
            pid: std::process::id(),
            fingerprint: fingerprint.into(),
        }
    }
}

/// The name of this machine.
pub fn host() -> String {
    let kernel = fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let variable = |name| std::env::var(name).ok();
    let name = kernel.or_else(|| variable("HOSTNAME").or_else(|| variable("COMPUTERNAME")));
    name.map_or("this machine".into(), |name| name.trim().into())
}

/// A frame that is this run's to render; dropped, it is free again.
#[derive(Debug)]
pub struct FrameClaim {
    path: PathBuf,
    _file: File,
    /// The run that left it, if it was taken over.
    pub left_by: Option<ClaimOwner>,
    /// Closed, the beats end.
    _beats: Sender<()>,
}

/// What became of an attempt to claim a frame.
#[derive(Debug)]
pub enum ClaimAttempt {
    /// It is this run's.
    Ours(FrameClaim),
    /// Another run has it; nothing is known of one that has just begun.
    Others(Option<ClaimOwner>),
}

/// Claims on frames, and when those of other runs were last seen to change.
#[derive(Debug)]
pub struct Claims {
    me: ClaimOwner,
    seen: HashMap<PathBuf, (Option<SystemTime>, Instant)>,
    stale: Duration,
}

/// The file that claims a picture.
pub fn path_of(picture: &Path) -> PathBuf {
    let mut name = picture.as_os_str().to_owned();
    name.push(EXTENSION);
    name.into()
}

/// Removes a claim that a killed run has left, if it is one.
pub fn sweep(path: &Path) {
    if let Ok(file) = File::open(path)
        && file.try_lock().is_ok()
        && owner(&file).is_none_or(|owner| owner.host == host())
    {
        let _ = fs::remove_file(path);
    }
}

impl Claims {
    /// No claims yet.
    pub fn of(me: ClaimOwner) -> Claims {
        Claims {
            me,
            seen: HashMap::new(),
            stale: STALE,
        }
    }

    /// Tries to claim a picture.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn attempt(&mut self, picture: &Path) -> io::Result<ClaimAttempt> {
        let path = path_of(picture);
        for _ in 0..ATTEMPTS {
            fs::create_dir_all(destination::folder(&path))?;
            let mut open = File::options();
            let made = open.read(true).write(true).create_new(true).open(&path);
            let new = made.is_ok();
            let file = match made {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    File::options().read(true).write(true).open(&path)
                }
                made => made,
            };
            let file = match file {
                // Its last holder has just removed it.
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                file => file?,
            };
            let free = match file.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    return Ok(ClaimAttempt::Others(owner(&file)));
                }
                // On a file system without locks it is of whoever made it.
                Err(TryLockError::Error(_)) => new,
                Ok(()) => true,
            };
            if !is_at(&file, &path) {
                continue;
            }
            let left_by = owner(&file);
            let elsewhere = left_by
                .as_ref()
                .is_some_and(|left| left.host != self.me.host);
            if (elsewhere || !free) && !self.is_stale(&path, &file) {
                return Ok(ClaimAttempt::Others(left_by));
            }
            self.seen.remove(&path);
            return self.take(path, file, left_by).map(ClaimAttempt::Ours);
        }
        Ok(ClaimAttempt::Others(None))
    }

    /// Whether nobody has touched a claim for long.
    fn is_stale(&mut self, path: &Path, file: &File) -> bool {
        let touched = file.metadata().and_then(|about| about.modified()).ok();
        let new = (touched, Instant::now());
        let seen = self.seen.entry(path.into()).or_insert(new);
        if seen.0 != touched {
            *seen = new;
        }
        seen.1.elapsed() >= self.stale
    }

    /// Writes this run's name into a claim.
    fn take(
        &self,
        path: PathBuf,
        mut file: File,
        left_by: Option<ClaimOwner>,
    ) -> io::Result<FrameClaim> {
        part::list(&path, true);
        let text = serde_json::to_string(&self.me).unwrap_or_default() + "\n";
        let written = file
            .set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| file.write_all(text.as_bytes()))
            .and_then(|()| file.try_clone());
        let touched = match written {
            Ok(touched) => touched,
            Err(error) => {
                part::list(&path, false);
                let _ = fs::remove_file(&path);
                return Err(error);
            }
        };
        let (beats, end) = mpsc::channel();
        thread::spawn(move || {
            while end.recv_timeout(BEAT) == Err(RecvTimeoutError::Timeout) {
                let _ = touched.set_modified(SystemTime::now());
            }
        });
        Ok(FrameClaim {
            path,
            _file: file,
            left_by,
            _beats: beats,
        })
    }
}

impl Drop for FrameClaim {
    fn drop(&mut self) {
        // It goes while it is locked, so that nobody takes it for one that was left.
        if is_at(&self._file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
        part::list(&self.path, false);
    }
}

/// Whether a file is the one at a path.
fn is_at(file: &File, path: &Path) -> bool {
    match (file.metadata(), fs::metadata(path)) {
        (Ok(here), Ok(there)) => destination::inode(&here) == destination::inode(&there),
        _ => false,
    }
}

/// Who has a claim, as far as it is written.
fn owner(file: &File) -> Option<ClaimOwner> {
    let mut text = Vec::new();
    let mut file = file;
    file.rewind().ok()?;
    file.take(LONGEST).read_to_end(&mut text).ok()?;
    serde_json::from_slice(&text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn owned(host: &str) -> ClaimOwner {
        ClaimOwner {
            host: host.into(),
            pid: 7,
            fingerprint: "f".into(),
        }
    }

    fn ours(attempt: io::Result<ClaimAttempt>) -> Option<FrameClaim> {
        match attempt.expect("a folder") {
            ClaimAttempt::Ours(claim) => Some(claim),
            ClaimAttempt::Others(_) => None,
        }
    }

    #[test]
    fn one_of_two_has_a_frame_until_it_lets_go() {
        let folder = tempfile::tempdir().expect("a folder");
        let picture = folder.path().join("a/x_0001.png");
        let [mut one, mut two] = [1, 2].map(|_| Claims::of(ClaimOwner::here("f")));
        let claim = ours(one.attempt(&picture)).expect("a claim");
        match two.attempt(&picture).expect("a folder") {
            ClaimAttempt::Others(Some(owner)) => assert_eq!(owner, ClaimOwner::here("f")),
            other => panic!("{other:?}"),
        }
        sweep(&path_of(&picture));
        assert!(path_of(&picture).exists(), "a claim that is held was swept");
        drop(claim);
        assert!(!path_of(&picture).exists());
        let claim = ours(two.attempt(&picture)).expect("a claim");
        assert_eq!(claim.left_by, None);
    }

    #[test]
    fn what_a_killed_run_left_is_taken_over_and_from_elsewhere_when_it_is_stale() {
        let folder = tempfile::tempdir().expect("a folder");
        let picture = folder.path().join("x_0001.png");
        let leave = |host: &str| {
            let text = serde_json::to_string(&owned(host)).expect("text");
            fs::write(path_of(&picture), text).expect("a file");
        };
        let mut claims = Claims::of(ClaimOwner::here("f"));
        leave(&host());
        let claim = ours(claims.attempt(&picture)).expect("a claim");
        assert_eq!(claim.left_by, Some(owned(&host())));
        drop(claim);
        leave("elsewhere");
        sweep(&path_of(&picture));
        assert!(ours(claims.attempt(&picture)).is_none(), "not stale yet");
        // Touched, it stays alive; left alone, it does not.
        claims.stale = Duration::from_millis(200);
        thread::sleep(claims.stale);
        let file = File::options().append(true).open(path_of(&picture));
        let later = SystemTime::now() + Duration::from_secs(5);
        file.expect("a file").set_modified(later).expect("a time");
        assert!(ours(claims.attempt(&picture)).is_none(), "it was touched");
        thread::sleep(claims.stale);
        let claim = ours(claims.attempt(&picture)).expect("a claim");
        assert_eq!(claim.left_by, Some(owned("elsewhere")));
        // Half a name is nobody's.
        drop(claim);
        fs::write(path_of(&picture), "{\"host\": \"el").expect("a file");
        assert!(ours(claims.attempt(&picture)).is_some());
    }
}
