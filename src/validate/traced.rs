//! The renderer's own rows for patches that no file describes: cut, sampled and traced as in a scene at rest.

use super::shapes::Patch;
use crate::compare::repeated::REPEATS;
use crate::emission::Emitters;
use crate::error::Result;
use crate::formfactor::hemisphere::{Hemisphere, Set};
use crate::formfactor::sobol::scatter;
use crate::geometry::Ray;
use crate::ids::{MaterialId, MeshId, NodeId, SideId, SurfaceId};
use crate::mesh::RadiosityMesh;
use crate::scene::light::LightScale;
use crate::scene::{Animation, Instance, Material, Mesh, Node, Rest};
use crate::visibility::light_samples::{self, Budget, LightAim, LightHit};
use crate::visibility::sample::Receiver;
use crate::visibility::{Accel, MissIds, sample};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

/// A patch's longest edge is cut this many times for scrambled samples, which start all over it and not at 16 points. Grids
/// are coarse where each of many elements has few samples, so there it is cut less.
fn cuts(set: Set) -> f32 {
    match set {
        // Sixteen samples of each of 2 · cuts² elements at least.
        Set::Cosine(samples) => (samples as f32 / 32.0).sqrt().clamp(2.0, 8.0).floor(),
        Set::Hemicube(_) | Set::Plane(_) => 2.0,
    }
}

/// What was traced.
#[derive(Clone, Debug)]
pub struct Traced {
    /// All factors, row after row: a matrix for each repetition.
    pub factors: Vec<Vec<f64>>,
    /// Samples of the patch that has fewest.
    pub samples: usize,
    /// What the directions of an element may leave of light at most, relative to its range; 0 where they are scrambled.
    pub bias: f64,
}

/// The rows of the first `rows` patches, those of the others being 0, traced `repeats` times independently: scrambled or turned each time.
///
/// Of [`Set::Cosine`] the samples are those of a patch, dealt out to its elements; each element has its own hemicube or
/// plane.
pub fn factors(patches: &[Patch], rows: usize, set: Set, repeats: u32) -> Result<Traced> {
    let meshes: Vec<Vec<[Vec3; 3]>> = patches.iter().map(Patch::triangles).collect();
    let longest = meshes
        .iter()
        .flatten()
        .map(|[a, b, c]| a.distance(*b).max(b.distance(*c)).max(c.distance(*a)))
        .fold(0.0, f32::max);
    of_meshes(&meshes, rows, longest / cuts(set), set, repeats)
}

/// The same for meshes of triangles, the elements cut to `size` metres: the mean over each mesh's area.
pub fn of_meshes(
    meshes: &[Vec<[Vec3; 3]>],
    rows: usize,
    size: f32,
    set: Set,
    repeats: u32,
) -> Result<Traced> {
    // Cut the scene as any other; nothing moves, so surfaces keep the order of the meshes.
    let animation = animation(meshes);
    let patches = RadiosityMesh::cut(&animation, size)?;
    let placed = patches.at(&animation, &animation.pose(0.0));
    let accel = Accel::whole(&patches, &placed);
    let misses = MissIds::of_clip(patches.sides.len());
    // Deal the samples out to the elements of the mesh that has fewest.
    let mut elements = vec![0usize; meshes.len()];
    let wanted = |side: &SideId| patches.surface_at(*side).index() < rows;
    let sides: Vec<SideId> = patches.side_ids().filter(wanted).collect();
    for side in &sides {
        elements[patches.surface_at(*side)] += 1;
    }
    let fewest = elements
        .iter()
        .copied()
        .filter(|n| *n > 0)
        .min()
        .unwrap_or(1);
    let set = match set {
        Set::Cosine(samples) => Set::Cosine(samples.div_ceil(fewest)),
        set => set,
    };
    // Trace every sample, and weigh what each element sees.
    let n = meshes.len();
    let matrix = |hemisphere: &Hemisphere| {
        let row = |side: &SideId| {
            let side = *side;
            let sampler = hemisphere.sampler(&patches, &placed, side);
            let mut seen = vec![0.0; n];
            for k in 0..hemisphere.samples {
                let ray = sample::hemisphere_ray(&sampler, k);
                let hit = accel.intersect(&ray);
                let id = misses.hit_id(&patches, &placed, hit.as_ref(), ray.direction);
                if let Some(seen_side) = misses.side(id) {
                    seen[patches.surface_at(seen_side)] += f64::from(sampler.weight(k));
                }
            }
            let element = &patches.elements[patches.sides[side].element];
            let area = f64::from(placed.area(element));
            (patches.surface_at(side).index(), area, seen)
        };
        let rows: Vec<_> = sides.par_iter().map(row).collect();
        let all: f64 = (0..hemisphere.samples)
            .map(|k| hemisphere.weights.get(k).map_or(1.0, |w| f64::from(*w)))
            .sum();
        added(rows, n, all)
    };
    // Scramble again, or turn the same grid otherwise.
    let first = Hemisphere::new(set, 1);
    let scrambled = matches!(set, Set::Cosine(_));
    let hemisphere = |seed| {
        let table = if scrambled {
            Hemisphere::new(set, seed)
        } else {
            first.clone()
        };
        table.turned(scatter(seed))
    };
    let bias = if scrambled { 0.0 } else { first.discrepancy() };
    Ok(Traced {
        factors: (1..=repeats)
            .map(|seed| matrix(&hemisphere(seed)))
            .collect(),
        samples: fewest * set.samples(),
        bias,
    })
}

/// The factor from the only element of the first mesh to the second mesh by so many light samples, past all others: as often
/// as samples are repeated, independently.
pub fn light(meshes: &[Vec<[Vec3; 3]>], samples: usize) -> Result<Vec<f64>> {
    let animation = animation(meshes);
    let mut patches = RadiosityMesh::cut(&animation, f32::MAX)?;
    patches.surfaces[1].emission = Vec3::ONE;
    let placed = patches.at(&animation, &animation.pose(0.0));
    let accel = Accel::whole(&patches, &placed);
    let emitters = Emitters::unit(&patches, &placed, &[SurfaceId::new(1)]);
    let table = Hemisphere::new(Set::Cosine(1), 1);
    let receiver = Receiver::of(&table, &patches, &placed, SideId::new(0));
    let mut aim = LightAim::default();
    let mut hits = vec![LightHit::UNTRACED; samples];
    let factor = |seed: u32| {
        let (offset, budget) = (patches.ray_offset, Budget::Fixed(samples));
        aim.aim(&emitters, &receiver, offset, budget, seed);
        let free = |s: usize| {
            let (from, to) = (receiver.sampler.point(s), aim.samples[s].target);
            !accel.occluded(&Ray::to_point(from, to, offset))
        };
        light_samples::trace(&aim.samples, 0, free, &mut hits);
        let (factors, samples) = (&aim.factors, &aim.samples);
        let irradiance =
            light_samples::irradiance(&emitters, factors, samples, &hits, |_| Vec3::ONE);
        f64::from(irradiance.x)
    };
    Ok((1..=REPEATS).map(factor).collect())
}

/// The factors of n patches from their elements' rows: patch, area, weights seen, of `all`; added up by area, in order.
fn added(rows: Vec<(usize, f64, Vec<f64>)>, n: usize, all: f64) -> Vec<f64> {
    let mut factors = vec![0.0; n * n];
    let mut area = vec![0.0; n];
    for (from, part, seen) in rows {
        area[from] += part;
        for (to, weight) in seen.into_iter().enumerate() {
            factors[from * n + to] += part * weight / all;
        }
    }
    for (row, area) in factors.chunks_mut(n).zip(area) {
        if area > 0.0 {
            row.iter_mut().for_each(|f| *f /= area);
        }
    }
    factors
}

/// A scene at rest with one object for each mesh.
fn animation(meshes: &[Vec<[Vec3; 3]>]) -> Animation {
    let numbers = 0..meshes.len();
    Animation {
        name: "validate".into(),
        file: "validate".into(),
        generator: String::new(),
        light_scale: LightScale::default(),
        shading: Default::default(),
        sources: Vec::new(),
        limits: crate::scene::FileLimits::default(),
        scenes: vec!["validate".into()],
        scene: 0,
        origin: DVec3::ZERO,
        raised: Vec::new(),
        nodes: numbers.clone().map(node).collect(),
        meshes: meshes.iter().map(|triangles| mesh(triangles)).collect(),
        instances: numbers.map(instance).collect(),
        skins: Vec::new(),
        materials: vec![grey()],
        textures: Vec::new(),
        cameras: Vec::new(),
        lights: Vec::new(),
        lamps: Vec::new(),
        clips: Vec::new(),
        playing: Vec::new(),
        extensions: Vec::new(),
        warnings: Vec::new(),
    }
}

fn node(number: usize) -> Node {
    Node {
        name: format!("patch {number}"),
        index: number,
        parent: None,
        rest: Rest::Matrix(DAffine3::IDENTITY),
        weights: Vec::new(),
        visible: true,
    }
}

fn instance(number: usize) -> Instance {
    Instance {
        node: NodeId::from_index(number),
        mesh: MeshId::from_index(number),
        local: None,
        skin: None,
    }
}

fn mesh(triangles: &[[Vec3; 3]]) -> Mesh {
    Mesh {
        name: "patch".into(),
        positions: triangles.as_flattened().to_vec(),
        texcoords: Vec::new(),
        colors: Vec::new(),
        tangents: Vec::new(),
        normals: crate::scene::VertexNormals::None,
        triangles: (0..triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect(),
        targets: Vec::new(),
        influences: None,
        material: MaterialId::from_index(0),
    }
}

fn grey() -> Material {
    Material {
        base_color: Vec3::splat(0.5),
        ..Material::plain("grey")
    }
}
