//! The scene in JSON: what a page needs to know once, and what panels show of each state.

use crate::export::drawn::{DrawnMesh, DrawnObject};
use crate::image::Tone;
use crate::scene::view::{Eye, View};
use crate::scene::{Lens, Material};
use crate::session::Session;
use crate::session::scene::Looks;
use crate::texture::{Texture, Wrap};
use serde_json::{Value, json};

/// The shape of pictures in which cameras are described; only the height of the view counts.
const ASPECT: f64 = 16.0 / 9.0;

/// What does not change while nothing is added.
pub(super) fn about(
    session: &Session,
    drawn: &DrawnMesh,
    epoch: u32,
    (tone, files, fps): (Tone, &[String], f64),
) -> String {
    let animation = &session.scene.animation;
    let nodes = animation.nodes.iter().map(|node| {
        let parent = node.parent.map(|parent| parent.index());
        json!({ "name": node.name, "number": node.index, "parent": parent })
    });
    let lights = animation.lights.iter();
    let lights = lights.map(|light| json!({ "name": light.name, "kind": light.kind.to_string() }));
    let cameras = animation.cameras.iter().map(|camera| &camera.name);
    let bounds = session.placed().bounds();
    json!({ "scene": {
        "epoch": epoch, "name": animation.name, "seconds": animation.seconds(), "fps": fps,
        "nodes": nodes.collect::<Vec<_>>(),
        "objects": drawn.objects.iter().map(object).collect::<Vec<_>>(),
        "materials": animation.materials.iter().map(material).collect::<Vec<_>>(),
        "textures": animation.textures.iter().map(texture).collect::<Vec<_>>(),
        "lights": lights.collect::<Vec<_>>(),
        "cameras": cameras.collect::<Vec<_>>(),
        "view": session.scene.view(session.pose(), ASPECT).ok().map(|view| looks(&view)),
        "bounds": [bounds.lo.to_array(), bounds.hi.to_array()],
        "files": files, "stops": tone.stops, "curve": tone.curve,
        "elements": session.scene.patches.elements.len(),
    }})
    .to_string()
}

fn object(object: &DrawnObject) -> Value {
    let triangles = &object.triangles;
    json!({ "node": object.node.index(), "material": object.material.index(),
        "first": triangles.start, "count": triangles.len() })
}

fn material(material: &Material) -> Value {
    let passes = material.specular.is_some_and(|specular| specular.passes());
    json!({
        "name": material.name, "texture": material.base_map.map(|map| map.texture.index()),
        "cutoff": material.cutoff, "glass": passes, "specular": material.specular.is_some(),
        "unlit": material.unlit,
    })
}

fn texture(texture: &Texture) -> Value {
    let wrap = texture.wrap.map(|wrap| match wrap {
        Wrap::Repeat => "repeat",
        Wrap::Mirror => "mirror",
        Wrap::Clamp => "clamp",
    });
    json!({ "wrap": wrap, "nearest": texture.nearest })
}

fn looks(view: &View) -> Value {
    let degrees = match view.lens {
        Lens::Perspective { yfov } => yfov.to_degrees(),
        Lens::Orthographic { .. } => 40.0,
    };
    json!({ "eye": view.eye.to_array(), "forward": view.forward.to_array(), "degrees": degrees })
}

/// What panels show of a state, as fields of an object.
pub(super) fn values(session: &Session, drawn: &DrawnMesh) -> Vec<(&'static str, Value)> {
    let (scene, pose) = (&session.scene, session.pose());
    let emitted = session.emitted_by_surfaces();
    let objects = drawn.objects.iter();
    let emitted = objects.map(|object| emitted[object.surface.index()].to_array());
    let materials = scene.animation.materials.iter().zip(&pose.base_color);
    let materials = materials.map(|(material, color)| {
        json!([
            color.to_array(),
            material.emissive.to_array(),
            material.emissive_strength
        ])
    });
    let beams = scene.animation.lights.iter().map(|light| light.beam);
    let beams = beams.map(|beam| json!([beam.color.to_array(), beam.intensity]));
    let cameras = (0..scene.animation.cameras.len()).map(|camera| {
        let eye = Looks::Through(Eye::Camera(camera));
        scene
            .view_by(eye, pose, ASPECT)
            .ok()
            .map(|view| looks(&view))
    });
    vec![
        ("visible", json!(pose.visible)),
        ("emitted", emitted.collect()),
        ("materials", materials.collect()),
        ("lights", beams.collect()),
        ("cameras", cameras.collect()),
    ]
}
