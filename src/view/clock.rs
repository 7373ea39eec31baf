//! The time of the clips: it stands, or goes on with the real one and begins anew at the end.

use std::time::Instant;

/// A clock over a clip.
pub(super) struct Clock {
    /// Length of the clip, in seconds.
    length: f64,
    /// The time when it was last set.
    from: f64,
    /// Since when it goes on from there; `None` while it stands.
    since: Option<Instant>,
}

impl Clock {
    /// A clock that stands at 0.
    pub(super) fn new(length: f64) -> Clock {
        Clock {
            length,
            from: 0.0,
            since: None,
        }
    }

    /// The time now.
    pub(super) fn seconds(&self) -> f64 {
        let passed = self
            .since
            .map_or(0.0, |since| since.elapsed().as_secs_f64());
        match self.length > 0.0 {
            true if self.since.is_some() => (self.from + passed) % self.length,
            true => self.from,
            false => 0.0,
        }
    }

    /// Lets it go on or stand. Without a clip it stands.
    pub(super) fn play(&mut self, on: bool) {
        self.from = self.seconds();
        self.since = (on && self.length > 0.0).then(Instant::now);
    }

    /// Sets it to a time, from 0 to the end.
    pub(super) fn seek(&mut self, seconds: f64) {
        self.from = if seconds.is_finite() {
            seconds.clamp(0.0, self.length)
        } else {
            0.0
        };
        self.since = self.since.map(|_| Instant::now());
    }

    /// Whether it goes on.
    pub(super) fn plays(&self) -> bool {
        self.since.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stands_within_the_clip_until_it_plays() {
        let mut clock = Clock::new(2.0);
        for (to, at) in [(1.5, 1.5), (9.0, 2.0), (-1.0, 0.0), (f64::NAN, 0.0)] {
            clock.seek(to);
            assert_eq!(clock.seconds(), at);
        }
        clock.play(true);
        assert!(clock.plays() && clock.seconds() < 2.0);
        let mut still = Clock::new(0.0);
        still.play(true);
        assert!(!still.plays());
        assert_eq!(still.seconds(), 0.0);
    }
}
