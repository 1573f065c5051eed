//! What came out for a model, method, level and backend; as JSON, CSV and text.

use std::io::{self, Write};

use hullform::gpu::Outcome;
use serde_json::{Map, Value, json};

use super::yardstick;

/// The work of a frame, counted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Runs of the evaluating shader.
    pub evaluations: u64,
    /// Patches that control shaders ran for; None where devices do not count.
    pub control_patches: Option<u64>,
    /// Control points that were computed: by control shaders, into a cache, or before all patches.
    pub points: u64,
    /// Products of a weight and a point in these.
    pub products: u64,
    /// Draw commands.
    pub draws: u64,
    /// Barriers between batches.
    pub barriers: u64,
    /// What was decided about patches, over all passes.
    pub decided: Outcome,
}

/// A row of the result.
#[derive(Clone, Debug)]
pub struct Row {
    pub model: String,
    pub method: &'static str,
    pub level: f32,
    pub backend: &'static str,
    pub residence: &'static str,
    pub is_static: bool,
    /// Who decides about patches.
    pub decides: &'static str,
    pub passes: u32,
    pub instances: u32,
    /// Seconds of all threads of the process for each frame; empty where the system does not tell.
    pub cpu: Vec<f64>,
    /// Seconds between the device's timestamps for each frame; empty where it has none.
    pub gpu: Vec<f64>,
    /// Whether the device is the CPU.
    pub is_software: bool,
    pub ratio_to_flat: Option<f64>,
    pub work: Work,
    pub ring_bytes: u64,
    pub device_bytes: u64,
    pub storage_buffers: u32,
}

fn least(seconds: &[f64]) -> Option<f64> {
    seconds.iter().copied().reduce(f64::min)
}

fn median(seconds: &[f64]) -> Option<f64> {
    let mut sorted = seconds.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

fn milliseconds(seconds: Option<f64>) -> Option<f64> {
    seconds.map(|seconds| 1e3 * seconds)
}

impl Row {
    /// The least time that counts: of the processor where it draws, else of the device.
    pub fn seconds(&self) -> Option<f64> {
        let device = least(&self.gpu).filter(|_| !self.is_software);
        device.or(least(&self.cpu)).or(least(&self.gpu))
    }

    /// As the files have it.
    pub fn json(&self) -> Value {
        json!({
            "model": self.model,
            "method": self.method,
            "level": self.level,
            "residence": self.residence,
            "backend": self.backend,
            "instances": self.instances,
            "passes": self.passes,
            "static": self.is_static,
            "cpu_ms": milliseconds(least(&self.cpu)),
            "cpu_ms_median": milliseconds(median(&self.cpu)),
            "gpu_ms": milliseconds(least(&self.gpu)),
            "gpu_ms_median": milliseconds(median(&self.gpu)),
            "ratio_to_flat": self.ratio_to_flat,
            "decides": self.decides,
            "patches": self.work.decided.drawn,
            "control_patches": self.work.control_patches,
            "culled_frustum": self.work.decided.frustum,
            "culled_back": self.work.decided.back,
            "culled_small": self.work.decided.small,
            "triangles": self.work.decided.triangles,
            "evaluation_invocations": self.work.evaluations,
            "points_computed": self.work.points,
            "multiply_adds": self.work.products,
            "ring_bytes": self.ring_bytes,
            "device_bytes": self.device_bytes,
            "draws": self.work.draws,
            "barriers": self.work.barriers,
            "storage_buffers": self.storage_buffers,
        })
    }

    /// Whether another row differs in the method alone.
    fn is_comparable(&self, other: &Row) -> bool {
        self.model == other.model
            && self.level == other.level
            && self.backend == other.backend
            && self.passes == other.passes
            && self.instances == other.instances
    }
}

/// Fills in how much longer each takes than the yardstick.
pub fn set_ratios(rows: &mut [Row]) {
    let flat: Vec<Row> = rows
        .iter()
        .filter(|row| row.method == yardstick().name)
        .cloned()
        .collect();
    for row in rows {
        let beside = flat.iter().find(|flat| flat.is_comparable(row));
        let own = row.seconds();
        let ratio = own.zip(beside.and_then(Row::seconds));
        row.ratio_to_flat = ratio.map(|(own, flat)| own / flat);
    }
}

/// The rows of a report, with device and driver in front.
pub fn write_csv(out: &mut dyn Write, report: &Value) -> io::Result<()> {
    let rows = report["rows"].as_array().into_iter().flatten();
    let rows: Vec<&Map<String, Value>> = rows.filter_map(Value::as_object).collect();
    let Some(first) = rows.first() else {
        return Ok(());
    };
    let names: Vec<&str> = first.keys().map(String::as_str).collect();
    writeln!(out, "device,driver,{}", names.join(","))?;
    for row in rows {
        let known = [&report["device"], &report["driver"]];
        let values: Vec<String> = known.into_iter().chain(row.values()).map(cell).collect();
        writeln!(out, "{}", values.join(","))?;
    }
    Ok(())
}

/// A value as RFC 4180 has it.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) if text.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// A line a row.
pub fn as_text(title: &str, rows: &[Row]) -> String {
    let mut lines = vec![
        title.to_string(),
        format!(
            "{:16} {:10} {:>5} {:12} {:9} {:>9} {:>9} {:>9} {:>7} {:>9} {:>11} {:>10} {:>12} {:>5} {:>8}",
            "model",
            "method",
            "level",
            "backend",
            "residence",
            "cpu ms",
            "median",
            "gpu ms",
            "x flat",
            "patches",
            "evaluations",
            "points",
            "multiplies",
            "draws",
            "barriers"
        ),
    ];
    let number = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.2}"));
    lines.extend(rows.iter().map(|row| {
        format!(
            "{:16} {:10} {:>5} {:12} {:9} {:>9} {:>9} {:>9} {:>7} {:>9} {:>11} {:>10} {:>12} {:>5} {:>8}",
            row.model,
            row.method,
            row.level,
            row.backend,
            row.residence,
            number(milliseconds(least(&row.cpu))),
            number(milliseconds(median(&row.cpu))),
            number(milliseconds(least(&row.gpu))),
            number(row.ratio_to_flat),
            row.work.decided.drawn,
            row.work.evaluations,
            row.work.points,
            row.work.products,
            row.work.draws,
            row.work.barriers
        )
    }));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &'static str, cpu: &[f64], gpu: &[f64], is_software: bool) -> Row {
        Row {
            model: "a, \"b\"".into(),
            method,
            level: 8.0,
            backend: "tessellator",
            residence: "ring",
            is_static: false,
            decides: "host",
            passes: 1,
            instances: 1,
            cpu: cpu.to_vec(),
            gpu: gpu.to_vec(),
            is_software,
            ratio_to_flat: None,
            work: Work::default(),
            ring_bytes: 0,
            device_bytes: 0,
            storage_buffers: 0,
        }
    }

    #[test]
    fn ratios_go_by_the_processor_where_it_draws_and_by_the_device_elsewhere() {
        for (is_software, right) in [(true, 3.0), (false, 5.0)] {
            let mut rows = [
                row(yardstick().name, &[2.0, 1.0], &[1.0], is_software),
                row("another", &[3.0, 4.0], &[6.0, 5.0], is_software),
            ];
            set_ratios(&mut rows);
            assert_eq!(rows[0].ratio_to_flat, Some(1.0));
            assert_eq!(rows[1].ratio_to_flat, Some(right));
        }
    }

    #[test]
    fn lines_of_values_have_as_many_as_the_header() {
        let rows = [row("another", &[], &[1.0], true)];
        let rows: Vec<Value> = rows.iter().map(Row::json).collect();
        let report = json!({ "device": "x, y", "driver": "z", "rows": rows });
        let mut bytes = Vec::new();
        write_csv(&mut bytes, &report).expect("memory does not fail");
        let text = String::from_utf8(bytes).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[1].starts_with("\"x, y\",z,\"a, \"\"b\"\"\",another,8.0,ring,"));
        // Two commas are in quotes.
        assert_eq!(
            lines[0].matches(',').count() + 2,
            lines[1].matches(',').count()
        );
    }
}
