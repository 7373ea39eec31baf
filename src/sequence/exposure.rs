//! How bright each frame is shown: the same for all, or read from a file with a line a frame or a line a key.
//!
//! Fixed exposure is the default, for one that follows each frame's own light would flicker. A file is for what a camera
//! crew does with the iris: Radiance's `ranimate` takes one value per frame from a file too (its EXPOSURE). In ours a line
//! is either stops alone, the first for frame 0, the next for frame 1 and so on, or a frame number and its stops. Between
//! keys stops are interpolated linearly, so that light grows by equal factors in equal times; before the first key and
//! after the last they stay. What follows a `#` is a comment, and empty lines count for nothing.

use std::path::Path;

use crate::error::{Error, Result};
use crate::image::tone::Tone;
use crate::settings::{Exposure, Settings};

/// Stops that are taken: far beyond any use and far from what overflows.
pub const STOPS: std::ops::RangeInclusive<f32> = -32.0..=32.0;

/// Stops by frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposures {
    /// Frames with their stops, rising; never empty.
    keys: Vec<(u32, f32)>,
}

impl Exposures {
    /// Those of the settings; a file is read.
    ///
    /// # Errors
    /// [`Error::Read`] when there is no such file, [`Error::Usage`] with the number of a line that cannot be taken.
    pub fn of(exposure: &Exposure) -> Result<Exposures> {
        match exposure {
            Exposure::Stops(stops) => Ok(Exposures::fixed(*stops)),
            // A pass over the clip finds the stops later.
            Exposure::ByLight | Exposure::Auto => Ok(Exposures::fixed(0.0)),
            Exposure::File(path) => {
                let text = std::fs::read_to_string(path).map_err(|source| Error::Read {
                    path: path.clone(),
                    source,
                    way_out: "give stops, e.g. --exposure 1, or a text file with a line FRAME STOPS for each key".into(),
                })?;
                read(path, &text)
            }
        }
    }

    /// The same for all frames.
    fn fixed(stops: f32) -> Exposures {
        Exposures {
            keys: vec![(0, stops)],
        }
    }

    /// Exposure and tone curve of a frame.
    pub fn tone(&self, settings: &Settings, frame: u32) -> Tone {
        Tone {
            stops: self.at(frame),
            curve: settings.film.tone,
        }
    }

    /// The stops of a frame.
    pub fn at(&self, frame: u32) -> f32 {
        let after = self.keys.partition_point(|(key, _)| *key <= frame);
        match (
            after.checked_sub(1).map(|at| self.keys[at]),
            self.keys.get(after),
        ) {
            (Some((from, a)), Some((to, b))) => {
                let part = f64::from(frame - from) / f64::from(to - from);
                (f64::from(a) + part * f64::from(b - a)) as f32
            }
            (Some((_, stops)), None) | (None, Some(&(_, stops))) => stops,
            (None, None) => 0.0,
        }
    }
}

/// The keys of a file's lines.
fn read(path: &Path, text: &str) -> Result<Exposures> {
    let mut keys: Vec<(u32, f32)> = Vec::new();
    // Whether lines have frame numbers; the first decides.
    let mut keyed = None;
    for (number, line) in (1..).zip(text.lines()) {
        let bad = |expected: &str| bad_line(path, number, line, expected);
        let line = line.split('#').next().unwrap_or_default();
        let parts: Vec<&str> = line
            .split(|c: char| c.is_whitespace() || c == ',')
            .filter(|part| !part.is_empty())
            .collect();
        let (frame, stops) = match parts[..] {
            [] => continue,
            [stops] => (None, stops),
            [frame, stops] => (Some(frame), stops),
            _ => return Err(bad("STOPS, or FRAME STOPS")),
        };
        if *keyed.get_or_insert(frame.is_some()) != frame.is_some() {
            return Err(bad("STOPS in every line, or FRAME STOPS in every line"));
        }
        let stops = stops.parse().ok().filter(|stops| STOPS.contains(stops));
        let stops = stops.ok_or_else(|| bad("stops from -32 to 32"))?;
        let frame = match frame {
            Some(frame) => frame.parse().map_err(|_| bad("a frame number from 0"))?,
            None => keys.len() as u32,
        };
        if keys.last().is_some_and(|(last, _)| *last >= frame) {
            return Err(bad("frames that rise from line to line"));
        }
        keys.push((frame, stops));
    }
    if keys.is_empty() {
        return Err(bad_line(path, 1, "", "at least one line with stops"));
    }
    Ok(Exposures { keys })
}

/// The error of a line.
fn bad_line(path: &Path, number: usize, line: &str, expected: &str) -> Error {
    Error::Usage {
        flag: "--exposure".into(),
        expected: expected.into(),
        got: format!("'{}' in {}, line {number}", line.trim(), path.display()),
        way_out: "write e.g. '24 -1.5' for one stop and a half less at frame 24".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exposures(text: &str) -> Exposures {
        read(Path::new("e.txt"), text).expect(text)
    }

    #[test]
    fn keys_are_joined_by_straight_lines_of_stops() {
        let keys = exposures("# frame, stops\n10 1.0\n\n14, -1 # darker\n");
        let at = [0, 10, 11, 12, 13, 14, 99].map(|frame| keys.at(frame));
        assert_eq!(at, [1.0, 1.0, 0.5, 0.0, -0.5, -1.0, -1.0]);
    }

    #[test]
    fn lines_of_stops_alone_count_from_frame_0() {
        let each = exposures("0\n0.5\n-2\n");
        assert_eq!(
            [0, 1, 2, 3].map(|frame| each.at(frame)),
            [0.0, 0.5, -2.0, -2.0]
        );
    }

    #[test]
    fn one_value_holds_for_all() {
        let fixed = Exposures::of(&Exposure::Stops(-1.5)).expect("stops");
        assert_eq!((fixed.at(0), fixed.at(u32::MAX)), (-1.5, -1.5));
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, line, word) in [
            ("0 1\n1 x", 2, "stops from -32 to 32"),
            ("0 1\n\n# c\n1 33", 4, "stops from -32 to 32"),
            ("0 nan", 1, "stops from -32 to 32"),
            ("0 1\n-1 1", 2, "a frame number from 0"),
            ("5 1\n5 2", 2, "frames that rise"),
            ("0 1 2", 1, "STOPS, or FRAME STOPS"),
            ("0 1\n2", 2, "in every line"),
            ("# nothing\n", 1, "at least one line"),
        ] {
            let told = read(Path::new("e.txt"), text).expect_err(text).to_string();
            assert!(
                told.contains(word) && told.contains(&format!("in e.txt, line {line} ")),
                "{told}"
            );
        }
    }
}
