//! The order of instances in a mesh.

use crate::ids::InstanceId;
use crate::scene::Animation;

/// The instances, static ones first, so that the lower triangle id is the static one in every tie.
pub(super) fn order(animation: &Animation) -> Vec<InstanceId> {
    let moves = animation.moves();
    let mut order: Vec<InstanceId> = (0..animation.instances.len())
        .map(InstanceId::from_index)
        .collect();
    order.sort_by_key(|&instance| moves[instance]);
    order
}
