//! One policy for property tests: a fixed seed and as many cases as every run can pay; others on demand.
//!
//! `PROPTEST_CASES` sets another number of cases, `PROPTEST_RNG_SEED` another seed: a number, or `random`. A failure
//! shows its input, and no file remembers it: an input that once failed becomes a test of its own.

use proptest::test_runner::{Config, RngSeed};
use std::env;

/// The seed of every run that asks for no other.
const SEED: u64 = 1986;

/// Settings of a property test with a usual number of cases.
pub(crate) fn config(cases: u32) -> Config {
    let mut config = Config::default();
    if env::var_os("PROPTEST_CASES").is_none() {
        config.cases = cases;
    }
    if env::var_os("PROPTEST_RNG_SEED").is_none() {
        config.rng_seed = RngSeed::Fixed(SEED);
    }
    config.failure_persistence = None;
    config
}
