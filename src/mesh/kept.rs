//! The mesh in an archive: elements, cuts, clusters, sides and vertices, which take long to find.
//!
//! Surfaces and holes follow from the scene and the elements, and are found again; grids are made again from the cuts. What is
//! read is checked number by number, so that none leads out of a list or round in a circle.

use super::bisection::WHOLE;
use super::clusters::{Clusters, SPREAD};
use super::cuts::{Cuts, LEAF, Slice};
use super::order::order;
use super::{Element, RadiosityMesh, Side, cuts, mean};
use crate::archive::{ArchiveReader, ArchiveWriter, check};
use crate::ids::{ElementId, SideId, SurfaceId, TriangleId};
use crate::scene::Animation;
use glam::{Vec2, Vec3};
use std::io;
use std::sync::Arc;

/// Stands for no side, and for no cluster.
const NONE: u32 = u32::MAX;

impl RadiosityMesh {
    /// Writes what [`RadiosityMesh::restore`] reads.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        to.list(&[self.element_size, self.ray_offset])?;
        to.column(&self.surfaces, |surface| u8::from(surface.even))?;
        to.column(&self.elements, |element| element.triangle.number())?;
        to.column(&self.elements, |element| element.corners)?;
        to.column(&self.elements, |element| element.tint)?;
        to.column(&self.elements, |element| element.glow)?;
        to.column(&self.elements, |element| element.share)?;
        self.cuts.store(to)?;
        self.clusters.store(to)?;
        to.column(&self.sides, |side| side.element.number())?;
        to.column(&self.sides, |side| u8::from(side.back))?;
        to.column(&self.side_of, |sides| {
            sides.map(|side| side.map_or(NONE, SideId::number))
        })?;
        to.list(&self.vertex_of)?;
        to.number(self.vertices.into())
    }

    /// Reads the mesh of an animation; its emission is that at rest, as after the cut.
    ///
    /// # Errors
    /// Words on what does not fit the animation or itself.
    pub fn restore(
        animation: &Animation,
        from: &mut ArchiveReader,
    ) -> Result<RadiosityMesh, String> {
        let sizes: Vec<f32> = from.list_of(2)?;
        let (order, shown) = (order(animation), animation.shown());
        // Clusters may have averaged what was even when the surface was made.
        let even: Vec<u8> = from.list_of(order.len())?;
        let cutouts = Arc::new(mean::cutouts(animation, &order, &shown));
        let mut mesh = RadiosityMesh::empty(cutouts, sizes[0], sizes[1]);
        let counts = order.iter().map(|instance| shown[*instance].corners.len());
        let triangles: usize = counts.clone().sum();

        // Read the elements; those of a surface follow each other.
        let of: Vec<u32> = from.list()?;
        let known = of.last().is_some_and(|last| (*last as usize) < triangles);
        check(known && of.is_sorted(), "elements of no triangle")?;
        check(of.len() < cuts::MOST_ELEMENTS, "too many elements")?;
        mesh.elements = elements(&of, from)?;
        mesh.cuts = Cuts::restore(triangles, of.len(), from)?;
        let (moves, repainted) = (animation.moves(), animation.repainted());
        let mut first = 0;
        for (number, (instance, count)) in order.iter().zip(counts).enumerate() {
            let instance = *instance;
            let surface = SurfaceId::from_index(number);
            mesh.surface_of.extend(vec![surface; count]);
            let range = (first, first + count as u32);
            let within = [range.0, range.1].map(|end| of.partition_point(|t| *t < end) as u32);
            let mirrored = shown[instance].mirrored;
            let known = (&moves[..], &repainted[..]);
            mesh.push_surface(animation, instance, range, within.into(), mirrored, known);
            mesh.surfaces[number].even = even[number] != 0;
            first = range.1;
        }

        // Read what the elements have.
        mesh.clusters = Clusters::restore(of.len(), from)?;
        mesh.restore_sides(from)?;
        mesh.vertex_of = from.list()?;
        mesh.vertices = u32::try_from(from.number()?).unwrap_or(NONE);
        let vertices = mesh.vertex_of.as_flattened();
        let known = vertices.iter().all(|vertex| *vertex < mesh.vertices);
        check(known, "vertices without a number")?;
        check(
            mesh.vertices as usize <= 3 * mesh.vertex_of.len().max(of.len() * 2),
            "too many vertices",
        )?;
        check(mesh.facets_fit(), "sides without vertices")?;
        Ok(mesh)
    }

    /// Reads the sides.
    fn restore_sides(&mut self, from: &mut ArchiveReader) -> Result<(), String> {
        let elements = self.elements.len();
        let of: Vec<u32> = from.list()?;
        let backs: Vec<u8> = from.list_of(of.len())?;
        let known = of.iter().all(|element| (*element as usize) < elements);
        check(
            known && of.len() <= 2 * elements,
            "sides without an element",
        )?;
        let sides = of.iter().zip(&backs).map(|(element, back)| Side {
            element: ElementId::new(*element),
            back: *back != 0,
        });
        self.sides = sides.collect();
        let numbers: Vec<[u32; 2]> = from.list_of(elements)?;
        let count = self.sides.len() as u32;
        let known = |side: &u32| *side == NONE || *side < count;
        check(
            numbers.as_flattened().iter().all(known),
            "sides without a number",
        )?;
        let side = |number: u32| (number != NONE).then(|| SideId::new(number));
        self.side_of = numbers.iter().map(|pair| pair.map(side)).collect();
        self.count_static_sides();
        Ok(())
    }

    /// Whether each side of each element has a row of vertices.
    fn facets_fit(&self) -> bool {
        let rows = self.vertex_of.len();
        match self.clusters.is_empty() {
            true => rows == self.sides.len(),
            false => self.facets().all(|(row, ..)| (row as usize) < rows),
        }
    }
}

/// Reads the elements of these triangles.
fn elements(of: &[u32], from: &mut ArchiveReader) -> Result<Vec<Element>, String> {
    let corners: Vec<[Vec2; 3]> = from.list_of(of.len())?;
    let tint: Vec<Vec3> = from.list_of(of.len())?;
    let glow: Vec<Vec3> = from.list_of(of.len())?;
    let share: Vec<f32> = from.list_of(of.len())?;
    let element = |at: usize| Element {
        triangle: TriangleId::new(of[at]),
        corners: corners[at],
        tint: tint[at],
        glow: glow[at],
        share: share[at],
    };
    Ok((0..of.len()).map(element).collect())
}

impl Cuts {
    fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        to.list(&self.roots)?;
        to.list(&self.nodes)?;
        to.column(&self.slices, |slice| slice.edge)?;
        to.column(&self.slices, |slice| slice.share)?;
        to.column(&self.slices, |slice| slice.parts)
    }

    /// Reads the cuts of so many triangles into so many elements.
    fn restore(
        triangles: usize,
        elements: usize,
        from: &mut ArchiveReader,
    ) -> Result<Cuts, String> {
        let roots: Vec<u32> = from.list_of(triangles)?;
        let nodes: Vec<u32> = from.list()?;
        let edge: Vec<u32> = from.list()?;
        let share: Vec<f32> = from.list_of(edge.len())?;
        let parts: Vec<[u32; 2]> = from.list_of(edge.len())?;
        let slices = (0..edge.len()).map(|at| Slice {
            edge: edge[at],
            share: share[at],
            parts: parts[at],
        });
        let mut cuts = Cuts {
            roots,
            nodes,
            slices: slices.collect(),
            ..Cuts::default()
        };
        check(cuts.end_in(elements as u32), "cuts that end nowhere")?;
        cuts.make_grids();
        Ok(cuts)
    }

    /// Whether every way down ends in one of so many elements.
    fn end_in(&self, elements: u32) -> bool {
        // Children and parts come after what is cut, so no way goes round in a circle.
        let ends = |number: u32, after: usize| match self.slice_at(number) {
            Some(_) => number as usize - cuts::MOST_ELEMENTS >= after,
            None => number < elements,
        };
        let count = self.nodes.len();
        let node = |(at, code): (usize, &u32)| match code & LEAF {
            LEAF => ends(code >> 2, 0),
            _ => (at + 1..count.saturating_sub(1)).contains(&((code >> 2) as usize)),
        };
        let slice = |(at, slice): (usize, &Slice)| {
            slice.is_one() && slice.parts.iter().all(|part| ends(*part, at + 1))
        };
        self.roots.iter().all(|root| (*root as usize) < count)
            && self.nodes.iter().enumerate().all(node)
            && self.slices.iter().enumerate().all(slice)
            && count < WHOLE as usize
    }
}

impl Clusters {
    fn store(&self, to: &mut ArchiveWriter) -> io::Result<()> {
        to.column(&self.of, |cluster| cluster.unwrap_or(NONE))?;
        to.list(&self.start)?;
        to.column(&self.members, |member| member.number())?;
        to.column(&self.spread, |spread| spread.map(ElementId::number))?;
        to.list(&self.facets)
    }

    /// Reads the clusters of so many elements.
    fn restore(elements: usize, from: &mut ArchiveReader) -> Result<Clusters, String> {
        let of: Vec<u32> = from.list()?;
        let start: Vec<u32> = from.list()?;
        let members: Vec<u32> = from.list()?;
        let spread: Vec<[u32; SPREAD]> = from.list()?;
        let facets: Vec<[u32; 2]> = from.list()?;
        let all = (members.iter()).chain(spread.as_flattened());
        let known = { all }.all(|element| (*element as usize) < elements);
        let clusters = spread.len() as u32;
        let numbered = |cluster: &u32| *cluster == NONE || *cluster < clusters;
        let rows = start.first() == Some(&0)
            && start.is_sorted()
            && start.len() == spread.len() + 1
            && start
                .last()
                .is_some_and(|end| *end as usize == members.len())
            && of.len() == elements
            && facets.len() == elements;
        let none = of.is_empty() && members.is_empty() && spread.is_empty() && facets.is_empty();
        check(
            known && of.iter().all(numbered) && (rows || none),
            "clusters of no elements",
        )?;
        let cluster = |number: &u32| (*number != NONE).then_some(*number);
        let ids = |list: &[u32; SPREAD]| list.map(ElementId::new);
        Ok(Clusters {
            of: of.iter().map(cluster).collect(),
            start,
            members: members.into_iter().map(ElementId::new).collect(),
            spread: spread.iter().map(ids).collect(),
            facets,
        })
    }
}
