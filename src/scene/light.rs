//! Lights without a surface: points, spots and directions, as KHR_lights_punctual defines them.
//!
//! KHR_lights_punctual, Khronos Group 2018. A spot's edge falls off as the extension's appendix recommends, and `range`
//! is the window it recommends; neither leaves us a choice, so files look alike in every reader.

use crate::ids::{LightId, NodeId};
use glam::Vec3;

/// A light of the file; nodes carry it.
#[derive(Clone, Debug)]
pub struct Light {
    /// The light's name, or `light 2`.
    pub name: String,
    /// Its kind.
    pub kind: LightKind,
    /// Its beam at rest.
    pub beam: Beam,
    /// Radius of a point or spot in metres; tangent of half the angle under which a direction is seen. 0 for hard shadows.
    pub spread: f64,
}

/// The kind of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// Its node, to all sides alike.
    Point,
    /// Its node, along the node's −z.
    Spot,
    /// Everywhere, along the node's −z.
    Directional,
}

impl std::fmt::Display for LightKind {
    fn fmt(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        to.write_str(match self {
            LightKind::Point => "point",
            LightKind::Spot => "spot",
            LightKind::Directional => "directional",
        })
    }
}

/// Colour, intensity and cone of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Linear RGB, at least 0.
    pub color: Vec3,
    /// Candela of a point or a spot, lux of a direction; at least 0.
    pub intensity: f64,
    /// Metres beyond which nothing arrives; infinite where the file gives none. Directions have none.
    pub range: f64,
    /// A spot is full within this angle from its axis, in radians.
    pub inner: f64,
    /// A spot is dark beyond this angle, from `inner` to π/2.
    pub outer: f64,
}

impl Default for Beam {
    /// The defaults of the extension.
    fn default() -> Beam {
        Beam {
            color: Vec3::ONE,
            intensity: 1.0,
            range: f64::INFINITY,
            inner: 0.0,
            outer: std::f64::consts::FRAC_PI_4,
        }
    }
}

/// The largest intensity in candela or lux, far beyond any star: with its colour and a distance it stays a 32-bit number.
const MOST_INTENSE: f64 = 1e30;

/// The largest channel of a colour.
const MOST_COLOR: f32 = 1e3;

impl Beam {
    /// The beam with every number clamped to its range: a spline overshoots its keys.
    pub(crate) fn tamed(mut self) -> Beam {
        self.color = self.color.clamp(Vec3::ZERO, Vec3::splat(MOST_COLOR));
        self.intensity = self.intensity.clamp(0.0, MOST_INTENSE);
        self.range = self.range.max(f64::MIN_POSITIVE);
        self.outer = self.outer.clamp(0.0, std::f64::consts::FRAC_PI_2);
        self.inner = self.inner.clamp(0.0, self.outer);
        self
    }
}

/// Factors that bring a file's lights onto the scale of its materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightScale {
    /// Of points and spots.
    pub points: f64,
    /// Of directional lights.
    pub directions: f64,
}

impl Default for LightScale {
    /// glTF's own units.
    fn default() -> LightScale {
        LightScale::all(1.0)
    }
}

impl LightScale {
    /// The same factor for all kinds.
    pub fn all(factor: f64) -> LightScale {
        LightScale {
            points: factor,
            directions: factor,
        }
    }

    /// The factor of a kind of light.
    pub fn of(self, kind: LightKind) -> f64 {
        match kind {
            LightKind::Point | LightKind::Spot => self.points,
            LightKind::Directional => self.directions,
        }
    }
}

/// A node that carries a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lamp {
    /// The node.
    pub node: NodeId,
    /// The light.
    pub light: LightId,
}
