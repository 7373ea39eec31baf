//! An image as the bytes of an OpenEXR file: linear radiance, channels R, G and B, with further layers and notes.
//!
//! One part of scan lines in ZIP blocks of 16 lines: what every reader opens, and lossless. Layers are channels with a dot
//! in their names. The rate is in `framesPerSecond`, where OpenEXR's own attributes have a place for it.

use std::collections::BTreeMap;
use std::io::Cursor;

use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples,
    Image as File, Layer, LayerAttributes, LineOrder, SmallVec, Text, WritableImage,
};
use half::f16;

use crate::image::film::Image;
use crate::io::channel::ImageChannel;
use crate::io::rate;

/// The EXR of an image, in 32-bit floats or 16-bit halves; the error is what the encoder said.
///
/// Halves end at 65504; brighter radiance is written as that, not as infinity. Notes become text attributes; `fps` is left
/// out where it is 0.
pub fn encode(
    image: &Image,
    layers: &[ImageChannel],
    float: bool,
    fps: f64,
    notes: &[(String, String)],
) -> Result<Vec<u8>, String> {
    let pixels = image.radiance.len();
    if let Some(layer) = layers.iter().find(|layer| layer.values.len() != pixels) {
        let values = layer.values.len();
        return Err(format!(
            "{} holds {values} values for {pixels} pixels",
            layer.name
        ));
    }
    let notes = notes.iter().map(|(key, text)| (clean(key), clean(text)));
    let notes: BTreeMap<String, String> = notes.collect();
    let size = (image.width as usize, image.height as usize);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let file = File::from_layer(Layer::new(
        size,
        attributes(fps, &notes),
        encoding,
        AnyChannels::sort(channels(image, layers, float)),
    ));
    let mut bytes = Cursor::new(Vec::new());
    file.write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|error| error.to_string())?;
    let mut bytes = bytes.into_inner();
    sort_notes(&mut bytes, &notes);
    Ok(bytes)
}

/// The picture's channels, then those of the layers.
fn channels(
    image: &Image,
    layers: &[ImageChannel],
    float: bool,
) -> SmallVec<[AnyChannel<FlatSamples>; 4]> {
    let samples = |values: &mut dyn Iterator<Item = f32>, float: bool| match float {
        true => FlatSamples::F32(values.collect()),
        false => FlatSamples::F16(values.map(half).collect()),
    };
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = ["R", "G", "B"]
        .iter()
        .enumerate()
        .map(|(index, &name)| {
            let mut values = image.radiance.iter().map(|pixel| pixel[index]);
            AnyChannel::new(name, samples(&mut values, float))
        })
        .collect();
    channels.extend(layers.iter().map(|layer| {
        let mut values = layer.values.iter().copied();
        AnyChannel::new(
            layer.name.as_str(),
            samples(&mut values, float || layer.exact),
        )
    }));
    channels
}

/// The attributes of the header: the frame rate, and the notes as text.
fn attributes(fps: f64, notes: &BTreeMap<String, String>) -> LayerAttributes {
    let mut attributes = LayerAttributes::default();
    if fps > 0.0 {
        let (frames, seconds) = rate::fraction(fps);
        attributes.frames_per_second = Some((frames as i32, seconds));
    }
    for (key, text) in notes {
        attributes
            .other
            .insert(utf8(key), AttributeValue::Text(utf8(text)));
    }
    attributes
}

/// Put the notes into the order of their names.
///
/// The exr crate keeps own attributes in a hash map, so the same image would come out in other bytes each time. They are
/// the last attributes of the header, side by side; sorting them moves nothing else.
fn sort_notes(bytes: &mut [u8], notes: &BTreeMap<String, String>) {
    let coded: Vec<Vec<u8>> = notes
        .iter()
        .map(|(key, text)| {
            let length = (text.len() as u32).to_le_bytes();
            [key.as_bytes(), b"\0string\0", &length, text.as_bytes()].concat()
        })
        .collect();
    let starts = coded
        .iter()
        .map(|note| bytes.windows(note.len()).position(|window| window == note));
    if let Some(start) = starts.flatten().min() {
        let sorted = coded.concat();
        bytes[start..start + sorted.len()].copy_from_slice(&sorted);
    }
}

/// Text without zero bytes, which would end it.
fn clean(text: &str) -> String {
    text.replace('\0', " ")
}

/// The nearest half; beyond the largest one, that one.
fn half(value: f32) -> f16 {
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}

/// Text as OpenEXR keeps it, which is UTF-8.
fn utf8(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use ::exr::prelude::{ReadChannels, ReadLayers, read};

    use super::*;

    /// Channels by name, as floats, and the note `scene`.
    fn decode(bytes: Vec<u8>) -> (Vec<(String, Vec<f32>)>, Option<AttributeValue>) {
        let reader = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer();
        let file = reader
            .all_attributes()
            .from_buffered(Cursor::new(bytes))
            .expect("an EXR");
        let layer = file.layer_data;
        assert_eq!(layer.encoding.compression, Compression::ZIP16);
        let channels = layer.channel_data.list.iter();
        let values = channels.map(|channel| {
            (
                channel.name.to_string(),
                channel.sample_data.values_as_f32().collect(),
            )
        });
        (
            values.collect(),
            layer.attributes.other.get(&utf8("scene")).cloned(),
        )
    }

    fn image() -> Image {
        Image {
            width: 1,
            height: 2,
            radiance: vec![[0.1, 2.0, 1e6], [-3.0, 65504.0, f32::INFINITY]],
        }
    }

    #[test]
    fn floats_come_back_bit_by_bit() {
        let notes = [("scene".to_string(), "Tür".to_string())];
        let (channels, note) = decode(encode(&image(), &[], true, 24.0, &notes).expect("an EXR"));
        assert_eq!(channels[0], ("B".into(), vec![1e6, f32::INFINITY]));
        assert_eq!(channels[1], ("G".into(), vec![2.0, 65504.0]));
        assert_eq!(channels[2], ("R".into(), vec![0.1, -3.0]));
        assert_eq!(note, Some(AttributeValue::Text(utf8("Tür"))));
    }

    #[test]
    fn notes_stand_in_the_order_of_their_names() {
        let notes = ["e", "b", "scene", "d", "a", "c"]
            .map(|name| (name.to_string(), format!("{name} is\0x")));
        let bytes = encode(&image(), &[], false, 24.0, &notes).expect("an EXR");
        let expected = ["a", "b", "c", "d", "e", "scene"].map(|name| {
            [
                name.as_bytes(),
                b"\0string\0",
                &[name.len() as u8 + 5, 0, 0, 0],
                name.as_bytes(),
                b" is x",
            ]
            .concat()
        });
        let (first, sorted) = (&expected[0], expected.concat());
        let start = bytes
            .windows(first.len())
            .position(|window| window == first)
            .expect("a note");
        assert_eq!(bytes[start..start + sorted.len()], sorted);
        assert_eq!(
            decode(bytes).1,
            Some(AttributeValue::Text(utf8("scene is x")))
        );
    }

    #[test]
    fn layers_come_back_by_name_and_whole_numbers_stay_whole() {
        let layer = |name: &str, exact| ImageChannel {
            name: name.into(),
            values: vec![4097.0, -1.0],
            exact,
        };
        let layers = [layer("patch.X", true), layer("albedo.R", false)];
        let (channels, _) = decode(encode(&image(), &layers, false, 24.0, &[]).expect("an EXR"));
        let names: Vec<&str> = channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["B", "G", "R", "albedo.R", "patch.X"]);
        assert_eq!(channels[4].1, [4097.0, -1.0]);
        assert_eq!(channels[3].1, [4096.0, -1.0], "a half has 11 bits");
        let mut short = layer("depth.Z", true);
        short.values.pop();
        let told = encode(&image(), &[short], false, 24.0, &[]);
        assert_eq!(told, Err("depth.Z holds 1 values for 2 pixels".into()));
    }

    #[test]
    fn halves_are_rounded_and_stay_finite() {
        let (channels, note) = decode(encode(&image(), &[], false, 0.0, &[]).expect("an EXR"));
        assert_eq!(channels[0], ("B".into(), vec![65504.0, 65504.0]));
        assert_eq!(channels[1], ("G".into(), vec![2.0, 65504.0]));
        // The half nearest to 0.1 is 1638 / 2^14.
        assert_eq!(channels[2], ("R".into(), vec![0.099_975_586, -3.0]));
        assert_eq!(note, None);
    }
}
