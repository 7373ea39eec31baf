//! Surface at a primary hit, from the textures themselves; the solve uses their means over elements.
//!
//! Light is sought for planes and interpolated between vertices, but what a surface makes of it may change from pixel to
//! pixel. So each primary sample looks into the pictures, as closely as a pixel's samples are apart: a pixel is sharp
//! near by, and shows the mean of what it cannot resolve, whatever its camera does.

use super::context::ShadingContext;
use super::footprint::footprint;
use crate::geometry::{Hit, Ray};
use crate::ids::SurfaceId;
use crate::scene::tangents::Tangent;
use glam::{Vec2, Vec3};

/// Reflectance and emission at a point of a surface.
pub struct SurfaceSample {
    /// Reflectance.
    pub reflectance: Vec3,
    /// Texture × vertex colour: what multiplies the base colour.
    pub paint: Vec3,
    /// Radiance that needs no light and never changes: that of what is unlit.
    pub emitted: Vec3,
    /// What multiplies the surface's emission here.
    pub glow: Vec3,
    /// What its normal map shows, with the tangents at the triangle's corners.
    pub bumps: Option<(Vec3, [Tangent; 3])>,
}

/// Looks at a hit, so many metres away from the eye, as closely as the pixel's samples are apart.
pub fn look(
    scene: &ShadingContext,
    number: SurfaceId,
    (ray, hit): (&Ray, &Hit),
    way: f32,
) -> SurfaceSample {
    let surface = &scene.patches.surfaces[number];
    let paint = &scene.paints[number];
    let triangle = hit.triangle.index() - surface.triangles.0 as usize;
    let at = Vec2::new(hit.u, hit.v);
    let sides = if paint.is_even() && !paint.has_bumps() {
        [Vec2::ZERO; 2]
    } else {
        let width = scene.camera.pixel_width(way) / (scene.params.samples as f32).sqrt();
        let corners = &scene.accel.placed.triangles[hit.triangle];
        footprint(corners, ray.direction, width)
    };
    let tint = paint.tint(triangle, at, sides);
    let painted = surface.base_color * tint;
    if surface.unlit {
        return SurfaceSample {
            reflectance: Vec3::ZERO,
            paint: tint,
            emitted: painted,
            glow: Vec3::ZERO,
            bumps: None,
        };
    }
    let glow = if surface.emission == Vec3::ZERO {
        Vec3::ZERO
    } else {
        paint.glow(triangle, at, sides)
    };
    SurfaceSample {
        reflectance: painted,
        paint: tint,
        emitted: Vec3::ZERO,
        glow,
        bumps: paint.bumps(triangle, at, sides),
    }
}
