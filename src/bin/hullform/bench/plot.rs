//! Times over levels as a picture: a line for each model, method and backend.

use std::error::Error;

use plotters::prelude::*;

use super::row::Row;

const SIZE: (u32, u32) = (960, 640);

/// The picture; without lines where nothing was measured.
pub fn svg(title: &str, rows: &[Row]) -> String {
    let mut text = String::new();
    let drawn = draw(title, &lines(rows), &mut text);
    drawn.expect("a string takes all, and the axes have a length");
    text
}

/// A line's name, and its points: level and milliseconds.
type Line = (String, Vec<(f64, f64)>);

fn lines(rows: &[Row]) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for row in rows {
        let Some(seconds) = row.seconds().filter(|&seconds| seconds > 0.0) else {
            continue;
        };
        let name = format!(
            "{} {} {} {}",
            row.model, row.method, row.backend, row.residence
        );
        let point = (f64::from(row.level), 1e3 * seconds);
        match lines.iter_mut().find(|(other, _)| *other == name) {
            Some((_, points)) => points.push(point),
            None => lines.push((name, vec![point])),
        }
    }
    for (_, points) in &mut lines {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    lines
}

fn draw(title: &str, lines: &[Line], text: &mut String) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let points = || lines.iter().flat_map(|(_, points)| points);
    // A decade at least, so that the axis has a length whatever was measured.
    let least = points().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let greatest = points().map(|point| point.1).fold(0.0, f64::max);
    let (least, greatest) = if least.is_finite() {
        (least / 1.5, (1.5 * greatest).max(10.0 * least))
    } else {
        (1.0, 10.0)
    };
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 18))
        .margin(16)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(
            (1.0..64.0f64).log_scale().base(2.0),
            (least..greatest).log_scale(),
        )?;
    chart
        .configure_mesh()
        .x_desc("tess level")
        .y_desc("milliseconds a frame, the least")
        .x_label_formatter(&|level| format!("{level:.0}"))
        .draw()?;
    for (number, (name, points)) in lines.iter().enumerate() {
        let colour = Palette99::pick(number).to_rgba();
        let line = LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(3);
        chart
            .draw_series(line)?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    drop(chart);
    drop(root);
    Ok(())
}
