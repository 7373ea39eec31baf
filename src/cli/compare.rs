//! The flags of `factors`: two ends in a scene, frames, and estimators.

use std::path::PathBuf;

use clap::Args;

use super::help;
use super::light::LightArgs;
use super::scene::{FrameList, LookArgs, frames};
use super::values::{Checked, usage};
use crate::compare::{FactorMethod, PairQuery};
use crate::error::Result;
use crate::settings::Settings;
use clap::ValueEnum;
use clap::builder::PossibleValue;

/// Print the form factor between two things of a scene, by every estimator, with its expected error
///
/// An end is an element by its number, 12, one of its sides, 12:front or 12:back, or a node by its name, with all nodes below
/// it. Beside each factor stand the factor back, whether both are reciprocal, and the share that movers stop.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct FactorsArgs {
    /// The .gltf or .glb file
    scene: PathBuf,
    /// The end that receives
    #[arg(long, value_name = "ELEMENT|NODE")]
    from: String,
    /// The end that sends
    #[arg(long, value_name = "ELEMENT|NODE")]
    to: String,
    /// Frames, such as 0-47x2; without a list, the whole animation [default: 0]
    #[arg(long, value_name = "LIST", num_args = 0..=1, default_missing_value = "all", allow_negative_numbers = true,
          value_parser = Checked(some_frames))]
    frames: Option<WantedFrames>,
    /// The estimator, or all [default: all]
    #[arg(long, value_name = "NAME|all", value_parser = Estimators)]
    by: Option<WantedMethod>,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    light: LightArgs,
    /// Print JSON instead of the table
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Print errors alone
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

/// The frames of a list, or all: one value of clap's.
#[derive(Clone, Debug)]
struct WantedFrames(Option<Vec<u32>>);

/// An estimator, or all: one value of clap's.
#[derive(Clone, Debug)]
struct WantedMethod(Option<FactorMethod>);

/// The parser of estimators.
#[derive(Clone)]
struct Estimators;

impl clap::builder::TypedValueParser for Estimators {
    type Value = WantedMethod;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> std::result::Result<WantedMethod, clap::Error> {
        Checked(method).parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let all = PossibleValue::new("all").help("All of them");
        Some(Box::new(
            super::values::possible::<FactorMethod>().chain([all]),
        ))
    }
}

/// An estimator by its name, or all.
fn method(flag: &str, text: &str) -> Result<WantedMethod> {
    if text == "all" {
        return Ok(WantedMethod(None));
    }
    let named = FactorMethod::from_str(text.trim(), false);
    named.map(|method| WantedMethod(Some(method))).map_err(|_| {
        let names = super::values::names::<FactorMethod>().join(", ");
        let expected = format!("all, or one of {names}");
        usage(flag, &expected, text, "leave the flag out for all")
    })
}

/// A list of frames, or all.
fn some_frames(flag: &str, text: &str) -> Result<WantedFrames> {
    if text == "all" {
        return Ok(WantedFrames(None));
    }
    let FrameList(list) = frames(flag, text)?;
    Ok(WantedFrames(Some(list)))
}

impl FactorsArgs {
    /// The settings, what is asked for, and whether JSON is printed, and nothing.
    pub(super) fn filled(self) -> Result<(Settings, PairQuery, [bool; 2])> {
        let mut settings = Settings::new(self.scene);
        self.look.fill(&mut settings.scene);
        self.light.fill(&mut settings)?;
        settings.scene.frames = self.frames.map_or(Some(vec![0]), |frames| frames.0);
        let query = PairQuery {
            from: self.from,
            to: self.to,
            by: self.by.and_then(|by| by.0),
        };
        Ok((settings, query, [self.json, self.quiet]))
    }
}
