//! The frames of a sequence and their times: frame n shows time n / fps, or several moments about it while the shutter is open.

use crate::error::{Error, Result};
use crate::io::range::MOST_FRAMES;
use crate::scene::Animation;
use crate::scene::pose::Pose;
use crate::settings::Settings;

/// Frame numbers of the settings, or all of the clip: frame n shows time n / fps, the last one is not after its end.
///
/// # Errors
/// [`Error::Usage`] when none are chosen and the clip has more than [`MOST_FRAMES`].
pub fn frames(settings: &Settings, animation: &Animation) -> Result<Vec<u32>> {
    if let Some(frames) = &settings.scene.frames {
        return Ok(frames.clone());
    }
    let last = last_frame(settings, animation);
    if u64::from(last) >= MOST_FRAMES {
        return Err(Error::Usage {
            flag: "--frames".into(),
            expected: format!("a choice, for a whole animation has at most {MOST_FRAMES} frames"),
            got: format!("none, and {:e} seconds of animation", animation.seconds()),
            way_out: "name the frames to render, or correct the animation's last key".into(),
        });
    }
    Ok((0..=last).collect())
}

/// The last frame of the clip.
pub fn last_frame(settings: &Settings, animation: &Animation) -> u32 {
    // A hair of tolerance, so that a key at exactly n / fps counts in spite of its 32-bit time.
    (animation.seconds() * settings.scene.fps + 1e-3).floor() as u32
}

/// The pose that a frame shows.
pub fn pose(animation: &Animation, settings: &Settings, frame: u32) -> Pose {
    animation.pose(frame as f64 / settings.scene.fps)
}

/// The times that a frame shows, in seconds: n / fps, or, while the shutter is open, moments at even steps about it.
pub fn times(settings: &Settings, frame: u32) -> Vec<f64> {
    let moments = settings.film.moments();
    let time = |k: u32| {
        let part = (f64::from(k) + 0.5) / f64::from(moments) - 0.5;
        (f64::from(frame) + settings.film.shutter * part) / settings.scene.fps
    };
    if moments == 1 {
        return vec![f64::from(frame) / settings.scene.fps];
    }
    (0..moments).map(time).collect()
}

/// A time at which the scene is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The frame that it is part of.
    pub frame: u32,
    /// Its time in seconds.
    pub time: f64,
}

/// The moments of these frames, in the order in which they are rendered.
pub fn moments(settings: &Settings, frames: &[u32]) -> Vec<Moment> {
    let of = |&frame: &u32| {
        let times = times(settings, frame).into_iter();
        times.map(move |time| Moment { frame, time })
    };
    frames.iter().flat_map(of).collect()
}
