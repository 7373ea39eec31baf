//! What the pixels show, as layers of an EXR file: channels by name, beside the picture's own.
//!
//! A layer's name and its channel are joined by a dot, as OpenEXR asks and Blender, Nuke and OpenImageIO read it:
//! `albedo.R`, `normal.X`, `depth.Z`. Numbers that must stay whole, or are too long for halves, are always 32-bit floats,
//! in which all numbers up to 16,777,216 are exact.

use crate::image::PixelAov;
use crate::io::channel::ImageChannel;
use crate::mesh::NO_SIDE;
use crate::sequence::prepared::Prepared;
use crate::sequence::step::State;
use crate::settings::Aov;
use glam::Vec3;

/// The number of no object and no patch.
const NONE: f32 = -1.0;

/// The channels of these layers in a frame.
pub fn channels(
    aovs: &[Aov],
    glances: &[PixelAov],
    prepared: &Prepared,
    state: &State,
    first: bool,
) -> Vec<ImageChannel> {
    let mut channels = Vec::new();
    let mut layer = |aov: Aov, letters: &[char], of: &dyn Fn(&PixelAov) -> Vec3| {
        for (at, letter) in letters.iter().enumerate() {
            channels.push(ImageChannel {
                name: format!("{}.{letter}", aov.name()),
                values: glances.iter().map(|glance| of(glance)[at]).collect(),
                exact: matches!(aov, Aov::Depth | Aov::Object | Aov::Patch),
            });
        }
    };
    let colors = ['R', 'G', 'B'];
    for &aov in aovs {
        match aov {
            Aov::Direct => layer(aov, &colors, &|glance| glance.parts.direct),
            Aov::Indirect => layer(aov, &colors, &|glance| glance.parts.indirect),
            Aov::Emission => layer(aov, &colors, &|glance| glance.parts.emitted),
            Aov::Albedo => layer(aov, &colors, &|glance| glance.albedo),
            Aov::Normal => layer(aov, &['X', 'Y', 'Z'], &|glance| glance.normal),
            Aov::TrueNormal => layer(aov, &['X', 'Y', 'Z'], &|glance| glance.true_normal),
            Aov::Depth => layer(aov, &['Z'], &|glance| Vec3::splat(glance.depth)),
            Aov::Object => layer(aov, &['X'], &|glance| Vec3::splat(object(prepared, glance))),
            Aov::Patch => layer(aov, &['X'], &|glance| Vec3::splat(patch(prepared, glance))),
            Aov::Recomputed => layer(aov, &['X', 'Y'], &|glance| {
                Vec3::new(f32::from(glance.asked), again(state, glance, first), 0.0)
            }),
        }
    }
    channels
}

/// The number in the file of the node that a pixel shows.
fn object(prepared: &Prepared, glance: &PixelAov) -> f32 {
    let node = |surface: u32| {
        let surface = &prepared.patches.surfaces[surface as usize];
        let animation = &prepared.animation;
        animation.nodes[animation.instances[surface.instance].node].index
    };
    glance.surface.map_or(NONE, |surface| node(surface) as f32)
}

/// The number of the element that it shows.
fn patch(prepared: &Prepared, glance: &PixelAov) -> f32 {
    match glance.side {
        NO_SIDE => NONE,
        side => prepared.patches.sides[side as usize].element as f32,
    }
}

/// The share of the samples of the side it shows that were asked again; all of them where no frame came before.
fn again(state: &State, glance: &PixelAov, first: bool) -> f32 {
    let Some(tally) = state.tally.as_deref().filter(|_| !first) else {
        return 1.0;
    };
    match glance.side {
        NO_SIDE => 0.0,
        side => {
            let samples = state.view.samples_of(side as usize).max(1);
            (tally[side as usize].traced as f64 / samples as f64) as f32
        }
    }
}
