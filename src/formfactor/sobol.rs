//! Low-discrepancy point sets and the hash that scrambles them.
//!
//! Sobol' points are Owen-scrambled (Burley 2020, "Practical hash-based Owen scrambling", JCGT 9(4):1–20). Where points
//! are made one by one and cheaply, they follow the R2 sequence (M. Roberts 2018, "The unreasonable effectiveness of
//! quasirandom sequences", extremelearning.com.au), shifted by a hash of the receiver (Cranley, Patterson 1976,
//! "Randomization of number theoretic methods for multiple integration", SIAM J. Numer. Anal. 13(6):904–914).

use glam::Vec2;

/// Point k of the unit square, from a pair of dimensions of a scrambled Sobol' sequence.
pub fn sobol(k: u32, pair: u32, scramble: u32) -> Vec2 {
    let at = |d| sobol_burley::sample(k, 2 * pair + d, scramble);
    Vec2::new(at(0), at(1))
}

/// The steps of the R2 sequence: 1/φ and 1/φ², where φ³ = φ + 1.
const R2: Vec2 = Vec2::new(0.754_877_7, 0.569_840_3);

/// The R2 sequence in the unit square, shifted by the 16-bit halves of a hash.
#[derive(Clone, Copy, Debug)]
pub struct ShiftedR2(Vec2);

impl ShiftedR2 {
    /// The sequence of this hash.
    #[inline]
    pub fn new(hash: u32) -> ShiftedR2 {
        ShiftedR2(Vec2::new((hash & 0xffff) as f32, (hash >> 16) as f32) / 65536.0)
    }

    /// Its point s.
    #[inline]
    pub fn point(self, s: usize) -> Vec2 {
        (self.0 + R2 * s as f32).fract()
    }
}

/// Weights of a triangle's second and third corner for a point of the unit square.
///
/// Heitz 2019, "A low-distortion map between triangle and square": no square root and no fold line.
pub fn in_triangle(p: Vec2) -> Vec2 {
    if p.y > p.x {
        Vec2::new(p.x * 0.5, p.y - p.x * 0.5)
    } else {
        Vec2::new(p.x - p.y * 0.5, p.y * 0.5)
    }
}

/// A well-mixed 32-bit hash (Wellons' `lowbias32`), for angles and scrambles that neighbours do not share.
pub fn scatter(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}
