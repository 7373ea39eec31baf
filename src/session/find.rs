//! Finding the node, material, light or camera of an edit by name or number.

use super::edit::Which;
use super::scene::{EditedScene, fault};
use crate::error::{Error, Result};

impl EditedScene {
    /// The node that an edit means, of those that are not removed.
    pub(super) fn node(&self, which: &Which, at: &str) -> Result<usize> {
        let away = self.away();
        let nodes = self.animation.nodes.iter().enumerate();
        let there: Vec<(usize, &crate::scene::Node)> = nodes.filter(|(i, _)| !away[*i]).collect();
        let at = format!("{at}.node");
        if let Which::Index(number) = which {
            // A node's number is the one that it has in its file's list.
            let found = there.iter().find(|(_, node)| node.index == *number);
            return found.map(|(index, _)| *index).ok_or_else(|| {
                let numbers: Vec<(usize, &str)> = there
                    .iter()
                    .map(|(_, n)| (n.index, n.name.as_str()))
                    .collect();
                missing(&at, "node", &format!("{number}"), &numbers)
            });
        }
        let names: Vec<(usize, &str)> = there
            .iter()
            .map(|(i, node)| (*i, node.name.as_str()))
            .collect();
        find(which, &names, &at, "node")
    }

    /// The material that an edit means.
    pub(super) fn material(&self, which: &Which, at: &str) -> Result<usize> {
        let materials = self.animation.materials.iter().enumerate();
        let names: Vec<(usize, &str)> = materials.map(|(i, m)| (i, m.name.as_str())).collect();
        find(which, &names, &format!("{at}.material"), "material")
    }
}

/// The number of what is meant.
pub(super) fn find(which: &Which, names: &[(usize, &str)], at: &str, what: &str) -> Result<usize> {
    match which {
        Which::Index(index) => {
            let found = names.iter().find(|(number, _)| number == index);
            let found = found.map(|(number, _)| *number);
            found.ok_or_else(|| missing(at, what, &index.to_string(), names))
        }
        Which::Name(name) => {
            let mut found = names.iter().filter(|(_, other)| other == name);
            match (found.next(), found.count()) {
                (Some((number, _)), 0) => Ok(*number),
                (Some(_), more) => {
                    let got = format!("'{name}', of which there are {}", more + 1);
                    let way_out = format!("give its number in the file's list of {what}s");
                    Err(fault(
                        at,
                        &format!("the name of one {what}"),
                        &got,
                        &way_out,
                    ))
                }
                (None, _) => Err(missing(at, what, &format!("'{name}'"), names)),
            }
        }
    }
}

/// Names told in an error at most.
const TOLD: usize = 12;

fn missing(at: &str, what: &str, got: &str, names: &[(usize, &str)]) -> Error {
    let told: Vec<String> = names
        .iter()
        .take(TOLD)
        .map(|(number, name)| format!("{number} '{name}'"))
        .collect();
    let more = if names.len() > TOLD { ", …" } else { "" };
    let expected = match told.is_empty() {
        true => format!("a {what}, and there is none"),
        false => format!("a {what}, one of {}{more}", told.join(", ")),
    };
    fault(at, &expected, got, "give a name or a number from the list")
}
