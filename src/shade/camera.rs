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
