//! One walk through a file's JSON that holds it against the [`table`] of the format, and names the first wrong field.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 5 "Properties Reference", with the extensions that are read. We
//! depart from its letter where real files do and nothing is lost: a field that is `null` counts as absent, `3.0` counts
//! as the integer 3, lists may be empty, and fields that sweeplight never reads may hold anything.

mod table;

use crate::error::Result;
use crate::scene::fault::{broken, counted};
use serde_json::{Map, Value};
use std::collections::HashMap;
use std::path::Path;
use table::{ANY, Field, LISTS, List, MOST, ROOT, ValueKind};

/// Most objects a file may hold: nodes, accessors, primitives, keys' samplers and all others together. Each takes up to
/// 1 kB once it has its types, so half of it halves the 2 GB that a file of 6 MB full of `{}` could ask for.
const MOST_OBJECTS: usize = 1 << 21;

/// Checks every field that sweeplight reads, and makes whole numbers integers, nulls absent and scenes complete.
pub(super) fn check(file: &Path, json: &mut Value) -> Result<()> {
    // Find how long each list is, before anything refers to its items.
    let mut lengths = HashMap::new();
    for List { pointer, .. } in LISTS {
        let length = match json.pointer(pointer) {
            Some(Value::Array(items)) => items.len(),
            None | Some(Value::Null) => 0,
            Some(other) => {
                let (place, got) = (String::from(*pointer), shown(other));
                return Err(broken(file, place, "an array", got, AGAIN));
            }
        };
        lengths.insert(*pointer, length);
    }
    let mut walk = Walk {
        file,
        lengths,
        path: String::new(),
        objects: 0,
    };
    walk.object(json, ROOT)?;

    // An empty scene may leave out its list of nodes; the crate's types may not.
    let scenes = json.get_mut("scenes").and_then(Value::as_array_mut);
    let scenes = scenes.into_iter().flatten();
    for scene in scenes.filter_map(Value::as_object_mut) {
        scene
            .entry("nodes")
            .or_insert_with(|| Value::Array(Vec::new()));
    }
    Ok(())
}

/// A walk through the file's JSON.
struct Walk<'a> {
    file: &'a Path,
    /// Length of each of [`LISTS`].
    lengths: HashMap<&'static str, usize>,
    /// The pointer to where the walk is.
    path: String,
    /// Number of objects visited.
    objects: usize,
}

impl Walk<'_> {
    /// An object and the fields it is known to have. The table is finite, so the recursion is not deep.
    fn object(&mut self, value: &mut Value, fields: &[Field]) -> Result<()> {
        self.objects += 1;
        if self.objects > MOST_OBJECTS {
            let way_out = "split the scene into smaller files";
            let expected = format!("at most {MOST_OBJECTS} objects in the file");
            return Err(self.wrong(expected, "one more".into(), way_out));
        }
        let Value::Object(members) = value else {
            return Err(self.unlike("an object", value));
        };
        for field in fields {
            self.inside(field.name, |walk| walk.field(members, field))?;
        }
        Ok(())
    }

    fn field(&mut self, members: &mut Map<String, Value>, field: &Field) -> Result<()> {
        if members.get(field.name).is_some_and(Value::is_null) {
            members.remove(field.name);
        }
        match members.get_mut(field.name) {
            Some(value) => self.value(value, &field.kind),
            None if field.must => {
                let expected = self.asked(&field.kind);
                Err(self.wrong(expected, "nothing".into(), AGAIN))
            }
            None => Ok(()),
        }
    }

    fn value(&mut self, value: &mut Value, kind: &ValueKind) -> Result<()> {
        // Go into what holds other values.
        match kind {
            ValueKind::Object(fields) => return self.object(value, fields),
            ValueKind::Objects(fields) => {
                return self.each(value, |walk, item| walk.object(item, fields));
            }
            ValueKind::Texts => {
                return self.each(value, |walk, item| walk.value(item, &ValueKind::Text));
            }
            ValueKind::Series => return self.each(value, |walk, item| walk.value(item, &ANY)),
            ValueKind::Indices(list) => {
                return self.each(value, |walk, item| {
                    walk.value(item, &ValueKind::Index(list))
                });
            }
            ValueKind::NamedList(list) => {
                return self.each(value, |walk, item| {
                    walk.value(item, &ValueKind::Named(list))
                });
            }
            ValueKind::Named(list) => {
                let Value::Object(members) = value else {
                    return Err(self.unlike("an object", value));
                };
                return members.iter_mut().try_for_each(|(name, member)| {
                    self.inside(name, |walk| walk.value(member, &ValueKind::Index(list)))
                });
            }
            _ => {}
        }

        // Hold what stands alone against its kind.
        let within = |value: &Value, least: f64, most: f64| {
            value
                .as_f64()
                .is_some_and(|number| (least..=most).contains(&number))
        };
        let fits = match kind {
            ValueKind::Flag => value.is_boolean(),
            ValueKind::Text => value.is_string(),
            ValueKind::Word(words) => value.as_str().is_some_and(|word| words.contains(&word)),
            ValueKind::Code(codes) => whole(value).is_some_and(|code| codes.contains(&code)),
            ValueKind::Whole(least, most) => {
                whole(value).is_some_and(|number| (*least..=*most).contains(&number))
            }
            ValueKind::Number(least, most) => within(value, *least, *most),
            ValueKind::Numbers(count, least, most) => value.as_array().is_some_and(|numbers| {
                numbers.len() == *count && numbers.iter().all(|value| within(value, *least, *most))
            }),
            ValueKind::Index(list) => {
                let length = self.lengths.get(list.pointer).copied().unwrap_or(0);
                whole(value).is_some_and(|index| index < length as u64)
            }
            _ => true,
        };
        if !fits {
            let expected = self.asked(kind);
            return Err(self.unlike(&expected, value));
        }
        Ok(())
    }

    /// Every item of an array.
    fn each(
        &mut self,
        value: &mut Value,
        visit: impl Fn(&mut Self, &mut Value) -> Result<()>,
    ) -> Result<()> {
        let Value::Array(items) = value else {
            return Err(self.unlike("an array", value));
        };
        items
            .iter_mut()
            .enumerate()
            .try_for_each(|(index, item)| self.inside(index, |walk| visit(walk, item)))
    }

    /// One step further down the path, and back.
    fn inside(
        &mut self,
        step: impl std::fmt::Display,
        visit: impl FnOnce(&mut Self) -> Result<()>,
    ) -> Result<()> {
        use std::fmt::Write;
        let length = self.path.len();
        // Writing to a string cannot fail.
        let _ = write!(self.path, "/{step}");
        let visited = visit(self);
        self.path.truncate(length);
        visited
    }

    /// A kind in words.
    fn asked(&self, kind: &ValueKind) -> String {
        match kind {
            ValueKind::Flag => "true or false".into(),
            ValueKind::Text => "a text".into(),
            ValueKind::Word(words) => either(words),
            ValueKind::Code(codes) => either(codes),
            ValueKind::Whole(least, u64::MAX) => format!("a whole number of at least {least}"),
            ValueKind::Whole(least, most) => format!("a whole number from {least} to {most}"),
            ValueKind::Number(least, most) => format!("a {}", range("number", *least, *most)),
            ValueKind::Numbers(count, least, most) => {
                format!("{count} {}", range("numbers", *least, *most))
            }
            ValueKind::Index(list) => counted(
                list.what,
                self.lengths.get(list.pointer).copied().unwrap_or(0),
            ),
            ValueKind::Object(_) | ValueKind::Named(_) => "an object".into(),
            ValueKind::Texts
            | ValueKind::Series
            | ValueKind::Indices(_)
            | ValueKind::NamedList(_)
            | ValueKind::Objects(_) => "an array".into(),
        }
    }

    fn unlike(&self, expected: &str, value: &Value) -> crate::error::Error {
        self.wrong(expected.into(), shown(value), AGAIN)
    }

    fn wrong(&self, expected: String, got: String, way_out: &str) -> crate::error::Error {
        let pointer = if self.path.is_empty() {
            "/"
        } else {
            &self.path
        };
        broken(self.file, pointer.into(), expected, got, way_out)
    }
}

const AGAIN: &str = "correct the field, or export the file again";

/// A whole number; `3.0` is made `3`, as the crate's types need it.
fn whole(value: &mut Value) -> Option<u64> {
    /// Beyond 2⁵³ a 64-bit float skips integers.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    if let Some(number) = value.as_f64().filter(|_| value.is_f64())
        && number.fract() == 0.0
        && (0.0..=EXACT).contains(&number)
    {
        *value = Value::from(number as u64);
    }
    value.as_u64()
}

/// Words or numbers as "a, b or c".
fn either(items: &[impl ToString]) -> String {
    let items: Vec<String> = items.iter().map(ToString::to_string).collect();
    match items.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Numbers and the range they may have.
fn range(numbers: &str, least: f64, most: f64) -> String {
    match (least > -MOST, most < MOST) {
        (false, false) => format!("finite {numbers} within ±3.4e38"),
        (true, false) => format!("{numbers} of at least {least}"),
        _ => format!("{numbers} from {least} to {most}"),
    }
}

/// A value as it stands in the file, cut after 60 characters.
pub(super) fn shown(value: &Value) -> String {
    const LONGEST: usize = 60;
    // A long text or list is cut before it is written out.
    let text = match value {
        Value::String(text) => format!("{:?}", text.chars().take(LONGEST).collect::<String>()),
        Value::Array(items) if items.len() > LONGEST => {
            return format!("an array of {}", items.len());
        }
        Value::Object(members) if members.len() > LONGEST => {
            return format!("an object of {} members", members.len());
        }
        value => value.to_string(),
    };
    if text.chars().count() > LONGEST {
        return text.chars().take(LONGEST).chain(['…']).collect();
    }
    text
}
