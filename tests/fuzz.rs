//! Readers of files against what nobody wrote: OBJ texts, and databases of plans whose sums are right and whose contents are not.
//!
//! Each target changes inputs of its own at random, and keeps those that it is about to try in the build folder: whatever ends the process is found there. What was
//! found is a named test in `bad_input.rs` or `database.rs`. `HULLFORM_FUZZ_SECONDS=600 cargo test --test fuzz` looks for longer, from another beginning each time.
#![cfg(feature = "host")]

use glam::Vec2;
use hullform::mesh::{Model, builtin, read_obj_bytes};
use hullform::method::{MethodOptions, Prepared, prepare_by_default, prepare_by_default_with};
use hullform::plan::database::VERSION;
use hullform::plan::{Database, PlanOptions};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

/// So many rounds, or as many as the time allows that was asked for.
fn rounds(least: u32, mut round: impl FnMut(&mut Random)) {
    let asked = std::env::var("HULLFORM_FUZZ_SECONDS").ok();
    let seconds = asked.map(|text| {
        text.parse()
            .expect("HULLFORM_FUZZ_SECONDS is a number of seconds")
    });
    let beginning = match seconds {
        None => 1,
        Some(_) => {
            let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            now.expect("it is later than 1970").as_nanos() as u64
        }
    };
    println!("beginning with {beginning}");
    let mut random = Random(beginning);
    let end = seconds.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let mut done = 0;
    while end.map_or(done < least, |end| Instant::now() < end) {
        round(&mut random);
        done += 1;
    }
    println!("{done} rounds");
}

/// Where an input is kept while it is tried.
fn kept(name: &str, bytes: &[u8]) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, bytes).expect("room for a file");
    path
}

/// Evaluates a few points of every patch.
fn evaluate(model: &Model, prepared: &Prepared) {
    let controls = prepared.controls(model.positions());
    for pass in &prepared.passes {
        for patch in 0..pass.patches.len() {
            for uv in [[0.0, 0.0], [1.0, 0.5], [0.3, 0.6], [0.01, 0.99], [0.5, 1.0]] {
                pass.evaluate(&controls, patch, Vec2::from(uv));
            }
        }
    }
}

const TEXTS: [&str; 4] = [
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 .5e0\nvt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1 4/2/1\nf 2 5 6 3\nt crease 2/1/0 1 2 3.5\nt corner 1/1/0 0 2\n",
    "# a cube's corner\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 4 3 2 1\nf 1 2 6 5\nf -7 -3 -1 -4\nt interpolateboundary 1/0/0 2\nt creasemethod 0/0/1 chaikin\nt crease 2/1/0 0 1 10\nt hole 1/0/0 2\n",
    "v 0 0 0\nv 4 0 0\nv 5 3 0\nv 2 5 \\\n 1\nv -1 3 0\nf 1 2 3 4 5\nt smoothtriangles 0/0/1 smooth\nt facevaryinginterpolateboundary 1/0/0 3\n",
    "mtllib none.mtl\no one\ng all\ns 1\nv 1e-3 -2E+2 +3.25\nv nan 0 0\nv 1 2\nv 3 4 5 6\nl 1 2\nf 1 2 3\n",
];

/// What is put in the place of something else.
const PIECES: [&str; 16] = [
    "0",
    "-1",
    "4294967295",
    "99999999999999999999",
    "1e308",
    "-1e-320",
    "nan",
    "inf",
    "//",
    "1//1",
    "\\\n",
    "\n",
    " ",
    "f 1 2 3 4\n",
    "t crease 2/1/0 0 1 2\n",
    "v 0 0 0\n",
];

/// Changes a text somewhere.
fn change_text(random: &mut Random, text: &mut Vec<u8>) {
    let at = random.below(text.len() + 1);
    let end = at + random.below((text.len() - at).min(24) + 1);
    match random.below(5) {
        0 => drop(text.drain(at..end)),
        1 => {
            let piece = text[at..end].to_vec();
            let to = random.below(text.len() + 1);
            text.splice(to..to, piece);
        }
        2 => {
            let piece = random.of(&PIECES).as_bytes().to_vec();
            text.splice(at..end, piece);
        }
        3 => {
            let other = random.of(&TEXTS).as_bytes();
            let from = random.below(other.len());
            let length = random.below(60).min(other.len() - from);
            text.splice(at..at, other[from..from + length].to_vec());
        }
        _ => {
            if let Some(byte) = text.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
    }
}

#[test]
fn any_text_is_read_or_refused_in_words_and_what_is_read_can_be_drawn() {
    let (mut read, mut refused) = (0, 0);
    rounds(3000, |random| {
        let mut text = random.of(&TEXTS).as_bytes().to_vec();
        for _ in 0..=random.below(6) {
            change_text(random, &mut text);
        }
        kept("fuzz.obj", &text);
        let mesh = match read_obj_bytes("fuzz.obj", &text) {
            Ok(mesh) => mesh,
            Err(error) => {
                let words = error.to_string();
                assert!(
                    words.starts_with("fuzz.obj") && words.contains("; "),
                    "{words}"
                );
                assert_eq!(error.exit_code(), 2, "{words}");
                refused += 1;
                return;
            }
        };
        read += 1;
        let model = Model::new(mesh);
        let options = MethodOptions::from(PlanOptions {
            max_level: 2,
            ..PlanOptions::default()
        });
        if let Ok((prepared, _)) = prepare_by_default(&model, options) {
            evaluate(&model, &prepared);
        }
    });
    println!("{read} were read, {refused} refused");
    assert!(read > 0 && refused > 0);
}

/// A record's key and entry.
type Record = [Vec<u32>; 2];

fn records(bytes: &[u8]) -> Vec<Record> {
    let words: Vec<u32> = bytes[24..]
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes(word.try_into().expect("four bytes")))
        .collect();
    let (mut rest, mut records) = (&words[..], Vec::new());
    while let &[_, all, key, _, ref behind @ ..] = rest {
        let (own, next) = behind.split_at(all as usize);
        let (key, entry) = own.split_at(key as usize);
        records.push([key.to_vec(), entry.to_vec()]);
        rest = next;
    }
    records
}

/// The bytes of records, with the sums that they must have.
fn file(header: &[u8], records: &[Record]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    for [key, entry] in records {
        let counts = [(key.len() + entry.len()) as u32, key.len() as u32];
        let counted: Vec<u8> = counts
            .iter()
            .flat_map(|count| count.to_le_bytes())
            .collect();
        let words = key.iter().chain(entry);
        let words: Vec<u8> = words.flat_map(|word| word.to_le_bytes()).collect();
        let sum = crc32fast::hash(&[&counted[..], &words].concat());
        bytes.extend((0x4e41_4c00 + VERSION).to_le_bytes());
        bytes.extend(counted);
        bytes.extend(sum.to_le_bytes());
        bytes.extend(words);
    }
    bytes
}

/// Changes a record somewhere.
fn change_record(random: &mut Random, records: &mut [Record]) {
    let other = random.of(records).clone();
    let [key, entry] = {
        let number = random.below(records.len());
        &mut records[number]
    };
    // Other keys are mostly keys of nothing that is asked for.
    let words = if random.below(8) == 0 { key } else { entry };
    let at = random.below(words.len());
    match random.below(8) {
        0 => drop(words.drain(at..(at + random.below(4)).min(words.len()))),
        1 => words.insert(at, *random.of(&[0, 1, 4, u32::MAX])),
        2 => *entry_of(words, at) ^= 1 << random.below(32),
        3 => *entry_of(words, at) = *random.of(&[0, 1, 15, 0xffff, 0x1_0000, u32::MAX]),
        4 => *entry_of(words, at) = (*random.of(&[f32::NAN, f32::INFINITY, -1.0, 1e30])).to_bits(),
        5 => *entry_of(words, at) = entry_of(words, at).wrapping_add(1),
        6 => *entry_of(words, at) = entry_of(words, at).wrapping_sub(1),
        // The plan of another.
        _ => *words = other[1].clone(),
    }
}

fn entry_of(words: &mut Vec<u32>, at: usize) -> &mut u32 {
    if at >= words.len() {
        words.resize(at + 1, 0);
    }
    &mut words[at]
}

#[test]
fn any_database_is_drawn_with_or_done_without() {
    let model = Model::new(builtin("ngons").expect("it is built in"));
    let options = PlanOptions {
        max_level: 3,
        ..PlanOptions::default()
    };
    let prepare = |database: &Database| {
        let prepared = prepare_by_default_with(&model, options, database);
        prepared.expect("the model is sound").0
    };
    let path = kept("fuzz.db", &[]);
    evaluate(
        &model,
        &prepare(&Database::open(&path).expect("it is empty")),
    );
    let sound = std::fs::read(&path).expect("it was written");
    let (header, records) = (&sound[..24], records(&sound));
    assert!(
        file(header, &records) == sound && records.len() > 8,
        "{} records",
        records.len()
    );
    rounds(400, |random| {
        let mut records = records.clone();
        for _ in 0..=random.below(3) {
            change_record(random, &mut records);
        }
        let path = kept("fuzz.db", &file(header, &records));
        evaluate(
            &model,
            &prepare(&Database::open(&path).expect("it is ours")),
        );
    });
}
