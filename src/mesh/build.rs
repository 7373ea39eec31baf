//! Building the mesh of an animation: its instances in order, static ones first, their triangles cut into elements.

use super::contact::Contacts;
use super::grain::Grains;
use super::lamps::lamps;
use super::near_light::ReachedLight;
use super::order::order;
use super::sizes::Sizes;
use super::{Element, PosedMesh, RadiosityMesh, Side, Surface};
use super::{budget, contact, count, cut, cuts, mean, weld};
use crate::error::{Error, Result};
use crate::ids::{ElementId, InstanceId, SideId, SurfaceId, TriangleId};
use crate::scene::{Animation, deform::Shown, paint::Paint};
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

/// A mesh that grows instance by instance.
struct Builder<'a> {
    animation: &'a Animation,
    sizes: &'a Sizes,
    shown: &'a [Shown],
    contacts: &'a Contacts,
    light: Option<&'a ReachedLight<'a>>,
    /// Whether each instance moves, and whether a clip sets the base colour of each material.
    moves: Vec<bool>,
    repainted: Vec<bool>,
    patches: RadiosityMesh,
    /// The triangles as they are cut.
    placed: PosedMesh,
    corners: weld::Corners,
}

impl RadiosityMesh {
    /// Cuts an animation into elements with no edge longer than `size` metres at time 0. An instance without an area then
    /// is cut in the pose in which its area is largest.
    ///
    /// # Errors
    /// As [`RadiosityMesh::cut_by`].
    pub fn cut(animation: &Animation, size: f32) -> Result<RadiosityMesh> {
        RadiosityMesh::cut_by(animation, &Sizes::Even(size))
    }

    /// Cuts an animation into elements with edges of these sizes.
    ///
    /// # Errors
    /// [`Error::Scene`] for a scene without triangles, [`Error::Usage`] for more than [`cuts::MOST_ELEMENTS`] elements.
    pub fn cut_by(animation: &Animation, sizes: &Sizes) -> Result<RadiosityMesh> {
        // Count first: a size mistyped by a few zeros must not fill the memory.
        let (shown, size) = (animation.shown(), sizes.even());
        let elements = count::count_of(&shown, sizes, None, cuts::MOST_ELEMENTS);
        if elements >= cuts::MOST_ELEMENTS {
            return Err(budget::too_many(animation, size, elements));
        }

        let (moves, order) = (animation.moves(), order(animation));

        let cutouts = Arc::new(mean::cutouts(animation, &order, &shown));
        let contacts = Contacts::of(animation, &shown, &cutouts);
        let light = contacts.near_light(sizes);
        let mut builder = Builder {
            animation,
            sizes,
            shown: &shown,
            contacts: &contacts,
            light: light.as_ref(),
            moves,
            repainted: animation.repainted(),
            patches: RadiosityMesh::empty(cutouts, size, contact::ray_offset(&shown)),
            placed: PosedMesh::default(),
            corners: weld::Corners::default(),
        };
        for instance in order {
            builder.add(instance)?;
        }
        builder.finish()
    }
}

impl Builder<'_> {
    /// Cuts the triangles of an instance.
    fn add(&mut self, instance: InstanceId) -> Result<()> {
        let Shown {
            corners,
            mirrored,
            normals,
        } = &self.shown[instance];
        let cutouts = self.patches.cutouts.clone();
        let first = self.patches.surface_of.len() as u32;
        let first_element = self.patches.elements.len();
        let source = mean::Source {
            paint: Paint::of(self.animation, instance.index(), *mirrored),
            cutouts: &cutouts,
            first: TriangleId::new(first),
        };
        let surface = SurfaceId::from_index(self.patches.surfaces.len());
        let rule = self.sizes.of(instance.index());
        let mut crossings = self.contacts.on(instance.index(), self.light, self.sizes);
        self.placed.triangles.extend(corners);
        self.placed.normals.push(normals);
        for (k, triangle) in corners.iter().enumerate() {
            self.patches.surface_of.push(surface);
            let (patches, welded) = (&mut self.patches, &mut self.corners);
            cut::triangle(
                patches,
                welded,
                triangle,
                k,
                rule,
                &source,
                crossings.as_mut(),
            )
            .map_err(|got| budget::too_many(self.animation, self.sizes.even(), got))?;
        }
        let triangles = (first, self.patches.surface_of.len() as u32);
        let elements = (first_element as u32, self.patches.elements.len() as u32);
        let known = (&self.moves[..], &self.repainted[..]);
        let patches = &mut self.patches;
        patches.push_surface(
            self.animation,
            instance,
            triangles,
            elements,
            *mirrored,
            known,
        );
        Ok(())
    }

    /// The mesh with its sides and vertices.
    fn finish(mut self) -> Result<RadiosityMesh> {
        if self.patches.elements.is_empty() {
            return Err(Error::Scene {
                file: self.animation.file.clone(),
                pointer: "/meshes".into(),
                expected: "at least one triangle with an area on a node of the scene".into(),
                got: "none".into(),
                way_out: "export the objects' meshes too".into(),
            });
        }
        self.patches.cuts.make_grids();
        self.patches.number_sides();
        (self.patches.vertex_of, self.patches.vertices) =
            self.corners
                .weld(&self.patches, &self.placed, self.contacts);
        if let Sizes::Clustered(clustering) = self.sizes {
            let grains = Grains::of(self.shown);
            self.patches.cluster(&self.placed, &grains, clustering);
        }
        Ok(self.patches)
    }
}

impl RadiosityMesh {
    /// Adds the surface of an instance, whose triangles and elements are there; `known` are which instances move, and which
    /// materials a clip repaints.
    pub(super) fn push_surface(
        &mut self,
        animation: &Animation,
        instance: InstanceId,
        triangles: (u32, u32),
        elements: (u32, u32),
        mirrored: bool,
        (moves, repainted): (&[bool], &[bool]),
    ) {
        let mesh = &animation.meshes[animation.instances[instance].mesh];
        let material = &animation.materials[mesh.material];
        let repainted = repainted[mesh.material].then_some(mesh.material);
        let on_it = &self.elements[elements.0 as usize..elements.1 as usize];
        let glows = on_it.iter().any(|e| e.glow != Vec3::ZERO);
        let even = on_it.iter().all(|e| e.glow == Vec3::ONE);
        let lamps = match glows && even {
            true => lamps(&mesh.positions, &mesh.triangles),
            false => Vec::new(),
        };
        let surface = Surface {
            instance,
            moves: moves[instance],
            triangles,
            elements,
            base_color: repainted.map_or(material.base_color, |_| Vec3::ONE),
            emission: if glows {
                material.emission() * PI
            } else {
                Vec3::ZERO
            },
            even,
            lamps,
            unlit: material.unlit,
            mirrored,
            double_sided: material.double_sided,
            unseen: material.unseen,
            has_normals: mesh.normals.are_given(),
            has_bumps: material.normal_map.is_some() && !mesh.tangents.is_empty(),
            specular: material.specular,
            transmission: material.transmission,
            repainted,
        };
        if !surface.moves {
            self.static_triangles = triangles.1;
        }
        self.any_sends_on |= surface.specular.is_some_and(|s| s.sends_on());
        self.any_translucent |= surface.transmission.is_some();
        self.surfaces.push(surface);
    }

    /// Gives a number to every side that may hold light.
    fn number_sides(&mut self) {
        for (index, element) in self.elements.iter().enumerate() {
            let surface = &self.surfaces[self.surface_of[element.triangle]];
            let diffuse = surface.specular.is_none_or(|s| s.diffuse() > 0.0);
            let lit = element.share > 0.0 && !surface.unlit && diffuse;
            let mut numbers = [None; 2];
            for (back, number) in numbers.iter_mut().enumerate() {
                if lit && (back == 0 || surface.double_sided) {
                    *number = Some(SideId::from_index(self.sides.len()));
                    self.sides.push(Side {
                        element: ElementId::from_index(index),
                        back: back == 1,
                    });
                }
            }
            self.side_of.push(numbers);
        }
        self.count_static_sides();
    }

    /// Keeps the sides marked as lit; the others become black. Vertices keep their numbers.
    pub fn keep_sides(&mut self, lit: &[bool]) {
        let mut renumbered = vec![None; self.sides.len()];
        let kept = (0..lit.len()).filter(|side| lit[*side]);
        kept.zip((0..).map(SideId::new))
            .for_each(|(side, number)| renumbered[side] = Some(number));
        for number in self.side_of.iter_mut().flatten() {
            *number = number.and_then(|side| renumbered[side]);
        }
        let mut lit_sides = lit.iter();
        self.sides.retain(|_| *lit_sides.next().unwrap_or(&false));
        if self.clusters.is_empty() {
            let mut lit_vertices = lit.iter();
            self.vertex_of
                .retain(|_| *lit_vertices.next().unwrap_or(&false));
        }
        self.count_static_sides();
    }

    pub(super) fn count_static_sides(&mut self) {
        let of = |side: &Side| -> &Element { &self.elements[side.element] };
        let is_static = |side: &&Side| self.is_static(of(side).triangle);
        self.static_sides = self.sides.iter().take_while(is_static).count() as u32;
    }

    /// Sets the peak emission of each surface, over all times; a surface that is always dark is no emitter.
    pub fn set_peak_emission(&mut self, peaks: impl IntoIterator<Item = Vec3>) {
        for (surface, peak) in self.surfaces.iter_mut().zip(peaks) {
            let elements = &self.elements[surface.elements.0 as usize..surface.elements.1 as usize];
            let glows = !surface.unlit && elements.iter().any(|e| e.glow != Vec3::ZERO);
            surface.emission = if glows { peak } else { Vec3::ZERO };
        }
    }
}
