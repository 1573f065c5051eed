//! `hullform devices`: every Vulkan device, what it lacks for us, and the workarounds that apply.

use crate::gpu::check;
use crate::options::Global;
use crate::{print, print_json};
use ash::vk;
use hullform::gpu::Workaround;
use hullform::host::{Device, DeviceInfo, Instance, devices};
use hullform::{Error, Result};
use serde_json::{Value, json};

/// Lists the devices; with `--device` the chosen one alone. Fails with "no suitable device" if none will do.
pub fn run(global: &Global) -> Result<()> {
    let instance = Instance::new(global.validation)?;
    let mut listed = devices(&instance)?;
    if let Some(selector) = &global.device {
        // Opened, so that what this says is what the others will do.
        let chosen = Device::open(&instance, Some(selector))?;
        listed.retain(|device| device.index == chosen.info().index);
    }
    report(&listed, global)?;
    check(&instance)?;
    if listed.iter().any(DeviceInfo::is_suitable) {
        Ok(())
    } else {
        let reason = "the list above says what each one lacks";
        Err(Error::NoDevice(reason.into()))
    }
}

fn report(devices: &[DeviceInfo], global: &Global) -> Result<()> {
    if global.prints_json() {
        let devices: Vec<_> = devices
            .iter()
            .map(|device| as_json(device, global))
            .collect();
        return print_json(&json!({ "devices": devices }));
    }
    let texts: Vec<_> = devices
        .iter()
        .map(|device| as_text(device, global))
        .collect();
    print(&texts.join("\n"))
}

fn active<'a>(device: &'a DeviceInfo, global: &Global) -> &'a [&'static Workaround] {
    if global.no_workarounds {
        &[]
    } else {
        &device.workarounds
    }
}

fn as_text(device: &DeviceInfo, global: &Global) -> String {
    let kind = device.kind_name();
    let mut lines = vec![
        format!("{}: {} ({kind})", device.index, device.name),
        format!("   driver: {} {}", device.driver.name, device.driver.info),
        format!("   Vulkan: {}", version(device.support.api_version)),
    ];
    if device.is_suitable() {
        lines.push("   suitable".into());
    }
    let missing = device.missing.iter();
    lines.extend(missing.map(|what| format!("   lacks: {what}")));
    for workaround in active(device, global) {
        let Workaround {
            name, reason, case, ..
        } = workaround;
        lines.push(format!("   workaround {name}: {reason} (case {case})"));
    }
    lines.join("\n")
}

fn as_json(device: &DeviceInfo, global: &Global) -> Value {
    let workarounds = active(device, global).iter().map(|workaround| {
        json!({
            "name": workaround.name,
            "reason": workaround.reason,
            "seen": workaround.seen,
            "case": workaround.case,
        })
    });
    let optional = device.support.optional;
    json!({
        "index": device.index,
        "name": device.name,
        "type": device.kind_name(),
        "vulkan": version(device.support.api_version),
        "driver": {
            "id": device.driver.id.as_raw(),
            "name": device.driver.name,
            "info": device.driver.info,
            "version": device.driver.version.to_string(),
        },
        "suitable": device.is_suitable(),
        "missing": device.missing,
        "optional": {
            "fill_mode_non_solid": optional.fill_mode_non_solid,
            "wide_lines": optional.wide_lines,
            "pipeline_statistics_query": optional.pipeline_statistics_query,
            "sample_rate_shading": optional.sample_rate_shading,
            "maintenance4": optional.maintenance4,
        },
        "workarounds": workarounds.collect::<Vec<_>>(),
    })
}

fn version(packed: u32) -> String {
    let (major, minor) = (vk::api_version_major(packed), vk::api_version_minor(packed));
    format!("{major}.{minor}.{}", vk::api_version_patch(packed))
}
