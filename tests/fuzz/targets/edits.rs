//! Any lines, as steps of edits: each is made or refused, and what was made is taken back.
#![no_main]

mod small;

use libfuzzer_sys::fuzz_target;
use std::cell::RefCell;
use sweeplight::sequence::{edit, silence};
use sweeplight::session::{Session, Step};

/// Most lines of an input.
const LINES: usize = 8;

/// Inputs after which a session is opened anew: what is removed for good leaves less and less to edit.
const INPUTS: u32 = 100;

/// Opens the scene.
fn open() -> Session {
    let folder = tempfile::tempdir().expect("a folder");
    let opened = edit::open(&small::settings(folder.path()), true, &silence);
    opened.expect("a scene that can be edited").0
}

thread_local! {
    static SESSION: RefCell<(Session, u32)> = RefCell::new((open(), 0));
}

fuzz_target!(|content: &str| {
    SESSION.with_borrow_mut(|(session, inputs)| {
        *inputs += 1;
        if inputs.is_multiple_of(INPUTS) {
            *session = open();
        }
        for line in content.lines().take(LINES) {
            if let Ok(step) = Step::parse(line) {
                let _ = session.apply(&step.edits);
            }
        }
        let undo = format!(r#"{{"edits": [{{"undo": {}}}]}}"#, session.undoable());
        if session.undoable() > 0 {
            let step = Step::parse(&undo).expect("a step");
            session.apply(&step.edits).expect("steps are taken back");
        }
    });
});
