//! Elements of many triangles: the members of each share its sides.
//!
//! A side then stands for all of its members ([`grain`](super::grain) finds them): its area is theirs together, its normal the
//! mean of theirs by area, its samples start from all over them, and its colour is their mean. Every member keeps its own
//! vertices, so that light is interpolated over the fine mesh.

use super::clusters::{Clusters, SPREAD};
use super::grain::{Clustering, Grains};
use super::placed::PosedMesh;
use super::{Element, RadiosityMesh, Side};
use crate::ids::{ElementId, SideId};
use glam::Vec3;
use std::collections::HashMap;

impl RadiosityMesh {
    /// Number of elements, a cluster counted once.
    pub fn count(&self) -> usize {
        self.elements.len() - self.clusters.joined()
    }

    /// The area of a side in m², in this pose.
    pub fn area(&self, placed: &PosedMesh, side: &Side) -> f32 {
        match self.clusters.cluster(side.element) {
            None => placed.area(&self.elements[side.element]),
            Some(cluster) => {
                let members = self.clusters.members(cluster).iter();
                members.map(|e| placed.area(&self.elements[*e])).sum()
            }
        }
    }

    /// The row of [`RadiosityMesh::vertex_of`] for a point of an element that shows a side.
    #[inline]
    pub fn facet(&self, element: ElementId, side: SideId) -> u32 {
        if self.clusters.is_empty() {
            return side.number();
        }
        self.clusters.facets[element.index()][usize::from(self.sides[side].back)]
    }

    /// The rows of vertices with their elements and sides; those of dark sides are left out.
    pub fn facets(&self) -> impl Iterator<Item = (u32, ElementId, SideId)> {
        let elements = (0..self.elements.len()).map(ElementId::from_index);
        elements.flat_map(move |element| {
            let sides = self.side_of[element].into_iter().flatten();
            sides.map(move |side| (self.facet(element, side), element, side))
        })
    }

    /// Lets the small triangles share sides; every element has sides and vertices of its own yet.
    pub(super) fn cluster(&mut self, placed: &PosedMesh, grains: &Grains, clustering: &Clustering) {
        // Bring the members of each cluster together, in the order of their elements.
        let size = clustering.size;
        let roots = grains.clusters(clustering);
        let mut known: HashMap<u32, u32> = HashMap::new();
        let mut lists: Vec<Vec<ElementId>> = Vec::new();
        for (index, element) in self.elements.iter().enumerate() {
            let surface = &self.surfaces[self.surface_of[element.triangle]];
            let triangle = grains.first[surface.instance.index()] + element.triangle.number()
                - surface.triangles.0;
            if !grains.is_small(triangle as usize, size) || element.share <= 0.0 {
                continue;
            }
            let next = lists.len() as u32;
            let list = *known.entry(roots[triangle as usize]).or_insert(next);
            if list == next {
                lists.push(Vec::new());
            }
            lists[list as usize].push(ElementId::from_index(index));
        }
        lists.retain(|list| list.len() > 1);
        if lists.is_empty() {
            return;
        }

        // Keep them, and give all members the mean of their colours.
        let mut clusters = Clusters {
            of: vec![None; self.elements.len()],
            start: vec![0],
            facets: self.side_of.iter().map(rows).collect(),
            ..Clusters::default()
        };
        for (number, list) in (0..).zip(&lists) {
            list.iter()
                .for_each(|e| clusters.of[e.index()] = Some(number));
            clusters.members.extend(list);
            clusters.start.push(clusters.members.len() as u32);
            let areas: Vec<f32> = list
                .iter()
                .map(|e| placed.area(&self.elements[*e]))
                .collect();
            clusters.spread.push(spread(list, &areas));
            self.average(list, &areas);
        }
        self.clusters = clusters;
        self.share_sides();
    }

    /// Gives all members the mean of their colours, by their areas.
    fn average(&mut self, members: &[ElementId], areas: &[f32]) {
        let total = areas.iter().sum::<f32>().max(f32::MIN_POSITIVE);
        let (mut tint, mut glow, mut share, mut there) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
        for (member, area) in members.iter().zip(areas) {
            let element = &self.elements[*member];
            tint += element.tint * (area * element.share);
            glow += element.glow * *area;
            share += element.share * area;
            there += area * element.share;
        }
        let even = members.iter().all(|e| {
            let (a, b) = (&self.elements[*e], &self.elements[members[0]]);
            (a.tint, a.glow, a.share) == (b.tint, b.glow, b.share)
        });
        if even {
            return;
        }
        for member in members {
            let element = &mut self.elements[*member];
            *element = Element {
                tint: tint / f32::max(there, f32::MIN_POSITIVE),
                glow: glow / total,
                share: share / total,
                ..*element
            };
        }
    }

    /// Numbers the sides again, the members of a cluster sharing those of the first.
    fn share_sides(&mut self) {
        self.sides.clear();
        for index in 0..self.elements.len() {
            let element = ElementId::from_index(index);
            let first = match self.clusters.cluster(element) {
                Some(cluster) => self.clusters.members(cluster)[0],
                None => element,
            };
            if first != element {
                let of_first = self.side_of[first];
                let mine = &mut self.side_of[element];
                *mine = [0, 1].map(|back| mine[back].and(of_first[back]));
                continue;
            }
            for back in 0..2 {
                if self.side_of[element][back].is_some() {
                    self.side_of[element][back] = Some(SideId::from_index(self.sides.len()));
                    self.sides.push(Side {
                        element,
                        back: back == 1,
                    });
                }
            }
        }
        self.count_static_sides();
    }
}

impl Clusters {
    /// Adds elements that are in no cluster, whose rows of vertices begin at `first`.
    pub(super) fn append(&mut self, side_of: &[[Option<SideId>; 2]], first: u32) {
        self.of.resize(self.of.len() + side_of.len(), None);
        let row = |side: Option<SideId>| side.map_or(u32::MAX, |side| first + side.number());
        let rows = side_of.iter().map(|sides| sides.map(row));
        self.facets.extend(rows);
    }
}

/// The rows of vertices of an element's sides, while each has its own.
fn rows(sides: &[Option<SideId>; 2]) -> [u32; 2] {
    sides.map(|side| side.map_or(u32::MAX, SideId::number))
}

/// The members at even steps of the area.
fn spread(members: &[ElementId], areas: &[f32]) -> [ElementId; SPREAD] {
    let total: f32 = areas.iter().sum();
    let (mut at, mut below) = (0, 0.0);
    std::array::from_fn(|s| {
        let wanted = total * (s as f32 + 0.5) / SPREAD as f32;
        while at + 1 < members.len() && below + areas[at] < wanted {
            below += areas[at];
            at += 1;
        }
        members[at]
    })
}
