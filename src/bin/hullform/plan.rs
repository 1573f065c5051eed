//! `hullform plan`: how the faces of a model are planned.

use crate::options::Global;
use crate::{model, print, progress};
use clap::Args;
use hullform::mesh::ControlMesh;
use hullform::{Error, Result};
use serde_json::{Map, Value};

/// Options of `plan`.
#[derive(Args)]
pub struct Arguments {
    /// OBJ file, or builtin:NAME
    model: String,
    /// Deepest level of a plan's quadtree, 1 to 10
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u8).range(1..=10))]
    max_level: u8,
    /// Refine along creases instead of evaluating them directly
    #[arg(long)]
    no_direct_creases: bool,
}

/// Plans the model's faces and prints what came out.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    let mesh = model::load(Some(&arguments.model))?;
    let facts = progress::during("planning", |_| facts(&mesh, arguments))?;
    if global.json {
        print(&format!("{:#}", Value::Object(facts)))
    } else {
        print(&as_text(&facts))
    }
}

/// A line a fact, the values in a column.
fn as_text(facts: &Map<String, Value>) -> String {
    let width = facts.keys().map(String::len).max().unwrap_or(0);
    let line = |(name, value): (&String, &Value)| {
        let name = name.replace('_', " ");
        match value {
            Value::String(text) => format!("{name:width$}  {text}"),
            value => format!("{name:width$}  {value}"),
        }
    };
    facts.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// What there is to tell about the plans of `mesh`, in the order to tell it.
fn facts(mesh: &ControlMesh, arguments: &Arguments) -> Result<Map<String, Value>> {
    // SEAM: the planner goes here.
    let _ = (mesh, arguments.max_level, arguments.no_direct_creases);
    Err(Error::Refused("planning is not built yet".into()))
}
