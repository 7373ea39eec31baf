//! Unscripted edits: something moves, changes or goes that no keyframe announced, and light is redistributed.
//!
//! Chen 1990, "Incremental radiosity: an extension of progressive radiosity to an interactive image synthesis system",
//! Computer Graphics 24(4):135–144; George, Sillion, Greenberg 1990, "Radiosity redistribution for dynamic
//! environments", IEEE Computer Graphics and Applications 10(4):26–34. No swept volume is known, so every sample keeps
//! its hit and its distance. What an edit moves has a box where it was and a box where it is: samples whose hit
//! it was, and samples that may cross the box where it is, are traced again; no other could find a new hit.
//!
//! We depart from both papers in four things. All edits of a step make one new state, the rows change to those of the new
//! state, and then one residual r = ρ'(D' + F'R) − R is shot, signed: so no two edits can count the same light twice,
//! and an object that comes and goes leaves no hole. What is subtracted is what was delivered, because samples are
//! fixed: only those whose hit changed carry other light. Light goes through the columns of the sampled rows, not by
//! reciprocity. And where light changes nearly everywhere, as when a lamp is switched, rows are gathered instead, after
//! a solve between groups of sides (see [`redistribution`](crate::solver::redistribution)).
//!
//! [`edit`] is what can be said, [`scene`] the scene as edited, [`Session`] holds hits and light and takes the steps.
//!
//! ```
//! use sweeplight::sequence::{edit, silence};
//! use sweeplight::session::Step;
//! use sweeplight::settings::Settings;
//!
//! let mut settings = Settings::new("animations/cornell.glb");
//! # (settings.image.size, settings.solve.element_size, settings.solve.samples) = ((64, 36), Some(1.0), Some(64));
//! let (mut session, _) = edit::open(&settings, false, &silence)?;
//! for line in [
//!     r#"{"edits": [{"move": {"node": "short block", "by": [-0.5, 0, 0.4]}}]}"#,
//!     r#"{"edits": [{"color": {"material": "red", "to": [0.1, 0.2, 0.7]}}, {"emission": {"material": "light", "strength": 20}}]}"#,
//!     r#"{"edits": [{"undo": 2}]}"#,
//! ] {
//!     let report = session.apply(&Step::parse(line)?.edits)?;    // one new state, one residual
//!     let image = session.image(&session.camera(settings.image.size)?); // from the same camera, only pixels that may differ
//!     println!("{} of {} samples traced, {} changed", report.traced, report.samples, report.changed);
//! #   assert!(report.traced < report.samples);
//! #   assert!(image.radiance.iter().flatten().any(|light| *light > 0.1));
//! }
//! assert!(session.verify().holds());                             // the same as a fresh build, bit for bit
//! # Ok::<(), sweeplight::error::Error>(())
//! ```
//!
//! # What depends on what
//!
//! Hits are a function of the state alone, never of the way there:
//! - Every side keeps its number while the session lives; what is added is numbered on, what is removed is away.
//! - What stands elsewhere than in its file, or was added, takes a sixteenth of the samples, as movers of an animation do: it traces
//!   all of them at each move, and pixels gather what is seen of it. Back in its place it takes all of them again.
//! - Each emitting material has light samples of its own, aimed by where its cells are and never by how brightly they
//!   shine. So a switch traces nothing, and what it brings is what a unit of light brings × the light.
//! - A material that has emitted keeps its samples while it is dark, so that it can be switched on again for nothing.

mod add;
mod apply;
pub mod edit;
mod emitters;
mod find;
mod light;
mod make;
mod open;
mod pictures;
mod pixels;
mod place;
mod precompute;
mod redistribute;
pub mod scene;
mod shown;
mod transform;
mod verify;

pub use edit::{Edit, Step};
pub use open::{Numbers, Session};
