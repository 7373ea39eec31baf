//! The flags of `view` and `export`: both drive a session, and refuse what edits refuse.

use std::path::PathBuf;

use clap::Args;

use super::edits::{self, Typed};
use super::help;
use super::light::LightArgs;
use super::picture::PictureArgs;
use super::scene::Sequence;
use crate::error::Result;
use crate::export::Export;
use crate::settings::Settings;

/// Write solved light: a .glb that any viewer shows lit, or the radiosity of every element as a table
///
/// The lit scene has unlit materials and colours of vertices; exposure and range stand in its extras.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct ExportArgs {
    /// The .gltf or .glb file
    scene: PathBuf,
    #[command(flatten)]
    sequence: Sequence,
    #[command(flatten)]
    light: LightArgs,
    #[command(flatten)]
    picture: PictureArgs,
    /// The lit scene, in the first of --frames: a .glb file
    #[arg(short, long, value_name = "FILE.glb", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Radiosity, irradiance, emission and reflectance of every side in all --frames, with units: .csv, or .npz for NumPy
    #[arg(long, value_name = "FILE.csv|FILE.npz", help_heading = "Output")]
    radiosity: Option<PathBuf>,
    /// Print errors alone
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl ExportArgs {
    /// The settings, what is written, and whether nothing is told.
    pub(super) fn filled(self) -> Result<(Settings, Export, bool)> {
        let mut settings = Settings::new(self.scene);
        self.sequence.fill(&mut settings.scene);
        let wanted = Export {
            scene: self.output,
            radiosity: self.radiosity,
        };
        fill(&mut settings, self.light, self.picture)?;
        Ok((settings, wanted, self.quiet))
    }
}

/// Fills in light and picture, and refuses what a session cannot honour.
fn fill(settings: &mut Settings, light: LightArgs, picture: PictureArgs) -> Result<()> {
    let typed = Typed {
        solver: light.names_solver(),
        fps: true,
        play: true,
    };
    light.fill(settings)?;
    picture.fill(settings);
    edits::check(settings, &typed)
}
