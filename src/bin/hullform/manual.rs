//! The manual's table of options is that of the program itself.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use clap::{Arg, Command, CommandFactory};

const FILE: &str = "src/manual/command_line.md";
const BEGIN: &str = "<!-- generated: options -->\n";
const END: &str = "\n<!-- end -->";

/// An option as it is written: `-o`, `--output FILE`.
fn spelling(arg: &Arg) -> String {
    let short = arg.get_short().map(|short| format!("`-{short}`, "));
    let long = arg.get_long().expect("options have long names");
    let names = arg.get_value_names().unwrap_or_default();
    let value = match names.first().map(|name| name.as_str()) {
        Some(name) if takes_value(arg) && !name.is_empty() => format!(" {name}"),
        _ => String::new(),
    };
    format!("{}`--{long}{value}`", short.unwrap_or_default())
}

fn takes_value(arg: &Arg) -> bool {
    arg.get_num_args().is_some_and(|count| count.takes_values())
}

/// What it does, what it may be, and what it is unless said.
fn meaning(arg: &Arg) -> String {
    let mut text = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let possible = arg.get_possible_values();
    let shown = takes_value(arg) && !arg.is_hide_possible_values_set();
    if shown && !possible.is_empty() {
        let value = |value: &clap::builder::PossibleValue| match value.get_help() {
            Some(help) => format!("`{}`: {help}", value.get_name()),
            None => format!("`{}`", value.get_name()),
        };
        let values: Vec<String> = possible.iter().map(value).collect();
        write!(text, " ({})", values.join("; ")).expect("a string takes all");
    }
    let defaults = arg.get_default_values().iter();
    let defaults: Vec<_> = defaults.map(|value| value.to_string_lossy()).collect();
    if takes_value(arg) && !defaults.is_empty() {
        write!(text, " [default: {}]", defaults.join(",")).expect("a string takes all");
    }
    text.replace('|', "\\|").replace('\n', " ")
}

/// A row an option and meaning; `of` are the subcommands that have it.
fn table() -> String {
    let mut command = crate::Arguments::command();
    command.build();
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut of: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    let own = ["help", "version"]; // of every program
    let visible =
        |arg: &&Arg| !arg.is_hide_set() && arg.get_long().is_some_and(|name| !own.contains(&name));
    let mut add = |arg: &Arg, whose: String| {
        let row = (spelling(arg), meaning(arg));
        let number = rows.iter().position(|known| *known == row);
        let number = number.unwrap_or_else(|| {
            rows.push(row);
            rows.len() - 1
        });
        of.entry(number).or_default().push(whose);
    };
    let mut subcommands: Vec<(String, &Command)> = Vec::new();
    for subcommand in command.get_subcommands() {
        let name = subcommand.get_name();
        subcommands.push((name.into(), subcommand));
        let nested = subcommand.get_subcommands();
        subcommands.extend(nested.map(|nested| (format!("{name} {}", nested.get_name()), nested)));
    }
    for (name, subcommand) in &subcommands {
        let inherited = |arg: &&Arg| arg.is_global_set();
        for arg in subcommand
            .get_arguments()
            .filter(visible)
            .filter(|arg| !inherited(arg))
        {
            add(arg, format!("`{name}`"));
        }
    }
    for arg in command.get_arguments().filter(visible) {
        add(arg, "all".into());
    }
    let mut text = String::from("| option | of | meaning |\n| --- | --- | --- |\n");
    for (number, (spelling, meaning)) in rows.iter().enumerate() {
        let spelling = spelling.replace('|', "\\|");
        writeln!(
            text,
            "| {spelling} | {} | {meaning} |",
            of[&number].join(", ")
        )
        .expect("a string takes all");
    }
    text
}

#[test]
fn the_manual_has_the_options_of_the_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    let old = std::fs::read_to_string(&path).expect("the manual is there");
    let (before, rest) = old.split_once(BEGIN).expect("it has a table of options");
    let (_, after) = rest.split_once(END).expect("the table has an end");
    let new = format!("{before}{BEGIN}\n{}{END}{after}", table());
    if std::env::var_os("HULLFORM_UPDATE").is_some() {
        std::fs::write(&path, new).expect("the manual can be written");
    } else {
        assert!(
            old == new,
            "{FILE} is old; HULLFORM_UPDATE=1 cargo test --bin hullform writes it anew"
        );
    }
}
