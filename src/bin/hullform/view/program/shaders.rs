//! Shaders that are compiled anew when their text changes. The last good ones stay until others are whole.

use std::path::PathBuf;

use hullform::Result;

use super::{Done, Program};

/// The text of shaders, and how far what was made of it has come.
#[derive(Default)]
pub(super) struct Live {
    /// None where nothing is compiled.
    pub folder: Option<PathBuf>,
    /// Whether the text has changed since it was read.
    pub due: bool,
    /// Whether it is being compiled.
    pub running: bool,
    /// Counts changes of the shaders that fill caches.
    pub filling: u64,
    /// What is wrong with the text as it is.
    pub error: Option<String>,
}

/// What came of shaders: none where nothing was compiled.
pub struct Compiled {
    #[cfg(feature = "shaderc")]
    glsl: std::sync::Arc<hullform::gpu::shaders::Glsl>,
    #[cfg(feature = "shaderc")]
    pipelines: crate::view::context::Pipes,
    /// What has changed of the modules that are in use.
    #[cfg(feature = "shaderc")]
    changed: Vec<String>,
    #[cfg(feature = "shaderc")]
    fills: bool,
}

impl Program {
    /// Compiles shaders whose text has changed, once there is something that is drawn with them.
    #[cfg(feature = "shaderc")]
    pub(super) fn compile(&mut self) -> Result<()> {
        use crate::view::context::Context;
        use crate::view::stage::{Stage, style};
        use crate::view::workers::Entrance;
        use hullform::gpu::{CachePipelines, Pipelines, Residence, shaders};

        let Some(folder) = self.live.folder.clone() else {
            return Ok(());
        };
        if !self.live.due || self.live.running || self.stage.parts.is_empty() {
            return Ok(());
        }
        self.live.due = false;
        self.live.running = true;
        let drawn = self.stage.parts.iter().flat_map(|part| &part.sides);
        let wanted: Vec<_> = drawn
            .flat_map(|drawn| {
                let fills = Stage::fills(&self.viewer).into_iter();
                fills.map(|fill| {
                    let prepared = drawn.surface.prepared().clone();
                    (prepared, style(drawn, &self.viewer, fill))
                })
            })
            .collect();
        let work = move |entrance: &Entrance<Context>| {
            let glsl = shaders::Glsl::read(&folder)?;
            let context = entrance.enter()?;
            let of = context.shaders().modules;
            let from: &dyn shaders::Modules = &glsl;
            let other = |name: &String| of.fingerprint(name) != from.fingerprint(name);
            let mut changed = Vec::new();
            let mut fills = false;
            for (prepared, style) in &wanted {
                if style.residence == Residence::Cache {
                    let own: Vec<String> =
                        CachePipelines::modules(prepared).filter(other).collect();
                    for name in &own {
                        from.module(name)?;
                    }
                    fills |= !own.is_empty();
                    changed.extend(own);
                }
                let names = Pipelines::modules(prepared, &style.options(context.mould()));
                changed.extend(names.into_iter().filter(other));
            }
            changed.sort();
            changed.dedup();
            Ok(Compiled {
                pipelines: context.remake(&wanted, from)?,
                glsl: std::sync::Arc::new(glsl),
                changed,
                fills,
            })
        };
        self.workers.start("shaders", work, Done::Compiled)
    }

    /// Without the compiler nothing is compiled.
    #[cfg(not(feature = "shaderc"))]
    pub(super) fn compile(&mut self) -> Result<()> {
        Ok(())
    }

    /// Goes over to shaders that are whole, or tells what is wrong with them.
    pub(super) fn take_compiled(&mut self, result: Result<Compiled>) -> Result<()> {
        self.live.running = false;
        match result {
            Ok(compiled) => {
                self.live.error = None;
                self.exchange(compiled);
                Ok(())
            }
            Err(error) if error.is_of_device() => Err(error),
            Err(error) => {
                self.live.error = Some(error.to_string());
                Ok(())
            }
        }
    }

    #[cfg(feature = "shaderc")]
    fn exchange(&mut self, compiled: Compiled) {
        let Compiled {
            glsl,
            pipelines,
            changed,
            fills,
        } = compiled;
        if !changed.is_empty() {
            let words = match changed.as_slice() {
                [one] => format!("{one} is compiled anew"),
                [first, ..] => format!("{first} and {} more are compiled anew", changed.len() - 1),
                [] => String::new(),
            };
            self.viewer.notices.tell(words);
        }
        self.live.filling += u64::from(fills);
        let old = self.context.exchange(glsl, pipelines);
        self.workers.let_go(old);
        self.failed = Default::default();
        (self.fresh, self.drawn) = (true, None);
    }

    #[cfg(not(feature = "shaderc"))]
    fn exchange(&mut self, _: Compiled) {}
}
