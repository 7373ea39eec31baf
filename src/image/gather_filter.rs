//! Filters of gathered irradiance: neighbours on the same plane see the room in different directions, so together they see
//! it well.
//!
//! The first filter is as wide as a tile, whose pixels share one set of directions. The others take five by five pixels
//! ever farther apart (Dammertz, Sewtz, Hanika, Lensch 2010, "Edge-avoiding À-Trous wavelet transform for fast global
//! illumination filtering", High Performance Graphics, 67–75), hardly farther than the harmonic mean of the distances to all
//! that is around: so far irradiance changes smoothly (Ward, Rubinstein, Clear 1988, "A ray tracing solution for diffuse
//! interreflection", Computer Graphics 22(4):85–92). A pixel keeps as much of its own light as its neighbours differ more than
//! by noise (`local_statistics.rs`). What the wide filters took from peaks and contacts is filtered once more and given back
//! (J. W. Tukey 1977, "Exploratory Data Analysis", Addison-Wesley, section 16: twicing), which halves their bias or better
//! and costs little of what they gain.

use super::fragments::Fragments;
use super::local_statistics::{Neighbours, NoisyLight};
use glam::Vec3;
use rayon::prelude::*;

/// Pixels between the neighbours of the wide filters: a tile's, and thrice that.
const STRIDES: [i64; 2] = [4, 12];

/// What a neighbour beyond the reach counts for: in a corner all but the corner's own line is beyond it, and specks would stay.
const SEAM: f32 = 0.2;

/// What arrives at a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct GatheredPlane {
    pub arrived: NoisyLight,
    /// The harmonic mean of the distances to what is around, in metres.
    pub distance: f32,
}

/// The planes of all pixels, in the order of [`Fragments`]; those that gather nothing have none.
pub(super) type GatheredPlanes = Vec<Option<GatheredPlane>>;

/// Irradiance without the noise that few directions leave.
pub(super) fn smooth(fragments: &Fragments, raw: &GatheredPlanes) -> Vec<Option<Vec3>> {
    let tile = over_tiles(fragments, raw);
    let level = wide(fragments, &tile);
    let taken = pairs(&tile, &level).map(|pair| {
        let (own, level) = pair?;
        let light = own.arrived.light - level.arrived.light;
        let arrived = NoisyLight {
            light,
            ..own.arrived
        };
        Some(GatheredPlane { arrived, ..own })
    });
    let back = wide(fragments, &taken.collect());
    let both = pairs(&level, &back).map(|pair| {
        let (level, back) = pair?;
        Some((level.arrived.light + back.arrived.light).max(Vec3::ZERO))
    });
    both.collect()
}

/// Two lists, plane by plane.
fn pairs<'a>(
    one: &'a GatheredPlanes,
    other: &'a GatheredPlanes,
) -> impl IndexedParallelIterator<Item = Option<(GatheredPlane, GatheredPlane)>> + use<'a> {
    one.par_iter()
        .zip(other)
        .map(|(one, other)| (*one).zip(*other))
}

/// Each plane's level over what is as wide as a tile, whatever is near: together it is one set of directions.
fn over_tiles(fragments: &Fragments, planes: &GatheredPlanes) -> GatheredPlanes {
    fragments.each(|index, number| {
        let here = fragments.place(index, number);
        planes[here]?;
        let mut neighbours = Neighbours::of(fragments.plane(here));
        let (mut total, mut near) = (0.0, 0.0);
        fragments.around(index, number, 1, |share, place| {
            if let Some(other) = &planes[place] {
                neighbours.add(fragments.plane(place).point, &other.arrived, share);
                total += share;
                near += share / other.distance;
            }
        });
        Some(GatheredPlane {
            arrived: neighbours.level(),
            distance: total / near,
        })
    })
}

/// All wide filters, one after the other.
fn wide(fragments: &Fragments, planes: &GatheredPlanes) -> GatheredPlanes {
    let [first, then] = STRIDES;
    let level = filtered(fragments, planes, first);
    filtered(fragments, &level, then)
}

/// Each plane's light among those of five by five pixels a stride apart.
fn filtered(fragments: &Fragments, planes: &GatheredPlanes, stride: i64) -> GatheredPlanes {
    fragments.each(|index, number| {
        let here = fragments.place(index, number);
        let own = planes[here]?;
        let plane = fragments.plane(here);
        let mut neighbours = Neighbours::of(plane);
        fragments.around(index, number, stride, |share, place| {
            if let Some(other) = &planes[place] {
                let point = fragments.plane(place).point;
                let reach = own.distance.min(other.distance).max(f32::MIN_POSITIVE);
                let near = (1.0 - point.distance(plane.point) / reach).max(SEAM);
                neighbours.add(point, &other.arrived, share * near);
            }
        });
        let arrived = neighbours.beside(&own.arrived);
        Some(GatheredPlane { arrived, ..own })
    })
}
