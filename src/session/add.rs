//! Adding objects of another file: they are appended, so that all ids of the scene stay.

use super::edit::Add;

use super::scene::{EditedScene, fault};
use super::transform::{check_scale, quaternion};
use crate::error::Result;
use crate::ids::NodeId;
use crate::mesh::RadiosityMesh;
use crate::scene::pose::FARTHEST;
use crate::scene::{Animation, Node, Rest};
use glam::{DQuat, DVec3};

/// Adds what a file holds on a new node, and gives that node's number among all.
pub(super) fn add(scene: &mut EditedScene, what: &Add, at: &str) -> Result<usize> {
    let rest = place(what, at)?;
    let name = name(scene, what);
    let mut file = Animation::open_within(&what.file, None, scene.animation.limits)?;
    file.shade(scene.animation.shading);
    let part = part(file, &name, rest, scene);

    part.check(&part.pose(0.0), |_| true)?;

    // Cut it as the scene was cut; what has lights alone has nothing to cut.
    let patches = if part.instances.is_empty() {
        None
    } else {
        Some(RadiosityMesh::cut(&part, scene.patches.element_size)?)
    };
    if patches.is_none() && part.lamps.is_empty() {
        let got = format!("nothing to see in {}", what.file.display());
        let expected = "a file with triangles or lights in its default scene";
        return Err(fault(
            &format!("{at}.file"),
            expected,
            &got,
            "name another file",
        ));
    }
    let node = scene.animation.nodes.len();
    if let Some(patches) = patches {
        let first = scene.animation.instances.len();
        scene.patches.append(&patches, first).map_err(|count| {
            let got = format!("{count} elements together");
            let way_out =
                "remove nothing and add less: numbers are never used again, so open a new session";
            fault(at, "fewer elements than ids", &got, way_out)
        })?;
    }
    append(&mut scene.animation, part);
    scene.patches.make_static(&scene.animation);
    scene.grow();
    Ok(node)
}

/// Transform of the new node.
fn place(what: &Add, at: &str) -> Result<Rest> {
    let translation = DVec3::from(what.to.unwrap_or_default());
    let turn = |turn| quaternion(turn, &format!("{at}.rotation"));
    let rotation = what.rotation.map_or(Ok(DQuat::IDENTITY), turn)?;
    let scale = what.scale.map_or(DVec3::ONE, DVec3::from);
    check_scale(scale, DVec3::ONE, &format!("{at}.scale"))?;
    if !translation.is_finite() || translation.abs().max_element() > FARTHEST {
        let got = format!("{translation}");
        return Err(fault(
            &format!("{at}.to"),
            "coordinates below 1e15 metres",
            &got,
            "put it nearer",
        ));
    }
    Ok(Rest::Trs {
        translation,
        rotation,
        scale,
    })
}

/// A name that no node has that is there.
fn name(scene: &EditedScene, what: &Add) -> String {
    let stem = what
        .file
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    let wanted = what.name.clone().or(stem).unwrap_or_else(|| "added".into());
    let away = scene.away();
    let taken = |name: &str| {
        let mut nodes = scene.animation.nodes.iter().zip(&away);
        nodes.any(|(node, away)| !away && node.name == name)
    };
    if !taken(&wanted) {
        return wanted;
    }
    let numbered = (2..).map(|number| format!("{wanted} {number}"));
    numbered
        .into_iter()
        .find(|name| !taken(name))
        .unwrap_or(wanted)
}

/// The file as a part of the scene: below a node of its own, at rest, with names that begin with that node's.
fn part(mut part: Animation, name: &str, rest: Rest, scene: &EditedScene) -> Animation {
    let numbers = scene.animation.nodes.iter().map(|node| node.index + 1);
    let first = numbers.max().unwrap_or(0);
    let root = Node {
        name: name.into(),
        index: first,
        parent: None,
        rest,
        weights: Vec::new(),
        visible: true,
    };
    for node in &mut part.nodes {
        node.parent = Some(
            node.parent
                .map_or(NodeId::from_index(0), |parent| parent.after(1)),
        );
        node.index += first + 1;
        node.name = format!("{name}/{}", node.name);
    }
    part.nodes.insert(0, root);
    let below = |name: &mut String, root: &str| *name = format!("{root}/{name}");
    part.materials
        .iter_mut()
        .for_each(|m| below(&mut m.name, name));
    part.lights
        .iter_mut()
        .for_each(|l| below(&mut l.name, name));
    part.cameras
        .iter_mut()
        .for_each(|c| below(&mut c.name, name));
    part.instances
        .iter_mut()
        .for_each(|i| i.node = i.node.after(1));
    part.lamps.iter_mut().for_each(|l| l.node = l.node.after(1));
    part.cameras
        .iter_mut()
        .for_each(|c| c.node = c.node.after(1));
    let joints = part.skins.iter_mut().flat_map(|skin| &mut skin.joints);
    joints.for_each(|joint| *joint = joint.after(1));
    (part.clips, part.playing) = (Vec::new(), Vec::new());
    part
}

/// Puts a part's lists behind the scene's, and lets its numbers count on.
fn append(animation: &mut Animation, mut part: Animation) {
    let [nodes, meshes, materials, textures, skins, lights] = [
        animation.nodes.len(),
        animation.meshes.len(),
        animation.materials.len(),
        animation.textures.len(),
        animation.skins.len(),
        animation.lights.len(),
    ];
    for node in &mut part.nodes {
        node.parent = node.parent.map(|parent| parent.after(nodes));
    }
    part.meshes
        .iter_mut()
        .for_each(|mesh| mesh.material = mesh.material.after(materials));
    for instance in &mut part.instances {
        instance.node = instance.node.after(nodes);
        instance.mesh = instance.mesh.after(meshes);
        instance.skin = instance.skin.map(|skin| skin.after(skins));
    }
    let joints = part.skins.iter_mut().flat_map(|skin| &mut skin.joints);
    joints.for_each(|joint| *joint = joint.after(nodes));
    for material in &mut part.materials {
        let maps = material
            .base_map
            .iter_mut()
            .chain(&mut material.emission_map)
            .chain(material.normal_map.as_mut().map(|bumps| &mut bumps.map));
        maps.for_each(|map| map.texture = map.texture.after(textures));
    }
    part.cameras
        .iter_mut()
        .for_each(|camera| camera.node = camera.node.after(nodes));
    for lamp in &mut part.lamps {
        lamp.node = lamp.node.after(nodes);
        lamp.light = lamp.light.after(lights);
    }
    animation.sources.push(part.file);
    animation.sources.append(&mut part.sources);
    animation.nodes.append(&mut part.nodes);
    animation.meshes.append(&mut part.meshes);
    animation.instances.append(&mut part.instances);
    animation.skins.append(&mut part.skins);
    animation.materials.append(&mut part.materials);
    animation.textures.append(&mut part.textures);
    animation.cameras.append(&mut part.cameras);
    animation.lights.append(&mut part.lights);
    animation.lamps.append(&mut part.lamps);
}
