//! What a run tells whoever watches it, while it works.
//!
//! The renderer takes a `&(dyn Fn(Event) + Sync)` and calls it from any thread; what becomes of the events (a bar, a
//! line, nothing) is the watcher's affair, and nothing that it does reaches the result.

/// Something that has just happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<'a> {
    /// A new stage of the work began; the one before it is over.
    Stage {
        /// What is being done, e.g. `trace the back-buffer`.
        name: &'a str,
        /// How many steps it takes; 0 where that is not known.
        total: u64,
    },
    /// This many more steps of the stage are done.
    Advance(u64),
    /// A frame is on disk.
    Frame {
        /// How many frames of this run are done now, this one included.
        done: usize,
        /// How many frames the run has.
        total: usize,
        /// The frame's number.
        frame: u32,
        /// How long it took.
        seconds: f64,
        /// The share of all samples that were not asked again, 0 to 1.
        reused: f64,
    },
    /// Something the user should know, a whole sentence.
    Warning(&'a str),
}

/// Watch nothing.
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
