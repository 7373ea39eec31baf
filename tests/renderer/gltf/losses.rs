//! What has no effect is told by `info`, by the first lines of `render` and by its report, in the same words.

use crate::support::program::{done, moving, quick, stderr, stdout, sweeplight};
use crate::support::run::case;
use serde_json::{Value, json};

#[test]
fn the_same_losses_are_told_everywhere() {
    let mut scene = moving();
    scene.edit(0)["name"] = json!("wall");
    scene.edit(0)["extensions"]["KHR_materials_sheen"] = json!({"sheenColorFactor": [1, 1, 1]});
    scene.set(0, "extensions", json!({"EXT_unheard_of": {}}));
    scene.used = vec!["KHR_materials_sheen", "EXT_unheard_of"];
    let case = case(&scene);
    let info = sweeplight(case.folder.path(), &["info", "scene.gltf", "--json"]);
    done(&info);
    let info: Value = serde_json::from_str(&stdout(&info)).expect("JSON");
    let told = info["warnings"].as_array().expect("a list");
    let [sheen, unknown] = &told[..] else {
        panic!("{told:?}");
    };
    let begins =
        |told: &Value, text: &str| told.as_str().is_some_and(|told| told.starts_with(text));
    assert!(
        begins(sheen, "material 'wall': KHR_materials_sheen is left out"),
        "{sheen}"
    );
    assert!(begins(unknown, "node '"), "{unknown}");

    let text = stdout(&sweeplight(case.folder.path(), &["info", "scene.gltf"]));
    let rendered = quick(
        &case,
        "render",
        &["--frames", "0", "--report", "r.json", "-o", "x_####.png"],
    );
    done(&rendered);
    let lines = stderr(&rendered);
    for told in told {
        let told = told.as_str().expect("a sentence");
        assert_eq!(text.matches(told).count(), 1, "{text}");
        assert_eq!(
            lines.matches(&format!("warning: {told}")).count(),
            1,
            "{lines}"
        );
    }
    let report = std::fs::read(case.folder.path().join("r.json")).expect("a report");
    let report: Value = serde_json::from_slice(&report).expect("JSON");
    assert_eq!(report["scene"]["warnings"], info["warnings"]);
}
