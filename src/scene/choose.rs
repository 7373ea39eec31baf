//! Choices by name or number: the clips that play, the camera, hidden nodes.

use super::{Animation, Target};
use crate::error::{Error, Result};
use crate::ids::NodeId;
use crate::settings::Choice;
use std::collections::{BTreeSet, HashMap, HashSet};

impl Animation {
    /// Chooses the clips that play. By default these are all that change different properties, as an exporter writes them,
    /// one for each object; of clips that change the same one, as of one figure, the first. Else it is one by name, else by
    /// index from 0, else `all` together or `none`.
    ///
    /// Warns of clips that are not played by default, and where two that play change the same property: the later one wins.
    ///
    /// # Errors
    /// [`Error::Usage`] with the names there are, when none is called so.
    pub fn choose_clip(&mut self, choice: &Choice) -> Result<()> {
        let names: Vec<&str> = self.clips.iter().map(|clip| clip.name.as_str()).collect();
        self.playing = match choice {
            Choice::First => self.in_accord(),
            Choice::Named(name) => match (choose("--animation", name, &[&names]), name.as_str()) {
                (Ok(clip), _) => vec![clip],
                (Err(_), "all") => (0..names.len()).collect(),
                (Err(_), "none") => Vec::new(),
                (Err(error), _) => return Err(error),
            },
        };
        self.warn_of_contests();
        Ok(())
    }

    /// Leaves out the meshes and lights of all nodes of these names, and of all nodes below them.
    ///
    /// # Errors
    /// [`Error::Usage`] with the names of the nodes that have a mesh or a light, when none is called so.
    pub fn hide(&mut self, names: &[String]) -> Result<()> {
        // Find the nodes; parents stand before their children.
        let mut hidden: Vec<bool> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let below = node.parent.is_some_and(|parent| hidden[parent]);
            hidden.push(below || names.contains(&node.name));
        }

        // Refuse names that nothing has.
        let known = |name: &&String| self.nodes.iter().any(|node| node.name == **name);
        if let Some(unknown) = names.iter().find(|name| !known(name)) {
            return Err(self.no_such_node(unknown));
        }
        let stays = |node: NodeId| !hidden[node];
        self.instances.retain(|instance| stays(instance.node));
        self.lamps.retain(|lamp| stays(lamp.node));
        Ok(())
    }

    /// The error for a node that is not there.
    fn no_such_node(&self, unknown: &str) -> Error {
        /// Names that are listed at most.
        const MOST_NAMES: usize = 20;
        let shown = self.instances.iter().map(|instance| instance.node);
        let shown = shown.chain(self.lamps.iter().map(|lamp| lamp.node));
        let names: BTreeSet<&str> = shown.map(|node| self.nodes[node].name.as_str()).collect();
        let listed: Vec<String> = names
            .iter()
            .take(MOST_NAMES)
            .map(|name| format!("'{name}'"))
            .collect();
        let more = match names.len().saturating_sub(MOST_NAMES) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        Error::Usage {
            flag: "--hide".into(),
            expected: format!("the name of a node, such as {}{more}", listed.join(", ")),
            got: format!("'{unknown}'"),
            way_out: "give the name of a node, of whatever kind".into(),
        }
    }

    /// The clips that change no property which an earlier one of them changes; warns of all others.
    fn in_accord(&mut self) -> Vec<usize> {
        let mut set = HashMap::new();
        let (mut playing, mut others) = (Vec::new(), Vec::new());
        for (index, clip) in self.clips.iter().enumerate() {
            let mut targets = clip.channels.iter().map(|channel| channel.target);
            match targets.find_map(|target| set.get(&target)) {
                Some(first) => others.push((index, *first)),
                None => {
                    let mine = clip.channels.iter().map(|channel| (channel.target, index));
                    set.extend(mine);
                    playing.push(index);
                }
            }
        }
        if let [(other, first), rest @ ..] = &others[..] {
            let name = |clip: &usize| &self.clips[*clip].name;
            let more = match rest.len() {
                0 => String::new(),
                1 => ", nor is one more".into(),
                count => format!(", nor are {count} more"),
            };
            self.warnings.push(format!(
                "animation '{}' is not played, since '{}' changes the same property{more}: choose by --animation NAME, or all.",
                name(other),
                name(first),
            ));
        }
        playing
    }

    /// Warns of properties that two playing clips change, naming the clip that wins.
    fn warn_of_contests(&mut self) {
        let mut set = HashSet::new();
        for clip in self.playing.iter().filter_map(|clip| self.clips.get(*clip)) {
            let here: HashSet<Target> = clip.channels.iter().map(|c| c.target).collect();
            let again = here.iter().filter(|target| set.contains(*target)).count();
            if again > 0 {
                self.warnings.push(format!(
                    "animation '{}' changes {again} properties that an earlier one changes too: it wins.",
                    clip.name
                ));
            }
            set.extend(here);
        }
    }

    /// The camera to look through; `None` where the file has none and [`Animation::ball`] frames the scene.
    /// A name is compared with the cameras' names, then with their nodes' names, then read as an index from 0.
    ///
    /// # Errors
    /// [`Error::Usage`] with the names there are, when none is called so.
    pub fn choose_camera(&self, choice: &Choice) -> Result<Option<usize>> {
        let names: Vec<&str> = self
            .cameras
            .iter()
            .map(|camera| camera.name.as_str())
            .collect();
        let on = |camera: &super::SceneCamera| self.nodes[camera.node].name.as_str();
        let nodes: Vec<&str> = self.cameras.iter().map(on).collect();
        match choice {
            Choice::First => Ok((!names.is_empty()).then_some(0)),
            Choice::Named(name) => choose("--camera", name, &[&names, &nodes]).map(Some),
        }
    }
}

/// The position of a name, else of an index, among lists of names that belong to the same things.
pub(crate) fn choose(flag: &str, wanted: &str, lists: &[&[&str]]) -> Result<usize> {
    let named = lists
        .iter()
        .find_map(|names| names.iter().position(|name| *name == wanted));
    let count = lists.first().map_or(0, |names| names.len());
    let numbered = wanted.parse().ok().filter(|index| *index < count);
    named.or(numbered).ok_or_else(|| {
        let listed: Vec<String> = lists
            .iter()
            .take(1)
            .flat_map(|names| names.iter().enumerate())
            .map(|(index, name)| format!("{index} '{name}'"))
            .collect();
        let none = count == 0;
        Error::Usage {
            flag: flag.into(),
            expected: if none {
                "no choice, the file has none".into()
            } else {
                format!("one of {}", listed.join(", "))
            },
            got: format!("'{wanted}'"),
            way_out: if none {
                format!("leave {flag} out")
            } else {
                "give a name or a number from the list".into()
            },
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::pose::tests::door;
    use super::*;

    #[test]
    fn choices_go_by_name_then_number() -> Result<()> {
        let mut door = door();
        let named = |name: &str| Choice::Named(name.into());
        assert_eq!(door.choose_camera(&Choice::First)?, Some(0));
        assert_eq!(door.choose_camera(&named("2nd"))?, Some(1));
        assert_eq!(door.choose_camera(&named("leaf"))?, Some(1));
        assert_eq!(door.choose_camera(&named("1"))?, Some(1));
        let told = door
            .choose_camera(&named("7"))
            .map_err(|error| error.to_string());
        assert_eq!(told, Err("--camera: expected one of 0 'wide', 1 '2nd', got '7' — give a name or a number from the list".into()));
        assert!(door.choose_clip(&named("close")).is_err());
        door.choose_clip(&named("open"))?;
        assert_eq!(door.playing, [0]);
        door.cameras.clear();
        assert_eq!(door.choose_camera(&Choice::First)?, None);
        assert!(door.choose_camera(&named("0")).is_err());
        Ok(())
    }

    #[test]
    fn clips_of_different_objects_play_together_by_default() -> Result<()> {
        let mut door = door();
        let mut hinge = door.clips[0].clone();
        let floor = hinge.channels.split_off(1);
        let other = crate::scene::Clip {
            name: "floor".into(),
            channels: floor,
            ..hinge.clone()
        };
        let whole = door.clips[0].clone();
        door.clips = vec![hinge, other, whole];
        for name in ["again", "and again"] {
            let mut last = door.clips[2].clone();
            last.name = name.into();
            door.clips.push(last);
        }
        door.choose_clip(&Choice::First)?;
        assert_eq!(door.playing, [0, 1]);
        assert_eq!(
            door.warnings,
            [
                "animation 'open' is not played, since 'open' changes the same property, nor are 2 more: choose by --animation NAME, or all."
            ]
        );
        Ok(())
    }

    #[test]
    fn all_clips_play_together_and_the_later_wins() -> Result<()> {
        let mut door = door();
        let mut slower = door.clips[0].clone();
        slower.name = "slower".into();
        slower.channels.truncate(1);
        slower.channels[0].track.times = vec![0.0, 4.0];
        slower.seconds = 4.0;
        door.clips.push(slower);
        let hinge = |door: &Animation| door.pose(2.0).world[0].matrix3;
        let quick = hinge(&door);

        // Half of the quarter turn that the first clip has done by now; the floor's scale is the first clip's alone.
        door.choose_clip(&Choice::Named("all".into()))?;
        assert_eq!((&door.playing[..], door.seconds()), (&[0, 1][..], 4.0));
        let half = glam::DMat3::from_rotation_y(std::f64::consts::FRAC_PI_4);
        assert!(hinge(&door).abs_diff_eq(half, 1e-12));
        assert_eq!(door.pose(2.0).world[2].matrix3.x_axis.x, 2.0);
        assert_eq!(
            door.warnings,
            ["animation 'slower' changes 1 properties that an earlier one changes too: it wins."]
        );

        door.choose_clip(&Choice::Named("none".into()))?;
        assert_eq!((door.seconds(), door.moves().contains(&true)), (0.0, false));
        door.choose_clip(&Choice::Named("open".into()))?;
        assert_eq!(hinge(&door), quick);
        // A clip that is called so comes first.
        door.clips[1].name = "all".into();
        door.choose_clip(&Choice::Named("all".into()))?;
        assert_eq!(door.playing, [1]);
        Ok(())
    }

    #[test]
    fn what_is_hidden_goes_with_all_below_it() -> Result<()> {
        // The leaf hangs on the hinge; the floor stands by itself.
        let left = |names: &[&str]| -> Result<Vec<String>> {
            let mut door = door();
            let names: Vec<String> = names.iter().map(|name| name.to_string()).collect();
            door.hide(&names)?;
            let on = |instance: &crate::scene::Instance| instance.node.index();
            let name = |instance| door.nodes[on(instance)].name.clone();
            Ok(door.instances.iter().map(name).collect())
        };
        assert_eq!(left(&[])?, ["leaf", "floor"]);
        assert_eq!(left(&["hinge"])?, ["floor"]);
        assert_eq!(left(&["floor", "leaf"])?, [""; 0]);
        let told = left(&["lid"]).map_err(|error| error.to_string());
        assert!(told.is_err_and(|told| told.starts_with(
            "--hide: expected the name of a node, such as 'floor', 'leaf', got 'lid'"
        )));
        Ok(())
    }
}
