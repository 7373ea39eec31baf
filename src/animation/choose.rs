//! Which clips play and which camera is looked through: by the names that only the file knows.

use super::{Animation, Target};
use crate::error::{Error, Result};
use crate::settings::Choice;
use std::collections::HashSet;

impl Animation {
    /// Chooses the clips that play: one by name, else by index from 0, else `all` together or `none`.
    ///
    /// Warns where two of them change the same property: the later one wins.
    ///
    /// # Errors
    /// [`Error::Usage`] with the names there are, when none is called so.
    pub fn choose_clip(&mut self, choice: &Choice) -> Result<()> {
        let names: Vec<&str> = self.clips.iter().map(|clip| clip.name.as_str()).collect();
        let first = (!names.is_empty()).then_some(0);
        self.playing = match choice {
            Choice::First => first.into_iter().collect(),
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

    /// The camera to look through; `None` where the file has none and [`Animation::view`] frames the scene.
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
        let on = |camera: &super::Camera| self.nodes[camera.node as usize].name.as_str();
        let nodes: Vec<&str> = self.cameras.iter().map(on).collect();
        match choice {
            Choice::First => Ok((!names.is_empty()).then_some(0)),
            Choice::Named(name) => choose("--camera", name, &[&names, &nodes]).map(Some),
        }
    }
}

/// The position of a name, else of an index, among lists of names that belong to the same things.
pub(super) fn choose(flag: &str, wanted: &str, lists: &[&[&str]]) -> Result<usize> {
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
}
