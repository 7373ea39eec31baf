//! Whether a box may stand between two others.
//!
//! Haines, Wallace 1991, "Shaft culling for efficient ray-traced radiosity", Eurographics Workshop on Rendering. At
//! parameter s of the way from box A to box B the shaft is the box A + s (B − A): on each axis two bounds linear in s. The
//! parameters at which it overlaps a third box are an interval on each axis; that box is in the way if they have a
//! parameter in common. The shaft holds every segment from a point of A to one of B.

use crate::geometry::Bounds;

/// Room for rounding, as a share of the way.
const SLACK: f32 = 1e-5;

/// Whether some segment from `from` to `to` may meet `other`.
pub(crate) fn meets(from: &Bounds, to: &Bounds, other: &Bounds) -> bool {
    let (mut first, mut last) = (0.0f32, 1.0f32);
    // Keep the parameters with start + slope · s ≤ 0.
    let mut keep = |start: f32, slope: f32| {
        if slope > 0.0 {
            last = last.min(-start / slope);
        } else if slope < 0.0 {
            first = first.max(-start / slope);
        } else if start > 0.0 {
            last = -1.0;
        }
    };
    for axis in 0..3 {
        keep(from.lo[axis] - other.hi[axis], to.lo[axis] - from.lo[axis]);
        keep(other.lo[axis] - from.hi[axis], from.hi[axis] - to.hi[axis]);
    }
    first <= last + SLACK
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn cube(at: Vec3, half: f32) -> Bounds {
        Bounds {
            lo: at - half,
            hi: at + half,
        }
    }

    #[test]
    fn a_shaft_narrows_from_box_to_box() {
        let (from, to) = (cube(Vec3::ZERO, 1.0), cube(Vec3::Y * 10.0, 2.0));
        // Half way it is 1.5 wide to each side.
        assert!(meets(&from, &to, &cube(Vec3::new(1.9, 5.0, 0.0), 0.5)));
        assert!(!meets(&from, &to, &cube(Vec3::new(2.3, 5.0, 0.0), 0.5)));
        assert!(meets(&from, &to, &cube(Vec3::new(0.0, 0.5, 0.9), 0.5)));
        assert!(!meets(&from, &to, &cube(Vec3::new(0.0, 13.0, 0.0), 0.5)));
        assert!(!meets(&from, &to, &cube(Vec3::new(0.0, -2.0, 0.0), 0.5)));
    }

    #[test]
    fn a_shaft_between_points_is_a_segment() {
        let (from, to) = (cube(Vec3::ZERO, 0.0), cube(Vec3::new(4.0, 4.0, 0.0), 0.0));
        assert!(meets(&from, &to, &cube(Vec3::new(2.0, 2.0, 0.0), 0.1)));
        assert!(!meets(&from, &to, &cube(Vec3::new(2.0, 2.0, 0.3), 0.1)));
        assert!(!meets(&from, &to, &cube(Vec3::new(3.0, 1.0, 0.0), 0.9)));
    }
}
