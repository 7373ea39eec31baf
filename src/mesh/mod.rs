//! The scene as patches: what never changes ([`Patches`]) and where it stands at time t ([`Placed`]).
//!
//! Triangles of the file are cut into elements (Cohen, Greenberg, Immel, Brock 1986, "An efficient radiosity approach
//! for realistic image synthesis", IEEE CG&A 6(3):26–35); a side of an element that light can reach is a receiver with
//! a radiosity of its own. An element knows its corners as weights of its triangle's corners, so that it follows any
//! motion of the triangle and keeps its identity for all time. Unlike the paper we solve on elements directly,
//! unless patches of several are asked for ([`group`]).

mod append;
pub mod budget;
mod contact;
pub mod cut;
pub mod group;
pub mod locate;
pub mod mean;
pub mod placed;
pub mod sizes;
pub mod weld;

pub use budget::{count, count_sides, size_for};
pub use placed::{Placed, Stand};
pub use sizes::Sizes;

use crate::error::{Error, Result};
use crate::ids::{InstanceId, MaterialId};
use crate::scene::{Animation, deform::Shown, paint::Paint};
use crate::texture::Cutouts;
use contact::Contacts;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// Marks a side of an element that has no radiosity: the black back of a single-sided surface, or a side no light reaches.
pub const NO_SIDE: u32 = u32::MAX;

/// The identity of everything light is exchanged between; it never changes during an animation.
#[derive(Clone, Debug)]
pub struct Patches {
    /// Instances of the animation, those that never move first.
    pub surfaces: Vec<Surface>,
    /// The surface of each triangle; triangles of resting surfaces come first.
    pub surface_of: Vec<u32>,
    /// Number of triangles that never move: ids below it are static, the others are on movers.
    pub static_triangles: u32,
    /// Elements in the order of their triangles.
    pub elements: Vec<Element>,
    /// How each triangle was cut, for finding the element at a hit.
    pub cuts: locate::Cuts,
    /// The sides that receive light, in the order of their elements.
    pub sides: Vec<Side>,
    /// Number of sides that never move.
    pub static_sides: u32,
    /// The side at the front and at the back of each element, or [`NO_SIDE`].
    pub side_of: Vec<[u32; 2]>,
    /// The welded vertex at each corner of each side, for interpolation.
    pub vertex_of: Vec<[u32; 3]>,
    /// Number of welded vertices.
    pub vertices: u32,
    /// Where triangles have holes.
    pub cutouts: Arc<Cutouts>,
    /// Longest edge of an element, in metres; where edges follow needs, that of an even mesh.
    pub element_size: f32,
    /// Distance of sample origins from their surface, in metres.
    pub lift: f32,
}

/// An instance of the animation with its material.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its instance.
    pub instance: InstanceId,
    /// Whether the playing clips move it, as a whole or its corners.
    pub moves: bool,
    /// First triangle and one past the last.
    pub triangles: (u32, u32),
    /// First element and one past the last.
    pub elements: (u32, u32),
    /// Reflectance, RGB: what its elements' tints multiply.
    pub base_color: Vec3,
    /// Emitted radiosity E = π·L of its front, and of its back if double-sided, that its elements' glow multiplies; zero
    /// where nothing glows. It is the largest it ever has, channel by channel, once [`Patches::outshine`] knows it, and
    /// that at rest before.
    pub emission: Vec3,
    /// Whether all of it glows alike.
    pub even: bool,
    /// Whether it is seen as it is painted, and sends no light on.
    pub unlit: bool,
    /// Whether it was mirrored when it was cut: its triangles' second and third corner have changed places.
    pub mirrored: bool,
    /// Whether its back has a radiosity too.
    pub double_sided: bool,
    /// The material whose base colour a playing clip sets, if one does: the reflectance of its elements is then without
    /// that colour, and [`Placed::colors`] has it.
    pub repainted: Option<MaterialId>,
}

/// A piece of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// The triangle it is cut from.
    pub triangle: u32,
    /// Its corners as weights of the triangle's second and third corner.
    pub corners: [Vec2; 3],
    /// What multiplies its surface's reflectance, RGB, averaged over what of it is there.
    pub tint: Vec3,
    /// What multiplies its surface's emission, RGB, averaged over its area; where it is not there it does not glow.
    pub glow: Vec3,
    /// The share of its area that is there: less than 1 where it has holes.
    pub share: f32,
}

/// One side of an element: a receiver.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Its element.
    pub element: u32,
    /// Whether it is the back.
    pub back: bool,
}

impl Surface {
    /// Emitted radiosity E of one of its elements.
    pub fn emission_of(&self, element: &Element) -> Vec3 {
        self.emission * element.glow
    }
}

impl Patches {
    /// Cuts an animation into elements with no edge longer than `size` metres at time 0; what has no area then is cut
    /// when it has most.
    ///
    /// Errors name the scene when it holds no triangle, or so many elements that ids would run out.
    pub fn cut(animation: &Animation, size: f32) -> Result<Patches> {
        Patches::cut_by(animation, &Sizes::Even(size))
    }

    /// The same with edges as long as `sizes` lets them be.
    pub fn cut_by(animation: &Animation, sizes: &Sizes) -> Result<Patches> {
        // Count first: a size mistyped by a few zeros must not fill the memory.
        let (shown, size) = (animation.shown(), sizes.even());
        let elements = budget::count_of(&shown, sizes, None, locate::MOST_ELEMENTS);
        if elements >= locate::MOST_ELEMENTS {
            return Err(budget::too_many(animation, size, elements));
        }
        let moves = animation.moves();
        let repainted = animation.repainted();
        // Put what never moves first, so that a lower triangle id is the static one in every tie.
        let mut order: Vec<u32> = (0..animation.instances.len() as u32).collect();
        order.sort_by_key(|&i| moves[i as usize]);

        let cutouts = Arc::new(mean::cutouts(animation, &order, &shown));
        let contacts = Contacts::of(animation, &shown, Some(&cutouts));

        let mut patches = Patches {
            surfaces: Vec::new(),
            surface_of: Vec::new(),
            static_triangles: 0,
            elements: Vec::new(),
            cuts: locate::Cuts::default(),
            sides: Vec::new(),
            static_sides: 0,
            side_of: Vec::new(),
            vertex_of: Vec::new(),
            vertices: 0,
            cutouts,
            element_size: size,
            lift: contact::lift(&shown),
        };
        let mut placed = Placed {
            triangles: Vec::new(),
            reversed: Vec::new(),
            colors: Vec::new(),
        };
        let mut weld = weld::Corners::default();
        for &i in &order {
            let instance = animation.instances[i as usize];
            let mesh = &animation.meshes[instance.mesh];
            let material = &animation.materials[mesh.material];
            let Shown { corners, mirrored } = &shown[i as usize];
            let surface = patches.surfaces.len() as u32;
            let first = patches.surface_of.len() as u32;
            let repainted = repainted[mesh.material].then_some(mesh.material);
            let cutouts = patches.cutouts.clone();
            let source = mean::Source {
                paint: Paint::of(animation, i as usize, *mirrored),
                cutouts: &cutouts,
                first,
            };
            let first_element = patches.elements.len();
            let rule = sizes.of(i as usize);
            let mut crossings = contacts.on(i as usize);
            placed.triangles.extend(corners);
            for (k, triangle) in corners.iter().enumerate() {
                patches.surface_of.push(surface);
                let crossings = crossings.as_mut();
                cut::triangle(
                    &mut patches,
                    &mut weld,
                    triangle,
                    k,
                    rule,
                    &source,
                    crossings,
                )
                .map_err(|got| budget::too_many(animation, size, got))?;
            }
            let elements = &patches.elements[first_element..];
            patches.surfaces.push(Surface {
                instance: InstanceId::from_index(i as usize),
                moves: moves[i as usize],
                triangles: (first, first + corners.len() as u32),
                elements: (first_element as u32, patches.elements.len() as u32),
                base_color: repainted.map_or(material.base_color, |_| Vec3::ONE),
                emission: if elements.iter().any(|e| e.glow != Vec3::ZERO) {
                    material.emission() * PI
                } else {
                    Vec3::ZERO
                },
                even: elements.iter().all(|e| e.glow == Vec3::ONE),
                unlit: material.unlit,
                mirrored: *mirrored,
                double_sided: material.double_sided,
                repainted,
            });
            if !patches.surfaces[surface as usize].moves {
                patches.static_triangles = patches.surface_of.len() as u32;
            }
        }
        if patches.elements.is_empty() {
            return Err(Error::Scene {
                file: animation.file.clone(),
                pointer: "/meshes".into(),
                expected: "at least one triangle with an area on a node of the scene".into(),
                got: "none".into(),
                way_out: "export the objects' meshes too".into(),
            });
        }
        patches.number_sides(&weld, &placed, &contacts);
        Ok(patches)
    }

    /// Gives every side that may hold light its number and its welded vertices.
    fn number_sides(&mut self, weld: &weld::Corners, placed: &Placed, contacts: &Contacts) {
        for (index, element) in self.elements.iter().enumerate() {
            let surface = &self.surfaces[self.surface_of[element.triangle as usize] as usize];
            let mut numbers = [NO_SIDE; 2];
            for (back, number) in numbers.iter_mut().enumerate() {
                let seen = element.share > 0.0 && !surface.unlit;
                if seen && (back == 0 || surface.double_sided) {
                    *number = self.sides.len() as u32;
                    self.sides.push(Side {
                        element: index as u32,
                        back: back == 1,
                    });
                }
            }
            self.side_of.push(numbers);
        }
        self.count_static_sides();
        (self.vertex_of, self.vertices) = weld.weld(self, placed, contacts);
    }

    /// Keeps only the sides marked as lit; the others become black. Vertices keep their numbers.
    pub fn keep(&mut self, lit: &[bool]) {
        let mut renumbered = vec![NO_SIDE; self.sides.len()];
        let kept = (0..lit.len()).filter(|side| lit[*side]);
        kept.zip(0..)
            .for_each(|(side, number)| renumbered[side] = number);
        for number in self.side_of.iter_mut().flatten().filter(|n| **n != NO_SIDE) {
            *number = renumbered[*number as usize];
        }
        let mut lit_sides = lit.iter();
        self.sides.retain(|_| *lit_sides.next().unwrap_or(&false));
        let mut lit_vertices = lit.iter();
        self.vertex_of
            .retain(|_| *lit_vertices.next().unwrap_or(&false));
        self.count_static_sides();
    }

    fn count_static_sides(&mut self) {
        let resting =
            |s: &&Side| self.elements[s.element as usize].triangle < self.static_triangles;
        self.static_sides = self.sides.iter().take_while(resting).count() as u32;
    }

    /// The surface that a side belongs to.
    pub fn surface(&self, side: u32) -> &Surface {
        let element = &self.elements[self.sides[side as usize].element as usize];
        &self.surfaces[self.surface_of[element.triangle as usize] as usize]
    }

    /// The elements of a surface.
    pub fn elements_of(&self, surface: &Surface) -> &[Element] {
        &self.elements[surface.elements.0 as usize..surface.elements.1 as usize]
    }

    /// Takes the largest emission that each surface ever has: whoever is dark at all times is no emitter.
    pub fn outshine(&mut self, brightest: impl IntoIterator<Item = Vec3>) {
        for (surface, emission) in self.surfaces.iter_mut().zip(brightest) {
            let elements = &self.elements[surface.elements.0 as usize..surface.elements.1 as usize];
            let glows = !surface.unlit && elements.iter().any(|e| e.glow != Vec3::ZERO);
            surface.emission = if glows { emission } else { Vec3::ZERO };
        }
    }

    /// The largest emitted radiosity E that a side ever has.
    pub fn emission(&self, side: u32) -> Vec3 {
        let element = &self.elements[self.sides[side as usize].element as usize];
        self.surface(side).emission_of(element)
    }

    /// Reflectance of a side, without the colour of a repainted surface.
    pub fn reflectance(&self, side: u32) -> Vec3 {
        let element = &self.elements[self.sides[side as usize].element as usize];
        self.surface(side).base_color * element.tint
    }

    /// What covers each surface, for look-ups point by point.
    pub fn paints<'a>(&self, animation: &'a Animation) -> Vec<Paint<'a>> {
        let paint = |s: &Surface| Paint::of(animation, s.instance.index(), s.mirrored);
        self.surfaces.iter().map(paint).collect()
    }

    /// Reflectance of every side in a pose.
    pub fn reflectances(&self, placed: &Placed) -> Vec<Vec3> {
        let of = |side: u32| self.reflectance(side) * placed.colors[self.surface_at(side)];
        (0..self.sides.len() as u32).map(of).collect()
    }

    /// The position of the surface that a side belongs to.
    pub fn surface_at(&self, side: u32) -> usize {
        let element = &self.elements[self.sides[side as usize].element as usize];
        self.surface_of[element.triangle as usize] as usize
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of_val(&self.elements[..])
            + size_of_val(&self.sides[..])
            + size_of_val(&self.side_of[..])
            + size_of_val(&self.vertex_of[..])
            + size_of_val(&self.surface_of[..])
            + self.cuts.memory()
            + self.cutouts.memory()
    }
}
