//! Pictures, colours and materials.

use super::{cart, open, put, tell, told};
use crate::error::Result;
use crate::scene::Handled;
use crate::texture::{TexturePicture, Wrap};
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

/// A PNG of pixels in one row, as a data address.
pub(super) fn png(pixels: &[[u8; 4]]) -> String {
    let picture = image::RgbaImage::from_raw(pixels.len() as u32, 1, pixels.concat());
    png_of(&picture.expect("four bytes a pixel"))
}

/// A PNG of a picture, as a data address.
fn png_of(picture: &image::RgbaImage) -> String {
    let mut png = Vec::new();
    picture
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .expect("a PNG in memory");
    address("image/png", &png)
}

/// Bytes as a data address.
fn address(kind: &str, bytes: &[u8]) -> String {
    let hex: String = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    format!("data:{kind},{hex}")
}

/// The cart with a picture of two pixels, left red and there, right green and gone, on the base colour.
fn painted() -> Value {
    let mut json = cart();
    json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    json["textures"] = json!([{"source": 0}]);
    json["images"] = json!([{"uri": png(&[[255, 0, 0, 255], [0, 255, 0, 0]])}]);
    json
}

#[test]
fn each_texture_takes_the_set_it_asks_for() -> Result<()> {
    let mut json = painted();
    json["materials"][0]["emissiveTexture"] = json!({"index": 0, "texCoord": 4294967295u32,
        "extensions": {"KHR_texture_transform": {"texCoord": 3, "offset": [0.25, 0]}}});
    let primitive = "/meshes/0/primitives/0/attributes";
    put(
        &mut json,
        primitive,
        json!({"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_3": 1}),
    );
    let cart = open(&json)?;
    let sets: Vec<u32> = cart.meshes[0]
        .texcoords
        .iter()
        .map(|(set, _)| *set)
        .collect();
    assert_eq!(sets, [0, 3]);
    let map = cart.materials[0].emission_map.expect("a texture");
    assert_eq!((map.texture.index(), map.set), (0, 3));
    assert_eq!(map.transform.translation, Vec2::new(0.25, 0.0));
    // Without its set the emissive texture is left out, and the other stays.
    put(
        &mut json,
        primitive,
        json!({"POSITION": 0, "TEXCOORD_0": 1}),
    );
    let cart = open(&json)?;
    assert_eq!(cart.materials[0].emission_map, None);
    assert!(cart.materials[0].base_map.is_some() && cart.warnings.len() == 1);
    let pointer = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions";
    put(
        &mut json,
        pointer,
        json!({"KHR_texture_transform": {"scale": [1e39, 1]}}),
    );
    assert!(tell(open(&json)).contains(&format!(
        "{pointer}/KHR_texture_transform/scale: expected 2 finite"
    )));
    Ok(())
}

#[test]
fn corners_have_colours() -> Result<()> {
    // Three corners of four bytes each: the normalized bytes of the first two floats and a half of the buffer, which
    // hold x = 0, y = 0, z = 0 of the first corner; then the indices 0, 0, 1, 0 and so on from byte 60.
    let mut json = cart();
    json["accessors"][3] = json!({"bufferView": 2, "componentType": 5121, "normalized": true, "count": 1, "type": "VEC4"});
    put(
        &mut json,
        "/meshes/0/primitives/0/attributes/COLOR_0",
        3.into(),
    );
    json["animations"] = json!([]);
    let told = tell(open(&json));
    assert!(
        told.contains("COLOR_0: expected 3 colours, one per position, got 1"),
        "{told}"
    );
    // The positions read as colours: (0, 0, 0), (1, 0, 0), (0, 1, 0), each with alpha 1.
    put(
        &mut json,
        "/meshes/0/primitives/0/attributes/COLOR_0",
        0.into(),
    );
    let cart = open(&json)?;
    assert_eq!(
        cart.meshes[0].colors,
        [Vec4::W, Vec4::X + Vec4::W, Vec4::Y + Vec4::W]
    );
    Ok(())
}

#[test]
fn alpha_cuts_where_the_material_says() -> Result<()> {
    let cutoff = |change: Value| -> Result<(Option<f32>, usize)> {
        let mut json = painted();
        for (field, value) in change.as_object().expect("fields") {
            json["materials"][0][field] = value.clone();
        }
        let cart = open(&json)?;
        Ok((cart.materials[0].cutoff, cart.warnings.len()))
    };
    assert_eq!(cutoff(json!({"alphaCutoff": 0.25}))?, (None, 0));
    assert_eq!(cutoff(json!({"alphaMode": "MASK"}))?, (Some(0.5), 0));
    assert_eq!(
        cutoff(json!({"alphaMode": "MASK", "alphaCutoff": 0.25}))?,
        (Some(0.25), 0)
    );
    assert_eq!(cutoff(json!({"alphaMode": "BLEND"}))?, (Some(0.5), 1));
    let expected = "/materials/0/alphaMode: expected OPAQUE, MASK or BLEND";
    assert!(told("/materials/0/alphaMode", "CUT".into()).contains(expected));
    let expected = "/materials/0/alphaCutoff: expected a number of at least 0";
    assert!(told("/materials/0/alphaCutoff", (-1).into()).contains(expected));
    Ok(())
}

#[test]
fn metal_is_told_by_name() -> Result<()> {
    let mut json = painted();
    json["materials"][0]["name"] = "gold".into();
    let pbr = "/materials/0/pbrMetallicRoughness";
    put(&mut json, &format!("{pbr}/metallicFactor"), 0.5.into());
    let cart = open(&json)?;
    assert_eq!(cart.materials[0].metallic, 0.5);
    assert!(
        cart.warnings.len() == 1 && cart.warnings[0].contains("'gold'"),
        "{:?}",
        cart.warnings
    );
    // Blue is metal: a picture whose mean blue is (51 + 0) / 2 / 255 = 1/10.
    json["images"][0]["uri"] = png(&[[255, 255, 51, 0], [255, 255, 0, 255]]).into();
    put(
        &mut json,
        &format!("{pbr}/metallicRoughnessTexture"),
        json!({"index": 0}),
    );
    assert!((open(&json)?.materials[0].metallic - 0.05).abs() < 1e-4);
    json["images"][0]["uri"] = png(&[[255, 255, 0, 255]]).into();
    let cart = open(&json)?;
    assert_eq!((cart.materials[0].metallic, cart.warnings.len()), (0.0, 0));
    let expected = "metallicFactor: expected a number from 0 to 1, got 1.5";
    assert!(told(&format!("{pbr}/metallicFactor"), 1.5.into()).contains(expected));
    Ok(())
}

#[test]
fn the_unlit_send_no_light() -> Result<()> {
    let mut json = painted();
    json["extensionsRequired"] = json!(["KHR_materials_unlit"]);
    json["materials"][0]["extensions"] = json!({"KHR_materials_unlit": {}});
    json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = 1.into();
    let cart = open(&json)?;
    let material = &cart.materials[0];
    assert!(material.unlit && material.emission() == Vec3::ZERO && cart.warnings.is_empty());
    Ok(())
}

#[test]
fn textures_are_read_and_their_coordinates_moved() -> Result<()> {
    let mut json = cart();
    json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0, "extensions":
        {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 3]}}});
    json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    json["textures"] = json!([{"source": 0, "sampler": 0}]);
    json["images"] = json!([{"uri": png(&[[255, 0, 0, 255]])}]);
    let cart = open(&json)?;
    let map = cart.materials[0].base_map.expect("a texture");
    assert_eq!((map.texture.index(), map.set), (0, 0));
    assert_eq!(cart.textures[0].wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(cart.textures[0].at(Vec2::splat(0.3)), Vec3::X);
    // (1, 0) scaled is (2, 0), turned a quarter with v down (0, −2), shifted (0.5, −2); (0, 1) goes to (3.5, 0).
    let (set, texcoords) = &cart.meshes[0].texcoords[0];
    assert_eq!((*set, texcoords.len()), (0, 3));
    for (uv, expected) in texcoords.iter().zip([[0.5, 0.0], [0.5, -2.0], [3.5, 0.0]]) {
        let uv = map.transform.transform_point2(*uv);
        assert!(uv.distance(Vec2::from(expected)) < 1e-6, "{uv}");
    }

    json["images"][0]["uri"] = "data:image/png;base64,Zm9v".into();
    assert!(tell(open(&json)).contains("/images/0: expected a PNG, JPEG, WebP or KTX2 picture"));
    for (bytes, what) in [
        (
            "%abKTX 20%bb%0d%0a%1a%0a",
            "expected a PNG, JPEG, WebP or KTX2 picture, got a KTX2 picture that is cut short — export",
        ),
        (
            "%abKTX 11%bb%0d%0a%1a%0a",
            "a KTX picture is not supported — convert the picture",
        ),
        (
            "%00%00%00%1cftypavif",
            "an AVIF picture is not supported — convert the picture",
        ),
        (
            "DDS %7c",
            "a DDS picture is not supported — convert the picture",
        ),
    ] {
        json["images"][0]["uri"] = format!("data:,{bytes}").into();
        assert!(tell(open(&json)).contains(&format!("/images/0: {what}")));
    }
    json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    let plain = open(&json)?;
    assert_eq!(
        (plain.materials[0].base_map, plain.warnings.len()),
        (None, 1)
    );
    Ok(())
}

/// The KTX2 picture that KHR_texture_basisu names is read and not the plain one, and it is its PNG twin but for the loss of
/// its codec; a WebP one goes before it.
#[test]
fn universal_pictures_are_read() -> Result<()> {
    let slope = |x: u32, y: u32| [6 * (x + y), 6 * (x + y) + 60, 6 * (x + y) + 30, 255 - 8 * y];
    let twin = image::RgbaImage::from_fn(13, 10, |x, y| image::Rgba(slope(x, y).map(|v| v as u8)));
    let file = include_bytes!("../../texture/ktx2/etc1s.ktx2");
    let mut json = painted();
    let plain = json["images"][0]["uri"].clone();
    json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    json["images"] =
        json!([{"uri": plain}, {"uri": png_of(&twin)}, {"uri": address("image/ktx2", file)}]);
    json["materials"][0]["alphaMode"] = "BLEND".into();
    let picture = |texture: Value, required: &[&str]| -> Result<_> {
        let mut json = json.clone();
        json["textures"] = json!([texture]);
        json["extensionsRequired"] = json!(required);
        let cart = open(&json)?;
        assert_eq!(cart.extensions[0].handled, Handled::Read);
        Ok(cart.textures[0].picture.clone())
    };
    let basis = json!({"KHR_texture_basisu": {"source": 2}});
    let twin = picture(json!({"source": 1}), &[])?;
    let read = picture(json!({"source": 0, "extensions": basis}), &[])?;
    let alone = picture(json!({"extensions": basis}), &["KHR_texture_basisu"])?;
    let both = json!({"KHR_texture_basisu": {"source": 2}, "EXT_texture_webp": {"source": 1}});
    let webp = picture(json!({"extensions": both}), &[])?;
    let pixels = |picture: &TexturePicture| picture.levels[0].pixels.clone();
    assert_eq!(read.levels[0].size, [13, 10]);
    assert_eq!(pixels(&alone), pixels(&read));
    assert_eq!(pixels(&webp), pixels(&twin));
    assert_ne!(pixels(&read), pixels(&twin));
    // Each pixel is off by the loss of 10 steps of 255, times the slope of sRGB (at most 2.3); their mean by far less.
    for (read, twin) in pixels(&read).iter().zip(&pixels(&twin)) {
        for (read, twin) in read.iter().zip(twin) {
            assert!(read.abs_diff(*twin) < 23 * 257, "{read} {twin}");
        }
    }
    assert!(read.mean().distance(twin.mean()) < 0.01);
    Ok(())
}

/// A file of 408 bytes that says that it is 2³² pixels wide and high is refused by its claim.
#[test]
fn a_universal_picture_that_claims_much_is_refused() {
    let mut file = include_bytes!("../../texture/ktx2/etc1s.ktx2").to_vec();
    file[20..28].fill(0xff);
    let mut json = painted();
    json["images"][0]["uri"] = address("image/ktx2", &file).into();
    let told = tell(open(&json));
    let expected = "/images/0: expected at most 268435456 pixels in all pictures together";
    assert!(told.contains(expected), "{told}");
}
