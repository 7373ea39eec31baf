//! Paths: what a ray sees by way of mirrors and through glass.
//!
//! J. R. Wallace, M. F. Cohen, D. P. Greenberg 1987, "A two-pass solution to the rendering equation: a synthesis of ray
//! tracing and radiosity methods", Computer Graphics 21(4):311–320; H. E. Rushmeier, K. E. Torrance 1990, "Extending the
//! radiosity method to include specularly reflecting and translucent materials", ACM Transactions on Graphics 9(1):1–27;
//! F. Sillion, C. Puech 1989, "A general two-pass method integrating specular and diffuse reflection", Computer Graphics
//! 23(3):335–344. A sample that meets a specular surface goes on from it, until it meets a diffuse one: so its factor is an
//! *extended form factor*, which counts all ways of light by mirrors and glass. Where a surface both reflects and lets pass,
//! the sample's own fixed number chooses, and a tint makes up for the choice. So a path is a pure function of the scene at t
//! and the sample, as a ray is.
//!
//! Light straight from emitters goes through glass unbent (`transmittance`): so light samples see it, and a path that only
//! passes glass brings of an emitter what it reflects, as any sample. One that was reflected brings all of it.

use super::Accel;
use super::specular_sample::SpecularSample;
use crate::formfactor::sobol::scatter;
use crate::geometry::{Hit, Ray};
use crate::mesh::{PosedMesh, RadiosityMesh};
use crate::scene::specular::{Lobes, Specular, reflect, refract};
use glam::Vec3;

/// Most surfaces on a path: light that is left after so many is taken for lost.
pub const DEPTH: u32 = 16;

/// The golden ratio as a part of 2³²: it parts the numbers of one sample, and of one bounce, from those of the next.
const BOUNCE: u32 = 0x9e37_79b9;

/// The number by which sample k of a receiver chooses its way.
#[inline]
pub fn seed(receiver: u32, k: usize) -> u32 {
    scatter(receiver).wrapping_add((k as u32).wrapping_mul(BOUNCE))
}

/// The end of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathEnd {
    /// Its last segment.
    pub ray: Ray,
    /// What that meets.
    pub hit: Option<Hit>,
    /// Whether it was reflected on its way.
    pub reflected: bool,
    /// What multiplies the light that arrives along it, RGB.
    pub tint: Vec3,
}

impl PathEnd {
    /// The last segment of a way and what that meets: its first, where no path was followed.
    pub fn last(end: Option<&PathEnd>, ray: &Ray, first: Option<Hit>) -> (Ray, Option<Hit>) {
        end.map_or((*ray, first), |end| (end.ray, end.hit))
    }

    /// What a hemisphere sample keeps of it.
    pub fn of_sample(&self, k: usize) -> SpecularSample {
        SpecularSample {
            k: k as u16,
            reflected: self.reflected,
            direction: self.ray.direction,
            tint: self.tint,
        }
    }
}

/// A specular surface as a ray meets it.
pub struct Meeting<'a> {
    /// The surface's specular part.
    pub specular: &'a Specular,
    /// What light becomes of it.
    pub lobes: Lobes,
    /// Its unit normal on the side of the ray.
    pub normal: Vec3,
    /// Whether the ray meets it from within a volume.
    pub inside: bool,
    /// What the ray kept since it entered the volume, RGB.
    pub kept: Vec3,
}

/// Unit normal of a triangle on the side that a direction comes from.
pub fn facing_normal(placed: &PosedMesh, hit: &Hit, direction: Vec3) -> Vec3 {
    let [a, b, c] = placed.triangles[hit.triangle];
    let normal = (b - a).cross(c - a).normalize_or_zero();
    if normal.dot(direction) > 0.0 {
        -normal
    } else {
        normal
    }
}

impl<'a> Meeting<'a> {
    /// What a ray meets at a hit on a surface with a specular part, where `base` is the base colour there and `normal` faces
    /// the ray; `eye` asks for the gloss of paint too.
    pub fn of(
        (patches, placed): (&'a RadiosityMesh, &PosedMesh),
        (ray, hit): (&Ray, &Hit),
        (base, normal): (Vec3, Vec3),
        eye: bool,
    ) -> Option<Meeting<'a>> {
        let surface = &patches.surfaces[patches.surface_of[hit.triangle]];
        let specular = surface.specular.as_ref()?;
        let back = patches.is_back(placed, hit.triangle, ray.direction);
        if back && !surface.double_sided && !specular.passes() {
            return None;
        }
        let mut cosine = -ray.direction.dot(normal);
        let volume = specular.volume.filter(|_| back);
        let mut kept = Vec3::ONE;
        if let Some(volume) = volume {
            // Schlick's reflectance is that of the angle outside; beyond the critical angle all is reflected.
            let outside = refract(ray.direction, normal, volume.ior);
            cosine = outside.map_or(0.0, |out| -out.dot(normal));
            let distance = hit.t - ray.tmin;
            kept = (volume.absorption * -distance).exp();
        }
        let alpha = match specular.blends {
            true => patches.cutouts.alpha(hit.triangle, hit.u, hit.v),
            false => 1.0,
        };
        Some(Meeting {
            specular,
            lobes: specular.lobes(cosine, base, alpha.min(1.0), eye),
            normal,
            inside: volume.is_some(),
            kept,
        })
    }

    /// The ray that goes on by reflection.
    pub fn reflected(&self, ray: &Ray, hit: &Hit, ray_offset: f32) -> Ray {
        let at = ray.origin + ray.direction * hit.t;
        from(
            at + self.normal * ray_offset,
            reflect(ray.direction, self.normal),
        )
    }

    /// The ray that goes on behind the surface; none where all is reflected.
    pub fn passed(&self, ray: &Ray, hit: &Hit, ray_offset: f32) -> Option<Ray> {
        let Some(volume) = self.specular.volume else {
            // Straight on: the same ray from here on, so that nothing is rounded.
            return Some(Ray {
                tmin: hit.t,
                ..*ray
            });
        };
        let ratio = if self.inside {
            volume.ior
        } else {
            1.0 / volume.ior
        };
        let direction = refract(ray.direction, self.normal, ratio)?;
        let at = ray.origin + ray.direction * hit.t;
        Some(from(at - self.normal * ray_offset, direction))
    }
}

fn from(origin: Vec3, direction: Vec3) -> Ray {
    Ray {
        origin,
        direction: direction.normalize_or_zero(),
        tmin: 0.0,
        tmax: f32::INFINITY,
    }
}

/// The mean of a colour's channels, by which a path is chosen.
fn mean(color: Vec3) -> f32 {
    color.element_sum() / 3.0
}

/// The base colour of a specular surface at a hit: the mean over its element.
fn base_color(patches: &RadiosityMesh, specular: &Specular, hit: &Hit) -> Vec3 {
    let (element, _) = patches.cuts.locate(hit.triangle, hit.u, hit.v);
    specular.base_color * patches.elements[element].tint
}

/// Follows a path beyond a ray's first hit; `None` where that is diffuse, or there is none. `seed` is the sample's own
/// number, `intersect` finds the first hit of a ray, and `each` is told every segment, with its end, but the first.
pub fn follow(
    (patches, placed): (&RadiosityMesh, &PosedMesh),
    ray: &Ray,
    first: Option<Hit>,
    seed: u32,
    intersect: impl Fn(&Ray) -> Option<Hit>,
    mut each: impl FnMut(&Ray),
) -> Option<PathEnd> {
    if !patches.any_sends_on {
        return None;
    }
    patches.specular_at(&first?)?;
    // A ray that was cut where it need not be tested goes on as far as any.
    let mut end = PathEnd {
        ray: Ray {
            tmax: f32::INFINITY,
            ..*ray
        },
        hit: first,
        reflected: false,
        tint: Vec3::ONE,
    };
    for bounce in 0..DEPTH {
        let Some(hit) = end.hit else {
            return Some(end);
        };
        let Some(specular) = patches.specular_at(&hit) else {
            return Some(end);
        };
        let base = base_color(patches, specular, &hit);
        let normal = facing_normal(placed, &hit, end.ray.direction);
        let (scene, at) = ((patches, placed), (&end.ray, &hit));
        let Some(meeting) = Meeting::of(scene, at, (base, normal), false) else {
            return Some(end);
        };
        end.tint *= meeting.kept;
        let lobes = meeting.lobes;
        // What the surface reflects diffusely is chosen by what it may send at most.
        let diffuse = mean(lobes.diffuse * base) * specular.diffuse();
        let [reflected, passed] = [lobes.reflected, lobes.passed].map(mean);
        let all = reflected + passed + diffuse;
        if all <= 0.0 {
            end.tint = Vec3::ZERO;
            return Some(end);
        }
        // Samples of one receiver share the first choice evenly: their seeds step by the golden ratio.
        let number = match bounce {
            0 => seed,
            _ => scatter(seed ^ bounce.wrapping_mul(BOUNCE)),
        };
        let chosen = (number >> 8) as f32 / 16_777_216.0 * all;
        let next = if chosen < reflected || passed + diffuse == 0.0 {
            end.tint *= lobes.reflected * (all / reflected);
            end.reflected = true;
            Some(meeting.reflected(&end.ray, &hit, patches.ray_offset))
        } else if chosen < reflected + passed || diffuse == 0.0 {
            end.tint *= lobes.passed * (all / passed);
            meeting.passed(&end.ray, &hit, patches.ray_offset)
        } else {
            end.tint *= lobes.diffuse * (all / diffuse);
            return Some(end);
        };
        // Nothing passes beyond the critical angle, where all is reflected.
        let Some(next) = next else {
            end.tint = Vec3::ZERO;
            return Some(end);
        };
        end.ray = next;
        end.hit = intersect(&end.ray);
        let tmax = end.hit.map_or(f32::INFINITY, |hit| hit.t);
        each(&Ray { tmax, ..end.ray });
    }
    end.tint = Vec3::ZERO;
    Some(end)
}

/// What a ray that nothing blocks keeps on its way through clear surfaces, RGB: it goes straight on.
#[inline]
pub fn transmittance(patches: &RadiosityMesh, accel: &Accel, ray: &Ray) -> Vec3 {
    if patches.cutouts.any_clear() {
        through(patches, accel, ray)
    } else {
        Vec3::ONE
    }
}

fn through(patches: &RadiosityMesh, accel: &Accel, ray: &Ray) -> Vec3 {
    let (mut ray, mut tint, placed) = (*ray, Vec3::ONE, accel.placed);
    while let Some(hit) = accel.closest_clear(&ray) {
        let surface = &patches.surfaces[patches.surface_of[hit.triangle]];
        let Some(specular) = surface.specular.as_ref().filter(|s| s.passes()) else {
            return tint;
        };
        let cosine = -ray
            .direction
            .dot(facing_normal(placed, &hit, ray.direction));
        let alpha = patches.cutouts.alpha(hit.triangle, hit.u, hit.v).min(1.0);
        let base = base_color(patches, specular, &hit);
        tint *= specular.lobes(cosine, base, alpha, false).passed;
        if let Some(volume) = specular.volume
            && patches.is_back(placed, hit.triangle, ray.direction)
        {
            tint *= (volume.absorption * (ray.tmin - hit.t)).exp();
        }
        ray.tmin = hit.t;
    }
    tint
}
