//! What a command writes: asked about before the work begins.

use std::ffi::OsString;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::{Arg, ArgMatches, Command};
use serde::Serialize;

use super::out;
use crate::files::{self, guard};

/// An argument that names a file to write; `-` is standard output. Every other argument that names a
/// file names one to read.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Output(PathBuf);

impl From<OsString> for Output {
    fn from(name: OsString) -> Self {
        Self(name.into())
    }
}

impl Output {
    pub fn stdout() -> Self {
        Self("-".into())
    }
}

impl Deref for Output {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl AsRef<Path> for Output {
    fn as_ref(&self) -> &Path {
        self
    }
}

/// Gives `--json` one meaning in all commands: a file, or standard output in place of the text.
pub fn with_json(command: Command) -> Command {
    let json = |argument: Arg| match argument.get_id() == "json" {
        true => {
            let what = argument.get_help().map(ToString::to_string).unwrap_or_default();
            let help = format!("{what}; without FILE to standard output, in place of the text");
            argument.num_args(0..=1).default_missing_value("-").help(help)
        }
        false => argument,
    };
    command.mut_args(json).mut_subcommands(with_json)
}

/// Refuses what this command line would destroy.
///
/// # Errors
/// Names the first file that may not be written, and why.
pub fn ask(command: &Command, matches: &ArgMatches) -> anyhow::Result<()> {
    let mut outputs = Vec::new();
    collect(command, matches, &mut outputs);
    if matches.get_flag("overwrite") {
        guard::overwrite();
    }
    outputs.iter().try_for_each(|path| may_write(path))?;
    for (i, path) in outputs.iter().enumerate() {
        let same = |other: &Output| files::guard::resolved(other) == files::guard::resolved(path);
        if !discards(path) && outputs[..i].iter().any(same) {
            let there = if files::is_stdout(path) {
                "standard output".into()
            } else {
                path.display().to_string()
            };
            bail!("{there}: two outputs would go there; name another file for one of them");
        }
    }
    if outputs.iter().any(|path| files::is_stdout(path)) {
        out::leave_to_the_file();
    }
    Ok(())
}

/// Several may go there.
fn discards(path: &Path) -> bool {
    files::is_stream(path) && !files::is_stdout(path)
}

/// Refuses a folder that is a file, and files of these names in it that may not be written over.
///
/// # Errors
/// As [`ask`].
pub fn ask_in<N: AsRef<Path>>(folder: &Path, names: &[N]) -> anyhow::Result<()> {
    match (folder.exists(), folder.is_dir()) {
        (true, true) => names.iter().try_for_each(|name| may_write(&folder.join(name))),
        (true, false) => bail!("{}: is a file; name a folder", folder.display()),
        (false, _) => Ok(()),
    }
}

fn may_write(path: &Path) -> anyhow::Result<()> {
    files::may_write(path).map_err(|refused| anyhow!("{}: {refused}", path.display()))
}

/// Adds the outputs; all else that names a file is read.
fn collect(command: &Command, matches: &ArgMatches, outputs: &mut Vec<Output>) {
    for argument in command.get_arguments().filter(|a| a.get_action().takes_values()) {
        let id = argument.get_id().as_str();
        match matches.try_get_many::<Output>(id) {
            Ok(named) => outputs.extend(named.into_iter().flatten().cloned()),
            Err(_) => {
                let words = matches.try_get_raw(id).ok().flatten().into_iter().flatten();
                words.map(Path::new).filter(|path| path.is_file()).for_each(guard::reads);
            }
        }
    }
    if let Some((name, matches)) = matches.subcommand()
        && let Some(command) = command.find_subcommand(name)
    {
        collect(command, matches, outputs);
    }
}
