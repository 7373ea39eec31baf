//! What the program finds on a machine, and what it means for a run.

use crate::cli::shard;
use crate::geometry::kernel_name;
use crate::io::ffmpeg;
use crate::sequence::machine;
use crate::settings::Shard;
use serde::Serialize;
use std::fmt::Write;

/// A machine as the program finds it.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Version of the program.
    pub version: &'static str,
    /// Operating system and processor family.
    pub system: String,
    /// Threads that a run takes without `--threads`.
    pub threads: usize,
    /// The kernel that traces rays: `avx2` or `portable`.
    pub kernel: &'static str,
    /// Bytes of memory; without `--memory` a run must fit into them.
    pub memory_bytes: u64,
    /// `None` if ffmpeg works, else what is wrong: only .mp4 needs it.
    pub ffmpeg: Option<String>,
    /// The part that `--shard auto` renders, where the program runs in a Slurm array.
    pub shard: Option<Shard>,
    /// The variables that set the number of threads, where they are set.
    pub variables: Vec<(String, String)>,
}

/// Variables that other programs or the user set, and that change a run.
const VARIABLES: [&str; 3] = ["RAYON_NUM_THREADS", "SLURM_CPUS_PER_TASK", "SLURM_JOB_ID"];

/// Looks at this machine.
pub fn machine() -> Machine {
    let variable = |name: &str| std::env::var(name).ok();
    Machine {
        version: env!("CARGO_PKG_VERSION"),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        threads: rayon::current_num_threads(),
        kernel: kernel_name(),
        memory_bytes: machine::memory(),
        ffmpeg: ffmpeg::check().err(),
        shard: shard::parse("--shard", "auto").ok(),
        variables: VARIABLES
            .iter()
            .filter_map(|name| Some((name.to_string(), variable(name)?)))
            .collect(),
    }
}

impl Machine {
    /// The machine as rows of text.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut row = |name: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:10} {value}");
        };
        row("sweeplight", self.version.into());
        row("system", self.system.clone());
        row(
            "threads",
            format!("{}; --threads takes fewer", self.threads),
        );
        row(
            "rays",
            match self.kernel {
                "portable" => {
                    "portable kernel: the same pictures, at about .75 of the speed of AVX2".into()
                }
                kernel => format!("{kernel} kernel"),
            },
        );
        row(
            "memory",
            format!("{:.1} GB", self.memory_bytes as f64 / 1e9),
        );
        row(
            "ffmpeg",
            match &self.ffmpeg {
                None => "works: -o name.mp4 can be written".into(),
                Some(reason) => {
                    format!("{reason}: .mp4 cannot be written; .gif and .apng need none")
                }
            },
        );
        row(
            "slurm",
            match self.shard {
                Some(Shard { part, parts }) => {
                    format!("--shard auto renders part {part} of {parts}")
                }
                None => "not in an array; --shard I/N renders a part by hand".into(),
            },
        );
        for (name, value) in &self.variables {
            row("variable", format!("{name}={value}"));
        }
        text
    }
}
