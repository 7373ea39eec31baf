//! Pictures by Phong's model: an instant preview, for which nothing is traced beforehand and no light is solved.
//!
//! The ambient term is Cohen's, of equation 34 in Drucker's survey: unshot radiosity, spread evenly over all areas and reflected
//! by their mean reflectance (Cohen, Chen, Wallace, Greenberg 1988, "A progressive refinement approach to fast radiosity image
//! generation", Computer Graphics 22(4):75–84). The emitters have shot, without shadows, and nothing else has. The sky counts
//! as one more surface, black, and as large as the box around the scene.

use super::expose::Frame;
use super::prepared::Prepared;
use super::stopwatch::{Phase, Stopwatch};
use crate::emission::Lights;
use crate::emission::sampling::{self, FactorScratch};
use crate::error::{Error, Result};
use crate::ids::SideId;
use crate::image::Camera;
use crate::image::context::ShadingContext;
use crate::image::phong::{self, PhongModel};
use crate::mesh::{Kind, PosedMesh};
use crate::report::FrameReport;
use crate::scene::specular::Gloss;
use crate::settings::Settings;
use crate::solver::solution;
use crate::visibility::Accel;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

/// Refuses what needs solved light beside Phong's model.
pub fn fits(settings: &Settings) -> Result<()> {
    let solve = &settings.solve;
    let refusals = [
        (!settings.film.aovs.is_empty(), "--aov"),
        (settings.output.preview, "--preview"),
        (solve.shots.is_some(), "--shots"),
        (solve.from_scratch, "--from-scratch"),
    ];
    match refusals
        .iter()
        .find(|(said, _)| *said && settings.image.is_phong())
    {
        None => Ok(()),
        Some((_, flag)) => Err(Error::Usage {
            flag: (*flag).into(),
            expected: "a finish for which light is solved".into(),
            got: "--finish phong".into(),
            way_out: "leave out one of the two".into(),
        }),
    }
}

/// The picture of a moment whose geometry is placed.
pub(super) fn frame(
    prepared: &Prepared,
    placed: &PosedMesh,
    lights: &Lights,
    camera: Camera,
    start: Stopwatch,
    mut report: FrameReport,
) -> Frame {
    let patches = &prepared.patches;
    let accel = Accel::with_movers(patches, prepared.back.always(), placed);
    start.stop(Phase::Place, &mut report);
    let start = Stopwatch::start();
    let scene = ShadingContext {
        patches,
        paints: patches.paints(&prepared.animation),
        accel: &accel,
        lights,
        peak: &prepared.light.peak,
        sky: prepared.light.sky.as_ref(),
        share: None,
        camera,
        params: &prepared.image,
        standing: Vec::new(),
    };
    let model = PhongModel {
        gloss: gloss(prepared),
        ambient: ambient(prepared, placed, lights),
    };
    let image = phong::image(&scene, &model);
    report.pixels = u64::from(image.width) * u64::from(image.height);
    report.pixels_traced = report.pixels;
    report.from_scratch = true;
    start.stop(Phase::Image, &mut report);
    Frame {
        report,
        image,
        previews: Vec::new(),
        channels: Vec::new(),
    }
}

/// The gloss of each surface.
fn gloss(prepared: &Prepared) -> Vec<Gloss> {
    let animation = &prepared.animation;
    let surfaces = prepared.patches.surfaces.iter();
    let mesh = surfaces.map(|surface| animation.instances[surface.instance].mesh);
    mesh.map(|mesh| animation.materials[animation.meshes[mesh].material].gloss)
        .collect()
}

/// Ambient irradiance in W/m².
fn ambient(prepared: &Prepared, placed: &PosedMesh, lights: &Lights) -> Vec3 {
    let patches = &prepared.patches;
    let sides: Vec<SideId> = patches.side_ids().collect();
    let one = |scratch: &mut FactorScratch, side: &SideId| {
        let stand = patches.stand(placed, *side, Vec2::X);
        let (point, normal) = (stand.middle(patches.ray_offset), stand.normal);
        let mut direct = Vec3::ZERO;
        for kind in Kind::BOTH {
            let cells = &lights.emitters[kind];
            sampling::unoccluded(cells, point, normal, scratch, |_, irradiance| {
                direct += irradiance;
            });
        }
        let area = f64::from(patches.area(placed, &patches.sides[*side]));
        let reflectance = patches.sent_on(placed, *side).as_dvec3() * area;
        (area, reflectance * direct.as_dvec3(), reflectance)
    };
    let all: Vec<(f64, DVec3, DVec3)> = sides
        .par_iter()
        .map_init(FactorScratch::default, one)
        .collect();
    let area: f64 = all.iter().map(|one| one.0).sum();
    let unshot: DVec3 = all.iter().map(|one| one.1).sum();
    let reflectance: DVec3 = all.iter().map(|one| one.2).sum();
    let (outside, sky) = match &prepared.light.sky {
        // As if it were sent from the box around the scene.
        Some(sky) => {
            let area = f64::from(placed.bounds().area());
            (area, sky.mean().as_dvec3() * (std::f64::consts::PI * area))
        }
        None => (0.0, DVec3::ZERO),
    };
    solution::ambient(area + outside, unshot + sky, reflectance)
}
