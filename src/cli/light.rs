//! The flags under Light: the mesh, the samples and the solver.

use clap::Args;

use crate::cli::outside::Surroundings;
use crate::cli::values::{Checked, conflict, number, one_of, read, series, set, usage, whole};
use crate::error::Result;
use crate::mesh::cuts::MOST_ELEMENTS;
use crate::sequence::checks::{low_memory_fits, patches_fit};
use crate::sequence::sets;
use crate::settings::{
    HemisphereSampling, Memory, Meshing, Pairs, Quality, Settings, Solve, Solver,
};

/// The size of elements.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Elements {
    /// Preset for --elements and --samples [default: standard]
    #[arg(long, value_name = "PRESET", value_parser = one_of::<Quality>("write e.g. --quality draft for a quick look"))]
    quality: Option<Quality>,
    /// Longest edge of an element in metres, above 0. Halving it makes 4 times as many elements [default: by quality]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true,
          value_parser = number("a length in metres above 0", |metres: &f32| *metres > 0.0 && metres.is_finite(),
                                "0.25, or leave it out for one that suits the scene"))]
    element_size: Option<f32>,
    /// Largest number of elements, 1 to 16777215, in place of --element-size. Large triangles are cut, and small ones are
    /// clustered where they would eat the budget [default: by quality]
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "element_size",
          value_parser = whole(1, MOST_ELEMENTS as u32 - 1))]
    elements: Option<u32>,
}

impl Elements {
    /// Puts the flags into the settings.
    pub(super) fn fill(self, solve: &mut Solve) {
        set(&mut solve.quality, self.quality);
        solve.element_size = self.element_size;
        solve.elements = self.elements;
    }
}

/// The mesh, the samples and the solver.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct LightArgs {
    #[command(flatten)]
    elements: Elements,
    /// Lengths of elements' edges. The mesh is the same for every frame [default: uniform]
    #[arg(long, value_name = "MESH", value_parser = one_of::<Meshing>("leave it out for uniform"))]
    mesh: Option<Meshing>,
    /// Hemisphere samples of a receiver, a multiple of 16 from 16 to 4096. 4 times as many halve the noise [default: by quality]
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = series((16, 4096), "a multiple of 16 from 16 to 4096", |count| (count + 8) / 16 * 16))]
    samples: Option<u32>,
    /// Form factors by hemisphere samples in one of three distributions, or by formulas between all pairs of up to 2048 sides of
    /// elements [default: cosine]
    #[arg(long, value_name = "SET",
          value_parser = one_of::<HemisphereSampling>("leave it out for cosine, the least error for as many samples"))]
    form_factors: Option<HemisphereSampling>,
    /// With --form-factors hemicube, in place of --samples: pixels along an edge of the hemicube's top, an even number N from 4
    /// to 146. There are 3N² samples, a sixteenth of them for receivers on movers [default: nearest to --samples]
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "samples", value_parser = Checked(resolution))]
    hemicube_resolution: Option<u32>,
    /// Samples of a receiver to each emitter, 1 to 1024. More of them smooth penumbrae [default: 16]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1, 1024))]
    light_samples: Option<u32>,
    /// Method of solution. Both end within the same tolerance [default: gather]
    #[arg(long, value_name = "SOLVER", value_parser = one_of::<Solver>("leave it out for gather, the faster of the two"))]
    solver: Option<Solver>,
    /// Form factors of elements that lie closer together than they are long. near is for few, large elements that touch; it
    /// costs time, and gains nothing at the usual sizes [default: none]
    #[arg(long, value_name = "PAIRS", value_parser = one_of::<Pairs>("leave it out for none, where elements are small"))]
    pairs: Option<Pairs>,
    /// Number of elements that send light as one patch, 1 to 1024. Each still receives for itself (Cohen 1986). The solve takes
    /// less time, and the error grows [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = number("a whole number from 1 to 1024", |count: &u32| (1..=1024).contains(count), "4"))]
    patch_elements: Option<u32>,
    #[command(flatten)]
    surroundings: Surroundings,
    /// Worker threads, 1 to 1024. Results do not depend on them [default: every core]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1, 1024))]
    threads: Option<u32>,
    /// Gigabytes of memory that a run may take, light and picture, above 0; more is refused before the work [default: the machine's
    /// memory, or 16 where it is unknown]. low keeps no hit ids: rows are traced whenever a patch shoots. Memory is then linear
    /// in elements, every frame traces all samples at least twice, and nothing is reused. Give the flag twice for both
    #[arg(long, value_name = "GB|low", allow_negative_numbers = true, value_parser = Checked(memory))]
    memory: Vec<MemoryChoice>,
}

/// A value of `--memory`.
#[derive(Clone, Copy, Debug)]
enum MemoryChoice {
    /// Keep no hit ids.
    Low,
    /// So many bytes.
    Bytes(u64),
}

impl LightArgs {
    /// Whether a solver was given.
    pub(super) fn names_solver(&self) -> bool {
        self.solver.is_some()
    }

    /// Puts the flags into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
        let solve = &mut settings.solve;
        self.elements.fill(solve);
        set(&mut solve.mesh, self.mesh);
        solve.samples = self.samples;
        set(&mut solve.form_factors, self.form_factors);
        solve.hemicube_resolution = self.hemicube_resolution;
        if self.hemicube_resolution.is_some() && solve.form_factors != HemisphereSampling::Hemicube
        {
            let got = "another set, or cosine, the default";
            let way_out = "add --form-factors hemicube, or write --samples";
            let expected = "samples that form a hemicube";
            return Err(conflict("--hemicube-resolution", expected, got, way_out));
        }
        set(&mut solve.light_samples, self.light_samples);
        // Without rows light can only be shot. Another solver beside --memory low is refused below.
        for room in self.memory {
            match room {
                MemoryChoice::Low => {
                    (solve.memory, solve.solver) = (Memory::Low, Solver::Progressive)
                }
                MemoryChoice::Bytes(bytes) => solve.memory_limit = Some(bytes),
            }
        }
        set(&mut solve.solver, self.solver);
        set(&mut solve.pairs, self.pairs);
        set(&mut solve.patch_elements, self.patch_elements);
        solve.threads = self.threads.map(|threads| threads as usize);
        self.surroundings.fill(&mut settings.light);
        low_memory_fits(settings)?;
        patches_fit(settings)
    }
}

/// Pixels along an edge, an even number.
fn resolution(flag: &str, text: &str) -> Result<u32> {
    let way_out = format!("write e.g. {flag} 32");
    let refused = || {
        usage(
            flag,
            "an even number of pixels from 4 to 146",
            text,
            &way_out,
        )
    };
    let pixels = read::<u32>(text).ok_or_else(refused)?;
    sets::resolved(pixels).map(|pixels| pixels as u32)
}

/// Gigabytes, or low.
fn memory(flag: &str, text: &str) -> Result<MemoryChoice> {
    if text == "low" {
        return Ok(MemoryChoice::Low);
    }
    let gigabytes = read(text).filter(|gigabytes: &f64| *gigabytes > 0.0 && *gigabytes <= 1e6);
    let bytes = gigabytes.map(|gigabytes| MemoryChoice::Bytes((gigabytes * 1e9) as u64));
    bytes.ok_or_else(|| {
        let expected = "gigabytes above 0 and at most 1000000, or low";
        usage(flag, expected, text, &format!("write e.g. {flag} 16"))
    })
}
