//! Events of a run, for a progress bar or a log.
//!
//! The renderer takes a `&(dyn Fn(Event) + Sync)` and calls it from any thread; no event changes the result.

/// An event of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<'a> {
    /// A new stage of the work began; the one before it is over.
    Stage {
        /// Name, e.g. `trace the back-buffer`.
        name: &'a str,
        /// Number of its steps; 0 where that is not known.
        total: u64,
    },
    /// This many more steps of the stage are done.
    Advance(u64),
    /// All that is done once is done.
    Prepared {
        /// Seconds that it took.
        seconds: f64,
        /// Number of frames to come.
        frames: usize,
    },
    /// A frame is on disk.
    Frame {
        /// Number of frames done, this one included.
        done: usize,
        /// Number of frames of the run.
        total: usize,
        /// The frame's number.
        frame: u32,
        /// Seconds that it took.
        seconds: f64,
        /// Share of all samples that were not traced again, 0 to 1.
        reused: f64,
    },
    /// Frames of an earlier run stay, and are not rendered again.
    Kept {
        /// Number of frames that stay.
        kept: usize,
        /// Number of frames that were asked for.
        total: usize,
        /// Whether they were found to be up to date, and not kept unseen.
        known: bool,
    },
    /// A warning to the user, a whole sentence.
    Warning(&'a str),
}

/// Ignores every event.
pub fn silence(_: Event) {}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    #[test]
    fn any_function_that_threads_may_share_can_watch() {
        let steps = AtomicU64::new(0);
        let count = |event: Event| {
            if let Event::Advance(more) = event {
                steps.fetch_add(more, Ordering::Relaxed);
            }
        };
        let watchers: [&(dyn Fn(Event) + Sync); 2] = [&count, &silence];
        for watch in watchers {
            watch(Event::Stage {
                name: "trace",
                total: 5,
            });
            watch(Event::Advance(2));
            watch(Event::Advance(3));
        }
        assert_eq!(steps.into_inner(), 5);
    }
}
