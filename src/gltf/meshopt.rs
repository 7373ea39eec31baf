//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views that stand compressed in another buffer.
//!
//! Khronos glTF extension registry: EXT_meshopt_compression (A. Kapoulkine, J. St. Pierre and others, 2020) and
//! KHR_meshopt_compression, which adds a second version of one stream and a filter. Each view is decoded into a buffer of
//! its own, and the JSON is made to say so: nothing behind this knows that it was compressed. A plain copy beside the
//! compressed one is not asked for.

mod attributes;
mod bytes;
mod filters;
mod indices;
#[cfg(test)]
mod tests;

use super::buffers::{Buffers, span};
use crate::error::Result;
use crate::scene::fault::broken;
use bytes::Stream;
use serde_json::Value;
use std::collections::HashSet;
use std::path::Path;

/// The two extensions that a view may have.
const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The way out of a broken stream.
const AGAIN: &str = "compress the file again, or copy it again; it is damaged";

/// A compressed view: where its stream is and what it makes of it.
struct PackedView<'a> {
    pointer: String,
    buffer: usize,
    offset: u64,
    length: u64,
    stride: u64,
    count: u64,
    mode: &'a str,
    filter: &'a str,
}

/// The extension of a view, if it has one; the table of fields has checked its types.
fn packed(view: &Value, index: usize) -> Option<PackedView<'_>> {
    let extensions = view.get("extensions")?;
    let found = |name: &'static str| Some((name, extensions.get(name)?));
    let (name, json) = NAMES.into_iter().find_map(found)?;
    let number = |field: &str| json.get(field).and_then(Value::as_u64).unwrap_or(0);
    let word = |field: &str| json.get(field).and_then(Value::as_str);
    Some(PackedView {
        pointer: format!("/bufferViews/{index}/extensions/{name}"),
        buffer: number("buffer") as usize,
        offset: number("byteOffset"),
        length: number("byteLength"),
        stride: number("byteStride"),
        count: number("count"),
        mode: word("mode").unwrap_or_default(),
        filter: word("filter").unwrap_or("NONE"),
    })
}

fn views(json: &Value) -> impl Iterator<Item = &Value> {
    let views = json.get("bufferViews").and_then(Value::as_array);
    views.into_iter().flatten()
}

/// The buffers in which nothing but compressed views lies: what they hold is not needed.
pub(super) fn not_needed(json: &Value) -> HashSet<usize> {
    let buffer = |view: &Value| view.get("buffer").and_then(Value::as_u64);
    let (mut compressed, mut needed) = (HashSet::new(), HashSet::new());
    for (index, view) in views(json).enumerate() {
        let here = buffer(view).unwrap_or_default() as usize;
        match packed(view, index) {
            Some(packed) => {
                compressed.insert(here);
                needed.insert(packed.buffer);
            }
            None => drop(needed.insert(here)),
        }
    }
    &compressed - &needed
}

/// Decodes every compressed view, each into a buffer of its own.
pub(super) fn unpack(file: &Path, json: &mut Value, buffers: &mut Buffers) -> Result<()> {
    let count = views(json).count();
    for index in 0..count {
        let view = &json["bufferViews"][index];
        let Some(packed) = packed(view, index) else {
            continue;
        };
        packed.check(file, view, index)?;
        let whole = packed.count * packed.stride;
        buffers.claim(file, &packed.pointer, whole)?;
        let source = &buffers.held[packed.buffer];
        let stream = span(source, packed.offset, packed.length).ok_or_else(|| {
            let expected = format!("a stream inside the {} bytes of its buffer", source.len());
            let got = format!("{} bytes from byte {}", packed.length, packed.offset);
            let way_out = "copy or export the file again; it is cut short";
            broken(file, packed.pointer.clone(), expected, got, way_out)
        })?;
        let values = packed.decode(stream).map_err(|got| {
            let (count, stride, mode) = (packed.count, packed.stride, packed.mode);
            let expected = format!("a stream of {count} elements of {stride} bytes, mode {mode}");
            broken(file, packed.pointer.clone(), expected, got.into(), AGAIN)
        })?;
        buffers.lay(json, index, values);
    }
    Ok(())
}

impl PackedView<'_> {
    /// Refuses what the specification forbids, before anything is decoded.
    fn check(&self, file: &Path, view: &Value, index: usize) -> Result<()> {
        let (pointer, stride) = (&self.pointer, self.stride);
        let wrong = |pointer: String, expected: String, got: String| {
            let way_out = "compress the file again";
            Err(broken(file, pointer, expected, got, way_out))
        };
        let length = view.get("byteLength").and_then(Value::as_u64);
        let whole = self.count.checked_mul(stride);
        if whole.is_none() || whole != length {
            let expected = format!("{} elements of {stride} bytes in all", self.count);
            let got = length.unwrap_or_default().to_string();
            return wrong(format!("/bufferViews/{index}/byteLength"), expected, got);
        }
        let attributes = self.mode == "ATTRIBUTES";
        let (fits, strides) = match (self.mode, self.filter) {
            ("ATTRIBUTES", "OCTAHEDRAL" | "COLOR") => (matches!(stride, 4 | 8), "4 or 8"),
            ("ATTRIBUTES", "QUATERNION") => (stride == 8, "8"),
            ("ATTRIBUTES", _) => (
                stride.is_multiple_of(4) && (4..=256).contains(&stride),
                "a multiple of 4 up to 256",
            ),
            _ => (matches!(stride, 2 | 4), "2 or 4"),
        };
        if !fits {
            let of = if attributes { self.filter } else { self.mode };
            let expected = format!("{strides} bytes for {of}");
            return wrong(
                format!("{pointer}/byteStride"),
                expected,
                stride.to_string(),
            );
        }
        if !attributes && self.filter != "NONE" {
            let expected = format!("no filter of {}", self.mode);
            return wrong(format!("{pointer}/filter"), expected, self.filter.into());
        }
        if self.mode == "TRIANGLES" && !self.count.is_multiple_of(3) {
            let expected = "a multiple of 3 for TRIANGLES".into();
            return wrong(format!("{pointer}/count"), expected, self.count.to_string());
        }
        Ok(())
    }

    /// The elements of a stream.
    fn decode(&self, stream: &[u8]) -> Stream {
        let (count, stride) = (self.count as usize, self.stride as usize);
        match self.mode {
            "TRIANGLES" => return indices::triangles(stream, count, stride),
            "INDICES" => return indices::indices(stream, count, stride),
            _ => {}
        }
        let mut values = attributes::decode(stream, count, stride)?;
        match self.filter {
            "OCTAHEDRAL" => filters::octahedral(&mut values, stride),
            "QUATERNION" => filters::quaternion(&mut values),
            "EXPONENTIAL" => filters::exponential(&mut values),
            "COLOR" => filters::colour(&mut values, stride),
            _ => {}
        }
        Ok(values)
    }
}
