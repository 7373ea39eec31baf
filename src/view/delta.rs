//! Binary messages: the mesh once, then of each state what differs from what the tab has.
//!
//! All numbers are little-endian, all arrays begin at multiples of four bytes. A list of differences is the number of its runs,
//! the first place and the length of each, and then the values of all.

use super::snapshot::{MeshSnapshot, Snapshot, VertexLight};
use glam::Vec3;
use half::f16;

/// Kinds of messages, their first word.
const MESH: u32 = 1;
const STATE: u32 = 2;
pub(super) const PICTURE: u32 = 3;

/// What stands for no vertex and for no side.
const NONE: u32 = u32::MAX;

/// The mesh of a stage.
pub(super) fn mesh(stage: &MeshSnapshot) -> Vec<u8> {
    let drawn = &stage.drawn;
    let mut bytes = Vec::with_capacity(64 * drawn.triangles.len());
    let count = drawn.triangles.len() as u32;
    for word in [MESH, stage.epoch, count, drawn.vertices, drawn.sides] {
        bytes.extend(word.to_le_bytes());
    }
    for triangle in &drawn.triangles {
        let vertices = triangle.vertices.unwrap_or([NONE; 3]);
        bytes.extend(vertices.iter().flat_map(|vertex| vertex.to_le_bytes()));
    }
    for triangle in &drawn.triangles {
        let side = triangle.side.map_or(NONE, |side| side.number());
        bytes.extend(side.to_le_bytes());
    }
    for triangle in &drawn.triangles {
        let numbers = triangle.texcoords.iter().flat_map(|at| at.to_array());
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
    }
    for triangle in &drawn.triangles {
        for tint in triangle.tints {
            bytes.extend(
                tint.to_array()
                    .map(|part| (255.0 * part.clamp(0.0, 1.0)).round() as u8),
            );
            bytes.push(255);
        }
    }
    for triangle in &drawn.triangles {
        let glow = triangle.glow.to_array();
        bytes.extend(glow.map(|part| (255.0 * part.clamp(0.0, 1.0)).round() as u8));
        bytes.push(255);
    }
    bytes
}

/// What a tab has been sent.
#[derive(Default)]
pub(super) struct Sent {
    corners: Vec<[Vec3; 3]>,
    light: Vec<VertexLight>,
    heat: Vec<u8>,
}

impl Sent {
    /// The message that brings a tab to a state, and the tab's copy with it.
    pub(super) fn state(&mut self, snapshot: &Snapshot) -> Vec<u8> {
        let mut bytes = Vec::new();
        for word in [STATE, snapshot.stage.epoch, snapshot.revision as u32] {
            bytes.extend(word.to_le_bytes());
        }
        list(
            &mut bytes,
            &mut self.corners,
            &snapshot.corners,
            |a, b| a == b,
            |bytes, corners| {
                let numbers = corners.iter().flat_map(|corner| corner.to_array());
                bytes.extend(numbers.flat_map(f32::to_le_bytes));
            },
        );
        let same = if snapshot.is_coarse {
            looks_alike
        } else {
            is_same
        };
        list(
            &mut bytes,
            &mut self.light,
            &snapshot.light,
            same,
            |bytes, light| {
                bytes.extend(light.iter().flat_map(|bits| bits.to_le_bytes()));
            },
        );
        list(
            &mut bytes,
            &mut self.heat,
            &snapshot.heat,
            |a, b| a == b,
            |bytes, heat| {
                bytes.push(*heat);
            },
        );
        bytes
    }
}

fn is_same(a: &VertexLight, b: &VertexLight) -> bool {
    a == b
}

/// The part of light whose change nobody sees while a hand moves.
const UNSEEN: f32 = 1.0 / 256.0;

fn looks_alike(a: &VertexLight, b: &VertexLight) -> bool {
    if a[3] != b[3] {
        return false;
    }
    let [a, b] = [a, b].map(|light| light.map(|bits| f16::from_bits(bits).to_f32()));
    let most = a[..3].iter().fold(0.0f32, |most, part| most.max(*part));
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= UNSEEN * most)
}

/// Runs that are this near are sent as one: the words of a run cost as much.
const NEAR: usize = 2;

/// Appends the differences of a list, and makes it the new one.
fn list<T: Copy>(
    bytes: &mut Vec<u8>,
    sent: &mut Vec<T>,
    now: &[T],
    same: impl Fn(&T, &T) -> bool,
    put: impl Fn(&mut Vec<u8>, &T),
) {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (at, value) in now.iter().enumerate() {
        if sent.get(at).is_some_and(|known| same(known, value)) {
            continue;
        }
        match runs.last_mut() {
            Some((_, end)) if at < *end + NEAR => *end = at + 1,
            _ => runs.push((at, at + 1)),
        }
    }
    bytes.extend((runs.len() as u32).to_le_bytes());
    for (first, end) in &runs {
        bytes.extend((*first as u32).to_le_bytes());
        bytes.extend(((end - first) as u32).to_le_bytes());
    }
    sent.truncate(now.len());
    for (first, end) in runs {
        now[first..end].iter().for_each(|value| put(bytes, value));
        // Values behind the end of what was sent all differ, so they are in the last run.
        let known = end.min(sent.len());
        if first < known {
            sent[first..known].copy_from_slice(&now[first..known]);
        }
        sent.extend_from_slice(&now[known.max(first)..end]);
    }
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(sent: &mut Vec<u8>, now: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        list(
            &mut bytes,
            sent,
            now,
            |a, b| a == b,
            |bytes, value| bytes.push(*value),
        );
        bytes
    }

    #[test]
    fn only_what_differs_is_sent() {
        let mut sent = Vec::new();
        let whole = runs(&mut sent, &[1, 2, 3, 4, 5]);
        assert_eq!(
            whole,
            [1, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 1, 2, 3, 4, 5, 0, 0, 0]
        );
        assert_eq!(sent, [1, 2, 3, 4, 5]);
        assert_eq!(runs(&mut sent, &[1, 2, 3, 4, 5]), [0; 4]);
        let two = runs(&mut sent, &[9, 2, 3, 4, 8, 7]);
        assert_eq!(two[..4], [2, 0, 0, 0]);
        assert_eq!(two[4..20], [0, 0, 0, 0, 1, 0, 0, 0, 4, 0, 0, 0, 2, 0, 0, 0]);
        assert_eq!(two[20..], [9, 8, 7, 0]);
        assert_eq!(sent, [9, 2, 3, 4, 8, 7]);
    }

    #[test]
    fn light_that_hardly_changes_can_wait() {
        let light = |value: f32| {
            let bits = f16::from_f32(value).to_bits();
            [bits, bits, bits, f16::ONE.to_bits()]
        };
        assert!(looks_alike(&light(1.0), &light(1.002)));
        assert!(!looks_alike(&light(1.0), &light(1.01)));
        assert!(!looks_alike(&light(0.0), &light(0.001)));
        assert!(!looks_alike(&[0; 4], &light(0.0)));
    }
}
