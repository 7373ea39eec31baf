//! The picture of a sky, read: radiance in an equirectangular map, as Radiance .hdr or OpenEXR.

use crate::emission::Sky;
use crate::emission::bound::MOST_RADIANCE;
use crate::error::{Error, Result};
use glam::Vec3;
use std::path::Path;

/// An equirectangular picture of linear radiance, .hdr or .exr, that takes at most so many bytes of memory.
///
/// # Errors
/// [`Error::Read`], and [`Error::Usage`] for a file that is no such picture.
pub fn read(path: &Path, memory: u64) -> Result<Sky> {
    let bad = |got: String| Error::Usage {
        flag: "--sky".into(),
        expected: format!(
            "an equirectangular picture of radiance in {}, Radiance .hdr or OpenEXR with R, G, B",
            path.display()
        ),
        got,
        way_out: "give another file, or an even sky, e.g. --sky 1,1,1".into(),
    };
    let bytes = std::fs::read(path).map_err(|source| Error::Read {
        path: path.into(),
        source,
        way_out: "give the file of a sky, or an even one, e.g. --sky 1,1,1".into(),
    })?;
    let exr = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("exr"));
    let sky = if exr {
        read_exr(&bytes, memory)
    } else {
        read_hdr(&bytes, memory)
    }
    .map_err(&bad)?;
    let wrong = |texel: &&Vec3| {
        !texel.is_finite() || texel.min_element() < 0.0 || texel.max_element() > MOST_RADIANCE
    };
    if let Some(texel) = sky.texels.iter().find(wrong) {
        return Err(bad(format!(
            "a texel of {texel}; each channel is from 0 to {MOST_RADIANCE:e}"
        )));
    }
    if sky.texels.is_empty() {
        return Err(bad("a picture without texels".into()));
    }
    Ok(sky)
}

fn read_hdr(bytes: &[u8], memory: u64) -> std::result::Result<Sky, String> {
    let reader =
        || image::ImageReader::with_format(std::io::Cursor::new(bytes), image::ImageFormat::Hdr);
    let (width, height) = reader()
        .into_dimensions()
        .map_err(|reason| reason.to_string())?;
    fits(u64::from(width) * u64::from(height), memory)?;
    let image = reader().decode();
    let image = image.map_err(|reason| reason.to_string())?.into_rgb32f();
    Ok(Sky {
        width: image.width() as usize,
        height: image.height() as usize,
        texels: image.pixels().map(|texel| Vec3::from(texel.0)).collect(),
    })
}

/// Bytes of a texel: three floats as decoded, three as kept, and the sums by which directions are drawn.
const TEXEL: u64 = 40;

/// Refuses a picture of so many texels where they do not fit into the memory.
fn fits(texels: u64, memory: u64) -> std::result::Result<(), String> {
    let most = memory / TEXEL;
    match texels > most {
        true => Err(format!(
            "{texels} texels, of which {most} fit into the memory"
        )),
        false => Ok(()),
    }
}

/// The least bytes of a block of lines in a file: eight in the table of places, eight before its content, and one of that.
const LEAST_BLOCK: u64 = 17;

fn read_exr(bytes: &[u8], memory: u64) -> std::result::Result<Sky, String> {
    use exr::prelude::{MetaData, ReadChannels, ReadLayers, read};
    let meta = MetaData::read_from_buffered(std::io::Cursor::new(bytes), false);
    let headers = meta.map_err(|reason| reason.to_string())?.headers;
    let texels = headers.iter().map(|header| header.layer_size.area() as u64);
    fits(texels.max().unwrap_or(0), memory)?;
    let blocks: u64 = headers.iter().map(|header| header.chunk_count as u64).sum();
    if blocks.saturating_mul(LEAST_BLOCK) > bytes.len() as u64 {
        return Err(format!(
            "{} bytes, too few for the {blocks} blocks that it states",
            bytes.len()
        ));
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| Sky {
                width: size.width(),
                height: size.height(),
                texels: vec![Vec3::ZERO; size.area()],
            },
            |sky: &mut Sky, at, (r, g, b, _): (f32, f32, f32, f32)| {
                sky.texels[at.y() * sky.width + at.x()] = Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(std::io::Cursor::new(bytes))
        .map_err(|reason| reason.to_string())?;
    Ok(image.layer_data.channel_data.pixels)
}
