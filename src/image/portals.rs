//! Portals: the parts of a box around the scene through which receivers see the sky.
//!
//! A window is a small part of a room's hemisphere, and of the box that the room stands in. So samples aim at cells of the box's
//! faces (a portal is drawn by hand in other renderers: pbrt-v4, Bitterli, Novák, Jarosz 2015, "Portal-masked environment map
//! sampling", Computer Graphics Forum 34(4):13–19; here it is found). A ray that leaves the scene leaves the box in one cell, so
//! that both kinds of samples know how likely the other was to choose it.

use crate::geometry::Bounds;
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::PI;

/// Cells along each edge of a face: a window has some tens of them.
const CELLS: i32 = 48;

/// The box is wider than the scene by this share of its diagonal.
const MARGIN: f32 = 1e-3;

/// A box around what rests, with cells on its faces.
#[derive(Clone, Debug)]
pub(super) struct Portals {
    bounds: Bounds,
    /// Probability that an aim is at a point of each cell, 1/m²; nothing where none is.
    pub(super) density: Vec<f32>,
}

/// A point of a cell.
pub(super) struct InCell {
    pub(super) at: Vec3,
    /// The normal of its face, outwards.
    pub(super) normal: Vec3,
}

impl Portals {
    /// Cells around a scene, at none of which anything aims.
    pub(super) fn around(scene: Bounds) -> Portals {
        let margin = MARGIN * scene.extent().length();
        Portals {
            bounds: scene.padded(margin),
            density: Vec::new(),
        }
    }

    /// Number of cells.
    pub(super) fn count() -> usize {
        (6 * CELLS * CELLS) as usize
    }

    /// Area of a cell in m².
    pub(super) fn area(&self, cell: usize) -> f32 {
        let [one, other] = across(face_of(cell).0);
        let size = self.bounds.extent() / CELLS as f32;
        size[one] * size[other]
    }

    /// Where a ray leaves the box: the cell, the distance in metres, and the cosine with its face; none from outside.
    #[inline]
    pub(super) fn exit(&self, origin: Vec3, direction: Vec3) -> Option<(usize, f32, f32)> {
        let Bounds { lo, hi } = self.bounds;
        if origin.cmplt(lo).any() || origin.cmpgt(hi).any() {
            return None;
        }
        let ahead = Vec3::select(direction.cmpgt(Vec3::ZERO), hi, lo);
        let far = Vec3::select(
            direction.cmpeq(Vec3::ZERO),
            Vec3::INFINITY,
            (ahead - origin) / direction,
        );
        let axis = match (far.x <= far.y, far.x <= far.z, far.y <= far.z) {
            (true, true, _) => 0,
            (_, _, true) => 1,
            _ => 2,
        };
        let place = (origin + direction * far[axis] - lo) / (hi - lo) * CELLS as f32;
        let [one, other] = across(axis).map(|axis| (place[axis] as i32).clamp(0, CELLS - 1));
        let face = 2 * axis as i32 + i32::from(direction[axis] > 0.0);
        let cell = (face * CELLS + other) * CELLS + one;
        Some((cell as usize, far[axis], direction[axis].abs()))
    }

    /// The point of a cell at a place of the unit square.
    pub(super) fn point(&self, cell: usize, within: Vec2) -> InCell {
        let (axis, beyond) = face_of(cell);
        let place = IVec2::new(cell as i32 % CELLS, cell as i32 / CELLS % CELLS);
        let place = (place.as_vec2() + within) / CELLS as f32;
        let [one, other] = across(axis);
        let mut share = Vec3::ZERO;
        (share[one], share[other]) = (place.x, place.y);
        share[axis] = f32::from(u8::from(beyond));
        let mut normal = Vec3::ZERO;
        normal[axis] = if beyond { 1.0 } else { -1.0 };
        InCell {
            at: self.bounds.lo + self.bounds.extent() * share,
            normal,
        }
    }

    /// How many times as likely an aim is as a cosine-distributed direction to choose a ray that leaves the scene, per sample.
    #[inline]
    pub(super) fn odds(&self, origin: Vec3, (direction, cosine): (Vec3, f32)) -> f32 {
        if self.density.is_empty() {
            return 0.0;
        }
        match self.exit(origin, direction) {
            Some((cell, distance, across)) => {
                self.density[cell] * distance * distance * PI / (cosine * across)
            }
            None => 0.0,
        }
    }
}

/// The axis that a cell's face stands across, and whether it is the face farther along it.
fn face_of(cell: usize) -> (usize, bool) {
    let face = cell / (CELLS * CELLS) as usize;
    (face / 2, face % 2 == 1)
}

/// The two other axes.
fn across(axis: usize) -> [usize; 2] {
    [[1, 2], [2, 0], [0, 1]][axis]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formfactor::cosine;
    use crate::formfactor::sobol::sobol;

    fn portals() -> Portals {
        Portals::around(Bounds {
            lo: Vec3::new(-1.0, 0.0, 2.0),
            hi: Vec3::new(3.0, 2.0, 5.0),
        })
    }

    #[test]
    fn a_ray_to_a_point_of_a_cell_leaves_through_that_cell() {
        let portals = portals();
        for cell in (0..Portals::count()).step_by(7) {
            let within = sobol(cell as u32, 0, 3) * 0.98 + 0.01;
            let origin = Vec3::new(0.5, 1.2, 3.3);
            let InCell { at, normal } = portals.point(cell, within);
            let way = at - origin;
            let (found, distance, cosine) =
                portals.exit(origin, way.normalize()).expect("it is inside");
            assert_eq!(found, cell);
            assert!((distance / way.length() - 1.0).abs() < 1e-4);
            assert!((cosine - normal.dot(way.normalize())).abs() < 1e-5);
        }
    }

    /// Aims spread evenly over the box: over all cosine-distributed directions the odds have mean 1, as any two densities have.
    #[test]
    fn the_odds_of_all_directions_add_up_to_one() {
        let mut portals = portals();
        let cells = 0..Portals::count();
        let whole: f64 = (cells.clone())
            .map(|cell| f64::from(portals.area(cell)))
            .sum();
        let whole = whole as f32;
        assert!((whole / portals.bounds.area() - 1.0).abs() < 1e-5);
        portals.density = cells.map(|_| 1.0 / whole).collect();
        let origin = Vec3::new(0.5, 0.3, 3.3);
        // What lies below the horizon is chosen by no direction.
        let below = |cell| portals.point(cell, Vec2::splat(0.5)).at.y < origin.y;
        let lost = (0..Portals::count()).filter(|cell| below(*cell));
        let lost: f32 = lost.map(|cell| portals.area(cell) / whole).sum();
        let directions = cosine::directions(1 << 16, 1);
        let odds = directions.iter().map(|direction| {
            let up = Vec3::new(direction.x, direction.z, -direction.y);
            f64::from(portals.odds(origin, (up, direction.z)))
        });
        let mean = odds.sum::<f64>() / f64::from(1 << 16);
        let expected = f64::from(1.0 - lost);
        // The row of cells that the horizon cuts is a hundredth of all area, of which their middles misjudge up to a half.
        assert!((mean - expected).abs() < 0.01, "{mean} {expected}");
    }

    #[test]
    fn from_outside_nothing_is_told() {
        assert!(portals().exit(Vec3::ZERO, Vec3::Z).is_none());
    }
}
