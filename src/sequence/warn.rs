//! Warnings before the work: what will not look as its author meant, and what the work will take.

use super::observer::Event;
use crate::emission::PeakEmission;
use crate::emission::punctual::{PeakLight, PunctualLight};
use crate::geometry::Bounds;
use crate::image::Camera;
use crate::mesh::RadiosityMesh;
use crate::scene::Animation;
use crate::scene::light::LightKind;
use crate::scene::view::View;
use crate::visibility::enclosure::Enclosure;
use crate::visibility::reachability::Probed;
use glam::{Vec2, Vec3};

/// Columns and rows of the points of a picture from which it is looked around.
const LOOKS: (u32, u32) = (16, 9);

/// A scene is shut in where fewer rays than one in so many leave it: what a crack lets in is no more than that.
const SHUT: usize = 200;

/// A surface belongs to the shell where it is the last that one in so many rays meets.
const SHELL: usize = 10;

/// A model of the sky is so many times as large as what it holds, at least.
const ROOMY: f32 = 2.0;

/// Warns where nothing emits.
pub(super) fn of_light(
    patches: &RadiosityMesh,
    peak: &PeakEmission,
    sky: bool,
    watch: &(dyn Fn(Event) + Sync),
) {
    let dark = patches.surfaces.iter().all(|s| s.emission == Vec3::ZERO)
        && !peak.lights.iter().any(|light| light.emits);
    if dark && !sky {
        watch(Event::Warning(
            "no material emits light, every frame will be black, for nothing else shines: \
             --sky 1,1,1 or --sun 45,45,3 would light it",
        ));
    }
}

/// A warning where light from outside does not get to what the camera sees, which names what is in its way, or says that the
/// sun stands behind.
pub(super) fn of_walls(
    patches: &RadiosityMesh,
    animation: &Animation,
    probed: &[Probed],
    views: &[Option<View>],
    sky: bool,
) -> Option<String> {
    // Trace only where light comes from outside.
    let emits = |(light, peak): (&PunctualLight, &PeakLight)| {
        light.kind == LightKind::Directional && peak.emits
    };
    let mut emitters = probed
        .iter()
        .flat_map(|time| time.emitters.as_ref().into_array());
    let directions = emitters.any(|l| l.lights.iter().zip(&l.peak).any(emits));
    if !sky && !directions {
        return None;
    }

    let enclosure = around(patches, probed, views);
    let open = |got: usize, of: usize| got * SHUT >= of;
    if enclosure.rays == 0
        || sky && open(enclosure.left, enclosure.rays)
        || directions && open(enclosure.sunny, enclosure.places)
    {
        return None;
    }
    let left = enclosure.left as f64 / enclosure.rays as f64 * 100.0;
    if open(enclosure.left, enclosure.rays) {
        return Some(format!(
            "the sun shines on nothing that the camera sees: all that is seen is turned away from it or in shadow, though \
             {left:.1} % of the rays from there get out; turn the sun, with --sun AZIMUTH,ELEVATION,IRRADIANCE or in the \
             file"
        ));
    }
    let shell = shell(patches, animation, &enclosure);
    let way_out = match shell.first() {
        Some((name, _)) if holds_all(patches, animation, probed, name) => {
            format!("a model of the sky is better left out, with --hide '{name}'")
        }
        _ => "put lamps inside".into(),
    };
    Some(format!(
        "light from outside does not reach what the camera sees: {} it in, {left:.1} % of the rays from there \
         get out; {way_out}",
        shuts(&shell)
    ))
}

/// A look around from what the camera sees, at each of the times.
fn around(patches: &RadiosityMesh, probed: &[Probed], views: &[Option<View>]) -> Enclosure {
    let mut enclosure = Enclosure::default();
    for (time, view) in probed.iter().zip(views) {
        let Some(view) = view else { continue };
        let camera = Camera::new(view, LOOKS);
        let points = (0..LOOKS.0 * LOOKS.1).map(|i| (i % LOOKS.0, i / LOOKS.0));
        let rays = points.map(|(x, y)| camera.ray(Vec2::new(x as f32, y as f32) + 0.5));
        enclosure.look(patches, time, rays);
    }
    enclosure
}

/// Who shuts something in, with the verb.
fn shuts(shell: &[(&str, &str)]) -> String {
    let named = |(name, mesh): &(&str, &str)| format!("'{name}' (mesh '{mesh}')");
    let names: Vec<String> = shell.iter().map(named).collect();
    match &names[..] {
        [] => "what is around it shuts".into(),
        [one] => format!("node {one} shuts"),
        [most @ .., last] => format!("nodes {} and {last} shut", most.join(", ")),
    }
}

/// Whether a node's box holds the rest of the scene, with room to spare: it may be a model of the sky.
fn holds_all(
    patches: &RadiosityMesh,
    animation: &Animation,
    probed: &[Probed],
    node: &str,
) -> bool {
    let Some(placed) = probed.first().map(|time| time.accel.placed) else {
        return false;
    };
    let (mut shell, mut rest) = (Bounds::EMPTY, Bounds::EMPTY);
    for surface in &patches.surfaces {
        let here = Bounds::of_points(placed.of(surface).as_flattened());
        let at = animation.instances[surface.instance].node;
        let part = match animation.nodes[at].name == node {
            true => &mut shell,
            false => &mut rest,
        };
        *part = part.union(here);
    }
    let inside = rest.lo.cmpgt(shell.lo).all() && rest.hi.cmplt(shell.hi).all();
    inside && shell.extent().length() > ROOMY * rest.extent().length()
}

/// The shell, as names of nodes and meshes: the surfaces that most rays meet last.
fn shell<'a>(
    patches: &RadiosityMesh,
    animation: &'a Animation,
    enclosure: &Enclosure,
) -> Vec<(&'a str, &'a str)> {
    let mut shell: Vec<(&str, &str, usize)> = Vec::new();
    for (surface, met) in patches.surfaces.iter().zip(&enclosure.shell) {
        let instance = &animation.instances[surface.instance];
        let name = animation.nodes[instance.node].name.as_str();
        let mesh = animation.meshes[instance.mesh].name.as_str();
        match shell.iter_mut().find(|(known, ..)| *known == name) {
            Some((.., count)) => *count += met,
            None => shell.push((name, mesh, *met)),
        }
    }
    shell.retain(|(.., met)| met * SHELL >= enclosure.rays);
    shell.sort_by_key(|(.., met)| std::cmp::Reverse(*met));
    shell
        .into_iter()
        .map(|(name, mesh, _)| (name, mesh))
        .collect()
}
