//! Modes TRIANGLES and INDICES: corners that follow from triangles and corners shortly before.
//!
//! Khronos glTF extension registry, EXT_meshopt_compression (A. Kapoulkine, J. St. Pierre and others, 2020), Appendix A
//! "Bitstream", modes 1 and 2; KHR_meshopt_compression has the same. The letters are the specification's.

use super::bytes::{Bytes, Stream, TOO_SHORT, signed};

/// What was pushed last, up to sixteen items.
struct Recent<T> {
    items: [T; 16],
    pushed: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Recent<T> {
        Recent {
            items: [T::default(); 16],
            pushed: 0,
        }
    }

    fn push(&mut self, item: T) {
        self.items[self.pushed % 16] = item;
        self.pushed += 1;
    }

    /// The item pushed `back` items before the last one.
    fn get(&self, back: u8) -> Result<T, &'static str> {
        let at = self.pushed.checked_sub(1 + usize::from(back));
        let at = at.ok_or("one that refers to what was not there yet")?;
        Ok(self.items[at % 16])
    }
}

/// What is known between two triangles.
struct Triangles<'a> {
    data: Bytes<'a>,
    next: u32,
    last: u32,
    edges: Recent<[u32; 2]>,
    corners: Recent<u32>,
}

/// `count` corners of triangles, each of `stride` bytes.
pub(super) fn triangles(stream: &[u8], count: usize, stride: usize) -> Stream {
    // Take the codes, the data and the table apart.
    if stream.first() != Some(&0xe1) {
        return Err("one that does not begin with 0xe1");
    }
    let mut stream = Bytes(&stream[1..]);
    let codes = stream.take(count / 3)?;
    let data = stream.0.len().checked_sub(16).ok_or(TOO_SHORT)?;
    let data = Bytes(stream.take(data)?);
    let table = stream.take(16)?;
    let nibbles = table.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    if table[14..] != [0, 0] || nibbles.into_iter().any(|nibble| nibble == 15) {
        return Err("one with a broken table at its end");
    }

    // Decode triangle after triangle.
    let mut state = Triangles {
        data,
        next: 0,
        last: 0,
        edges: Recent::new(),
        corners: Recent::new(),
    };
    let mut values = Vec::with_capacity(count * stride);
    for code in codes {
        let triangle = match (code >> 4, code & 15) {
            (15, y @ 14..) => state.explicit(y == 15)?,
            (15, y) => state.tabled(table[usize::from(y)])?,
            (x, y) => state.beside(x, y)?,
        };
        for corner in triangle {
            values.extend_from_slice(&corner.to_le_bytes()[..stride]);
        }
    }
    state.data.finish()?;
    Ok(values)
}

impl Triangles<'_> {
    /// A triangle on a recent edge.
    fn beside(&mut self, x: u8, y: u8) -> Result<[u32; 3], &'static str> {
        let [a, b] = self.edges.get(x)?;
        let c = match y {
            0 => self.fresh(),
            1..13 => self.corners.get(y)?,
            13 => self.stepped(1_u32.wrapping_neg()),
            14 => self.stepped(1),
            _ => self.read()?,
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if !(1..13).contains(&y) {
            self.corners.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle of new and recent corners, as an entry of the table tells.
    fn tabled(&mut self, entry: u8) -> Result<[u32; 3], &'static str> {
        let (z, w) = (entry >> 4, entry & 15);
        let a = self.fresh();
        let b = self.corner(z)?;
        let c = self.corner(w)?;
        Ok(self.pushed([a, b, c], [z, w]))
    }

    /// A triangle whose kind of corners a byte of the data tells.
    fn explicit(&mut self, read_first: bool) -> Result<[u32; 3], &'static str> {
        let entry = self.data.byte()?;
        let (z, w) = (entry >> 4, entry & 15);
        if entry == 0 {
            self.next = 0;
        }
        // New corners are counted before any is read.
        let a = if read_first { 0 } else { self.fresh() };
        let b = if z < 15 { self.corner(z)? } else { 0 };
        let c = if w < 15 { self.corner(w)? } else { 0 };
        let a = if read_first { self.read()? } else { a };
        let b = if z < 15 { b } else { self.read()? };
        let c = if w < 15 { c } else { self.read()? };
        Ok(self.pushed([a, b, c], [z, w]))
    }

    /// The triangle, remembered with its edges and those corners that were not recent already.
    fn pushed(&mut self, [a, b, c]: [u32; 3], [z, w]: [u8; 2]) -> [u32; 3] {
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        self.corners.push(a);
        for (kind, corner) in [(z, b), (w, c)] {
            if kind == 0 || kind == 15 {
                self.corners.push(corner);
            }
        }
        [a, b, c]
    }

    /// The next new corner, or a recent one.
    fn corner(&mut self, kind: u8) -> Result<u32, &'static str> {
        match kind {
            0 => Ok(self.fresh()),
            recent => self.corners.get(recent - 1),
        }
    }

    fn fresh(&mut self) -> u32 {
        let fresh = self.next;
        self.next = fresh.wrapping_add(1);
        fresh
    }

    fn stepped(&mut self, by: u32) -> u32 {
        self.last = self.last.wrapping_add(by);
        self.last
    }

    fn read(&mut self) -> Result<u32, &'static str> {
        let step = signed(self.data.number()?);
        Ok(self.stepped(step))
    }
}

/// `count` indices, each of `stride` bytes: steps from one of two last ones.
pub(super) fn indices(stream: &[u8], count: usize, stride: usize) -> Stream {
    /// Bytes at the end that mean nothing.
    const PADDING: usize = 4;
    if stream.first() != Some(&0xd1) {
        return Err("one that does not begin with 0xd1");
    }
    let end = stream.len().checked_sub(PADDING).filter(|end| *end > 0);
    let mut data = Bytes(&stream[1..end.ok_or(TOO_SHORT)?]);
    let mut last = [0_u32; 2];
    let mut values = Vec::with_capacity(count.min(data.0.len()) * stride);
    for _ in 0..count {
        let step = data.number()?;
        let last = &mut last[(step & 1) as usize];
        *last = last.wrapping_add(signed(step >> 1));
        values.extend_from_slice(&last.to_le_bytes()[..stride]);
    }
    data.finish()?;
    Ok(values)
}
