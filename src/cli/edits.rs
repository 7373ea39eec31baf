//! What flags that `edit` shares with `render` must not say: each is refused by name, and none is passed over.

use super::values::conflict as alone;
use crate::error::Result;
use crate::io::pattern::{Kind, Pattern};
use crate::settings::{FormFactors, Memory, Mesh, Pairs, Settings};

/// Light samples of a side to one emitting material, at most: a session keeps their answers as the bits of a word.
const MOST_LIGHT_SAMPLES: u32 = 64;

/// Flags that were typed, where settings do not tell.
pub(super) struct Typed {
    /// `--solver`.
    pub(super) solver: bool,
    /// `--fps`.
    pub(super) fps: bool,
    /// `--play`.
    pub(super) play: bool,
}

/// Refuses what edits cannot do.
pub(super) fn check(settings: &Settings, typed: &Typed) -> Result<()> {
    let out = "leave the flag out";
    let light_samples = settings.solve.light_samples > MOST_LIGHT_SAMPLES;
    let refusals = [
        (
            settings.solve.memory == Memory::Low,
            "--memory low",
            "gigabytes, for edits build on the answers that are kept",
            "low",
        ),
        (
            typed.solver,
            "--solver",
            "none, for edits shoot or gather as the light asks for",
            "one",
        ),
        (
            settings.solve.form_factors != FormFactors::Cosine,
            "--form-factors",
            "cosine, the one set of edits",
            "another",
        ),
        (
            settings.solve.pairs == Pairs::Near,
            "--pairs",
            "none, for edits keep samples alone",
            "near",
        ),
        (
            settings.solve.patch_elements > 1,
            "--patch-elements",
            "1, for edits redistribute light element by element",
            "more",
        ),
        (
            settings.solve.mesh == Mesh::Adaptive,
            "--mesh",
            "uniform, for edits come that no pilot has seen",
            "adaptive",
        ),
        (
            light_samples,
            "--light-samples",
            "a whole number from 1 to 64, for each emitting material",
            "more",
        ),
        (
            typed.fps && !typed.play,
            "--fps",
            "--play beside it, for time stands still otherwise",
            "none",
        ),
        (
            settings.film.shutter > 0.0,
            "--shutter",
            "0, for a step is a moment",
            "an open shutter",
        ),
    ];
    match refusals.iter().find(|(said, ..)| *said) {
        Some((_, flag, expected, got)) => Err(alone(flag, expected, got, out)),
        None => Ok(()),
    }
}

/// Refuses outputs that no step can be written into, and `--exr-float` without any that it speaks of.
pub(super) fn check_outputs(texts: &[String], kinds: &[Kind], exr_float: bool) -> Result<()> {
    for text in texts {
        if Pattern::parse(text)?.container().is_some() {
            let expected = "a picture for each step, .png or .exr";
            let way_out = "write e.g. -o 'frames/step_####.png', and join them afterwards";
            return Err(alone("-o", expected, &format!("'{text}'"), way_out));
        }
    }
    if exr_float && !kinds.contains(&Kind::Exr) {
        let expected = "an output that ends in .exr";
        let way_out = "add -o 'frames/step_####.exr', or leave the flag out";
        return Err(alone("--exr-float", expected, "none", way_out));
    }
    Ok(())
}
