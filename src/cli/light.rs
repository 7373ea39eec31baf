//! The flags under Light: how surfaces are cut, and how the light on them is solved.

use clap::Args;

use crate::cli::film::alone;
use crate::cli::outside::Shining;
use crate::cli::values;
use crate::error::Result;
use crate::frames::prepare::{low_memory_fits, patches_fit};
use crate::settings::{FormFactors, Memory, Settings, Solver};

/// How the surfaces are cut.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Elements {
    /// draft, standard or fine: about 4000, 16000 or 64000 elements, 128, 256 or 512 samples [default: standard]
    #[arg(long, value_name = "PRESET")]
    quality: Option<String>,
    /// Longest edge of an element in metres: halving it costs 4 times the elements [default: by quality]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    element_size: Option<String>,
    /// Elements at most, 1 to 16777215, in place of --element-size: a triangle of the scene is never less than one
    /// [default: by quality]
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        conflicts_with = "element_size"
    )]
    elements: Option<String>,
}

impl Elements {
    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
        if let Some(text) = self.quality {
            settings.quality = values::quality(&text)?;
        }
        settings.element_size = self
            .element_size
            .as_deref()
            .map(values::element_size)
            .transpose()?;
        settings.elements = self.elements.as_deref().map(values::elements).transpose()?;
        Ok(())
    }
}

/// How the light is solved.
#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub(super) struct Light {
    #[command(flatten)]
    elements: Elements,
    /// uniform or adaptive: edges of one length everywhere, or as many elements that are small where the pictures need it.
    /// A pilot, a coarse run of the whole animation, finds where, and the mesh is the same for every frame [default: uniform]
    #[arg(long, value_name = "MESH")]
    mesh: Option<String>,
    /// Hemisphere samples of a receiver, a multiple of 16 from 16 to 4096: 4 times halve the noise [default: by quality]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    samples: Option<String>,
    /// cosine, hemicube or plane: how these are spread. Directions of equal weight; the pixels of a hemicube with their delta
    /// form factors, of the resolution that comes nearest to --samples; or cells of a plane of which each carries the
    /// same, what its rim loses renormalised [default: cosine]
    #[arg(long, value_name = "SET")]
    form_factors: Option<String>,
    /// Pixels along an edge of a hemicube's top, an even number N from 4 to 146, in place of --samples: 3N² samples in all,
    /// a sixteenth of them for receivers on movers
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        conflicts_with = "samples"
    )]
    hemicube_resolution: Option<String>,
    /// Samples of a receiver to the emitters, 1 to 1024: more for cleaner shadows in the light [default: 16]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    light_samples: Option<String>,
    /// gather or progressive: every patch collects what it sees, on all cores, or the one with most unshot light gives it
    /// away first; both end within the same tolerance [default: gather]
    #[arg(long, value_name = "SOLVER")]
    solver: Option<String>,
    /// near or none: near takes the factor of patches that lie closer together than they are long by the contour integral
    /// times what samples see of it, for large elements that touch; emitters' light always comes by such formulas [default: none]
    #[arg(long, value_name = "PAIRS")]
    pairs: Option<String>,
    /// Elements that send light as one patch, 1 to 1024: the solve then takes less time, and elements receive as before
    /// [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    patch_elements: Option<String>,
    #[command(flatten)]
    shining: Shining,
    /// Worker threads, 1 to 1024; the result does not depend on them [default: every core]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    threads: Option<String>,
    /// Gigabytes of memory that the light may take, above 0: what would take more is refused before the work [default: the
    /// machine's memory, or 16 where it tells none]. low keeps no answers, but asks for each shooter's when it shoots,
    /// progressively, so that memory is linear in patches: every frame then asks all samples at least twice, and nothing is
    /// saved. May be given twice, for both
    #[arg(long, value_name = "GB|low", allow_negative_numbers = true)]
    memory: Vec<String>,
}

impl Light {
    /// Whether a solver was said.
    pub(super) fn names_solver(&self) -> bool {
        self.solver.is_some()
    }

    /// Put what was said into the settings.
    pub(super) fn fill(self, settings: &mut Settings) -> Result<()> {
        self.elements.fill(settings)?;
        if let Some(text) = self.mesh {
            settings.mesh = values::mesh(&text)?;
        }
        settings.samples = self.samples.as_deref().map(values::samples).transpose()?;
        if let Some(text) = self.form_factors {
            settings.form_factors = values::form_factors(&text)?;
        }
        let resolution = self.hemicube_resolution.as_deref();
        settings.hemicube_resolution = resolution.map(values::hemicube_resolution).transpose()?;
        if resolution.is_some() && settings.form_factors != FormFactors::Hemicube {
            let got = "another set, or cosine, the default";
            let way_out = "add --form-factors hemicube, or write --samples";
            let expected = "samples that form a hemicube";
            return Err(alone("--hemicube-resolution", expected, got, way_out));
        }
        if let Some(text) = self.light_samples {
            settings.light_samples = values::light_samples(&text)?;
        }
        self.shining.fill(&mut settings.light)?;
        // Without rows light can only be shot: so it is, unless something else is said, which is refused in time.
        for text in &self.memory {
            match values::memory(text)? {
                None => (settings.rows, settings.solver) = (Memory::Low, Solver::Progressive),
                limit => settings.memory = limit,
            }
        }
        if let Some(text) = self.solver {
            settings.solver = values::solver(&text)?;
        }
        if let Some(text) = self.pairs {
            settings.pairs = values::pairs(&text)?;
        }
        if let Some(text) = self.patch_elements {
            settings.patch_elements = values::patch_elements(&text)?;
        }
        low_memory_fits(settings)?;
        patches_fit(settings)?;
        settings.threads = self.threads.as_deref().map(values::threads).transpose()?;
        Ok(())
    }
}
