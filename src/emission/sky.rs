//! Light from outside the scene: even, or a picture of all directions.
//!
//! A picture is equirectangular with +y up, and its middle looks along +x, as Blender and three.js place it. Hemisphere
//! samples cannot find a sun of half a degree: for the solve the picture is averaged over cells of an octahedral map
//! (Cigolle, Donow, Evangelakos, Mara, McGuire, Meyer 2014, "A survey of efficient representations for independent unit
//! vectors", JCGT 3(2):1–30), each four times as large as what one sample stands for. So a small bright sun in a picture
//! casts the shadows of a large one; a sun for sharp shadows is a light of its own.

use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Half of the samples that fall into a cell: the map covers the sphere, a receiver's samples half of it. A cell of four
/// samples leaves a small sun's light a noise of a few percent; half of that costs twice the width of its shadows' edges.
const CELL: f32 = 2.0;

/// Radiance from every direction outside the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear radiance, row by row from the top left.
    pub texels: Vec<Vec3>,
}

/// A sky as the solve sees it: averages over large cells.
#[derive(Clone, Debug, PartialEq)]
pub struct FilteredSky {
    /// Cells along each edge of the octahedral map.
    size: usize,
    cells: Vec<Vec3>,
}

impl Sky {
    /// The same radiance from everywhere.
    pub fn even(radiance: Vec3) -> Sky {
        Sky {
            width: 1,
            height: 1,
            texels: vec![radiance],
        }
    }

    /// Radiance from a unit direction, interpolated between texels.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        if self.texels.len() == 1 {
            return self.texels[0];
        }
        let u = 0.5 + direction.z.atan2(direction.x) / TAU;
        let v = direction.y.clamp(-1.0, 1.0).acos() / PI;
        let (x, y) = (u * self.width as f32 - 0.5, v * self.height as f32 - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let texel = |dx: i64, dy: i64| {
            let column = (x.floor() as i64 + dx).rem_euclid(self.width as i64) as usize;
            let row = (y.floor() as i64 + dy).clamp(0, self.height as i64 - 1) as usize;
            self.texels[row * self.width + column]
        };
        texel(0, 0)
            .lerp(texel(1, 0), fx)
            .lerp(texel(0, 1).lerp(texel(1, 1), fx), fy)
    }

    /// The mean radiance over all directions.
    pub fn mean(&self) -> Vec3 {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (row, texels) in self.texels.chunks(self.width.max(1)).enumerate() {
            let weight = ((row as f32 + 0.5) / self.height as f32 * PI).sin();
            sum += texels.iter().copied().sum::<Vec3>() * weight;
            weights += weight * texels.len() as f32;
        }
        if weights > 0.0 {
            sum / weights
        } else {
            Vec3::ZERO
        }
    }

    /// The unit direction of a texel's middle.
    fn direction(&self, column: usize, row: usize) -> Vec3 {
        let angle = ((column as f32 + 0.5) / self.width as f32 - 0.5) * TAU;
        let polar = (row as f32 + 0.5) / self.height as f32 * PI;
        Vec3::new(
            angle.cos() * polar.sin(),
            polar.cos(),
            angle.sin() * polar.sin(),
        )
    }

    /// Averages for receivers that take this many hemisphere samples.
    pub fn soft(&self, samples: usize) -> FilteredSky {
        let even = self.texels.len() == 1;
        let size = if even {
            1
        } else {
            (samples as f32 / CELL).sqrt().round().max(1.0) as usize
        };
        let mut sums = vec![(Vec3::ZERO, 0.0f32); size * size];
        for row in 0..self.height {
            let share = ((row as f32 + 0.5) / self.height as f32 * PI).sin();
            for column in 0..self.width {
                let (x, y) = octahedral(self.direction(column, row), size);
                let at = |v: f32| (v.round().max(0.0) as usize).min(size - 1);
                let cell = &mut sums[at(y) * size + at(x)];
                *cell = (
                    cell.0 + self.texels[row * self.width + column] * share,
                    cell.1 + share,
                );
            }
        }
        // A cell between the texels of a coarse picture takes what its middle sees.
        let middle = |cell: usize| self.radiance(unfolded(cell % size, cell / size, size));
        let mean = |(cell, (sum, weight)): (usize, (Vec3, f32))| {
            if weight > 0.0 {
                sum / weight
            } else {
                middle(cell)
            }
        };
        FilteredSky {
            size,
            cells: sums.into_iter().enumerate().map(mean).collect(),
        }
    }

    /// Whether nothing comes from outside.
    pub fn is_black(&self) -> bool {
        self.texels.iter().all(|texel| *texel == Vec3::ZERO)
    }
}

impl FilteredSky {
    /// Radiance from a unit direction, interpolated between cells.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        if self.size == 1 {
            return self.cells[0];
        }
        let (x, y) = octahedral(direction, self.size);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (x, y) = (x.floor() as i32, y.floor() as i32);
        let row = |y| self.cell(x, y).lerp(self.cell(x + 1, y), fx);
        row(y).lerp(row(y + 1), fy)
    }

    /// A cell, also one beyond the map's edge, where it is folded back on itself.
    fn cell(&self, x: i32, y: i32) -> Vec3 {
        let (last, mut x, mut y) = (self.size as i32 - 1, x, y);
        if x < 0 || x > last {
            (x, y) = (x.clamp(0, last), last - y);
        }
        if y < 0 || y > last {
            (x, y) = (last - x, y.clamp(0, last));
        }
        self.cells[y as usize * self.size + x as usize]
    }
}

/// Where a direction lies on a map of `size` by `size` cells; cell n's middle is at n.
fn octahedral(d: Vec3, size: usize) -> (f32, f32) {
    let d = d / (d.x.abs() + d.y.abs() + d.z.abs());
    let flat = Vec2::new(d.x, d.z);
    let at = if d.y >= 0.0 { flat } else { folded(flat) };
    let at = (at + 1.0) * (0.5 * size as f32) - 0.5;
    (at.x, at.y)
}

/// Turns the map's lower half over its diagonals, or back.
fn folded(at: Vec2) -> Vec2 {
    (1.0 - Vec2::new(at.y.abs(), at.x.abs())) * Vec2::ONE.copysign(at)
}

/// The unit direction of a cell's middle.
fn unfolded(x: usize, y: usize, size: usize) -> Vec3 {
    let at = (Vec2::new(x as f32, y as f32) + 0.5) * (2.0 / size as f32) - 1.0;
    let height = 1.0 - at.x.abs() - at.y.abs();
    let flat = if height >= 0.0 { at } else { folded(at) };
    Vec3::new(flat.x, height, flat.y).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emission::punctual::turn;

    /// A picture whose radiance is 1 + y along each direction, in red, and 1 + x in green.
    fn gradient() -> Sky {
        let mut sky = Sky {
            width: 64,
            height: 32,
            texels: vec![Vec3::ZERO; 64 * 32],
        };
        for row in 0..32 {
            for column in 0..64 {
                let d = sky.direction(column, row);
                sky.texels[row * 64 + column] = Vec3::new(1.0 + d.y, 1.0 + d.x, 0.0);
            }
        }
        sky
    }

    #[test]
    fn a_picture_looks_along_x_and_stands_upright() {
        let sky = gradient();
        for (direction, expected) in [
            (Vec3::Y, Vec3::new(2.0, 1.0, 0.0)),
            (Vec3::NEG_Y, Vec3::new(0.0, 1.0, 0.0)),
            (Vec3::X, Vec3::new(1.0, 2.0, 0.0)),
            (Vec3::NEG_X, Vec3::new(1.0, 0.0, 0.0)),
            (Vec3::Z, Vec3::new(1.0, 1.0, 0.0)),
        ] {
            let got = sky.radiance(direction);
            assert!(
                (got - expected).abs().max_element() < 0.06,
                "{got} towards {direction}, expected {expected}"
            );
        }
        // A quarter of the picture right of its middle is +z.
        assert!(sky.direction(48, 16).z > 0.99);
    }

    #[test]
    fn a_soft_sky_keeps_smooth_light_and_the_whole_of_a_peak() {
        let directions = |n: usize| {
            (0..n).map(|s| {
                let t = turn(1, s);
                let (y, angle) = (1.0 - 2.0 * t.x, t.y * TAU);
                let r = (1.0 - y * y).sqrt();
                Vec3::new(r * angle.cos(), y, r * angle.sin())
            })
        };
        let (sky, n) = (gradient(), 20_000);
        let soft = sky.soft(256);
        for d in directions(500) {
            let (got, expected) = (soft.radiance(d), Vec3::new(1.0 + d.y, 1.0 + d.x, 0.0));
            assert!(
                (got - expected).abs().max_element() < 0.15,
                "{got} towards {d}, expected {expected}"
            );
        }
        // One texel of 1,000 near the horizon: over the sphere it brings its radiance times its share of the area.
        let mut sun = gradient();
        sun.texels.fill(Vec3::ZERO);
        sun.texels[12 * 64 + 30] = Vec3::splat(1000.0);
        let share = (12.5 / 32.0 * PI).sin() * (TAU / 64.0) * (PI / 32.0) / (4.0 * PI);
        let soft = sun.soft(256);
        let mean = directions(n).map(|d| soft.radiance(d).x).sum::<f32>() / n as f32;
        assert!(
            (mean / (1000.0 * share) - 1.0).abs() < 0.25,
            "{mean}, expected {}",
            1000.0 * share
        );
    }

    #[test]
    fn a_soft_sky_has_no_seam() {
        let soft = gradient().soft(64);
        // Just above and just below the horizon, and on both sides of the picture's edges, it is the same light.
        for angle in (0..360).step_by(7) {
            let (z, x) = (angle as f32).to_radians().sin_cos();
            let above = soft.radiance(Vec3::new(x, 1e-4, z).normalize());
            let below = soft.radiance(Vec3::new(x, -1e-4, z).normalize());
            assert!(
                (above - below).abs().max_element() < 2e-3,
                "{above} and {below} at {angle}°"
            );
        }
    }
}
