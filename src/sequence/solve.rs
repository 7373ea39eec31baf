//! The visibility at one time as rows of form factors, and its radiosity by either solver.

use super::factors::{self, FormFactors};
use super::prepared::Prepared;
use crate::emission::Emission;
use crate::ids::SideId;
use crate::mesh::{PosedMesh, Side};
use crate::settings::{Settings, Solver, TOLERANCE};
use crate::solver::{self, Radiosity, Solution, StopRule, Substructure, System, gather_on_patches};
use crate::visibility::{MissIds, Visibility, specular_factors};
use glam::{Vec3, Vec3A};
use std::borrow::Cow;

/// Indirect light while a progressive solve converges.
pub struct Preview {
    /// Number of shots before it.
    pub shots: u64,
    /// Irradiance that each side has received, plus the ambient term for unshot radiosity.
    pub irradiance: Vec<Vec3>,
    /// Radiosity that each side has shot, plus the ambient term, then zeros for misses: pixels gather from it.
    pub reflected: Vec<Vec3A>,
}

/// Solves for the radiosity, starting from this one; previews are kept if asked for.
pub(super) fn solve(
    prepared: &Prepared,
    view: &Visibility,
    placed: &PosedMesh,
    emission: &Emission,
    start: Radiosity,
) -> (Radiosity, Vec<Preview>) {
    let factors = FormFactors::of(prepared, view, placed);
    let mut direct = arriving(prepared, view, &factors.share, emission);
    factors.mix(&mut direct);
    let rows = factors.rows();
    let reflectance = prepared.patches.reflectances(placed);
    let (mut light, previews) = match prepared.settings.solve.solver {
        Solver::Gather => {
            let kinds = MissIds::KINDS;
            let light = match &prepared.groups {
                None => solver::gather(&rows, &direct, &reflectance, kinds, start, TOLERANCE),
                Some(groups) => {
                    let grouping = Substructure {
                        patch_of: &groups.patch_of,
                        start: &groups.start,
                        members: &groups.sides,
                        area: &areas(prepared, placed),
                    };
                    let (light, white) = (&direct, &reflectance);
                    gather_on_patches(&rows, grouping, light, white, kinds, start, TOLERANCE)
                }
            };
            (light, Vec::new())
        }
        Solver::Progressive => {
            let system = System {
                area: &areas(prepared, placed),
                direct: &direct,
                reflectance: &reflectance,
            };
            shown(&prepared.settings, system, |stop, watch| {
                solver::shoot(&rows, system, MissIds::KINDS, &start, stop, watch)
            })
        }
    };
    factors.part(&mut light);
    (light, previews)
}

/// The same gathered from darkness, where light is shot otherwise: a way to compare with that knows no shots.
pub(super) fn gathered(
    prepared: &Prepared,
    view: &Visibility,
    placed: &PosedMesh,
    emission: &Emission,
) -> Option<Radiosity> {
    if prepared.settings.solve.solver == Solver::Gather {
        return None;
    }
    let factors = FormFactors::of(prepared, view, placed);
    let mut direct = arriving(prepared, view, &factors.share, emission);
    factors.mix(&mut direct);
    let rows = factors.rows();
    let (white, dark) = (prepared.patches.reflectances(placed), Radiosity::default());
    let kinds = MissIds::KINDS;
    Some(solver::gather(
        &rows, &direct, &white, kinds, dark, TOLERANCE,
    ))
}

/// Direct irradiance of each side, from emitters, also those that it sees by reflection, and from the sky.
pub(super) fn arriving(
    prepared: &Prepared,
    view: &Visibility,
    share: &[f32],
    emission: &Emission,
) -> Vec<Vec3> {
    let mut direct = view.direct();
    let reflected = reflected_emission(prepared, view, share, emission);
    for (direct, reflected) in direct.iter_mut().zip(reflected) {
        *direct += reflected;
    }
    if prepared.light.sky.is_some() {
        let all = direct.iter_mut().zip(view.sky(share));
        all.for_each(|(direct, sky)| *direct += sky);
    }
    direct
}

/// Indirect irradiance of each side with the sky's and with that of emitters that it sees by reflection.
pub(super) fn sky_irradiance<'a>(
    prepared: &Prepared,
    view: &Visibility,
    placed: &PosedMesh,
    emission: &Emission,
    irradiance: &'a [Vec3],
) -> Cow<'a, [Vec3]> {
    let mut irradiance = Cow::from(irradiance);
    let mirrors = prepared.patches.any_sends_on;
    if prepared.light.sky.is_none() && !mirrors {
        return irradiance;
    }
    let (shares, _) = factors::shares(prepared, view, placed);
    if prepared.light.sky.is_some() {
        let all = irradiance.to_mut().iter_mut().zip(view.sky(&shares));
        all.for_each(|(light, sky)| *light += sky);
    }
    let reflected = reflected_emission(prepared, view, &shares, emission);
    let all = irradiance.to_mut().iter_mut().zip(reflected);
    all.for_each(|(light, reflected)| *light += reflected);
    irradiance
}

/// Irradiance of each side straight from emitters that its samples see by reflection; empty where there is no mirror.
fn reflected_emission(
    prepared: &Prepared,
    view: &Visibility,
    share: &[f32],
    emission: &Emission,
) -> Vec<Vec3> {
    let patches = &prepared.patches;
    let of = |side: u32| emission.of_side(patches, SideId::new(side));
    let rows = prepared.specular_rows(view);
    specular_factors::reflected_emission(&rows, share, patches.sides.len(), of)
}

/// Irradiance that stands in for light that was not shot, in the picture of a solve that a number of shots stopped.
pub(super) fn ambient(settings: &Settings, light: &Radiosity) -> Vec3 {
    let stopped = settings.solve.shots.is_some() && light.residual > TOLERANCE;
    if stopped && settings.solve.ambient {
        light.ambient
    } else {
        Vec3::ZERO
    }
}

/// Shoots light, and keeps the previews on the way.
pub(super) fn shown(
    settings: &Settings,
    system: System,
    shoot: impl FnOnce(StopRule, &mut dyn FnMut(&Solution, u64)) -> Radiosity,
) -> (Radiosity, Vec<Preview>) {
    let mut previews = Vec::new();
    let stop = StopRule {
        shots: settings.solve.shots.unwrap_or(u64::MAX),
        ..StopRule::at(TOLERANCE)
    };
    let light = shoot(stop, &mut |solution, shots| {
        if settings.output.preview {
            let ambient = solution.ambient(system);
            let reflected = solution.shot.iter();
            let reflected = reflected.map(|r| r.as_vec3a() + Vec3A::from(ambient));
            let received = solution.received.iter();
            previews.push(Preview {
                shots,
                irradiance: received.map(|h| h.as_vec3() + ambient).collect(),
                reflected: reflected.chain([Vec3A::ZERO; MissIds::KINDS]).collect(),
            });
        }
    });
    (light, previews)
}

/// The area of each side in this pose, in m².
pub(super) fn areas(prepared: &Prepared, placed: &PosedMesh) -> Vec<f32> {
    let patches = &prepared.patches;
    let area = |side: &Side| patches.area(placed, side);
    patches.sides.iter().map(area).collect()
}
