//! The pool of threads that a run works in.

use crate::error::{Error, Result};

/// Runs the work in a pool of its own where a number of threads is asked for.
pub fn in_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let Some(threads) = threads else {
        return Ok(work());
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Error::Usage {
            flag: "--threads".into(),
            expected: "a number of threads the system can start".into(),
            got: format!("{threads} ({error})"),
            way_out: "give a smaller number, or none for all cores".into(),
        })?;
    Ok(pool.install(work))
}
