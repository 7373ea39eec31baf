//! Mode ATTRIBUTES: elements of whole words, whose bytes lie apart and are differences from the element before.
//!
//! Khronos glTF extension registry, KHR_meshopt_compression, Appendix A "Bitstream", mode 0. Its version 0 is the stream of
//! EXT_meshopt_compression (A. Kapoulkine, J. St. Pierre and others, 2020).

use super::bytes::{Bytes, Stream, TOO_SHORT, signed};

/// Elements whose differences are packed together.
const GROUP: usize = 16;

/// Most elements of a block.
const MOST_ELEMENTS: usize = 256;

/// Most bytes of a block.
const MOST_BYTES: usize = 8192;

/// Bytes of a word: the differences of its bytes are undone together.
const WORD: usize = 4;

/// The differences of a word's four bytes, each over the elements of a block.
type Planes = [[u8; MOST_ELEMENTS]; WORD];

/// How a word follows from the one before it.
#[derive(Clone, Copy)]
enum WordCoding {
    /// Each byte has a difference.
    Bytes,
    /// Each half has a difference.
    Halves,
    /// The bits that differ, rotated to the left by so many.
    Bits(u32),
}

/// `count` elements of `stride` bytes, which is a multiple of four and at most 256.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Stream {
    // Take the header, the blocks and the tail apart.
    let words = stride / WORD;
    let (modes, least) = match stream.first() {
        Some(0xa0) => (0, 32),
        Some(0xa1) => (words, 24),
        _ => return Err("one that begins with neither 0xa0 nor 0xa1"),
    };
    let tail = (stride + modes).max(least);
    let end = stream.len().checked_sub(tail).filter(|end| *end > 0);
    let mut blocks = Bytes(&stream[1..end.ok_or(TOO_SHORT)?]);
    let (before, modes) = stream[stream.len() - stride - modes..].split_at(stride);
    let channels = match modes {
        [] => vec![WordCoding::Bytes; words],
        modes => modes
            .iter()
            .map(|mode| channel(*mode))
            .collect::<Result<_, _>>()?,
    };

    // Decode block after block, each from the last element of the one before.
    let versed = stream[0] == 0xa1;
    let mut before = before.to_vec();
    let mut values = vec![0; count * stride];
    let most = (MOST_BYTES / stride / GROUP * GROUP).min(MOST_ELEMENTS);
    for block in values.chunks_mut(most * stride) {
        let controls = match versed {
            true => Some(blocks.take(words)?),
            false => None,
        };
        for (word, channel) in channels.iter().enumerate() {
            let control = controls.map(|controls| controls[word]);
            let planes = planes(&mut blocks, control, block.len() / stride)?;
            let place = word * WORD..(word + 1) * WORD;
            let elements = block.chunks_exact_mut(stride);
            let words = elements.map(|element| &mut element[place.clone()]);
            channel.undo(&planes, &mut before[place.clone()], words);
        }
    }
    blocks.finish()?;
    Ok(values)
}

/// The channel of a mode byte.
fn channel(mode: u8) -> Result<WordCoding, &'static str> {
    match (mode & 15, mode >> 4) {
        (0, 0) => Ok(WordCoding::Bytes),
        (1, 0) => Ok(WordCoding::Halves),
        (2, turn) => Ok(WordCoding::Bits(u32::from(turn))),
        _ => Err("one with an unknown channel mode"),
    }
}

/// The packed differences of a word's four bytes over a block of `count` elements; without a control byte in version 0.
fn planes(blocks: &mut Bytes, control: Option<u8>, count: usize) -> Result<Planes, &'static str> {
    let mut planes = [[0; MOST_ELEMENTS]; WORD];
    for (byte, plane) in planes.iter_mut().enumerate() {
        let widths = match control.map(|control| control >> (2 * byte) & 3) {
            None => [0, 2, 4, 8],
            Some(0) => [0, 1, 2, 4],
            Some(1) => [1, 2, 4, 8],
            Some(2) => continue,
            Some(_) => {
                plane[..count].copy_from_slice(blocks.take(count)?);
                continue;
            }
        };
        let groups = count.div_ceil(GROUP);
        let header = blocks.take(groups.div_ceil(4))?;
        for (at, group) in plane.chunks_exact_mut(GROUP).take(groups).enumerate() {
            unpack(
                blocks,
                widths[usize::from(header[at / 4] >> (at % 4 * 2) & 3)],
                group,
            )?;
        }
    }
    Ok(planes)
}

/// A group of differences of so many bits; one whose bits are all set stands as a byte behind the group.
fn unpack(blocks: &mut Bytes, width: usize, group: &mut [u8]) -> Result<(), &'static str> {
    let packed = blocks.take(GROUP * width / 8)?;
    match width {
        0 => group.fill(0),
        8 => group.copy_from_slice(packed),
        _ => {
            let (all, each) = ((1 << width) - 1, 8 / width);
            for (at, value) in group.iter_mut().enumerate() {
                // Single bits begin with the lowest, wider ones with the highest.
                let place = match width {
                    1 => at % each,
                    _ => each - 1 - at % each,
                };
                let bits = packed[at / each] >> (place * width) & all;
                *value = if bits == all { blocks.byte()? } else { bits };
            }
        }
    }
    Ok(())
}

impl WordCoding {
    /// Writes each element's word from the one before it, and leaves the last one for the next block.
    fn undo<'a>(
        self,
        planes: &Planes,
        before: &mut [u8],
        words: impl Iterator<Item = &'a mut [u8]>,
    ) {
        let mut last = std::array::from_fn(|byte| before[byte]);
        for (at, word) in words.enumerate() {
            last = self.next(last, std::array::from_fn(|byte| planes[byte][at]));
            word.copy_from_slice(&last);
        }
        before.copy_from_slice(&last);
    }

    /// The word that differs from the last one by so much.
    fn next(self, last: [u8; WORD], by: [u8; WORD]) -> [u8; WORD] {
        match self {
            WordCoding::Bytes => std::array::from_fn(|byte| {
                last[byte].wrapping_add(signed(u32::from(by[byte])) as u8)
            }),
            WordCoding::Halves => {
                let half = |bytes: [u8; WORD], at| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
                let next = |at| {
                    let step = signed(u32::from(half(by, at))) as u16;
                    half(last, at).wrapping_add(step).to_le_bytes()
                };
                let [[a, b], [c, d]] = [next(0), next(2)];
                [a, b, c, d]
            }
            WordCoding::Bits(turn) => {
                let differ = u32::from_le_bytes(by).rotate_right(turn);
                (u32::from_le_bytes(last) ^ differ).to_le_bytes()
            }
        }
    }
}
