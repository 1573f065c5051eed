//! Cases that are not run on some devices, as dEQP keeps them (`tcuWaiverUtil.cpp`):
//!
//! ```xml
//! <waiver_list>
//!   <waiver vendor="llvmpipe" url="https://.../issues/1">
//!     <renderer_list><r>llvmpipe*</r></renderer_list>
//!     <waived_tests><t>hullform.scale.primitive_id.*</t></waived_tests>
//!   </waiver>
//! </waiver_list>
//! ```
//!
//! The vendor is the driver's name, `r` the device's, and all may have stars.

use crate::selection::pattern;
use glob::Pattern;
use hullform::conformance::{Case, Cases, Expectation, Expectations, Opened, Status, deqp};
use hullform::error::Place;
use hullform::{Error, Result};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::path::Path;

/// What is waived on a device: patterns of names, with the reasons.
type Waived = Vec<(Pattern, String)>;

/// The cases of these that are waived on a device, as ones that are not run.
pub fn read(path: &Path, device: &Opened, cases: &[Case]) -> Result<Expectations> {
    let text = std::fs::read_to_string(path).map_err(|source| Error::File {
        path: path.into(),
        source,
    })?;
    let waived = parse(&text, &device.driver.name, &device.name).map_err(|problem| {
        let remedy = "write dEQP's XML: waiver elements with lists of r and t";
        Error::input(Place::File(path.display().to_string()), problem, remedy)
    })?;
    let row = |case: &Case| {
        Some(Expectation {
            reason: reason(&waived, &case.name)?.into(),
            cases: Cases::Named(case.name.clone()),
            status: Status::Skip,
        })
    };
    Ok(Expectations {
        name: path.display().to_string(),
        rows: cases.iter().filter_map(row).collect(),
    })
}

/// Why a case is waived.
fn reason<'a>(waived: &'a Waived, case: &str) -> Option<&'a str> {
    let path = deqp::path(case);
    let mut own = waived.iter().filter(|(cases, _)| cases.matches(&path));
    own.next().map(|(_, url)| url.as_str())
}

/// The waiver that is being read.
#[derive(Default)]
struct Open {
    url: String,
    is_of_vendor: bool,
    is_of_device: bool,
    cases: Vec<Pattern>,
}

fn parse(text: &str, vendor: &str, renderer: &str) -> std::result::Result<Waived, String> {
    let mut reader = Reader::from_str(text);
    let mut waived = Waived::new();
    let mut open: Option<Open> = None;
    let mut element = Vec::new();
    loop {
        let event = reader.read_event().map_err(|error| error.to_string())?;
        match event {
            Event::Start(start) => {
                element = start.local_name().as_ref().to_vec();
                if element == b"waiver" {
                    open = Some(opened(&start, vendor)?);
                }
            }
            Event::Text(text) => {
                let text = text.decode().map_err(|error| error.to_string())?;
                match (&mut open, element.as_slice()) {
                    (Some(open), b"r") => open.is_of_device |= pattern(&text).matches(renderer),
                    (Some(open), b"t") => open.cases.push(pattern(&text)),
                    _ => {}
                }
            }
            Event::End(end) => {
                element.clear();
                if end.local_name().as_ref() == b"waiver" {
                    let ours = open
                        .take()
                        .filter(|open| open.is_of_vendor && open.is_of_device);
                    let cases = ours.into_iter().flat_map(|Open { url, cases, .. }| {
                        cases.into_iter().map(move |case| (case, url.clone()))
                    });
                    waived.extend(cases);
                }
            }
            Event::Eof if open.is_some() => return Err("it ends in the middle of a waiver".into()),
            Event::Eof => return Ok(waived),
            _ => {}
        }
    }
}

fn opened(start: &BytesStart<'_>, vendor: &str) -> std::result::Result<Open, String> {
    let value = |name: &str| -> std::result::Result<Option<String>, String> {
        let found = start.try_get_attribute(name);
        let found = found.map_err(|error| error.to_string())?;
        let text = found.map(|attribute| String::from_utf8_lossy(&attribute.value).into_owned());
        Ok(text)
    };
    let own = value("vendor")?;
    Ok(Open {
        url: value("url")?.unwrap_or_default(),
        is_of_vendor: own.is_some_and(|own| pattern(&own).matches(vendor)),
        ..Default::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_waiver_counts_on_its_devices_alone() {
        let text = "<waiver_list><waiver vendor=\"llvm*\" url=\"https://x/1\"><description>d</description>\
            <renderer_list><r>llvmpipe (LLVM 15*</r></renderer_list>\
            <waived_tests><t>hullform.a.*</t><t>hullform.b.c.d</t></waived_tests></waiver></waiver_list>";
        let waivers = parse(text, "llvmpipe", "llvmpipe (LLVM 15.0.6, 256 bits)");
        let waivers = waivers.expect("it is well formed");
        assert_eq!(reason(&waivers, "a.x.y"), Some("https://x/1"));
        assert_eq!(reason(&waivers, "b.c.d"), Some("https://x/1"));
        assert_eq!(reason(&waivers, "b.c.dd"), None);
        for (vendor, device) in [("radv", "llvmpipe (LLVM 15.0)"), ("llvmpipe", "another")] {
            let others = parse(text, vendor, device).expect("it is well formed");
            assert_eq!(reason(&others, "a.x.y"), None);
        }
        assert!(parse("<waiver_list><waiver vendor=\"x\">", "x", "y").is_err());
    }
}
