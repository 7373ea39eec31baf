//! Normals at the corners of smooth surfaces' triangles, at time t, and what each point of a triangle is taken to face.
//!
//! Light alone asks for them: sides, hits and shadows stay with the true triangles. A corner whose normal has no direction, or
//! faces away from its triangle, takes the triangle's own.

use crate::ids::SurfaceId;
use crate::scene::normals::FLAT;
use glam::Vec3;

/// Cosine of the angle to a triangle's own normal up to which the normal of a corner counts. Beyond, at 87°, a point in the
/// middle may face away from where it is seen.
const FACING: f32 = 0.05;

/// Unit normals in world space by surface and triangle; those without direction are zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PosedNormals {
    /// Where each surface's end.
    ends: Vec<u32>,
    /// At the corners of each triangle of the surfaces that have any.
    corners: Vec<[Vec3; 3]>,
}

impl PosedNormals {
    /// Those of all surfaces, in order; nothing for one that is flat.
    pub(super) fn push(&mut self, corners: &[[Vec3; 3]]) {
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len() as u32);
    }

    /// Those of a surface, triangle by triangle; empty for one that is flat, and for one that is not known yet.
    pub fn of(&self, surface: SurfaceId) -> &[[Vec3; 3]] {
        let Some(end) = self.ends.get(surface.index()) else {
            return &[];
        };
        let start = match surface.index() {
            0 => 0,
            index => self.ends[index - 1],
        };
        &self.corners[start as usize..*end as usize]
    }

    /// Puts others in the place of a surface's, as many, or behind all others those of the next surface.
    pub(crate) fn set(&mut self, surface: SurfaceId, corners: &[[Vec3; 3]]) {
        match self.ends.get(surface.index()) {
            None => self.push(corners),
            Some(end) => {
                let end = *end as usize;
                self.corners[end - corners.len()..end].copy_from_slice(corners);
            }
        }
    }

    /// Unit normals that the corners of a surface's n-th triangle seem to have, on the side of `front`, its own normal there;
    /// `None` where the triangle is as flat as it is.
    #[inline]
    pub fn smooth(&self, surface: SurfaceId, triangle: usize, front: Vec3) -> Option<[Vec3; 3]> {
        let corners = self.of(surface).get(triangle)?;
        let held = corners.map(|normal| match normal.dot(front) > FACING {
            true => normal,
            false => front,
        });
        let flat = held.iter().all(|normal| normal.dot(front) > FLAT);
        (!flat).then_some(held)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_that_face_nowhere_or_away_take_the_triangle_s_own() {
        let mut normals = PosedNormals::default();
        let slanted = Vec3::new(0.6, 0.0, 0.8);
        normals.push(&[]);
        normals.push(&[
            [Vec3::ZERO, slanted, -Vec3::Z],
            [Vec3::Z, Vec3::ZERO, Vec3::Z],
        ]);
        let got = normals.smooth(SurfaceId::new(1), 0, Vec3::Z);
        assert_eq!(got, Some([Vec3::Z, slanted, Vec3::Z]));
        assert_eq!(
            normals.smooth(SurfaceId::new(1), 1, Vec3::Z),
            None,
            "as flat as it is"
        );
        for (surface, triangle) in [(0, 0), (1, 2), (2, 0)] {
            assert_eq!(
                normals.smooth(SurfaceId::new(surface), triangle, Vec3::Z),
                None
            );
        }
    }

    #[test]
    fn a_surface_is_set_in_its_place_or_comes_last() {
        let of = |x: f32| [Vec3::splat(x); 3];
        let mut normals = PosedNormals::default();
        normals.set(SurfaceId::new(0), &[of(1.0), of(2.0)]);
        normals.set(SurfaceId::new(1), &[]);
        normals.set(SurfaceId::new(2), &[of(3.0)]);
        normals.set(SurfaceId::new(0), &[of(4.0), of(5.0)]);
        normals.set(SurfaceId::new(1), &[]);
        assert_eq!(normals.of(SurfaceId::new(0)), [of(4.0), of(5.0)]);
        assert_eq!(
            (
                normals.of(SurfaceId::new(1)).len(),
                normals.of(SurfaceId::new(2))
            ),
            (0, &[of(3.0)][..])
        );
    }
}
