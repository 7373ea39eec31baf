//! Text for people: what others wrote, in a file or a file's name, may not steer their terminal. What programs read (JSON, job
//! files, completions) goes out as it is.

use crate::error::Error;
use std::borrow::Cow;

/// Tells an error on standard error.
pub fn tell_error(error: &Error) {
    eprintln!("{}", plain(&format!("error: {error}")));
}

/// The text with control characters as they are typed in Rust, `\u{1b}`; ends of lines and tabs stay.
pub fn plain(text: &str) -> Cow<'_, str> {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\t';
    if !text.contains(steers) {
        return text.into();
    }
    let shown = |c: char| match steers(c) {
        true => c.escape_unicode().to_string(),
        false => c.to_string(),
    };
    text.chars().map(shown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_shown() {
        assert_eq!(plain("two\n\tlines, ü"), "two\n\tlines, ü");
        assert_eq!(plain("\u{1b}[2Jx\r"), "\\u{1b}[2Jx\\u{d}");
    }
}
