//! What a tab may say: JSON texts of bounded size, as the protocol lists them.

use crate::options::Curve;
use serde::Deserialize;
use serde_json::Value;

/// Longest message that is read, in bytes: a step of many edits has a few thousand.
pub(super) const MOST_BYTES: usize = 64 << 10;

/// A message.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum Ask {
    /// Makes the edits of a step.
    Step {
        /// The edits, as `sweeplight edit` takes them.
        edits: Value,
        /// Steps of one gesture that say the same things become one line, and one undo takes all back.
        #[serde(default)]
        gesture: Option<u64>,
    },
    /// Moves and turns a node in world coordinates, from where it was when the gesture began.
    Place {
        node: usize,
        gesture: u64,
        #[serde(flatten)]
        places: Carry,
    },
    /// Takes back the last line.
    Undo {},
    /// Lets the clips play or stand.
    Play { on: bool },
    /// Shows the clips at a time.
    Seek { seconds: f64 },
    /// Makes a picture with the pixels of `render`.
    Render(PictureOrder),
    /// Compares the state with one traced and solved from nothing.
    Verify {},
    /// Asks for the edits so far.
    Lines {},
}

/// Where a node goes, from where it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub(super) struct Carry {
    /// Metres.
    #[serde(default)]
    pub(super) by: [f64; 3],
    /// Degrees about the vertical.
    #[serde(default)]
    pub(super) turn: f64,
    /// The point that it turns about; its origin if there is none.
    #[serde(default)]
    pub(super) about: Option<[f64; 3]>,
}

/// A picture that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PictureOrder {
    pub(super) eye: [f64; 3],
    pub(super) at: [f64; 3],
    /// The vertical field of view.
    pub(super) degrees: f64,
    /// Pixels.
    pub(super) size: (u32, u32),
    /// Exposure.
    #[serde(default)]
    pub(super) stops: f32,
    #[serde(default)]
    pub(super) curve: Curve,
}

/// A message with the number that its answer names.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Message {
    /// The number that the tab gave it; 0 without one.
    pub(super) id: u64,
    /// What is asked.
    pub(super) ask: Ask,
}

impl Message {
    /// Reads a text; the error says what is wrong.
    pub(super) fn parse(text: &str) -> Result<Message, (u64, String)> {
        if text.len() > MOST_BYTES {
            let told = format!("expected at most {MOST_BYTES} bytes, got {}", text.len());
            return Err((0, format!("message: {told} — send several messages")));
        }
        let mut value: Value =
            serde_json::from_str(text).map_err(|error| (0, wrong("JSON", &error.to_string())))?;
        let id = value.as_object_mut().and_then(|fields| fields.remove("id"));
        let id = id.and_then(|id| id.as_u64()).unwrap_or(0);
        let ask = serde_json::from_value(value);
        let ask = ask.map_err(|error| (id, wrong("one of the protocol", &error.to_string())))?;
        Ok(Message { id, ask })
    }
}

fn wrong(expected: &str, got: &str) -> String {
    format!("message: expected {expected}, got {got} — sweeplight help live lists the messages")
}

impl Ask {
    /// Whether a later message makes this one needless: two places of one gesture, two times.
    pub(super) fn gives_way_to(&self, later: &Ask) -> bool {
        match (self, later) {
            (
                Ask::Place { node, gesture, .. },
                Ask::Place {
                    node: n,
                    gesture: g,
                    ..
                },
            ) => node == n && gesture == g,
            (Ask::Seek { .. }, Ask::Seek { .. }) => true,
            (
                Ask::Step {
                    edits,
                    gesture: Some(gesture),
                },
                Ask::Step {
                    edits: e,
                    gesture: Some(g),
                },
            ) => gesture == g && super::record::say_the_same_things(edits, e),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_with_their_number() {
        let read = |text: &str| Message::parse(text).expect("a message");
        assert_eq!(read(r#"{"do":"undo","id":7}"#).id, 7);
        assert_eq!(
            read(r#"{"do":"seek","seconds":1.5}"#).ask,
            Ask::Seek { seconds: 1.5 }
        );
        let place = read(r#"{"do":"place","node":3,"by":[1,0,0],"gesture":2}"#).ask;
        assert!(matches!(
            place,
            Ask::Place {
                node: 3,
                gesture: 2,
                ..
            }
        ));
        let shot = r#"{"do":"render","eye":[0,1,2],"at":[0,0,0],"degrees":45,"size":[64,36],"curve":"agx"}"#;
        assert!(matches!(
            read(shot).ask,
            Ask::Render(PictureOrder { size: (64, 36), .. })
        ));
    }

    #[test]
    fn what_is_none_is_told() {
        let long = format!("{{\"do\":\"undo\",\"x\":\"{}\"}}", "a".repeat(MOST_BYTES));
        for text in [
            "",
            "[]",
            "{",
            "{}",
            r#"{"do":"jump"}"#,
            r#"{"do":"seek"}"#,
            &long,
            "\u{0}",
        ] {
            let (_, told) = Message::parse(text).expect_err("no message");
            assert!(told.contains("expected") && told.contains(" — "), "{told}");
        }
    }

    #[test]
    fn later_places_of_a_gesture_stand_for_earlier_ones() {
        let place = |node, gesture| Ask::Place {
            node,
            gesture,
            places: Carry::default(),
        };
        assert!(place(1, 1).gives_way_to(&place(1, 1)));
        assert!(!place(1, 1).gives_way_to(&place(1, 2)));
        assert!(!place(1, 1).gives_way_to(&place(2, 1)));
        assert!(!Ask::Undo {}.gives_way_to(&Ask::Undo {}));
    }
}
