//! A perspective camera: pixels to rays, and boxes to the pixels that may see them.

use crate::animation::pose::View;
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
    /// Half the height of the picture at distance 1.
    slope: f32,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

impl Camera {
    /// A view for an image of this many pixels; the vertical field is the camera's, the horizontal follows the image.
    pub fn new(view: &View, size: (u32, u32)) -> Camera {
        Camera {
            eye: view.eye,
            right: view.right,
            up: view.up,
            forward: view.forward,
            slope: (view.yfov * 0.5).tan() as f32,
            size,
        }
    }

    /// The ray through a point of the image, in pixels from the top left.
    pub fn ray(&self, at: Vec2) -> Ray {
        let (width, height) = (self.size.0 as f32, self.size.1 as f32);
        let x = (2.0 * at.x - width) / height * self.slope;
        let y = (height - 2.0 * at.y) / height * self.slope;
        let direction = (self.forward + self.right * x + self.up * y).normalize();
        Ray {
            origin: self.eye,
            direction,
            tmin: 0.0,
            tmax: f32::INFINITY,
        }
    }

    /// The pixels from which a ray may meet a box, as columns and rows: conservative by a pixel on each side.
    pub fn covers(&self, bounds: &Bounds) -> (std::ops::Range<u32>, std::ops::Range<u32>) {
        let (width, height) = (self.size.0 as f32, self.size.1 as f32);
        let (mut lo, mut hi) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for corner in 0..8 {
            let pick = |axis: usize| {
                if corner >> axis & 1 == 1 {
                    bounds.hi[axis]
                } else {
                    bounds.lo[axis]
                }
            };
            let to = Vec3::new(pick(0), pick(1), pick(2)) - self.eye;
            let depth = to.dot(self.forward);
            if depth <= 1e-3 * to.length() {
                // A corner beside or behind the eye has no place in the image: take all of it.
                return (0..self.size.0, 0..self.size.1);
            }
            let scale = height / (2.0 * self.slope * depth);
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
}
