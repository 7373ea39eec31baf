//! Streams made by small encoders of the specification's bitstream, its own examples, and what is broken.

use super::{attributes, bytes::Bytes, filters, indices};

/// The next number of a row that repeats itself after 2³² steps (G. Marsaglia, "Xorshift RNGs", 2003).
fn random(state: &mut u32) -> u32 {
    for (left, shift) in [(true, 13), (false, 17), (true, 5)] {
        *state ^= if left {
            *state << shift
        } else {
            *state >> shift
        };
    }
    *state
}

/// The zigzag code of a difference.
fn zigzag(difference: i32) -> u32 {
    (difference << 1 ^ difference >> 31) as u32
}

/// A number as seven bits a byte.
fn number(mut number: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number > 0x7f {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}

/// How the bytes of every group are written.
#[derive(Clone, Copy)]
enum Coding {
    /// Version 0 or 1 with groups of so many bits a byte; in version 1 the control mode.
    Groups(usize, Option<u8>),
    /// Version 1 without groups.
    Literal,
}

/// The header's two bits for a width of bits.
fn code(width: usize, control: Option<u8>) -> u8 {
    let widths = match control {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(_) => [1, 2, 4, 8],
    };
    let found = widths.iter().position(|known| *known == width);
    found.expect("a width of this control mode") as u8
}

/// Differences of one byte over a block.
fn plane(values: &[u8], coding: Coding, stream: &mut Vec<u8>) {
    let Coding::Groups(width, control) = coding else {
        return stream.extend(values);
    };
    let groups: Vec<&[u8]> = values.chunks(16).collect();
    let bits = code(width, control);
    stream.extend(
        groups
            .chunks(4)
            .map(|four| (0..four.len()).fold(0, |byte, at| byte | bits << (2 * at))),
    );
    for group in groups {
        let mut group = group.to_vec();
        group.resize(16, 0);
        if matches!(width, 0 | 8) {
            stream.extend(&group[..2 * width]);
            continue;
        }
        let (all, each) = ((1_u32 << width) - 1, 8 / width);
        for packed in group.chunks(each) {
            let byte = packed.iter().enumerate().fold(0, |byte, (at, value)| {
                let place = if width == 1 { at } else { each - 1 - at };
                byte | u32::from(*value).min(all) << (place * width)
            });
            stream.push(byte as u8);
        }
        stream.extend(group.iter().filter(|value| u32::from(**value) >= all));
    }
}

/// Elements as a stream; `mode` is the channels' in version 1.
fn encoded(values: &[u8], stride: usize, coding: Coding, mode: Option<u8>) -> Vec<u8> {
    let mut stream = vec![if mode.is_some() { 0xa1 } else { 0xa0 }];
    let first = vec![7; stride];
    let most = (8192 / stride / 16 * 16).min(256);
    let mut before = first.clone();
    for block in values.chunks(most * stride) {
        let control = match coding {
            Coding::Literal => 0xff,
            Coding::Groups(_, control) => control.unwrap_or(0) * 0x55,
        };
        stream.extend(mode.iter().flat_map(|_| vec![control; stride / 4]));
        for word in 0..stride / 4 {
            // The differences of a word, element by element.
            let mut planes: [Vec<u8>; 4] = Default::default();
            let place = |at: usize| at * stride + 4 * word;
            for at in 0..block.len() / stride {
                let last = if at == 0 {
                    &before[4 * word..]
                } else {
                    &block[place(at - 1)..]
                };
                let here = &block[place(at)..];
                let halves = |bytes: &[u8], at| i16::from_le_bytes([bytes[at], bytes[at + 1]]);
                let words =
                    |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                let differences: Vec<u8> = match mode.unwrap_or(0) & 15 {
                    0 => (0..4)
                        .map(|b| zigzag(i32::from(here[b].wrapping_sub(last[b]) as i8)) as u8)
                        .collect(),
                    1 => [0, 2]
                        .into_iter()
                        .map(|b| halves(here, b).wrapping_sub(halves(last, b)))
                        .flat_map(|step| (zigzag(i32::from(step)) as u16).to_le_bytes())
                        .collect(),
                    _ => {
                        let turn = u32::from(mode.unwrap_or(0) >> 4);
                        (words(here) ^ words(last))
                            .rotate_left(turn)
                            .to_le_bytes()
                            .into()
                    }
                };
                planes
                    .iter_mut()
                    .zip(differences)
                    .for_each(|(plane, byte)| plane.push(byte));
            }
            planes
                .iter()
                .for_each(|values| plane(values, coding, &mut stream));
        }
        before = block[block.len() - stride..].to_vec();
    }
    let modes = mode.map_or(Vec::new(), |mode| vec![mode; stride / 4]);
    let least: usize = if mode.is_some() { 24 } else { 32 };
    stream.resize(stream.len() + least.saturating_sub(stride + modes.len()), 0);
    stream.extend(first);
    stream.extend(modes);
    stream
}

#[test]
fn attributes_come_back_from_every_coding() {
    let codings = [
        (Coding::Groups(0, None), None),
        (Coding::Groups(2, None), None),
        (Coding::Groups(4, None), None),
        (Coding::Groups(8, None), None),
        (Coding::Groups(1, Some(0)), Some(0x00)),
        (Coding::Groups(4, Some(0)), Some(0x01)),
        (Coding::Groups(1, Some(1)), Some(0x42)),
        (Coding::Groups(2, Some(1)), Some(0x02)),
        (Coding::Groups(8, Some(1)), Some(0xf2)),
        (Coding::Literal, Some(0x01)),
        (Coding::Literal, Some(0x72)),
    ];
    let mut state = 1;
    for (coding, mode) in codings {
        for stride in [4, 12, 64, 256] {
            for count in [1, 15, 16, 17, 255, 256, 257, 600] {
                // Without differences all elements are as the first.
                let still = matches!(coding, Coding::Groups(0, _));
                let values: Vec<u8> = (0..count * stride)
                    .map(|_| if still { 7 } else { random(&mut state) as u8 })
                    .collect();
                let stream = encoded(&values, stride, coding, mode);
                let decoded = attributes::decode(&stream, count, stride);
                assert_eq!(decoded, Ok(values), "{mode:?} {stride} {count}");
            }
        }
    }
}

#[test]
fn the_specifications_examples_are_decoded() {
    // Sixteen differences of four bits, in the first of four bytes.
    let packed = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
    let differences = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0_i8];
    let stream = [&[0xa0, 2][..], &packed, &[0, 0, 0], &[0; 32]].concat();
    let decoded = attributes::decode(&stream, 16, 4).expect("a stream");
    let mut value = 0_u8;
    for (element, difference) in decoded.chunks(4).zip(differences) {
        value = value.wrapping_add(difference as u8);
        assert_eq!(element, [value, 0, 0, 0]);
    }

    // The third stands there with its bytes the other way round, unlike the second and every encoder.
    let numbers: [(&[u8], u32); 3] = [
        (&[0x7f], 0x7f),
        (&[0x81, 0x04], 0x201),
        (&[0x85, 0xa0, 0x7f], 0x1f_d005),
    ];
    for (bytes, expected) in numbers {
        assert_eq!(Bytes(bytes).number(), Ok(expected));
    }
    assert!(Bytes(&[0x80; 6]).number().is_err());
}

fn shorts(values: &[u8]) -> Vec<u16> {
    values
        .chunks(2)
        .map(|two| u16::from_le_bytes([two[0], two[1]]))
        .collect()
}

#[test]
fn triangles_follow_from_those_before() {
    // A first triangle of the table; one on its last edge; with a recent corner; beside the last; read; restarted.
    let codes = [0xf0, 0x00, 0x01, 0x0e, 0x0d, 0x0f, 0xfe, 0xff];
    let data = [
        &number(zigzag(40))[..],
        &[0x00],
        &[0xff],
        &number(zigzag(-30)),
        &number(2),
        &number(2),
    ];
    let stream = [&[0xe1][..], &codes, &data.concat(), &[0; 16]].concat();
    let decoded = indices::triangles(&stream, 24, 2).expect("a stream");
    let expected = [
        [0, 1, 2],
        [0, 2, 3],
        // The edge from 0 to 3, with the corner before 3.
        [0, 3, 2],
        // One after the last read corner, which was none: 1; one before it: 0.
        [0, 2, 1],
        [0, 1, 0],
        [0, 0, 40],
        // The count of new corners begins again.
        [0, 1, 2],
        [10, 11, 12],
    ];
    assert_eq!(shorts(&decoded), expected.concat());

    // Any corners at all can be written one by one.
    let mut state = 5;
    let corners: Vec<u32> = (0..300).map(|_| random(&mut state)).collect();
    let (mut data, mut last) = (Vec::new(), 0_u32);
    for triangle in corners.chunks(3) {
        data.push(0xff);
        for corner in triangle {
            data.extend(number(zigzag(corner.wrapping_sub(last) as i32)));
            last = *corner;
        }
    }
    let stream = [&[0xe1][..], &[0xff; 100], &data, &[0; 16]].concat();
    let expected: Vec<u8> = corners
        .iter()
        .flat_map(|corner| corner.to_le_bytes())
        .collect();
    assert_eq!(indices::triangles(&stream, 300, 4), Ok(expected));
}

#[test]
fn indices_step_from_two_last_ones() {
    let rows = [[5, 1000], [7, 1001], [3, 1003]];
    let mut stream = vec![0xd1];
    let mut last = [0; 2];
    for row in rows {
        for (baseline, index) in row.into_iter().enumerate() {
            stream.extend(number(
                zigzag(index - last[baseline]) << 1 | baseline as u32,
            ));
            last[baseline] = index;
        }
    }
    stream.extend([0; 4]);
    let expected: Vec<u16> = rows.concat().iter().map(|index| *index as u16).collect();
    assert_eq!(
        shorts(&indices::indices(&stream, 6, 2).expect("a stream")),
        expected
    );
}

#[test]
fn filters_give_what_the_formulas_say() {
    // Axes and a diagonal on the octahedron; the last number is untouched.
    let mut vectors: Vec<u8> = [
        [127, 0, 127, 5],
        [0, -127, 127, 6],
        [127, 127, 127, 7],
        [0, 0, 127, 8_i8],
    ]
    .as_flattened()
    .iter()
    .map(|lane| *lane as u8)
    .collect();
    filters::octahedral(&mut vectors, 4);
    let signed: Vec<i8> = vectors.iter().map(|lane| *lane as i8).collect();
    assert_eq!(
        signed,
        [127, 0, 0, 5, 0, -127, 0, 6, 0, 0, -127, 7, 0, 0, 127, 8]
    );

    // The identity's largest number is its last; half a turn about x has its first.
    for (place, expected) in [(3, [0, 0, 0, 32767]), (0, [32767, 0, 0, 0_i16])] {
        let one = 0x7ffc | place;
        let mut turn: Vec<u8> = [0, 0, 0, one]
            .iter()
            .flat_map(|lane: &i16| lane.to_le_bytes())
            .collect();
        filters::quaternion(&mut turn);
        let lanes: Vec<i16> = shorts(&turn).into_iter().map(|lane| lane as i16).collect();
        assert_eq!(lanes, expected);
    }

    // 3 × 2⁻¹, −5 × 2³, and the least exponent there may be.
    for (exponent, mantissa) in [(-1, 3), (3, -5), (-100, 1), (100, -1), (-128, 1)] {
        let mut bits = (exponent << 24 | mantissa & 0xff_ffff_i32).to_le_bytes();
        filters::exponential(&mut bits);
        let expected = (f64::from(mantissa) * 2_f64.powi(exponent)) as f32;
        assert_eq!(f32::from_le_bytes(bits), expected);
    }

    // Luma 100, orange by 10, green by 20, alpha whole: eight bits as the highest of alpha says.
    let mut colour = [100, 10, 20, 0xff];
    filters::colour(&mut colour, 4);
    assert_eq!(colour, [90, 120, 70, 255]);
}

#[test]
fn broken_streams_are_refused_and_never_panic() {
    type Decode = fn(&[u8]) -> super::bytes::Stream;
    let mut state = 9;
    let values: Vec<u8> = (0..40 * 8).map(|_| random(&mut state) as u8).collect();
    let old = encoded(&values, 8, Coding::Groups(4, None), None);
    let new = encoded(&values, 8, Coding::Groups(2, Some(1)), Some(1));
    let triangles = [
        &[0xe1][..],
        &[0xf0, 0x00, 0x01, 0x0f],
        &number(80),
        &[0; 16],
    ]
    .concat();
    let steps = [&[0xd1][..], &number(4), &number(9), &number(300), &[0; 4]].concat();
    let streams: [(Vec<u8>, Decode); 4] = [
        (old, |stream| attributes::decode(stream, 40, 8)),
        (new, |stream| attributes::decode(stream, 40, 8)),
        (triangles, |stream| indices::triangles(stream, 12, 4)),
        (steps, |stream| indices::indices(stream, 3, 2)),
    ];
    for (stream, decode) in streams {
        assert!(decode(&stream).is_ok());
        for length in 0..stream.len() {
            assert!(decode(&stream[..length]).is_err(), "cut at {length}");
        }
        let more = [&stream[..], &[0]].concat();
        assert!(decode(&more).is_err());
        for at in 0..stream.len() {
            for value in [0, 1, 0x0f, 0x7f, 0x80, 0xf0, 0xff] {
                let mut damaged = stream.clone();
                damaged[at] = value;
                // Whether it is told is not the question: it may be another stream.
                let _ = decode(&damaged);
            }
        }
    }
    // A corner that was never there.
    let early = [&[0xe1][..], &[0x00], &[0; 16]].concat();
    assert!(indices::triangles(&early, 3, 2).is_err_and(|told| told.contains("not there yet")));
}
