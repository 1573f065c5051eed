//! Results of the conformance suite in the XML that JUnit introduced and every CI reads.

use hullform::conformance::{CaseResult, Report, Status};
use quick_junit::{NonSuccessKind, Report as Xml, TestCase, TestCaseStatus, TestSuite};
use std::io::{self, Write};
use std::time::Duration;

/// A suite a group. Crashes and time-outs are errors, other unexpected results are failures.
pub fn write(out: &mut dyn Write, report: &Report) -> io::Result<()> {
    let mut xml = Xml::new("hullform verify");
    for group in report.groups() {
        let mut suite = TestSuite::new(group);
        let own = report.results.iter();
        suite.add_test_cases(own.filter(|result| result.group() == group).map(case));
        xml.add_test_suite(suite);
    }
    let text = xml.to_string().map_err(io::Error::other)?;
    out.write_all(text.as_bytes())
}

fn case(result: &CaseResult) -> TestCase {
    let status = match result.status {
        Status::Pass | Status::Warn | Status::ExpectedFail => TestCaseStatus::success(),
        Status::Skip => TestCaseStatus::skipped(),
        Status::Crash | Status::DeviceLost | Status::Timeout => {
            TestCaseStatus::non_success(NonSuccessKind::Error)
        }
        Status::Fail | Status::Flake | Status::UnexpectedImprovement => {
            TestCaseStatus::non_success(NonSuccessKind::Failure)
        }
    };
    let mut case = TestCase::new(result.name.as_str(), status);
    case.set_classname(result.group());
    case.set_time(Duration::from_secs_f64(result.seconds.max(0.0)));
    case.status
        .set_message(result.line())
        .set_type(result.status.to_string());
    case.set_system_out(said(result));
    case
}

/// What was measured, and why something else than a pass was expected.
fn said(result: &CaseResult) -> String {
    match &result.reason {
        Some(reason) => format!("{}\nexpected: {reason}", result.line()),
        None => result.line(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statuses_become_what_a_ci_understands() {
        let result = |name: &str, status| CaseResult {
            name: name.into(),
            status,
            found: status,
            measured: "1 < 2 & \u{1}".into(),
            reason: None,
            seconds: 1.5,
        };
        let report = Report {
            results: vec![
                result("a.s.pass", Status::Pass),
                result("a.s.fail", Status::Fail),
                result("b.s.crash", Status::Crash),
                result("b.s.skip", Status::Skip),
            ],
        };
        let mut bytes = Vec::new();
        write(&mut bytes, &report).expect("memory does not fail");
        let text = String::from_utf8(bytes).expect("text");
        assert!(text.starts_with("<?xml"));
        assert_eq!(text.matches("<testsuite ").count(), 2);
        assert_eq!(text.matches("<testcase ").count(), 4);
        assert_eq!(text.matches("<failure ").count(), 1);
        assert_eq!(text.matches("<error ").count(), 1);
        assert_eq!(text.matches("<skipped").count(), 1);
        assert!(text.contains("1 &lt; 2 &amp; ") && !text.contains('\u{1}'));
    }
}
