//! Names of one line: control characters in a file's names are read as spaces, so that no name breaks the lines that tell of it,
//! colours the terminal, or is read backwards.

use serde_json::Value;

/// Makes every name in a file's JSON one line of plain text.
pub(super) fn make_plain(json: &mut Value) {
    match json {
        Value::Array(items) => items.iter_mut().for_each(make_plain),
        Value::Object(fields) => {
            for (key, value) in fields.iter_mut() {
                match value {
                    Value::String(name) if key == "name" && name.contains(is_unseen) => {
                        *name = name.replace(is_unseen, " ");
                    }
                    value => make_plain(value),
                }
            }
        }
        _ => {}
    }
}

/// Whether a character steers text instead of being seen: controls, ends of lines, and marks that turn the direction of reading
/// (Unicode Standard Annex 9, "Unicode bidirectional algorithm", table 4).
fn is_unseen(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_are_one_line_and_all_else_stays() {
        let mut json = json!({
            "nodes": [{"name": "a\nb\u{1b}[31m"}, {"name": "Stuhl über Eck"}],
            "extensions": {"lights": [{"name": "\u{202e}gnp.exe", "color": [1, 2, 3]}]},
            "extras": {"text": "a\nb"},
        });
        make_plain(&mut json);
        let expected = json!({
            "nodes": [{"name": "a b [31m"}, {"name": "Stuhl über Eck"}],
            "extensions": {"lights": [{"name": " gnp.exe", "color": [1, 2, 3]}]},
            "extras": {"text": "a\nb"},
        });
        assert_eq!(json, expected);
    }
}
