//! SIGINT and SIGTERM: one line, no half-made file, and the exit code that shells expect, 128 + the signal.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Frames that are complete, and all of the run.
static DONE: [AtomicUsize; 2] = [AtomicUsize::new(0), AtomicUsize::new(0)];

/// So many frames of a run are complete.
pub fn complete(done: usize, total: usize) {
    DONE[0].store(done, Ordering::Relaxed);
    DONE[1].store(total, Ordering::Relaxed);
}

/// Waits for the signals in a thread of its own.
#[cfg(unix)]
pub fn listen() {
    use signal_hook::consts::{SIGINT, SIGTERM, signal::SIGXFSZ};
    use std::sync::Arc;
    // A file that grows beyond the limit of the shell is an error of writing, not the end.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::default());
    // Without the thread a signal ends the program as it does any other.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else {
        return;
    };
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            crate::io::part::abandon();
            let name = if signal == SIGINT {
                "SIGINT"
            } else {
                "SIGTERM"
            };
            let [done, total] = DONE.each_ref().map(|count| count.load(Ordering::Relaxed));
            eprintln!("{}", words(name, done, total));
            std::process::exit(128 + signal);
        }
    });
}

/// Elsewhere the system ends the program.
#[cfg(not(unix))]
pub fn listen() {}

/// The line.
fn words(signal: &str, done: usize, total: usize) -> String {
    let kept = match total {
        0 => "files that are complete stay".to_string(),
        _ => format!("{done} of {total} frames are complete and stay"),
    };
    format!("interrupted by {signal}: {kept}, partial files are removed")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_there() {
        let told = words("SIGINT", 3, 9);
        assert_eq!(
            told,
            "interrupted by SIGINT: 3 of 9 frames are complete and stay, partial files are removed"
        );
        assert!(words("SIGTERM", 0, 0).contains("files that are complete stay"));
    }
}
