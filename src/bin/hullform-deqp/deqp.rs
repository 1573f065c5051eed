//! What dEQP prints and logs beside the cases' own words.

/// The release, as dEQP tells its commit.
pub const RELEASE: &str = concat!("hullform-", env!("CARGO_PKG_VERSION"));

/// The release's number, which nobody compares.
pub const RELEASE_ID: u32 = 0;

/// The platform: none, all pictures are kept in memory.
pub const TARGET: &str = "Headless";

/// The type of every case.
pub const CASE_TYPE: &str = "SelfValidate";
