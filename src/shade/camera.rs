//! A camera, perspective or orthographic: pixels to rays, and boxes to the pixels that may see them.

use crate::animation::{Lens, view::View};
use crate::geometry::{Bounds, Ray};
use glam::{Vec2, Vec3};

/// Where the camera stands and how wide it looks, for one image size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye.
    pub eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Half the height of the picture: at distance 1, or anywhere where rays are parallel.
    half: f32,
    /// Whether all rays run forward instead of from the eye.
    parallel: bool,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

impl Camera {
    /// A view for an image of this many pixels; the height is the lens's, the width follows the image.
    pub fn new(view: &View, size: (u32, u32)) -> Camera {
        let (half, parallel) = match view.lens {
            Lens::Perspective { yfov } => ((yfov * 0.5).tan(), false),
            Lens::Orthographic { ymag, .. } => (ymag, true),
        };
        Camera {
            eye: view.eye,
            right: view.right,
            up: view.up,
            forward: view.forward,
            half: half as f32,
            parallel,
            size,
        }
    }

    /// The ray through a point of the image, in pixels from the top left.
    pub fn ray(&self, at: Vec2) -> Ray {
        let (width, height) = (self.size.0 as f32, self.size.1 as f32);
        let x = (2.0 * at.x - width) / height * self.half;
        let y = (height - 2.0 * at.y) / height * self.half;
        let (right, up) = (self.right * x, self.up * y);
        let (origin, direction) = if self.parallel {
            (self.eye + right + up, self.forward)
        } else {
            (self.eye, (self.forward + right + up).normalize())
        };
        Ray {
            origin,
            direction,
            tmin: 0.0,
            tmax: f32::INFINITY,
        }
    }

    /// The width in metres that a pixel sees of a plane across its ray, at this distance along it.
    pub fn pixel_width(&self, distance: f32) -> f32 {
        let depth = if self.parallel { 1.0 } else { distance };
        2.0 * self.half / self.size.1 as f32 * depth
    }

    /// The pixels from which a ray may meet a box, as columns and rows: conservative by a pixel on each side.
    pub fn covers(&self, bounds: &Bounds) -> (std::ops::Range<u32>, std::ops::Range<u32>) {
        let (width, height) = (self.size.0 as f32, self.size.1 as f32);
        let (mut lo, mut hi) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for corner in corners(bounds) {
            let to = corner - self.eye;
            let depth = to.dot(self.forward);
            if !self.parallel && depth <= 1e-3 * to.length() {
                // A corner beside or behind the eye has no place in the image: take all of it.
                return (0..self.size.0, 0..self.size.1);
            }
            let depth = if self.parallel { 1.0 } else { depth };
            let scale = height / (2.0 * self.half * depth);
            let at = Vec2::new(
                width / 2.0 + to.dot(self.right) * scale,
                height / 2.0 - to.dot(self.up) * scale,
            );
            (lo, hi) = (lo.min(at), hi.max(at));
        }
        let range = |lo: f32, hi: f32, most: u32| {
            let first = (lo - 1.0).floor().clamp(0.0, most as f32) as u32;
            first..((hi + 1.0).ceil().clamp(0.0, most as f32) as u32).max(first)
        };
        (
            range(lo.x, hi.x, self.size.0),
            range(lo.y, hi.y, self.size.1),
        )
    }
    /// A distance before which no ray meets a box.
    pub fn nearest(&self, bounds: &Bounds) -> f32 {
        if !self.parallel {
            return self.eye.distance(self.eye.clamp(bounds.lo, bounds.hi)) * (1.0 - SLACK);
        }
        let depth = |corner: Vec3| {
            let to = corner - self.eye;
            to.dot(self.forward) - SLACK * to.length()
        };
        corners(bounds)
            .map(depth)
            .into_iter()
            .fold(f32::INFINITY, f32::min)
    }
}

/// Shortens the distances of boxes, as a share of them, so that rounding cannot put a box behind what is in it.
const SLACK: f32 = 1e-5;

/// The eight corners of a box.
fn corners(bounds: &Bounds) -> [Vec3; 8] {
    let pick = |corner: usize, axis: usize| {
        if corner >> axis & 1 == 1 {
            bounds.hi[axis]
        } else {
            bounds.lo[axis]
        }
    };
    std::array::from_fn(|corner| Vec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looking_down_z(lens: Lens) -> Camera {
        let view = View {
            eye: Vec3::new(1.0, 2.0, 10.0),
            right: Vec3::X,
            up: Vec3::Y,
            forward: Vec3::NEG_Z,
            lens,
        };
        Camera::new(&view, (80, 40))
    }

    /// The point at depth 5 that is 1.55 m to the right of the middle and 1.05 m below it.
    const POINT: Vec3 = Vec3::new(2.55, 0.95, 5.0);

    #[test]
    fn a_known_point_has_a_known_pixel() {
        // Half the height is 2 m: at depth 5 by a slope of 0.4, anywhere by ymag 2. A metre is 10 pixels.
        let slope = Lens::Perspective {
            yfov: 2.0 * 0.4_f64.atan(),
        };
        let flat = Lens::Orthographic {
            xmag: 9.0,
            ymag: 2.0,
        };
        let pixel = Vec2::new(40.0 + 15.5, 20.0 + 10.5);
        // At depth 5 the way from the eye is √(5² + 1.55² + 1.05²) m, and 5 m where rays are parallel.
        for (lens, distance) in [(slope, 28.505_f32.sqrt()), (flat, 5.0)] {
            let camera = looking_down_z(lens);
            let ray = camera.ray(pixel);
            assert!((ray.origin + ray.direction * distance).distance(POINT) < 1e-5);
            assert!((ray.direction.length() - 1.0).abs() < 1e-6);
            let (columns, rows) = camera.covers(&Bounds::of_points([POINT]));
            // Pixel 55, 30, and one more on each side.
            assert_eq!((columns, rows), (54..57, 29..32));
        }
    }

    #[test]
    fn no_ray_meets_a_box_before_its_nearest_distance() {
        let bounds = Bounds {
            lo: Vec3::new(2.0, 0.5, 3.0),
            hi: Vec3::new(3.0, 1.5, 5.0),
        };
        let flat = Lens::Orthographic {
            xmag: 1.0,
            ymag: 2.0,
        };
        let near = looking_down_z(flat).nearest(&bounds);
        assert!((4.999..=5.0).contains(&near), "{near}");
        // From the eye, its nearest point is the edge at x 2, y 1.5, z 5: √(1 + 0.25 + 25) m.
        let near = looking_down_z(Lens::Perspective { yfov: 1.0 }).nearest(&bounds);
        let edge = 26.25_f32.sqrt();
        assert!((edge * 0.9999..=edge).contains(&near), "{near}");
    }
}
