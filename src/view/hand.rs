//! A hand that holds a node: world coordinates from where it was, as edits in its parent's.

use super::message::Carry;
use crate::scene::{Animation, Target};
use crate::session::Session;
use glam::{DAffine3, DQuat, DVec3};
use serde_json::{Value, json};

/// A node as it was when the gesture began.
pub(super) struct Hand {
    /// The gesture, with the tab whose it is.
    gesture: (u64, u64),
    /// The node's number in its file.
    number: usize,
    /// Its position among the scene's nodes.
    node: usize,
    world: DAffine3,
    /// Whether clips set its transform.
    is_carried: bool,
}

impl Hand {
    /// A hand that takes a node; the error is for the one who asked.
    pub(super) fn take(
        session: &Session,
        number: usize,
        gesture: (u64, u64),
    ) -> Result<Hand, String> {
        let mut nodes = session.scene.animation.nodes.iter();
        let node = nodes.position(|node| node.index == number);
        let node = node.ok_or_else(|| {
            format!(
                "node: expected a node's number, got {number} — the scene's description lists them"
            )
        })?;
        Ok(Hand {
            gesture,
            number,
            node,
            is_carried: is_carried(&session.scene.animation, node),
            world: session.pose().world[node],
        })
    }

    /// Whether it is the hand of a gesture.
    pub(super) fn is_of(&self, number: usize, gesture: (u64, u64)) -> bool {
        self.number == number && self.gesture == gesture
    }

    /// The edits that put the node there. A node that clips carry is put there with all it has, so that the line means the
    /// same at any time of the clips.
    pub(super) fn edits(&self, session: &Session, places: &Carry) -> Result<Value, String> {
        let animation = &session.scene.animation;
        let pivot = places.about.map_or(self.world.translation, DVec3::from);
        let turned = DQuat::from_rotation_y(places.turn.to_radians());
        let moved = DAffine3::from_translation(DVec3::from(places.by) + pivot)
            * DAffine3::from_quat(turned)
            * DAffine3::from_translation(-pivot);
        let parent = animation.parent_to_world(self.node, session.pose());
        let local = parent.inverse() * moved * self.world;
        let (scale, rotation, to) = local.to_scale_rotation_translation();
        if !(to.is_finite() && rotation.is_finite() && scale.is_finite()) {
            return Err("place: expected finite numbers, got others — send a smaller way".into());
        }
        let made = DAffine3::from_scale_rotation_translation(scale, rotation, to);
        if !made.abs_diff_eq(local, 1e-6 * (1.0 + scale.abs().max_element())) {
            let got = "one that its parent's scale would slant";
            return Err(format!(
                "place: expected a turn, got {got} — turn a node above it"
            ));
        }
        let node = self.number;
        let mut edits = vec![json!({ "move": { "node": node, "to": to.to_array() } })];
        if places.turn != 0.0 || self.is_carried {
            edits.push(json!({ "rotate": { "node": node, "to": rotation.to_array() } }));
        }
        if self.is_carried {
            edits.push(json!({ "scale": { "node": node, "to": scale.to_array() } }));
        }
        Ok(edits.into())
    }
}

/// Whether a playing clip sets a node's transform.
fn is_carried(animation: &Animation, node: usize) -> bool {
    let clips = (animation.playing.iter()).filter_map(|clip| animation.clips.get(*clip));
    let mut targets = clips
        .flat_map(|clip| &clip.channels)
        .map(|channel| channel.target);
    let of = |target: Target| target.node().is_some_and(|known| known.index() == node);
    targets.any(|target| target.is_transform() && of(target))
}
