//! Draws whose commands are in a buffer: the engine uploads them, and may edit them on the device, to leave out what it culls.

use std::ops::Range;

use ash::vk;

use crate::error::{Error, Misuse, Result};
use crate::frame::{Batch, Decides, Draw};
use crate::gpu::draw::Constants;
use crate::gpu::{Drawing, Layout, Pipelines};

/// The commands of one call at most (Vulkan spec, "Required Limits", `maxDrawIndirectCount` where there is more than one).
pub(super) const MOST_COMMANDS: u32 = 65_535;

/// The draw commands of a batch, as Vulkan reads them: for each [`Draw`] one an instance of the model, in the order of their views. An engine that culls
/// sets `instance_count` of the instance's command, of each draw, to 0.
#[derive(Clone, Debug)]
pub enum IndirectCommands {
    /// Of [`Draw::Patches`].
    Patches(Vec<vk::DrawIndirectCommand>),
    /// Of [`Draw::Pattern`].
    Patterns(Vec<vk::DrawIndexedIndirectCommand>),
}

impl IndirectCommands {
    /// Bytes from one command to the next.
    pub fn stride(&self) -> u32 {
        let size = match self {
            IndirectCommands::Patches(_) => size_of::<vk::DrawIndirectCommand>(),
            IndirectCommands::Patterns(_) => size_of::<vk::DrawIndexedIndirectCommand>(),
        };
        size as u32
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            IndirectCommands::Patches(commands) => commands.len(),
            IndirectCommands::Patterns(commands) => commands.len(),
        }
    }

    /// Whether there is none: of no views.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What is uploaded.
    pub fn words(&self) -> Vec<u32> {
        match self {
            IndirectCommands::Patches(commands) => {
                let words = |c: &vk::DrawIndirectCommand| {
                    [
                        c.vertex_count,
                        c.instance_count,
                        c.first_vertex,
                        c.first_instance,
                    ]
                };
                commands.iter().flat_map(words).collect()
            }
            IndirectCommands::Patterns(commands) => {
                let words = |c: &vk::DrawIndexedIndirectCommand| {
                    [
                        c.index_count,
                        c.instance_count,
                        c.first_index,
                        c.vertex_offset as u32,
                        c.first_instance,
                    ]
                };
                commands.iter().flat_map(words).collect()
            }
        }
    }
}

/// A batch, and where its commands are.
#[derive(Clone, Copy, Debug)]
pub struct Indirect<'a> {
    /// The batch.
    pub batch: Batch<'a>,
    /// A buffer with usage `INDIRECT_BUFFER`.
    pub buffer: vk::Buffer,
    /// Where in it the first command stands: a multiple of 4.
    pub offset: u64,
}

impl Drawing<'_> {
    /// The commands of a batch with these views, for [`cmd_draw_indirect`](Self::cmd_draw_indirect) with the same.
    ///
    /// # Errors
    /// As [`cmd_draw`](Self::cmd_draw); [`Misuse::DecidedByDevice`] where the device decides, which makes its commands itself.
    pub fn indirect_commands(
        &self,
        layout: &Layout,
        pipelines: &Pipelines,
        views: Range<u32>,
        batch: Batch<'_>,
    ) -> Result<IndirectCommands> {
        self.check(pipelines, &views, batch)?;
        check_commands(batch)?;
        let repeated = views.len() as u32 / pipelines.eyes();
        // Without the feature commands begin with instance 0, and each is a draw with constants of its own.
        let step = u32::from(layout.enabled().multi_draw_indirect);
        let pass = &self.tables.prepared().passes[batch.pass()];
        let (mut of_patches, mut of_patterns) = (Vec::new(), Vec::new());
        for draw in batch.draws() {
            for number in 0..repeated {
                match *draw {
                    Draw::Patches {
                        per_instance,
                        instances,
                        ..
                    } => of_patches.push(vk::DrawIndirectCommand {
                        vertex_count: self.slot.vertices_of(pass, per_instance),
                        instance_count: instances,
                        first_vertex: 0,
                        first_instance: step * number * instances,
                    }),
                    Draw::Pattern {
                        pattern, instances, ..
                    } => {
                        let indices = self.slot.patterns().place(pattern);
                        of_patterns.push(vk::DrawIndexedIndirectCommand {
                            index_count: indices.len() as u32,
                            instance_count: instances,
                            first_index: indices.start,
                            vertex_offset: 0,
                            first_instance: step * number * instances,
                        });
                    }
                    // Refused above.
                    Draw::Decided { .. } => {}
                }
            }
        }
        Ok(match of_patterns.is_empty() {
            true => IndirectCommands::Patches(of_patches),
            false => IndirectCommands::Patterns(of_patterns),
        })
    }

    /// As [`cmd_draw`](Self::cmd_draw), with the commands of [`indirect_commands`](Self::indirect_commands) for the same batch and views, read from a
    /// buffer when the device draws. One call a draw where the device has `multiDrawIndirect` and `drawIndirectFirstInstance`, else one an instance.
    ///
    /// # Errors
    /// As [`indirect_commands`](Self::indirect_commands).
    ///
    /// # Safety
    /// As [`cmd_draw`](Self::cmd_draw). The commands are in the buffer, as they were made but for their `instance_count`, which may be 0, and visible to
    /// `INDIRECT_COMMAND_READ` in the stage `DRAW_INDIRECT`.
    pub unsafe fn cmd_draw_indirect(
        &self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        layout: &Layout,
        pipelines: &Pipelines,
        views: Range<u32>,
        indirect: Indirect<'_>,
    ) -> Result<()> {
        let batch = indirect.batch;
        let pipeline = self.check(pipelines, &views, batch)?;
        check_commands(batch)?;
        if views.is_empty() {
            return Ok(());
        }
        let eyes = pipelines.eyes();
        let constants = Constants {
            layout: pipelines.layout_or(layout),
            eyes,
        };
        let repeated = views.len() as u32 / eyes;
        let together = match layout.enabled().multi_draw_indirect {
            true => MOST_COMMANDS,
            false => 1,
        };
        // SAFETY: this function's contract.
        unsafe { self.cmd_bind(device, cmd, constants.layout, pipeline, batch) };
        let mut commands = Commands {
            buffer: indirect.buffer,
            offset: indirect.offset,
        };
        for draw in batch.draws() {
            let mut first = 0;
            while first < repeated {
                let count = together.min(repeated - first);
                // With the feature the commands themselves tell their instances.
                let view = match together {
                    1 => views.start + first * eyes,
                    _ => views.start,
                };
                let frame = self.frame(eyes, view, batch, draw);
                // SAFETY: as above.
                unsafe {
                    constants.cmd_push(device, cmd, &frame);
                    commands.cmd_next(device, cmd, draw, count);
                }
                first += count;
            }
        }
        Ok(())
    }
}

/// # Errors
/// [`Misuse::DecidedByDevice`].
fn check_commands(batch: Batch<'_>) -> Result<()> {
    if batch.list().options().decides == Decides::Host {
        return Ok(());
    }
    let what = "commands of the engine's own";
    Err(Error::Misuse(Misuse::DecidedByDevice { what }))
}

/// Where the next commands stand.
struct Commands {
    buffer: vk::Buffer,
    offset: u64,
}

impl Commands {
    /// # Safety
    /// As [`Drawing::cmd_draw_indirect`], with everything bound; there are as many commands.
    unsafe fn cmd_next(
        &mut self,
        device: &ash::Device,
        cmd: vk::CommandBuffer,
        draw: &Draw,
        count: u32,
    ) {
        let &mut Commands { buffer, offset } = self;
        let stride = match draw {
            Draw::Patches { .. } | Draw::Decided { .. } => {
                let stride = size_of::<vk::DrawIndirectCommand>() as u32;
                // SAFETY: this function's contract.
                unsafe { device.cmd_draw_indirect(cmd, buffer, offset, count, stride) };
                stride
            }
            Draw::Pattern { .. } => {
                let stride = size_of::<vk::DrawIndexedIndirectCommand>() as u32;
                // SAFETY: this function's contract.
                unsafe { device.cmd_draw_indexed_indirect(cmd, buffer, offset, count, stride) };
                stride
            }
        };
        self.offset += u64::from(count) * u64::from(stride);
    }
}
