//! Malformed OBJ text: every message names file and line and speaks of the problem; nothing panics.

use std::path::Path;

use hullform::Error;
use hullform::mesh::{ControlMesh, read_obj, read_obj_bytes};
use proptest::prelude::*;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

const TAGGED: &str = "# a pyramid\nmtllib none.mtl\no p\nv 0 0 0\nv 1 0 0\nv 1 1 0\r\nv 0 1 0\nv .5 .5 1\n\
     vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng base\nf 4/4 3/3 2/2 1/1\nusemtl x\ns 1\n\
     f 1/1 2/2 \\\n 5/3\nf -4/2 -3/3 -1/1\nf 3/1 4/2 5/3\nf 4/1 1/2 5/3\n\
     t crease 4/2/0 0 1 1 2 2.5 3\nt corner 1/1/0 4 10\nt hole 2/0/0 0 3\n\
     t interpolateboundary 1/0/0 1\nt creasemethod 0/0/1 chaikin\nt smoothtriangles 0/0/1 smooth\n\
     t vertexedit 1/1/1 0 0 add\nt facevaryinginterpolateboundary 1/0/0 5\n";

fn refusal(bytes: &[u8]) -> String {
    match read_obj_bytes("bad.obj", bytes) {
        Ok(_) => panic!("accepted: {}", String::from_utf8_lossy(bytes)),
        Err(error) => {
            assert_eq!(error.exit_code(), 2);
            error.to_string()
        }
    }
}

/// Asserts that `text` is refused with `bad.obj:LINE: ` and a message that contains `words`.
fn refused(text: &str, line: usize, words: &str) {
    let message = refusal(text.as_bytes());
    let place = format!("bad.obj:{line}: ");
    assert!(message.starts_with(&place), "{text:?} gave {message:?}");
    assert!(message.contains(words), "{text:?} gave {message:?}");
    assert!(message.contains("; "), "no remedy: {message:?}");
}

/// As [`refused`], for a line after the five lines of a square.
fn refused_after_square(line: &str, words: &str) {
    refused(&format!("{SQUARE}{line}\n"), 6, words);
}

fn read(text: &str) -> ControlMesh {
    read_obj_bytes("good.obj", text.as_bytes()).expect(text)
}

#[test]
fn coordinates() {
    refused("v 0 0 0\nv NaN 0 0\n", 2, "\"NaN\" is not finite");
    refused("v 0 -inf 0\n", 1, "\"-inf\" is not finite");
    refused("v 0 0 1e999\n", 1, "\"1e999\" is not finite");
    refused("v 0 0\n", 1, "has 2 coordinates");
    refused("v\n", 1, "has 0 coordinates");
    refused("v 0 0 zero\n", 1, "\"zero\" is not a number");
    refused("v 0 0 0 1 2 blue\n", 1, "\"blue\" is not a number");
    refused("vt\n", 1, "has no value");
    refused("vt 0 1e999\n", 1, "\"1e999\" is not finite");
    refused("vt 0 0,5\n", 1, "\"0,5\" is not a number");
    refused("vt nancy 0\n", 1, "\"nancy\" is not a number");
    // As Windows once wrote them; not a comment behind a number.
    refused("v 0 -1.#IND 0\n", 1, "\"-1.#IND\" is not finite");
    refused("v -nan(ind) 0 0\n", 1, "\"-nan(ind)\" is not finite");
    refused("v 0x10 0 0\n", 1, "\"0x10\" is not a number");
    refused("v 0 infinity 0\n", 1, "\"infinity\" is not finite");
}

#[test]
fn faces() {
    refused_after_square("f 1 2 3 2", "names vertex 2 twice");
    refused_after_square("f 1 2 3 -3", "names vertex 2 twice");
    refused_after_square("f 1 2", "has 2 vertices");
    refused_after_square("f", "has 0 vertices");
    refused_after_square("f 0 1 2", "names vertex 0");
    refused_after_square("f 1 2 5", "names vertex 5, but the file has 4");
    refused_after_square("f 1 2 -5", "names vertex -5, but only 4");
    refused_after_square("f 1 2 3.5", "\"3.5\" is not a whole number");
    refused_after_square("f 1 2 99999999999999999999", "is not a whole number");
    refused_after_square("f 1 2 9223372036854775807", "the file has 4");
    refused_after_square("f 1 2 -9223372036854775808", "only 4 stand before it");
    refused_after_square("f 1/1/1/1 2 3", "more than three parts");
    refused_after_square("f /1 2 3", "\"\" is not a whole number");
    refused_after_square(
        "f 1/1 2 3",
        "names texture coordinate 1, but the file has 0",
    );
    refused_after_square("f 1/-1 2 3", "names texture coordinate -1, but only 0");
    refused_after_square("f 1//x 2 3", "\"x\" is not a whole number");
    refused_after_square("f 1 2 \\", "the file ends where a backslash");
}

#[test]
fn tags() {
    refused_after_square("t", "cut off");
    refused_after_square("t crease", "cut off");
    refused_after_square("t crease 2/1 0 1 3", "\"2/1\" is not ints/floats/strings");
    refused_after_square("t crease 2/1/0/0 0 1 3", "is not ints/floats/strings");
    refused_after_square("t crease -2/1/0 0 1 3", "is not ints/floats/strings");
    refused_after_square("t crease 2/1/0 0 1", "announces 3 values, but 2 follow");
    refused_after_square("t crease 18446744073709551615/1/1 0 1", "but 2 follow");
    refused_after_square("t crease 3/1/0 0 1 2 3", "has 3 ints, 1 floats");
    refused_after_square("t crease 2/0/0 0 1", "has 2 ints, 0 floats");
    refused_after_square("t crease 2/2/0 0 1 3 3", "has 2 ints, 2 floats");
    refused_after_square("t crease 2/1/0 0 1.5 3", "\"1.5\" is not a whole number");
    refused_after_square("t crease 2/1/0 0 1 hard", "\"hard\" is not a number");
    refused_after_square("t crease 2/1/0 0 1 -1", "\"-1\" is negative");
    refused_after_square("t crease 2/1/0 0 1 NaN", "\"NaN\" is not finite");
    refused_after_square(
        "t crease 2/1/0 0 2 3",
        "edge 0-2: a crease names it, but no face",
    );
    refused_after_square("t crease 2/1/0 0 9 3", "edge 0-9: a crease names it");
    refused_after_square("t corner 1/1/0 4 3", "vertex 4: a corner names it");
    refused_after_square("t corner 1/1/0 -1 3", "\"-1\" is not a whole number");
    refused_after_square("t corner 0/1/0 3", "has 0 ints");
    refused_after_square("t hole 1/0/0 1", "face 1: a hole names it");
    refused_after_square("t hole 0/0/0", "has 0 ints");
    refused_after_square("t hole 1/1/0 0 1", "has 1 ints, 1 floats");
    refused_after_square("t interpolateboundary 1/0/0 3", "has the value \"3\"");
    refused_after_square("t interpolateboundary 0/0/0", "has 0 ints");
    refused_after_square("t facevaryinginterpolateboundary 1/0/0 6", "\"6\"");
    refused_after_square("t creasemethod 0/0/1 soft", "has the value \"soft\"");
    refused_after_square("t creasemethod 1/0/0 1", "has 1 ints");
    refused_after_square("t smoothtriangles 0/0/1 yes", "has the value \"yes\"");
}

#[test]
fn whole_files() {
    for text in [
        "",
        "\n\n",
        "# nothing\n",
        "v 0 0 0\n",
        "\u{feff}",
        "<html>\n",
    ] {
        let message = refusal(text.as_bytes());
        assert!(
            message.starts_with("bad.obj: there is no face; "),
            "{message}"
        );
    }
    let message = refusal(b"v 0 0 0\nv 1 \xff 0\n");
    assert!(
        message.starts_with("bad.obj:2: byte 0xff is not UTF-8"),
        "{message}"
    );
    let message = refusal(b"\xff\xfev\0 \x000\0");
    assert!(
        message.starts_with("bad.obj: this is UTF-16 text; "),
        "{message}"
    );
    for bytes in [
        &b"\x1f\x8b\x08\x00\xff\x0a\x00"[..],
        b"v\0 \x000\0 \x000\0 \x000\0\n\0",
    ] {
        let message = refusal(bytes);
        assert!(message.contains("there are bytes of 0x00"), "{message}");
    }
    let error = read_obj(Path::new("no/such.obj")).expect_err("there is no such file");
    assert!(matches!(&error, Error::File { .. }));
    assert!(error.to_string().starts_with("no/such.obj: "), "{error}");
}

/// Only what makes the surface must be text, and there the line is named.
#[test]
fn bytes_of_other_encodings() {
    let latin: [&[u8]; 10] = [
        b"# Mod\xe8le de d\xe9monstration",
        b"o Mod\xe8le",
        b"g c\xf4t\xe9 gauche",
        b"usemtl verre d\xe9poli\\\n\xe9",
        b"mtllib \x83}\x83e.mtl",
        b"f 1 2 3 # trois\xe8me",
        b"v 0 0 0#\xff",
        b"\xe9trange 1 2 3",
        b"vn \xff",
        b"# \0 \xff\xfe",
    ];
    for line in latin {
        let mut bytes = line.to_vec();
        bytes.extend_from_slice(b"\n");
        bytes.extend_from_slice(SQUARE.as_bytes());
        let mesh = read_obj_bytes("latin.obj", &[SQUARE.as_bytes(), &bytes].concat());
        let mesh = mesh.expect("what is skipped may be anything");
        assert!(mesh.face_count() >= 2, "{}", line.escape_ascii());
    }
    for line in [
        "v 0 0 \\\n0\u{e9}",
        "vt 0 \u{e9}",
        "f 1 2 3\u{e9}",
        "t hole 1/0/0 0 \u{e9}",
    ] {
        let mut bytes = SQUARE.as_bytes().to_vec();
        bytes.extend(line.chars().map(|c| c as u8));
        let message = refusal(&bytes);
        assert!(
            message.starts_with("bad.obj:6: byte 0xe9 is not UTF-8"),
            "{message}"
        );
    }
}

/// As it comes from modellers: what read well before, and what once did not.
#[test]
fn files_in_the_wild() {
    let square = read(SQUARE);
    let spellings = [
        SQUARE.replace('\n', "\r\n"),
        SQUARE.replace('\n', "\r"),
        SQUARE.replace('\n', "\r\r\n"),
        SQUARE.replace("0\nv", "0\rv").replace("\nf", "\r\nf"),
        SQUARE.trim_end().to_string(),
        format!("\u{feff}{SQUARE}"),
        format!("\u{feff}\u{feff}{SQUARE}\u{1a}"),
        SQUARE.replace(' ', "\t"),
        SQUARE.replace(' ', " \u{c}\u{b} "),
        SQUARE.replace(' ', "\u{a0}"),
        SQUARE.replace("\nv", "\n   v"),
        SQUARE.replace("v 0 0 0", "v +.0 -0 0.e5"),
        SQUARE.replace("v 1 0 0", "v 1. 0e-999 0"),
        SQUARE.replace("0\n", "0 0.5 0.5 0.5\n"),
        SQUARE.replace("0\n", "0 1.0\n"),
        SQUARE.replace("v 0 0 0\n", "v 0 0 0 nan nan -1.#IND\n"),
        SQUARE.replace("f 1 2 3 4", "vn 0 0 1\nf 1//1 2//1 3//1 4//1"),
        SQUARE.replace("f 1 2 3 4", "f 1/ 2/ 3/ 4/"),
        SQUARE.replace("f 1 2 3 4", "f 1// 2// 3// 4//"),
        SQUARE.replace("f 1 2 3 4", "f -4 -3 -2 -1"),
        SQUARE.replace("f 1 2 3 4", "f +1 +2 03 4"),
        SQUARE.replace("f 1 2 3 4", "vt 0 0\nf 1/1 2 3//-7 4/-1/0"),
        SQUARE.replace("f 1 2 3 4", "f 1 2\\\n 3 4 # all\\"),
        SQUARE.replace("f 1 2 3 4", "f 1 2\\ # two\n3 4\\\n"),
        format!(
            "f 1 2 3 4\n{}",
            SQUARE.replace("f 1 2 3 4\n", "l 1 2 3\np 1 2\ns off\n")
        ),
        format!("cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nparm u 0 1\nend\n{SQUARE}"),
        format!("# {}\n{SQUARE}", "long ".repeat(100_000)),
        format!("g {}\n{SQUARE}", "long ".repeat(100_000)),
        format!("{SQUARE}usemtl C:\\textures\\"),
        format!("{SQUARE}\\\n\\\n\\"),
    ];
    for text in spellings {
        let mesh = read(&text);
        assert_eq!(mesh.positions(), square.positions(), "{text:?}");
        assert!(mesh.faces().eq(square.faces()), "{text:?}");
        assert!(mesh.texture().is_none(), "{text:?}");
    }
}

/// A backslash joins whatever comes next, as the format says.
#[test]
fn a_backslash_behind_a_name_takes_the_next_statement_along() {
    let tail = "v 2 0 0\nv 2 1 0\nusemtl other\nf 2 5 6 3\n";
    let mesh = read(
        &SQUARE
            .replace("f 1", "usemtl brushed\\\nf 1")
            .replace("f 1 2 3 4\n", &format!("f 1 2 3 4\n{tail}")),
    );
    assert_eq!(mesh.face_count(), 1);
    assert_eq!(mesh.face(0), [1, 4, 5, 2]);
}

#[test]
fn texture_coordinates_of_one_value_or_none_that_is_finite() {
    let texture = |statements: [&str; 4]| {
        let lines: String = statements
            .iter()
            .map(|line| format!("vt {line}\n"))
            .collect();
        let mesh = read(&SQUARE.replace("f 1 2 3 4", &format!("{lines}f 1/1 2/2 3/3 4/4")));
        let values = mesh.texture().expect("every corner has one").values.clone();
        values
            .iter()
            .map(|value| value.to_array())
            .collect::<Vec<_>>()
    };
    let values = texture(["0.5", "-1", "1 2 3", "1. # half"]);
    assert_eq!(values, [[0.5, 0.0], [-1.0, 0.0], [1.0, 2.0], [1.0, 0.0]]);
    let values = texture(["nan nan", "1 0", "1 1", "-nan(ind) 7"]);
    assert_eq!(values, [[0.0; 2], [1.0, 0.0], [1.0, 1.0], [0.0; 2]]);
    let values = texture(["1.#QNAN 0.5", "0.5 -1.#IND00", "-inf", "0.5 0.25 nan"]);
    assert_eq!(values, [[0.0; 2], [0.0; 2], [0.0; 2], [0.5, 0.25]]);
}

/// Lines are counted as an editor counts them, comments, CRLF and joined lines included.
#[test]
fn lines_count_from_one_through_everything() {
    let text = "# one\r\n\r\nv 0 0 0 # three\r\nv 1 0 \\\r\n 0\r\nv 1 1 0\r\nf 1 2 7\r\n";
    refused(text, 7, "names vertex 7");
    refused(
        "v 0 0 0\nf 1 \\\n 2 \\\n 3\nv 1 2\n",
        5,
        "has 2 coordinates",
    );
    refused("v 0 0 0\nv 1 0 0\nf 1 \\\n 2 \\\n 3\n", 3, "names vertex 3");
    refused("v 0 0 0\r# two\r\rv 1 0\r", 4, "has 2 coordinates");
    refused(
        "v 0 0 0\r\r\n# two\r\r\nv 1 0\r\r\n",
        3,
        "has 2 coordinates",
    );
}

#[test]
fn long_words_are_cut_in_messages() {
    let message = refusal(format!("v 0 0 {}\n", "x".repeat(100_000)).as_bytes());
    assert!(message.len() < 200, "{message}");
}

#[test]
fn everything_valid_is_read() {
    let mesh = read(TAGGED);
    let faces: Vec<_> = mesh.faces().map(<[u32]>::to_vec).collect();
    assert_eq!(
        faces,
        [
            vec![3, 2, 1, 0],
            vec![0, 1, 4],
            vec![1, 2, 4],
            vec![2, 3, 4],
            vec![3, 0, 4]
        ]
    );
    let creases: Vec<_> = mesh
        .creases()
        .iter()
        .map(|c| (c.vertices, c.sharpness))
        .collect();
    assert_eq!(creases, [([0, 1], 2.5), ([1, 2], 3.0)]);
    assert_eq!(mesh.holes(), [0, 3]);
    let texture = mesh.texture().expect("every corner has one");
    assert_eq!(texture.values.len(), 4);
    assert_eq!(texture.indices[..7], [3, 2, 1, 0, 0, 1, 2]);
}

/// What readers for drawing change: order of vertices, isolated ones, groups, weights, colours, precision.
#[test]
fn the_file_s_own_numbers() {
    let mesh = read(
        "v 9 9 9\nv 1000.0000001 0 0 2\ng a\nf 4 3 2\ng b\nv 0 1 0 0.5 0.5 0.5\nv 0 0 1\nv 8 8 8\nf 2 3 -2\n",
    );
    assert_eq!(mesh.vertex_count(), 5);
    assert_eq!(mesh.positions()[1].to_array(), [1000.0000001, 0.0, 0.0]);
    assert_eq!(mesh.face(0), [3, 2, 1]);
    assert_eq!(mesh.face(1), [1, 2, 3]);
}

#[test]
fn texture_coordinates_all_or_none() {
    let partial = SQUARE.replace("f 1 2 3 4", "vt 0 0\nf 1/1 2/1 3/1 4");
    assert!(read(&partial).texture().is_none());
    let first_bare = SQUARE.replace("f 1 2 3 4", "vt 0 0\nvt 1 1\nf 1 2/2 3/1 4/2");
    assert!(read(&first_bare).texture().is_none());
    let more_than_vertices = SQUARE.replace("f 1", "vt 0 0\nvt 1 0\nvt 2 0\nvt 3 0\nvt 4 0\nf 1/5");
    assert!(read(&more_than_vertices).texture().is_none());
    let all = "vt 0 0\nvt 1 0\nvt 2 0\nvt 3 0\nvt 4 0\nf 1/5 2/5 3/4 4/3";
    let mesh = read(&SQUARE.replace("f 1 2 3 4", all));
    let texture = mesh.texture().expect("every corner has one");
    assert_eq!(texture.indices, [4, 4, 3, 2]);
    assert_eq!(texture.values.len(), 5);
    assert_eq!(texture.values[4].x, 4.0);
}

#[test]
fn one_sharpness_for_all_and_the_last_crease_last() {
    let tags = "t crease 4/1/0 0 1 2 1 7\nt crease 2/1/0 1 0 3\nt strange 1/0/1 5 x\n";
    let mesh = read(&format!("{SQUARE}{tags}"));
    let sharpness: Vec<f32> = mesh
        .creases()
        .iter()
        .map(|crease| crease.sharpness)
        .collect();
    assert_eq!(sharpness, [7.0, 7.0, 3.0]);
}

/// Words that reach deep into the reader, put together at random.
fn words() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "v",
        "vt",
        "f",
        "t",
        "l",
        "o",
        "g",
        "usemtl",
        "mtllib",
        "crease",
        "corner",
        "hole",
        "2/1/0",
        "1/0/0",
        "0/0/1",
        "0",
        "1",
        "2",
        "3",
        "-1",
        "-2",
        "1/1",
        "2//3",
        "1/2/3",
        "1e308",
        "nan",
        "\\",
        "#",
        "\n",
        "\n",
        "\n",
        "\r\n",
        "interpolateboundary",
        "chaikin",
        "creasemethod",
        "99999999999999999999",
        "-9223372036854775808",
    ]);
    prop::collection::vec(word, 0..60).prop_map(|words| words.join(" "))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read_obj_bytes("fuzz", &bytes);
    }

    #[test]
    fn random_words_never_panic(text in words()) {
        let _ = read_obj_bytes("fuzz", text.as_bytes());
        let _ = read_obj_bytes("fuzz", format!("{SQUARE}{text}").as_bytes());
    }

    /// Bytes replaced, inserted and cut out of a valid file.
    #[test]
    fn mutations_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0u8..4), 1..8),
    ) {
        let mut bytes = TAGGED.as_bytes().to_vec();
        for (at, byte, kind) in edits {
            let at = at.index(bytes.len());
            let digit = b"0123456789-./ \n\\#"[byte as usize % 17];
            match kind {
                0 => bytes[at] = byte,
                1 => bytes[at] = digit,
                2 => bytes.insert(at, digit),
                _ => bytes.truncate(at.max(1)),
            }
        }
        if let Err(error) = read_obj_bytes("fuzz", &bytes) {
            let message = error.to_string();
            prop_assert!(message.starts_with("fuzz:"), "{}", message);
            prop_assert!(!message.contains("bug of hullform"), "{}", message);
        }
    }
}
