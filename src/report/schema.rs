//! The JSON schema of the report, and every figure of it with its text: the doc comment of its field.
//!
//! schemars derives the schema (JSON Schema, draft 2020-12). A figure is named by its way through the JSON; figures stand in
//! the order of the fields.

use std::sync::LazyLock;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::Value;

use super::Report;
use super::verified::Verified;

/// A figure's way through the JSON, and its text.
pub type Figure = (String, String);

/// The text of seconds that only a verification measures.
const FROM_SCRATCH: &str = "Seconds of the frame's light from scratch.";

/// The JSON schema of a report.
pub fn schema() -> Value {
    of::<Report>()
}

/// Every figure but those of single frames; those of a verification stand first.
pub fn figures() -> &'static [Figure] {
    static FIGURES: LazyLock<Vec<Figure>> = LazyLock::new(|| {
        let mut figures = Vec::new();
        walk("verified", &of::<Verified>(), "", &mut figures);
        walk("", &schema(), "", &mut figures);
        figures
    });
    &FIGURES
}

/// The figures of a frame.
pub fn frame() -> &'static [Figure] {
    static FRAME: LazyLock<Vec<Figure>> = LazyLock::new(|| {
        let mut figures = Vec::new();
        walk(
            "",
            &schema()["properties"]["frames"]["items"],
            "",
            &mut figures,
        );
        figures.push(("seconds.from_scratch".into(), FROM_SCRATCH.into()));
        figures
    });
    &FRAME
}

/// The text of a figure, if there is one of that name.
pub fn meaning(figures: &'static [Figure], name: &str) -> Option<&'static str> {
    let known = figures.iter().find(|(known, _)| known == name);
    known.map(|(_, text)| text.as_str())
}

fn of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let settings = settings.with(|settings| settings.inline_subschemas = true);
    settings.into_generator().into_root_schema_for::<T>().into()
}

/// Adds the figures below a schema, in the order of its fields; `text` is for those without one of their own.
fn walk(prefix: &str, schema: &Value, text: &str, figures: &mut Vec<Figure>) {
    let text = schema["description"].as_str().unwrap_or(text);
    for key in ["anyOf", "oneOf", "allOf"] {
        for option in schema[key].as_array().into_iter().flatten() {
            walk(prefix, option, text, figures);
        }
    }
    let Some(fields) = schema["properties"].as_object() else {
        return;
    };
    // Fields that are always there stand in `required`, in their order; `properties` has lost it.
    let required = schema["required"].as_array().into_iter().flatten();
    let mut names: Vec<&str> = required.filter_map(Value::as_str).collect();
    let others: Vec<&str> = fields.keys().map(String::as_str).collect();
    names.extend(others.into_iter().filter(|name| {
        !schema["required"]
            .to_string()
            .contains(&format!("\"{name}\""))
    }));
    for name in names {
        let way = match prefix {
            "" => name.to_string(),
            _ => format!("{prefix}.{name}"),
        };
        let text = fields[name]["description"].as_str().unwrap_or(text);
        figures.push((way.clone(), text.replace('\n', " ")));
        walk(&way, &fields[name], text, figures);
    }
}
