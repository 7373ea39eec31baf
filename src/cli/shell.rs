//! Texts for the system, from the program's own flags: completions for shells, and man pages.

use std::fs;
use std::io;
use std::path::Path;

use clap::CommandFactory;

use crate::cli::flags::{CommandLine, Completions, Man};
use crate::error::{Error, Result};

impl Completions {
    /// The script.
    pub(super) fn text(&self) -> String {
        let mut script = Vec::new();
        clap_complete::generate(
            self.shell,
            &mut CommandLine::command(),
            "sweeplight",
            &mut script,
        );
        String::from_utf8_lossy(&script).into_owned()
    }
}

impl Man {
    /// The page, or the names of the pages that were written.
    ///
    /// # Errors
    /// [`Error::Write`] where the folder cannot be written to.
    pub(super) fn write(&self) -> Result<String> {
        let line = CommandLine::command();
        let Some(folder) = &self.output else {
            return page(line).map_err(|source| refused(Path::new("-"), &source));
        };
        fs::create_dir_all(folder)
            .and_then(|()| clap_mangen::generate_to(line, folder))
            .map_err(|source| refused(folder, &source))?;
        Ok(format!("man pages are in {}", folder.display()))
    }
}

fn page(line: clap::Command) -> io::Result<String> {
    let mut page = Vec::new();
    clap_mangen::Man::new(line).render(&mut page)?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}

fn refused(path: &Path, source: &io::Error) -> Error {
    Error::Write {
        path: path.into(),
        reason: source.to_string(),
        way_out: "name a folder that can be written to".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;
    use clap_complete::Shell;

    #[test]
    fn every_shell_completes_every_command() {
        let commands = CommandLine::command();
        for shell in Shell::value_variants() {
            let text = Completions { shell: *shell }.text();
            for command in commands.get_subcommands() {
                assert!(text.contains(command.get_name()), "{shell} {command}");
            }
            assert!(text.contains("light-samples"), "{shell}");
        }
    }

    #[test]
    fn every_command_has_a_man_page() {
        let folder = tempfile::tempdir().expect("a folder");
        let pages = folder.path().join("man1");
        let man = Man {
            output: Some(pages.clone()),
        };
        man.write().expect("pages");
        for command in CommandLine::command().get_subcommands() {
            let page = pages.join(format!("sweeplight-{}.1", command.get_name()));
            let text = fs::read_to_string(&page).expect("a page");
            assert!(text.contains(".SH NAME"), "{}", page.display());
        }
        let whole = Man { output: None }.write().expect("a page");
        assert!(whole.contains("sweeplight") && whole.contains(".SH"));
    }
}
