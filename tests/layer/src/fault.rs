//! What goes wrong, as the layer reads it from the environment.

use std::fmt;
use std::str::FromStr;

use ash::vk;

/// What goes wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Fault {
    /// Nothing: calls are counted.
    #[default]
    Nothing,
    /// Calls return an error and do nothing.
    Fail {
        /// The names of functions; several share one count.
        calls: Vec<String>,
        /// Which of the calls in a process, from 1.
        occurrence: u32,
        /// What it returns.
        code: vk::Result,
        /// Whether all calls after it fail too; of a device that is lost, also every other call that can say so.
        lasting: bool,
    },
    /// Draws are recorded only in part.
    Lose(Lost),
    /// All formats of a display encode what is written to them.
    Encode,
    /// A fault of those processes alone among whose arguments is this one.
    Only(String, Box<Fault>),
}

/// The draws that get lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lost {
    /// All.
    All,
    /// The one of this number in a process, from 1.
    One(u32),
    /// Half of the vertices or instances of the one of this number.
    Half(u32),
}

impl Fault {
    /// A call that fails once.
    pub fn once(call: &str, occurrence: u32, code: vk::Result) -> Fault {
        Fault::Fail {
            calls: vec![call.into()],
            occurrence,
            code,
            lasting: false,
        }
    }

    /// The same, of processes that have an argument.
    pub fn only(self, argument: &str) -> Fault {
        Fault::Only(argument.into(), self.into())
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::Nothing => write!(f, "nothing"),
            Fault::Fail {
                calls,
                occurrence,
                code,
                lasting,
            } => {
                let how = if *lasting { "lasting" } else { "once" };
                let (calls, code) = (calls.join("+"), code.as_raw());
                write!(f, "fail {how} {occurrence} {code} {calls}")
            }
            Fault::Encode => write!(f, "encode"),
            Fault::Lose(Lost::All) => write!(f, "lose all"),
            Fault::Lose(Lost::One(number)) => write!(f, "lose one {number}"),
            Fault::Lose(Lost::Half(number)) => write!(f, "lose half {number}"),
            Fault::Only(argument, fault) => write!(f, "only {argument} {fault}"),
        }
    }
}

impl FromStr for Fault {
    type Err = String;

    fn from_str(text: &str) -> Result<Fault, String> {
        let unknown = || format!("'{text}' is no fault");
        let words: Vec<&str> = text.split(' ').collect();
        let number = |word: &str| word.parse::<u32>().map_err(|_| unknown());
        Ok(match words[..] {
            ["nothing"] => Fault::Nothing,
            ["fail", how, occurrence, code, calls] => Fault::Fail {
                calls: calls.split('+').map(String::from).collect(),
                occurrence: number(occurrence)?,
                code: vk::Result::from_raw(code.parse().map_err(|_| unknown())?),
                lasting: how == "lasting",
            },
            ["encode"] => Fault::Encode,
            ["lose", "all"] => Fault::Lose(Lost::All),
            ["lose", "one", which] => Fault::Lose(Lost::One(number(which)?)),
            ["lose", "half", which] => Fault::Lose(Lost::Half(number(which)?)),
            ["only", argument, ..] => {
                let rest = words[2..].join(" ");
                Fault::Only(argument.into(), Box::new(rest.parse()?))
            }
            _ => return Err(unknown()),
        })
    }
}
