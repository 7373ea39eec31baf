//! The renderer's own rows for patches that no file describes: cut, asked and traced as in a scene at rest.

use super::shapes::Patch;
use crate::animation::{Animation, Instance, Material, Mesh, Node, Rest};
use crate::backbuffer::{Nothing, Stage, ask};
use crate::error::Result;
use crate::formfactor::{Hemisphere, Set};
use crate::patch::Patches;
use glam::{DAffine3, Vec3};
use rayon::prelude::*;

/// A patch's longest edge is cut this many times, so that samples start all over it and not at 16 points.
const CUTS: f32 = 8.0;

/// All factors among patches, row after row, from at least `samples` cosine samples of each.
pub fn factors(patches: &[Patch], samples: usize, seed: u32) -> Result<Vec<f64>> {
    let meshes: Vec<Vec<[Vec3; 3]>> = patches.iter().map(Patch::triangles).collect();
    let longest = meshes
        .iter()
        .flatten()
        .map(|[a, b, c]| a.distance(*b).max(b.distance(*c)).max(c.distance(*a)))
        .fold(0.0, f32::max);
    of_meshes(&meshes, longest / CUTS, samples, seed)
}

/// The same for meshes of triangles, the elements cut to `size` metres: the mean over each mesh's area.
pub fn of_meshes(
    meshes: &[Vec<[Vec3; 3]>],
    size: f32,
    samples: usize,
    seed: u32,
) -> Result<Vec<f64>> {
    // Cut the scene as any other; nothing moves, so surfaces keep the order of the meshes.
    let animation = animation(meshes);
    let patches = Patches::cut(&animation, size)?;
    let placed = patches.at(&animation, &animation.pose(0.0));
    let stage = Stage::whole(&patches, &placed);
    let nothing = Nothing::after(patches.sides.len());
    // Deal the samples out to the elements of the mesh that has fewest.
    let mut elements = vec![0usize; meshes.len()];
    let sides = 0..patches.sides.len() as u32;
    sides
        .clone()
        .for_each(|side| elements[patches.surface_at(side)] += 1);
    let fewest = elements
        .iter()
        .copied()
        .filter(|n| *n > 0)
        .min()
        .unwrap_or(1);
    let hemisphere = Hemisphere::new(Set::Cosine(samples.div_ceil(fewest)), seed);

    // Ask every sample, and count what each element sees.
    let n = meshes.len();
    let rows: Vec<(usize, f64, Vec<u32>)> = sides
        .into_par_iter()
        .map(|side| {
            let asker = hemisphere.asker(&patches, &placed, side);
            let mut seen = vec![0; n];
            for k in 0..hemisphere.samples {
                let ray = ask::hemisphere_ray(&asker, k);
                let hit = stage.closest(&ray);
                let answer = ask::answer(&patches, &placed, nothing, hit.as_ref(), ray.direction);
                if (answer as usize) < patches.sides.len() {
                    seen[patches.surface_at(answer)] += 1;
                }
            }
            let element = &patches.elements[patches.sides[side as usize].element as usize];
            let area = f64::from(placed.area(element));
            (patches.surface_at(side), area, seen)
        })
        .collect();

    // Add them up by area, in the order of the elements.
    let mut factors = vec![0.0; n * n];
    let mut area = vec![0.0; n];
    for (from, part, seen) in rows {
        area[from] += part;
        for (to, count) in seen.into_iter().enumerate() {
            factors[from * n + to] += part * f64::from(count) / hemisphere.samples as f64;
        }
    }
    for (row, area) in factors.chunks_mut(n).zip(area) {
        row.iter_mut().for_each(|f| *f /= area);
    }
    Ok(factors)
}

/// A scene at rest with one object for each mesh.
fn animation(meshes: &[Vec<[Vec3; 3]>]) -> Animation {
    let numbers = 0..meshes.len() as u32;
    Animation {
        name: "validate".into(),
        file: "validate".into(),
        scenes: vec!["validate".into()],
        scene: 0,
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

fn node(number: u32) -> Node {
    Node {
        name: format!("patch {number}"),
        index: number as usize,
        parent: None,
        rest: Rest::Matrix(DAffine3::IDENTITY),
        weights: Vec::new(),
        visible: true,
    }
}

fn instance(number: u32) -> Instance {
    Instance {
        node: number,
        mesh: number,
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
        triangles: (0..triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect(),
        targets: Vec::new(),
        influences: None,
        material: 0,
    }
}

fn grey() -> Material {
    Material {
        base_color: Vec3::splat(0.5),
        ..Material::plain("grey")
    }
}
