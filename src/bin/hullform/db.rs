//! `hullform db` and `--db`: the file that plans are kept in from run to run.

use crate::options::{self, Global};
use crate::{places, print, print_json};
use clap::{Args, Subcommand};
use hullform::error::Place;
use hullform::plan::Database;
use hullform::plan::database::{FileState, GREATEST_BYTES, Kind};
use hullform::{Error, Result};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Options of `db`.
#[derive(Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Tell where the database is and what it has
    Info,
    /// Read every entry, and tell what is damaged
    Verify,
    /// Write it anew without what is damaged or repeated, and of the rest the latest entries
    Prune {
        /// The size of the file, at most: bytes, or with KiB or MiB
        #[arg(long, value_name = "N", default_value = "128MiB", value_parser = options::bytes)]
        max_bytes: u64,
    },
    /// Print every entry's surroundings, and what its plan takes, as JSON
    Export,
}

/// What `--db` says.
static ASKED: OnceLock<Option<PathBuf>> = OnceLock::new();

/// Remembers what `--db` says, for whoever prepares a model.
pub fn remember(global: &Global) {
    let _ = ASKED.set(global.db.clone());
}

/// The database of this run, opened when it is first asked for.
///
/// # Errors
/// As [`Database::open`], of a file that was asked for; where the usual one cannot be had, plans are kept in memory.
pub fn database() -> Result<&'static Arc<Database>> {
    static OPENED: OnceLock<Arc<Database>> = OnceLock::new();
    if let Some(opened) = OPENED.get() {
        return Ok(opened);
    }
    let asked = ASKED.get().and_then(Option::as_deref);
    let database = match asked {
        Some(path) if path.as_os_str() == "none" => Database::default(),
        Some(path) => Database::open(path)?,
        None => usual().map_or_else(Database::default, |path| {
            Database::open(path).unwrap_or_else(|error| {
                tracing::warn!("{error}; plans are kept in memory");
                Database::default()
            })
        }),
    };
    Ok(OPENED.get_or_init(|| Arc::new(database)))
}

/// Where the database is unless it is said.
fn usual() -> Option<PathBuf> {
    Some(places::caches()?.join("plans.db"))
}

/// Does what is asked with the database's file.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    let path = match &global.db {
        Some(path) if path.as_os_str() == "none" => None,
        Some(path) => Some(path.clone()),
        None => usual(),
    };
    let Some(path) = path else {
        return Err(Error::Option {
            option: "--db",
            problem: "there is no file to look at".into(),
            remedy: "name one".into(),
        });
    };
    if !path.exists() {
        let place = Place::File(path.display().to_string());
        let remedy = "name another with --db, or plan a model, which begins one";
        return Err(Error::input(place, "there is no database", remedy));
    }
    let database = Database::open(&path)?;
    let state = database.state().unwrap_or_default();
    match arguments.what {
        What::Info => report(&path, &state, global),
        What::Verify => {
            let state = database.verify().unwrap_or_default();
            report(&path, &state, global)?;
            match state.unsound > 0 || state.lost_bytes > 0 {
                true => Err(Error::Refused(format!(
                    "{}: {} entries make no sense, and {} bytes belong to none; they cost nothing but their room, and `hullform db prune` takes them out",
                    path.display(),
                    state.unsound,
                    state.lost_bytes
                ))),
                false => Ok(()),
            }
        }
        What::Prune { max_bytes } => {
            database.prune(max_bytes.min(GREATEST_BYTES))?;
            report(&path, &database.state().unwrap_or_default(), global)
        }
        What::Export => export(&database),
    }
}

fn report(path: &std::path::Path, state: &FileState, global: &Global) -> Result<()> {
    let kinds = Kind::ALL.iter().zip(state.entries);
    let entries: Map<String, Value> = kinds
        .map(|(kind, count)| (kind.name().into(), count.into()))
        .collect();
    if global.prints_json() {
        return print_json(&json!({
            "path": path.display().to_string(),
            "version": hullform::plan::database::VERSION,
            "bytes": state.bytes,
            "greatest_bytes": GREATEST_BYTES,
            "lost_bytes": state.lost_bytes,
            "repeated": state.repeated,
            "unsound": state.unsound,
            "entries": entries,
        }));
    }
    let mut lines = vec![
        format!("{:22}  {}", "path", path.display()),
        format!("{:22}  {}", "bytes", state.bytes),
        format!("{:22}  {}", "lost bytes", state.lost_bytes),
        format!("{:22}  {}", "repeated", state.repeated),
        format!("{:22}  {}", "unsound", state.unsound),
    ];
    let of_kind = entries
        .iter()
        .map(|(kind, count)| format!("  {kind:20}  {count}"));
    lines.push("entries".into());
    lines.extend(of_kind);
    print(&lines.join("\n"))
}

fn export(database: &Database) -> Result<()> {
    let entries = database.entries().into_iter().map(|(key, entry)| {
        let plan = entry.plan();
        json!({
            "kind": key.kind.name(),
            "max_level": key.options.max_level,
            "direct_creases": key.options.direct_creases,
            "configuration": key.configuration.words(),
            "ring": plan.ring_size,
            "nodes": plan.nodes.len(),
            "stencils": plan.stencils.len(),
        })
    });
    print_json(&json!({ "entries": entries.collect::<Vec<_>>() }))
}
