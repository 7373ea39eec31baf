//! Near emitters: an element's edge is halved where light of an emitter close by differs along it.
//!
//! An element has one radiosity. Where a panel hangs close below a ceiling, the ceiling is bright above the panel and dark
//! beside it; an element that reaches past the panel's rim carries the average of both, and the room sees light that nobody
//! should see. Cohen, Greenberg, Immel and Brock 1986, "An efficient radiosity approach for realistic image synthesis", IEEE
//! Computer Graphics and Applications 6(3):26–35, divide elements by the differences of a solution; we need none: the light
//! of an emitter in closed form, unoccluded (`geometry::polygon`), says where it may differ. Only what is close to an edge
//! counts, for farther emitters vary little along it; occluders do not count, for their shadows are coarser than a rim's.
//!
//! An element of area A that mixes irradiances which differ by D sends D·A watts wrong ways. An edge of length l is halved
//! where D·l² is more than an even element receives on average: the resting emitters' power over the resting area, times
//! the even size squared. Emitters that move light no place for all time, and do not count.

use crate::geometry::polygon::point_to_triangle;
use crate::geometry::{AabbBvh8, Bounds, Ray};
use crate::scene::{Animation, Target, deform::Shown};
use glam::Vec3;
use std::f32::consts::PI;

/// How near an emitter must be to count, in even sizes.
const REACH: f32 = 2.0;

/// What an edge's difference may send wrong ways, in shares of what an even element receives.
const LEAST: f32 = 1.0;

/// Where along an edge light is compared.
const PLACES: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Times tried for the strongest emission of a material whose emission changes.
const TRIED: usize = 32;

/// The resting emitters.
pub(super) struct NearLight {
    emitters: Vec<NearEmitter>,
    /// Mean irradiance of the resting surfaces if nothing occluded the emitters, in W/m².
    mean: f32,
}

/// An instance that emits.
struct NearEmitter {
    triangles: Vec<[Vec3; 3]>,
    bounds: Bounds,
    /// Emitted radiosity E in W/m², the strongest channel at its strongest time.
    emission: f32,
    double_sided: bool,
}

/// The emitters that count for edges up to one size.
pub(super) struct ReachedLight<'a> {
    light: &'a NearLight,
    tree: AabbBvh8,
    /// The even size in metres.
    size: f32,
}

impl NearLight {
    /// The emitters among an animation's resting instances.
    pub(super) fn of(animation: &Animation, shown: &[Shown], moves: &[bool]) -> NearLight {
        let strongest = strongest(animation);
        let (mut emitters, mut power, mut area) = (Vec::new(), 0.0, 0.0);
        let resting = animation.instances.iter().zip(shown).zip(moves);
        for ((instance, shown), _) in resting.filter(|(_, moves)| !**moves) {
            let mesh = &animation.meshes[instance.mesh];
            let material = &animation.materials[mesh.material];
            let emission = strongest[mesh.material] * PI;
            let here: f32 = shown.corners.iter().map(triangle_area).sum();
            area += here;
            if emission > 0.0 && !material.unlit {
                power += emission * here * if material.double_sided { 2.0 } else { 1.0 };
                emitters.push(NearEmitter {
                    bounds: Bounds::of_points(shown.corners.iter().flatten()),
                    triangles: shown.corners.clone(),
                    emission,
                    double_sided: material.double_sided,
                });
            }
        }
        NearLight {
            emitters,
            mean: power / area,
        }
    }

    /// Its emitters as edges of an even mesh of this size meet them; none if nothing emits.
    pub(super) fn within(&self, size: f32) -> Option<ReachedLight<'_>> {
        let padded: Vec<Bounds> = self
            .emitters
            .iter()
            .map(|emitter| emitter.bounds.padded(REACH * size))
            .collect();
        (!padded.is_empty()).then(|| ReachedLight {
            light: self,
            tree: AabbBvh8::build(&padded),
            size,
        })
    }
}

impl ReachedLight<'_> {
    /// Whether light of the emitters nearby differs so much along an edge that it is halved; `normal` is the unit normal of
    /// its surface on the side that receives.
    pub(super) fn differs(&self, [p, q]: [Vec3; 2], normal: Vec3) -> bool {
        let (way, length) = (q - p, p.distance(q));
        let ray = Ray {
            origin: p,
            direction: way / length,
            tmin: 0.0,
            tmax: length,
        };
        if !(length > 0.0 && self.tree.meets(&ray)) {
            return false;
        }
        let edge = Bounds::of_points([p, q]).padded(REACH * self.size);
        let mut received = [0.0; PLACES.len()];
        for emitter in &self.light.emitters {
            if meet(&edge, &emitter.bounds) {
                emitter.add(&edge, normal, PLACES.map(|at| p + way * at), &mut received);
            }
        }
        let (least, most) = received
            .iter()
            .fold((f32::MAX, 0.0f32), |(least, most), e| {
                (least.min(*e), most.max(*e))
            });
        (most - least) * length * length > LEAST * self.light.mean * self.size * self.size
    }
}

impl NearEmitter {
    /// Adds the irradiance, in W/m², that its triangles near an edge give to points of it.
    fn add(
        &self,
        edge: &Bounds,
        normal: Vec3,
        points: [Vec3; PLACES.len()],
        received: &mut [f32; PLACES.len()],
    ) {
        let near = |triangle: &&[Vec3; 3]| meet(edge, &Bounds::of_points(triangle.iter()));
        for triangle in self.triangles.iter().filter(near) {
            let [a, b, c] = *triangle;
            let front = (b - a).cross(c - a);
            for (point, received) in points.iter().zip(received.iter_mut()) {
                if self.double_sided || (*point - a).dot(front) > 0.0 {
                    *received += self.emission * point_to_triangle(*point, normal, triangle);
                }
            }
        }
    }
}

/// The strongest radiance L of each material at any time, of its strongest channel.
pub(super) fn strongest(animation: &Animation) -> Vec<f32> {
    let at = |time: f64| -> Vec<f32> {
        let pose = animation.pose(time);
        pose.emission.iter().map(|e| e.max_element()).collect()
    };
    let mut strongest = at(0.0);
    let glows =
        |target: Target| matches!(target, Target::Emissive(_) | Target::EmissiveStrength(_));
    let mut channels = animation.played().flat_map(|clip| &clip.channels);
    if channels.any(|channel| glows(channel.target)) {
        let step = animation.seconds() / TRIED as f64;
        for index in 1..=TRIED {
            for (most, now) in strongest.iter_mut().zip(at(step * index as f64)) {
                *most = most.max(now);
            }
        }
    }
    strongest
}

fn triangle_area([a, b, c]: &[Vec3; 3]) -> f32 {
    (b - a).cross(c - a).length() * 0.5
}

/// Whether two boxes touch.
fn meet(a: &Bounds, b: &Bounds) -> bool {
    a.lo.cmple(b.hi).all() && b.lo.cmple(a.hi).all()
}
