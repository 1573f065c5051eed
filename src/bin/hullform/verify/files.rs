//! The files that results go to, opened before the work begins.

use super::{Arguments, known};
use crate::model;
use crate::options::Json;
use crate::output::{self, Contents, Pending, junit};
use hullform::Result;
use hullform::conformance::{Lists, Report};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// CSV, JUnit's XML, JSON, and deqp-runner's three lists, those that are asked for.
pub struct Files([Option<Pending>; 6]);

impl Files {
    pub fn create(arguments: &Arguments) -> Result<Files> {
        let lists = arguments.expectations.as_deref().map(known::files);
        let lists = lists.unwrap_or_default();
        let models = arguments.models.iter();
        let models = models.filter_map(|model| model::file(Some(model)));
        let reads: Vec<&Path> = models.chain(lists.iter().map(PathBuf::as_path)).collect();
        let json = match &arguments.json {
            Some(Json::File(path)) => Some(path.clone()),
            _ => None,
        };
        let exported = arguments.export_expectations.as_ref();
        let exported = exported.map(|name| Lists::files(name).map(PathBuf::from));
        let [fails, flakes, skips] = exported.map_or([None, None, None], |files| files.map(Some));
        let export = "--export-expectations";
        let asked = [
            ("--csv", arguments.csv.clone()),
            ("--junit", arguments.junit.clone()),
            ("--json", json),
            (export, fails),
            (export, flakes),
            (export, skips),
        ];
        let writes = asked.iter();
        let writes = writes.filter_map(|(option, path)| Some((*option, path.as_deref()?)));
        let mut made = output::create(&reads, &writes.collect::<Vec<_>>())?.into_iter();
        Ok(Files(asked.map(|(_, path)| path.and_then(|_| made.next()))))
    }

    pub fn write(self, report: &Report, json: &Value) -> Result<()> {
        let lists = Lists::of(report);
        let contents: [&Contents; 6] = [
            &|out| out.write_all(report.csv().as_bytes()),
            &|out| junit::write(out, report),
            &|out| writeln!(out, "{json:#}"),
            &|out| out.write_all(lists.fails.as_bytes()),
            &|out| out.write_all(lists.flakes.as_bytes()),
            &|out| out.write_all(lists.skips.as_bytes()),
        ];
        let files = self.0.into_iter().zip(contents);
        output::write(files.filter_map(|(file, contents)| Some((file?, contents))))
    }
}
