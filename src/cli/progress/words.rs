//! What is told off a terminal while a stage takes long: on standard error, after two seconds and then every ten.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::time::{Duration, Instant};

/// How long somebody off a terminal waits for the first word.
pub(super) const FIRST_WORD: Duration = Duration::from_secs(2);

/// How long for each further one.
pub(super) const PATIENCE: Duration = Duration::from_secs(10);

/// What is told off a terminal while a stage takes long.
pub(super) struct ProgressWords {
    at: Arc<Mutex<At>>,
    /// Dropped, it ends the thread that speaks.
    _silence: mpsc::Sender<()>,
}

/// The stage at hand.
pub(super) struct At {
    name: String,
    pub(super) done: u64,
    total: u64,
    begun: Instant,
}

impl ProgressWords {
    /// Says where the work is after the first time, then again and again after the second, until it is dropped.
    pub(super) fn every(
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

    pub(super) fn at(&self) -> MutexGuard<'_, At> {
        self.at.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl At {
    pub(super) fn now(name: &str, total: u64) -> At {
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

/// Seconds as `mm:ss`, or `h:mm:ss` from an hour on.
pub(super) fn clock(seconds: f64) -> String {
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
}
