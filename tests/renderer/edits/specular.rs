//! Edits among mirrors and glass: the state is that of a fresh build, paths and tints included.

use crate::support::run::case;
use crate::support::specular::hall;
use glam::{Quat, Vec3};
use sweeplight::sequence::{edit, silence};
use sweeplight::session::Step;

#[test]
fn mirrors_panes_and_what_they_show_are_moved_and_painted() {
    let at_rest = [(Vec3::new(0.2, -1.0, -0.4), Quat::IDENTITY); 3];
    let mut case = case(&hall(at_rest));
    case.settings.solve.samples = Some(32);
    case.settings.image.finish_samples = 4;
    let opened = edit::open(&case.settings, false, &silence);
    let mut session = opened.expect("a scene that can be edited").0;
    let camera = session.camera((24, 14)).expect("a camera");
    for line in [
        r#"{"edits":[{"move":{"node":"mirror door","by":[0.3,0,0.2]}}]}"#,
        r#"{"edits":[{"move":{"node":"ball","by":[-0.6,0.1,0.3]}},{"rotate":{"node":"pane","by":{"axis":[0,1,0],"degrees":50}}}]}"#,
        r#"{"edits":[{"hide":{"node":"mirror"}}]}"#,
        r#"{"edits":[{"show":{"node":"mirror"}},{"color":{"material":0,"to":[0.3,0.6,0.7]}}]}"#,
        r#"{"edits":[{"move":{"node":"paper","by":[-0.5,0.4,0.9]}},{"hide":{"node":"curtain"}}]}"#,
        r#"{"edits":[{"emission":{"material":1,"color":[1,0.5,0.2],"strength":9}}]}"#,
    ] {
        let step = Step::parse(line).expect("edits");
        session.apply(&step.edits).expect("edits that can be made");
        session.image(&camera);
        let verified = session.verify();
        assert!(verified.holds(), "{verified:?} after {line}");
    }
}
