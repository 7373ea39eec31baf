//! The size for a budget of elements.

use super::contact::{self, Contacts};
use super::count::{clustered, contacts, count_of};
use super::cuts::MOST_ELEMENTS;
use super::grain::{Clustering, Grains, LIKENESSES, Likeness};
use super::shadow_lines::{ShadowLines, ShadowPlanes};
use super::sizes::{GRADE, Grade, Shadowed, SizeField, Sizes};
use crate::error::Error;
use crate::scene::{Animation, deform::Shown};
use glam::Vec3;
use std::sync::Arc;

/// No even size is smaller than the longest edge divided by this.
const FINEST: f32 = 4096.0;

/// Halvings of an exponent's interval: twelve bring a size within 0.2 %.
const HALVINGS: usize = 12;

/// Small triangles eat the budget where they are more than this share of it.
const EATEN: f32 = 0.75;

/// Edges of what is cut beside clusters, at least, as a share of what these stand for.
const FINER: f32 = 0.6;

/// Halvings of that interval.
const EDGE_HALVINGS: usize = 6;

/// Edges so many times as long as the longest leave every triangle small; as long as the scene, as many in a cluster as look alike.
const LARGEST: f32 = 4.0;

/// The fewest clusters that likeness leaves take at most one in so many elements of the budget.
const MOST_FEWEST: usize = 4;

/// An even mesh is left as it is where it uses more than this share of the budget.
const USED: f32 = 0.95;

/// Halvings of the interval of a graded size: one in ten thousand, while edges of one length take a twentieth of it.
const GRADE_HALVINGS: usize = 13;

/// Sixteen halvings bring a size of clusters within 0.03 %, and their number as near as cubes allow.
const CLUSTER_HALVINGS: usize = 16;

/// Below this share of what is worth most nothing is worth a split: a quarter of an edge has 1/256 of its worth.
const LEAST_ERROR: f32 = 1e-16;

/// Twenty bring a worth within 0.004 %: elements come by the pair.
const ERROR_HALVINGS: usize = 20;

/// Boundaries of shadows take at most this share of the budget: with more, what lies between them would be too coarse.
const CUTS: f32 = 0.5;

/// Halvings of the interval of an even size beside them.
const EVEN_HALVINGS: usize = 8;

/// The first step by which edges grow to make room for slices; a split's worth grows with their fourth power.
const STEP: f32 = 1.01;

/// Halvings of the last of these steps.
const STEPS_BACK: usize = 3;

/// The longest edge in metres that gives about `budget` elements, found by halving an interval.
///
/// A scene whose own triangles are more than the budget gets its own longest edge: triangles are never merged.
pub fn size_for(animation: &Animation, budget: usize) -> f32 {
    let shown = animation.shown();
    even_size(&shown, &contacts(animation, &shown), budget)
}

/// The same for triangles and contacts that are known.
fn even_size(shown: &[Shown], contacts: &Contacts, budget: usize) -> f32 {
    let mut longest = 0.0f32;
    for [a, b, c] in shown.iter().flat_map(|shown| &shown.corners) {
        longest = longest
            .max(a.distance(*b))
            .max(b.distance(*c))
            .max(c.distance(*a));
    }
    let fits = |size: f32, contacts: Option<&Contacts>| {
        count_of(shown, &Sizes::Even(size), contacts, budget + 1) <= budget
    };
    if longest == 0.0 || !fits(longest, None) {
        return longest.max(f32::MIN_POSITIVE);
    }
    let size = least(longest / FINEST, longest, HALVINGS, |size| fits(size, None));
    from(size, STEP, longest, |size| fits(size, Some(contacts)))
}

/// Sizes that give about `budget` elements: even ones or, where small triangles would eat the budget, clusters of them.
pub fn sizes_for(animation: &Animation, budget: usize) -> Sizes {
    // Leave meshes alone that are as even as they are wanted.
    let shown = animation.shown();
    let contacts = contacts(animation, &shown);
    let even = even_size(&shown, &contacts, budget);
    let grains = Grains::of(&shown);
    let total = grains.longest.len();
    let small = (0..total).filter(|k| grains.is_small(*k, even)).count();
    if total <= budget && small as f32 <= EATEN * budget as f32 {
        return graded(&shown, &contacts, even, budget);
    }

    // Take the triangles of a cluster as alike as leaves most of the budget for all else.
    let longest = grains.longest.iter().fold(0.0, |a: f32, b| a.max(*b));
    let (_, radius) = ball(&shown);
    let whole = (longest * LARGEST).max(2.0 * radius);
    let fewest = |likeness: &&Likeness| {
        let likeness = **likeness;
        let fewest = Clustering {
            edge: whole,
            size: whole,
            likeness,
            halvings: 0,
        };
        MOST_FEWEST * clustered(&shown, &grains, &fewest, None, usize::MAX) <= budget
    };
    let last = &LIKENESSES[LIKENESSES.len() - 1];
    let likeness = *LIKENESSES.iter().find(fewest).unwrap_or(last);
    let fits = |size: f32, edge: f32, contacts: Option<&Contacts>| {
        let clustering = Clustering {
            edge,
            size,
            likeness,
            halvings: 0,
        };
        clustered(&shown, &grains, &clustering, contacts, budget + 1) <= budget
    };
    let size = least(longest / FINEST, whole, CLUSTER_HALVINGS, |size| {
        fits(size, size, None)
    });
    let size = from(size, STEP, whole, |size| fits(size, size, Some(&contacts)));

    // Clusters come many at a time: to use what they leave, cut what is large a little finer, and halve the largest clusters.
    let edge = least(size * FINER, size, EDGE_HALVINGS, |edge| {
        fits(size, edge, Some(&contacts))
    });
    let whole = Clustering {
        edge,
        size,
        likeness,
        halvings: 0,
    };
    let used = clustered(&shown, &grains, &whole, Some(&contacts), budget);
    Sizes::Clustered(Clustering {
        halvings: (budget - used) as u32,
        ..whole
    })
}

/// An even mesh or, where that leaves much of the budget because many edges are of one length, a graded one.
fn graded(shown: &[Shown], contacts: &Contacts, even: f32, budget: usize) -> Sizes {
    let count = |sizes: &Sizes| count_of(shown, sizes, Some(contacts), budget + 1);
    if count(&Sizes::Even(even)) as f32 > USED * budget as f32 {
        return Sizes::Even(even);
    }
    let (middle, radius) = ball(shown);
    let sizes = |longest: f32| {
        Sizes::Graded(Grade {
            longest,
            middle,
            radius,
        })
    };
    let most = even * (1.0 + 2.0 * GRADE);
    let longest = least(even * FINER, most, GRADE_HALVINGS, |longest| {
        count(&sizes(longest)) <= budget
    });
    match count(&sizes(longest)) <= budget {
        true => sizes(longest),
        false => Sizes::Even(even),
    }
}

/// The middle of a scene, and the distance of the corners of its box.
fn ball(shown: &[Shown]) -> (Vec3, f32) {
    let corners = || shown.iter().flat_map(|shown| shown.corners.as_flattened());
    let low = corners().fold(Vec3::INFINITY, |low, p| low.min(*p));
    let high = corners().fold(Vec3::NEG_INFINITY, |high, p| high.max(*p));
    let middle = (low + high) * 0.5;
    (middle, middle.distance(high).max(f32::MIN_POSITIVE))
}

/// The field's sizes where splits are worth the least that gives no more than `budget` elements.
///
/// `most` is worth more than any split.
pub fn within(animation: &Animation, field: SizeField, budget: usize, most: f32) -> Sizes {
    let shown = animation.shown();
    let contacts = contacts(animation, &shown);
    let mut sizes = Sizes::Needed(field);
    let mut set = |error: f32, contacts: Option<&Contacts>| {
        if let Sizes::Needed(field) = &mut sizes {
            field.least = error;
        }
        count_of(&shown, &sizes, contacts, budget + 1) <= budget
    };
    let error = least(most * LEAST_ERROR, most, ERROR_HALVINGS, |error| {
        set(error, None)
    });
    let error = from(error, STEP.powi(4), most, |error| {
        set(error, Some(&contacts))
    });
    set(error, None);
    sizes
}

/// The boundaries of the shadows of an animation's resting geometry, for elements with edges up to `even` metres.
pub fn shadow_planes(animation: &Animation, even: f32) -> ShadowPlanes {
    let shown = animation.shown();
    ShadowPlanes::of(animation, &shown, even, contact::ray_offset(&shown))
}

/// Sizes that give no more than `budget` elements, cut along the strongest of these boundaries; `even` metres is the edge of a
/// uniform mesh of as many. Cuts take up to half of the budget; what they leave makes edges shorter again.
pub fn along(animation: &Animation, lines: ShadowLines, even: f32, budget: usize) -> Sizes {
    let most = lines.len() as u32;
    if most == 0 {
        return Sizes::Even(even);
    }
    let (shown, lines) = (animation.shown(), Arc::new(lines));
    let contacts = contacts(animation, &shown);
    let sizes = |even: f32, take: u32| {
        let lines = lines.clone();
        Sizes::Shadowed(Shadowed { even, lines, take })
    };
    let fits = |even: f32, take: u32| {
        count_of(&shown, &sizes(even, take), Some(&contacts), budget + 1) <= budget
    };
    // Elements grow with the square of their edge; near light may still make more of larger ones.
    let coarse = even / (1.0 - CUTS).sqrt();
    let Some(coarse) = [coarse, even].into_iter().find(|size| fits(*size, 0)) else {
        return Sizes::Even(even);
    };
    let (mut take, mut beyond) = (0, most + 1);
    while beyond - take > 1 {
        let middle = take + (beyond - take) / 2;
        match fits(coarse, middle) {
            true => take = middle,
            false => beyond = middle,
        }
    }
    let fine = least(even * FINER, coarse, EVEN_HALVINGS, |even| fits(even, take));
    sizes(fine, take)
}

/// A value that fits, from `start` on: slices come on top of what was found without them, and are dear to count, so steps
/// that double lead up to the first that fits, and a few halvings back.
fn from(start: f32, step: f32, most: f32, mut fits: impl FnMut(f32) -> bool) -> f32 {
    let (mut low, mut high, mut step) = (start, start, step);
    while !fits(high) {
        if high >= most {
            return most;
        }
        low = high;
        high = (high * step).min(most);
        step *= step;
    }
    if high == start {
        return start;
    }
    least(low, high, STEPS_BACK, fits)
}

/// The least value from `low` to `high` that fits, if any does, found by halving the interval of its exponent.
fn least(mut low: f32, mut high: f32, halvings: usize, mut fits: impl FnMut(f32) -> bool) -> f32 {
    for _ in 0..halvings {
        let middle = (low * high).sqrt();
        if fits(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    high
}

pub(super) fn too_many(animation: &Animation, size: f32, got: usize) -> Error {
    Error::Usage {
        flag: "--element-size".into(),
        expected: format!(
            "fewer than {MOST_ELEMENTS} elements in {}",
            animation.file.display()
        ),
        got: format!("{got} and more at {size} m"),
        way_out: "give a larger --element-size in metres".into(),
    }
}
