//! The subdivision schemes by name, and what each asks of a mesh.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// How a control mesh is refined, and so which limit surface it has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// Catmull, Clark 1978: quads; other faces become quads in the first refinement.
    #[default]
    CatmullClark,
    /// Loop 1987: triangles; quartic box splines where six of them meet.
    Loop,
    /// The modified butterfly of Zorin, Schröder, Sweldens 1996: triangles; passes through the control vertices.
    Butterfly,
    /// Stam, Loop 2003: triangles as Loop has them beside quads as Catmull and Clark have them.
    LoopStam,
    /// Linear refinement: the faces themselves, n-gons as one quad a corner around their mean.
    Bilinear,
}

impl Scheme {
    /// All of them, in the order in which they are listed to users.
    pub const ALL: [Scheme; 5] = [
        Scheme::CatmullClark,
        Scheme::Loop,
        Scheme::Butterfly,
        Scheme::LoopStam,
        Scheme::Bilinear,
    ];

    /// The name that the command line knows it by.
    pub fn name(self) -> &'static str {
        match self {
            Scheme::CatmullClark => "catmull-clark",
            Scheme::Loop => "loop",
            Scheme::Butterfly => "butterfly",
            Scheme::LoopStam => "loop-stam",
            Scheme::Bilinear => "bilinear",
        }
    }

    /// Whether every face must be a triangle. Then each takes one ptex number, and its domain is u + v <= 1.
    pub fn is_triangular(self) -> bool {
        matches!(self, Scheme::Loop | Scheme::Butterfly)
    }

    /// Whether a face with so many corners is a ptex face of its own. Any other face has one a corner.
    pub fn is_whole(self, corners: usize) -> bool {
        match self {
            Scheme::CatmullClark | Scheme::Bilinear => corners == 4,
            Scheme::Loop | Scheme::Butterfly | Scheme::LoopStam => corners <= 4,
        }
    }

    /// How many ptex faces a face with so many corners has.
    pub(crate) fn ptex_faces(self, corners: usize) -> usize {
        match self.is_whole(corners) {
            true => corners.min(1),
            false => corners,
        }
    }

    /// The scheme that the beginning of a file's name speaks of, as the names of OpenSubdiv's shapes do.
    ///
    /// ```
    /// use hullform::mesh::Scheme;
    /// assert_eq!(Scheme::of_file("shapes/loop_cube.obj"), Some(Scheme::Loop));
    /// assert_eq!(Scheme::of_file("loophole.obj"), None);
    /// ```
    pub fn of_file(path: impl AsRef<std::path::Path>) -> Option<Scheme> {
        let stem = path.as_ref().file_stem()?.to_string_lossy();
        let (first, _) = stem.split_once('_')?;
        match first {
            "catmark" => Some(Scheme::CatmullClark),
            "loop" => Some(Scheme::Loop),
            "bilinear" => Some(Scheme::Bilinear),
            _ => None,
        }
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Scheme {
    type Err = Error;

    fn from_str(text: &str) -> Result<Scheme> {
        let found = Scheme::ALL.into_iter().find(|scheme| scheme.name() == text);
        found.ok_or_else(|| Error::Option {
            option: "--scheme",
            problem: format!("there is no scheme {text:?}"),
            remedy: format!("choose one of {}", Scheme::ALL.map(Scheme::name).join(", ")),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_their_schemes() {
        for scheme in Scheme::ALL {
            assert_eq!(scheme.name().parse::<Scheme>().ok(), Some(scheme));
        }
        let error = "doo-sabin"
            .parse::<Scheme>()
            .map_err(|error| error.to_string());
        assert_eq!(
            error,
            Err("--scheme: there is no scheme \"doo-sabin\"; \
                 choose one of catmull-clark, loop, butterfly, loop-stam, bilinear"
                .into())
        );
    }
}
