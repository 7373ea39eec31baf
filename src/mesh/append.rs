//! Meshes for edits: objects appended to a mesh, and a mesh without movers, of which an edit may move anything.

use super::RadiosityMesh;
use super::cuts::MOST_ELEMENTS;
use crate::ids::{CutoutId, SideId};
use crate::scene::Animation;
use crate::texture::Cutouts;
use glam::Vec3;
use std::sync::Arc;

impl RadiosityMesh {
    /// Appends a mesh without clusters; its first instance gets the number `instances`.
    ///
    /// # Errors
    /// The number of elements together, if there are not as many ids.
    pub fn append(&mut self, more: &RadiosityMesh, instances: usize) -> Result<(), usize> {
        let all = self.elements.len() + more.elements.len();
        if all >= MOST_ELEMENTS {
            return Err(all);
        }
        let triangles = self.surface_of.len() as u32;
        let elements = self.elements.len() as u32;
        let (surfaces, sides) = (self.surfaces.len(), self.sides.len());
        let on = |(from, to): (u32, u32), by: u32| (from + by, to + by);
        self.surfaces
            .extend(more.surfaces.iter().cloned().map(|mut s| {
                s.instance = s.instance.after(instances);
                s.triangles = on(s.triangles, triangles);
                s.elements = on(s.elements, elements);
                s
            }));
        self.surface_of
            .extend(more.surface_of.iter().map(|s| s.after(surfaces)));
        self.elements.extend(more.elements.iter().map(|element| {
            let mut element = *element;
            element.triangle = element.triangle.after(triangles as usize);
            element
        }));
        self.cuts.append(&more.cuts, elements);
        self.sides.extend(more.sides.iter().map(|side| {
            let mut side = *side;
            side.element = side.element.after(elements as usize);
            side
        }));
        let number = |side: &Option<SideId>| side.map(|side| side.after(sides));
        let numbers = more.side_of.iter().map(|both| both.each_ref().map(number));
        self.side_of.extend(numbers);
        if !self.clusters.is_empty() {
            self.clusters
                .append(&more.side_of, self.vertex_of.len() as u32);
        }
        let vertices = self.vertices;
        let vertex_of = more.vertex_of.iter().map(|v| v.map(|v| v + vertices));
        self.vertex_of.extend(vertex_of);
        self.vertices += more.vertices;
        self.any_sends_on |= more.any_sends_on;
        self.any_translucent |= more.any_translucent;
        append_cutouts(Arc::make_mut(&mut self.cutouts), &more.cutouts);
        Ok(())
    }

    /// Makes every surface a static one whose base colour is the pose's. An unlit surface keeps its own colour.
    pub fn make_static(&mut self, animation: &Animation) {
        for surface in &mut self.surfaces {
            let instance = &animation.instances[surface.instance];
            let material = animation.meshes[instance.mesh].material;
            surface.moves = false;
            if surface.unlit {
                surface.base_color = animation.materials[material].base_color;
                surface.repainted = None;
            } else {
                surface.base_color = Vec3::ONE;
                surface.repainted = Some(material);
            }
        }
        self.static_triangles = self.surface_of.len() as u32;
        self.static_sides = self.sides.len() as u32;
    }
}

fn append_cutouts(cutouts: &mut Cutouts, more: &Cutouts) {
    let (first, rasters) = (cutouts.cutouts.len(), cutouts.rasters.len() as u32);
    if cutouts.any_clear() || more.any_clear() {
        let both = cutouts.of.len() + more.of.len();
        cutouts.clear.resize(cutouts.of.len(), false);
        cutouts.clear.extend(&more.clear);
        cutouts.clear.resize(both, false);
    }
    let on = |of: &Option<CutoutId>| of.map(|cutout| cutout.after(first));
    cutouts.of.extend(more.of.iter().map(on));
    cutouts.cutouts.extend(more.cutouts.iter().map(|cutout| {
        let mut cutout = *cutout;
        cutout.raster = cutout.raster.map(|raster| raster + rasters);
        cutout
    }));
    cutouts.rasters.extend(more.rasters.iter().cloned());
}
