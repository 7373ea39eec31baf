//! Every figure of the report with its meaning: the page's tables follow the JSON, so that none is left out.
//!
//! A figure is named by its way through the JSON. Figures stand in the order of the list of meanings; one that it does
//! not know stands at the end of its table, without a meaning.

use serde_json::Value;

use crate::report::schema::{self, Figure, meaning};
use crate::report::table::grouped;

/// The tables by the JSON's members; what lies in none of them belongs to the run.
const GROUPS: [(&str, &str); 6] = [
    ("verified", "Verification"),
    ("total", "Total"),
    ("settings", "Settings"),
    ("scene", "Scene"),
    ("profile", "Profile"),
    ("", "Run"),
];

/// A value as it is shown, and as the JSON has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What people read.
    pub shown: String,
    /// What the JSON has, where that is a number.
    pub exact: Option<String>,
}

/// A figure with its name, its value and its meaning.
#[derive(Clone, Debug)]
pub struct WordRow {
    /// Its name in the JSON, without that of its table.
    pub name: String,
    /// One value, or several such as width and height.
    pub cells: Vec<Cell>,
    /// What stands between several values.
    pub joint: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

/// A table of figures.
#[derive(Clone, Debug)]
pub struct Group {
    /// Its title.
    pub title: &'static str,
    /// Its figures.
    pub rows: Vec<WordRow>,
}

/// The table of the frames.
#[derive(Clone, Debug)]
pub struct Frames {
    /// Names of the columns, and what they mean.
    pub columns: Vec<(String, &'static str)>,
    /// A row a frame.
    pub rows: Vec<Vec<Cell>>,
}

/// The tables of everything but the frames.
pub fn groups(json: &Value) -> Vec<Group> {
    let mut figures = Vec::new();
    if let Value::Object(members) = json {
        for (name, value) in members.iter().filter(|(name, _)| *name != "frames") {
            flatten(name, value, &mut figures);
        }
    }
    sort(&mut figures, schema::figures());
    let belongs = |name: &str, group: &str| match name.split_once('.') {
        Some((member, _)) => member == group,
        None => group.is_empty(),
    };
    let group = |(member, title): (&str, &'static str)| {
        let figures = figures.iter().filter(|(name, _)| belongs(name, member));
        let row = |(name, value): &(String, Value)| WordRow {
            name: name
                .strip_prefix(member)
                .unwrap_or(name)
                .trim_start_matches('.')
                .into(),
            cells: cells(name, value),
            joint: if name == "settings.size" {
                " × "
            } else {
                ", "
            },
            meaning: meaning(schema::figures(), name).unwrap_or(""),
        };
        let rows: Vec<WordRow> = figures.map(row).collect();
        (!rows.is_empty()).then_some(Group { title, rows })
    };
    GROUPS.into_iter().filter_map(group).collect()
}

/// The table of the frames.
pub fn frames(json: &Value) -> Frames {
    let flat = |frame: &Value| {
        let mut figures = Vec::new();
        flatten("", frame, &mut figures);
        sort(&mut figures, schema::frame());
        figures
    };
    let all = json["frames"].as_array().map_or(&[][..], |frames| frames);
    let first = all.first().map(flat).unwrap_or_default();
    let column =
        |(name, _): &(String, Value)| (name.clone(), meaning(schema::frame(), name).unwrap_or(""));
    let row = |frame: &Value| {
        let figures = flat(frame);
        figures
            .iter()
            .flat_map(|(name, value)| cells(name, value))
            .collect()
    };
    Frames {
        columns: first.iter().map(column).collect(),
        rows: all.iter().map(row).collect(),
    }
}

/// Walks down to what is no object, naming the way.
pub(crate) fn flatten(name: &str, value: &Value, figures: &mut Vec<(String, Value)>) {
    let Value::Object(members) = value else {
        figures.push((name.into(), value.clone()));
        return;
    };
    for (member, value) in members {
        let way = if name.is_empty() {
            member.clone()
        } else {
            format!("{name}.{member}")
        };
        flatten(&way, value, figures);
    }
}

/// Puts figures into the order of a list, those that it does not know last.
fn sort(figures: &mut [(String, Value)], list: &[Figure]) {
    figures.sort_by_key(|(name, _)| {
        let place = list.iter().position(|(known, _)| known == name);
        (place.unwrap_or(list.len()), name.clone())
    });
}

/// A value's cells: several for a list.
pub(crate) fn cells(name: &str, value: &Value) -> Vec<Cell> {
    match value {
        Value::Array(values) => values.iter().flat_map(|value| cells(name, value)).collect(),
        Value::Number(number) => {
            let exact = number.to_string();
            // A frame's number and a time are no quantities to be grouped or rounded.
            let shown = match (number.as_u64(), number.as_f64()) {
                (Some(count), _) if name == "frame" || name.ends_with("_frame") => {
                    count.to_string()
                }
                (Some(count), _) => grouped(count),
                (None, Some(value)) => rounded(value),
                _ => exact.clone(),
            };
            vec![Cell {
                shown,
                exact: Some(exact),
            }]
        }
        other => {
            let shown = match other {
                Value::String(text) => text.clone(),
                Value::Bool(true) => "yes".into(),
                Value::Bool(false) => "no".into(),
                _ => "none".into(),
            };
            vec![Cell { shown, exact: None }]
        }
    }
}

/// A number with four digits.
fn rounded(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e9).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::json;
    use crate::report::page::tests::report;
    use crate::report::verified::Verified;
    use crate::settings::Sun;

    fn value(value: &impl serde::Serialize) -> Value {
        serde_json::from_str(&json(value).expect("JSON")).expect("JSON")
    }

    #[test]
    fn every_figure_has_a_meaning() {
        let mut json = value(&report(2.0, 1.0));
        json["verified"] = value(&Verified::default());
        json["settings"]["light"]["sun"] = value(&Sun {
            azimuth: 0.0,
            elevation: 45.0,
            irradiance: 3.0,
            color: [1.0, 0.9, 0.8],
            diameter: 0.53,
        });
        for group in groups(&json) {
            for row in group.rows {
                assert!(
                    !row.meaning.is_empty(),
                    "{}.{} of the report has no meaning",
                    group.title,
                    row.name
                );
            }
        }
        for (name, meaning) in frames(&json).columns {
            assert!(!meaning.is_empty(), "{name} of a frame has no meaning");
        }
    }

    #[test]
    fn unknown_figures_stand_last() {
        let json = serde_json::json!({"scene": {"aaa": 7, "movers": 1, "triangles": 1234567}});
        let groups = groups(&json);
        let names: Vec<&str> = groups[0].rows.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(
            (groups[0].title, names),
            ("Scene", vec!["triangles", "movers", "aaa"])
        );
        let cell = &groups[0].rows[0].cells[0];
        assert_eq!(
            (cell.shown.as_str(), cell.exact.as_deref()),
            ("1,234,567", Some("1234567"))
        );
    }

    #[test]
    fn numbers_are_rounded_and_kept() {
        let shown = [0.1, 2.0, 0.026_41, 12_345.678, 4e-5, -0.5].map(rounded);
        assert_eq!(shown, ["0.1", "2", "0.02641", "12346", "4.00e-5", "-0.5"]);
        let frame = cells("frame", &serde_json::json!(1234));
        assert_eq!(frame[0].shown, "1234");
    }
}
