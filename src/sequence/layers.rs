//! What the pixels show, as layers of an EXR file: channels by name, beside the picture's own.
//!
//! A layer's name and its channel are joined by a dot, as OpenEXR asks and Blender, Nuke and OpenImageIO read it:
//! `albedo.R`, `normal.X`, `depth.Z`. Numbers that must stay whole, or are too long for halves, are always 32-bit floats,
//! in which all numbers up to 16,777,216 are exact.

use crate::ids::{SideId, SurfaceId};
use crate::image::PixelAov;
use crate::io::channel::ImageChannel;
use crate::sequence::prepared::Prepared;
use crate::sequence::step::State;
use crate::settings::Aov;
use glam::Vec3;

/// The number of no object and no patch.
const NONE: f32 = -1.0;

/// The channels of these layers in a frame.
pub fn channels(
    aovs: &[Aov],
    pixels: &[PixelAov],
    prepared: &Prepared,
    state: &State,
    first: bool,
) -> Vec<ImageChannel> {
    let mut channels = Vec::new();
    let mut layer = |aov: Aov, letters: &[char], of: &dyn Fn(&PixelAov) -> Vec3| {
        for (at, letter) in letters.iter().enumerate() {
            channels.push(ImageChannel {
                name: format!("{}.{letter}", aov.name()),
                values: pixels.iter().map(|pixel| of(pixel)[at]).collect(),
                exact: matches!(aov, Aov::Depth | Aov::Object | Aov::Patch),
            });
        }
    };
    let colors = ['R', 'G', 'B'];
    for &aov in aovs {
        match aov {
            Aov::Direct => layer(aov, &colors, &|pixel| pixel.parts.direct),
            Aov::Indirect => layer(aov, &colors, &|pixel| pixel.parts.indirect),
            Aov::Emission => layer(aov, &colors, &|pixel| pixel.parts.emitted),
            Aov::Specular => layer(aov, &colors, &|pixel| pixel.parts.specular),
            Aov::Albedo => layer(aov, &colors, &|pixel| pixel.albedo),
            Aov::Normal => layer(aov, &['X', 'Y', 'Z'], &|pixel| pixel.normal),
            Aov::TrueNormal => layer(aov, &['X', 'Y', 'Z'], &|pixel| pixel.true_normal),
            Aov::Depth => layer(aov, &['Z'], &|pixel| Vec3::splat(pixel.depth)),
            Aov::Object => layer(aov, &['X'], &|pixel| Vec3::splat(object(prepared, pixel))),
            Aov::Patch => layer(aov, &['X'], &|pixel| Vec3::splat(patch(prepared, pixel))),
            Aov::Recomputed => layer(aov, &['X', 'Y'], &|pixel| {
                Vec3::new(f32::from(pixel.traced), again(state, pixel, first), 0.0)
            }),
        }
    }
    channels
}

/// The number in the file of the node that a pixel shows.
fn object(prepared: &Prepared, pixel: &PixelAov) -> f32 {
    let node = |surface: SurfaceId| {
        let surface = &prepared.patches.surfaces[surface];
        let animation = &prepared.animation;
        animation.nodes[animation.instances[surface.instance].node].index
    };
    pixel.surface.map_or(NONE, |surface| node(surface) as f32)
}

/// The number of the element that it shows.
fn patch(prepared: &Prepared, pixel: &PixelAov) -> f32 {
    let element = |side: SideId| prepared.patches.sides[side].element;
    pixel
        .side
        .map_or(NONE, |side| element(side).number() as f32)
}

/// The share of the samples of the side it shows that were traced again; all of them where no frame came before.
fn again(state: &State, pixel: &PixelAov, first: bool) -> f32 {
    let Some(tally) = state.tally.as_deref().filter(|_| !first) else {
        return 1.0;
    };
    match pixel.side {
        None => 0.0,
        Some(side) => {
            let samples = state.view.samples_of(side.index()).max(1);
            (tally[side].traced as f64 / samples as f64) as f32
        }
    }
}
