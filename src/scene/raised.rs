//! Triangles that are raised a little, since they lie on others in their plane (`coplanar.rs`).

use glam::Vec3;

/// A triangle that lies on top of another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raised {
    /// Its number in its mesh.
    pub triangle: u32,
    /// Metres along its normal; less than 0 where it shows its back.
    pub by: f32,
}

/// Raises triangles in a pose, whose corners these are.
pub(super) fn raise(raised: &[Raised], corners: &mut [[Vec3; 3]]) {
    for Raised { triangle, by } in raised {
        if let Some(corners) = corners.get_mut(*triangle as usize) {
            let [a, b, c] = *corners;
            let lift = (b - a).cross(c - a).normalize_or_zero() * *by;
            *corners = [a, b, c].map(|p| p + lift);
        }
    }
}
