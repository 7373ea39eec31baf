//! What has no effect in a picture, or another one than its author asked for: one list, each kind once, by name.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Most names that a sentence lists: enough to tell what they have in common.
const MOST_NAMES: usize = 5;

/// A kind of loss, in the order in which they are told.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Lost {
    Outside,
    AreaLight,
    Camera,
    Light,
    Skin,
    NotTriangles,
    Incomplete,
    Uneven,
    Jointless,
    BentCopies,
    WithoutTexcoords,
    MoreColours,
    Variants,
    Glass,
    Frosted,
    Unbent,
    Absent,
    Blended,
    Metal,
    Gloss,
    Coat,
    Occlusion,
    Channel,
    Weightless,
    Elsewhere,
    OfMaterial,
    OfOther,
}

impl Lost {
    /// What it befalls, what becomes of it, where `{}` stands for a detail, and what to do.
    #[rustfmt::skip]
    fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Lost::Outside => ("node", "outside the scene that is read, so left out", "choose another scene by --scene"),
            Lost::AreaLight => ("node", "area lights, by their names, which Blender's exporter leaves out", "put planes in their place that emit"),
            Lost::Camera => ("camera", "on no node, so of no use", "put it on a node"),
            Lost::Light => ("light", "on no node, so dark", "put it on a node"),
            Lost::Skin => ("skin", "on no node, so of no use", "nothing to do unless a mesh should bend"),
            Lost::NotTriangles => ("mesh", "points or lines are left out, for only triangles have an area", "make thin tubes of them"),
            Lost::Incomplete => ("mesh", "corners that make no whole triangle are left out", "export the file again"),
            Lost::Uneven => ("mesh", "joint weights that do not sum to 1 are scaled to", "normalize the weights"),
            Lost::Jointless => ("node", "a skin, but no joints in the mesh, which stands on its node", "weight the mesh, or take the skin away"),
            Lost::BentCopies => ("node", "copies of a skinned mesh are left out, for joints alone place it", "give each copy joints of its own"),
            Lost::WithoutTexcoords => ("mesh", "a texture, but no coordinates for it: the plain factor is shown", "unwrap the mesh"),
            Lost::MoreColours => ("mesh", "colours after COLOR_0 are left out", "mix them into the first"),
            Lost::Variants => ("mesh", "shown with its own material and no variant", "make the variant you want the mesh's own"),
            Lost::Glass => ("material", "transparent in the file, opaque here: what is behind stays dark", "leave panes out with --hide"),
            Lost::Frosted => ("material", "rough glass in the file; here light passes it straight on, and it has no gloss", "nothing to do unless what is behind must be blurred"),
            Lost::Unbent => ("material", "a glass body: what is seen through it is bent, but light straight from lamps passes it unbent, and casts no caustics", "nothing to do unless caustics matter"),
            Lost::Absent => ("material", "blended with an alpha below 0.5, and shines by itself or is unlit, so not there at all", "give it an alpha of 0.5 or more to have it there"),
            Lost::Blended => ("material", "blended, and shines by itself or is unlit: here opaque where alpha is 0.5 or more, and not there elsewhere", "choose alphaMode MASK with a cutoff"),
            Lost::Metal => ("material", "rough metal in the file, matt here, reflecting as much in the same colour", "give it a roughness of 0.1 or less to have a mirror"),
            Lost::Gloss => ("material", "glossy in the file, with a roughness from 0.1 to 0.3, matt here", "give it a roughness of 0.1 or less to have a mirror"),
            Lost::Coat => ("material", "a clear coat with a roughness above 0.1 is left out", "nothing to do unless highlights matter"),
            Lost::Occlusion => ("material", "baked occlusion is left out", "nothing to do: light itself darkens corners"),
            Lost::Channel => ("animation", "nothing here changes with {}", "nothing to do unless that matters"),
            Lost::Weightless => ("animation", "morph weights of a mesh without morph targets are left out", "take the channels away"),
            Lost::Elsewhere => ("animation", "changes of what is not in the scene are left out", "choose another scene by --scene"),
            Lost::OfMaterial => ("material", "{} is left out: nothing here shows it", "nothing to do unless their finish matters"),
            Lost::OfOther => ("", "{} is left out: nothing here knows it", "export the file without it to see what depends on it"),
        }
    }
}

/// A kind of loss, what it befalls, and the detail in its sentence.
type Key = (Lost, &'static str, String);

/// What is lost so far, and the names of all that is concerned.
#[derive(Default)]
pub(super) struct Losses {
    named: BTreeMap<Key, BTreeSet<String>>,
}

impl Losses {
    /// Notes that something of a name is concerned.
    pub(super) fn note(&mut self, lost: Lost, name: impl Into<String>) {
        self.note_of(lost, "", name);
    }

    /// The same with a detail.
    pub(super) fn note_of(&mut self, lost: Lost, detail: &str, name: impl Into<String>) {
        self.note_at(lost, lost.words().0, detail, name);
    }

    /// The same of something of another kind than the loss is usually of.
    pub(super) fn note_at(
        &mut self,
        lost: Lost,
        kind: &'static str,
        detail: &str,
        name: impl Into<String>,
    ) {
        let names = self.named.entry((lost, kind, detail.into())).or_default();
        names.insert(name.into());
    }

    /// Notes all of another list.
    pub(super) fn extend(&mut self, other: Losses) {
        for (key, names) in other.named {
            self.named.entry(key).or_default().extend(names);
        }
    }

    /// A sentence a kind: what, its names, what becomes of it, and what to do.
    pub(super) fn sentences(&self) -> Vec<String> {
        let sentence = |((lost, kind, detail), names): (&Key, &BTreeSet<String>)| {
            let (_, told, way_out) = lost.words();
            let told = told.replace("{}", detail);
            format!("{}: {told} — {way_out}", listed(kind, names))
        };
        self.named.iter().map(sentence).collect()
    }
}

/// A kind and the first few names of it, and how many more there are.
fn listed(kind: &str, names: &BTreeSet<String>) -> String {
    let first = names.iter().take(MOST_NAMES);
    let first: Vec<String> = first.map(|name| format!("'{name}'")).collect();
    let more = match names.len().saturating_sub(MOST_NAMES) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let kinds = match (names.len(), kind) {
        (1, kind) => kind.to_string(),
        (_, "mesh") => "meshes".into(),
        (_, kind) => format!("{kind}s"),
    };
    format!("{kinds} {}{more}", first.join(", "))
}

/// An item's name, or its kind and number.
pub(super) fn called(item: &Value, kind: &str, index: usize) -> String {
    let name = item.get("name").and_then(Value::as_str);
    name.map_or_else(|| format!("{kind} {index}"), str::to_string)
}
