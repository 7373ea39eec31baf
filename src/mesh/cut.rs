//! Cutting triangles into elements: an edge is halved if and only if it is too long, by a rule that sees the edge alone.
//!
//! That rule alone is conforming: two triangles that share an edge decide alike about it and about its halves, so no
//! vertex of one lies inside an edge of the other. Inside a triangle the longest edge is split first (Rivara 1984,
//! "Algorithms for refining triangular grids suitable for adaptive and multigrid techniques", International Journal for
//! Numerical Methods in Engineering 20(4):745–756), which keeps angles from shrinking. What is short enough is sliced where
//! something stands across its edges (`contact.rs`), or the boundary of a shadow crosses them (`shadow_cuts.rs`), by a rule
//! that sees the edge alone too. Light of near emitters
//! (`near_light.rs`) halves edges of pieces that are not small already: there a vertex may lie inside a small piece's edge.

use super::contact::Crossings;
use super::cuts::{CutPlace, MOST_ELEMENTS};
use super::mean::Source;
use super::sizes::Rule;
use super::{RadiosityMesh, weld};
use glam::{Vec2, Vec3};

/// Slices of one piece at most: a thicket that stands on it must not use up all elements.
const MOST_SLICES: usize = 32;

/// The same where shadows cut too: above what has room in a piece at their least distance.
const MOST_SHADED: usize = 256;

/// Near light halves no piece of less than this share of the even size squared: a quarter of a square of an eighth.
const SMALLEST: f32 = 0.25 / 64.0;

/// A triangle on its way to becoming elements: positions decide about edges, weights say where it lies in its parent.
#[derive(Clone, Copy)]
struct Piece {
    positions: [Vec3; 3],
    weights: [Vec2; 3],
}

impl Piece {
    fn whole(positions: &[Vec3; 3]) -> Piece {
        Piece {
            positions: *positions,
            weights: [Vec2::ZERO, Vec2::X, Vec2::Y],
        }
    }

    /// Its unit normal; zero if it has no area.
    fn normal(&self) -> Vec3 {
        let [a, b, c] = self.positions;
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// The edge to halve: one that the rule splits, or else one along which light of near emitters differs, as long as the
    /// piece is no smaller than such light may make it.
    fn edge(&self, rule: Rule, crossings: Option<&mut Crossings>) -> Option<usize> {
        self.longest(|ends| rule.splits(ends)).or_else(|| {
            let (crossings, even) = (crossings?, rule.even()?);
            let [a, b, c] = self.positions;
            let across = (b - a).cross(c - a);
            let area = across.length() * 0.5;
            if area <= SMALLEST * even * even {
                return None;
            }
            let normal = across / (2.0 * area);
            self.longest(|ends| crossings.halves(ends, normal))
        })
    }

    /// The longest edge that is to be split, named by the corner opposite to it.
    fn longest(&self, mut splits: impl FnMut([Vec3; 2]) -> bool) -> Option<usize> {
        let ends = |e: usize| [self.positions[(e + 1) % 3], self.positions[(e + 2) % 3]];
        let mut longest = (0.0, None);
        for edge in 0..3 {
            let [p, q] = ends(edge);
            let length = p.distance_squared(q);
            if length > longest.0 && splits([p, q]) {
                longest = (length, Some(edge));
            }
        }
        longest.1
    }

    /// The two halves at the middle of an edge.
    fn halves(&self, edge: usize) -> [Piece; 2] {
        let (p, w) = (&self.positions, &self.weights);
        let (y, z) = ((edge + 1) % 3, (edge + 2) % 3);
        self.parts(edge, (p[y] + p[z]) * 0.5, (w[y] + w[z]) * 0.5)
    }

    /// An edge that is cut, the weight of its second end there, and the two parts: the first edge that something stands across,
    /// or one that the boundary of a shadow crosses.
    fn slice(&self, crossings: &mut Crossings, normal: Vec3) -> Option<(usize, f32, [Piece; 2])> {
        let shadows = crossings.cuts_shadows();
        let mut cuts = (0..3).filter_map(|edge| {
            let (y, z) = ((edge + 1) % 3, (edge + 2) % 3);
            let ends = [self.positions[y], self.positions[z]];
            let cut = crossings.split(ends, normal)?;
            let along = crossings.keeps_to(&cut, self.positions[edge]);
            Some((edge, cut, along))
        });
        let first = cuts.next()?;
        // All three are cut in the end: begin with one that keeps to its shadow on the way to the opposite corner.
        let along = (first.2 || !shadows).then_some(None);
        let along = along.unwrap_or_else(|| cuts.find(|(.., along)| *along));
        let (edge, cut, _) = along.unwrap_or(first);
        let (y, z) = ((edge + 1) % 3, (edge + 2) % 3);
        let weight = self.weights[y] + (self.weights[z] - self.weights[y]) * cut.share;
        Some((edge, cut.share, self.parts(edge, cut.point, weight)))
    }

    /// The two parts at a point of an edge. The new corner comes first, so that the next split, mostly of the
    /// edge opposite to it, is mostly edge 0; the winding stays.
    fn parts(&self, edge: usize, position: Vec3, weight: Vec2) -> [Piece; 2] {
        let (x, y, z) = (edge, (edge + 1) % 3, (edge + 2) % 3);
        let (p, w) = (&self.positions, &self.weights);
        [
            Piece {
                positions: [position, p[x], p[y]],
                weights: [weight, w[x], w[y]],
            },
            Piece {
                positions: [position, p[z], p[x]],
                weights: [weight, w[z], w[x]],
            },
        ]
    }
}

/// The parts of a piece that is short enough, each with its place in the tree of cuts, which `split` goes on building.
fn slices<P>(
    piece: Piece,
    place: P,
    crossings: Option<&mut Crossings>,
    mut split: impl FnMut(P, usize, f32) -> [P; 2],
) -> Vec<(P, Piece)> {
    let mut parts = Vec::with_capacity(1);
    let mut stack = vec![(place, piece)];
    let normal = piece.normal();
    if let Some(crossings) = crossings {
        let most = match crossings.cuts_shadows() {
            true => MOST_SHADED,
            false => MOST_SLICES,
        };
        while let Some((place, piece)) = stack.pop() {
            let room = parts.len() + stack.len() < most;
            match room.then(|| piece.slice(crossings, normal)).flatten() {
                Some((edge, share, [first, second])) => {
                    let [one, other] = split(place, edge, share);
                    stack.extend([(other, second), (one, first)]);
                }
                None => parts.push((place, piece)),
            }
        }
    }
    parts.extend(stack);
    parts
}

/// Cuts one triangle of the surface being added and appends its elements; `Err` holds how many there would be.
pub(super) fn triangle(
    patches: &mut RadiosityMesh,
    weld: &mut weld::Corners,
    positions: &[Vec3; 3],
    index: usize,
    rule: Rule,
    source: &Source,
    mut crossings: Option<&mut Crossings>,
) -> Result<(), usize> {
    if let Some(crossings) = crossings.as_deref_mut() {
        crossings.enter(index);
    }
    let root = patches.cuts.root();
    let mut stack = vec![(root, Piece::whole(positions))];
    while let Some((node, piece)) = stack.pop() {
        if let Some(edge) = piece.edge(rule, crossings.as_deref_mut()) {
            let child = patches.cuts.split(node, edge);
            let [first, second] = piece.halves(edge);
            stack.extend([(child + 1, second), (child, first)]);
            continue;
        }
        let cuts = &mut patches.cuts;
        let parts = slices(
            piece,
            CutPlace::Node(node),
            crossings.as_deref_mut(),
            |place, edge, share| cuts.slice(place, edge, share),
        );
        for (place, part) in parts {
            if patches.elements.len() >= MOST_ELEMENTS {
                return Err(patches.elements.len());
            }
            patches.cuts.leaf(place, patches.elements.len());
            patches.elements.push(source.element(index, part.weights));
            weld.push(part.positions);
        }
    }
    Ok(())
}

/// Counts the elements of one triangle without building them, stopping at `most`.
pub(super) fn count(
    positions: &[Vec3; 3],
    rule: Rule,
    mut crossings: Option<&mut Crossings>,
    most: usize,
) -> usize {
    let mut stack = vec![Piece::whole(positions)];
    let mut leaves = 0;
    while let Some(piece) = stack.pop() {
        match piece.edge(rule, crossings.as_deref_mut()) {
            // In the order in which they are cut.
            Some(edge) => stack.extend(piece.halves(edge).into_iter().rev()),
            None => leaves += slices(piece, (), crossings.as_deref_mut(), |_, _, _| [(); 2]).len(),
        }
        if leaves + stack.len() >= most {
            return most;
        }
    }
    leaves
}
