//! Counts of the elements that sizes would give, without cutting them.

use super::contact::{Contacts, Crossings};
use super::cut;
use super::grain::{Clustering, Grains};
use super::mean;
use super::order::order;
use super::sizes::{Rule, Sizes};
use crate::scene::{Animation, deform::Shown};
use std::sync::Arc;

/// Counts the elements that edges of these sizes would give, and their sides that may hold light, stopping at
/// `limit` elements.
pub fn count_sides(animation: &Animation, sizes: &Sizes, limit: usize) -> (usize, usize) {
    let (mut elements, mut sides) = (0, 0);
    let shown = animation.shown();
    let contacts = contacts(animation, &shown);
    let light = contacts.near_light(sizes);
    let shared = shared(&shown, sizes);
    for (i, instance) in animation.instances.iter().enumerate() {
        let mesh = &animation.meshes[instance.mesh];
        let material = &animation.materials[mesh.material];
        let crossings = contacts.on(i, light.as_ref(), sizes);
        let here = count_on(&shown[i], sizes.of(i), crossings, limit - elements);
        elements += here;
        let apart = here - shared.get(i).copied().unwrap_or(0).min(here);
        sides += match (material.unlit, material.double_sided) {
            (true, _) => 0,
            (false, back) => apart * (1 + usize::from(back)),
        };
        if elements >= limit {
            break;
        }
    }
    (elements, sides)
}

/// For each instance how many triangles share the sides of another, where small ones are clustered.
fn shared(shown: &[Shown], sizes: &Sizes) -> Vec<usize> {
    let Sizes::Clustered(clustering) = sizes else {
        return Vec::new();
    };
    let grains = Grains::of(shown);
    let roots = grains.clusters(clustering);
    let count = |range: &[u32]| {
        let here = (range[0]..range[1]).zip(&roots[range[0] as usize..]);
        here.filter(|(triangle, root)| triangle != *root).count()
    };
    grains.first.windows(2).map(count).collect()
}

/// Counts the elements that edges of these sizes would give, stopping at `limit`.
pub fn count(animation: &Animation, sizes: &Sizes, limit: usize) -> usize {
    let shown = animation.shown();
    let contacts = contacts(animation, &shown);
    count_of(&shown, sizes, Some(&contacts), limit)
}

/// The same for triangles that are known, instance by instance; without contacts nothing is sliced.
pub(super) fn count_of(
    shown: &[Shown],
    sizes: &Sizes,
    contacts: Option<&Contacts>,
    limit: usize,
) -> usize {
    let mut total = 0;
    let light = contacts.and_then(|contacts| contacts.near_light(sizes));
    for (instance, shown) in shown.iter().enumerate() {
        let crossings = contacts.and_then(|contacts| contacts.on(instance, light.as_ref(), sizes));
        total += count_on(shown, sizes.of(instance), crossings, limit - total);
        if total >= limit {
            return limit;
        }
    }
    total
}

/// Counts the elements of one instance.
fn count_on(shown: &Shown, rule: Rule, mut crossings: Option<Crossings>, limit: usize) -> usize {
    let mut total = 0;
    for (k, corners) in shown.corners.iter().enumerate() {
        if let Some(crossings) = crossings.as_mut() {
            crossings.enter(k);
        }
        total += cut::count(corners, rule, crossings.as_mut(), limit - total);
        if total >= limit {
            return limit;
        }
    }
    total
}

/// Counts elements where small triangles are clustered and large ones are cut, stopping at about `limit`.
pub(super) fn clustered(
    shown: &[Shown],
    grains: &Grains,
    clustering: &Clustering,
    contacts: Option<&Contacts>,
    limit: usize,
) -> usize {
    let roots = grains.clusters(clustering);
    let sizes = Sizes::Clustered(*clustering);
    let light = contacts.and_then(|contacts| contacts.near_light(&sizes));
    let mut total = 0;
    for (instance, shown) in shown.iter().enumerate() {
        let mut crossings =
            contacts.and_then(|contacts| contacts.on(instance, light.as_ref(), &sizes));
        let first = grains.first[instance] as usize;
        for (triangle, corners) in (first..).zip(&shown.corners) {
            total += match grains.is_small(triangle, clustering.size) {
                true => usize::from(roots[triangle] as usize == triangle),
                false => cut::count(
                    corners,
                    sizes.of(instance),
                    crossings.as_mut(),
                    limit.saturating_sub(total),
                ),
            };
            if total >= limit {
                return limit;
            }
        }
    }
    total
}

/// What stands on surfaces, as the mesh will be cut by it: through holes nothing does.
pub(super) fn contacts(animation: &Animation, shown: &[Shown]) -> Contacts {
    let cutouts = Arc::new(mean::cutouts(animation, &order(animation), shown));
    Contacts::of(animation, shown, &cutouts)
}
