//! The program: reads the command line, runs one command, exits with a code that says how it went.

use std::process::ExitCode;
use sweeplight::cli::args::{self, Command, Trial};
use sweeplight::cli::progress::Progress;
use sweeplight::error::Result;
use sweeplight::frames;
use sweeplight::frames::edit::Edits;
use sweeplight::report::json;
use sweeplight::report::table;
use sweeplight::settings::Settings;
use sweeplight::validate::{self, convergence, race};

fn main() -> ExitCode {
    let command = match args::parse(std::env::args_os()) {
        Ok(command) => command,
        Err(refusal) => {
            refusal.print();
            return ExitCode::from(refusal.exit_code());
        }
    };
    let done = match command {
        Command::Render(settings) => render(&settings),
        Command::Verify(settings) => verify(&settings),
        Command::Info(settings) => info(&settings),
        Command::Edit(settings, edits) => edit(&settings, &edits),
        Command::Validate { trial, json, quiet } => validate(trial, json, quiet),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn render(settings: &Settings) -> Result<()> {
    let progress = Progress::new(settings.quiet, settings.json);
    let report = frames::render(settings, &|event| progress.tell(event))?;
    progress.finish();
    if settings.json {
        print(&json(&report)?);
    } else if !settings.quiet {
        print(&table::table(&report));
    }
    Ok(())
}

fn verify(settings: &Settings) -> Result<()> {
    let progress = Progress::new(settings.quiet, settings.json);
    let lines = |line: &str| {
        if !settings.quiet && !settings.json {
            progress.line(line);
        }
    };
    let verified = frames::verify(settings, &|event| progress.tell(event), &lines)?;
    progress.finish();
    if settings.json {
        print(&json(&verified)?);
    } else {
        print(&verified.line());
    }
    verified.check()
}

fn info(settings: &Settings) -> Result<()> {
    let info = frames::info::info(settings)?;
    print(&if settings.json {
        json(&info)?
    } else {
        info.text()
    });
    Ok(())
}

fn edit(settings: &Settings, edits: &Edits) -> Result<()> {
    let progress = Progress::new(settings.quiet, settings.json || edits.is_pipe());
    let watch = |event: frames::Event<'_>| progress.tell(event);
    frames::edit::edit(settings, edits, &watch, &mut |line| {
        if edits.is_pipe() || !settings.quiet {
            progress.finish();
            print(line);
        }
    })
}

fn validate(trial: Trial, as_json: bool, quiet: bool) -> Result<()> {
    let progress = Progress::new(quiet, as_json);
    let watch = |event: frames::Event<'_>| progress.tell(event);
    let (text, data, done) = match trial {
        Trial::Answers => {
            let all = validate::validate(&watch)?;
            (all.text(), json(&all)?, all.check())
        }
        Trial::Race(seconds) => {
            let race = race::race(seconds, &watch);
            (race.text(), json(&race)?, race.check())
        }
        Trial::Convergence => {
            let curves = convergence::curves(&watch)?;
            (convergence::text(&curves), json(&curves)?, Ok(()))
        }
    };
    progress.finish();
    if as_json {
        print(&data);
    } else if !quiet {
        print(&text);
    }
    done
}

/// Prints to standard output; a reader that has gone away is no error.
fn print(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stdout(), "{}", text.trim_end());
}
