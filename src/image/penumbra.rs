//! How wide a penumbra is: of a wide one few light samples a pixel tell enough, for neighbours share theirs.
//!
//! An emitter so wide, w, behind the edge of an occluder leaves a penumbra w t / (d − t) wide, where d is the way to the emitter
//! and t that to the occluder. What is many pixels wide `denoise.rs` smooths without loss (Mehta, Wang, Ramamoorthi 2012,
//! "Axis-aligned filtering for interactive sampled soft shadows", ACM Transactions on Graphics 31(6):163, filter by that width
//! too); what is narrow needs all samples of its own.

use super::context::ShadingContext;
use super::fragment::Fragment;
use crate::geometry::Ray;

/// Pixels from which on a penumbra is wide: about what the filters reach to one side. With 12 as with 3 the errors of rooms
/// stayed the same.
const WIDE: f32 = 6.0;

/// Whether the penumbra in which a plane of a pixel lies is narrow, as far as one occluded light sample tells: `ray` is its own, and
/// `width` is the emitter's, in metres across the ray; of a direction, the tangent of the angle under which it is seen.
pub(super) fn is_sharp(scene: &ShadingContext, group: &Fragment, ray: &Ray, width: f32) -> bool {
    // What clear surfaces darken has no occluder.
    let Some(hit) = scene.accel.intersect(ray) else {
        return true;
    };
    let way = group.point - scene.camera.eye;
    let distance = way.length().max(f32::MIN_POSITIVE);
    let across = behind(width, hit.t, ray.tmax) * way.dot(group.normal).abs() / distance;
    across < WIDE * scene.camera.pixel_width(distance)
}

/// How wide the penumbra is that an occluder at `t` metres leaves of an emitter at `end`; of a direction that is infinite.
fn behind(width: f32, t: f32, end: f32) -> f32 {
    match end.is_finite() {
        true => width * t / (end - t).max(f32::MIN_POSITIVE),
        false => width * t,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By similar triangles: half way the penumbra is as wide as the emitter, at a quarter a third of it.
    #[test]
    fn it_grows_with_the_way_to_the_occluder() {
        assert!((behind(0.6, 2.0, 4.0) - 0.6).abs() < 1e-6);
        assert!((behind(0.6, 1.0, 4.0) - 0.2).abs() < 1e-6);
        // A sun of 0.5 degrees behind a roof 10 m away.
        assert!((behind(0.0087, 10.0, f32::INFINITY) - 0.087).abs() < 1e-6);
    }
}
