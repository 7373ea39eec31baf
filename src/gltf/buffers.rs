//! The bytes of every buffer, and what is decoded from them.

use super::file::fetch;
use crate::error::{Error, Result};
use crate::scene::FileLimits;
use crate::scene::fault::broken;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::Path;

/// Most bytes of all buffers together: the most that one .glb can hold. Half of it halves the memory that a small file
/// which names a large one again and again can ask for.
pub(super) const MOST_BYTES: u64 = 1 << 32;

/// Most bytes that all compressed views and meshes of a file may be decoded to: 64 million positions of short integers,
/// with their normals. Half of it halves the memory that a small file of well-packed meshes can ask for.
const MOST_DECODED: u64 = 1 << 30;

/// Bytes of the file's buffers, then of what was decoded from them.
pub(super) struct Buffers {
    pub(super) held: Vec<Vec<u8>>,
    /// Bytes that may still be decoded.
    left: u64,
    limits: FileLimits,
}

impl Buffers {
    /// The content of every buffer that is needed, cut to the length its JSON states.
    pub(super) fn read(
        file: &Path,
        json: &Value,
        mut binary: Option<Vec<u8>>,
        not_needed: &HashSet<usize>,
        limits: FileLimits,
    ) -> Result<Buffers> {
        let list = json.get("buffers").and_then(Value::as_array);
        let list = list.map_or(&[][..], Vec::as_slice);
        // The table of fields has checked that each has a length.
        let length = |buffer: &Value| buffer.get("byteLength").and_then(Value::as_u64);
        let lengths: Vec<u64> = (list.iter())
            .map(|buffer| length(buffer).unwrap_or(0))
            .collect();
        check_lengths(file, &lengths, not_needed)?;
        let mut held = Vec::with_capacity(list.len());
        for (index, (buffer, length)) in list.iter().zip(lengths).enumerate() {
            if not_needed.contains(&index) {
                held.push(Vec::new());
                continue;
            }
            // Find the bytes: an address, or the binary chunk.
            let pointer = format!("/buffers/{index}/uri");
            let address = buffer.get("uri").and_then(Value::as_str);
            let mut bytes = match (address, &mut binary) {
                (Some(address), _) => fetch(file, address, &pointer, length, limits.external)?,
                (None, Some(binary)) if index == 0 => std::mem::take(binary),
                (None, _) => {
                    let expected = "an address, for there is no GLB binary chunk for it";
                    let way_out = "export the file again";
                    return Err(broken(file, pointer, expected, "nothing".into(), way_out));
                }
            };

            // Hold them to their length.
            if (bytes.len() as u64) < length {
                let pointer = format!("/buffers/{index}/byteLength");
                let expected = format!("at most the {} bytes there are", bytes.len());
                let way_out = "copy or export the file again; it is cut short";
                return Err(broken(file, pointer, expected, length.to_string(), way_out));
            }
            bytes.truncate(length as usize);
            held.push(bytes);
        }
        Ok(Buffers {
            held,
            left: MOST_DECODED,
            limits,
        })
    }

    /// Refuses to decode what would fill the memory, before a byte of it is.
    pub(super) fn claim(&mut self, file: &Path, pointer: &str, bytes: u64) -> Result<()> {
        if bytes > self.left {
            let expected = format!("at most {MOST_DECODED} bytes of all that is compressed");
            let got = format!("{bytes} with room left for {}", self.left);
            let way_out = "split the scene into smaller files";
            return Err(broken(file, pointer.into(), expected, got, way_out));
        }
        self.left -= bytes;
        let decoded = MOST_DECODED - self.left;
        if decoded > self.limits.memory {
            let [needs, fits] = [decoded, self.limits.memory].map(|bytes| bytes as f64 / 1e9);
            return Err(Error::Usage {
                flag: "--memory".into(),
                expected: format!("a scene whose meshes fit into the {fits:.1} GB there are"),
                got: format!(
                    "{pointer} of {}: {needs:.1} GB in all so far",
                    file.display()
                ),
                way_out: "export the file with smaller meshes, or give more --memory".into(),
            });
        }
        Ok(())
    }

    /// Bytes that may still be decoded.
    pub(super) fn left(&self) -> u64 {
        self.left.min(self.limits.memory)
    }

    /// The bytes of a view of the JSON.
    pub(super) fn view(&self, file: &Path, json: &Value, view: usize) -> Result<&[u8]> {
        let pointer = format!("/bufferViews/{view}");
        let number = |field: &str| {
            let number = json.pointer(&format!("{pointer}/{field}"));
            number.and_then(Value::as_u64).unwrap_or(0)
        };
        let (buffer, offset, length) =
            (number("buffer"), number("byteOffset"), number("byteLength"));
        let held = self
            .held
            .get(buffer as usize)
            .map_or(&[][..], Vec::as_slice);
        span(held, offset, length).ok_or_else(|| {
            let expected = format!("at most the {} bytes of buffer {buffer}", held.len());
            let got = format!("{length} bytes from byte {offset}");
            let way_out = "export the file again; it is cut short";
            broken(
                file,
                format!("{pointer}/byteLength"),
                expected,
                got,
                way_out,
            )
        })
    }

    /// Puts bytes into a buffer of their own, and lets a view of the JSON be all of it.
    pub(super) fn lay(&mut self, json: &mut Value, view: usize, bytes: Vec<u8>) {
        let (buffer, length) = (self.held.len(), bytes.len());
        self.held.push(bytes);
        if let Some(list) = json.get_mut("buffers").and_then(Value::as_array_mut) {
            list.push(json!({ "byteLength": length }));
        }
        let view = json.pointer_mut(&format!("/bufferViews/{view}"));
        if let Some(view) = view.and_then(Value::as_object_mut) {
            view.insert("buffer".into(), buffer.into());
            view.insert("byteLength".into(), length.into());
            view.remove("byteOffset");
        }
    }
}

/// Refuses too many bytes before one is read.
fn check_lengths(file: &Path, lengths: &[u64], not_needed: &HashSet<usize>) -> Result<()> {
    let mut left = MOST_BYTES;
    for (index, length) in lengths.iter().enumerate() {
        if not_needed.contains(&index) {
            continue;
        }
        if *length > left {
            let pointer = format!("/buffers/{index}/byteLength");
            let expected = format!("at most {MOST_BYTES} bytes in all buffers together");
            let got = format!("{length} with room left for {left}");
            let way_out = "correct the length, or split the scene into smaller files";
            return Err(broken(file, pointer, expected, got, way_out));
        }
        left -= length;
    }
    Ok(())
}

/// `length` bytes from `offset` on, if they are all there.
pub(super) fn span(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}
