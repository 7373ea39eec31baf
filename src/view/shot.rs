//! A picture of the present state with the pixels of `render`, from where a tab looks.

use super::message::PictureOrder;
use crate::image::Tone;
use crate::io::png;
use crate::session::Session;
use crate::session::scene::Looks;
use crate::settings::PngBits;
use glam::DVec3;

/// Largest width and height: such a picture takes a minute.
const MOST_PIXELS: u32 = 3840;

/// The picture as a PNG; the error is for the one who asked.
pub(super) fn png(session: &mut Session, shot: &PictureOrder) -> Result<Vec<u8>, String> {
    let (width, height) = shot.size;
    if !(1..=MOST_PIXELS).contains(&width) || !(1..=MOST_PIXELS).contains(&height) {
        let told = format!("expected 1 to {MOST_PIXELS} pixels, got {width}×{height}");
        return Err(format!("size: {told} — ask for another size"));
    }
    let (eye, at) = (DVec3::from(shot.eye), DVec3::from(shot.at));
    let looks = eye.is_finite() && (at - eye).try_normalize().is_some();
    let opens = shot.degrees > 0.0 && shot.degrees < 180.0;
    if !(looks && opens && shot.stops.is_finite()) {
        let told = "expected two points and an angle below 180 degrees, got others";
        return Err(format!("render: {told} — look elsewhere"));
    }
    let yfov = shot.degrees.to_radians();
    let camera = session.camera_at(Looks::At { eye, at, yfov }, shot.size);
    let image = session.image(&camera.map_err(|error| error.to_string())?);
    let tone = Tone {
        stops: shot.stops,
        curve: shot.curve,
    };
    png::encode(&image, tone, PngBits::Eight, &[])
}
