//! What the flags say, checked: a number outside its bounds is refused with the nearest one that would do.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::frames::sets;
use crate::io::pattern::{Kind, Pattern};
use crate::mesh::locate::MOST_ELEMENTS;
use crate::settings::{Finish, FormFactors, Mesh, Pairs, Quality, Solver};

/// `--fps`: above 0, at most 1000.
pub(super) fn fps(text: &str) -> Result<f64> {
    let rate = number(text).filter(|&rate: &f64| rate > 0.0 && rate <= 1000.0);
    rate.ok_or_else(|| {
        usage(
            "--fps",
            "frames per second above 0 and at most 1000",
            text,
            "write e.g. --fps 24",
        )
    })
}

/// `--memory`: gigabytes, as bytes; `None` for low.
pub(super) fn memory(text: &str) -> Result<Option<u64>> {
    if text == "low" {
        return Ok(None);
    }
    let gigabytes = number(text).filter(|&gigabytes: &f64| gigabytes > 0.0 && gigabytes <= 1e6);
    gigabytes
        .map(|gigabytes| Some((gigabytes * 1e9) as u64))
        .ok_or_else(|| {
            usage(
                "--memory",
                "gigabytes above 0 and at most 1000000, or low",
                text,
                "write e.g. --memory 16",
            )
        })
}

/// `--size`: width x height.
pub(super) fn size(text: &str) -> Result<(u32, u32)> {
    let sides = text.split_once(['x', 'X', '×']);
    let sides = sides.and_then(|(width, height)| Some((number(width)?, number(height)?)));
    let fits = |side: u32| (1..=16_384).contains(&side);
    sides
        .filter(|&(width, height)| fits(width) && fits(height))
        .ok_or_else(|| {
            usage(
                "--size",
                "width x height in pixels, each 1 to 16384",
                text,
                "write e.g. --size 640x360",
            )
        })
}

/// `--budget`: milliseconds from 0.
pub(super) fn budget(text: &str) -> Result<f64> {
    let budget = number(text).filter(|ms: &f64| (0.0..=1e9).contains(ms));
    budget.ok_or_else(|| {
        usage(
            "--budget",
            "milliseconds from 0",
            text,
            "write e.g. --budget 5, or leave it out to redistribute all light in each step",
        )
    })
}

/// `--quality`: a preset.
pub(super) fn quality(text: &str) -> Result<Quality> {
    match text {
        "draft" => Ok(Quality::Draft),
        "standard" => Ok(Quality::Standard),
        "fine" => Ok(Quality::Fine),
        _ => Err(usage(
            "--quality",
            "draft, standard or fine",
            text,
            "write e.g. --quality draft for a quick look",
        )),
    }
}

/// `--finish`: interpolate, hybrid, gather or flat.
pub(super) fn finish(text: &str) -> Result<Finish> {
    match text {
        "interpolate" => Ok(Finish::Interpolate),
        "hybrid" => Ok(Finish::Hybrid),
        "gather" => Ok(Finish::Gather),
        "flat" => Ok(Finish::Flat),
        _ => Err(usage(
            "--finish",
            "interpolate, hybrid, gather or flat",
            text,
            "give one of the four, or leave the flag out for hybrid",
        )),
    }
}

/// `--form-factors`: a set.
pub(super) fn form_factors(text: &str) -> Result<FormFactors> {
    match text {
        "cosine" => Ok(FormFactors::Cosine),
        "hemicube" => Ok(FormFactors::Hemicube),
        "plane" => Ok(FormFactors::Plane),
        _ => Err(usage(
            "--form-factors",
            "cosine, hemicube or plane",
            text,
            "leave it out for cosine, the least error for as many samples",
        )),
    }
}

/// `--hemicube-resolution`: pixels along an edge, an even number.
pub(super) fn hemicube_resolution(text: &str) -> Result<u32> {
    let Some(pixels) = number::<u32>(text) else {
        return Err(usage(
            "--hemicube-resolution",
            "an even number of pixels from 4 to 146",
            text,
            "write e.g. --hemicube-resolution 32",
        ));
    };
    sets::resolved(pixels).map(|pixels| pixels as u32)
}

/// `--solver`: gather or progressive.
pub(super) fn solver(text: &str) -> Result<Solver> {
    match text {
        "gather" => Ok(Solver::Gather),
        "progressive" => Ok(Solver::Progressive),
        _ => Err(usage(
            "--solver",
            "gather or progressive",
            text,
            "leave it out for gather, the faster of the two",
        )),
    }
}

/// `--pairs`: near or none.
pub(super) fn pairs(text: &str) -> Result<Pairs> {
    match text {
        "near" => Ok(Pairs::Near),
        "none" => Ok(Pairs::None),
        _ => Err(usage(
            "--pairs",
            "near or none",
            text,
            "leave it out for none, where elements are small",
        )),
    }
}

/// `--patch-elements`: a whole number.
pub(super) fn patch_elements(text: &str) -> Result<u32> {
    let fits = number(text).filter(|count| (1..=1024).contains(count));
    fits.ok_or_else(|| {
        usage(
            "--patch-elements",
            "a whole number from 1 to 1024",
            text,
            "write e.g. --patch-elements 4",
        )
    })
}

/// `--shots`: a whole number.
pub(super) fn shots(text: &str) -> Result<u64> {
    number(text).ok_or_else(|| {
        usage(
            "--shots",
            "a whole number from 0",
            text,
            "write e.g. --shots 1000, or leave it out to let the tolerance decide",
        )
    })
}

/// `--element-size`: metres, above 0.
pub(super) fn element_size(text: &str) -> Result<f32> {
    let metres = number(text).filter(|&metres: &f32| metres > 0.0 && metres.is_finite());
    metres.ok_or_else(|| {
        let way_out =
            "write e.g. --element-size 0.25, or leave it out for one that suits the scene";
        usage(
            "--element-size",
            "a length in metres above 0",
            text,
            way_out,
        )
    })
}

/// `--elements`: from 1 to what ids last for.
pub(super) fn elements(text: &str) -> Result<u32> {
    whole("--elements", text, 1, MOST_ELEMENTS as u32 - 1)
}

/// `--mesh`: by its name.
pub(super) fn mesh(text: &str) -> Result<Mesh> {
    match text {
        "uniform" => Ok(Mesh::Uniform),
        "adaptive" => Ok(Mesh::Adaptive),
        _ => Err(usage(
            "--mesh",
            "uniform or adaptive",
            text,
            "leave it out for uniform",
        )),
    }
}

/// `--samples`: a multiple of 16 from 16 to 4096.
pub(super) fn samples(text: &str) -> Result<u32> {
    let flag = "--samples";
    let count = whole(flag, text, 16, 4096)?;
    if count % 16 == 0 {
        return Ok(count);
    }
    let nearest = (count + 8) / 16 * 16;
    Err(usage(
        flag,
        "a multiple of 16 from 16 to 4096",
        text,
        &format!("the nearest is --samples {nearest}"),
    ))
}

/// `--light-samples`: 1 to 1024.
pub(super) fn light_samples(text: &str) -> Result<u32> {
    whole("--light-samples", text, 1, 1024)
}

/// `--finish-samples`: a power of two from 4 to 256.
pub(super) fn finish_samples(text: &str) -> Result<u32> {
    let flag = "--finish-samples";
    let count = whole(flag, text, 4, 256)?;
    if count.is_power_of_two() {
        return Ok(count);
    }
    let way_out = format!("the next is --finish-samples {}", count.next_power_of_two());
    Err(usage(
        flag,
        "a power of 2: 4, 8, 16, 32, 64, 128 or 256",
        text,
        &way_out,
    ))
}

/// `--pixel-samples`: a square from 1 to 64.
pub(super) fn pixel_samples(text: &str) -> Result<u32> {
    let flag = "--pixel-samples";
    let count = whole(flag, text, 1, 64)?;
    let nearest = (1..=8u32)
        .map(|side| side * side)
        .min_by_key(|square| square.abs_diff(count));
    match nearest {
        Some(square) if square != count => {
            let way_out = format!("the nearest is --pixel-samples {square}");
            Err(usage(
                flag,
                "a square: 1, 4, 9, 16, 25, 36, 49 or 64",
                text,
                &way_out,
            ))
        }
        _ => Ok(count),
    }
}

/// `--threads`: 1 to 1024.
pub(super) fn threads(text: &str) -> Result<usize> {
    whole("--threads", text, 1, 1024).map(|threads| threads as usize)
}

/// `--slalom`: seconds.
pub(super) fn seconds(text: &str) -> Result<f64> {
    let seconds = text.parse::<f64>().ok();
    seconds.filter(|s| *s > 0.0 && *s <= 3600.0).ok_or_else(|| {
        let expected = "seconds above 0 and at most 3600";
        usage(
            "--slalom",
            expected,
            &format!("'{text}'"),
            "write e.g. --slalom 60",
        )
    })
}

/// `-o`: patterns that can be written, no two of them to the same files; their formats.
pub(super) fn outputs(texts: &[String]) -> Result<Vec<Kind>> {
    let patterns = texts
        .iter()
        .map(|text| Pattern::parse(text))
        .collect::<Result<Vec<_>>>()?;
    for (index, pattern) in patterns.iter().enumerate() {
        if patterns[..index].iter().any(|other| other.clashes(pattern)) {
            let got = format!("{} twice", texts[index]);
            return Err(usage(
                "-o",
                "each file once",
                &got,
                "leave one of the two out",
            ));
        }
    }
    Ok(patterns.iter().map(Pattern::kind).collect())
}

/// A whole number within bounds, both included.
pub(super) fn whole(flag: &str, text: &str, least: u32, most: u32) -> Result<u32> {
    let expected = format!("a whole number from {least} to {most}");
    let count: i64 = match number(text) {
        Some(count) => count,
        None => {
            return Err(usage(
                flag,
                &expected,
                text,
                &format!("write e.g. {flag} {}", least.max(16).min(most)),
            ));
        }
    };
    let nearest = count.clamp(least.into(), most.into());
    if nearest == count {
        return Ok(nearest as u32);
    }
    Err(usage(
        flag,
        &expected,
        text,
        &format!("the nearest is {flag} {nearest}"),
    ))
}

/// A number, if it is one.
pub(super) fn number<T: FromStr>(text: &str) -> Option<T> {
    text.trim().parse().ok()
}

/// The error for a flag.
pub(super) fn usage(flag: &str, expected: &str, got: &str, way_out: &str) -> Error {
    Error::Usage {
        flag: flag.into(),
        expected: expected.into(),
        got: format!("'{got}'"),
        way_out: way_out.into(),
    }
}

#[cfg(test)]
mod tests;
