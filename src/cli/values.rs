//! Parsers of values: each refusal names what would do.
//!
//! clap has parsers of numbers and enums of its own, but refuses without a way out. Ours answer in the form of
//! [`Error::Usage`]: *flag: expected, got — way out*.

use std::ffi::OsStr;
use std::marker::PhantomData;
use std::str::FromStr;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Command, ValueEnum};

use crate::error::{Error, Result};
use crate::io::pattern::{FileKind, Pattern};

/// A parser of one value, a function of the flag and the text.
#[derive(Clone)]
pub(super) struct Checked<F>(pub(super) F);

impl<T, F> TypedValueParser for Checked<F>
where
    F: Fn(&str, &str) -> Result<T> + Clone + Send + Sync + 'static,
    T: Clone + Send + Sync + 'static,
{
    type Value = T;

    fn parse_ref(
        &self,
        _: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> std::result::Result<T, clap::Error> {
        self.0(&flag(arg), &value.to_string_lossy()).map_err(refusal)
    }
}

/// A parser of the names of an enum's variants, which the help lists.
#[derive(Clone)]
pub(super) struct OneOf<T> {
    way_out: &'static str,
    variants: PhantomData<fn() -> T>,
}

/// The names of an enum's variants; `way_out` tells what to write instead of another.
pub(super) fn one_of<T>(way_out: &'static str) -> OneOf<T> {
    OneOf {
        way_out,
        variants: PhantomData,
    }
}

impl<T: ValueEnum + Clone + Send + Sync + 'static> TypedValueParser for OneOf<T> {
    type Value = T;

    fn parse_ref(
        &self,
        _: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> std::result::Result<T, clap::Error> {
        let text = value.to_string_lossy();
        T::from_str(text.trim(), false).map_err(|_| {
            refusal(usage(
                &flag(arg),
                &either(&names::<T>()),
                &text,
                self.way_out,
            ))
        })
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(possible::<T>()))
    }
}

/// The possible values of an enum, with their help.
pub(super) fn possible<T: ValueEnum + 'static>() -> impl Iterator<Item = PossibleValue> {
    let variants = T::value_variants().iter();
    variants.filter_map(ValueEnum::to_possible_value)
}

/// The names of an enum's variants.
pub(super) fn names<T: ValueEnum + 'static>() -> Vec<String> {
    possible::<T>()
        .map(|value| value.get_name().into())
        .collect()
}

/// `a, b or c`.
fn either(names: &[String]) -> String {
    match names {
        [all @ .., last] if !all.is_empty() => format!("{} or {last}", all.join(", ")),
        _ => names.concat(),
    }
}

/// A number that fits; the way out is an example, and what may follow it in the sentence.
pub(super) fn number<T: FromStr>(
    expected: &'static str,
    fits: fn(&T) -> bool,
    example: &'static str,
) -> Checked<impl Fn(&str, &str) -> Result<T> + Clone> {
    Checked(move |flag: &str, text: &str| {
        let refused = || {
            usage(
                flag,
                expected,
                text,
                &format!("write e.g. {flag} {example}"),
            )
        };
        read(text).filter(fits).ok_or_else(refused)
    })
}

/// A whole number within bounds, both included.
pub(super) fn whole(least: u32, most: u32) -> Checked<impl Fn(&str, &str) -> Result<u32> + Clone> {
    Checked(move |flag: &str, text: &str| within(flag, text, least, most))
}

/// A whole number of a series within bounds: `nearest` maps every other number to one of the series.
pub(super) fn series(
    (least, most): (u32, u32),
    expected: &'static str,
    nearest: fn(u32) -> u32,
) -> Checked<impl Fn(&str, &str) -> Result<u32> + Clone> {
    Checked(move |flag: &str, text: &str| {
        let count = within(flag, text, least, most)?;
        let near = nearest(count);
        let refused = || {
            usage(
                flag,
                expected,
                text,
                &format!("the nearest is {flag} {near}"),
            )
        };
        (near == count).then_some(count).ok_or_else(refused)
    })
}

/// The square nearest to a number from 1 to 64.
pub(super) fn square(count: u32) -> u32 {
    let squares = (1..=8).map(|side: u32| side * side);
    squares
        .min_by_key(|square| square.abs_diff(count))
        .unwrap_or(1)
}

fn within(flag: &str, text: &str, least: u32, most: u32) -> Result<u32> {
    let expected = format!("a whole number from {least} to {most}");
    let Some(count) = read::<i64>(text) else {
        let way_out = format!("write e.g. {flag} {}", least.max(16).min(most));
        return Err(usage(flag, &expected, text, &way_out));
    };
    let nearest = count.clamp(least.into(), most.into());
    if nearest == count {
        return Ok(nearest as u32);
    }
    let way_out = format!("the nearest is {flag} {nearest}");
    Err(usage(flag, &expected, text, &way_out))
}

/// Width x height, in pixels.
pub(super) fn size(flag: &str, text: &str) -> Result<(u32, u32)> {
    let sides = text.split_once(['x', 'X', '×']);
    let sides = sides.and_then(|(width, height)| Some((read(width)?, read(height)?)));
    let fits = |side: u32| (1..=16_384).contains(&side);
    let refused = || {
        let expected = "width x height in pixels, each 1 to 16384";
        usage(flag, expected, text, &format!("write e.g. {flag} 640x360"))
    };
    sides
        .filter(|&(width, height)| fits(width) && fits(height))
        .ok_or_else(refused)
}

/// Patterns that can be written, no two of them to the same files; their formats.
pub(super) fn outputs(texts: &[String]) -> Result<Vec<FileKind>> {
    let patterns = texts.iter().map(|text| Pattern::parse(text));
    let patterns = patterns.collect::<Result<Vec<_>>>()?;
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

/// A number, if it is one.
pub(super) fn read<T: FromStr>(text: &str) -> Option<T> {
    text.trim().parse().ok()
}

/// Puts a value into the settings, if it was given.
pub(super) fn set<T>(place: &mut T, given: Option<T>) {
    if let Some(value) = given {
        *place = value;
    }
}

/// The error of a value that is not taken.
pub(super) fn usage(flag: &str, expected: &str, got: &str, way_out: &str) -> Error {
    conflict(flag, expected, &format!("'{got}'"), way_out)
}

/// The error of a flag that does not go with another, or without one.
pub(super) fn conflict(flag: &str, expected: &str, got: &str, way_out: &str) -> Error {
    Error::Usage {
        flag: flag.into(),
        expected: expected.into(),
        got: got.into(),
        way_out: way_out.into(),
    }
}

/// The flag as typed, `--frames`.
pub(super) fn flag(arg: Option<&Arg>) -> String {
    let long = arg.and_then(Arg::get_long).unwrap_or("value");
    format!("--{long}")
}

/// An error in a form that clap hands on.
pub(super) fn refusal(error: Error) -> clap::Error {
    clap::Error::raw(ErrorKind::ValueValidation, format!("{error}\n"))
}

#[cfg(test)]
mod tests;
