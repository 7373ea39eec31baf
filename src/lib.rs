//! sweeplight renders glTF animations by radiosity, and recomputes in each frame only what the movers really changed.
//!
//! # The method on one page
//!
//! The scene is cut into **elements**, everywhere alike or smaller where a pilot run of the animation finds that its
//! pictures need it, and light is solved on their sides: *B = E + ρ F B*, with radiosity *B*,
//! emission *E* and reflectance *ρ* in red, green and blue. Everything is diffuse, so the radiance of a side is *B/π*,
//! and glTF's emissive colour × strength, a radiance, makes *E = π L*.
//!
//! Every form factor *F* is a weighted sum of **samples**. A sample has a fixed origin, a fixed direction or target and
//! a fixed weight, and asks one question: *what is the first thing seen?* No sample is ever drawn again, so a picture
//! changes only where the light did: there is no flicker to filter.
//!
//! 1. **Once**, with all movers gone, every sample of every resting receiver is traced. Its **static answer** (which
//!    side, how far) holds for the whole animation: that is the *back-buffer* of Baum, Wallace, Cohen and Greenberg
//!    (1986). A mover can only come in between.
//! 2. The **swept volume** is a set of boxes over the parts of the movers and over spans of frames; together they hold
//!    every mover in every rendered pose. A sample that meets none of them before its static answer is **settled** and
//!    is never looked at again. The others are **contested**, and keep the exact distance of their static answer.
//! 3. **In frame t** a contested sample is tested against the movers alone, and only if a mover that moved may stand in
//!    its way, or stood there. Receivers on a mover that moved ask all of their samples afresh.
//! 4. The answers at t *are* the rows of *F*. The **gathering solve** starts from the light of the frame before and
//!    sweeps until what is still to come lies below its tolerance. Or light is **shot** through the transpose of the
//!    same rows, the most unshot first, with a picture after each power of two of shots. Where memory is short no answer is
//!    kept: a shooter's row is asked for when it shoots, and turned around by reciprocity.
//! 5. The **image**: while the camera stands still, pixels are receivers too. What a pixel sees, and the light straight
//!    from the emitters, is asked again only where a mover may matter. Indirect light is interpolated from the solve, or
//!    **gathered** near contacts and on movers: pixels keep what hemisphere samples of their own see, and look it up;
//!    elements as near as they are long in **cells**, each lit directly.
//!
//! Surfaces are glTF's, taken as diffuse ([`Material`](scene::Material) says what becomes of metal). Textures and
//! vertex colours are averaged over each element for the solve, and looked up point by point where a camera sees them.
//!
//! Two kinds of samples carry the light. *Hemisphere samples* are spread in one of three ways: cosine-distributed
//! directions, each worth the same share of a row; the pixels of a hemicube, which weigh what their delta form factors
//! are; the cells of a plane. *Light samples* aim at emitters: the unoccluded factor is exact, and samples only say which
//! share of it is free. They deliver the emitters' own light *D*, hence a hemisphere sample that lands on an emitter
//! brings only what that reflects: what is iterated is *R = B − E = ρ (D + F R)*. On demand two patches that
//! lie closer together than they are long exchange light by such an exact factor too. Lights without a surface (points, spots,
//! directions) take light samples too; a hemisphere sample that leaves the scene brings the sky's radiance to *D*.
//!
//! Which samples are asked is chosen by the brightest that an emitter ever is, not by what it is now. So where only light
//! changes, a lamp that dims, a colour that turns, nothing is asked: the same answers are weighed anew, and solved.
//!
//! Where nobody knows beforehand what will move, a [`session`] does the same without a swept volume: every sample keeps its
//! distance, the boxes of what moved mark what to ask, and what light is missing or too much is shot, signed.
//!
//! # What is exact, and what is not
//!
//! - The answers at t equal a full trace at t **bit for bit**: hemisphere samples, covered origins, light samples, the
//!   irradiance they give, and what pixels see. One triangle test decides, ties go to the lower triangle, and distances
//!   are compared in one order, so it does not matter which tree or which kernel found a hit.
//! - Images, answers and counts do not depend on the number of threads; only seconds do.
//! - The solve, gathering or shooting, ends when no channel of any *R* can be off by more than [`TOLERANCE`](frames::prepare::TOLERANCE), 2 · 10⁻³
//!   of the root mean square of *R*; the bound is rigorous while no reflectance exceeds 0.95. Where a solve starts may
//!   show within that: a frame rendered alone and the same frame of a whole run may be twice the tolerance apart.
//! - After any edits the answers of a session equal those of a fresh build of the edited scene **bit for bit**, and its light
//!   agrees within the tolerance: [`Session::verify`](session::Session::verify).
//! - [`frames::verify()`] holds a scene to this, frame by frame, against a trace and a solve from nothing.
//! - Against the light of the real scene there remain the errors of every radiosity program: elements of a finite size,
//!   a finite number of samples, and, in what reflects on to others, one reflectance for each element.
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | ambient term | even light in a preview, in place of what is still to be shot; no final image has any |
//! | answer | what a sample sees: the number of a side, or one of [`MissIds`](visibility::MissIds) |
//! | away | not seen in a pose: its triangles are points, which no ray hits and which send and receive nothing |
//! | back-buffer | every static answer, and what of it is contested: [`BackBuffer`](visibility::BackBuffer) |
//! | candidate | a sample that a frame tested or traced again; the terminal says *asked* |
//! | changed | a sample whose answer differs from the frame before: the least that any method must ask |
//! | base colour, tint, glow | a material's factor; what textures and vertex colours multiply it by; the same of its emission |
//! | contested, settled | a mover may come before the static answer in some frame; none ever does |
//! | covered | an origin with something close above it that does not shine on it, or in a hole; it does not count, and vertices weigh less for it |
//! | cutout | where a triangle has holes: no ray hits it there, and no light arrives |
//! | edit, step | one change that no keyframe announced; all that make one new state together |
//! | element | a piece of a triangle with edges up to the element size, or as short as needed; its identity never changes |
//! | emitter, lamp | an element or a light that emits; the emitters of one kind, resting or moving |
//! | layer | numbers of each pixel beside its colour in an EXR file, chosen by `--aov` |
//! | light | what shines without a surface: a point, a spot or a direction of KHR_lights_punctual, or the sun of a flag |
//! | light sample | a question put to an emitter: is the way to this point free? |
//! | loose | not where its file put it, or added: it takes a mover's share of the samples |
//! | moment | a time at which the scene is looked at: a frame's own, or one of several while the shutter is open |
//! | mover | a surface that the playing clips move, bend, morph, or show and hide |
//! | mesh | all elements: uniform, or adaptive by [`Need`](mesh::sizes::Need)s |
//! | near pair | two sides closer together than they are long: on demand their factor is a contour integral, and samples say what of it is visible |
//! | origin | one of the points of a side, lifted off it, from which its samples start |
//! | part, span | a group of a mover's triangles that lie together; a run of frames: one box of the swept volume each |
//! | pilot | a coarse run of the whole clip, by which an adaptive mesh is cut; no picture shows it |
//! | placed, pose | where all triangles are at t; where all nodes are at t |
//! | radiance, irradiance, radiosity | *L*, what a camera sees; what arrives; what leaves: for diffuse surfaces *B = π L* |
//! | receiver | whoever asks: a side in the solve, a pixel in the image |
//! | repainted | a surface whose base colour a clip changes: nothing is asked again for it, the light is solved anew |
//! | reversed | mirrored otherwise than when it was cut: its front is where its corners run clockwise |
//! | row | the samples' answers of one receiver, each worth its weight over what those that count weigh |
//! | set | how hemisphere samples are spread, and what each weighs: cosine, hemicube or plane |
//! | shell | what shuts light from outside out: the surfaces that rays from what is in view meet last |
//! | shot | all of a row's unshot radiosity, given or taken back down its column: [`shoot`](solver::shoot()) |
//! | side | the front or the back of an element, with a radiosity of its own |
//! | stage | the geometry at t, in trees that rays can ask |
//! | static answer | what a sample sees when every mover is gone |
//! | still | a frame of a moving picture, as a file until all of them are joined |
//! | sweep | one pass of the solver over all rows; no relation to the swept volume |
//! | swept volume | boxes that hold everywhere a mover goes: [`SweptVolume`](visibility::SweptVolume) |
//! | tally | what each side asked and found changed in a frame; kept only for a page of the report, and for the layer `recomputed` |
//! | tight | changed ÷ traced: 1 where no sample was traced in vain |
//! | tone | exposure and a curve: how radiance is shown |
//! | unshot | what a row reflects of all it has received, less what it has shot: the residual; may be negative |
//! | view | all answers at t: [`Visibility`](visibility::Visibility) |
//! | worth | what an error of light in one place adds to the error of a picture |
//!
//! # The floor plan
//!
//! Rooms stand in the order in which data passes them, and each uses only rooms before it:
//! glTF → scene at t → patches → swept volume → questions → answers → light → image → session → sequence.
//!
//! Form factors come before the back-buffer, although a factor is what its answers add up to: [`formfactor`] defines
//! the questions and what each is worth, [`visibility`] answers them. No step lies between answers and factors, since the
//! view at t, row by row, *is* the matrix of sampled rows that [`solver`] reads.
//!
//! A program needs one call, [`frames::render()`]. One that wants to look between the steps takes them itself, as
//! `render` does: [`frames::prepare::prepare`] once, then [`Renderer::step`](frames::Renderer::step) frame by frame. One that edits opens a
//! session, [`frames::edit::open`], and applies steps. The README shows all three.

// Errors: one enum that names the thing, the expected, the found and the way out.
pub mod error;

// Choices that the settings and the rooms below them share.
pub mod options;

// Every number of a run with its unit, reason and default; an argument list for `frames`.
pub mod settings;

// Numbers of things: a type for each kind.
pub mod ids;

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

// Unscripted edits: what changed is asked again, and its light redistributed.
pub mod session;

// The account of a run: counts and seconds, as a table, as JSON and as a page.
pub mod report;

// The sequence: frame by frame, its steps, and the proof that nothing was lost.
pub mod frames;

// Answers known beforehand: every estimator against formulas, theorems and published solutions.
pub mod validate;

// The command line: flags to settings, help, and progress on a terminal; nothing else knows flags.
pub mod cli;

// The README's examples, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
