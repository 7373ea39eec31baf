//! The ends of a form factor: an element by its number, or all that hangs on a node by its name.

use crate::error::{Error, Result};
use crate::ids::{ElementId, NodeId, SideId};
use crate::mesh::RadiosityMesh;
use crate::scene::Animation;
use serde::Serialize;

/// Names of nodes that a refusal lists at most.
const MOST_NAMES: usize = 12;

/// One end of a form factor: sides that receive, or send, as one.
#[derive(Clone, Debug, Serialize)]
pub struct FactorEnd {
    /// What it is, in words.
    pub name: String,
    /// Its sides, ascending.
    #[serde(serialize_with = "numbers")]
    pub sides: Vec<SideId>,
}

/// Sides as their numbers.
fn numbers<S: serde::Serializer>(sides: &[SideId], to: S) -> std::result::Result<S::Ok, S::Error> {
    to.collect_seq(sides.iter().map(|side| side.number()))
}

/// The end that a flag's text names: the node of this name with all nodes below it, or where no name matches the element of
/// this number, with `:front` or `:back` behind it for one of its sides.
///
/// # Errors
/// [`Error::Usage`] where there is no such thing, or it has no side that light can reach.
pub fn find(
    flag: &str,
    text: &str,
    animation: &Animation,
    patches: &RadiosityMesh,
) -> Result<FactorEnd> {
    let named = animation.nodes.iter().any(|node| node.name == text);
    let (name, sides) = match (named, element(text)) {
        (true, _) => (format!("node '{text}'"), of_node(text, animation, patches)),
        (false, Some((number, which))) if number < patches.elements.len() => {
            let both = patches.side_of[ElementId::from_index(number)];
            let chosen = which.map_or(&both[..], |back| &both[back as usize..=back as usize]);
            let sides = chosen.iter().copied().flatten().collect();
            (format!("element {text}"), sides)
        }
        _ => return Err(unknown(flag, text, animation, patches)),
    };
    if sides.is_empty() {
        return Err(Error::Usage {
            flag: flag.into(),
            expected: "a side that light can reach".into(),
            got: format!("{name}, which has none"),
            way_out: "name another; --sides both gives backs a radiosity too".into(),
        });
    }
    Ok(FactorEnd { name, sides })
}

/// A number, and whether the back or the front alone is meant.
fn element(text: &str) -> Option<(usize, Option<bool>)> {
    let (number, which) = match text.split_once(':') {
        Some((number, "front")) => (number, Some(false)),
        Some((number, "back")) => (number, Some(true)),
        Some(_) => return None,
        None => (text, None),
    };
    Some((number.parse().ok()?, which))
}

/// The sides of a node and of all nodes below it.
fn of_node(name: &str, animation: &Animation, patches: &RadiosityMesh) -> Vec<SideId> {
    let below = |mut node: NodeId| loop {
        let here = &animation.nodes[node];
        if here.name == name {
            return true;
        }
        match here.parent {
            Some(parent) => node = parent,
            None => return false,
        }
    };
    let carried = |side: &SideId| below(animation.instances[patches.surface(*side).instance].node);
    patches.side_ids().filter(carried).collect()
}

/// The refusal of a text that names nothing.
fn unknown(flag: &str, text: &str, animation: &Animation, patches: &RadiosityMesh) -> Error {
    let instances = animation.instances.iter();
    let mut names: Vec<&str> = instances
        .map(|instance| animation.nodes[instance.node].name.as_str())
        .collect();
    names.sort_unstable();
    names.dedup();
    let more = names.len().saturating_sub(MOST_NAMES);
    names.truncate(MOST_NAMES);
    let more = match more {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Error::Usage {
        flag: flag.into(),
        expected: format!(
            "an element from 0 to {}, such as 12 or 12:back, or the name of a node with a mesh",
            patches.elements.len().saturating_sub(1)
        ),
        got: format!("'{text}'"),
        way_out: format!(
            "nodes are {}{more}; the layer patch of --aov has the numbers of elements",
            names.join(", ")
        ),
    }
}
