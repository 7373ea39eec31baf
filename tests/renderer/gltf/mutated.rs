//! Valid files changed at random, byte by byte and value by value: each is read, or refused by name with a way out.

use crate::support::all_features::{glb, rich};
use crate::support::damage::{places, put};
use crate::support::exercise::exercise;
use crate::support::property;
use proptest::prelude::*;
use serde_json::{Value, json};

/// A change to the bytes of a file; places are shares of its length.
#[derive(Clone, Debug)]
enum Change {
    Flip(f64, u8),
    Set(f64, u32),
    Cut(f64),
    Remove(f64, usize),
    Insert(f64, Vec<u8>),
    Repeat(f64, usize),
}

fn change() -> impl Strategy<Value = Change> {
    let place = || 0.0..1.0;
    let words = [
        0,
        1,
        0x7fff_ffff,
        0x8000_0000,
        u32::MAX,
        0x7fc0_0000,
        0x7f80_0000,
        0x0000_0001,
    ];
    prop_oneof![
        (place(), 0..8_u8).prop_map(|(at, bit)| Change::Flip(at, bit)),
        (place(), prop::sample::select(words.to_vec()))
            .prop_map(|(at, word)| Change::Set(at, word)),
        place().prop_map(Change::Cut),
        (place(), 1..64_usize).prop_map(|(at, length)| Change::Remove(at, length)),
        (place(), prop::collection::vec(any::<u8>(), 1..16))
            .prop_map(|(at, new)| Change::Insert(at, new)),
        (place(), 1..256_usize).prop_map(|(at, length)| Change::Repeat(at, length)),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    let place = |at: &f64| (bytes.len() as f64 * at) as usize;
    let end = |at: usize, length: usize| (at + length).min(bytes.len());
    match change {
        Change::Flip(at, bit) => {
            let at = place(at);
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << bit;
            }
        }
        Change::Set(at, word) => {
            let at = place(at) / 4 * 4;
            for (byte, new) in bytes.iter_mut().skip(at).zip(word.to_le_bytes()) {
                *byte = new;
            }
        }
        Change::Cut(at) => bytes.truncate(place(at)),
        Change::Remove(at, length) => {
            let at = place(at);
            bytes.drain(at..end(at, *length));
        }
        Change::Insert(at, new) => {
            let at = place(at);
            bytes.splice(at..at, new.iter().copied());
        }
        Change::Repeat(at, length) => {
            let at = place(at);
            let again = bytes[at..end(at, *length)].to_vec();
            bytes.splice(at..at, again);
        }
    }
}

/// Values that files hold where they should not.
fn wild() -> impl Strategy<Value = Option<Value>> {
    let numbers = [
        -1.0,
        0.5,
        1e-45,
        1e38,
        -1e38,
        1e39,
        1e300,
        4_294_967_296.0,
        9.3e18,
    ];
    prop_oneof![
        Just(None),
        (0..40_u64).prop_map(|number| Some(json!(number))),
        prop::sample::select(numbers.to_vec()).prop_map(|number| Some(json!(number))),
        prop::sample::select(vec![
            json!(null),
            json!([]),
            json!({}),
            json!(""),
            json!(u64::MAX),
            json!(true)
        ])
        .prop_map(Some),
        prop::collection::vec(prop::sample::select(numbers.to_vec()), 1..17)
            .prop_map(|numbers| Some(json!(numbers))),
    ]
}

/// Insists that a file is either read and can be posed, or refused as every broken file is: by name, with a way out.
/// A file that is read without end ends no run.
fn read_or_refused(content: Vec<u8>) {
    let Err(error) = exercise(content) else {
        return;
    };
    let told = error.to_string();
    assert!((1..=6).contains(&error.exit_code()), "{told}");
    assert!(told.contains(" — "), "no way out: {told}");
    assert_eq!(told.lines().count(), 1, "{told}");
}

/// Cases of each test here: a case takes a millisecond.
const CASES: u32 = 2000;

proptest! {
    #![proptest_config(property::config(CASES))]

    #[test]
    fn changed_bytes_never_panic(changes in prop::collection::vec(change(), 1..4)) {
        let mut bytes = rich().glb();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        read_or_refused(bytes);
    }

    /// The same with whole chunks around the changed content, so that the damage gets past the container.
    #[test]
    fn changed_text_and_buffers_never_panic(
        text in prop::collection::vec(change(), 0..2),
        buffers in prop::collection::vec(change(), 0..3),
    ) {
        let whole = rich();
        let (mut json, mut bytes) = (whole.json.to_string().into_bytes(), whole.bytes);
        text.iter().for_each(|change| apply(&mut json, change));
        buffers.iter().for_each(|change| apply(&mut bytes, change));
        read_or_refused(glb(&json, &bytes));
    }

    #[test]
    fn changed_values_never_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), wild()), 1..4)) {
        let mut file = rich();
        for (place, value) in changes {
            let places = places(&file.json);
            put(&mut file.json, &places[place.index(places.len())], value);
        }
        read_or_refused(file.glb());
    }

    /// Two parts of the file change places: what is right for one is nearly right for the other.
    #[test]
    fn exchanged_values_never_panic(first in any::<prop::sample::Index>(), second in any::<prop::sample::Index>()) {
        let mut file = rich();
        let places = places(&file.json);
        let [first, second] = [first, second].map(|place| &places[place.index(places.len())]);
        if !first.starts_with(second.as_str()) && !second.starts_with(first.as_str()) {
            let [a, b] = [first, second].map(|place| file.json.pointer(place).cloned());
            put(&mut file.json, first, b);
            put(&mut file.json, second, a);
        }
        read_or_refused(file.glb());
    }
}
