//! Random motion: a block on a path of random keys.

use crate::support::scene::{self, Scene};
use glam::{Quat, Vec3};
use proptest::prelude::*;

/// A block on a random path in a room, a step a key.
pub(crate) fn flight(keys: &[(Vec3, Quat, Vec3)], interpolation: &str) -> Scene {
    let mut scene = scene::room();
    let block = scene::block(&mut scene, "block", Vec3::new(0.25, 0.4, 0.15));
    let times = |n: usize| n as f32 / 4.0;
    let of = |pick: fn(&(Vec3, Quat, Vec3)) -> Vec3| -> Vec<(f32, Vec3)> {
        keys.iter()
            .enumerate()
            .map(|(n, key)| (times(n), pick(key)))
            .collect()
    };
    scene.slide(block, interpolation, &of(|key| key.0));
    scene.scale(block, interpolation, &of(|key| key.2));
    let turns: Vec<(f32, Quat)> = keys
        .iter()
        .enumerate()
        .map(|(n, key)| (times(n), key.1))
        .collect();
    scene.turn(block, interpolation, &turns);
    scene
}

/// Two to four random keys: anywhere in the room (and through its walls), in any turn, mirrored or not.
pub(crate) fn keys() -> impl Strategy<Value = Vec<(Vec3, Quat, Vec3)>> {
    let place = (-2.0f32..2.0, -1.4f32..1.4, -2.0f32..2.0).prop_map(Vec3::from);
    let axis = (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(Vec3::from);
    let turn = (axis, -3.0f32..3.0).prop_map(|(axis, angle)| {
        Quat::from_axis_angle(axis.try_normalize().unwrap_or(Vec3::Y), angle)
    });
    let wide = (0.5f32..2.0, any::<bool>()).prop_map(|(x, mirrored)| if mirrored { -x } else { x });
    let size = (wide, 0.5f32..2.0, 0.5f32..2.0).prop_map(Vec3::from);
    prop::collection::vec((place, turn, size), 2..=4)
}
