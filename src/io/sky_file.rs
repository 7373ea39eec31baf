//! The picture of a sky, read: radiance in an equirectangular map, as Radiance .hdr or OpenEXR.

use crate::emission::Sky;
use crate::error::{Error, Result};
use glam::Vec3;
use std::path::Path;

/// An equirectangular picture of linear radiance, .hdr or .exr.
///
/// # Errors
/// [`Error::Read`], and [`Error::Usage`] for a file that is no such picture.
pub fn read(path: &Path) -> Result<Sky> {
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
        read_exr(&bytes)
    } else {
        read_hdr(&bytes)
    }
    .map_err(&bad)?;
    let wrong = |texel: &&Vec3| !texel.is_finite() || texel.min_element() < 0.0;
    if let Some(texel) = sky.texels.iter().find(wrong) {
        return Err(bad(format!("a texel of {texel}")));
    }
    if sky.texels.is_empty() {
        return Err(bad("a picture without texels".into()));
    }
    Ok(sky)
}

fn read_hdr(bytes: &[u8]) -> std::result::Result<Sky, String> {
    let reader = std::io::Cursor::new(bytes);
    let image = image::ImageReader::with_format(reader, image::ImageFormat::Hdr).decode();
    let image = image.map_err(|reason| reason.to_string())?.into_rgb32f();
    Ok(Sky {
        width: image.width() as usize,
        height: image.height() as usize,
        texels: image.pixels().map(|texel| Vec3::from(texel.0)).collect(),
    })
}

/// The most texels of a picture, 16,384 × 16,384: a header that asks for more is broken, or not for this machine.
const MOST_TEXELS: usize = 1 << 28;

fn read_exr(bytes: &[u8]) -> std::result::Result<Sky, String> {
    use exr::prelude::{MetaData, ReadChannels, ReadLayers, read};
    let meta = MetaData::read_from_buffered(std::io::Cursor::new(bytes), false);
    let headers = meta.map_err(|reason| reason.to_string())?.headers;
    let texels = headers.iter().map(|header| header.layer_size.area());
    if let Some(texels) = texels.max().filter(|texels| *texels > MOST_TEXELS) {
        return Err(format!("{texels} texels, of which {MOST_TEXELS} fit"));
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
