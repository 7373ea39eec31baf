//! Frame lists as typed: `0-47x2,60` means 0, 2, 4 … 46, then 60.
//!
//! The notation is the one of farm managers and of Nuke: parts between commas, each a number, a range `a-b` with both
//! ends, or a range with a step, `a-bxk`. `a..b` is the same as `a-b` (both ends as well, as in Blender and not as in
//! Rust). The order is kept, and a frame named again is dropped.

use std::collections::HashSet;

use crate::error::{Error, Result};

/// The most frames one list may name, repetitions included: eleven hours at 24 frames a second, 4 MB of numbers.
pub const MOST_FRAMES: u64 = 1_000_000;

/// The frames that `text` names, in its order and each once.
///
/// ```
/// assert_eq!(sweeplight::io::range::parse("60,0-9x3")?, [60, 0, 3, 6, 9]);
/// # Ok::<(), sweeplight::error::Error>(())
/// ```
pub fn parse(text: &str) -> Result<Vec<u32>> {
    let mut frames = Vec::new();
    let mut seen = HashSet::new();
    let mut named = 0;
    for part in text.split(',').map(str::trim) {
        let (first, last, step) = bounds(part)?;
        named += u64::from((last - first) / step) + 1;
        if named > MOST_FRAMES {
            return Err(usage(
                &format!("at most {MOST_FRAMES} frames"),
                &format!("more by '{part}'"),
                "render the list in several runs",
            ));
        }
        frames.extend(
            (first..=last)
                .step_by(step as usize)
                .filter(|&frame| seen.insert(frame)),
        );
    }
    Ok(frames)
}

/// Frames as a list that [`parse`] reads: those that follow each other are a range.
pub fn text(frames: &[u32]) -> String {
    let runs = frames.chunk_by(|a, b| a.checked_add(1) == Some(*b));
    let part = |run: &[u32]| match run {
        [first, .., last] => format!("{first}-{last}"),
        run => run.iter().map(u32::to_string).collect(),
    };
    let parts: Vec<String> = runs.map(part).collect();
    parts.join(",")
}

/// First and last frame and step of one part.
fn bounds(part: &str) -> Result<(u32, u32, u32)> {
    let (range, step) = match part.split_once(['x', 'X']) {
        Some((range, step)) => (range, Some(number(step, part)?)),
        None => (part, None),
    };
    let ends = range.split_once("..").or_else(|| range.split_once('-'));
    let (first, last) = match ends {
        Some((first, last)) => (number(first, part)?, number(last, part)?),
        None => {
            let only = number(range, part)?;
            (only, only)
        }
    };
    if first > last {
        return Err(usage(
            "ranges from the lower to the higher frame",
            &format!("'{part}'"),
            &format!("write {last}-{first}, or single frames for another order"),
        ));
    }
    match (step, ends) {
        (Some(0), _) => Err(usage(
            "a step of at least 1",
            &format!("'{part}'"),
            "leave x0 out",
        )),
        (Some(_), None) => Err(usage(
            "a step behind a range, as in 0-47x2",
            &format!("'{part}'"),
            &format!("write {first} alone, or give the range an end"),
        )),
        (step, _) => Ok((first, last, step.unwrap_or(1))),
    }
}

/// A frame number or step; `part` is what the error shows.
fn number(text: &str, part: &str) -> Result<u32> {
    let text = text.trim();
    let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let value = if digits { text.parse().ok() } else { None };
    value.ok_or_else(|| {
        let got = if part.is_empty() {
            "an empty part".to_string()
        } else {
            format!("'{part}'")
        };
        let expected = format!("frames from 0 to {}, as in 0-47x2,60", u32::MAX);
        usage(
            &expected,
            &got,
            "write numbers and ranges a-b or a-bxSTEP between commas",
        )
    })
}

/// The error for `--frames`.
fn usage(expected: &str, got: &str, way_out: &str) -> Error {
    Error::Usage {
        flag: "--frames".into(),
        expected: expected.into(),
        got: got.into(),
        way_out: way_out.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(text: &str) -> Vec<u32> {
        parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    fn refusal(text: &str) -> String {
        parse(text).expect_err(text).to_string()
    }

    #[test]
    fn ranges_steps_and_single_frames() {
        assert_eq!(frames("7"), [7]);
        assert_eq!(frames("0-3"), [0, 1, 2, 3]);
        assert_eq!(frames("0..3"), [0, 1, 2, 3]);
        assert_eq!(frames("0-7x3,60"), [0, 3, 6, 60]);
        assert_eq!(frames("5..5x9"), [5]);
        assert_eq!(frames(" 1 - 3 , 9 "), [1, 2, 3, 9]);
        assert_eq!(frames("4294967295"), [u32::MAX]);
        assert_eq!(frames("4294967290-4294967295x5"), [u32::MAX - 5, u32::MAX]);
        assert_eq!(frames("0-47x2,60").len(), 25);
    }

    #[test]
    fn order_is_kept_and_repetitions_are_dropped() {
        assert_eq!(frames("9,3-5,4,9,0-4"), [9, 3, 4, 5, 0, 1, 2]);
    }

    #[test]
    fn a_list_is_written_as_it_is_read() {
        for list in ["7", "0-3", "9,3-5,4294967294-4294967295,0", "60,0-46"] {
            assert_eq!(text(&frames(list)), list);
        }
    }

    #[test]
    fn errors_name_the_bad_part() {
        for (text, part) in [
            ("1,a,3", "'a'"),
            ("1-2-3", "'1-2-3'"),
            ("-4", "'-4'"),
            ("4-", "'4-'"),
            ("+4", "'+4'"),
            ("0-4x", "'0-4x'"),
            ("0-4x0", "'0-4x0'"),
            ("4x2", "'4x2'"),
            ("8-2", "'8-2'"),
            ("4294967296", "'4294967296'"),
            ("1,,2", "an empty part"),
            ("", "an empty part"),
        ] {
            let told = refusal(text);
            assert!(told.starts_with("--frames: expected "), "{told}");
            assert!(told.contains(part), "{told}");
        }
        assert!(refusal("8-2").ends_with("write 2-8, or single frames for another order"));
    }

    #[test]
    fn a_list_is_bounded() {
        assert_eq!(frames("0-999999").len(), 1_000_000);
        assert!(refusal("0-999999,1").contains("at most 1000000 frames"));
        assert!(refusal("0-4294967295").contains("'0-4294967295'"));
    }
}
