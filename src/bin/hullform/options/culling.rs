//! `--cull`: what is left out of a picture.

use std::fmt;
use std::str::FromStr;

use super::Cull;

/// What is left out: triangles that show one side, and patches of which nothing is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Culling {
    /// Triangles; and with those that show their backs, patches that show nothing else.
    pub triangles: Cull,
    /// Patches outside of the picture.
    pub frustum: bool,
    /// Patches between samples.
    pub small: bool,
}

impl Culling {
    /// Whether patches are left out that triangles would not be.
    pub fn needs_decisions(self) -> bool {
        self.frustum || self.small
    }
}

/// As the command line has it.
impl fmt::Display for Culling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let triangles = match self.triangles {
            Cull::None => None,
            Cull::Back => Some("back"),
            Cull::Front => Some("front"),
        };
        let patches = [(self.frustum, "frustum"), (self.small, "small")];
        let patches = patches.iter().filter_map(|&(on, name)| on.then_some(name));
        let words: Vec<&str> = triangles.into_iter().chain(patches).collect();
        match words.is_empty() {
            true => write!(f, "none"),
            false => write!(f, "{}", words.join(",")),
        }
    }
}

impl FromStr for Culling {
    type Err = String;

    fn from_str(text: &str) -> Result<Culling, String> {
        let mut culling = Culling::default();
        let mut sides = Vec::new();
        for word in text.split(',') {
            match word {
                "none" if text == "none" => {}
                "back" => sides.push(Cull::Back),
                "front" => sides.push(Cull::Front),
                "frustum" => culling.frustum = true,
                "small" => culling.small = true,
                "all" => {
                    sides.push(Cull::Back);
                    (culling.frustum, culling.small) = (true, true);
                }
                _ => {
                    return Err(format!(
                        "'{word}' is none of none, frustum, back, small, all and front"
                    ));
                }
            }
        }
        culling.triangles = sides.first().copied().unwrap_or_default();
        if sides.iter().any(|&side| side != culling.triangles) {
            return Err("without backs and without fronts nothing is left".into());
        }
        Ok(culling)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_lists_of_them() {
        let culling = |triangles, frustum, small| Culling {
            triangles,
            frustum,
            small,
        };
        for (text, right) in [
            ("none", culling(Cull::None, false, false)),
            ("back", culling(Cull::Back, false, false)),
            ("front,frustum", culling(Cull::Front, true, false)),
            ("small", culling(Cull::None, false, true)),
            ("frustum,back,small", culling(Cull::Back, true, true)),
            ("all", culling(Cull::Back, true, true)),
        ] {
            assert_eq!(text.parse(), Ok(right), "{text}");
            assert_eq!(right.to_string().parse(), Ok(right), "{text}");
        }
        for wrong in [
            "",
            "behind",
            "back,",
            "none,back",
            "front,back",
            "all,front",
        ] {
            assert!(wrong.parse::<Culling>().is_err(), "{wrong}");
        }
    }
}
