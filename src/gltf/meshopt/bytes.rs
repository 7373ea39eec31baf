//! What the three streams have in common: bytes taken one after the other, and numbers of seven bits a byte.

/// What a stream holds, or what it is instead, as it reads after *got*.
pub(super) type Stream = Result<Vec<u8>, &'static str>;

pub(super) const TOO_SHORT: &str = "one that ends too early";
pub(super) const LEFT_OVER: &str = "one with bytes left over";

/// What is left of a stream.
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl<'a> Bytes<'a> {
    /// The next so many bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], &'static str> {
        let (taken, left) = self.0.split_at_checked(count).ok_or(TOO_SHORT)?;
        self.0 = left;
        Ok(taken)
    }

    /// The next byte.
    pub(super) fn byte(&mut self) -> Result<u8, &'static str> {
        Ok(self.take(1)?[0])
    }

    /// The next number: seven bits a byte, the lowest first; the last byte's highest bit is 0.
    pub(super) fn number(&mut self) -> Result<u32, &'static str> {
        let mut number = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            number |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err("one with a number of more than five bytes")
    }

    /// Fails unless all is taken.
    pub(super) fn finish(&self) -> Result<(), &'static str> {
        self.0.is_empty().then_some(()).ok_or(LEFT_OVER)
    }
}

/// A number whose lowest bit is its sign: 0, −1, 1, −2, 2 … in two's complement.
pub(super) fn signed(zigzag: u32) -> u32 {
    (zigzag >> 1) ^ (zigzag & 1).wrapping_neg()
}
