//! Textures on materials, and the pictures behind them, each decoded once.

use super::buffers::MOST_BYTES;
use super::import::{Import, known};
use super::refused::{self, unsupported};
use crate::error::{Error, Result};
use crate::ids::TextureId;
use crate::scene::Map;
use crate::texture::{self, Texture, TexturePicture, TextureUse, Wrap};
use glam::{Affine2, Vec2, Vec4};
use gltf::json;
use gltf::json::texture::{MagFilter, WrappingMode};
use serde_json::Value;
use std::collections::HashMap;
use std::sync::Arc;

/// Most pixels of all pictures together: sixteen of 4096², 2.9 GB with their halves. Half of it halves the memory that a
/// small file of well-packed pictures can ask for.
const MOST_PIXELS: u64 = 1 << 28;

/// Bytes of a pixel that is kept: eight, and a third for its halves.
const KEPT_PIXEL: u64 = 11;

/// Bytes of a pixel while it is decoded: at most eight as the file has it, eight of them made light, and what is kept.
const DECODED_PIXEL: u64 = 27;

/// Where a texture names its image, the preferred first: WebP loses less than KTX2 does.
const SOURCES: [&str; 3] = [
    "extensions/EXT_texture_webp/source",
    "extensions/KHR_texture_basisu/source",
    "source",
];

/// The pictures decoded so far, by image and meaning, and the textures made of them.
#[derive(Default)]
pub(super) struct Pictures {
    pub(super) textures: Vec<Texture>,
    places: HashMap<(usize, TextureUse, [Wrap; 2], bool), TextureId>,
    decoded: HashMap<(usize, TextureUse), Arc<TexturePicture>>,
    means: HashMap<usize, Vec4>,
    pixels: u64,
}

/// The set of texture coordinates that a texture asks for.
pub(super) fn set(info: &json::texture::Info) -> u32 {
    transform(info)
        .and_then(|transform| transform.tex_coord)
        .unwrap_or(info.tex_coord)
}

/// From a set's coordinates to the texture's.
pub(super) fn placed(info: &json::texture::Info) -> Affine2 {
    // Scale, turn and shift coordinates: v points down, so a turn counter-clockwise has its sine the other way.
    transform(info).map_or(Affine2::IDENTITY, |json| {
        let (scale, offset) = (Vec2::from(json.scale.0), Vec2::from(json.offset.0));
        Affine2::from_scale_angle_translation(scale, -json.rotation.0, offset)
    })
}

fn transform(info: &json::texture::Info) -> Option<&json::extensions::texture::TextureTransform> {
    info.extensions.as_ref()?.texture_transform.as_ref()
}

impl Import<'_> {
    /// A texture as it lies on a material; nothing where the file's texture has no picture. `user` is its JSON pointer.
    pub(super) fn map(
        &self,
        info: &json::texture::Info,
        user: &str,
        kind: TextureUse,
        pictures: &mut Pictures,
    ) -> Result<Option<Map>> {
        let moved = placed(info);
        if !moved.is_finite() {
            return Err(self.store.broken(
                format!("{user}/extensions/KHR_texture_transform"),
                "finite numbers",
                format!("{:?}", transform(info)),
                "correct the material and export the file again",
            ));
        }

        // Find or decode its picture.
        let texture = info.index.value();
        let Some((image, pointer)) = self.image_of(texture, user)? else {
            return Ok(None);
        };
        let (wrap, nearest) = self.sampler(texture)?;
        let key = (image, kind, wrap, nearest);
        let place = match pictures.places.get(&key) {
            Some(place) => *place,
            None => {
                let picture = self.decoded(image, &pointer, kind, pictures)?;
                let place = TextureId::from_index(pictures.textures.len());
                pictures.textures.push(Texture {
                    picture,
                    wrap,
                    nearest,
                });
                pictures.places.insert(key, place);
                place
            }
        };
        Ok(Some(Map {
            texture: place,
            set: set(info),
            transform: moved,
        }))
    }

    /// The mean of a texture's plain numbers; nothing where the file's texture has no picture.
    pub(super) fn mean(
        &self,
        info: &json::texture::Info,
        user: &str,
        pictures: &mut Pictures,
    ) -> Result<Option<Vec4>> {
        let Some((image, pointer)) = self.image_of(info.index.value(), user)? else {
            return Ok(None);
        };
        if let Some(mean) = pictures.means.get(&image) {
            return Ok(Some(*mean));
        }
        let mean = self
            .decode(image, &pointer, TextureUse::Numbers, MOST_PIXELS)?
            .mean();
        pictures.means.insert(image, mean);
        Ok(Some(mean))
    }

    /// The image of a texture, and the JSON pointer that names it: one of an extension is preferred, as they ask.
    fn image_of(&self, texture: usize, user: &str) -> Result<Option<(usize, String)>> {
        if texture >= self.root.textures.len() {
            let pointer = format!("{user}/index");
            let count = self.root.textures.len();
            return Err(self.store.missing(pointer, "texture", texture, count));
        }
        let sources = SOURCES.iter().map(|place| {
            let pointer = format!("/textures/{texture}/{place}");
            let image = self.at(&pointer).and_then(Value::as_u64)?;
            Some((image as usize, pointer))
        });
        Ok(match sources.flatten().next() {
            Some(found) => Some(found),
            None => {
                // A picture that only an extension points to is not left out in silence.
                let others = self.at(&format!("/textures/{texture}/extensions"));
                let mut others = others.and_then(Value::as_object).into_iter().flatten();
                if let Some((name, _)) = others.find(|(_, other)| other.get("source").is_some()) {
                    return Err(unsupported(self.file, name));
                }
                None
            }
        })
    }

    /// Wrapping of a texture, and whether its magFilter is NEAREST.
    fn sampler(&self, texture: usize) -> Result<([Wrap; 2], bool)> {
        let sampler = match self.root.textures[texture].sampler.map(|s| s.value()) {
            None => None,
            Some(sampler) => match self.root.samplers.get(sampler) {
                Some(json) => Some(json),
                None => {
                    let pointer = format!("/textures/{texture}/sampler");
                    let count = self.root.samplers.len();
                    return Err(self.store.missing(pointer, "sampler", sampler, count));
                }
            },
        };
        let wrap = |mode: Option<WrappingMode>| match mode {
            Some(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Some(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            Some(WrappingMode::Repeat) | None => Wrap::Repeat,
        };
        let wraps = [
            wrap(sampler.and_then(|sampler| known(sampler.wrap_s))),
            wrap(sampler.and_then(|sampler| known(sampler.wrap_t))),
        ];
        let near = sampler.and_then(|sampler| known(sampler.mag_filter?));
        Ok((wraps, near == Some(MagFilter::Nearest)))
    }

    /// An image's picture, decoded the first time.
    fn decoded(
        &self,
        image: usize,
        user: &str,
        kind: TextureUse,
        pictures: &mut Pictures,
    ) -> Result<Arc<TexturePicture>> {
        if let Some(picture) = pictures.decoded.get(&(image, kind)) {
            return Ok(picture.clone());
        }
        let room = MOST_PIXELS - pictures.pixels;
        let picture = Arc::new(self.decode(image, user, kind, room)?);
        pictures.pixels += picture.levels[0].pixels.len() as u64;
        pictures.decoded.insert((image, kind), picture.clone());
        Ok(picture)
    }

    /// A picture of at most `room` pixels.
    fn decode(
        &self,
        image: usize,
        user: &str,
        kind: TextureUse,
        room: u64,
    ) -> Result<TexturePicture> {
        let bytes = self.picture(image, user)?;
        let pointer = format!("/images/{image}");
        let pixels = texture::pixels(&bytes);
        let held = MOST_PIXELS - room;
        let bytes_needed = pixels
            .saturating_mul(DECODED_PIXEL)
            .saturating_add(held * KEPT_PIXEL);
        if bytes_needed > self.limits.memory {
            let [needs, fits] = [bytes_needed, self.limits.memory].map(|b| b as f64 / 1e9);
            return Err(Error::Usage {
                flag: "--memory".into(),
                expected: format!("a scene whose pictures fit into the {fits:.1} GB there are"),
                got: format!(
                    "{pointer} of {}: {pixels} pixels, {needs:.1} GB in all",
                    self.file.display()
                ),
                way_out: "export the file with smaller textures, or give more --memory".into(),
            });
        }
        if pixels > room {
            let expected = format!("at most {MOST_PIXELS} pixels in all pictures together");
            let got = format!("{pixels} with room left for {room}");
            let way_out = "export the file with smaller textures";
            return Err(self.store.broken(pointer, expected, got, way_out));
        }
        TexturePicture::decode(&bytes, kind).map_err(|reason| {
            if let Some(known) = refused::picture(self.file, &pointer, &bytes) {
                return known;
            }
            let way_out = "export the file with PNG, JPEG or WebP textures";
            let expected = "a PNG, JPEG, WebP or KTX2 picture";
            self.store.broken(pointer, expected, reason, way_out)
        })
    }

    /// The bytes of an image file.
    fn picture(&self, image: usize, user: &str) -> Result<Vec<u8>> {
        let Some(json) = self.root.images.get(image) else {
            return Err(self
                .store
                .missing(user.into(), "image", image, self.root.images.len()));
        };
        let pointer = format!("/images/{image}");
        match (json.buffer_view, &json.uri) {
            (Some(view), _) => Ok(self
                .store
                .view(view.value(), &format!("{pointer}/bufferView"))?
                .0
                .to_vec()),
            (None, Some(uri)) => super::fetch(
                self.file,
                uri,
                &format!("{pointer}/uri"),
                MOST_BYTES,
                self.limits.external,
            ),
            (None, None) => {
                Err(self
                    .store
                    .faulty(pointer, "an address or a buffer view", "neither"))
            }
        }
    }
}
