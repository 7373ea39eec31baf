//! What is drawn, frame by frame: the colours of all corners, and where objects and the camera are.

use super::lit::{SceneLight, in_16_bits};
use crate::error::Result;
use crate::export::drawn::{DrawnMesh, DrawnObject};
use crate::scene::view::View;
use crate::session::Session;
use glam::{DAffine3, Vec2, Vec3};

/// The states of an export so far.
pub(in crate::export) struct Recording {
    drawn: DrawnMesh,
    /// Seconds since the first frame.
    pub(super) times: Vec<f32>,
    /// As the drawn objects.
    pub(super) objects: Vec<Recorded>,
    /// The camera in each frame.
    pub(super) views: Vec<View>,
    /// What radiance is multiplied by, in stops, and the size of the picture.
    stops: f32,
    size: (u32, u32),
    first_second: f64,
}

/// An object over time.
pub(super) struct Recorded {
    pub(super) object: DrawnObject,
    /// Whether it emits in any frame, so that its texture is in its colours.
    pub(super) glows: bool,
    /// Its corners, three a triangle, in its own coordinates, or in the world's where it deforms; none before it is seen.
    pub(super) corners: Vec<Vec3>,
    pub(super) texcoords: Vec<Vec2>,
    /// World positions of the corners in each frame, where it deforms.
    pub(super) deformed: Option<Vec<Vec<Vec3>>>,
    /// From its own coordinates to the world's in each frame; none where it is hidden.
    pub(super) places: Vec<Option<DAffine3>>,
    /// Colours of the corners in each frame, linear, 65,535 for white; none where it is hidden.
    pub(super) colors: Vec<Vec<[u16; 3]>>,
    /// Whether each corner was brighter than white in any frame.
    pub(super) clipped: Vec<bool>,
}

impl Recording {
    /// Nothing yet of a session; `glowing` tells which materials emit in any frame.
    pub(in crate::export) fn of(
        session: &Session,
        (stops, size): (f32, (u32, u32)),
        glowing: &[bool],
    ) -> Recording {
        let drawn = DrawnMesh::of(session);
        let animation = &session.scene.animation;
        let recorded = |object: &DrawnObject| {
            let instance = session.scene.patches.surfaces[object.surface].instance;
            let deforms = animation
                .rigid_place(instance.index(), session.pose())
                .is_none();
            Recorded {
                glows: glowing[object.material.index()],
                corners: Vec::new(),
                texcoords: Vec::new(),
                deformed: deforms.then(Vec::new),
                places: Vec::new(),
                colors: Vec::new(),
                clipped: Vec::new(),
                object: object.clone(),
            }
        };
        Recording {
            objects: drawn.objects.iter().map(recorded).collect(),
            drawn,
            times: Vec::new(),
            views: Vec::new(),
            stops,
            size,
            first_second: session.seconds(),
        }
    }

    /// Bytes that a frame takes.
    pub(in crate::export) fn bytes_of_frame(&self) -> usize {
        let corners = 3 * self.drawn.triangles.len();
        let deformed = self
            .objects
            .iter()
            .filter(|object| object.deformed.is_some());
        let deformed: usize = deformed
            .map(|object| 3 * object.object.triangles.len())
            .sum();
        corners * size_of::<[u16; 3]>() + deformed * size_of::<Vec3>()
    }

    /// Adds the present state.
    pub(in crate::export) fn add(&mut self, session: &Session) -> Result<()> {
        self.times
            .push((session.seconds() - self.first_second) as f32);
        self.views.push(session.view(self.size)?.0);
        let light = SceneLight::of(session, &self.drawn, self.stops);
        let (animation, pose) = (&session.scene.animation, session.pose());
        for recorded in &mut self.objects {
            let object = &recorded.object;
            let instance = session.scene.patches.surfaces[object.surface].instance;
            let place = animation.rigid_place(instance.index(), pose);
            // What is scaled to nothing is hidden too.
            let place = place.unwrap_or(DAffine3::IDENTITY);
            let is_there = session.is_there(object.surface) && place.matrix3.determinant() != 0.0;
            if !is_there {
                recorded.places.push(None);
                recorded.colors.push(Vec::new());
                if let Some(deformed) = &mut recorded.deformed {
                    deformed.push(Vec::new());
                }
                continue;
            }
            let world = light.corners(object);
            if recorded.corners.is_empty() {
                let back = place.inverse();
                let own = world
                    .iter()
                    .map(|p| back.transform_point3(p.as_dvec3()).as_vec3());
                recorded.corners = own.collect();
                recorded.texcoords = light.texcoords(object, recorded.glows);
            }
            let colors = light.colors_of(object, recorded.glows);
            recorded.clipped.resize(colors.len(), false);
            let bright = colors.iter().map(|color| color.max_element() > 1.0);
            let clipped = recorded.clipped.iter_mut().zip(bright);
            clipped.for_each(|(clipped, bright)| *clipped |= bright);
            recorded
                .colors
                .push(colors.into_iter().map(in_16_bits).collect());
            recorded.places.push(Some(place));
            if let Some(deformed) = &mut recorded.deformed {
                deformed.push(world);
            }
        }
        Ok(())
    }
}
