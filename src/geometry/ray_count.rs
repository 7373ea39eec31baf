//! How many rays all threads have traced: for profiles.
//!
//! Each thread counts in a number of its own, which nobody else writes: so counting costs no more than an addition.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

static ALL: Mutex<Vec<Arc<AtomicU64>>> = Mutex::new(Vec::new());

thread_local! {
    static MINE: Arc<AtomicU64> = register();
}

fn register() -> Arc<AtomicU64> {
    let mine = Arc::new(AtomicU64::new(0));
    let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    all.push(mine.clone());
    mine
}

/// Counts a ray of this thread.
#[inline]
pub(super) fn count() {
    // A thread that ends counts no more.
    let _ = MINE.try_with(|mine| {
        mine.store(mine.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    });
}

/// Rays through trees of triangles that this process has traced so far; a ray through two trees counts twice.
pub fn rays() -> u64 {
    let all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    all.iter().map(|one| one.load(Ordering::Relaxed)).sum()
}
