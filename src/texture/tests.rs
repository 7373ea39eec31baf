use super::*;

fn texture(width: u32, pixels: &[[u16; 4]], kind: TextureUse, wrap: Wrap) -> Texture {
    let height = pixels.len() as u32 / width;
    let decoded = ImageBuffer::from_raw(width, height, pixels.concat()).expect("its pixels");
    Texture {
        picture: Arc::new(TexturePicture::of(decoded, kind)),
        wrap: [wrap; 2],
        nearest: false,
    }
}

fn grey(width: u32, values: &[u16], wrap: Wrap) -> Texture {
    let pixels: Vec<[u16; 4]> = values.iter().map(|v| [*v, *v, *v, u16::MAX]).collect();
    texture(width, &pixels, TextureUse::Numbers, wrap)
}

/// Black and white squares of one pixel.
fn checkers(size: u32) -> Texture {
    let square = |i: u32| ((i % size + i / size) % 2) as u16 * u16::MAX;
    grey(
        size,
        &(0..size * size).map(square).collect::<Vec<_>>(),
        Wrap::Repeat,
    )
}

#[test]
fn pixel_centres_give_pixels_and_the_middle_their_mean() {
    let texture = grey(2, &[0, 13_107, 26_214, 39_321], Wrap::Clamp);
    assert_eq!(texture.at(Vec2::new(0.25, 0.25)), Vec3::ZERO);
    assert!((texture.at(Vec2::new(0.75, 0.75)).x - 0.6).abs() < 1e-6);
    assert!((texture.at(Vec2::splat(0.5)).x - 0.3).abs() < 1e-6);
    assert!((texture.picture.mean().x - 0.3).abs() < 1e-5);
}

/// Two pixels side by side, 0 and 0.6: the nearest jumps at the middle, beyond the edges it goes on as it wraps, and
/// from afar it is their mean of 0.3, as the other is.
#[test]
fn the_nearest_pixel_is_all_that_shows_near_by() {
    let mut texture = grey(2, &[0, 39_321], Wrap::Mirror);
    texture.nearest = true;
    for (x, expected) in [
        (0.01, 0.0),
        (0.49, 0.0),
        (0.51, 0.6),
        (1.49, 0.6),
        (1.51, 0.0),
    ] {
        let at = Vec2::new(x, 0.5);
        assert!((texture.at(at).x - expected).abs() < 1e-6, "{x}");
        let narrow = [Vec2::X * 0.01, Vec2::Y * 0.01];
        assert!((texture.over(at, narrow).x - expected).abs() < 1e-6, "{x}");
        assert!((texture.over(at, [Vec2::X * 8.0, Vec2::Y * 8.0]).x - 0.3).abs() < 1e-4);
    }
    assert_eq!(texture.at(Vec2::splat(f32::NAN)), Vec3::ZERO);
    assert!(texture.alpha().nearest);
}

#[test]
fn every_level_has_the_mean_of_the_whole() {
    // 5 × 3 pixels of 0, 1, … 14 steps of 4000: the mean is 7 steps, through 2 × 1 to 1 × 1. The left pixel of
    // the 2 × 1 covers columns 0, 1 and half of 2: (0 + 1 + ½·2) / 2.5 = 0.8 in the first row, 5 more in each other.
    let values: Vec<u16> = (0..15).map(|value| value * 4000).collect();
    let texture = grey(5, &values, Wrap::Clamp);
    let levels = &texture.picture.levels;
    let sizes: Vec<[u32; 2]> = levels.iter().map(|level| level.size).collect();
    assert_eq!(sizes, [[5, 3], [2, 1], [1, 1]]);
    assert_eq!(levels[1].pixels[0][0], 23_200);
    assert_eq!(levels[2].pixels[0][0], 28_000);
}

#[test]
fn a_wide_look_is_the_mean_and_a_narrow_one_the_pixel() {
    let texture = checkers(64);
    let side = 1.0 / 64.0;
    let centre = Vec2::splat(0.5 * side) + Vec2::X * 3.0 * side;
    let square = |size: f32| [Vec2::X * size * side, Vec2::Y * size * side];
    assert_eq!(texture.over(centre, square(0.5)), Vec3::ONE);
    assert_eq!(texture.over(centre, square(1.0)), Vec3::ONE);
    for size in [2.0, 3.0, 10.0, 1000.0] {
        assert!(
            (texture.over(centre, square(size)).x - 0.5).abs() < 1e-4,
            "{size}"
        );
    }
    // Half of the way from one pixel (log₂ 1 = 0) to two, in octaves: half white, half mean.
    assert!((texture.over(centre, square(2f32.sqrt())).x - 0.75).abs() < 1e-4);
}

#[test]
fn a_long_look_along_stripes_stays_sharp_across_them() {
    // Eight black rows, eight white ones; a stretch 16 pixels long and 1 wide, in the middle of the white rows.
    let values: Vec<u16> = (0..256).map(|i| (i / 16 / 8) as u16 * u16::MAX).collect();
    let texture = grey(16, &values, Wrap::Clamp);
    let long = [Vec2::X, Vec2::Y / 16.0];
    assert_eq!(texture.over(Vec2::new(0.5, 0.75), long), Vec3::ONE);
    assert_eq!(texture.over(Vec2::new(0.5, 0.25), long), Vec3::ZERO);
    let upright = [Vec2::X / 16.0, Vec2::Y];
    assert!((texture.over(Vec2::splat(0.5), upright).x - 0.5).abs() < 1e-4);
}

#[test]
fn what_is_not_there_lends_no_colour() {
    // One red pixel beside three green ones that are holes: their mean is red, and so is the way to them.
    let red = [u16::MAX, 0, 0, u16::MAX];
    let hole = [0, u16::MAX, 0, 0];
    let holes = texture(
        2,
        &[red, hole, hole, hole],
        TextureUse::ColourAndAlpha,
        Wrap::Repeat,
    );
    for at in [Vec2::splat(0.3), Vec2::splat(0.45), Vec2::splat(0.1)] {
        assert!(holes.at(at).distance(Vec3::X) < 1e-6);
        assert!(holes.over(at, [Vec2::X, Vec2::Y]).distance(Vec3::X) < 1e-6);
    }
    assert!((holes.picture.mean().w - 0.25).abs() < 1e-4);
    assert_eq!(holes.picture.least_alpha(), 0.0);
    assert_eq!(holes.alpha().values, [u16::MAX, 0, 0, 0]);
    let opaque = texture(
        2,
        &[red, hole, hole, hole],
        TextureUse::Colour,
        Wrap::Repeat,
    );
    assert!(opaque.at(Vec2::splat(0.75)).distance(Vec3::Y) < 1e-6);
}

#[test]
fn coordinates_beyond_counting_do_not_panic() {
    let texture = grey(2, &[u16::MAX; 2], Wrap::Mirror);
    for wild in [f32::NAN, f32::INFINITY, f32::MAX, f32::MIN] {
        assert_eq!(texture.at(Vec2::splat(wild)), Vec3::ONE);
        assert_eq!(
            texture.over(Vec2::ZERO, [Vec2::splat(wild), Vec2::X]),
            Vec3::ONE
        );
    }
}

#[test]
fn decoding_turns_srgb_into_light() {
    let mut bytes = Vec::new();
    let picture = image::RgbImage::from_raw(2, 1, vec![0, 188, 255, 10, 0, 0])
        .expect("six bytes are two pixels");
    picture
        .write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png)
        .expect("a PNG in memory");
    let picture = TexturePicture::decode(&bytes, TextureUse::Colour).expect("a PNG");
    let [first, second] = [0, 1].map(|i| value(picture.levels[0].pixels[i]));
    // sRGB 188 is light 0.50289, and 10 lies on the straight part: 10 / 255 / 12.92. Half a step is 7.6e-6.
    assert!((first.y - 0.502_886).abs() < 8e-6);
    assert!((second.x - 10.0 / 255.0 / 12.92).abs() < 8e-6);
    assert_eq!((first.x, first.z, first.w), (0.0, 1.0, 1.0));
    let plain = TexturePicture::decode(&bytes, TextureUse::Numbers).expect("a PNG");
    assert!((value(plain.levels[0].pixels[0]).y - 188.0 / 255.0).abs() < 8e-6);
    assert!(TexturePicture::decode(&bytes[..20], TextureUse::Colour).is_err());
    assert!(TexturePicture::decode(b"no picture", TextureUse::Colour).is_err());
}
