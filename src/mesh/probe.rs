//! The scene at a few times of the clip, to judge beforehand what light can reach.

use super::{PosedMesh, RadiosityMesh};
use crate::scene::Animation;
use crate::scene::pose::{Pose, Presence};

/// Times of the clip at which it is judged which sides light can reach.
const PROBED_TIMES: usize = 5;

/// Times spread over the clip. What comes and goes is there at each of them, and then gone at each.
pub fn poses(
    patches: &RadiosityMesh,
    animation: &Animation,
    rest: &PosedMesh,
) -> Vec<(Pose, PosedMesh)> {
    let times = if animation.seconds() > 0.0 {
        PROBED_TIMES
    } else {
        1
    };
    let step = animation.seconds() / (times.max(2) - 1) as f64;
    let presence = animation.presence();
    let cases: &[bool] = if presence.contains(&Presence::AtTimes) {
        &[true, false]
    } else {
        &[true]
    };
    let case = |(i, there): (usize, bool)| {
        let mut pose = animation.pose(i as f64 * step);
        let comes_and_goes = |p: &Presence| *p == Presence::AtTimes;
        for (visible, _) in (pose.visible.iter_mut().zip(&presence))
            .filter(|(_, presence)| comes_and_goes(presence))
        {
            *visible = there;
        }
        let placed = patches.moved(rest, animation, &pose);
        (pose, placed)
    };
    (0..times)
        .flat_map(|i| cases.iter().map(move |there| (i, *there)))
        .map(case)
        .collect()
}
