//! The suite in the words of dEQP (VK-GL-CTS) and of deqp-runner, for harnesses that know these: names of cases, and statuses.

use crate::conformance::Status;

/// What stands before all names of cases, as `dEQP-VK` does before those of dEQP.
pub const PACKAGE: &str = "hullform";

/// A case's name behind the package's.
pub fn path(case: &str) -> String {
    format!("{PACKAGE}.{case}")
}

/// The case of a name that may have the package's before it.
pub fn case(path: &str) -> &str {
    let own = path.strip_prefix(PACKAGE);
    own.and_then(|rest| rest.strip_prefix('.')).unwrap_or(path)
}

/// How dEQP calls it (`qpTestLog.c`) when a case ended so by itself.
pub fn status(found: Status) -> &'static str {
    match found {
        Status::Pass => "Pass",
        Status::Skip => "NotSupported",
        Status::Warn => "QualityWarning",
        Status::Crash => "Crash",
        Status::DeviceLost => "DeviceLost",
        Status::Timeout => "Timeout",
        // Only a list of expectations makes the last two, and it does not judge what dEQP prints.
        Status::Fail | Status::Flake | Status::ExpectedFail | Status::UnexpectedImprovement => {
            "Fail"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        assert_eq!(case(&path("scale.a.b")), "scale.a.b");
        assert_eq!(case("scale.a.b"), "scale.a.b");
        assert_eq!(case("hullforms.a.b"), "hullforms.a.b");
    }
}
