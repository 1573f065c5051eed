use super::*;

#[test]
fn repetitions_that_differ_are_a_flake() {
    let pass = || Finding::pass("fine");
    assert_eq!(together(vec![pass(), pass()]).status, Status::Pass);
    let mixed = together(vec![pass(), Finding::fail("odd")]);
    assert_eq!(mixed.status, Status::Flake);
    assert!(mixed.measured.contains("once Fail: odd"));
}

#[test]
fn the_message_is_told_and_not_the_hint_behind_it() {
    let panic =
        "noise\nthread 'main' panicked at src/a.rs:1:2:\nindex out of bounds:\nthe len is 0\n";
    let backtrace = "stack backtrace:\n   0: rust_begin_unwind\n   1: main\n";
    let hint = "note: Some details are omitted, run with `RUST_BACKTRACE=full`\n";
    let second = "thread 'main' panicked at library/core:2:3:\npanic in a destructor\n";
    let wanted = "thread 'main' panicked at src/a.rs:1:2: index out of bounds: the len is 0";
    for tail in ["", hint, backtrace, &[backtrace, hint, second].concat()] {
        let message = last_message(&[panic, tail].concat());
        assert_eq!(message.as_deref(), Some(wanted));
    }
    let other = last_message("lavapipe: assertion failed\n\n");
    assert_eq!(other.as_deref(), Some("lavapipe: assertion failed"));
    assert_eq!(last_message(" \n"), None);
}

#[test]
fn only_the_last_words_are_kept() {
    let kept = Mutex::default();
    let said: Vec<u8> = (0..=99_999u32).map(|i| i as u8).collect();
    keep_last(&said[..], &kept);
    let kept = kept.into_inner().expect("nobody panicked");
    assert_eq!(kept, said[said.len() - LAST_WORDS..]);
}

#[cfg(unix)]
mod processes {
    use super::*;
    use crate::conformance::Expectations;

    /// A worker that is a shell script: `answer` runs for each request, with the case's name in `$name`.
    fn run(answer: &str, limit: Duration) -> Report {
        let script = format!(
            "echo 'hullform-verify ready'; while read -r run name; do echo 'hullform-verify begin'; {answer}; done"
        );
        let worker = move || {
            let mut command = Command::new("sh");
            command.args(["-c", &script]);
            command
        };
        let runner = Runner {
            worker: &worker,
            expectations: &Expectations::default(),
            options: RunOptions {
                repeat: 1,
                jobs: 2,
                limit: Some(limit),
            },
        };
        let case = |name: &str| Case::new(name, "rule", "source", |_| Ok(Finding::pass("")));
        let cases: Vec<Case> = ["g.s.a", "g.s.bad", "g.s.b", "g.s.c"].map(case).into();
        let mut heard = 0;
        let report = runner.run(&cases, &AtomicBool::new(false), |_| heard += 1);
        assert_eq!(heard, 4);
        report
    }

    fn statuses(report: &Report) -> Vec<Status> {
        report.results.iter().map(|result| result.status).collect()
    }

    const PASS: &str = "echo noise; echo 'hullform-verify end Pass fine'";

    #[test]
    fn a_crash_ends_one_case() {
        let crash = format!("case $name in *bad) echo oops >&2; kill -9 $$;; esac; {PASS}");
        let report = run(&crash, Duration::from_secs(20));
        let [pass, crash] = [Status::Pass, Status::Crash];
        assert_eq!(statuses(&report), [pass, crash, pass, pass]);
        assert!(report.results[1].measured.contains("signal"));
    }

    #[test]
    fn a_hang_ends_one_case() {
        let hang = format!("case $name in *bad) exec sleep 60;; esac; {PASS}");
        let report = run(&hang, Duration::from_secs(2));
        let [pass, late] = [Status::Pass, Status::Timeout];
        assert_eq!(statuses(&report), [pass, late, pass, pass]);
    }

    /// It is neither dead nor alive: its output is closed, but it does not end.
    #[test]
    fn a_worker_that_closes_its_output_is_a_crash() {
        let closes = format!("case $name in *bad) exec sleep 60 >&-;; esac; {PASS}");
        let report = run(&closes, Duration::from_secs(20));
        let [pass, crash] = [Status::Pass, Status::Crash];
        assert_eq!(statuses(&report), [pass, crash, pass, pass]);
    }

    /// It answers, and dies before the next request: nobody else pays for that.
    #[test]
    fn a_late_death_costs_no_case() {
        let dies = format!("{PASS}; exit 3");
        let report = run(&dies, Duration::from_secs(20));
        assert_eq!(statuses(&report), [Status::Pass; 4]);
    }

    #[test]
    fn a_worker_that_never_starts_loses_no_result() {
        let runner = Runner {
            worker: &|| {
                let mut command = Command::new("sh");
                command.args(["-c", "echo no driver >&2; exit 1"]);
                command
            },
            expectations: &Expectations::default(),
            options: RunOptions {
                repeat: 1,
                jobs: 1,
                limit: None,
            },
        };
        let case = Case::new("g.s.a", "rule", "source", |_| Ok(Finding::pass("")));
        let report = runner.run(&[case], &AtomicBool::new(false), |_| ());
        assert_eq!(report.results[0].status, Status::Crash);
        assert!(report.results[0].measured.contains("no driver"));
    }

    /// The program was removed, or there is no memory for another process.
    #[test]
    fn a_worker_that_is_not_there_loses_no_result() {
        let runner = Runner {
            worker: &|| Command::new("/no/such/program"),
            expectations: &Expectations::default(),
            options: RunOptions {
                repeat: 1,
                jobs: 2,
                limit: None,
            },
        };
        let case = |name: &str| Case::new(name, "rule", "source", |_| Ok(Finding::pass("")));
        let still = AtomicBool::new(false);
        let report = runner.run(&["g.s.a", "g.s.b", "g.s.c"].map(case), &still, |_| ());
        assert_eq!(statuses(&report), [Status::Crash; 3]);
        let words = &report.results[2].measured;
        assert!(words.starts_with("no worker could be started: "), "{words}");
        let device = runner.device(&still).expect("nobody stops it");
        let lost = device.expect_err("there is none");
        assert_eq!(lost.status, Status::Crash);
    }
}
