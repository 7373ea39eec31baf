//! How indirect light gets to pixels: the choice, and what those that gather share.

use super::finish::{self, Gathering};
use super::indirect::Indirect;
use super::nearness;
use crate::formfactor::{Sky, Soft};
use crate::geometry::Bounds;
use crate::mesh::{Patches, Placed};
use crate::visibility::Nothing;
use glam::Vec3;

/// How indirect light gets from elements to pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Interpolated between elements everywhere.
    Interpolate,
    /// Gathered near contacts and on movers, interpolated elsewhere.
    Hybrid,
    /// Gathered in every pixel.
    Gather,
    /// Even over each side of an element.
    Flat,
}

/// A finish, with the directions and the sky of pixels that gather.
#[derive(Clone, Debug)]
pub struct Finishing {
    /// By gathering, by interpolation, or both.
    pub kind: Finish,
    directions: Vec<Vec3>,
    sky: Option<Soft>,
}

impl Finishing {
    /// A finish; each plane in a pixel that gathers takes so many samples, a power of two.
    pub fn new(kind: Finish, samples: usize, sky: Option<&Sky>) -> Finishing {
        let samples = match kind {
            Finish::Interpolate | Finish::Flat => 0,
            Finish::Hybrid | Finish::Gather => samples,
        };
        let directions = finish::directions(samples);
        Finishing {
            kind,
            sky: sky.map(|sky| sky.soft(directions.len().max(1))),
            directions,
        }
    }

    /// What gathers at t, where `share` of the light at each vertex is gathered.
    pub fn at<'a>(&'a self, share: &'a [f32], nothing: Nothing) -> Gathering<'a> {
        Gathering {
            directions: &self.directions,
            share,
            nothing,
            sky: self.sky.as_ref(),
        }
    }

    /// How much of the indirect light at each vertex is gathered, or nothing where none ever is; `near` and `movers` are
    /// those of [`nearness::shares`].
    pub fn shares(
        &self,
        indirect: &Indirect,
        patches: &Patches,
        placed: &Placed,
        near: &[f32],
        movers: &[Bounds],
    ) -> Option<Vec<f32>> {
        match self.kind {
            Finish::Interpolate | Finish::Flat => None,
            Finish::Gather => Some(vec![1.0; patches.vertices as usize]),
            Finish::Hybrid => Some(nearness::shares(indirect, patches, placed, near, movers)),
        }
    }
}
