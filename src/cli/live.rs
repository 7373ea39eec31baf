//! The flags of `view` and `export`: both drive a session, and refuse what edits refuse.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use clap::Args;

use super::edits::{self, Typed};
use super::help;
use super::light::LightArgs;
use super::picture::PictureArgs;
use super::scene::{LookArgs, Sequence};
use super::values::number;
use crate::error::Result;
use crate::export::Export;
use crate::settings::Settings;
use crate::view::Viewer;

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
    /// All of --frames in that file: objects move as in the scene, and light is interpolated between key frames
    #[arg(long, help_heading = "Output")]
    animated: bool,
    /// How far colours between key frames may be off, as a share of white on the screen
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, requires = "animated", allow_negative_numbers = true,
        value_parser = number("a share from 0.0001 to 1", |share: &f64| (1e-4..=1.0).contains(share), "0.01"), help_heading = "Output")]
    tolerance: f64,
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
            animated: self.animated.then_some(self.tolerance as f32),
            radiosity: self.radiosity,
        };
        fill(&mut settings, self.light, self.picture)?;
        Ok((settings, wanted, self.quiet))
    }
}

/// Look at solved light in the browser, and edit it there
///
/// Prints the address of a page, with a token, on the loopback interface. Light follows what is moved, switched or painted.
/// The program ends when the last tab has been closed for ten seconds.
#[derive(Debug, Args)]
#[command(after_help = help::AFTER_COMMAND)]
pub(super) struct ViewArgs {
    /// The .gltf or .glb file
    scene: PathBuf,
    /// Port [default: any that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Address of this machine to listen on. Others than the loopback let other machines in that know the token
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    host: String,
    /// Start the browser
    #[arg(long)]
    open: bool,
    /// Go on when the last tab has been closed
    #[arg(long)]
    keep: bool,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    light: LightArgs,
    #[command(flatten)]
    picture: PictureArgs,
    /// Print the address and errors alone
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

/// What is done with the address of the page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Greeting {
    /// Whether the browser is started.
    pub open: bool,
    /// Whether progress is not told.
    pub quiet: bool,
}

impl ViewArgs {
    /// The settings, the viewer, and what is done with its address.
    pub(super) fn filled(self) -> Result<(Settings, Viewer, Greeting)> {
        let mut settings = Settings::new(self.scene);
        self.look.fill(&mut settings.scene);
        let viewer = Viewer {
            host: self.host,
            port: self.port,
            keep: self.keep,
        };
        fill(&mut settings, self.light, self.picture)?;
        let (open, quiet) = (self.open, self.quiet);
        Ok((settings, viewer, Greeting { open, quiet }))
    }
}

/// Starts the browser at an address. Where that fails, the address stands on the screen all the same.
pub fn open_browser(address: &str) {
    let (program, first): (&str, &[&str]) = if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else if cfg!(target_os = "macos") {
        ("open", &[])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    let command = command.args(first).arg(address);
    let quiet = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if let Err(error) = quiet.spawn() {
        eprintln!(
            "warning: the browser does not start by {program} ({error}): open the address yourself"
        );
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
