//! Writes the example animations: `cargo run --release --example generate [DIR]`.
//!
//! Every scene is built from closed solids that stand a millimetre apart, so that no two surfaces coincide; the files
//! are the same bytes on every run.

use std::path::PathBuf;

#[path = "generate/bathroom.rs"]
mod bathroom;
#[path = "generate/cornell.rs"]
mod cornell;
#[path = "generate/door.rs"]
mod door;
#[path = "generate/furniture.rs"]
mod furniture;
#[path = "generate/glb.rs"]
mod glb;
#[path = "generate/orrery.rs"]
mod orrery;
#[path = "generate/scene.rs"]
mod scene;
#[path = "generate/solid.rs"]
mod solid;
#[path = "generate/walkthrough.rs"]
mod walkthrough;

/// The time of the last of 48 frames at 24 frames a second: the first is at 0.
const LAST: f32 = 47.0 / 24.0;

/// The gap between things that seem to touch, in metres: far above f32's rounding, far below a pixel.
const GAP: f32 = 0.001;

fn main() -> std::io::Result<()> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("animations");
    let folder = std::env::args_os().nth(1).map_or(beside, PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    for scene in [
        door::scene(),
        cornell::scene(),
        walkthrough::scene(),
        orrery::scene(),
        bathroom::scene(),
    ] {
        let file = folder.join(scene.name).with_extension("glb");
        let bytes = glb::encode(&scene);
        std::fs::write(&file, &bytes)?;
        let faces = scene
            .nodes
            .iter()
            .flat_map(|node| &node.solids)
            .flat_map(|solid| &solid.faces);
        let triangles: usize = faces.map(|face| face.corners.len() - 2).sum();
        println!(
            "{}: {triangles} triangles, {} bytes",
            file.display(),
            bytes.len()
        );
    }
    Ok(())
}
