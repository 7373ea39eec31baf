//! Events of a run as JSON, an object on a line each: for queues, farms and other programs.
//!
//! The schema is described in `sweeplight help progress`; keys are only ever added under one schema name.

use std::io::Write;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::pace::MeanPace;
use crate::error::Error;
use crate::sequence::observer::Event;

/// The name of the schema.
const SCHEMA: &str = "sweeplight-progress-1";

/// Steps of a stage are told at most once in this time.
const BETWEEN: Duration = Duration::from_millis(250);

/// What is told in a line.
#[derive(Debug, Serialize)]
#[serde(tag = "event", rename_all = "lowercase")]
enum RunEvent<'a> {
    Started {
        schema: &'static str,
        version: &'static str,
        command: &'a str,
        scene: String,
    },
    Stage {
        name: &'a str,
        total: u64,
    },
    Steps {
        name: &'a str,
        done: u64,
        total: u64,
    },
    Prepared {
        seconds: f64,
        frames: usize,
    },
    Kept {
        kept: usize,
        total: usize,
        checked: bool,
    },
    Frame {
        frame: u32,
        done: usize,
        total: usize,
        seconds: f64,
        saving: f64,
        remaining_seconds: f64,
    },
    Warning {
        text: &'a str,
    },
    Finished {
        exit_code: u8,
        frames: usize,
        #[serde(skip_serializing_if = "Option::is_none")]
        error: Option<String>,
    },
}

/// A line: what is told, and the seconds since the start.
#[derive(Serialize)]
struct EventLine<'a> {
    #[serde(flatten)]
    record: RunEvent<'a>,
    at: f64,
}

/// Where events go, and what was told.
pub(super) struct Events(Mutex<EventLog>);

struct EventLog {
    place: Box<dyn Write + Send>,
    begun: Instant,
    stage: String,
    done: u64,
    total: u64,
    last: Instant,
    pace: MeanPace,
}

impl Events {
    /// Events to a place; the first tells of the command.
    pub(super) fn to(place: Box<dyn Write + Send>, command: &str, scene: String) -> Events {
        let begun = Instant::now();
        let mut told = EventLog {
            place,
            begun,
            stage: String::new(),
            done: 0,
            total: 0,
            last: begun,
            pace: MeanPace::default(),
        };
        told.write(RunEvent::Started {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            command,
            scene,
        });
        Events(Mutex::new(told))
    }

    /// Tells an event.
    pub(super) fn tell(&self, event: Event) {
        let mut told = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            Event::Stage { name, total } => told.stage(name, total),
            Event::Advance(steps) => told.advance(steps),
            Event::Prepared { seconds, frames } => {
                told.write(RunEvent::Prepared { seconds, frames });
            }
            Event::Kept { kept, total, known } => told.write(RunEvent::Kept {
                kept,
                total,
                checked: known,
            }),
            Event::Warning(text) => told.write(RunEvent::Warning { text }),
            Event::Frame {
                done,
                total,
                frame,
                seconds,
                reused,
            } => {
                let remaining_seconds = told.pace.remaining(seconds, total.saturating_sub(done));
                told.write(RunEvent::Frame {
                    frame,
                    done,
                    total,
                    seconds,
                    saving: reused,
                    remaining_seconds,
                });
            }
        }
    }

    /// Tells the end.
    pub(super) fn end(&self, error: Option<&Error>) {
        let mut told = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let frames = told.pace.frames;
        told.write(RunEvent::Finished {
            exit_code: error.map_or(0, Error::exit_code),
            frames,
            error: error.map(Error::to_string),
        });
    }
}

impl EventLog {
    fn stage(&mut self, name: &str, total: u64) {
        (self.stage, self.done, self.total) = (name.into(), 0, total);
        self.last = Instant::now();
        self.write(RunEvent::Stage { name, total });
    }

    fn advance(&mut self, steps: u64) {
        self.done += steps;
        if self.last.elapsed() < BETWEEN && self.done < self.total {
            return;
        }
        self.last = Instant::now();
        let (name, done, total) = (std::mem::take(&mut self.stage), self.done, self.total);
        self.write(RunEvent::Steps {
            name: &name,
            done,
            total,
        });
        self.stage = name;
    }

    /// Writes a line; it goes on if nobody listens any more.
    fn write(&mut self, record: RunEvent) {
        let at = self.begun.elapsed().as_secs_f64();
        if let Ok(text) = serde_json::to_string(&EventLine { record, at }) {
            let _ = writeln!(self.place, "{text}").and_then(|()| self.place.flush());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::progress::paper::Paper;
    use serde_json::Value;

    #[test]
    fn every_event_is_an_object_on_a_line() {
        let sheet = Paper::default();
        let events = Events::to(Box::new(sheet.clone()), "render", "a\nb.glb".into());
        events.tell(Event::Stage {
            name: "trace",
            total: 1000,
        });
        // Steps in quick succession are told once, at the end of the stage.
        (0..1000).for_each(|_| events.tell(Event::Advance(1)));
        events.tell(Event::Warning("two\nlines"));
        for (done, seconds) in [(1, 3.0), (2, 1.0)] {
            events.tell(Event::Frame {
                done,
                total: 4,
                frame: 7 * done as u32,
                seconds,
                reused: 0.5,
            });
        }
        events.end(None);
        let text = sheet.text();
        let lines: Vec<Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).expect("JSON"))
            .collect();
        let of = |event: &'static str| lines.iter().filter(move |l| l["event"] == event);
        assert_eq!(lines[0]["event"], "started");
        assert_eq!(lines[0]["scene"], "a\nb.glb");
        assert!((1..=3).contains(&of("steps").count()));
        assert_eq!(of("steps").next_back().expect("a line")["done"], 1000);
        assert_eq!(of("warning").count(), 1);
        // The mean of 3 s and 1 s for two more frames.
        assert_eq!(
            of("frame").next_back().expect("a line")["remaining_seconds"],
            4.0
        );
        assert_eq!(lines.last().expect("a line")["exit_code"], 0);
        assert!(
            lines
                .iter()
                .all(|l| l["at"].as_f64().is_some_and(|at| at >= 0.0))
        );
    }
}
