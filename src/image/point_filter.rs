//! Filter of what arrives at gather points: neighbours on the same plane see the room in different directions.
//!
//! Each point takes the level of a linear fit over the points around it, no farther than irradiance changes smoothly (Ward,
//! Rubinstein, Clear 1988, "A ray tracing solution for diffuse interreflection", Computer Graphics 22(4):85–92), and keeps as
//! much of its own as these differ more than by noise (`local_statistics.rs`). A second, wider filter knows how little noise the
//! first has left, so that the light of a window stays where a single wide one smears it over the wall beside. What both took
//! from peaks is filtered once more and given back, as for pixels (`gather_filter.rs`). The points are those that one frame sees,
//! in the order of their names: so the result is that of the frame, whatever was seen before.

use super::fragment::Plane;
use super::gather_filter::GatheredPlane;
use super::local_statistics::{Neighbours, NoisyLight};
use glam::Vec3;
use rayon::prelude::*;

/// Neighbours of the first and the second filter lie no farther than so many steps to the next point.
const STEPS: [f32; 2] = [1.5, 3.0];

/// What a neighbour beyond the reach counts for: in a corner all but the corner's own line is beyond it, and specks would stay.
const SEAM: f32 = 0.2;

/// What arrives at a point of a surface.
#[derive(Clone, Copy)]
pub(super) struct Spot {
    pub(super) plane: Plane,
    /// Metres to the farthest of the points next to it.
    pub(super) step: f32,
    pub(super) gathered: GatheredPlane,
}

/// Irradiance at each spot without the noise of its samples.
pub(super) fn smooth(spots: &[Spot]) -> Vec<Vec3> {
    let around = STEPS.map(|steps| around(spots, steps));
    let both = |lights: Vec<NoisyLight>| {
        let filters = around.iter();
        filters.fold(lights, |lights, around| filtered(spots, around, &lights))
    };
    let own: Vec<NoisyLight> = spots.iter().map(|spot| spot.gathered.arrived).collect();
    let level = both(own.clone());
    let taken = own.iter().zip(&level).map(|(own, level)| NoisyLight {
        light: own.light - level.light,
        ..*own
    });
    let back = both(taken.collect());
    let pairs = level.iter().zip(&back);
    pairs
        .map(|(level, back)| (level.light + back.light).max(Vec3::ZERO))
        .collect()
}

/// Each spot's light among those around it.
fn filtered(spots: &[Spot], around: &[Vec<(u32, f32)>], lights: &[NoisyLight]) -> Vec<NoisyLight> {
    let of = |(index, around): (usize, &Vec<(u32, f32)>)| {
        let mut neighbours = Neighbours::of(&spots[index].plane);
        for (other, weight) in around {
            let other = *other as usize;
            neighbours.add(spots[other].plane.point, &lights[other], *weight);
        }
        neighbours.beside(&lights[index])
    };
    around.par_iter().enumerate().map(of).collect()
}

/// Cells of a grid that spots of about one step lie in, as they are sorted.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct GridCell {
    /// The length of its edges as a power of two.
    size: i32,
    place: [i32; 3],
}

impl GridCell {
    /// The cell of that size at a point.
    fn at(size: i32, point: Vec3) -> GridCell {
        let place = (point / f32::powi(2.0, size)).floor().as_ivec3();
        GridCell {
            size,
            place: place.to_array(),
        }
    }
}

/// The power of two of the cells in which a spot lies for a filter of so many steps.
fn size(spot: &Spot, steps: f32) -> i32 {
    (steps * spot.step).log2().ceil() as i32
}

/// The spots no farther than so many steps around each, itself among them, in order, and what each counts for.
fn around(spots: &[Spot], steps: f32) -> Vec<Vec<(u32, f32)>> {
    let cell = |spot: &Spot| GridCell::at(size(spot, steps), spot.plane.point);
    let mut sorted: Vec<(GridCell, u32)> = spots.iter().map(cell).zip(0..).collect();
    sorted.par_sort_unstable();
    let of = |spot: &Spot| {
        let mut found = Vec::new();
        let own = size(spot, steps);
        for size in own - 1..=own + 1 {
            let middle = GridCell::at(size, spot.plane.point).place;
            for at in 0..9 {
                // The three cells of a column lie together.
                let [x, y] = [middle[0] + at % 3 - 1, middle[1] + at / 3 - 1];
                let [first, last] = [-1, 1].map(|z| [x, y, middle[2] + z]);
                let [first, last] = [first, last].map(|place| GridCell { size, place });
                let start = sorted.partition_point(|(cell, _)| *cell < first);
                let column = sorted[start..].iter();
                for (_, index) in column.take_while(|(cell, _)| *cell <= last) {
                    let weight = weight(spot, &spots[*index as usize], steps);
                    if weight > 0.0 {
                        found.push((*index, weight));
                    }
                }
            }
        }
        found.sort_unstable_by_key(|(index, _)| *index);
        found
    };
    spots.par_iter().with_min_len(16).map(of).collect()
}

/// What a spot counts for to another.
fn weight(spot: &Spot, other: &Spot, steps: f32) -> f32 {
    let far = spot.plane.point.distance(other.plane.point);
    let most = steps * spot.step;
    if far >= most || !other.plane.continues(&spot.plane) {
        return 0.0;
    }
    let reach = spot.gathered.distance.min(other.gathered.distance);
    let near = (1.0 - far / reach.max(f32::MIN_POSITIVE)).max(SEAM);
    near * (1.0 - (far / most).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::SurfaceId;

    /// Twenty by twenty spots a step apart on the ground, with this light at each.
    fn ground(light: impl Fn(usize) -> f32, variance: f32) -> Vec<Spot> {
        let spot = |k: usize| Spot {
            plane: Plane::of(
                (SurfaceId::new(0), false),
                Vec3::new((k % 20) as f32, 0.0, (k / 20) as f32) * 0.1,
                Vec3::Y,
            ),
            step: 0.1,
            gathered: GatheredPlane {
                arrived: NoisyLight {
                    light: Vec3::splat(light(k)),
                    variance,
                },
                distance: 10.0,
            },
        };
        (0..400).map(spot).collect()
    }

    #[test]
    fn light_that_is_even_or_slopes_evenly_stays() {
        for slope in [0.0, 0.01] {
            let light = |k: usize| 2.0 + slope * (k % 20) as f32;
            for (k, smooth) in smooth(&ground(light, 0.0)).into_iter().enumerate() {
                assert!((smooth.x - light(k)).abs() < 1e-4, "{smooth} at {k}");
            }
        }
    }

    /// Light 1 and 3 by turns is noise of 1 in each channel, 9 in their sum: known as such less than half is left by the few
    /// around. Known to be none, it stays.
    #[test]
    fn noise_goes_and_what_is_sure_stays() {
        let light = |k: usize| {
            if (k % 20 + k / 20).is_multiple_of(2) {
                1.0
            } else {
                3.0
            }
        };
        let inside = |k: &usize| (2..18).contains(&(k % 20)) && (2..18).contains(&(k / 20));
        let off = |variance: f32| {
            let smooth = smooth(&ground(light, variance));
            let off = (0..400).filter(inside).map(|k| (smooth[k].x - 2.0).abs());
            off.fold(0.0, f32::max)
        };
        assert!(off(9.0) < 0.5, "{}", off(9.0));
        assert!((off(0.0) - 1.0).abs() < 1e-4, "{}", off(0.0));
    }

    #[test]
    fn what_lies_apart_does_not_mix() {
        let mut spots = ground(|_| 2.0, 9.0);
        for spot in &mut spots[200..] {
            spot.plane.point.y += 0.05;
            spot.gathered.arrived.light = Vec3::splat(5.0);
        }
        for (k, smooth) in smooth(&spots).into_iter().enumerate() {
            let own = if k < 200 { 2.0 } else { 5.0 };
            assert!((smooth.x - own).abs() < 1e-4, "{smooth} at {k}");
        }
    }
}
