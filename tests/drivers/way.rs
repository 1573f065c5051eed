//! What an engine does and no program of ours: poses, edits between frames, levels by the device, uploads that are handed over. It is started
//! anew on the failing driver, by the name of its test.

use hullform::Result;
use hullform::gpu::{
    Cut, Decides, Fill, Handover, Residence, Shading, SurfaceOptions, TessellatedSurface, View,
};
use hullform::host::{Bench, Device, Instance, OffscreenTarget, Owned, Style};
use hullform::mesh::{Model, builtin};
use hullform::method::{Displacement, METHODS, MethodOptions};
use hullform::plan::Database;
use hullform::tessellation::Spacing;

const AT: Cut = Cut {
    level: 2.0,
    spacing: Spacing::Equal,
};
const FILL: Fill = Fill::Solid(Shading::Lit);

const NOWHERE: View = View {
    clip_from_model: [[0.0; 4]; 4],
    eye: [0.0; 3],
    displacement: Displacement {
        height: 0.0,
        frequency: 0.0,
    },
};

/// The name by which the test is started.
pub const NAME: &str = "way::an_engines_way";

#[test]
#[ignore = "it is started on the failing driver"]
fn an_engines_way() {
    if let Err(error) = way() {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn way() -> Result<()> {
    let instance = Instance::new(false)?;
    let device = Device::open(&instance, None)?;
    let bench = Bench::new(OffscreenTarget::new(&device, 16, 16, 1)?)?;
    for decides in [Decides::Host, Decides::Device] {
        for residence in Residence::ALL {
            drawn(
                &bench,
                SurfaceOptions {
                    decides,
                    residence,
                    ..SurfaceOptions::default()
                },
            )?;
        }
    }
    edited(&bench)
}

/// A model, drawn in two poses.
fn drawn(bench: &Bench, options: SurfaceOptions) -> Result<()> {
    let model = Model::new(builtin("cube")?);
    let prepared = METHODS[0].prepare(&model, MethodOptions::default())?;
    let workarounds = &bench.device().info().workarounds;
    let mut loaded = bench.load(&model, prepared, workarounds, options)?;
    loaded.picture(AT, FILL)?;
    let moved = model.positions().into_iter().map(|p| (0.5 * p).to_array());
    loaded.replace_positions(&moved.collect::<Vec<_>>())?;
    loaded.picture(AT, FILL)?;
    Ok(())
}

/// A surface that is handed over once, and then edited between frames.
fn edited(bench: &Bench) -> Result<()> {
    let (device, layout) = (bench.device(), bench.layout());
    let mut model = Model::new(builtin("cube")?);
    let database = Database::default();
    let mut editable = METHODS[0].prepare_editable(&model, MethodOptions::default(), &database)?;
    let workarounds = &device.info().workarounds;
    let options = SurfaceOptions::default();
    // SAFETY: all of one live device, here and below.
    let mut surface = unsafe {
        let (raw, memory) = (device.raw(), &mut device.memory());
        let made = TessellatedSurface::editable(
            raw,
            memory,
            layout,
            &model,
            &editable,
            workarounds,
            options,
        );
        Owned::new(device, made?)
    };
    let family = device.queue_family();
    let handover = Handover {
        from: family,
        to: family,
    };
    device.submit(|cmd| {
        // SAFETY: recording, outside of a render pass; what follows is submitted when this has been waited for.
        let released = unsafe { surface.cmd_upload_and_release(device.raw(), cmd, handover) };
        assert!(released, "nothing is on the device yet");
        Ok(())
    })?;
    device.submit(|cmd| {
        // SAFETY: as above.
        unsafe { surface.cmd_acquire(device.raw(), cmd, handover) };
        Ok(())
    })?;
    // SAFETY: the upload has been waited for.
    unsafe { surface.finish_upload(device.raw(), &mut device.memory()) };
    for sharpness in [2.0, 0.5] {
        let [a, b] = model.topology().edges()[0].vertices;
        let mut edit = model.mesh().edit();
        edit.crease(a, b, sharpness).position(7, [0.4; 3]);
        let changes = model.apply(&edit)?;
        let update = editable.update(&model, &changes, &database)?;
        // SAFETY: every submission has been waited for.
        unsafe {
            let (raw, memory) = (device.raw(), &mut device.memory());
            let retired = surface.edit(raw, memory, layout, &editable, &update)?;
            retired.destroy(raw, memory);
        }
        surface.move_vertices(&[(7, model.position(7).to_array())])?;
        device.submit(|cmd| {
            // SAFETY: recording, outside of a render pass.
            unsafe { surface.cmd_upload(device.raw(), cmd) };
            Ok(())
        })?;
        frame(bench, &surface)?;
    }
    Ok(())
}

/// Draws a surface as seen from nowhere.
fn frame(bench: &Bench, surface: &TessellatedSurface) -> Result<()> {
    let list = surface.draw_list(AT, None)?;
    let style = Style::new(surface.options(), AT.spacing, FILL);
    let pipelines = bench.pipelines(surface.prepared(), style)?;
    let device = bench.device();
    device.submit(|cmd| {
        // SAFETY: recording on the device that made everything, in the order that the calls ask for.
        unsafe {
            let raw = device.raw();
            surface.cmd_prepare(raw, cmd, &[NOWHERE])?;
            bench.target().begin(cmd, [0.0; 4]);
            for batch in list.batches() {
                surface.cmd_draw(raw, cmd, bench.layout(), &pipelines, 0..1, batch)?;
            }
            bench.target().end(cmd);
            surface.cmd_read_back(raw, cmd);
        }
        Ok(())
    })?;
    surface.counters().map(|_| ())
}
