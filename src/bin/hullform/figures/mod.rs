//! `hullform figures`: the tables and figures of the papers, made again, with a verdict on each.

mod curves;
mod figure;
mod list;
mod make;
mod page;
mod panels;
mod run;

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use hullform::{Error, Result};
use serde_json::{Value, json};

use crate::options::{Global, Json};
use crate::output::{self, Contents};
use crate::{print, print_json, progress};
use figure::{Figure, Made, Verdict};
use list::figures;

/// Options of `figures`.
#[derive(Args)]
pub struct Arguments {
    /// Which: a year, as 2016, a year and a kind, as 2016.table, or one, as 2011.figure.8; `methods` compares all methods [default: all]
    #[arg(value_name = "ID")]
    ids: Vec<String>,
    /// Folder to write them into, with a page that shows them all; made if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Folder with the papers' models: bigguy.obj, monsterfrog.obj, armorguy.obj [default: none; what needs one is unavailable, or on a built-in shape]
    #[arg(long, value_name = "FOLDER")]
    models: Option<PathBuf>,
    /// Leave out what takes long, and measure fewer frames
    #[arg(long)]
    quick: bool,
    /// Write results as JSON into a file; without FILE print them
    #[arg(long, id = "json", value_name = "FILE", num_args = 0..=1, default_missing_value = "-", value_parser = Json::anywhere)]
    json: Option<Json>,
}

/// Makes figures, prints a line of each, and writes the page.
pub fn run(arguments: &Arguments, global: &Global) -> Result<()> {
    let figures = chosen(&arguments.ids)?;
    check_models(arguments.models.as_deref())?;
    make_folder(&arguments.output)?;
    let [page, facts, table] =
        ["index.html", "figures.json", "figures.csv"].map(|name| arguments.output.join(name));
    let json = match &arguments.json {
        Some(Json::File(path)) => Some(("--json", path.as_path())),
        _ => None,
    };
    let own = [&page, &facts, &table].map(|path| ("--output", path.as_path()));
    let writes: Vec<_> = own.into_iter().chain(json).collect();
    let files = output::create(&[], &writes)?;
    let prints_json = arguments.json == Some(Json::Print) || global.prints_json();
    let workshop = make::Workshop::new(arguments, global)?;
    let mut made = Vec::new();
    for figure in figures {
        let one = progress::during(figure.id, |_| workshop.make(figure));
        if !prints_json {
            print(&line(&one))?;
        }
        made.push(one);
    }
    let rows: Vec<Value> = made.iter().flat_map(Made::rows).collect();
    let report = json!({ "quick": arguments.quick, "figures": rows });
    let as_page: &Contents = &|out| out.write_all(page::html(&made, arguments.quick).as_bytes());
    let as_json: &Contents = &|out| writeln!(out, "{report:#}");
    let as_table: &Contents = &|out| write_table(out, &rows);
    let contents = [as_page, as_json, as_table].into_iter();
    let contents = contents.chain(json.map(|_| as_json));
    output::write(files.into_iter().zip(contents))?;
    if prints_json {
        print_json(&report)
    } else {
        print(&format!("{}\n{}", summary(&made), output::wrote(&page)))
    }
}

/// The figures whose ids are named, or begin with what is named; all where nothing is.
fn chosen(ids: &[String]) -> Result<Vec<&'static Figure>> {
    let is_of = |figure: &Figure, id: &str| {
        let rest = figure.id.strip_prefix(id);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    if let Some(id) = ids.iter().find(|id| !figures().any(|f| is_of(f, id))) {
        let known: Vec<&str> = figures().map(|figure| figure.id).collect();
        return Err(Error::Option {
            option: "ID",
            problem: format!("there is no figure '{id}'"),
            remedy: format!("choose from {}", known.join(", ")),
        });
    }
    let wanted = |figure: &&Figure| ids.is_empty() || ids.iter().any(|id| is_of(figure, id));
    Ok(figures().filter(wanted).collect())
}

fn check_models(folder: Option<&Path>) -> Result<()> {
    match folder.filter(|folder| !folder.is_dir()) {
        None => Ok(()),
        Some(folder) => Err(Error::Option {
            option: "--models",
            problem: format!("{} is no folder", folder.display()),
            remedy: "name the folder that has bigguy.obj, monsterfrog.obj and armorguy.obj".into(),
        }),
    }
}

fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|source| Error::File {
        path: folder.into(),
        source,
    })
}

/// A figure in a line.
fn line(made: &Made) -> String {
    let line = format!(
        "{:16} {:12} {:6.1} s  {}",
        made.id,
        made.verdict.word(),
        made.seconds,
        made.verdict.reason()
    );
    line.trim_end().into()
}

fn summary(made: &[Made]) -> String {
    let count = |verdict: fn(&Verdict) -> bool| made.iter().filter(|m| verdict(&m.verdict)).count();
    format!(
        "{} reproduced, {} that differ, {} unavailable, in {:.0} s",
        count(|verdict| *verdict == Verdict::Reproduced),
        count(|verdict| matches!(verdict, Verdict::Differs(_))),
        count(|verdict| matches!(verdict, Verdict::Unavailable(_))),
        made.iter().map(|made| made.seconds).sum::<f64>()
    )
}

/// A row a printed number.
fn write_table(out: &mut dyn io::Write, rows: &[Value]) -> io::Result<()> {
    const COLUMNS: [&str; 7] = [
        "id", "paper", "what", "printed", "measured", "verdict", "reason",
    ];
    writeln!(out, "{}", COLUMNS.join(","))?;
    for row in rows {
        let cell = |column: &&str| match &row[*column] {
            Value::Null => String::new(),
            Value::String(text) => format!("\"{}\"", text.replace('"', "\"\"")),
            other => other.to_string(),
        };
        let cells: Vec<String> = COLUMNS.iter().map(cell).collect();
        writeln!(out, "{}", cells.join(","))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn figures_are_found_by_the_beginnings_of_their_ids() {
        let count = |ids: &[&str]| {
            let ids: Vec<String> = ids.iter().map(|&id| id.into()).collect();
            chosen(&ids).map(|figures| figures.len())
        };
        assert_eq!(count(&["2011.figure.8"]).ok(), Some(1));
        assert_eq!(count(&["2016.table", "2016.table.2"]).ok(), Some(3));
        assert_eq!(count(&[]).ok(), Some(figures().count()));
        let unknown = count(&["2016.figure"; 1]).and(count(&["2016.fig"]));
        assert_eq!(unknown.expect_err("there is none").exit_code(), 2);
        let ids: HashSet<&str> = figures().map(|figure| figure.id).collect();
        assert_eq!(ids.len(), figures().count());
    }
}
