//! What a viewer shows of the present state: where everything is, its light at vertices, and what the last step traced.

use super::open::Session;
use super::scene::Looks;
use crate::error::Result;
use crate::ids::{SideId, SurfaceId};
use crate::image::Camera;
use crate::mesh::PosedMesh;
use crate::scene::pose::Pose;
use crate::visibility::edit::moved_bounds::{FRESH, ORIGINS_CHANGED, SOME};
use glam::Vec3;
use rayon::prelude::*;

impl Session {
    /// Where triangles are; those of what is not seen are points.
    pub fn placed(&self) -> &PosedMesh {
        &self.place.placed
    }

    /// Where nodes are, and what emits.
    pub fn pose(&self) -> &Pose {
        &self.place.pose
    }

    /// Whether a surface is seen.
    pub fn is_there(&self, surface: SurfaceId) -> bool {
        self.place.there[surface]
    }

    /// The time of the clips, in seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Bound on the error of the present light, relative to the root mean square of radiosity.
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// Whether that is within the tolerance.
    pub fn is_settled(&self) -> bool {
        self.settled
    }

    /// All light that falls on each side, in W/m²; on those of a translucent sheet what they send on, over their reflectance
    /// and transmittance together.
    pub fn irradiance_of_sides(&self) -> Vec<Vec3> {
        let received = self.light.solution.received.par_iter().with_min_len(1024);
        let direct = self.state.direct.par_iter();
        let both = received.zip(direct);
        both.map(|(h, direct)| h.as_vec3() + *direct).collect()
    }

    /// All light that falls on each welded vertex; `None` where the elements around know nothing.
    pub fn irradiance_of_vertices(&self) -> Vec<Option<Vec3>> {
        let patches = &self.scene.patches;
        let light = self.pictures.indirect.at_vertices(
            patches,
            &self.place.placed,
            &self.irradiance_of_sides(),
            &self.hits.hemisphere.invalid_origins,
        );
        light.vertices().collect()
    }

    /// Radiosity E that each side emits now, in W/m².
    pub fn emitted_by_sides(&self) -> Vec<Vec3> {
        let (emission, patches) = (self.emission(), &self.scene.patches);
        let of = |side: SideId| emission.of_side(patches, side);
        patches.side_ids().map(of).collect()
    }

    /// Radiosity E that each surface emits now where its glow is 1, in W/m².
    pub fn emitted_by_surfaces(&self) -> Vec<Vec3> {
        let emission = self.emission();
        let surfaces = self.scene.patches.surface_ids();
        let of = |surface: SurfaceId| match self.place.there[surface] {
            true => emission.surfaces[surface],
            false => Vec3::ZERO,
        };
        surfaces.map(of).collect()
    }

    /// The share of each side's samples that the last step traced again, 0 to 1.
    pub fn recomputed(&self) -> Vec<f32> {
        let (marks, stride) = (&self.marks, self.hits.stride().max(1) as f32);
        let words = marks.words;
        let of = |(side, flags): (usize, &u8)| {
            if flags & (FRESH | ORIGINS_CHANGED) != 0 {
                return 1.0;
            }
            if flags & SOME == 0 {
                return 0.0;
            }
            let bits = &marks.bits[side * 2 * words..(side + 1) * 2 * words];
            let (hit, cross) = bits.split_at(words);
            let traced = hit.iter().zip(cross).map(|(a, b)| (a | b).count_ones());
            (traced.sum::<u32>() as f32 / stride).min(1.0)
        };
        marks.flags.iter().enumerate().map(of).collect()
    }

    /// A camera at another viewpoint than that of the edits, for an image of this many pixels.
    ///
    /// # Errors
    /// As [`EditedScene::view`](super::scene::EditedScene::view).
    pub fn camera_at(&self, looks: Looks, size: (u32, u32)) -> Result<Camera> {
        let aspect = f64::from(size.0) / f64::from(size.1.max(1));
        let view = self.scene.view_by(looks, &self.place.pose, aspect)?;
        Ok(Camera::new(&view, size).reaching(self.numbers.image.filter.radius()))
    }
}
