//! Rigid bodies: the instances that the playing clips carry about without deforming, stretching or hiding them.
//!
//! Instances with the same carrier never change their places to one another. So what a point on a body sees of the same
//! body is the same at all times.

use super::pose::Presence;
use super::{Animation, Instance, NodeId, Target};
use glam::DMat3;

/// How far the squares of a transform's lengths may lie apart, relative to the largest: beyond it a turn deforms.
const SIMILAR: f64 = 1e-6;

/// What the playing clips change of a node's own transform.
#[derive(Clone, Copy, Default)]
struct Motion {
    shifts: bool,
    turns: bool,
    stretches: bool,
}

/// How a node and all above it move.
#[derive(Clone, Copy)]
enum Carried {
    Rests,
    /// By this node, the lowest that is shifted or turned.
    Rigidly(NodeId),
    Deformed,
}

impl Animation {
    /// The node that carries each instance rigidly; `None` for an instance that rests, or that is deformed, stretched or
    /// hidden at any time.
    pub fn carriers(&self) -> Vec<Option<NodeId>> {
        let (carried, presence) = (self.carried(), self.presence());
        let weights = self.weights_change();
        let carrier = |instance: &Instance| {
            let node = instance.node;
            let keeps = instance.skin.is_none() && !self.morphs(instance, &weights);
            match carried[node.index()] {
                Carried::Rigidly(by) if keeps && presence[node] == Presence::Always => Some(by),
                _ => None,
            }
        };
        self.instances.iter().map(carrier).collect()
    }

    fn carried(&self) -> Vec<Carried> {
        let mut own = vec![Motion::default(); self.nodes.len()];
        for channel in self.played().flat_map(|clip| &clip.channels) {
            let varies = !channel.track.is_constant();
            match channel.target {
                Target::Translation(node) => own[node].shifts |= varies,
                Target::Rotation(node) => own[node].turns |= varies,
                Target::Scale(node) => own[node].stretches |= varies,
                _ => {}
            }
        }
        // A turn below a transform that keeps angles is a turn of the whole; no other is.
        let world = self.pose(0.0).world;
        let mut all: Vec<Carried> = Vec::with_capacity(self.nodes.len());
        for (index, (node, own)) in self.nodes.iter().zip(own).enumerate() {
            let above = node.parent.map_or(Carried::Rests, |up| all[up.index()]);
            let straight = || node.parent.is_none_or(|up| is_similar(&world[up].matrix3));
            all.push(match above {
                Carried::Deformed => Carried::Deformed,
                _ if own.stretches || own.turns && !straight() => Carried::Deformed,
                _ if own.turns || own.shifts => Carried::Rigidly(NodeId::from_index(index)),
                above => above,
            });
        }
        all
    }
}

/// Whether a transform keeps all angles: it turns, mirrors and scales alike in all directions.
fn is_similar(m: &DMat3) -> bool {
    let gram = m.transpose() * *m;
    let size = gram.x_axis.x;
    let rest = gram - DMat3::from_diagonal(glam::DVec3::splat(size));
    let off = rest.to_cols_array().map(f64::abs);
    off.iter().all(|off| *off <= SIMILAR * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_turns_mirrors_and_even_scales_keep_angles() {
        let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(2.0);
        assert!(is_similar(&(turn * 3.0)));
        assert!(is_similar(
            &(turn * DMat3::from_diagonal((-2.0, 2.0, 2.0).into()))
        ));
        assert!(!is_similar(
            &(turn * DMat3::from_diagonal((1.0, 1.0, 1.01).into()))
        ));
        assert!(!is_similar(&DMat3::from_cols_array(&[
            1.0, 0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 1.0
        ])));
    }
}
