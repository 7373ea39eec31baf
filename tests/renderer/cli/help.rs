//! `sweeplight help`: commands and topics, through the binary.

use crate::support::program::{done, refused, stdout, sweeplight};
use serde_json::Value;
use std::path::Path;
use sweeplight::cli::help::TOPICS;

fn help(args: &[&str]) -> String {
    let output = sweeplight(Path::new("."), args);
    done(&output);
    stdout(&output)
}

#[test]
fn each_topic_prints_its_text() {
    let list = help(&["help"]);
    for (name, about, text) in TOPICS {
        assert!(
            list.contains(name) && list.contains(about),
            "{name}: {list}"
        );
        assert_eq!(help(&["help", name]).trim_end(), text.trim_end(), "{name}");
    }
}

#[test]
fn each_command_prints_its_help_either_way() {
    let list = help(&["help"]);
    for name in [
        "render", "verify", "info", "edit", "view", "export", "validate", "blender",
    ] {
        assert!(list.contains(name), "{name}: {list}");
        let typed = help(&[name, "--help"]);
        assert_eq!(help(&["help", name]).trim_end(), typed.trim_end(), "{name}");
    }
    // Values of an option are listed, each with its meaning.
    let render = help(&["help", "render"]);
    for line in [
        "- hybrid:      Final gather near contacts",
        "- hemicube: Pixels of a hemicube",
        "- recomputed: X: 1 where the pixel was traced again",
    ] {
        assert!(render.contains(line), "{line}: {render}");
    }
}

#[test]
fn an_unknown_topic_is_refused_with_the_list() {
    let output = sweeplight(Path::new("."), &["help", "lights"]);
    refused(
        &output,
        2,
        &[
            "'lights'",
            "render",
            "light",
            "exit-codes",
            "report-schema",
            " — ",
        ],
    );
}

#[test]
fn the_schema_has_a_text_for_each_figure() {
    let schema: Value = serde_json::from_str(&help(&["help", "report-schema"])).expect("JSON");
    let frame = &schema["properties"]["frames"]["items"]["properties"];
    let text = |of: &Value| of["description"].as_str().map(String::from);
    assert_eq!(
        text(&frame["traced"]),
        Some("Samples whose ray was tested again, against boxes or triangles.".into())
    );
    let groups = [frame, &schema["properties"]["total"]["properties"]];
    for (name, figure) in groups
        .iter()
        .flat_map(|group| group.as_object().expect("fields"))
    {
        assert!(
            text(figure).is_some_and(|text| text.ends_with('.')),
            "{name}: {figure}"
        );
    }
}

/// The table of methods names files of tests that are there, and flags that some command has.
#[test]
fn methods_name_what_is_there() {
    let text = help(&["help", "methods"]);
    let quoted: Vec<&str> = text.split('`').skip(1).step_by(2).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files: Vec<&&str> = quoted.iter().filter(|name| name.ends_with(".rs")).collect();
    assert!(files.len() > 20, "{files:?}");
    for file in files {
        assert!(root.join(file).is_file(), "{file}");
    }
    let commands = ["render", "factors", "validate", "edit"].map(|name| help(&["help", name]));
    for flag in quoted.iter().flat_map(|quote| quote.split(' ')) {
        let known = commands.iter().any(|known| known.contains(flag));
        assert!(!flag.starts_with("--") || known, "{flag}");
    }
}
