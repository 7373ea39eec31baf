//! The report as a page: one file that needs no network, for people to look at.
//!
//! [`gallery`] gathers the pictures while the frames are made and [`heat`] colours those of where, [`chart`] draws what
//! [`charts`] chooses, [`verdict`] says what the figures mean, [`words`] lays out every figure of the JSON with its
//! meaning. `page.html` is the page and `page.css` how it looks, in a light and a dark room, on a desk and on a phone.

pub mod chart;
pub mod charts;
mod figure;
pub mod gallery;
pub mod heat;
pub mod plots;
pub mod proof;
mod shrink;
pub mod verdict;
pub mod words;

use std::path::Path;

use askama::Template;
use serde::Serialize;

pub use gallery::{Gallery, is_page};
pub use proof::Proof;

use crate::error::{Error, Result};
use crate::io::file;
use crate::report::{Report, json};
use crate::settings::Settings;
use chart::Chart;
use gallery::GalleryPicture;
use verdict::Headline;
use words::{Frames, Group};

/// The page as its template needs it.
#[derive(Template)]
#[template(path = "page.html", config = "src/report/page/askama.toml")]
struct Page<'a> {
    style: &'static str,
    name: String,
    about: String,
    headlines: Vec<Headline>,
    sentences: Vec<String>,
    whole: Option<[GalleryPicture; 3]>,
    single: &'a [GalleryPicture],
    moved: bool,
    ramp: String,
    charts: Vec<Chart>,
    sheet: &'a [GalleryPicture],
    frames: Frames,
    groups: Vec<Group>,
}

/// Writes every report that the settings name: pages, and `data` as JSON.
pub fn write(
    settings: &Settings,
    data: &impl Serialize,
    report: &Report,
    gallery: Option<&Gallery>,
    proof: Option<&Proof>,
) -> Result<()> {
    for path in &settings.output.reports {
        let text = match gallery {
            Some(gallery) if is_page(path) => page(report, gallery, proof)?,
            _ => json(data)?,
        };
        file::replace(path, text.as_bytes())?;
    }
    Ok(())
}

/// The page of a report.
pub fn page(report: &Report, gallery: &Gallery, proof: Option<&Proof>) -> Result<String> {
    let figures = figures(report, proof)?;
    let scene = Path::new(&report.settings.given.scene.file);
    let name = scene
        .file_stem()
        .map_or(String::new(), |name| name.to_string_lossy().into());
    let whole = gallery.whole()?;
    let page = Page {
        style: include_str!("page.css"),
        about: about(report, proof),
        name,
        headlines: verdict::headlines(report, proof),
        sentences: verdict::sentences(report, proof),
        moved: whole
            .as_ref()
            .is_some_and(|[_, traced, _]| traced.part > 0.0),
        whole,
        single: &gallery.single,
        ramp: ramp(),
        charts: charts::charts(report, proof),
        sheet: &gallery.sheet,
        frames: words::frames(&figures),
        groups: words::groups(&figures),
    };
    page.render().map_err(unwritten)
}

/// The JSON of the report; what verify found stands beside it, and its seconds stand with each frame.
fn figures(report: &Report, proof: Option<&Proof>) -> Result<serde_json::Value> {
    let value = |text: String| serde_json::from_str(&text).map_err(unwritten);
    let mut figures: serde_json::Value = value(json(report)?)?;
    if let Some(proof) = proof {
        figures["verified"] = value(json(proof.verified)?)?;
        let frames = figures["frames"].as_array_mut();
        for (frame, scratch) in frames.into_iter().flatten().zip(proof.scratch) {
            frame["seconds"]["from_scratch"] = (*scratch).into();
        }
    }
    Ok(figures)
}

/// What was done, in a line.
fn about(report: &Report, proof: Option<&Proof>) -> String {
    let settings = &report.settings.given;
    let (width, height) = settings.image.size;
    format!(
        "{} frames of {width} × {height} pixels {}, {} elements, {} samples a frame, {} threads",
        report.total.frames,
        if proof.is_some() {
            "verified"
        } else {
            "rendered"
        },
        crate::report::table::grouped(report.scene.elements),
        crate::report::table::grouped(report.scene.samples),
        settings.solve.threads.unwrap_or(1)
    )
}

/// The colours of shares as a CSS gradient.
fn ramp() -> String {
    let colors = heat::COLORS.map(|[red, green, blue]| format!("rgb({red},{green},{blue})"));
    colors.join(",")
}

fn unwritten(error: impl std::fmt::Display) -> Error {
    Error::Write {
        path: "report".into(),
        reason: error.to_string(),
        way_out: "please report this with the scene".into(),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::report::total::Scratch;
    use crate::report::{Counts, FrameReport, Seconds, Used};

    /// Four frames whose light takes 8, 1, 1 and 3 seconds.
    pub(super) fn report(scratch: f64, preparation: f64) -> Report {
        let mut settings = Settings::new("a/door & <more>.glb");
        settings.solve.quality = crate::settings::Quality::Draft;
        let settings = Used::of(&settings, 0.1, [128, 16], [1.0; 2], 2e-3);
        let frame = |(frame, solve): (u32, f64)| FrameReport {
            frame,
            samples: 1000,
            traced: if frame == 0 { 1000 } else { 40 },
            changed: if frame == 0 { 1000 } else { 10 },
            seconds: Seconds {
                solve,
                ..Seconds::default()
            },
            ..FrameReport::default()
        };
        let frames = [8.0, 1.0, 1.0, 3.0];
        let frames = (0..).zip(frames).map(frame).collect();
        Report::of(
            settings,
            Counts::default(),
            preparation,
            Scratch {
                light: Some(scratch),
                image: None,
            },
            frames,
        )
    }

    #[test]
    fn pages_are_known_by_their_names() {
        let are = ["a.html", "b.HTM", "c.json", "html", "d.html.json"]
            .map(|name| is_page(Path::new(name)));
        assert_eq!(are, [true, true, false, false, false]);
    }

    #[test]
    fn names_are_text_wherever_they_stand() {
        let mut settings = Settings::new("x.glb");
        settings.output.reports = vec!["x.html".into()];
        let gallery = Gallery::if_wanted(&settings, 4).expect("a gallery");
        let page = page(&report(2.0, 1.0), &gallery, None).expect("a page");
        assert!(!page.contains("<more>"), "{page}");
        assert!(page.contains("&#60;more&#62;"), "{page}");
    }
}
