//! Enclosure test: whether light from outside reaches the surfaces in view, and which surfaces keep it out.
//!
//! Each ray is followed through everything it meets. The last thing it meets has nothing behind it: where hardly a ray
//! leaves the scene, that is the shell that encloses it, however much furniture stands inside.

use super::reachability::{self, Probed};
use super::sample;
use crate::emission::punctual::PunctualLight;
use crate::formfactor::hemisphere::ORIGINS;
use crate::formfactor::{Hemisphere, Set};
use crate::geometry::Ray;
use crate::ids::{SideId, SurfaceId};
use crate::mesh::RadiosityMesh;
use crate::scene::light::LightKind;

/// Surfaces that one ray is followed through at most: no shell lies behind more walls, and nothing runs for ever.
const MOST_WALLS: usize = 256;

/// Rays from each thing that is seen, one from each of its origins.
const EACH: usize = ORIGINS;

/// Hits of rays from the surfaces in view, all times together.
#[derive(Clone, Debug, Default)]
pub struct Enclosure {
    /// Rays followed.
    pub rays: usize,
    /// How many of them met nothing.
    pub left: usize,
    /// How many of the places they start from are lit by a direction: a sun, or one of the file's lights.
    pub sunny: usize,
    /// How many places there are.
    pub places: usize,
    /// How many rays met each surface last.
    pub shell: Vec<usize>,
}

impl Enclosure {
    /// Looks around from what these rays of a camera see first, and adds up what is met.
    pub fn look(
        &mut self,
        patches: &RadiosityMesh,
        time: &Probed,
        camera: impl Iterator<Item = Ray>,
    ) {
        self.shell.resize(patches.surfaces.len(), 0);
        let hemisphere = Hemisphere::new(Set::Cosine(EACH), 3);
        for side in camera.filter_map(|ray| seen(patches, time, ray)) {
            let sampler = hemisphere.sampler(patches, time.accel.placed, side);
            if sampler.stand.is_flat() {
                continue;
            }
            self.places += 1;
            let direction = |light: &PunctualLight| light.kind == LightKind::Directional;
            let sunny = reachability::is_lit(patches, time, &sampler, side, EACH, &direction);
            self.sunny += usize::from(sunny);
            for k in 0..EACH {
                self.rays += 1;
                match last(patches, time, sample::hemisphere_ray(&sampler, k)) {
                    Some(surface) => self.shell[surface] += 1,
                    None => self.left += 1,
                }
            }
        }
    }
}

/// The side that a camera's ray sees.
fn seen(patches: &RadiosityMesh, time: &Probed, ray: Ray) -> Option<SideId> {
    let (hit, _) = time.accel.primary(patches, &ray)?;
    patches.side_at(time.accel.placed, &hit, ray.direction)
}

/// The last surface that a ray meets on its way out.
fn last(patches: &RadiosityMesh, time: &Probed, mut ray: Ray) -> Option<SurfaceId> {
    let mut last = None;
    for _ in 0..MOST_WALLS {
        let Some(hit) = time.accel.intersect(&ray) else {
            break;
        };
        let surface = patches.surface_of[hit.triangle];
        if !patches.cutouts.is_clear(hit.triangle) {
            last = Some(surface);
        }
        ray.tmin = hit.t;
    }
    last
}
