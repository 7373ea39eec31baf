//! The radiance of a pixel in three parts, and the other layers (AOVs) that a compositor reads.

use super::context::ShadingContext;
use super::denoise;
use super::final_gather::{GatheredIrradiance, SolvedRadiosity};
use super::fragment::Fragment;
use super::fragments::Fragments;
use super::gather_context::GatherContext;
use super::gather_points::GatherPoints;
use super::interpolate::IrradianceField;
use super::pixel::Pixel;
use super::subelement::SubelementCache;
use crate::ids::{SideId, SurfaceId};
use glam::Vec3;
use std::f32::consts::PI;

/// Radiance by where it last came from; their sum, in this order, is the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RadianceParts {
    /// What surfaces emit, are said to show without light, and what the sky shows.
    pub emitted: Vec3,
    /// Light straight from emitters, lights and suns, reflected once.
    pub direct: Vec3,
    /// All other light, the sky's among it, reflected.
    pub indirect: Vec3,
    /// What is seen by way of mirrors and through glass.
    pub specular: Vec3,
}

/// Radiance of a pixel and the attributes of the surface behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelAov {
    /// Its radiance.
    pub parts: RadianceParts,
    /// Reflectance, the mean over the pixel; 0 where nothing is.
    pub albedo: Vec3,
    /// The mean of the unit normals of shading towards the eye, in world space: shorter than 1 at edges, 0 where nothing is.
    pub normal: Vec3,
    /// The mean of the triangles' own.
    pub true_normal: Vec3,
    /// Metres along the view to the middle of the plane that takes most of the pixel; [`NOWHERE`] where nothing is.
    pub depth: f32,
    /// The surface of that plane, or `None` where nothing is.
    pub surface: Option<SurfaceId>,
    /// The side that takes most of the pixel, or none where none has a radiosity.
    pub side: Option<SideId>,
    /// Whether anything of the pixel was traced again in the last update.
    pub traced: bool,
}

/// The depth of nothing: as Cycles writes it, for many programs choke on infinity.
pub const NOWHERE: f32 = 1e10;

impl RadianceParts {
    /// All of it.
    pub fn sum(&self) -> Vec3 {
        self.emitted + self.direct + self.indirect + self.specular
    }
}

/// The light that arrives at the pixels.
pub struct IncidentLight<'a> {
    planes: Fragments,
    /// Irradiance straight from the emitters, plane by plane.
    direct: Vec<Vec3>,
    spread: &'a IrradianceField<'a>,
    /// What pixels gather themselves, where any do.
    gathered: Option<(GatherContext<'a>, GatheredIrradiance)>,
}

impl<'a> IncidentLight<'a> {
    /// Smooths what is direct, and looks up what pixels gather in the solved light.
    pub fn at(
        scene: &'a ShadingContext,
        pixels: &'a [Pixel],
        spread: &'a IrradianceField<'a>,
        solved: &SolvedRadiosity,
        subelements: &SubelementCache,
        points: &GatherPoints,
    ) -> IncidentLight<'a> {
        let planes = Fragments::of(pixels, scene.camera.size);
        let gathering = scene.gathering();
        let look_up = |g: GatherContext<'a>| {
            let known = (solved, subelements, points);
            let all = GatheredIrradiance::look_up(scene, &g, pixels, &planes, known);
            (g, all)
        };
        IncidentLight {
            direct: denoise::smooth(scene, pixels, &planes),
            spread,
            gathered: gathering.map(look_up),
            planes,
        }
    }
}

/// The radiance of a pixel.
pub fn parts(
    scene: &ShadingContext,
    pixels: &[Pixel],
    index: usize,
    arriving: &IncidentLight,
) -> RadianceParts {
    let pixel = &pixels[index];
    let patches = scene.patches;
    let colors = &scene.accel.placed.colors;
    // Add what shines, as bright as it is now.
    let mut parts = RadianceParts {
        emitted: pixel.emitted,
        ..RadianceParts::default()
    };
    parts.emitted -= pixel.emitted_by_way;
    parts.specular = pixel.emitted_by_way;
    for glow in &pixel.glows {
        let part = match glow.by_way {
            true => &mut parts.specular,
            false => &mut parts.emitted,
        };
        *part += scene.lights.emission.surfaces[glow.surface] * glow.share;
    }
    for (number, group) in (0..).zip(&pixel.groups) {
        let light = arriving.direct[arriving.planes.place(index, number)];
        let part = match group.is_by_way() {
            false => &mut parts.direct,
            true => &mut parts.specular,
        };
        *part += light * group.tint * colors[group.surface];
    }
    // Add what arrives at each hit: interpolated, gathered by its plane, or in between.
    for hit in &pixel.hits {
        let (vertices, weights) = (patches.vertex_of[hit.facet as usize], hit.weights());
        let mut irradiance = arriving.spread.at(patches, (hit.side, hit.facet), weights);
        if let Some((gathering, gathered)) = &arriving.gathered
            && let Some(light) = gathered.at(arriving.planes.place(index, hit.group))
        {
            irradiance = irradiance.lerp(light, gathering.share_at(vertices, weights));
        }
        let color = colors[patches.surface_at(hit.side)];
        let part = match pixel.groups[hit.group as usize].is_by_way() {
            false => &mut parts.indirect,
            true => &mut parts.specular,
        };
        *part += irradiance * hit.tint * color;
    }
    parts
}

/// A pixel's radiance and what lies behind it.
pub fn pixel_aov(
    scene: &ShadingContext,
    pixels: &[Pixel],
    index: usize,
    arriving: &IncidentLight,
    traced: bool,
) -> PixelAov {
    let pixel = &pixels[index];
    let colors = &scene.accel.placed.colors;
    let (mut albedo, mut normal, mut true_normal) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    let first_seen = |group: &&Fragment| group.by_way == 0;
    for group in pixel.groups.iter().filter(first_seen) {
        albedo += group.tint * PI * colors[group.surface];
        normal += group.smooth.normal * group.share;
        true_normal += group.normal * group.share;
    }
    // Of planes with equal shares take the first: the nearest to the start of the pattern.
    let groups = pixel.groups.iter().filter(first_seen);
    let most = groups.reduce(|best, group| match group.share > best.share {
        true => group,
        false => best,
    });
    let middle = |group: &Fragment| group.point - group.normal * scene.patches.ray_offset;
    PixelAov {
        parts: parts(scene, pixels, index, arriving),
        albedo,
        normal,
        true_normal,
        depth: most.map_or(NOWHERE, |group| scene.camera.depth(middle(group))),
        surface: most.map(|group| group.surface),
        side: side(pixel),
        traced,
    }
}

/// The side that a pixel sees most of, or none where none has a radiosity.
pub fn side(pixel: &Pixel) -> Option<SideId> {
    let seen = |side: SideId| pixel.hits.iter().filter(|hit| hit.side == side).count();
    let most = pixel.hits.iter();
    let most = most.max_by_key(|hit| (seen(hit.side), hit.side))?;
    Some(most.side)
}
