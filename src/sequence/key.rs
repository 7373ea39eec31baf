//! The key light: the light of one frame, solved in preparation, from which every frame's solve starts.
//!
//! A solve ends within a tolerance, so where it starts may show in the last bits. Were that the light of the frame rendered
//! before, a frame would depend on the others of the run. The key frame stands in the middle of the clip, whichever frames
//! are rendered: so any order, any subset and any resumed run gives a frame the same bits. From the frame before, a frame
//! of the scenes in `animations` took 5.3 to 6.5 sweeps, from a key frame in the middle 6.5 to 9.1, from one at the start
//! 7.1 to 9.3, from the light without movers 7.9 to 12, from darkness 10.6 to 12.6; a key frame in every twelve would save
//! a half to two of them, and each part of a farm would have to solve for more key frames. A sweep takes a millisecond.

use super::prepared::{KeyLight, Prepared};
use super::renderer::Renderer;
use super::timeline::{self, Moment};
use crate::image::aims::{Aims, SolvedScene};
use crate::scene::Animation;
use crate::settings::Settings;

/// The moment of the key light, in the middle of the clip.
pub(super) fn moment(settings: &Settings, animation: &Animation) -> Moment {
    let frame = timeline::last_frame(settings, animation) / 2;
    Moment {
        frame,
        time: f64::from(frame) / settings.scene.fps,
    }
}

/// Whether solves start from darkness instead of the key light: those from scratch, those that a number of shots stops, whose
/// pictures tell how far so many shots get, and those with previews on the way.
pub(super) fn starts_dark(settings: &Settings) -> bool {
    settings.solve.from_scratch || settings.solve.shots.is_some() || settings.output.preview
}

/// Solves for the key light, unless neither solves nor gathering samples need it.
pub(super) fn solve(prepared: &Prepared) -> KeyLight {
    let settings = &prepared.settings;
    let dark = starts_dark(settings);
    if settings.image.is_phong() || dark && !settings.image.finish.gathers() {
        return KeyLight::default();
    }
    let (light, report) = Renderer::new(prepared).solve_key();
    KeyLight {
        light,
        seconds: (!dark).then_some(report.seconds),
    }
}

/// At what gathering samples aim by the key light, if at anything: the same in every frame, in whatever order or way it is
/// rendered.
pub(super) fn aims(prepared: &Prepared) -> Option<Aims> {
    let (patches, finish) = (&prepared.patches, &prepared.image.finish);
    let sky = finish.sky().filter(|_| finish.aims > 0);
    let accel = sky.map(|_| prepared.accel_from_scratch(&prepared.rest));
    let scene = SolvedScene {
        patches,
        placed: &prepared.rest,
        reflected: &prepared.key.light.reflected,
        sky: sky.zip(accel.as_ref()),
    };
    Aims::choose(&scene, |side| patches.rests(side), finish.aims)
}
