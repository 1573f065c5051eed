//! `hullform view`: a window on surfaces, to turn, cut, compare and change them.

#[cfg(feature = "view")]
mod app;
#[cfg(feature = "view")]
mod canvas;
#[cfg(feature = "view")]
mod clipboard;
#[cfg(feature = "view")]
mod command;
#[cfg(feature = "view")]
mod context;
#[cfg(feature = "view")]
mod deform;
#[cfg(feature = "view")]
mod draft;
#[cfg(feature = "view")]
mod errors;
#[cfg(feature = "view")]
mod folder;
#[cfg(feature = "view")]
mod log;
#[cfg(feature = "view")]
mod notices;
#[cfg(feature = "view")]
mod orbit;
#[cfg(feature = "view")]
mod overlay;
#[cfg(feature = "view")]
mod panels;
#[cfg(feature = "view")]
mod part;
#[cfg(feature = "view")]
mod picture;
#[cfg(feature = "view")]
mod probe;
#[cfg(feature = "view")]
mod program;
#[cfg(feature = "view")]
mod readings;
#[cfg(feature = "view")]
mod selection;
#[cfg(feature = "view")]
mod settings;
#[cfg(feature = "view")]
mod shot;
#[cfg(feature = "view")]
mod stage;
#[cfg(feature = "view")]
mod viewer;
#[cfg(feature = "view")]
mod viewport;
#[cfg(feature = "view")]
mod watch;
#[cfg(feature = "view")]
mod workers;

use std::path::PathBuf;

use clap::Args;
use hullform::Result;

use crate::options::{Global, Shape, Size};

/// Options of `view`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ files, or builtin:NAME; several are a scene [default: the first built-in shape]
    pub models: Vec<PathBuf>,
    #[command(flatten)]
    shape: Shape,
    /// Size of the window in points [default: 1280x800, or as it was left]
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Neither read nor write settings and pipelines of other times
    #[arg(long)]
    fresh: bool,
    /// Write the window's state as JSON, a line a frame, for who drives it by script
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
}

/// Opens a window, and stays until it is closed.
#[cfg(feature = "view")]
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    app::run(arguments, global)
}

/// There is none in this build.
#[cfg(not(feature = "view"))]
pub fn run(_: &Arguments, _: &Global) -> Result<()> {
    Err(hullform::Error::Option {
        option: "view",
        problem: "this hullform was built without its window".into(),
        remedy: "build it with `--features view`, or draw into a file with `hullform render`"
            .into(),
    })
}
