//! A camera, perspective or orthographic: pixels to rays, and boxes to the pixels that may see them.

use crate::geometry::{Bounds, Ray};
use crate::scene::{Lens, view::View};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// A lens: what lies at its focus is sharp, and the rest the less so, the wider it is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Metres from its middle to its edge.
    pub radius: f32,
    /// Metres along the view to the plane that is sharp; above 0.
    pub focus: f32,
}

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
    /// Where the picture's middle lies: to the right of the view and above it, at distance 1.
    shift: Vec2,
    /// Whether all rays run forward instead of from the eye.
    parallel: bool,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The lens in place of a pinhole; of perspective cameras only.
    lens: Option<ThinLens>,
    /// Pixels from the middle of a pixel to its farthest sample.
    reach: f32,
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
            shift: view.shift * (2.0 * half as f32),
            parallel,
            size,
            lens: None,
            reach: 0.5,
        }
    }

    /// The same camera through a lens; one whose rays are parallel has none.
    pub fn through(self, lens: Option<ThinLens>) -> Camera {
        let lens = lens.filter(|_| !self.parallel);
        Camera { lens, ..self }
    }

    /// The same camera with pixels whose samples lie as far from their middle as this, in pixels.
    pub fn reaching(self, reach: f32) -> Camera {
        Camera { reach, ..self }
    }

    /// Whether it looks through a lens.
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// The ray through a point of the image from a point of the lens, given by a place in the unit square.
    ///
    /// The square is laid onto the disk as P. Shirley and K. Chiu do (1997, "A low distortion map between disk and
    /// square", Journal of Graphics Tools 2(3):45–52).
    pub fn ray_from(&self, at: Vec2, on_lens: Vec2) -> Ray {
        let ray = self.ray(at);
        let Some(ThinLens { radius, focus }) = self.lens else {
            return ray;
        };
        let on_lens = disk(on_lens) * radius;
        let sharp = ray.origin + ray.direction * (focus / ray.direction.dot(self.forward));
        let origin = self.eye + self.right * on_lens.x + self.up * on_lens.y;
        Ray {
            origin,
            direction: (sharp - origin).normalize(),
            ..ray
        }
    }

    /// The ray through a point of the image, in pixels from the top left.
    pub fn ray(&self, at: Vec2) -> Ray {
        let (width, height) = (self.size.0 as f32, self.size.1 as f32);
        let x = (2.0 * at.x - width) / height * self.half + self.shift.x;
        let y = (height - 2.0 * at.y) / height * self.half + self.shift.y;
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

    /// How far a point lies along the view, in metres.
    pub fn depth(&self, point: Vec3) -> f32 {
        (point - self.eye).dot(self.forward)
    }

    /// The width in metres that a pixel sees of a plane across its ray, at this distance along it.
    pub fn pixel_width(&self, distance: f32) -> f32 {
        let depth = if self.parallel { 1.0 } else { distance };
        2.0 * self.half / self.size.1 as f32 * depth
    }

    /// The pixels from which a ray may meet a box, as columns and rows: conservative by a pixel on each side.
    ///
    /// From a point of the lens, d off its middle, a corner at depth z lies d · |1/focus − 1/z| beside where the middle sees
    /// it, as a slope: each corner is widened by that for the lens's edge.
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
                width / 2.0 + (to.dot(self.right) - self.shift.x * depth) * scale,
                height / 2.0 - (to.dot(self.up) - self.shift.y * depth) * scale,
            );
            let blur = self.lens.map_or(0.0, |lens| {
                lens.radius * (1.0 / lens.focus - 1.0 / depth).abs() * height / (2.0 * self.half)
            });
            (lo, hi) = (lo.min(at - blur), hi.max(at + blur));
        }
        let margin = 0.5 + self.reach;
        let range = |lo: f32, hi: f32, most: u32| {
            let first = (lo - margin).floor().clamp(0.0, most as f32) as u32;
            first..((hi + margin).ceil().clamp(0.0, most as f32) as u32).max(first)
        };
        (
            range(lo.x, hi.x, self.size.0),
            range(lo.y, hi.y, self.size.1),
        )
    }
    /// A distance before which no ray meets a box.
    pub fn nearest(&self, bounds: &Bounds) -> f32 {
        if !self.parallel {
            let open = self.lens.map_or(0.0, |lens| lens.radius);
            let distance = self.eye.distance(self.eye.clamp(bounds.lo, bounds.hi));
            return distance * (1.0 - SLACK) - open * (1.0 + SLACK);
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

/// A place in the unit square on the unit disk, where equal areas stay equal and neighbours stay neighbours.
fn disk(unit: Vec2) -> Vec2 {
    let at = unit * 2.0 - 1.0;
    if at == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (radius, angle) = if at.x.abs() > at.y.abs() {
        (at.x, FRAC_PI_4 * (at.y / at.x))
    } else {
        (at.y, FRAC_PI_2 - FRAC_PI_4 * (at.x / at.y))
    };
    Vec2::from_angle(angle) * radius
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
            shift: Vec2::ZERO,
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
    fn a_shift_moves_the_picture_over_the_same_view() {
        let slope = Lens::Perspective {
            yfov: 2.0 * 0.4_f64.atan(),
        };
        let flat = Lens::Orthographic {
            xmag: 9.0,
            ymag: 2.0,
        };
        // Half of the height of 40 pixels to the right, a quarter of it up: what was seen there is now in the middle.
        let (moved, at) = (
            Vec2::new(0.5, 0.25) * 40.0 * Vec2::new(1.0, -1.0),
            Vec2::new(31.0, 12.5),
        );
        for lens in [slope, flat] {
            let plain = looking_down_z(lens);
            let view = View {
                eye: plain.eye,
                right: Vec3::X,
                up: Vec3::Y,
                forward: Vec3::NEG_Z,
                lens,
                shift: Vec2::new(0.5, 0.25),
            };
            let shifted = Camera::new(&view, (80, 40));
            let (got, expected) = (shifted.ray(at), plain.ray(at + moved));
            assert!(got.direction.distance(expected.direction) < 1e-6);
            assert!(got.origin.distance(expected.origin) < 1e-6);
            let (columns, rows) = shifted.covers(&Bounds::of_points([POINT]));
            // Of pixel 55, 30 the shift makes 35, 40.
            assert_eq!((columns, rows), (34..37, 39..40));
        }
    }

    #[test]
    fn a_lens_is_sharp_at_its_focus_and_its_blur_is_within_bounds() {
        let slope = Lens::Perspective {
            yfov: 2.0 * 0.4_f64.atan(),
        };
        let lens = ThinLens {
            radius: 0.25,
            focus: 5.0,
        };
        let camera = looking_down_z(slope).through(Some(lens)).reaching(1.5);
        let places = (0..64).map(|i| Vec2::new((i % 8) as f32 / 7.0, (i / 8) as f32 / 7.0));
        let (mut widest, pixel) = (0.0f32, Vec2::new(55.5, 30.5));
        for place in places {
            let ray = camera.ray_from(pixel, place);
            // At depth 5 all rays of a place of the picture meet; they start on the lens.
            let sharp = ray.origin + ray.direction * (5.0 / ray.direction.dot(Vec3::NEG_Z));
            assert!(sharp.distance(POINT) < 1e-5, "{sharp}");
            let off = ray.origin.distance(camera.eye);
            assert!(off <= 0.25 + 1e-6);
            widest = widest.max(off);
            // At depth 8 they have parted; the pixel belongs to each point's cover all the same.
            let blurred = ray.origin + ray.direction * (8.0 / ray.direction.dot(Vec3::NEG_Z));
            let (columns, rows) = camera.covers(&Bounds::of_points([blurred]));
            assert!(columns.contains(&55) && rows.contains(&30));
        }
        assert!(widest > 0.249);
        // 0.25 · |1/5 − 1/8| · 40 / (2 · 0.4) = 0.9375 pixels of blur, and 0.5 + 1.5 of margin about the pixel's middle.
        let far = Vec3::new(1.0 + 1.55 * 1.6, 2.0 - 1.05 * 1.6, 2.0);
        let (columns, _) = camera.covers(&Bounds::of_points([far]));
        assert_eq!(columns, 52..59);
        let bounds = Bounds::of_points([Vec3::new(1.0, 2.0, 8.0)]);
        let near = camera.nearest(&bounds);
        assert!((1.7499..=1.75).contains(&near), "{near}");
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
