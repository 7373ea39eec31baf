//! The vertices of an object in the present light, those that are alike once.

use crate::export::drawn::{DrawnMesh, DrawnObject, DrawnTriangle};
use crate::session::Session;
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::PI;

/// The light of a state, and what is drawn in it.
pub(super) struct SceneLight<'a> {
    session: &'a Session,
    drawn: &'a DrawnMesh,
    corners: Vec<[Vec3; 3]>,
    /// Irradiance at welded vertices.
    light: Vec<Option<Vec3>>,
    /// The mean of it, for what has no radiosity.
    mean: Vec3,
    /// Radiosity that each surface emits.
    emitted: Vec<Vec3>,
    /// What radiance is multiplied by.
    scale: f32,
}

/// The vertices of an object.
#[derive(Default)]
pub(super) struct LitObject {
    pub(super) positions: Vec<Vec3>,
    pub(super) colors: Vec<Vec3>,
    pub(super) texcoords: Vec<Vec2>,
    pub(super) indices: Vec<u32>,
    pub(super) is_textured: bool,
    pub(super) glows: bool,
    /// Vertices whose colour was above 1.
    pub(super) clipped: usize,
}

/// A colour cut at white, 65,535 for 1.
pub(super) fn in_16_bits(color: Vec3) -> [u16; 3] {
    let to_16 = |light: f32| (light.clamp(0.0, 1.0) * 65_535.0).round() as u16;
    color.to_array().map(to_16)
}

impl LitObject {
    /// Its colours in 16 bits.
    pub(super) fn in_16_bits(&self) -> Vec<[u16; 3]> {
        self.colors.iter().map(|color| in_16_bits(*color)).collect()
    }
}

/// A vertex by its bits.
type Bits = [u32; 8];

impl SceneLight<'_> {
    pub(super) fn of<'a>(session: &'a Session, drawn: &'a DrawnMesh, stops: f32) -> SceneLight<'a> {
        let light = session.irradiance_of_vertices();
        let known = light.iter().flatten();
        // The geometric mean: a few vertices beside a lamp do not speak for all.
        let logs: Vec<Vec3> = known
            .map(|light| light.max(Vec3::splat(1e-6)).ln())
            .collect();
        let mean = logs.iter().sum::<Vec3>() / logs.len().max(1) as f32;
        SceneLight {
            session,
            drawn,
            corners: drawn.corners(session),
            mean: mean.exp(),
            light,
            emitted: session.emitted_by_surfaces(),
            scale: stops.exp2(),
        }
    }

    pub(super) fn object(&self, object: &DrawnObject) -> LitObject {
        let material = &self.session.scene.animation.materials[object.material];
        let glows = self.emitted[object.surface.index()] != Vec3::ZERO;
        let mut lit = LitObject {
            is_textured: material.base_map.is_some() && !glows,
            glows,
            ..LitObject::default()
        };
        let mut known: HashMap<Bits, u32> = HashMap::new();
        for at in object.triangles.clone() {
            let (triangle, corners) = (&self.drawn.triangles[at], self.corners[at]);
            let colors = self.colors(object, triangle, glows);
            for k in 0..3 {
                let texcoord = if lit.is_textured {
                    triangle.texcoords[k]
                } else {
                    Vec2::ZERO
                };
                let [p, c, t] = [corners[k], colors[k], texcoord.extend(0.0)];
                let bits = [p.x, p.y, p.z, c.x, c.y, c.z, t.x, t.y].map(f32::to_bits);
                let index = *known.entry(bits).or_insert_with(|| {
                    lit.clipped += usize::from(c.max_element() > 1.0);
                    lit.positions.push(p);
                    lit.colors.push(c.clamp(Vec3::ZERO, Vec3::ONE));
                    lit.texcoords.push(texcoord);
                    lit.positions.len() as u32 - 1
                });
                lit.indices.push(index);
            }
        }
        lit
    }

    /// World positions of an object's corners, three a triangle.
    pub(super) fn corners(&self, object: &DrawnObject) -> Vec<Vec3> {
        self.corners[object.triangles.clone()]
            .as_flattened()
            .to_vec()
    }

    /// Texture coordinates of an object's corners; zero where no texture multiplies its colours.
    pub(super) fn texcoords(&self, object: &DrawnObject, glows: bool) -> Vec<Vec2> {
        let material = &self.session.scene.animation.materials[object.material];
        let is_textured = material.base_map.is_some() && !glows;
        let triangles = self.drawn.triangles[object.triangles.clone()].iter();
        let of = |triangle: &DrawnTriangle| match is_textured {
            true => triangle.texcoords,
            false => [Vec2::ZERO; 3],
        };
        triangles.flat_map(of).collect()
    }

    /// Colours of an object's corners, as they were not cut at white; `glows` tells that it emits, now or in other frames.
    pub(super) fn colors_of(&self, object: &DrawnObject, glows: bool) -> Vec<Vec3> {
        let triangles = self.drawn.triangles[object.triangles.clone()].iter();
        let of = |triangle: &DrawnTriangle| self.colors(object, triangle, glows);
        triangles.flat_map(of).collect()
    }

    /// The colours of a triangle's corners; where there is a texture and no glow, it and the base colour multiply them.
    fn colors(&self, object: &DrawnObject, triangle: &DrawnTriangle, glows: bool) -> [Vec3; 3] {
        let material = &self.session.scene.animation.materials[object.material];
        let emitted = self.emitted[object.surface.index()] / PI;
        if material.unlit {
            let base = match material.base_map {
                Some(_) => Vec3::ONE,
                None => self.session.pose().base_color[object.material],
            };
            return triangle.tints.map(|tint| base * tint * self.scale);
        }
        let irradiance = self.irradiance(triangle);
        let patches = &self.session.scene.patches;
        let base = self.session.pose().base_color[object.material];
        let mean_tint = patches.elements[triangle.element].tint;
        let mut colors = [Vec3::ZERO; 3];
        for (k, color) in colors.iter_mut().enumerate() {
            let radiance = irradiance[k] / PI;
            // What is multiplied by a texture goes without the base colour, which is then the material's.
            let reflected = if glows {
                base * mean_tint * radiance + emitted * triangle.glow
            } else if material.base_map.is_some() {
                triangle.tints[k] * radiance
            } else {
                base * triangle.tints[k] * radiance
            };
            *color = reflected * self.scale;
        }
        colors
    }

    /// Irradiance at the corners; those where nothing is known take the mean of the others.
    fn irradiance(&self, triangle: &DrawnTriangle) -> [Vec3; 3] {
        let Some(vertices) = triangle.vertices else {
            return [self.mean; 3];
        };
        let light = vertices.map(|vertex| self.light[vertex as usize]);
        let known: Vec<Vec3> = light.iter().flatten().copied().collect();
        let mean = known.iter().sum::<Vec3>() / known.len().max(1) as f32;
        light.map(|light| light.unwrap_or(mean))
    }
}
