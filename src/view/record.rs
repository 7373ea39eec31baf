//! The edits so far, as lines that `sweeplight edit` replays.
//!
//! A gesture takes many steps, one for each place that a hand passes, and leaves one line: the last place. Hits are a
//! function of the state alone, never of the way there, so the lines lead to the very same state.

use serde_json::Value;

/// The lines, and what each took.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    lines: Vec<Line>,
}

#[derive(Clone, Debug)]
struct Line {
    text: String,
    edits: Value,
    /// Steps of the session that it stands for.
    steps: u32,
    /// The gesture, with the tab whose it is.
    gesture: Option<(u64, u64)>,
}

impl Record {
    /// Notes a step that was made. It takes the place of the line before, if that is of the same gesture and says the same things.
    pub(super) fn note(&mut self, text: &str, edits: Value, gesture: Option<(u64, u64)>) {
        if let Some(last) = self.lines.last_mut()
            && gesture.is_some()
            && last.gesture == gesture
            && say_the_same_things(&last.edits, &edits)
        {
            last.steps += 1;
            last.text = text.into();
            last.edits = edits;
            return;
        }
        self.lines.push(Line {
            text: text.into(),
            edits,
            steps: 1,
            gesture,
        });
    }

    /// The steps that undo the last line; `None` where there is none.
    pub(super) fn last_steps(&self) -> Option<u32> {
        self.lines.last().map(|line| line.steps)
    }

    /// Takes the last line off.
    pub(super) fn forget_last(&mut self) {
        self.lines.pop();
    }

    /// Number of lines.
    pub(super) fn len(&self) -> usize {
        self.lines.len()
    }

    /// All lines, each with its end.
    pub(super) fn text(&self) -> String {
        self.lines
            .iter()
            .map(|line| format!("{}\n", line.text))
            .collect()
    }
}

/// Whether the later of two lists of edits replaces all that the earlier set: the same kinds of edits of the same things, each by
/// absolute values.
pub(super) fn say_the_same_things(one: &Value, other: &Value) -> bool {
    let (Some(one), Some(other)) = (one.as_array(), other.as_array()) else {
        return false;
    };
    one.len() == other.len() && one.iter().zip(other).all(|(a, b)| says_the_same(a, b))
}

/// Fields that tell what an edit is about.
const ABOUT: [&str; 4] = ["node", "material", "light", "camera"];

/// Edits whose later value replaces the earlier.
const REPLACE: [&str; 6] = ["move", "rotate", "scale", "emission", "color", "light"];

fn says_the_same(one: &Value, other: &Value) -> bool {
    let kind = |edit: &Value| -> Option<(String, Value)> {
        let (name, fields) = edit.as_object()?.iter().next()?;
        Some((name.clone(), fields.clone()))
    };
    let (Some((name, one)), Some((other_name, other))) = (kind(one), kind(other)) else {
        return false;
    };
    let (Some(one), Some(other)) = (one.as_object(), other.as_object()) else {
        return false;
    };
    let same_about = ABOUT
        .iter()
        .all(|field| one.get(*field) == other.get(*field));
    name == other_name
        && REPLACE.contains(&name.as_str())
        && !one.contains_key("by")
        && one.keys().eq(other.keys())
        && same_about
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_gesture_is_a_line_and_its_undo_takes_all_its_steps() {
        let mut record = Record::default();
        for x in [1.0, 2.0, 3.0] {
            let edits = json!([{"move": {"node": 1, "to": [x, 0, 0]}}]);
            record.note(&format!("place {x}"), edits, Some((1, 9)));
        }
        record.note("hide", json!([{"hide": {"node": 1}}]), Some((1, 9)));
        assert_eq!(record.text(), "place 3\nhide\n");
        assert_eq!(record.last_steps(), Some(1));
        record.forget_last();
        assert_eq!(record.last_steps(), Some(3));
    }

    #[test]
    fn what_adds_up_or_is_about_something_else_stays_a_line() {
        let said = |a: Value, b: Value| say_the_same_things(&json!([a]), &json!([b]));
        let to = |node: u32| json!({"move": {"node": node, "to": [0, 0, 0]}});
        assert!(said(to(1), to(1)));
        assert!(!said(to(1), to(2)));
        let by = json!({"move": {"node": 1, "by": [0, 0, 0]}});
        assert!(!said(by.clone(), by.clone()));
        let dim = json!({"emission": {"material": 0, "strength": 1}});
        let red = json!({"emission": {"material": 0, "color": [1, 0, 0]}});
        assert!(said(dim.clone(), dim.clone()));
        assert!(!said(dim, red));
        let hide = json!({"hide": {"node": 1}});
        assert!(!said(hide.clone(), hide.clone()));
    }
}
