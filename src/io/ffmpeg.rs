//! Stills as a video, by the ffmpeg that is installed: they go into its standard input one after another.
//!
//! H.264 in 4:2:0, as every player takes it, with the colours of BT.709 and the transfer curve of sRGB said in the file. A size
//! that is odd grows by a black column or row, for 4:2:0 has half as many of each.

use std::fs::File;
use std::io::{ErrorKind, Read, copy};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::io::rate;

/// The program, looked up as the system does.
const FFMPEG: &str = "ffmpeg";

/// Quality of H.264, 0 (lossless) to 51: at 16 nothing is to be seen of it.
const QUALITY: &str = "16";

/// What makes frames of even size in the right colours.
const PICTURE: &str =
    "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p";

/// Says what is wrong with the installed ffmpeg, if anything.
pub fn check() -> Result<(), String> {
    let mut command = Command::new(FFMPEG);
    command
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    match command.stderr(Stdio::null()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("ffmpeg -version ended with {status}")),
        Err(error) if error.kind() == ErrorKind::NotFound => Err("ffmpeg is not installed".into()),
        Err(error) => Err(format!("ffmpeg does not start: {error}")),
    }
}

/// Starts ffmpeg: PNG files on its standard input, a video as its output.
fn start(fps: f64, out: &Path) -> Result<Child, String> {
    let (frames, seconds) = rate::fraction(fps);
    let rate = format!("{frames}/{seconds}");
    let before = [
        "-hide_banner",
        "-loglevel",
        "error",
        "-y",
        "-f",
        "image2pipe",
        "-c:v",
        "png",
    ];
    let after = [
        "-i", "-", "-vf", PICTURE, "-c:v", "libx264", "-crf", QUALITY,
    ];
    let colors = [
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "iec61966-2-1",
    ];
    Command::new(FFMPEG)
        .args(before)
        .args(["-framerate", &rate])
        .args(after)
        .args(colors)
        .args(["-movflags", "+faststart", "-f", "mp4"])
        .arg(out)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("ffmpeg does not start: {error}"))
}

/// Lets ffmpeg write the stills into a file; the error is what it said.
pub fn join(stills: &[PathBuf], fps: f64, out: &Path) -> Result<(), String> {
    let mut child = start(fps, out)?;

    // Listen while it is fed: one who is not heard stops to take anything.
    let (feed, voice) = (child.stdin.take(), child.stderr.take());
    let listener = std::thread::spawn(move || {
        let mut said = Vec::new();
        voice.map(|mut voice| voice.read_to_end(&mut said));
        String::from_utf8_lossy(&said).trim().replace('\n', "; ")
    });
    let fed = feed.map_or(Ok(()), |mut feed| {
        stills.iter().try_for_each(|path| {
            let mut still = File::open(path)?;
            copy(&mut still, &mut feed).map(drop)
        })
    });
    let status = child.wait().map_err(|error| error.to_string())?;
    let said = listener.join().unwrap_or_default();

    // What it says explains more than a pipe that broke.
    match (status.success(), fed) {
        (true, Ok(())) => Ok(()),
        (true, Err(error)) => Err(error.to_string()),
        (false, _) if said.is_empty() => Err(format!("ffmpeg ended with {status}")),
        (false, _) => Err(format!("ffmpeg: {said}")),
    }
}
