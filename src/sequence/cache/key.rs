//! What a preparation depends on, as a key: files of the same key hold the same.
//!
//! It covers the bytes of every file of the scene, the light that it was given, each setting but those that only pictures know,
//! and the version. A camera counts only where it decides what is prepared: where it sizes the mesh, and where light from
//! outside may be kept from what it sees, which is warned of. So several cameras, sizes of pictures, and parts of the frames
//! share one preparation.

use super::label::FORMAT;
use crate::error::Result;
use crate::io::range;
use crate::scene::light::LightKind;
use crate::sequence::fingerprint;
use crate::sequence::key;
use crate::sequence::opening::Opened;
use crate::sequence::timeline;
use crate::settings::{Aov, Choice, Film, ImageSettings, Meshing, Settings};
use std::collections::HashSet;
use std::fmt::Write;

/// Movers of longer clips are swept over the frames of the run alone: the others would cost more than they gain.
const MOST_SWEPT: u32 = 10_000;

/// The frames that movers are swept over: those of the whole clip, and what else is rendered. The layer `recomputed` speaks of
/// the frames of the run alone.
pub(super) fn swept(opened: &Opened) -> Vec<u32> {
    let (settings, animation) = (&opened.settings, &opened.animation);
    let last = timeline::last_frame(settings, animation);
    let moves = animation.moves();
    let alone = settings.film.aovs.contains(&Aov::Recomputed);
    if alone || last > MOST_SWEPT || !moves.contains(&true) {
        return opened.frames.clone();
    }
    // A pose that cannot be rendered bounds nothing; the frames of the run have been looked at.
    let asked: HashSet<u32> = opened.frames.iter().copied().collect();
    let fits = |frame: &u32| {
        let mut times = timeline::times(settings, *frame).into_iter();
        let sound = |time| (animation.check(&animation.pose(time), |i| moves[i])).is_ok();
        asked.contains(frame) || times.all(sound)
    };
    let mut all: Vec<u32> = (0..=last).filter(fits).collect();
    let mut others: Vec<u32> = asked.into_iter().filter(|frame| *frame > last).collect();
    others.sort_unstable();
    all.extend(others);
    all
}

/// The key.
///
/// # Errors
/// [`Error::Read`](crate::error::Error::Read) where a file of the scene has gone away.
pub(super) fn of(opened: &Opened) -> Result<[u8; 32]> {
    let animation = &opened.animation;
    let mut text = format!(
        "sweeplight {} preparation {}\n{:?}\n",
        env!("CARGO_PKG_VERSION"),
        FORMAT,
        of_preparation(&opened.settings)
    );
    if animation.moves().contains(&true) {
        let _ = writeln!(text, "{}", range::text(&opened.swept));
    }
    // Lamps may have been added, which no file tells of.
    let _ = writeln!(text, "{:?}", animation.light_scale);
    for lamp in &animation.lamps {
        let (light, node) = (&animation.lights[lamp.light], &animation.nodes[lamp.node]);
        let _ = writeln!(text, "{lamp:?} {light:?} {:?}", node.rest);
    }
    if knows_camera(opened) {
        let _ = writeln!(text, "{:?}", opened.eye);
    }
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes());
    fingerprint::add_files(&mut hasher, &opened.settings, animation)?;
    Ok(*hasher.finalize().as_bytes())
}

/// Whether the preparation depends on who looks.
fn knows_camera(opened: &Opened) -> bool {
    let (settings, animation) = (&opened.settings, &opened.animation);
    let mut kinds = (animation.lamps.iter()).map(|lamp| animation.lights[lamp.light].kind);
    settings.solve.mesh == Meshing::Adaptive
        || settings.light.sky.is_some()
        || settings.light.sun.is_some()
        || kinds.any(|kind| kind == LightKind::Directional)
}

/// The settings without what no preparation depends on.
fn of_preparation(settings: &Settings) -> Settings {
    let mut known = fingerprint::of_pixels(settings);
    // A walk adds a clip; which camera is looked through is known by its number.
    known.scene.camera = Choice::First;
    known.film = Film {
        shutter: settings.film.shutter,
        sub_frames: settings.film.sub_frames,
        ..Film::default()
    };
    if settings.solve.mesh == Meshing::Adaptive {
        return known;
    }
    let image = ImageSettings::default();
    known.image.size = image.size;
    known.image.pixel_samples = image.pixel_samples;
    known.image.finish_samples = image.finish_samples;
    known.image.direct = image.direct;
    known.image.exposure = image.exposure;
    // Where solves start from darkness, only pixels that gather need a key light.
    if !(settings.image.is_phong() || key::starts_dark(settings)) {
        known.image.finish = image.finish;
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::observer::silence;
    use crate::settings::{Exposure, Shard, SkyChoice};

    type Setter = fn(&mut Settings);

    fn key(change: impl Fn(&mut Settings)) -> [u8; 32] {
        let mut settings = Settings::new("animations/cornell.glb");
        settings.solve.samples = Some(32);
        settings.scene.frames = Some(vec![3]);
        change(&mut settings);
        let mut opened = Opened::of(&settings, &silence).expect("a scene");
        opened.swept = swept(&opened);
        of(&opened).expect("a key")
    }

    #[test]
    fn what_only_pictures_know_does_not_count() {
        let plain = key(|_| ());
        let same: [(&str, Setter); 9] = [
            ("size", |s| s.image.size = (32, 18)),
            ("frames", |s| s.scene.frames = Some(vec![9, 1, 7])),
            ("all frames", |s| s.scene.frames = None),
            ("camera", |s| {
                s.scene.camera = Choice::Named("auto-outside".into())
            }),
            ("exposure", |s| s.image.exposure = Exposure::Stops(1.0)),
            ("layers", |s| s.film.aovs = vec![Aov::Depth]),
            ("threads", |s| s.solve.threads = Some(1)),
            ("memory", |s| s.solve.memory_limit = Some(1 << 40)),
            ("outputs", |s| {
                s.output.images = vec!["x_####.exr".into()];
                s.output.shard = Some(Shard { part: 1, parts: 2 });
            }),
        ];
        for (name, change) in same {
            assert_eq!(key(change), plain, "{name}");
        }
    }

    #[test]
    fn what_is_prepared_otherwise_has_another_key() {
        let mut keys = vec![key(|_| ())];
        let other: [Setter; 12] = [
            |s| s.scene.file = "animations/door.glb".into(),
            |s| s.scene.frames = Some(vec![1000]),
            |s| s.film.aovs = vec![Aov::Recomputed],
            |s| s.film.shutter = 0.5,
            |s| s.scene.fps = 12.0,
            |s| s.solve.samples = Some(64),
            |s| s.solve.element_size = Some(0.7),
            |s| s.light.emission_scale = 2.0,
            |s| s.light.sky = Some(SkyChoice::Even([1.0; 3])),
            |s| {
                s.light.sky = Some(SkyChoice::Even([1.0; 3]));
                s.scene.camera = Choice::Named("auto-outside".into());
            },
            |s| s.solve.from_scratch = true,
            |s| s.output.preview = true,
        ];
        keys.extend(other.map(key));
        let all = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), all);
    }
}
