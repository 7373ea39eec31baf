//! Progress as people and render farms read it: bars on a terminal, one fixed line a frame off it.
//!
//! Off a terminal a stage that takes long is told on standard error, after two seconds and then every ten.
//!
//! The line never changes its form: `Fra:12/120 Time:00:00.41 Remaining:00:44 Reused:93.1%` says that 12 of 120 frames
//! are done, that this one took 0.41 seconds, that the others will take 44 seconds at the mean of those done, and that
//! 93.1 % of its samples were not traced again. An hour or more remains as `1:02:03`.
//!
//! With `--progress json` each event is a JSON object on a line of its own instead: see `sweeplight help progress`.

mod bars;
mod events;
mod pace;
#[cfg(test)]
mod paper;
mod words;

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use bars::Bars;
use events::Events;
use pace::MeanPace;
use words::{At, FIRST_WORD, PATIENCE, ProgressWords, clock};

use crate::cli::interrupt;
use crate::cli::output::Answer;
use crate::cli::terminal::plain;
use crate::error::Error;
use crate::sequence::observer::Event;

/// Where the progress goes; any thread may tell it.
pub struct Progress {
    bars: Option<Bars>,
    lines: Option<Mutex<Box<dyn Write + Send>>>,
    pace: Mutex<MeanPace>,
    /// Off a terminal: what is told of long stages.
    words: Option<ProgressWords>,
    quiet: bool,
    /// With `--progress json`, where events go; nothing else is told then.
    events: Option<Events>,
}

impl Progress {
    /// Progress for this process: bars if standard error is a terminal, lines on standard output if it is none.
    ///
    /// With `json` standard output belongs to the JSON, and lines go to standard error if that is no terminal. With
    /// `quiet` nothing is told at all, not even a warning.
    pub fn new(quiet: bool, json: bool) -> Progress {
        let (screen, piped) = (io::stderr().is_terminal(), !io::stdout().is_terminal());
        let bars = (!quiet && screen).then(Bars::new);
        let lines: Option<Box<dyn Write + Send>> = match (quiet, json) {
            (false, false) if piped || !screen => Some(Box::new(io::stdout())),
            (false, true) if !screen => Some(Box::new(io::stderr())),
            _ => None,
        };
        let words = (!quiet && bars.is_none())
            .then(|| ProgressWords::every([FIRST_WORD, PATIENCE], |text| eprintln!("{text}")));
        Progress {
            bars,
            lines: lines.map(Mutex::new),
            pace: Mutex::default(),
            words,
            quiet,
            events: None,
        }
    }

    /// Lines only, to a place of one's own.
    pub fn lines_to(place: Box<dyn Write + Send>) -> Progress {
        Progress {
            bars: None,
            lines: Some(Mutex::new(place)),
            pace: Mutex::default(),
            words: None,
            quiet: false,
            events: None,
        }
    }

    /// Progress of a command on a scene, as the flags of its answer ask.
    ///
    /// Events go to standard output, and to standard error where that belongs to the JSON of the report.
    pub fn of(command: &str, scene: &Path, answer: Answer) -> Progress {
        if !answer.events {
            return Progress::new(answer.quiet, answer.json);
        }
        let place: Box<dyn Write + Send> = match answer.json {
            true => Box::new(io::stderr()),
            false => Box::new(io::stdout()),
        };
        let mut progress = Progress::new(true, answer.json);
        progress.events = Some(Events::to(place, command, scene.display().to_string()));
        progress
    }

    /// Tell an event; this is what the renderer's callback calls.
    pub fn tell(&self, event: Event) {
        if let Some(events) = &self.events {
            if let Event::Frame { done, total, .. } = event {
                interrupt::complete(done, total);
            }
            return events.tell(event);
        }
        match event {
            Event::Prepared { .. } => {}
            Event::Stage { name, total } => self.stage(name, total),
            Event::Advance(steps) => self.advance(steps),
            Event::Frame {
                done,
                total,
                frame,
                seconds,
                reused,
            } => {
                self.frame_done(done, total, frame, seconds, reused);
            }
            Event::Kept { kept, total, known } => {
                let state = if known {
                    "are up to date"
                } else {
                    "are there and stay"
                };
                self.say(&format!("{kept} of {total} frames {state}"));
            }
            Event::Warning(text) => self.warn(text),
        }
    }

    /// A stage of so many steps begins; 0 where their number is not known.
    pub fn stage(&self, name: &str, total: u64) {
        if let Some(bars) = &self.bars {
            bars.begin(name, total);
        }
        if let Some(words) = &self.words {
            *words.at() = At::now(name, total);
        }
    }

    /// So many more steps of the stage are done.
    pub fn advance(&self, steps: u64) {
        if let Some(Bars { stage, .. }) = &self.bars {
            stage.inc(steps);
        }
        if let Some(words) = &self.words {
            words.at().done += steps;
        }
    }

    /// A frame is on disk, the `done`-th of `total` in this run; `reused` is a share from 0 to 1.
    pub fn frame_done(&self, done: usize, total: usize, frame: u32, seconds: f64, reused: f64) {
        interrupt::complete(done, total);

        // Estimate what remains by the mean of the frames so far.
        let mut pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        let remaining = pace.remaining(seconds, total.saturating_sub(done));

        // Tell it, and go on if nobody listens any more.
        if let Some(lines) = &self.lines {
            let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
            let line = line(done, total, seconds, remaining, reused);
            let _ = writeln!(lines, "{line}").and_then(|()| lines.flush());
        }
        if let Some(Bars { frames, .. }) = &self.bars {
            frames.set_length(total as u64);
            frames.set_position(done as u64);
            let (reused, remaining) = (100.0 * reused, clock(remaining));
            frames.set_message(format!(
                "frame {frame}: {seconds:.2} s, {reused:.1}% reused; {remaining} left"
            ));
        }
    }

    /// A line of its own, on standard output, above the bars.
    pub fn line(&self, text: &str) {
        let text = plain(text);
        let print = || drop(writeln!(io::stdout(), "{text}"));
        match &self.bars {
            Some(Bars { both, .. }) => both.suspend(print),
            None => print(),
        }
    }

    /// Something the user should know, on standard error.
    pub fn warn(&self, text: &str) {
        self.say(&format!("warning: {text}"));
    }

    /// A line on standard error, above the bars.
    fn say(&self, text: &str) {
        let text = plain(text);
        match &self.bars {
            _ if self.quiet => {}
            Some(Bars { both, .. }) => both.suspend(|| eprintln!("{text}")),
            None => eprintln!("{text}"),
        }
    }

    /// The run is over, well or not: take the bars away.
    pub fn finish(&self) {
        if let Some(bars) = &self.bars {
            bars.finish();
        }
    }
}

impl Progress {
    /// The run is over, well or by an error.
    pub fn end(&self, error: Option<&Error>) {
        self.finish();
        if let Some(events) = &self.events {
            events.end(error);
        }
    }
}

impl Drop for Progress {
    /// An error that ends the run early takes the bars away as well.
    fn drop(&mut self) {
        self.finish();
    }
}

/// The line of a frame, without its end.
fn line(done: usize, total: usize, seconds: f64, remaining: f64, reused: f64) -> String {
    let hundredths = (100.0 * seconds).round().max(0.0) as u64;
    let (minutes, seconds, hundredths) =
        (hundredths / 6000, hundredths / 100 % 60, hundredths % 100);
    let (remaining, reused) = (clock(remaining), 100.0 * reused);
    format!(
        "Fra:{done}/{total} Time:{minutes:02}:{seconds:02}.{hundredths:02} Remaining:{remaining} Reused:{reused:.1}%"
    )
}

#[cfg(test)]
mod tests {
    use super::paper::Paper;
    use super::*;

    #[test]
    fn the_line_is_fixed() {
        let told = line(12, 120, 0.41, 44.28, 0.9314);
        assert_eq!(
            told,
            "Fra:12/120 Time:00:00.41 Remaining:00:44 Reused:93.1%"
        );
        let slow = line(1, 2, 754.996, 3723.0, 0.0);
        assert_eq!(slow, "Fra:1/2 Time:12:35.00 Remaining:1:02:03 Reused:0.0%");
        assert_eq!(
            line(2, 2, 59.999, 0.0, 1.0),
            "Fra:2/2 Time:01:00.00 Remaining:00:00 Reused:100.0%"
        );
    }

    #[test]
    fn a_clock_carries_over() {
        assert_eq!(
            [59.4, 59.6, 3599.4, 3599.6, 36_000.0].map(clock),
            ["00:59", "01:00", "59:59", "1:00:00", "10:00:00"]
        );
        assert_eq!(clock(f64::NAN), "00:00");
    }

    #[test]
    fn off_a_terminal_each_frame_is_one_line_and_nothing_else_is_told() {
        let paper = Paper::default();
        let progress = Progress::lines_to(Box::new(paper.clone()));
        progress.tell(Event::Stage {
            name: "trace",
            total: 7,
        });
        progress.tell(Event::Advance(7));
        for (done, seconds) in [(1, 3.0), (2, 1.0), (3, 2.0)] {
            progress.tell(Event::Frame {
                done,
                total: 4,
                frame: 100,
                seconds,
                reused: 0.5,
            });
        }
        progress.finish();
        let told = paper.text();
        // The mean of the frames done is 3, 2 and 2 seconds.
        let expected = "Fra:1/4 Time:00:03.00 Remaining:00:09 Reused:50.0%\n\
                        Fra:2/4 Time:00:01.00 Remaining:00:04 Reused:50.0%\n\
                        Fra:3/4 Time:00:02.00 Remaining:00:02 Reused:50.0%\n";
        assert_eq!(told, expected);
    }

    #[test]
    fn quiet_has_no_place_to_tell() {
        let progress = Progress::new(true, false);
        assert!(progress.bars.is_none() && progress.lines.is_none());
        progress.tell(Event::Warning("nobody reads this"));
        progress.finish();
    }
}
