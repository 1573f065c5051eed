//! What a driver is known to do wrong: the list that is shipped for it, or files of the user's.

use hullform::conformance::{Expectations, Lists, Opened};
use hullform::{Error, Result};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The list in a file, in our form or deqp-runner's; without one that which is shipped for the device's driver, if any.
pub fn expectations(file: Option<&Path>, device: Option<&Opened>) -> Result<Expectations> {
    let Some(file) = file else {
        let shipped = device.map(|device| Expectations::of(&device.driver));
        return Ok(shipped.unwrap_or_default());
    };
    let name = file.display().to_string();
    let Some(name) = Lists::name(&name) else {
        return Expectations::parse(&name, &read(file)?);
    };
    // The file that was named is there, or is missed; the other two need not be.
    let text = |other: &str| match read(Path::new(other)) {
        Err(Error::File { source, .. })
            if Path::new(other) != file && source.kind() == ErrorKind::NotFound =>
        {
            Ok(String::new())
        }
        found => found,
    };
    let [fails, flakes, skips] = Lists::files(name);
    let lists = Lists {
        fails: text(&fails)?,
        flakes: text(&flakes)?,
        skips: text(&skips)?,
    };
    lists.read(name)
}

/// Every file that is read when this one is asked for.
pub fn files(file: &Path) -> Vec<PathBuf> {
    let name = file.display().to_string();
    match Lists::name(&name) {
        Some(name) => Lists::files(name).map(PathBuf::from).into(),
        None => vec![file.into()],
    }
}

fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|source| Error::File {
        path: path.into(),
        source,
    })
}
