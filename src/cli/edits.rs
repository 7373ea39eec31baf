//! Refusals of `edit`: values of `render`'s flags that edits cannot honour, each refused by name.

use super::values::conflict as alone;
use crate::error::Result;
use crate::io::pattern::{FileKind, Pattern};
use crate::settings::{
    DirectLight, HemisphereSampling, IndirectMode, Memory, Meshing, Pairs, Settings,
};

/// Most light samples of a side to one emitting material: a session keeps their visibility as the bits of a word.
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

/// Refuses settings that edits cannot honour.
pub(super) fn check(settings: &Settings, typed: &Typed) -> Result<()> {
    let solve = &settings.solve;
    let low = "gigabytes, for edits build on kept hit ids";
    let solver = "none, for edits shoot or gather as the light requires";
    let pairs = "none, for edits keep samples alone";
    let patches = "1, for edits redistribute light element by element";
    let mesh = "uniform, for no pilot knows edits";
    let still_mesh = "uniform, for edits move what casts shadows";
    let lights = "a whole number from 1 to 64, for each emitting material";
    let still = "--play beside it, for time stands still otherwise";
    let refusals = [
        (solve.memory == Memory::Low, "--memory low", low, "low"),
        (typed.solver, "--solver", solver, "one"),
        (
            solve.form_factors != HemisphereSampling::Cosine,
            "--form-factors",
            "cosine, the one set of edits",
            "another",
        ),
        (solve.pairs == Pairs::Near, "--pairs", pairs, "near"),
        (
            solve.patch_elements > 1,
            "--patch-elements",
            patches,
            "more",
        ),
        (solve.mesh == Meshing::Adaptive, "--mesh", mesh, "adaptive"),
        (
            solve.mesh == Meshing::Shadows,
            "--mesh",
            still_mesh,
            "shadows",
        ),
        (
            settings.image.direct == DirectLight::Exact,
            "--direct",
            "sampled, for edits move what is exact",
            "exact",
        ),
        (
            solve.light_samples > MOST_LIGHT_SAMPLES,
            "--light-samples",
            lights,
            "more",
        ),
        (
            settings.image.finish == IndirectMode::Phong,
            "--finish",
            "a finish for which light is solved",
            "phong",
        ),
        (typed.fps && !typed.play, "--fps", still, "none"),
        (
            settings.film.shutter > 0.0,
            "--shutter",
            "0, for a step is a moment",
            "an open shutter",
        ),
    ];
    match refusals.iter().find(|(said, ..)| *said) {
        Some((_, flag, expected, got)) => Err(alone(flag, expected, got, "leave the flag out")),
        None => Ok(()),
    }
}

/// Refuses outputs that no step can be written into, and `--exr-float` without any that it speaks of.
pub(super) fn check_outputs(texts: &[String], kinds: &[FileKind], exr_float: bool) -> Result<()> {
    for text in texts {
        if Pattern::parse(text)?.container().is_some() {
            let expected = "a picture for each step, .png or .exr";
            let way_out = "write e.g. -o 'frames/step_####.png', and join them afterwards";
            return Err(alone("-o", expected, &format!("'{text}'"), way_out));
        }
    }
    if exr_float && !kinds.contains(&FileKind::Exr) {
        let expected = "an output that ends in .exr";
        let way_out = "add -o 'frames/step_####.exr', or leave the flag out";
        return Err(alone("--exr-float", expected, "none", way_out));
    }
    Ok(())
}
