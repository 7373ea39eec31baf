//! Pictures by an encoder, beside the pixels that Khronos's reference transcoder makes of them; and damaged ones.
//!
//! `etc1s` and `zstandard` hold the slope below, `levels` a disc on gradients with all its halves, and `uastc` a block of
//! each of the 19 modes side by side, of random bits otherwise.

use super::*;
use image::Rgba;

const ETC1S_FILE: &[u8] = include_bytes!("etc1s.ktx2");
const LEVELS_FILE: &[u8] = include_bytes!("levels.ktx2");
const UASTC_FILE: &[u8] = include_bytes!("uastc.ktx2");
const ZSTANDARD_FILE: &[u8] = include_bytes!("zstandard.ktx2");

const FILES: [(&[u8], &[u8]); 4] = [
    (ETC1S_FILE, include_bytes!("etc1s.png")),
    (LEVELS_FILE, include_bytes!("levels.png")),
    (UASTC_FILE, include_bytes!("uastc.png")),
    (ZSTANDARD_FILE, include_bytes!("zstandard.png")),
];

fn read(bytes: &[u8]) -> Result<RgbaImage, String> {
    decode(bytes, 16_384)
}

/// A file with other bytes at some place.
fn patched(bytes: &[u8], at: usize, patch: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + patch.len()].copy_from_slice(patch);
    bytes
}

/// A file whose samples say that they are other channels.
fn with_channels(bytes: &[u8], channels: &[u8]) -> Vec<u8> {
    let descriptor = word(bytes, 48).expect("a descriptor") as usize;
    let mut bytes = bytes.to_vec();
    for (sample, channel) in channels.iter().enumerate() {
        bytes[descriptor + 31 + 16 * sample] = *channel;
    }
    bytes
}

#[test]
fn a_file_gives_the_pixels_of_the_reference_transcoder() {
    for (file, expected) in FILES {
        let expected = image::load_from_memory(expected).expect("a PNG");
        assert_eq!(read(file).as_ref(), Ok(&expected.into_rgba8()));
    }
}

/// What was encoded is known by its formula; the encoder's own report of these two is at most 10 steps of 255.
#[test]
fn a_slope_comes_back_within_the_loss_of_its_codec() {
    for (file, size) in [(ETC1S_FILE, (13, 10)), (ZSTANDARD_FILE, (16, 12))] {
        let picture = read(file).expect("a picture");
        assert_eq!(picture.dimensions(), size);
        for (x, y, pixel) in picture.enumerate_pixels() {
            let slope = 6 * (x + y);
            let expected = [slope, slope + 60, slope + 30, 255 - 8 * y];
            for (got, expected) in pixel.0.iter().zip(expected) {
                assert!(expected.abs_diff(u32::from(*got)) <= 10, "{x} {y}");
            }
        }
    }
}

/// Mode 8 of UASTC: five bits name it, four times eight are the colour of all sixteen pixels.
#[test]
fn a_solid_block_has_one_colour() {
    let colour = [200, 30, 77, 128];
    let bits = 0x17 | u128::from(u32::from_le_bytes(colour)) << 5;
    let level = word(UASTC_FILE, 80).expect("a level") as usize;
    let mut file = UASTC_FILE[..level].to_vec();
    file.extend(bits.to_le_bytes());
    file.extend(bits.to_le_bytes());
    // 5 × 3 pixels take two blocks.
    for (at, value) in [(20, 5), (24, 3), (88, 32), (96, 32)] {
        file = patched(&file, at, &u32::to_le_bytes(value));
    }
    let expected = RgbaImage::from_pixel(5, 3, Rgba(colour));
    assert_eq!(read(&file), Ok(expected));
}

/// A channel that a file does not have is as glTF wants it, whatever the codec makes of it.
#[test]
fn channels_are_what_the_file_says() {
    type Expected = fn([u8; 4]) -> [u8; 4];
    let opaque: Expected = |[r, g, b, _]| [r, g, b, 255];
    let red_green: Expected = |[r, _, _, a]| [r, a, 0, 255];
    for (file, channels, expected) in [
        (ETC1S_FILE, &[0, 15][..], (|pixel| pixel) as Expected),
        (ETC1S_FILE, &[3, 4], red_green),
        (UASTC_FILE, &[0], opaque),
        (UASTC_FILE, &[4], opaque),
        (UASTC_FILE, &[5], red_green),
        (UASTC_FILE, &[6], opaque),
        // The upper bits say that alpha is linear.
        (UASTC_FILE, &[0x13], |pixel| pixel),
    ] {
        let whole = read(file).expect("a picture");
        let told = read(&with_channels(file, channels)).expect("a picture");
        for (whole, told) in whole.pixels().zip(told.pixels()) {
            assert_eq!(told.0, expected(whole.0), "{channels:?}");
        }
    }
}

#[test]
fn what_is_no_flat_universal_picture_is_told() {
    let descriptor = word(UASTC_FILE, 48).expect("a descriptor") as usize;
    let notes = word(UASTC_FILE, 56).expect("keys") as usize;
    let number = |value: u32| value.to_le_bytes().to_vec();
    for (at, patch, expected) in [
        (12, number(145), "Vulkan format 145, which is not"),
        (16, number(4), "units of 4 bytes"),
        (20, number(0), "0 × 4 × 0 pixels"),
        (24, number(0), "76 × 0 × 0 pixels"),
        (28, number(2), "76 × 4 × 2 pixels"),
        (20, number(16_385), "16385 × 4 pixels, and an edge has"),
        (20, number(u32::MAX), "4294967295 × 4 pixels"),
        (20, number(80), "304 bytes, and its size asks for 320"),
        (32, number(3), "3 layers"),
        (36, number(6), "6 faces"),
        (40, number(0), "no level"),
        (44, number(1), "UASTC in supercompression scheme 1"),
        (44, number(3), "UASTC in supercompression scheme 3"),
        (descriptor + 12, vec![163], "ETC1S in supercompression"),
        (descriptor + 12, vec![167], "colour model 167"),
        (descriptor + 14, vec![17], "transfer function 17"),
        (descriptor + 15, vec![1], "colours that are multiplied"),
        (descriptor + 31, vec![9], "channels [9]"),
        (52, number(40), "a format descriptor of 40 bytes"),
        (notes + 4, b"KTXanimData\0".to_vec(), "a video"),
        (
            notes,
            b"\x13\0\0\0KTXorientation\0lu\0".to_vec(),
            "orientation 'lu', and not rd",
        ),
    ] {
        let told = read(&patched(UASTC_FILE, at, &patch)).expect_err("a fault");
        let expected = format!("a KTX2 picture of {expected}");
        assert!(told.starts_with(&expected), "{told}, not {expected}");
    }
    let upright = patched(UASTC_FILE, notes, b"\x13\0\0\0KTXorientation\0rd\0");
    assert_eq!(read(&upright), read(UASTC_FILE));
    // Keys that end without the padding of the last one.
    let length = 4 + word(UASTC_FILE, notes).expect("a length");
    assert!(!length.is_multiple_of(4));
    let unpadded = patched(UASTC_FILE, NOTES_LENGTH, &length.to_le_bytes());
    assert_eq!(read(&unpadded), read(UASTC_FILE));
    // The first mode of all is 0; 1000101 in binary is none.
    let level = word(UASTC_FILE, 80).expect("a level") as usize;
    let told = read(&patched(UASTC_FILE, level, &[0x45]));
    assert_eq!(
        told.expect_err("a fault"),
        "a KTX2 picture whose stream is damaged"
    );
}

/// Offsets beyond the end, and lengths that run over, are found before they are used.
#[test]
fn no_part_reaches_beyond_the_end() {
    for (at, long) in [
        (48, false),
        (52, false),
        (56, false),
        (60, false),
        (64, true),
        (72, true),
        (80, true),
        (88, true),
    ] {
        for value in [u64::MAX, u64::MAX / 2, 1 << 31] {
            let patch = value.to_le_bytes();
            let patch = if long { &patch[..] } else { &patch[..4] };
            for (file, _) in FILES {
                let told = read(&patched(file, at, patch));
                assert_eq!(
                    told.expect_err("a fault"),
                    "a KTX2 picture that is cut short",
                    "{at}"
                );
            }
        }
    }
    let levels = patched(UASTC_FILE, 40, &u32::MAX.to_le_bytes());
    assert_eq!(
        read(&levels).expect_err("a fault"),
        "a KTX2 picture that is cut short"
    );
    for (file, _) in FILES {
        for length in SIGN.len()..file.len() {
            assert!(read(&file[..length]).is_err(), "{length}");
        }
    }
}

/// Claims of a large picture cost nothing: what Zstandard would unpack has to be what the size asks for.
#[test]
fn a_level_that_swells_is_refused_before_it_is_unpacked() {
    let file = patched(ZSTANDARD_FILE, 96, &(1_u64 << 50).to_le_bytes());
    let told = read(&file).expect_err("a fault");
    assert_eq!(
        told,
        "a KTX2 picture of 1125899906842624 bytes, and its size asks for 192"
    );
}

#[test]
fn damaged_bytes_never_panic() {
    let mut state = 1_u64;
    let mut random = |below: usize| {
        // D. E. Knuth's MMIX (The Art of Computer Programming 2, 1997, section 3.3.4); its upper bits are the better ones.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut decoded = 0;
    for case in 0..20_000 {
        let mut bytes = FILES[case % 4].0.to_vec();
        for _ in 0..=random(3) {
            let at = SIGN.len() + random(bytes.len() - SIGN.len());
            let run = (at + 1 + random(9)).min(bytes.len());
            match random(4) {
                0 => bytes[at] ^= 1 << random(8),
                1 => bytes[at] = random(256) as u8,
                2 => bytes[at..run].fill(0xff),
                _ => bytes[at..run].fill(0),
            }
        }
        decoded += u32::from(decode(&bytes, 256).is_ok());
    }
    assert!((5_000..15_000).contains(&decoded), "{decoded}");
}
