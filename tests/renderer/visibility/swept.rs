//! The swept volume is sound only if it holds every mover in every rendered pose: each vertex lies in some box.

use crate::support::flight::{flight, keys};
use crate::support::property;
use crate::support::run::case;
use proptest::prelude::*;
use sweeplight::geometry::Bounds;
use sweeplight::mesh::RadiosityMesh;
use sweeplight::sequence::{opening, timeline};
use sweeplight::visibility::swept_volume::{Parts, SweptVolume};

proptest! {
    #![proptest_config(property::config(64))]

    #[test]
    fn every_vertex_of_every_pose_lies_inside(keys in keys(), step in any::<bool>(), fps in 4.0f64..60.0) {
        let mut case = case(&flight(&keys, if step { "STEP" } else { "LINEAR" }));
        case.settings.scene.fps = fps;
        let animation = opening::open(&case.settings).expect("a scene");
        let patches = RadiosityMesh::cut(&animation, 10.0).expect("patches");
        let rest = patches.at(&animation, &animation.pose(0.0));
        let frames = timeline::frames(&case.settings, &animation).expect("frames");
        let times: Vec<f64> = frames.iter().map(|frame| f64::from(*frame) / fps).collect();
        let pose = |time: f64| patches.at(&animation, &animation.pose(time));
        let poses: Vec<_> = frames
            .into_iter()
            .map(|frame| patches.at(&animation, &timeline::pose(&animation, &case.settings, frame)))
            .collect();
        let swept = SweptVolume::of(&Parts::of(&patches, &rest), times, pose);
        prop_assert!(!swept.boxes.is_empty());
        for placed in &poses {
            let moving = patches.moving(placed);
            prop_assert_eq!(moving.len(), 12, "a block has twelve triangles");
            for corner in moving.iter().flatten() {
                let holds = |b: &Bounds| b.lo.cmple(*corner).all() && corner.cmple(b.hi).all();
                prop_assert!(swept.boxes.iter().any(holds), "{} is outside", corner);
            }
        }
    }
}
