//! What a renderer does with a file before the first ray; the property tests and the fuzzer share it.

use glam::Vec3;
use std::path::Path;
use sweeplight::error::Result;
use sweeplight::mesh::{self, RadiosityMesh};
use sweeplight::scene::{Animation, FileLimits, view::Eye};

/// Opens a file and, where it opens, does with it what a renderer does before the first ray.
pub(crate) fn exercise(content: Vec<u8>) -> Result<()> {
    let mut animation = Animation::read(
        Path::new("nowhere/mutated.glb"),
        content,
        None,
        FileLimits::default(),
    )?;
    animation.move_origin();
    animation.raise_coplanar();
    for clip in 0..animation.clips.len() {
        animation.playing = vec![clip];
        animation.moves();
        let last = animation.seconds();
        for seconds in [0.0, 0.3, last / 2.0, last, last + 1.0] {
            let pose = animation.pose(seconds);
            let whole = animation.ball([0.0, seconds]).ok().map(Eye::Whole);
            let cameras = (0..animation.cameras.len()).map(Eye::Camera);
            for eye in cameras.chain(whole) {
                // A view may be refused, as one without a direction is.
                let _ = animation.view(&eye, &pose, 16.0 / 9.0);
            }
            animation.check(&pose, |_| true)?;
        }
    }
    // As every command does: a file may have no clip.
    animation.check(&animation.pose(0.0), |_| true)?;
    // A thousand elements show as much as a million.
    let sizes = mesh::sizes_for(&animation, 1000);
    let patches = RadiosityMesh::cut_by(&animation, &sizes)?;
    let placed = patches.at(&animation, &animation.pose(0.1));
    assert!(placed.bounds().extent().cmpge(Vec3::ZERO).all());
    Ok(())
}
