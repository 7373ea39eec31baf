//! Any bytes, as a scene: they load or are refused, and what loads can be posed.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../renderer/support/exercise.rs"]
mod exercise;

fuzz_target!(|content: &[u8]| {
    // Whether they load is not the question here.
    let _ = exercise::exercise(content.to_vec());
});
