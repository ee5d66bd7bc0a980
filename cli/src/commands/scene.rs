//! `tyndall scene`: the scenes that are built in, to look at and to change.

use crate::tables::stdout;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;
use tyndall::error::{Error, Result};
use tyndall::scene::{BUILTIN, builtin_files};

/// List the scenes that are built in, or write one to a folder
#[derive(Debug, Args)]
pub struct SceneCommand {
    /// Which; all are listed without it
    #[arg(value_name = "NAME", value_parser = PossibleValuesParser::new(BUILTIN), requires = "output")]
    scene: Option<String>,
    /// The folder that its files are written to; it is made if it is not there
    #[arg(short, long, value_name = "FOLDER", requires = "scene")]
    output: Option<PathBuf>,
}

/// Lists or writes.
///
/// # Errors
/// [`Error::Input`] where one of the files is there already; [`Error::File`] where it cannot be written.
pub fn run(args: &SceneCommand) -> Result<()> {
    let (Some(name), Some(folder)) = (&args.scene, &args.output) else {
        let list = BUILTIN.map(|name| Ok(format!("{name:10} {}\n", builtin_files(name)?.0)));
        let list: Result<String> = list.into_iter().collect();
        return stdout::print(list?);
    };
    let (_, files) = builtin_files(name)?;
    let there = files
        .iter()
        .map(|(file, _)| folder.join(file))
        .find(|path| path.exists());
    if let Some(path) = there {
        return Err(Error::input(
            path.display().to_string(),
            "it is there already",
            "name another folder, or remove it",
        ));
    }
    std::fs::create_dir_all(folder).map_err(|e| Error::writing(folder, e))?;
    for (file, bytes) in files {
        let path = folder.join(file);
        std::fs::write(&path, bytes).map_err(|e| Error::writing(&path, e))?;
    }
    stdout::print(format!("{}\n", folder.join(files[0].0).display()))
}
