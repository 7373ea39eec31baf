//! A rate of frames as files keep it: a fraction, or hundredths of a second.

/// Frames and the seconds that they take, as whole numbers: 24/1, 30000/1001 for the 29.97 of NTSC, else in thousandths.
pub fn fraction(fps: f64) -> (u32, u32) {
    let whole = fps.round();
    if (fps - whole).abs() < 1e-6 && whole >= 1.0 {
        return (whole as u32, 1);
    }
    // NTSC's rates are 1000/1001 of a whole number; 23.976 and 29.97 are what people type for them.
    let ntsc = (fps * 1.001).round();
    if ntsc >= 1.0 && (fps - ntsc / 1.001).abs() < 2e-3 {
        return (ntsc as u32 * 1000, 1001);
    }
    let (frames, seconds) = ((fps * 1000.0).round().max(1.0) as u32, 1000);
    let common = gcd(frames, seconds);
    (frames / common, seconds / common)
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// How long a frame is shown, in hundredths of a second, which is all that GIF knows: rounded so that the whole is in time.
/// Players show what is shorter than 2 hundredths for 10, so none is.
pub fn hundredths(frame: usize, fps: f64) -> u16 {
    let end = |frame: usize| (100.0 * frame as f64 / fps).round();
    (end(frame + 1) - end(frame)).clamp(2.0, f64::from(u16::MAX)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_the_fractions_that_people_mean() {
        for (fps, expected) in [
            (24.0, (24, 1)),
            (23.976, (24_000, 1001)),
            (29.97, (30_000, 1001)),
            (59.94, (60_000, 1001)),
            (12.5, (25, 2)),
            (0.1, (1, 10)),
            (1000.0, (1000, 1)),
        ] {
            assert_eq!(fraction(fps), expected, "{fps}");
        }
    }

    #[test]
    fn hundredths_add_up() {
        // 24 frames take a second: 16 of 4 hundredths and 8 of 4 + 1/2 rounded up or down make 100.
        let sum: u32 = (0..24)
            .map(|frame| u32::from(hundredths(frame, 24.0)))
            .sum();
        assert_eq!(sum, 100);
        assert_eq!(hundredths(7, 25.0), 4);
        assert_eq!(hundredths(0, 1000.0), 2);
    }
}
