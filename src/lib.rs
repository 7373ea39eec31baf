//! sweeplight renders glTF animations by radiosity, and recomputes in each frame only the samples that its movers changed.
//!
//! # The method on one page
//!
//! The scene is cut into **elements**: of one size, or smaller where a coarse pilot run of the animation finds an error in
//! its pictures. Light is solved on their sides: *B = E + ρ F B*, with radiosity *B* and emission *E* in W/m², and
//! reflectance *ρ*, each in red, green and blue. What a surface sends on diffusely has the radiance *B/π*, and glTF's emissive
//! colour × strength, a radiance *L*, gives *E = π L*.
//!
//! Every form factor *F* is a weighted sum of **samples**. A sample has a fixed origin, a fixed direction or target and
//! a fixed weight, and one **hit**: the first side that its ray meets. No sample is ever drawn again, so a picture
//! changes only where the light did. There is no flicker to filter.
//!
//! 1. **Once**, with all movers gone, every sample of every resting receiver is traced. Its **static hit** (a side and a
//!    distance) holds for the whole animation: that is the *back-buffer* of Baum, Wallace, Cohen and Greenberg (1986). A
//!    mover can only come in between.
//! 2. The **swept volume** is a set of boxes over the parts of the movers and over spans of frames. Together they hold
//!    every mover in every rendered pose. A sample that meets none of them before its static hit is **settled**: it is
//!    never tested again. The others are **contested**, and keep the exact distance of their static hit.
//! 3. **In frame t** a contested sample is tested against the movers alone, and only where a moved mover may stand in
//!    its way, or stood there. A moved mover's own receivers trace their samples again; but what a receiver on a **rigid
//!    body** sees of that body was traced once, in the body's own space, so only the rest of the world is, and only before it.
//! 4. The hits at t *are* the rows of *F*. **Gathering** starts from the light of one key frame and sweeps until the
//!    error lies below its tolerance. Or light is **shot** through the transpose of the same rows, the most unshot first,
//!    with a picture after each power of two of shots. With little memory no hit is kept: a shooter's row is traced when it
//!    shoots, and transposed by reciprocity.
//! 5. The **image**: while the camera stands still, pixels are receivers too. A pixel's primary hits and light samples
//!    are traced again only where a mover may matter. Indirect light is interpolated from the solve, or **gathered** near
//!    contacts and on movers: pixels keep the hits of their own hemisphere samples, and look their radiosity up. Elements
//!    nearer than their length are looked up in smaller **cells**, each lit directly. On demand **gather points** do so for
//!    the pixels of flat surfaces: they lie on a lattice over the elements, and are kept wherever the camera goes.
//!
//! Surfaces are glTF's: diffuse, mirrors up to a roughness of 0.1, thin and solid glass, coverage by alpha, and translucent
//! sheets ([`scene::specular`]). A sample that meets a mirror or glass first follows a **path** to the first diffuse surface:
//! its factor is an extended form factor ([`visibility::path`]), and it is contested where any segment is. Pixels follow all
//! ways. Textures and vertex colours are averaged over each element for the solve, and looked up point by point for the camera.
//!
//! Two kinds of samples carry the light. *Hemisphere samples* are spread in one of three ways: cosine-distributed
//! directions of equal weight; the pixels of a hemicube, weighted by their delta form factors; the cells of a plane. *Light
//! samples* aim at emitters: the unoccluded form factor is exact, and the samples give its visible fraction. They deliver
//! the emitters' own light *D*, so a hemisphere sample that hits an emitter brings only its reflected part, and the solve
//! iterates *R = B − E = ρ (D + F R)*. On demand, two patches closer together than their length exchange light by an exact
//! factor too, or in small scenes all of them, by the contour integral or by disks. Lights without a surface (points, spots, directions) take light samples too. A hemisphere sample that leaves
//! the scene brings the sky's radiance to *D*.
//!
//! Samples are chosen by each emitter's peak emission over the clip, not by its emission now. So where only light
//! changes, a lamp that dims or a colour that turns, nothing is traced: the same hits are weighted again, and solved.
//!
//! For edits that no keyframe announced, a [`session`] does the same without a swept volume: every sample keeps its
//! distance, boxes around moved geometry mark the samples to trace, and the signed residual of the light is shot.
//!
//! # What is exact, and what is not
//!
//! - The hits at t equal a full trace at t **bit for bit**: hemisphere samples, invalid origins, light samples, their
//!   irradiance, and the pixels' primary hits. One triangle test decides, ties go to the lower triangle, and distances
//!   are compared in one order, so no result depends on the BVH or on the kernel.
//! - Images, hits and counts do not depend on the number of threads; only seconds do.
//! - The solve, gathering or shooting, ends when no channel of any *R* can be off by more than [`TOLERANCE`](settings::TOLERANCE), 2 · 10⁻³
//!   of the root mean square of *R*; the bound is rigorous while no reflectance exceeds 0.95. Where a solve starts may
//!   show within that, so all frames start from the same light: that of the [`key`](sequence::key) frame. A frame rendered
//!   alone is the same frame of a whole run, byte for byte.
//! - After any edits the hits of a session equal those of a fresh build of the edited scene **bit for bit**, and its light
//!   agrees within the tolerance: [`Session::verify`](session::Session::verify).
//! - [`sequence::verify()`] holds a scene to this, frame by frame, against a trace and a solve from nothing.
//! - Against the light of the real scene there remain the errors of every radiosity program: elements of a finite size,
//!   a finite number of samples, and, in what reflects on to others, one reflectance for each element.
//!
//! # Words
//!
//! Terms of the field keep their usual meaning. These are the method's own:
//!
//! | word | meaning |
//! |---|---|
//! | archive, cache | lists of numbers in a file with a checksum; a folder of them, one for each preparation: [`sequence::cache`] |
//! | back-buffer | all static hits, and the contested ones among them: [`BackBuffer`](visibility::BackBuffer) |
//! | changed | a sample whose hit differs from the last frame: the least that any method must trace |
//! | cluster | small triangles of a surface that lie together and look alike: one element, whose sides they share |
//! | contested, settled | a sample that a mover may come before in some frame; one that none ever does |
//! | dynamic | geometry of an edited scene that does not stand where its file put it: it takes a mover's samples |
//! | edit, step | one change that no keyframe announced; all edits that make one new state together |
//! | key light | the light of the frame in the middle of the clip, from which every frame's solve starts |
//! | gather point | a place of a lattice over flat elements; pixels interpolate what it gathers |
//! | invalid origin | a sample's origin under close geometry or in a hole; it does not count |
//! | moment | a time at which the scene is rendered: a frame's own, or one of several while the shutter is open |
//! | mover | a surface that the playing clips move, bend, morph, or show and hide |
//! | near pair | two sides closer together than their length, with a form factor by the contour integral |
//! | part, span | a group of a mover's triangles that lie close; a run of frames: one box of the swept volume each |
//! | pilot | a coarse run of the whole clip, which sizes an adaptive mesh; no picture shows it |
//! | rigid body | surfaces that one node carries without bending, stretching or hiding them: [`visibility::bodies`] |
//! | side | the front or the back of an element, with a radiosity of its own: the receiver of the solve |
//! | static hit | a sample's first hit with all movers gone |
//! | swept volume | boxes that hold every mover in every rendered pose: [`SweptVolume`](visibility::SweptVolume) |
//! | traced | a sample that a frame tested or traced again; changed ÷ traced is the tightness |
//!
//! # The floor plan
//!
//! Rooms stand in the order in which data passes them, and each uses only rooms before it:
//! glTF → scene at t → mesh → samples → visibility → radiosity → image → session → sequence.
//!
//! Form factors come before visibility, although a factor is a sum over hits: [`formfactor`] and [`emission`] define
//! the samples and their weights, [`visibility`] traces them. No step lies between hits and factors, since the hits
//! at t, row by row, *are* the matrix of sampled rows that [`solver`] reads.
//!
//! | question | place |
//! |---|---|
//! | where is a sample traced, kept, and updated? | [`visibility`], whose header names the files |
//! | where is light solved? | [`solver`]: gathering, shooting, redistribution, over one solution |
//! | where does a frame begin? | [`sequence::Renderer::step`]: place, update, solve, picture |
//! | where does an edit begin? | [`session::Session::apply`] |
//!
//! A program needs one call, [`sequence::render()`]. One that wants to look between the steps takes them itself, as
//! `render` does: [`sequence::prepare::prepare`] once, then [`Renderer::step`](sequence::Renderer::step) frame by frame. One that edits opens a
//! session, [`sequence::edit::open`], and applies steps. The README shows the first two, [`session`] the third.

// Errors: one enum that names the thing, the expected, the found and the way out.
pub mod error;

// Choices that the settings and the rooms below them share.
pub mod options;

// Every number of a run with its unit, reason and default; an argument list for `sequence`.
pub mod settings;

// Numbers of things: a type for each kind.
pub mod ids;

// Lists of numbers in a file, with a checksum: what a cache is made of.
pub mod archive;

// Pictures on surfaces, and the holes that their alpha makes.
pub mod texture;

// Rays, boxes, the watertight triangle test, and BVHs over triangles and boxes.
pub mod geometry;

// A scene that moves, as plain data: its nodes, meshes, materials and tracks, and their state at time t.
pub mod scene;

// A glTF file read into a scene; no other room names the gltf crate.
pub mod gltf;

// The scene cut into elements, the pieces that exchange light: one mesh for all time, and its pose at t.
pub mod mesh;

// Form factors in closed form, and the sample sets that a receiver casts.
pub mod formfactor;

// Emitters now and at their peak, and the light samples aimed at them.
pub mod emission;

// What every sample sees: the static hits, and those at t after movers or edits. The solver sees packed ids alone.
pub mod visibility;

// Rows of factors to radiosity; it knows neither rays nor time.
pub mod solver;

// Radiosity to image: camera, direct light, interpolation or final gathering, tone; it sees no form factor.
pub mod image;

// Files: pictures, moving pictures, and the names by which frames are asked for.
pub mod io;

// The account of a run: counts and seconds, as a table, as JSON and as a page.
pub mod report;

// Unscripted edits: samples that may change are traced again, and their light redistributed.
pub mod session;

// The sequence: frame by frame, its steps, and the proof that nothing was lost.
pub mod sequence;

// Solved light to take along: lit glTF files, and tables of radiosity.
pub mod export;

// The live viewer: a page in the browser, and a session behind it.
pub mod view;

// Form factors of a user's scene by every estimator, side by side.
pub mod compare;

// Answers known beforehand: every estimator against formulas, theorems and published solutions.
pub mod validate;

// The command line: flags to settings, help, and progress on a terminal; nothing else knows flags.
pub mod cli;

// The policy of property tests, shared with those beside the library.
#[cfg(test)]
#[path = "../tests/renderer/support/property.rs"]
mod property;

// The README's examples, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
