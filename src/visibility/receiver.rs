//! One receiver's answers in a view, and the asking of all of them afresh: by a full trace, and by an update on a mover.

use super::store::{LAMPS, Questions};
use super::{Nothing, Stage, sample};
use crate::emission::sampling::{LightSample, Scratch};
use crate::emission::{Emitters, FilteredSky};
use crate::formfactor::hemisphere::Asker;
use crate::geometry::{Hit, Ray};
use crate::mesh::{Patches, Placed};
use crate::visibility::packed_ids::RowMut;
use glam::Vec3;

/// The second of the [`LAMPS`].
const MOVING: usize = 1;

/// One receiver's slots in a [`Half`](super::store::Half).
pub(super) struct Slots<'a> {
    pub(super) answers: RowMut<'a>,
    pub(super) reach: &'a mut [f32],
    pub(super) covered: &'a mut u16,
    pub(super) light: [&'a mut [u32]; LAMPS],
    pub(super) points: [&'a mut [u32]; LAMPS],
    pub(super) direct: [&'a mut Vec3; LAMPS],
    pub(super) sky: &'a mut Vec3,
}

/// Asks all samples of one receiver.
#[expect(
    clippy::too_many_arguments,
    reason = "the receiver, the scene, and space for the answers"
)]
pub(super) fn everything(
    patches: &Patches,
    stage: &Stage,
    questions: &Questions,
    asker: &Asker,
    side: u32,
    sky: Option<&FilteredSky>,
    scratch: &mut Scratch,
    slots: &mut Slots,
) {
    *slots.covered = sample::covered(asker, |ray| stage.covers(patches, ray));
    let closest = |ray: &Ray| stage.closest(ray);
    for k in 0..slots.answers.len() {
        let nothing = questions.nothing;
        hemisphere(patches, stage.placed, nothing, asker, k, closest, slots);
    }
    if let Some(sky) = sky {
        *slots.sky = sample::sky(sky, questions.nothing, asker, slots.answers.read().iter());
    }
    let mut aim = sample::Aim::default();
    for (lamp, cells) in questions.lamps.into_iter().enumerate() {
        if !cells.is_dark() {
            lights(
                patches, stage, asker, side, cells, lamp, scratch, &mut aim, slots,
            );
        }
    }
}

/// Asks hemisphere sample k of a receiver afresh; `closest` is the first thing a ray meets.
pub(super) fn hemisphere(
    patches: &Patches,
    placed: &Placed,
    nothing: Nothing,
    asker: &Asker,
    k: usize,
    closest: impl Fn(&Ray) -> Option<Hit>,
    slots: &mut Slots,
) {
    if sample::is_covered(*slots.covered, k) {
        slots.answers.set(k, nothing.covered);
        return;
    }
    let ray = sample::hemisphere_ray(asker, k);
    let hit = closest(&ray);
    let answer = sample::answer(patches, placed, nothing, hit.as_ref(), ray.direction);
    slots.answers.set(k, answer);
    if slots.reach.len() == slots.answers.len() {
        slots.reach[k] = hit.map_or(f32::INFINITY, |h| h.t);
    }
}

/// Aims and asks all light samples of a receiver to one kind of emitter, surfaces and lights.
#[expect(
    clippy::too_many_arguments,
    reason = "the receiver, the scene, and space for the answers"
)]
pub(super) fn lights(
    patches: &Patches,
    stage: &Stage,
    asker: &Asker,
    side: u32,
    cells: &Emitters,
    lamp: usize,
    scratch: &mut Scratch,
    aim: &mut sample::Aim,
    slots: &mut Slots,
) {
    self::aim(patches, asker, side, cells, lamp, scratch, aim, slots);
    let free = |s: usize| {
        let sample = &aim.samples[s];
        sample::is_free(asker, sample, s, patches.lift, |ray| stage.blocked(ray))
    };
    sample::light(&aim.samples, *slots.covered, free, slots.light[lamp]);
    for (l, light) in cells.lights.iter().enumerate() {
        let may = sample::reach(light, &cells.lasting[l], asker) & !*slots.covered;
        let free = |o| !stage.blocked(&sample::light_ray(light, asker, o, side, patches.lift));
        slots.points[lamp][l] = sample::points(may, free);
    }
    relight(asker, cells, lamp, &aim.factors, &aim.samples, slots);
}

/// Aims the light samples of a receiver at one kind of emitting surfaces, as its covered origins now let it.
#[expect(
    clippy::too_many_arguments,
    reason = "the receiver, the emitters, and space for the samples"
)]
pub(super) fn aim(
    patches: &Patches,
    asker: &Asker,
    side: u32,
    cells: &Emitters,
    lamp: usize,
    scratch: &mut Scratch,
    aim: &mut sample::Aim,
    slots: &Slots,
) {
    sample::aim(
        cells,
        asker,
        slots.light[lamp].len(),
        (lamp == MOVING || side >= patches.static_sides) && *slots.covered == 0,
        side,
        patches.lift,
        scratch,
        aim,
    );
}

/// Adds up what the answers to one kind of emitter bring now.
pub(super) fn relight(
    asker: &Asker,
    cells: &Emitters,
    lamp: usize,
    factors: &[Vec3],
    samples: &[LightSample],
    slots: &mut Slots,
) {
    let surfaces = sample::irradiance(cells, factors, samples, slots.light[lamp]);
    let lights = &cells.lights;
    let lights = sample::irradiance_of_lights(lights, asker, *slots.covered, slots.points[lamp]);
    *slots.direct[lamp] = surfaces + lights;
}
