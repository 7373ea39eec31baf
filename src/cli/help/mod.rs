//! `sweeplight help`: the reference by topics, each text a file beside this one.
//!
//! The texts are part of this documentation too: each topic below is the file that the program prints.

use clap::Command;

use crate::error::{Error, Result};
use crate::report::{json, schema};

/// Defines the topics: a module with the text as its documentation, and the row of the table.
macro_rules! topics {
    ($($module:ident $name:literal $file:literal $about:literal)*) => {
        $(
            #[doc = include_str!($file)]
            pub mod $module {}
        )*

        /// Every topic: its name, what it is about, and its text.
        pub const TOPICS: &[(&str, &str, &str)] = &[$(($name, $about, include_str!($file)),)*];
    };
}

topics! {
    image "image" "image.md" "names of image files, moving pictures, EXR layers, finishes"
    light "light" "light.md" "mesh, samples, solvers, memory: when to use which"
    estimators "estimators" "estimators.md" "estimators of form factors, and one form factor by all of them"
    methods "methods" "methods.md" "papers: what each does here, its flag, its test"
    units "units" "units.md" "units of light, lamps from Blender, sky and sun"
    report "report" "report.md" "columns of the table, keys of the JSON, units"
    edits "edits" "edits.md" "edits of a step, and the answer to it"
    live "live" "live.md" "the viewer in the browser, its messages, and exports of solved light"
    scenes "scenes" "scenes.md" "what is read of a glTF file, and its limits"
    exactness "exactness" "exactness.md" "what is exact, and how exact the rest is"
    farm "farm" "farm.md" "many machines: Slurm, GNU parallel, OpenJD, cache, claims, merge"
    progress "progress" "progress.md" "what a run would do, bars and lines, events as JSON"
    exit_codes "exit-codes" "exit-codes.md" "exit codes, and signals"
}

/// The topic that is computed: the JSON schema of the report.
const SCHEMA: &str = "report-schema";

/// The end of each command's help.
pub(super) const AFTER_COMMAND: &str = "More: sweeplight help TOPIC, of image, light, estimators, methods, units, report, edits, live, scenes, exactness, farm, progress, exit-codes.";

/// The end of the help of `edit`.
pub(super) const EDITS: &str = include_str!("edits.md");

/// The topics, a line each, as they stand beneath the commands.
pub(super) fn after_commands() -> String {
    let line = |(name, about, _): &(&str, &str, &str)| format!("  {name:<13} {about}\n");
    let lines: String = TOPICS.iter().map(line).collect();
    format!("Topics, by sweeplight help TOPIC:\n{lines}  {SCHEMA} JSON schema of the report\n")
}

/// The help of a command or a topic; without one, the list of both.
///
/// # Errors
/// [`Error::Usage`] where there is neither a command nor a topic of that name.
pub(super) fn help(wanted: Option<&str>, mut line: Command) -> Result<String> {
    line.build();
    let Some(wanted) = wanted else {
        return Ok(line.render_long_help().to_string());
    };
    if wanted == SCHEMA {
        return json(&schema::schema());
    }
    if let Some((_, _, text)) = TOPICS.iter().find(|(name, ..)| *name == wanted) {
        return Ok((*text).into());
    }
    if let Some(command) = line.find_subcommand_mut(wanted) {
        return Ok(command.render_long_help().to_string());
    }
    let commands = line.get_subcommands().map(Command::get_name);
    let topics = TOPICS.iter().map(|(name, ..)| *name).chain([SCHEMA]);
    let names: Vec<&str> = commands.chain(topics).collect();
    Err(Error::Usage {
        flag: "help".into(),
        expected: format!("one of {}", names.join(", ")),
        got: format!("'{wanted}'"),
        way_out: "write sweeplight help for the list".into(),
    })
}
