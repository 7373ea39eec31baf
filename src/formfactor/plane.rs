//! The single plane: one window over the receiver, cut into uneven cells that all carry the same factor.
//!
//! Sillion, Puech 1989, "A general two-pass method integrating specular and diffuse reflection", Computer Graphics
//! 23(3):335–344. A point (x, y, 1) of the plane carries dx dy / π(x² + y² + 1)². What lies lower than the window's rim is
//! lost, and the rest is renormalised: a patch of factor F, of which L′ lies under the rim, comes out as (F − L′)/(1 − L).
//!
//! We depart in the cells. The paper's grid gives each a similar factor; here the window is cut into columns, and each
//! column into cells, such that all of them carry the same to the last bit. So no cell is wasted, and none needs a weight.
//! A ray through a cell's middle, by factor, answers for it; the paper subdivides by Warnock's algorithm.

use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Half the window's width over its height. The rim loses 0.82/WIDE² of all light, 0.08 %: less than any number of samples
/// leaves as an error. Cells are uneven, so a wider window needs no more of them; half of it loses four times as much.
const WIDE: f64 = 32.0;

/// Steps of a bisection: to 3 · 10⁻¹¹ of the height, far below the last bit of a direction.
const HALVINGS: usize = 41;

/// The factor of the rectangle from the foot of the normal to (x, y); odd in both.
fn corner(x: f64, y: f64) -> f64 {
    let (u, v) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / u * (y / u).atan() + y / v * (x / v).atan()) / TAU
}

/// The factor of the whole window: what the rim loses is missing from 1.
pub fn window() -> f64 {
    4.0 * corner(WIDE, WIDE)
}

/// Where an increasing function between the window's rims reaches a value.
fn reaches(value: f64, of: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (-WIDE, WIDE);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if of(middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Unit directions around +z through the middle of each of `cells` cells of equal factor.
pub fn directions(cells: usize) -> Vec<Vec3> {
    // Cut about as many columns as a column has cells, their factors in proportion to their cells.
    let columns = (cells as f64).sqrt().round().max(1.0) as usize;
    let each = 1.0 / cells.max(1) as f64;
    let left_of = |x: f64| 0.5 + 2.0 * corner(x, WIDE) / window();
    let first = |column: usize| column * cells / columns;
    let mut all = Vec::with_capacity(cells);
    for column in 0..columns {
        let [start, end] = [column, column + 1].map(first);
        let at = |cell: f64| reaches(cell * each, left_of);
        let [left, middle, right] = [start as f64, 0.5 * (start + end) as f64, end as f64].map(at);
        // Cut the column: all below the middle of each cell is half a cell more than the cells under it.
        let below = |y: f64| {
            let part = corner(right, y) - corner(left, y);
            let half = corner(right, WIDE) - corner(left, WIDE);
            0.5 + 0.5 * part / half
        };
        let count = end - start;
        for cell in 0..count {
            let y = reaches((cell as f64 + 0.5) / count as f64, below);
            all.push(DVec3::new(middle, y, 1.0).normalize().as_vec3());
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rim_loses_what_is_said() {
        let lost = 1.0 - window();
        assert!((lost * WIDE * WIDE - 0.82).abs() < 0.005, "{lost}");
    }

    #[test]
    fn cells_hold_the_hemisphere_evenly() {
        // Under a cosine the mean of z is 2/3 and of x and y 0; half of all factors lie within 45° of the normal. What
        // 1024 middles of cells make of a mean is off by about a cell's breadth squared, 1/1024.
        for cells in [16, 128, 1000, 1024] {
            let all = directions(cells);
            assert_eq!(all.len(), cells);
            let mean = all.iter().copied().sum::<Vec3>() / cells as f32;
            let off = (mean - Vec3::new(0.0, 0.0, 2.0 / 3.0)).length();
            assert!(off < 1.0 / cells as f32 + 2e-3, "{cells}: {mean}");
        }
        let all = directions(1024);
        let steep = all.iter().filter(|d| d.z * d.z > 0.5).count();
        assert!(steep.abs_diff(512) <= 16, "{steep}");
    }

    #[test]
    fn every_cell_lies_in_the_window() {
        let inside = |d: &Vec3| d.z > 0.0 && d.x.abs().max(d.y.abs()) < d.z * WIDE as f32;
        assert!(directions(4096).iter().all(inside));
    }
}
