//! `hullform view`: a window on surfaces, to turn, cut, compare and change them.

use std::path::PathBuf;

use clap::Args;
use hullform::Result;

use crate::options::{Global, Shape, Size};

/// Options of `view`.
#[derive(Args)]
#[cfg_attr(not(feature = "view"), allow(dead_code, reason = "there is no window"))]
pub struct Arguments {
    /// OBJ files, or builtin:NAME; several are a scene [default: the first built-in shape]
    pub models: Vec<PathBuf>,
    #[command(flatten)]
    pub shape: Shape,
    /// Size of the window in points [default: 1280x800, or as it was left]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Neither read nor write settings and pipelines of other times
    #[arg(long)]
    pub fresh: bool,
    /// Folder of shaders that are compiled anew when they change, in a hullform that was built with its shader compiler [default: that of the source
    /// tree that it was built in]
    #[arg(long, value_name = "FOLDER")]
    pub glsl: Option<PathBuf>,
    /// Write the window's state as JSON, a line a frame, for who drives it by script
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
}

/// Opens a window, and stays until it is closed.
#[cfg(feature = "view")]
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    crate::view::app::run(arguments, global)
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
