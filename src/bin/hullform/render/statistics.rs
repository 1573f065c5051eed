//! What `render` tells about a drawing.

use hullform::Result;
use hullform::gpu::{Decides, DrawList};
use serde_json::{Value, json};

use super::Scene;
use crate::deciding;
use crate::drawing::Drawing;
use crate::gpu::Gpu;

/// What `--stats` writes.
pub(super) fn of(
    gpu: &Gpu,
    scene: &Scene<'_>,
    drawing: &Drawing<'_>,
    list: &DrawList,
    counted: Option<[u64; 3]>,
    [plan_seconds, first_frame]: [f64; 2],
) -> Result<Value> {
    let info = gpu.device.info();
    let plans = drawing.prepared().plans.clone().unwrap_or_default();
    let patches: usize = drawing
        .prepared()
        .passes
        .iter()
        .map(|pass| pass.patches.len())
        .sum();
    let ring_batches = list.batches().filter(|batch| batch.points() > 0).count();
    let counters = drawing.surface().counters()?;
    let options = drawing.surface().options();
    let decided = (options.decides == Decides::Device)
        .then(|| drawing.surface().outcome(list, 0..1))
        .transpose()?;
    Ok(json!({
        "device": info.name,
        "driver": format!("{} {}", info.driver.name, info.driver.info),
        "method": drawing.prepared().method,
        "level": scene.cutting.cut.level,
        "backend": options.backend.name(),
        "residence": options.residence.name(),
        "spacing": scene.cutting.cut.spacing.name(),
        "patches": { "total": patches, "regular": plans.regular, "irregular": plans.irregular },
        "plans": plans.plans,
        "draws": list.batches().map(|batch| batch.draws().len()).sum::<usize>(),
        "batches": ring_batches,
        "workarounds": gpu.workarounds.iter().map(|row| row.name).collect::<Vec<_>>(),
        "pipeline_statistics": counted.map(|[patches, evaluations, clipping]| json!({
            "control_shader_patches": patches,
            "evaluation_invocations": evaluations,
            "clipping_primitives": clipping,
        })),
        "decided_by_device": decided.map(|outcome| deciding::as_json(&outcome)),
        "ring": {
            "bytes": scene.ring_bytes,
            "points_computed": counters.points,
            "overflows": counters.overflows,
        },
        "seconds": {
            "load": scene.load_seconds,
            "plan": plan_seconds,
            "upload": drawing.upload_seconds,
            "first_frame": first_frame,
        },
    }))
}
