//! Normals that a file gives its vertices: what a smooth surface seems to be between the corners of its triangles.
//!
//! glTF 2.0 specification, Khronos Group 2021, sections 3.7.2.1 (NORMAL), 3.7.2.2 "Morph Targets" and 3.7.3 "Skins": targets add
//! to the normals before joints turn them. A normal keeps its right angle to the surface when the inverse transpose of the
//! surface's matrix carries it (K. Turkowski 1990, "Transformations of surface normal vectors", Apple Technical Report 22). We
//! take the cofactors instead of the inverse: they differ by a factor alone, and a matrix that flattens has them too.

use super::deform::{joint_matrix, morphed};
use super::pose::{Places, Pose};
use super::{Animation, Mesh, SmoothNormals, VertexNormals};
use crate::options::Shading;
use glam::{DMat3, DVec3, Vec3};

/// Cosine of the angle up to which a vertex's normal is that of its triangle: 0.26°, what rounding to 16 bits stays below.
/// Wider, a finely cut sphere would show its triangles.
pub const FLAT: f32 = 0.999_99;

impl VertexNormals {
    /// The normals that a file gives a mesh; of one that deforms they are never taken for flat, as it may bend.
    pub fn of(mesh: &Mesh, said: SmoothNormals) -> VertexNormals {
        let deforms = mesh.morphs() || mesh.influences.is_some();
        let turns = said.targets.iter().any(|target| !target.is_empty());
        let flat = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
            let facing = (b - a).cross(c - a).normalize_or_zero();
            let normal = |corner: u32| said.normals[corner as usize].normalize_or_zero();
            corners.iter().all(|at| normal(*at).dot(facing) > FLAT)
        };
        match !deforms && !turns && mesh.triangles.iter().all(flat) {
            true => VertexNormals::Flat,
            false => VertexNormals::Smooth(said),
        }
    }

    /// Whether the file gives any.
    pub fn are_given(&self) -> bool {
        !matches!(self, VertexNormals::None)
    }

    /// Whether they are others than those of the triangles.
    pub fn are_smooth(&self) -> bool {
        matches!(self, VertexNormals::Smooth(_))
    }

    /// Whether morph targets turn them.
    pub fn morph(&self) -> bool {
        match self {
            VertexNormals::Smooth(said) => said.targets.iter().any(|target| !target.is_empty()),
            _ => false,
        }
    }
}

impl Animation {
    /// Chooses by which normals surfaces are lit; where they are flat, those of the file and its normal
    /// maps are forgotten.
    pub fn shade(&mut self, shading: Shading) {
        self.shading = shading;
        if shading == Shading::Flat {
            let meshes = self.meshes.iter_mut();
            meshes.for_each(|mesh| mesh.normals = VertexNormals::None);
            let materials = self.materials.iter_mut();
            materials.for_each(|material| material.normal_map = None);
        }
    }

    /// World-space normals at the corners of an instance's triangles, in the order of
    /// [`Animation::corners_in_order`]: unit vectors out of the front, or zero where a normal has no direction. Empty for a
    /// mesh that is not smooth.
    pub fn normals_in_order(&self, instance: usize, pose: &Pose, mirrored: bool) -> Vec<[Vec3; 3]> {
        let mesh = &self.meshes[self.instances[instance].mesh];
        let VertexNormals::Smooth(said) = &mesh.normals else {
            return Vec::new();
        };
        let places = self.places(instance, pose);
        let whole = match &places {
            Places::Node(world) => upright(world.matrix3),
            Places::Joints(_) => DMat3::IDENTITY,
        };
        let turned = |(index, normal): (usize, DVec3)| {
            let matrix = match (&places, &mesh.influences) {
                (Places::Joints(joints), Some(influences)) => {
                    upright(joint_matrix(joints, influences, index))
                }
                _ => whole,
            };
            (matrix * normal).normalize_or_zero().as_vec3()
        };
        let weights = &pose.weights[self.instances[instance].node];
        let normals = morphed(&said.normals, &said.targets, weights)
            .into_iter()
            .enumerate();
        let normals: Vec<Vec3> = normals.map(turned).collect();
        mesh.by_corners(&normals, mirrored)
    }
}

/// What carries normals where a matrix carries positions, but for their length: its cofactors, turned back where it mirrors.
fn upright(matrix: DMat3) -> DMat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    match x.dot(y.cross(z)) < 0.0 {
        true => cofactors * -1.0,
        false => cofactors,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_stays_at_right_angles() {
        // A plane with the tangents (1, 2, 0) and (0, 1, 3) and the normal of their cross product, in a slanting, scaling
        // and in a mirroring matrix: the carried normal is that of the carried tangents, whose order mirroring exchanges.
        let tangents = [DVec3::new(1.0, 2.0, 0.0), DVec3::new(0.0, 1.0, 3.0)];
        let normal = tangents[0].cross(tangents[1]);
        let slanting = DMat3::from_cols_array(&[2.0, 0.3, 0.0, -0.5, 0.7, 0.1, 0.2, 0.0, 5.0]);
        for (matrix, sign) in [
            (slanting, 1.0),
            (
                slanting * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
                -1.0,
            ),
        ] {
            let [along, across] = tangents.map(|tangent| matrix * tangent);
            let expected = along.cross(across).normalize() * sign;
            let got = (upright(matrix) * normal).normalize();
            assert!(got.distance(expected) < 1e-12, "{got}, {expected}");
        }
    }

    #[test]
    fn what_is_flattened_keeps_the_normal_of_its_plane() {
        let flat = DMat3::from_diagonal(DVec3::new(1.0, 0.0, 2.0));
        let got = (upright(flat) * DVec3::new(0.3, 0.8, 0.1)).normalize_or_zero();
        assert_eq!(got, DVec3::Y);
        let line = DMat3::from_diagonal(DVec3::new(1.0, 0.0, 0.0));
        assert_eq!((upright(line) * DVec3::Y).normalize_or_zero(), DVec3::ZERO);
    }
}
