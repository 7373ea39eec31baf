//! Any words, as a command line: they are read or refused. Words are parted by bytes of 0.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt;
use sweeplight::cli::args::parse;

fuzz_target!(|content: &[u8]| {
    let words = content.split(|byte| *byte == 0);
    let words: Vec<OsString> = words.map(|word| OsStr::from_bytes(word).into()).collect();
    // The manual is written into the folder that is named.
    if words.iter().all(|word| word != "man") {
        let name = std::iter::once("sweeplight".into());
        let _ = parse(name.chain(words));
    }
});
