//! Output patterns as typed: where frame n is written, and as what.
//!
//! `####` (as in Blender) and `%04d` (as in ffmpeg) in the file's name stand for the frame number, padded with zeros to
//! as many digits as the pattern says; longer numbers are never cut. A name without a marker is one file where that can be
//! ([`output`](super::output) says where), and else gets `_` and four digits before its extension; a name without an extension
//! becomes a PNG. Markers in the names of folders are just names.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::{destination, manifest};

/// Digits of a frame number where the pattern does not say: enough for seven minutes at 24 frames a second.
pub const DIGITS: usize = 4;

/// Digits of a number of shots, so that previews stand in order by name: a frame of the default scene takes 64,934.
const SHOT_DIGITS: usize = 7;

/// The widest number a pattern may ask for; frame numbers have ten digits at most.
const MOST_DIGITS: usize = 20;

/// The containers of moving pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Container {
    /// H.264 in MP4, by the user's ffmpeg.
    Mp4,
    /// GIF: 256 colours, and hundredths of a second.
    Gif,
    /// Animated PNG: all colours, and any rate.
    Apng,
}

/// The file formats, by extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FileKind {
    /// Tone-mapped sRGB.
    Png,
    /// Linear radiance.
    Exr,
}

impl FileKind {
    /// The format for an extension, in small or capital letters.
    pub fn of(extension: &str) -> Option<FileKind> {
        match extension.to_ascii_lowercase().as_str() {
            "png" => Some(FileKind::Png),
            "exr" => Some(FileKind::Exr),
            _ => None,
        }
    }
}

/// Where the frames go: `folder`/`before`·number·`after`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Pattern {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
    kind: FileKind,
    /// The file as typed, where the name has an extension and no marker.
    one: Option<PathBuf>,
    /// What joins all frames, where the extension says so.
    container: Option<Container>,
}

impl Pattern {
    /// Read a pattern as typed behind `-o`.
    ///
    /// ```
    /// use sweeplight::io::pattern::Pattern;
    /// assert_eq!(Pattern::parse("out/door_####.exr")?.path(7), std::path::Path::new("out/door_0007.exr"));
    /// assert_eq!(Pattern::parse("out/door.png")?.path(7), std::path::Path::new("out/door_0007.png"));
    /// # Ok::<(), sweeplight::error::Error>(())
    /// ```
    pub fn parse(text: &str) -> Result<Pattern> {
        // Part the folder from the file's name.
        let path = Path::new(text);
        let name = match path.file_name().and_then(|name| name.to_str()) {
            Some(name) if !text.ends_with(std::path::is_separator) => name,
            _ => {
                let way_out = format!("write {}", path.join("frame_####.png").display());
                return Err(usage(
                    "a file name such as frame_####.png",
                    &format!("'{text}'"),
                    &way_out,
                ));
            }
        };
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();

        // Part the name, then choose the format by the extension.
        let markers = markers(name);
        let (before, digits, after) = part(text, name, &markers)?;
        let extension = after.rsplit_once('.').map(|(_, extension)| extension);
        let container = extension.and_then(container_of);
        let one = extension
            .filter(|_| markers.is_empty())
            .map(|_| path.to_path_buf());
        if let (Some(_), None) = (container, &one) {
            let way_out = format!("write {}", path.with_file_name("name.mp4").display());
            let expected = "a moving picture's name without a marker, for it is one file";
            return Err(usage(expected, &format!("'{text}'"), &way_out));
        }
        let (after, kind) = ending(text, after, extension)?;
        Ok(Pattern {
            folder,
            before,
            digits,
            after,
            kind,
            one,
            container,
        })
    }

    /// Where frames go when nothing is said: `frames/<stem>_####.png`.
    pub fn default_for(scene_stem: &str) -> Pattern {
        Pattern {
            folder: "frames".into(),
            before: format!("{scene_stem}_"),
            digits: DIGITS,
            after: ".png".into(),
            kind: FileKind::Png,
            one: None,
            container: None,
        }
    }

    /// The file of one frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        let Pattern {
            before,
            digits,
            after,
            ..
        } = self;
        self.folder.join(format!("{before}{frame:0digits$}{after}"))
    }

    /// The file of a preview of one frame: `_shots_` and the number of shots before the extension.
    ///
    /// ```
    /// use sweeplight::io::pattern::Pattern;
    /// let preview = Pattern::parse("out/door_####.exr")?.preview(7, 64);
    /// assert_eq!(preview, std::path::Path::new("out/door_0007_shots_0000064.exr"));
    /// # Ok::<(), sweeplight::error::Error>(())
    /// ```
    pub fn preview(&self, frame: u32, shots: u64) -> PathBuf {
        preview_of(&self.path(frame), shots)
    }

    /// The folder and the stem of its manifest.
    pub fn manifest(&self) -> (PathBuf, String) {
        let folder = destination::folder(&self.path(0)).to_path_buf();
        (folder, manifest::stem(&self.before))
    }

    /// The file as typed, where the name has an extension and no marker.
    pub fn one(&self) -> Option<&Path> {
        self.one.as_deref()
    }

    /// What joins all frames into one file, where the extension says so.
    pub fn container(&self) -> Option<Container> {
        self.container
    }

    /// Whether two patterns may mean the same file.
    pub fn clashes(&self, other: &Pattern) -> bool {
        let files = |pattern: &Pattern| {
            // A single name is a sequence as well where its format has no moving pictures.
            let numbered = pattern.one.is_none() || pattern.kind == FileKind::Exr;
            let first = numbered.then(|| pattern.path(0));
            [pattern.one.clone(), first]
        };
        let theirs = files(other);
        let mut ours = files(self).into_iter();
        ours.any(|file| file.is_some() && theirs.contains(&file))
    }

    /// The format of the files.
    pub fn kind(&self) -> FileKind {
        self.kind
    }
}

/// The name before the frame number, its digits, and the name after it; parted where a marker stands or would stand.
fn part<'a>(
    text: &str,
    name: &'a str,
    markers: &[(usize, usize, usize)],
) -> Result<(String, usize, &'a str)> {
    let (before, digits, after) = match *markers {
        [] => {
            let dot = name.rfind('.').filter(|&dot| dot > 0).unwrap_or(name.len());
            (format!("{}_", &name[..dot]), DIGITS, &name[dot..])
        }
        [(start, end, digits)] => (name[..start].to_string(), digits, &name[end..]),
        _ => {
            let way_out = "keep one of them, the frame number is written once";
            return Err(usage(
                "one marker, #### or %04d",
                &format!("'{text}' with {}", markers.len()),
                way_out,
            ));
        }
    };
    if !(1..=MOST_DIGITS).contains(&digits) {
        let expected = format!("a number of 1 to {MOST_DIGITS} digits, padded with zeros");
        return Err(usage(&expected, &format!("'{text}'"), "write #### or %04d"));
    }
    Ok((before, digits, after))
}

/// The end of the name of each file, and its format.
fn ending(text: &str, after: &str, extension: Option<&str>) -> Result<(String, FileKind)> {
    let container = extension.and_then(container_of);
    Ok(match extension {
        None => (format!("{after}.png"), FileKind::Png),
        Some(_) if container.is_some() => (".png".to_string(), FileKind::Png),
        Some(extension) => match FileKind::of(extension) {
            Some(kind) => (after.to_string(), kind),
            None => {
                let got = format!("'.{extension}' in '{text}'");
                let way_out = "write the extension of the format you want";
                return Err(usage(
                    "a name that ends in .png (sRGB), .exr (linear radiance), .mp4, .gif or .apng",
                    &got,
                    way_out,
                ));
            }
        },
    })
}

/// The container that an extension means.
fn container_of(extension: &str) -> Option<Container> {
    match extension.to_ascii_lowercase().as_str() {
        "mp4" => Some(Container::Mp4),
        "gif" => Some(Container::Gif),
        "apng" => Some(Container::Apng),
        _ => None,
    }
}

/// The file of a preview beside that of its frame.
pub(super) fn preview_of(path: &Path, shots: u64) -> PathBuf {
    let part = |part: Option<&OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let (stem, extension) = (part(path.file_stem()), part(path.extension()));
    path.with_file_name(format!("{stem}_shots_{shots:0SHOT_DIGITS$}.{extension}"))
}

/// The file of the frame that a file is a preview of, if its name is that of one.
pub(super) fn frame_of_preview(path: &Path) -> Option<PathBuf> {
    let (stem, shots) = path.file_stem()?.to_str()?.rsplit_once("_shots_")?;
    let number = shots.len() >= SHOT_DIGITS && shots.bytes().all(|byte| byte.is_ascii_digit());
    let extension = path.extension()?.to_str()?;
    number.then(|| path.with_file_name(format!("{stem}.{extension}")))
}

/// Start, end and digits of each marker: a run of `#`, `%d`, or `%0Nd`. `%4d` would pad with spaces: it has 0 digits.
fn markers(name: &str) -> Vec<(usize, usize, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < name.len() {
        let marker = hashes(name, at).or_else(|| printf(name, at));
        let end = marker.map_or(at + 1, |(end, _)| end);
        found.extend(marker.map(|(end, digits)| (at, end, digits)));
        at = end;
    }
    found
}

/// End and digits of the run of `#` that starts at a byte.
fn hashes(name: &str, at: usize) -> Option<(usize, usize)> {
    let count = run(name, at, |byte| *byte == b'#');
    (count > 0).then_some((at + count, count))
}

/// End and digits of the `%d` or `%0Nd` that starts at a byte.
fn printf(name: &str, at: usize) -> Option<(usize, usize)> {
    if name.as_bytes()[at] != b'%' {
        return None;
    }
    let stop = at + 1 + run(name, at + 1, u8::is_ascii_digit);
    if name.as_bytes().get(stop) != Some(&b'd') {
        return None;
    }
    let digits = match &name[at + 1..stop] {
        "" => 1,
        width if width.starts_with('0') => width.parse().unwrap_or(usize::MAX).max(1),
        _ => 0,
    };
    Some((stop + 1, digits))
}

/// Length of the run of such bytes from a byte on.
fn run(name: &str, from: usize, is: fn(&u8) -> bool) -> usize {
    let bytes = name.as_bytes()[from..].iter();
    bytes.take_while(|byte| is(byte)).count()
}

/// The error for `-o`.
fn usage(expected: &str, got: &str, way_out: &str) -> Error {
    Error::Usage {
        flag: "-o".into(),
        expected: expected.into(),
        got: got.into(),
        way_out: way_out.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str, frame: u32) -> String {
        let pattern = Pattern::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        pattern.path(frame).display().to_string()
    }

    #[test]
    fn markers_are_filled_and_longer_numbers_are_not_cut() {
        assert_eq!(path("dir/name_####.exr", 7), "dir/name_0007.exr");
        assert_eq!(path("dir/name_####.exr", 123_456), "dir/name_123456.exr");
        assert_eq!(path("n##.png", 3), "n03.png");
        assert_eq!(path("n.######.png", 3), "n.000003.png");
        assert_eq!(path("n%06d.png", 3), "n000003.png");
        assert_eq!(path("n%d.png", 3), "n3.png");
        assert_eq!(path("####", 3), "0003.png");
        assert_eq!(path("door.####", 3), "door.0003.png");
        assert_eq!(path("####.v2.EXR", 3), "0003.v2.EXR");
    }

    #[test]
    fn a_name_without_marker_gets_one() {
        assert_eq!(path("out/door.exr", 3), "out/door_0003.exr");
        assert_eq!(path("out/door", 3), "out/door_0003.png");
        assert_eq!(path("/a.b/door", 3), "/a.b/door_0003.png");
        assert_eq!(path("take#1/50%grau.png", 3), "take#1/50%grau_0003.png");
    }

    #[test]
    fn the_extension_gives_the_kind() {
        assert_eq!(
            Pattern::parse("a.exr").map(|pattern| pattern.kind()).ok(),
            Some(FileKind::Exr)
        );
        assert_eq!(
            Pattern::parse("a.PNG").map(|pattern| pattern.kind()).ok(),
            Some(FileKind::Png)
        );
        assert_eq!(
            Pattern::parse("a").map(|pattern| pattern.kind()).ok(),
            Some(FileKind::Png)
        );
    }

    #[test]
    fn the_default_takes_the_stem_as_it_is() {
        assert_eq!(
            Pattern::default_for("door").path(12),
            Path::new("frames/door_0012.png")
        );
        assert_eq!(
            Pattern::default_for("a#b%d").path(0),
            Path::new("frames/a#b%d_0000.png")
        );
        assert_eq!(
            Pattern::default_for("door"),
            Pattern::parse("frames/door_####.png").expect("a pattern")
        );
    }

    #[test]
    fn what_cannot_be_used_is_refused_with_a_way_out() {
        for (text, word) in [
            (
                "a.jpg",
                ".exr (linear radiance), .mp4, .gif or .apng, got '.jpg'",
            ),
            ("a_####.", "'.'"),
            ("a_####.mp4", "without a marker"),
            ("a_####_%04d.png", "with 2"),
            ("a_%4d.png", "padded with zeros"),
            ("a_%099999999999999999999d.png", "padded with zeros"),
            ("out/", "write out/frame_####.png"),
            ("", "frame_####.png"),
            ("..", "frame_####.png"),
        ] {
            let told = Pattern::parse(text).expect_err(text).to_string();
            assert!(
                told.starts_with("-o: expected ") && told.contains(word),
                "{told}"
            );
        }
    }
}
