//! Errors in a scene file: the place, what was expected, what was got and the way out.

use crate::error::Error;
use std::path::Path;

/// Something the file has `count` of, in words.
pub(crate) fn counted(what: &str, count: usize) -> String {
    let article = if what.starts_with(['a', 'i']) {
        "an"
    } else {
        "a"
    };
    match count {
        0 => format!("a file with {article} {what}"),
        _ => format!("{article} {what} from 0 to {}", count - 1),
    }
}

/// An error in a scene file.
pub(crate) fn broken(
    file: &Path,
    pointer: String,
    expected: impl Into<String>,
    got: String,
    way_out: &str,
) -> Error {
    Error::Scene {
        file: file.into(),
        pointer,
        expected: expected.into(),
        got,
        way_out: way_out.into(),
    }
}
