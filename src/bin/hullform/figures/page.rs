//! The page that shows all figures.

use std::fmt::Write;

use super::figure::{Checked, Made, Verdict, paper, rounded};

const HEAD: &str = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Figures</title>\n<style>\n\
    body { font: 16px/1.5 sans-serif; margin: 2em auto; max-width: 60em; padding: 0 1em; color: #1c1e22; background: #fafaf8 }\n\
    table { border-collapse: collapse } td, th { padding: .2em .8em; text-align: left; border-bottom: 1px solid #ddd }\n\
    img { max-width: 100%; border: 1px solid #ddd } .reproduced { color: #17702f } .differs { color: #9a5b00 } .unavailable { color: #777 }\n\
    </style></head><body>\n";

/// As HTML.
pub fn html(made: &[Made], quick: bool) -> String {
    let mut text = String::from(HEAD);
    text.push_str("<h1>Figures and tables</h1>\n");
    if quick {
        text.push_str("<p>Made with --quick: what takes long is left out.</p>\n");
    }
    text.push_str("<table><tr><th>figure</th><th>what it shows</th><th>verdict</th></tr>\n");
    for made in made {
        let (id, word) = (made.id, made.verdict.word());
        let title = escaped(made.title);
        let _ = writeln!(
            text,
            "<tr><td><a href=\"#{id}\">{id}</a></td><td>{title}</td><td class=\"{word}\">{word}</td></tr>"
        );
    }
    text.push_str("</table>\n");
    for made in made {
        figure(&mut text, made);
    }
    text.push_str("</body></html>\n");
    text
}

fn figure(text: &mut String, made: &Made) {
    let (id, word) = (made.id, made.verdict.word());
    let _ = write!(
        text,
        "<h2 id=\"{id}\">{id}: {}</h2>\n<p>{}</p>\n<p class=\"{word}\"><b>{word}</b>",
        escaped(made.title),
        escaped(paper(id))
    );
    if made.verdict != Verdict::Reproduced {
        let _ = write!(text, ": {}", escaped(made.verdict.reason()));
    }
    text.push_str("</p>\n");
    if !made.checked.is_empty() {
        text.push_str("<table><tr><th></th><th>printed</th><th>measured</th></tr>\n");
        made.checked.iter().for_each(|check| row(text, check));
        text.push_str("</table>\n");
    }
    for file in &made.files {
        let name = escaped(file);
        let _ = match file.ends_with(".png") || file.ends_with(".svg") {
            true => writeln!(text, "<p><img src=\"{name}\" alt=\"{name}\"></p>"),
            false => writeln!(text, "<p><a href=\"{name}\">{name}</a></p>"),
        };
    }
}

fn row(text: &mut String, check: &Checked) {
    let measured = check.measured.map_or("not measured".into(), rounded);
    let word = match (check.measured, check.agrees) {
        (None, _) => "unavailable",
        (_, true) => "reproduced",
        (_, false) => "differs",
    };
    let _ = writeln!(
        text,
        "<tr><td>{}</td><td>{}</td><td class=\"{word}\">{measured}</td></tr>",
        escaped(check.what),
        escaped(check.printed)
    );
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_messages_say_is_no_markup() {
        let made = Made {
            id: "2016.table.2",
            title: "a & b",
            checked: Vec::new(),
            files: vec!["a.png".into()],
            verdict: Verdict::Unavailable("there is no <b>".into()),
            seconds: 0.0,
        };
        let text = html(&[made], false);
        assert!(text.contains("a &amp; b") && text.contains("there is no &lt;b&gt;"));
        assert!(text.contains("<img src=\"a.png\""));
    }
}
