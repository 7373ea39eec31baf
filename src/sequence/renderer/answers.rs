//! What a renderer answers for the moment of its last step: visibility, form factors, radiosity, irradiance, and the
//! comparison with the same moment from scratch.

use super::Renderer;
use crate::ids::SideId;
use crate::mesh::PosedMesh;
use crate::report::FrameReport;
use crate::report::page::gallery::Counted;
use crate::report::verified::Comparison;
use crate::sequence::factors::FormFactors;
use crate::sequence::solve::{self, arriving};
use crate::sequence::step::State;
use crate::sequence::step::picture::Shot;
use crate::sequence::stopwatch::{Phase, Stopwatch};
use crate::settings::TOLERANCE;
use crate::visibility::Visibility;
use glam::Vec3;

/// The moment of the last step; before the first one: static hits, darkness, and the geometry at time 0.
impl Renderer<'_> {
    /// Visibility and solution.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The hits of all samples, receiver by receiver.
    pub fn visibility(&self) -> &Visibility {
        &self.state.view
    }

    /// The world corners of all triangles, in metres.
    pub fn placed(&self) -> &PosedMesh {
        let last = self.last.as_ref();
        last.map_or(&self.prepared.rest, |last| &last.placed)
    }

    /// The form factors of all sides, as the solver reads them.
    pub fn form_factors(&self) -> FormFactors<'_> {
        FormFactors::of(self.prepared, &self.state.view, self.placed())
    }

    /// The form factor from a side to another: the part of what leaves `from` that arrives at `to`, from 0 to 1.
    ///
    /// The side at the front of element `e` is `prepared.patches.side_of[e][0]`. [`FormFactors::row`] gives all of a side's.
    ///
    /// ```
    /// # use sweeplight::{sequence::{prepare::prepare, renderer::Renderer, silence}, settings::Settings};
    /// # let mut settings = Settings::new("animations/cornell.glb");
    /// # (settings.image.size, settings.solve.element_size, settings.solve.samples) = ((32, 18), Some(1.0), Some(64));
    /// # let [a, b] = [0, 1].map(sweeplight::ids::SideId::new);
    /// let prepared = prepare(&settings, &silence)?;
    /// let mut renderer = Renderer::new(&prepared);
    /// renderer.solve(23);
    /// let factor = renderer.form_factor(a, b);
    /// # assert!((0.0..=1.0).contains(&factor));
    /// # Ok::<(), sweeplight::error::Error>(())
    /// ```
    ///
    /// # Panics
    /// If there is no such side.
    pub fn form_factor(&self, from: SideId, to: SideId) -> f32 {
        let row = self.form_factors().row(from);
        let found = row.iter().find(|(side, _)| *side == to);
        found.map_or(0.0, |(_, factor)| *factor)
    }

    /// Radiosity B of each side in W/m²: what it emits and reflects. A diffuse side's radiance is B / π.
    ///
    /// ```
    /// # use sweeplight::{sequence::{prepare::prepare, renderer::Renderer, silence}, settings::Settings};
    /// # let mut settings = Settings::new("animations/cornell.glb");
    /// # (settings.image.size, settings.solve.element_size, settings.solve.samples) = ((32, 18), Some(1.0), Some(64));
    /// let prepared = prepare(&settings, &silence)?;
    /// let mut renderer = Renderer::new(&prepared);
    /// renderer.solve(23);
    /// let radiosity = renderer.radiosity();
    /// # assert!(radiosity.iter().all(|b| b.min_element() >= 0.0) && radiosity.iter().any(|b| b.x > 1.0));
    /// # Ok::<(), sweeplight::error::Error>(())
    /// ```
    pub fn radiosity(&self) -> Vec<Vec3> {
        let patches = &self.prepared.patches;
        let emitted = |side: SideId| {
            let last = self.last.as_ref();
            last.map_or(Vec3::ZERO, |last| last.emission.of_side(patches, side))
        };
        let reflected = self.state.light.reflected.iter();
        let reflected = reflected
            .map(|r| Vec3::from(*r))
            .chain(std::iter::repeat(Vec3::ZERO));
        patches
            .side_ids()
            .zip(reflected)
            .map(|(side, r)| emitted(side) + r)
            .collect()
    }

    /// Irradiance of each side in W/m²: from emitters, from the sky, and by way of other sides.
    pub fn irradiance(&self) -> Vec<Vec3> {
        let indirect = &self.state.light.indirect;
        let shares = self.form_factors();
        let direct = match &self.last {
            Some(last) => arriving(
                self.prepared,
                &self.state.view,
                &shares.share,
                &last.emission,
            ),
            None => self.state.view.direct(),
        };
        let indirect = indirect
            .iter()
            .copied()
            .chain(std::iter::repeat(Vec3::ZERO));
        direct.iter().zip(indirect).map(|(d, i)| *d + i).collect()
    }

    /// The side that fills most of each pixel of the last picture, row by row.
    pub fn sides_of_pixels(&self) -> Vec<Option<SideId>> {
        self.picture.sides()
    }

    /// Hands over the counts of the last moment for a page of the report.
    pub(in crate::sequence) fn counted<T>(&self, to: impl FnOnce(&Counted) -> T) -> T {
        to(&Counted {
            tally: self.state.tally.as_deref(),
            view: &self.state.view,
            facing: &|| self.picture.sides(),
        })
    }

    /// Bytes held beside what is prepared.
    pub fn memory(&self) -> usize {
        self.state.memory() + self.picture.memory()
    }

    /// Compares the present moment with the same traced and solved from scratch; before the first step nothing differs.
    pub fn verify(&self) -> Comparison {
        let Some(moment) = self.present else {
            return Comparison::default();
        };
        let prepared = self.prepared;
        let arrived = self.arrive(prepared.moments[moment]);
        let mut report = FrameReport::default();
        let clock = Stopwatch::start();
        let accel = prepared.accel_from_scratch(&arrived.placed);
        clock.stop(Phase::Place, &mut report);
        let fresh = State::from_scratch(prepared, &accel, &arrived.lights, &mut report);
        let sides = prepared.patches.sides.len();
        let emission = &arrived.lights.emission;
        let gathered = solve::gathered(prepared, &fresh.view, &arrived.placed, emission);
        let gathered = gathered.as_ref().unwrap_or(&fresh.light);
        let pixels_differ = self.picture.current().map_or(0, |camera| {
            let shot = Shot::new(prepared, &fresh, &accel, &arrived.lights, camera);
            self.picture.differences_from_scratch(&shot.scene)
        });
        Comparison {
            differ: self.state.view.differences(&fresh.view),
            pixels_differ,
            difference: self.state.largest_difference(gathered, sides),
            allowed: 2.0 * f64::from(TOLERANCE),
            seconds: report.seconds.light(),
            solve_seconds: report.seconds.solve,
        }
    }
}
