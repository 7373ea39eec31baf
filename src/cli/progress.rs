//! Progress as people and render farms read it: bars on a terminal, one fixed line a frame off it.
//!
//! Off a terminal a stage that takes long is told on standard error, after two seconds and then every ten.
//!
//! The line never changes its form: `Fra:12/120 Time:00:00.41 Remaining:00:44 Reused:93.1%` says that 12 of 120 frames
//! are done, that this one took 0.41 seconds, that the others will take 44 seconds at the mean of those done, and that
//! 93.1 % of its samples were not traced again. An hour or more remains as `1:02:03`.

use std::io::{self, IsTerminal, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::interrupt;
use crate::sequence::observer::Event;

/// The bar of the stage: it tells only of its own steps.
const STAGE: &str = "{msg:24!} {wide_bar} {percent:>3}%";

/// The spinner of a stage whose steps are not known.
const SPINNER: &str = "{msg:24!} {spinner} {elapsed}";

/// How long somebody off a terminal waits for the first word.
const FIRST_WORD: Duration = Duration::from_secs(2);

/// How long for each further one.
const PATIENCE: Duration = Duration::from_secs(10);

/// Between two turns of the spinner.
const TURN: Duration = Duration::from_millis(200);

/// The bar of the frames.
const FRAMES: &str = "frames {pos:>5}/{len:<5}       {wide_bar} {msg}";

/// Where the progress goes; any thread may tell it.
pub struct Progress {
    bars: Option<Bars>,
    lines: Option<Mutex<Box<dyn Write + Send>>>,
    /// How many frames were told, and how long they took together.
    spent: Mutex<(usize, f64)>,
    /// Off a terminal: what is told of long stages.
    words: Option<ProgressWords>,
    quiet: bool,
}

/// What is told off a terminal while a stage takes long.
struct ProgressWords {
    at: Arc<Mutex<At>>,
    /// Dropped, it ends the thread that speaks.
    _silence: mpsc::Sender<()>,
}

/// The stage at hand.
struct At {
    name: String,
    done: u64,
    total: u64,
    begun: Instant,
}

/// The two bars: all of the frames below the stage at hand.
struct Bars {
    both: MultiProgress,
    stage: ProgressBar,
    frames: ProgressBar,
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
            spent: Mutex::new((0, 0.0)),
            words,
            quiet,
        }
    }

    /// Lines only, to a place of one's own.
    pub fn lines_to(place: Box<dyn Write + Send>) -> Progress {
        Progress {
            bars: None,
            lines: Some(Mutex::new(place)),
            spent: Mutex::new((0, 0.0)),
            words: None,
            quiet: false,
        }
    }

    /// Tell an event; this is what the renderer's callback calls.
    pub fn tell(&self, event: Event) {
        match event {
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
        if let Some(Bars { stage, .. }) = &self.bars {
            stage.set_style(style(if total == 0 { SPINNER } else { STAGE }));
            stage.set_length(total);
            stage.set_position(0);
            stage.set_message(name.to_string());
            stage.reset_elapsed();
            stage.enable_steady_tick(TURN);
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
        let mut spent = self.spent.lock().unwrap_or_else(PoisonError::into_inner);
        *spent = (spent.0 + 1, spent.1 + seconds);
        let remaining = spent.1 / spent.0 as f64 * total.saturating_sub(done) as f64;

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
        match &self.bars {
            _ if self.quiet => {}
            Some(Bars { both, .. }) => both.suspend(|| eprintln!("{text}")),
            None => eprintln!("{text}"),
        }
    }

    /// The run is over, well or not: take the bars away.
    pub fn finish(&self) {
        if let Some(Bars {
            both,
            stage,
            frames,
        }) = &self.bars
        {
            stage.finish_and_clear();
            frames.finish_and_clear();
            let _ = both.clear();
        }
    }
}

impl Drop for Progress {
    /// An error that ends the run early takes the bars away as well.
    fn drop(&mut self) {
        self.finish();
    }
}

impl ProgressWords {
    /// Says where the work is after the first time, then again and again after the second, until it is dropped.
    fn every(
        [first, further]: [Duration; 2],
        say: impl Fn(&str) + Send + 'static,
    ) -> ProgressWords {
        let at = Arc::new(Mutex::new(At::now("start", 0)));
        let (silence, silenced) = mpsc::channel::<()>();
        let spoken = at.clone();
        std::thread::spawn(move || {
            let mut wait = first;
            while silenced.recv_timeout(wait) == Err(mpsc::RecvTimeoutError::Timeout) {
                wait = further;
                let text = spoken.lock().unwrap_or_else(PoisonError::into_inner).text();
                say(&text);
            }
        });
        ProgressWords {
            at,
            _silence: silence,
        }
    }

    fn at(&self) -> MutexGuard<'_, At> {
        self.at.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl At {
    fn now(name: &str, total: u64) -> At {
        At {
            name: name.into(),
            done: 0,
            total,
            begun: Instant::now(),
        }
    }

    /// `working: trace static hits, 12 %, for 01:20`
    fn text(&self) -> String {
        let done = match self.total {
            0 => String::new(),
            total => format!(", {} %", 100 * self.done / total),
        };
        let since = clock(self.begun.elapsed().as_secs_f64());
        format!("working: {}{done}, for {since}", self.name)
    }
}

impl Bars {
    /// Bars on standard error, still empty.
    fn new() -> Bars {
        let both = MultiProgress::with_draw_target(ProgressDrawTarget::stderr());
        let stage = both.add(ProgressBar::new(0).with_style(style(SPINNER)));
        let frames = both.add(ProgressBar::new(0).with_style(style(FRAMES)));
        Bars {
            both,
            stage,
            frames,
        }
    }
}

/// A bar's style; a template that indicatif does not take leaves its default bar.
fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
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

/// Seconds as `mm:ss`, or `h:mm:ss` from an hour on.
fn clock(seconds: f64) -> String {
    let seconds = seconds.round().max(0.0) as u64;
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if hours > 0 {
        format!("{hours}:{minutes:02}:{seconds:02}")
    } else {
        format!("{minutes:02}:{seconds:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A place that the test can read while it is written.
    #[derive(Clone, Default)]
    struct Paper(Arc<Mutex<Vec<u8>>>);

    impl Write for Paper {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().expect("a lock").write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

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
        let told = String::from_utf8(paper.0.lock().expect("a lock").clone()).expect("text");
        // The mean of the frames done is 3, 2 and 2 seconds.
        let expected = "Fra:1/4 Time:00:03.00 Remaining:00:09 Reused:50.0%\n\
                        Fra:2/4 Time:00:01.00 Remaining:00:04 Reused:50.0%\n\
                        Fra:3/4 Time:00:02.00 Remaining:00:02 Reused:50.0%\n";
        assert_eq!(told, expected);
    }

    #[test]
    fn off_a_terminal_a_long_stage_is_told_until_the_end() {
        let (told, heard) = mpsc::channel();
        let say = move |text: &str| drop(told.send(text.to_string()));
        let words = ProgressWords::every([Duration::from_millis(5); 2], say);
        *words.at() = At::now("trace static hits", 8);
        words.at().done += 2;
        let mut told = heard.iter().skip_while(|told| !told.contains("25 %"));
        assert_eq!(
            told.next().as_deref(),
            Some("working: trace static hits, 25 %, for 00:00")
        );
        *words.at() = At::now("cut patches", 0);
        let mut told = heard.iter().skip_while(|told| told.contains('%'));
        assert_eq!(
            told.next().as_deref(),
            Some("working: cut patches, for 00:00")
        );
        // The thread ends, and with it the channel.
        drop(words);
        assert!(heard.iter().count() < 1000);
    }

    #[test]
    fn quiet_has_no_place_to_tell() {
        let progress = Progress::new(true, false);
        assert!(progress.bars.is_none() && progress.lines.is_none());
        progress.tell(Event::Warning("nobody reads this"));
        progress.finish();
    }

    #[test]
    fn the_templates_are_taken() {
        for template in [STAGE, SPINNER, FRAMES] {
            assert!(ProgressStyle::with_template(template).is_ok(), "{template}");
        }
    }
}
