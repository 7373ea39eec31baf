//! Direct light of lights without a surface on a fragment of a pixel: hard shadows and edges of cones from the few points that
//! the pixel keeps, soft shadows from a disk.
//!
//! The unoccluded light is a closed form (`emission/punctual.rs`) at the fragment's middle; where the edge of a spot's cone
//! crosses it, the mean over its points, so that the edge is as smooth as any other in the picture.

use super::context::ShadingContext;
use super::fragment::Fragment;
use super::shadow_test::{self, LEAST_SAMPLES};
use super::static_visibility::{self, SampleSet, StaticVisibility};
use crate::emission::punctual::{self, PeakLight, PunctualLight};
use crate::emission::sampling;
use crate::scene::light::LightKind;
use glam::{Vec2, Vec3};

/// Of how many points of a plane the unoccluded light is taken: of all that are kept where a cone may have its edge.
fn lit_points(light: &PunctualLight, group: &Fragment) -> usize {
    match light.kind {
        LightKind::Spot => group.kept(),
        LightKind::Point | LightKind::Directional => 1,
    }
}

/// Whether a light may ever shine on one of a plane's points, as long as it stands as now.
pub(super) fn reaches(light: &PunctualLight, peak: &PeakLight, group: &Fragment) -> bool {
    let reaches = |point: Vec3| light.may_reach(peak, point, group.smooth.normal);
    match lit_points(light, group) {
        1 => reaches(group.point),
        points => (0..points).any(|k| reaches(group.start(k))),
    }
}

/// What multiplies a light's power to give the irradiance at a plane, when nothing but the plane itself stands in between.
pub(super) fn unoccluded_share(light: &PunctualLight, group: &Fragment) -> f32 {
    let share = mean_share(light, group);
    if !group.smooth.is_bumped() {
        return share;
    }
    let towards = light.ray(group.point, 0.0, Vec2::ZERO).direction;
    share * group.smooth.softened(towards.normalize_or_zero())
}

/// The mean of a light's share over a plane.
fn mean_share(light: &PunctualLight, group: &Fragment) -> f32 {
    let share = |point: Vec3| light.share(point, group.smooth.normal);
    match lit_points(light, group) {
        1 => share(group.point),
        points => (0..points).map(|k| share(group.start(k))).sum::<f32>() / points as f32,
    }
}

/// Whether the edge of a light's cone crosses the points of a plane.
fn on_edge(light: &PunctualLight, group: &Fragment) -> bool {
    let points = 0..lit_points(light, group);
    let mut shares = points.map(|k| light.share(group.start(k), group.smooth.normal) > 0.0);
    shares
        .next()
        .is_some_and(|first| shares.any(|other| other != first))
}

/// The few samples of a light at a plane, or the many of a penumbra, `times` as many and as many as an emitter's.
pub(super) fn count(
    scene: &ShadingContext,
    light: &PunctualLight,
    group: &Fragment,
    times: usize,
) -> u32 {
    let few = match on_edge(light, group) {
        true => LEAST_SAMPLES.max(group.kept()),
        false => LEAST_SAMPLES,
    };
    let count = match light.spread > 0.0 {
        true if times > 1 => (few * times).max(scene.params.light_samples),
        true => few,
        false => (few * times).min(group.kept()),
    };
    count as u32
}

/// The visible share of a light at a plane; leaves what was free in `free`.
///
/// A hard light's shadow rays leave from the few points of the plane that the pixel keeps, a wide one's over its disk too.
pub(super) fn visible_share(
    scene: &ShadingContext,
    light: &PunctualLight,
    group: &Fragment,
    set: SampleSet,
    seed: u32,
    kept: Option<&mut StaticVisibility>,
    free: &mut Vec<bool>,
) -> Vec3 {
    let ray = |s: usize| {
        let turn = match light.spread > 0.0 {
            true => punctual::turn(seed, s),
            false => Vec2::ZERO,
        };
        let ray = |start: Vec3| light.ray(start, scene.patches.ray_offset, turn);
        let mut traced = ray(group.start(s));
        if group.smooth.rise > 0.0 {
            traced = ray(group.start_towards(s, traced.direction));
        }
        traced
    };
    static_visibility::trace(scene.accel, kept, set, ray, free);
    let share = |s: usize| light.share(group.start(s), group.smooth.normal);
    let samples = free.iter_mut().enumerate().map(|(s, free)| {
        let arrives = shadow_test::arrives(free, || scene.transmittance(&ray(s)));
        (share(s), arrives)
    });
    sampling::visible_share(samples)
}
