//! The frames of a run that are still to be made, one after another: all of them, or those that no other run has claimed.
//!
//! With claims a frame is looked at again once it is claimed, for another run may have finished it in between; and a run ends
//! when all frames are there, whoever made them: it waits for those of the others, and takes over what a killed one left.

use super::files::Files;
use super::observer::Event;
use crate::error::{Error, Result};
use crate::io::claim::{self, ClaimAttempt, ClaimOwner, Claims, FrameClaim};
use crate::settings::Settings;
use std::collections::VecDeque;
use std::path::Path;
use std::thread;
use std::time::Duration;

/// Whoever waits for other runs looks so often.
const PAUSE: Duration = Duration::from_millis(200);

/// The frames that are left.
pub(super) struct Queue {
    left: VecDeque<u32>,
    claims: Option<Claims>,
}

/// A frame to be made, free for others when it is dropped.
pub(super) struct ClaimedFrame {
    pub(super) frame: u32,
    _claim: Option<FrameClaim>,
}

impl Queue {
    /// All frames that the files need.
    pub(super) fn of(settings: &Settings, files: &Files) -> Queue {
        let me = || Claims::of(ClaimOwner::here(&files.fingerprint));
        Queue {
            left: files.todo.iter().copied().collect(),
            claims: settings.output.claim.then(me),
        }
    }

    /// The next frame; none when all are there.
    ///
    /// # Errors
    /// [`Error::Write`] where a claim cannot be made, or a run of another fingerprint has one.
    pub(super) fn next(
        &mut self,
        files: &mut Files,
        watch: &(dyn Fn(Event) + Sync),
    ) -> Result<Option<ClaimedFrame>> {
        let Some(claims) = &mut self.claims else {
            let turn = |frame| ClaimedFrame {
                frame,
                _claim: None,
            };
            return Ok(self.left.pop_front().map(turn));
        };
        let mut waits = false;
        while !self.left.is_empty() {
            for _ in 0..self.left.len() {
                let Some(frame) = self.left.pop_front() else {
                    break;
                };
                let picture = files.picture(frame);
                let attempt = claims
                    .attempt(&picture)
                    .map_err(|e| refused(&picture, &e))?;
                match attempt {
                    ClaimAttempt::Ours(claim) if !files.others_made(frame) => {
                        told(frame, &claim, watch);
                        return Ok(Some(ClaimedFrame {
                            frame,
                            _claim: Some(claim),
                        }));
                    }
                    ClaimAttempt::Ours(_) => {}
                    ClaimAttempt::Others(owner) => {
                        let other = owner.filter(|o| o.fingerprint != files.fingerprint);
                        if let Some(other) = other {
                            return Err(of_others(&picture, &other));
                        }
                        self.left.push_back(frame);
                    }
                }
            }
            if !self.left.is_empty() && !waits {
                waits = true;
                watch(Event::Stage {
                    name: "wait for other runs",
                    total: 0,
                });
            }
            if !self.left.is_empty() {
                thread::sleep(PAUSE);
            }
        }
        files.sweep_up();
        Ok(None)
    }
}

/// Tells that a frame was taken over.
fn told(frame: u32, claim: &FrameClaim, watch: &(dyn Fn(Event) + Sync)) {
    if let Some(ClaimOwner { host, pid, .. }) = &claim.left_by {
        watch(Event::Warning(&format!(
            "frame {frame}: process {pid} on {host} claimed it and is gone: it is rendered here"
        )));
    }
}

/// The error of a claim that cannot be made.
fn refused(picture: &Path, source: &std::io::Error) -> Error {
    Error::Write {
        path: claim::path_of(picture),
        reason: source.to_string(),
        way_out: "name a folder that you may write to, or leave --claim out".into(),
    }
}

/// The error of a frame that a run of another scene or other settings renders.
fn of_others(picture: &Path, ClaimOwner { host, pid, .. }: &ClaimOwner) -> Error {
    Error::Write {
        path: picture.into(),
        reason: format!(
            "process {pid} on {host} renders it from another scene or with other settings"
        ),
        way_out: "give all runs the same command, or name other files".into(),
    }
}
