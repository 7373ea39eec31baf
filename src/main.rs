//! The program: reads the command line, runs one command, exits with a code that says how it went.

use std::io::{ErrorKind, Write};
use std::process::ExitCode;
use sweeplight::cli::args::{self, Command, Trial};
use sweeplight::cli::doctor;
use sweeplight::cli::interrupt;
use sweeplight::cli::live::{Greeting, open_browser};
use sweeplight::cli::output::Answer;
use sweeplight::cli::progress::Progress;
use sweeplight::cli::terminal::{plain, tell_error};
use sweeplight::compare::{self, PairQuery, methods};
use sweeplight::error::{Error, Result};
use sweeplight::export::{self, Export};
use sweeplight::io::file;
use sweeplight::report::json;
use sweeplight::report::page::gallery::is_page;
use sweeplight::report::profile_table;
use sweeplight::report::table;
use sweeplight::sequence;
use sweeplight::sequence::cache::shelf::{self, Prune};
use sweeplight::sequence::edit::Edits;
use sweeplight::settings::Settings;
use sweeplight::validate::{self, convergence, figure_page, race};
use sweeplight::view::{self, Notice, Viewer};

fn main() -> ExitCode {
    interrupt::listen();
    let command = match args::parse(std::env::args_os()) {
        Ok(command) => command,
        Err(refusal) => {
            return ExitCode::from(refusal.print());
        }
    };
    let done = match command {
        Command::Render(settings, answer) => render(&settings, answer),
        Command::Verify(settings, answer) => verify(&settings, answer),
        Command::Info(settings, answer) => info(&settings, answer),
        Command::Edit(settings, edits, answer) => edit(&settings, &edits, answer),
        Command::View(settings, viewer, greeting) => view(&settings, &viewer, greeting),
        Command::Export(settings, wanted, answer) => export(&settings, &wanted, answer),
        Command::Factors(settings, query, answer) => factors(&settings, &query, answer),
        Command::Merge(parts) => sequence::merge::merge(&parts).and_then(|told| show(&told)),
        Command::Cache(wanted, answer) => cache(&wanted, answer),
        Command::Validate(trial, answer) => validate(trial, answer),
        Command::Blender(install) => install.write().and_then(|told| show(&told)),
        Command::Doctor(answer) => examine(answer),
        Command::Help(text) => print(&text),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tell_error(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

fn render(settings: &Settings, answer: Answer) -> Result<()> {
    if answer.dry_run {
        return plan(settings, answer);
    }
    let progress = Progress::of("render", &settings.scene.file, answer);
    let report = sequence::render(settings, &|event| progress.tell(event));
    progress.end(report.as_ref().err());
    let report = report?;
    if answer.json {
        print(&json(&report)?)?;
    } else if !answer.quiet && !answer.events {
        show(&table::table(&report))?;
        if answer.profile {
            show(&profile_table::text(&report.profile))?;
        }
    }
    report.check()
}

fn plan(settings: &Settings, answer: Answer) -> Result<()> {
    let progress = Progress::new(answer.quiet, true);
    let plan = sequence::plan::plan(settings, &|event| progress.tell(event));
    progress.finish();
    let plan = plan?;
    match answer.json {
        true => print(&json(&plan)?),
        false => show(&plan.text()),
    }
}

fn verify(settings: &Settings, answer: Answer) -> Result<()> {
    let progress = Progress::of("verify", &settings.scene.file, answer);
    let lines = |line: &str| {
        if !answer.quiet && !answer.json && !answer.events {
            progress.line(line);
        }
    };
    let verified = sequence::verify(settings, &|event| progress.tell(event), &lines);
    let checked = verified.as_ref().map(|verified| verified.check());
    progress.end(match &checked {
        Ok(checked) => checked.as_ref().err(),
        Err(error) => Some(error),
    });
    let verified = verified?;
    if answer.json {
        print(&json(&verified)?)?;
    } else if !answer.events {
        show(&verified.line())?;
    }
    verified.check()
}

fn info(settings: &Settings, answer: Answer) -> Result<()> {
    let progress = Progress::new(answer.quiet, true);
    progress.stage("look into the scene", 0);
    let info = sequence::info::info(settings)?;
    progress.finish();
    match answer.json {
        true => print(&json(&info)?),
        false => show(&info.text()),
    }
}

fn examine(answer: Answer) -> Result<()> {
    let machine = doctor::machine();
    match answer.json {
        true => print(&json(&machine)?),
        false => show(&machine.text()),
    }
}

fn cache(wanted: &Prune, answer: Answer) -> Result<()> {
    let shelf = shelf::prune(wanted)?;
    match answer.json {
        true => print(&json(&shelf)?),
        false => show(&shelf.text()),
    }
}

fn edit(settings: &Settings, edits: &Edits, answer: Answer) -> Result<()> {
    let progress = Progress::new(answer.quiet, answer.json || edits.is_pipe());
    let watch = |event: sequence::Event<'_>| progress.tell(event);
    sequence::edit::edit(settings, edits, &watch, &mut |line| {
        if !edits.is_pipe() && answer.quiet {
            return Ok(());
        }
        progress.finish();
        match edits.is_pipe() || answer.json {
            true => write(line),
            false => write(&plain(line)),
        }
    })
}

fn view(settings: &Settings, viewer: &Viewer, greeting: Greeting) -> Result<()> {
    let progress = Progress::new(greeting.quiet, false);
    let watch = |event: sequence::Event<'_>| progress.tell(event);
    view::view(settings, viewer, &watch, &|notice| match notice {
        Notice::Address(address) => {
            print(address)?;
            if greeting.open {
                open_browser(address);
            }
            Ok(())
        }
        Notice::Ready => {
            progress.finish();
            Ok(())
        }
    })
}

fn export(settings: &Settings, wanted: &Export, answer: Answer) -> Result<()> {
    let progress = Progress::new(answer.quiet, false);
    let told = export::export(settings, wanted, &|event| progress.tell(event))?;
    progress.finish();
    if answer.quiet {
        return Ok(());
    }
    show(&told)
}

fn factors(settings: &Settings, query: &PairQuery, answer: Answer) -> Result<()> {
    let progress = Progress::new(answer.quiet, answer.json);
    let found = compare::factors(settings, query, &|event| progress.tell(event));
    progress.finish();
    let found = found?;
    if answer.quiet {
        return Ok(());
    }
    match answer.json {
        true => print(&json(&found)?),
        false => show(&found.text()),
    }
}

fn validate(trial: Trial, answer: Answer) -> Result<()> {
    let progress = Progress::new(answer.quiet, answer.json);
    let watch = |event: sequence::Event<'_>| progress.tell(event);
    let (text, data, done) = match trial {
        Trial::Answers => {
            let all = validate::validate(&watch)?;
            (all.text(), json(&all)?, all.check())
        }
        Trial::Race(seconds) => {
            let race = race::race(seconds, &watch);
            (race.text(), json(&race)?, race.check())
        }
        Trial::Compare(scene, elements) => {
            let mut settings = Settings::new(scene);
            settings.solve.elements = elements;
            let table = methods::methods(&settings, &watch)?;
            (table.text(), json(&table)?, Ok(()))
        }
        Trial::Convergence(reports) => {
            let courses = convergence::courses(&watch)?;
            let data = json(&courses)?;
            for path in &reports {
                let text = match is_page(path) {
                    true => figure_page::page(&courses.figure_16, &courses.estimators)?,
                    false => data.clone(),
                };
                file::replace(path, text.as_bytes())?;
            }
            (courses.text(), data, Ok(()))
        }
    };
    progress.finish();
    if answer.json {
        print(&data)?;
    } else if !answer.quiet {
        show(&text)?;
    }
    done
}

/// Prints a text for people.
fn show(text: &str) -> Result<()> {
    print(&plain(text))
}

/// Prints to standard output; a reader that has gone away is no error.
fn print(text: &str) -> Result<()> {
    match write(text) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::printed(&error)),
        _ => Ok(()),
    }
}

/// Writes to standard output, to the last byte.
fn write(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", text.trim_end())?;
    out.flush()
}
