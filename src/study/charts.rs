//! The charts of a study: a measure by theta and by L, as the paper's figure 6 has them.

use super::canvas::Canvas;
use super::{Figures, Plan, Row, StudyError, Subject, Table};
use crate::export::atomic;
use crate::mesh::connect::ConnectOptions;
use crate::picture::Image;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// Pixels of a chart.
const SIZE: (u32, u32) = (1200, 560);
/// Height of letters, in pixels.
const LETTERS: i32 = 20;

/// A measure that has a chart.
pub(super) struct Measure {
    /// Its name on the chart.
    pub name: &'static str,
    /// How the name of its files ends.
    pub stem: &'static str,
    of: fn(&Figures) -> Option<f64>,
    /// The best that it can be; the chart ends there.
    best: f64,
}

pub(super) const MEASURES: [Measure; 4] = [
    Measure { name: "Qr, share of quads", stem: "qr", of: |figures| Some(figures.qr), best: 1.0 },
    Measure { name: "Qg, shape of quads", stem: "qg", of: |figures| figures.qg, best: 1.0 },
    Measure { name: "Tg, shape of triangles", stem: "tg", of: |figures| figures.tg, best: 1.0 },
    Measure {
        name: "irregular vertices, % of all",
        stem: "irregular",
        of: |figures| Some(100.0 * figures.irregular as f64 / figures.vertices.max(1) as f64),
        best: 0.0,
    },
];

/// The name of a chart's file, without its ending.
pub(super) fn stem(subject: &Subject, measure: &Measure) -> String {
    format!("{}-{}", subject.stem, measure.stem)
}

/// Writes the charts of a surface as SVG and PNG.
pub(super) fn write(folder: &Path, subject: &Subject, plan: &Plan, table: &Table) -> Result<(), StudyError> {
    for measure in &MEASURES {
        let chart = Chart::new(subject, plan, table, measure);
        let path = |ending: &str| folder.join(format!("{}.{ending}", stem(subject, measure)));
        let failed = |path: &Path, reason: String| StudyError::Chart { path: path.to_owned(), reason };

        let svg = path("svg");
        let mut text = String::new();
        chart.draw(SVGBackend::with_string(&mut text, SIZE)).map_err(|reason| failed(&svg, reason))?;
        atomic(&svg, |writer| writer.write_all(text.as_bytes()))?;

        let png = path("png");
        let mut image = Image::blank([SIZE.0, SIZE.1]);
        chart.draw(Canvas(&mut image)).map_err(|reason| failed(&png, reason))?;
        atomic(&png, |writer| image.write_png(writer))?;
    }
    Ok(())
}

/// Values of a measure for one number of points.
struct Series {
    name: String,
    colour: RGBColor,
    after: bool,
    /// By theta, and by L.
    panels: [Vec<(f64, f64)>; 2],
}

struct Chart {
    title: String,
    series: Vec<Series>,
    low: f64,
    high: f64,
}

const COLOURS: [RGBColor; 6] = [
    RGBColor(36, 92, 158),
    RGBColor(217, 95, 2),
    RGBColor(27, 138, 90),
    RGBColor(126, 64, 152),
    RGBColor(200, 30, 40),
    RGBColor(90, 90, 90),
];

impl Chart {
    fn new(subject: &Subject, plan: &Plan, table: &Table, measure: &Measure) -> Self {
        let usual = ConnectOptions::default();
        let mut series = Vec::new();
        for (&points, &colour) in plan.points.iter().zip(COLOURS.iter().cycle()) {
            let of = |row: &&Row| row.surface == subject.name && row.points == points;
            let rows: Vec<&Row> = table.rows.iter().filter(of).collect();
            for after in [false, true] {
                let value = |row: &Row| (measure.of)(if after { &row.after } else { &row.before });
                let panel = |fixed: fn(&Row) -> f64, at: f64, free: fn(&Row) -> f64, list: &[f64]| {
                    let mut values: Vec<(f64, f64)> = rows
                        .iter()
                        .filter(|row| fixed(row) == at && list.contains(&free(row)))
                        .filter_map(|row| Some((free(row), value(row)?)))
                        .collect();
                    values.sort_by(|a, b| a.0.total_cmp(&b.0));
                    values
                };
                series.push(Series {
                    name: format!("{points} points, {}", if after { "after clean-up" } else { "before" }),
                    colour,
                    after,
                    panels: [
                        panel(|row| row.max_distance, usual.max_distance, |row| row.max_angle, &plan.angles),
                        panel(|row| row.max_angle, usual.max_angle, |row| row.max_distance, &plan.distances),
                    ],
                });
            }
        }
        let values = series.iter().flat_map(|series| &series.panels).flatten().map(|point| point.1);
        let (least, most) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
        // Where all is nearly the best, the chart is not to make much of little.
        let (low, high) = if measure.best > 0.0 {
            ((20.0 * least - 0.2).floor().clamp(0.0, 18.0) / 20.0, measure.best)
        } else {
            (0.0, (1.1 * most).ceil().max(1.0))
        };
        let title = format!("{}: {}", subject.stem, measure.name);
        Self { title, series, low, high }
    }

    fn draw(&self, backend: impl DrawingBackend) -> Result<(), String> {
        self.drawn(backend.into_drawing_area()).map_err(|error| error.to_string())
    }

    fn drawn<B: DrawingBackend>(&self, area: DrawingArea<B, Shift>) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.fill(&WHITE)?;
        let (title, rest) = area.split_vertically(2 * LETTERS);
        let style = ("sans-serif", LETTERS + 4).into_text_style(&title);
        title.draw_text(&self.title, &style, (LETTERS, LETTERS / 2))?;
        let (panels, legend) = rest.split_vertically(SIZE.1 as i32 - 2 * LETTERS - self.legend_height());
        let titles = ["theta in degrees (L = 1.6)", "L in tile sides (theta = 30)"];
        for ((area, panel), title) in panels.split_evenly((1, 2)).iter().zip(0..).zip(titles) {
            self.panel(area, panel, title)?;
        }
        self.legend(&legend)?;
        area.present()
    }

    fn panel<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        panel: usize,
        title: &str,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let places = || self.series.iter().flat_map(|series| &series.panels[panel]).map(|point| point.0);
        let (left, right) = (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
        // There is nothing to draw, and plotters would divide a range without end for ever.
        if !(left.is_finite() && right.is_finite()) {
            return Ok(());
        }
        let room = 0.03 * (right - left).max(1.0);
        let mut chart = ChartBuilder::on(area)
            .margin(LETTERS / 2)
            .x_label_area_size(3 * LETTERS)
            .y_label_area_size(4 * LETTERS)
            .build_cartesian_2d(left - room..right + room, self.low..self.high)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 228, 232))
            .axis_style(RGBColor(120, 124, 130))
            .label_style(("sans-serif", LETTERS - 4))
            .axis_desc_style(("sans-serif", LETTERS - 2))
            .x_desc(title)
            .x_labels(9)
            .y_labels(7)
            .x_label_formatter(&|x| short(*x))
            .y_label_formatter(&|y| short(*y))
            .draw()?;
        for series in &self.series {
            let values = || series.panels[panel].iter().copied();
            if series.after {
                chart.draw_series(LineSeries::new(values(), series.colour.stroke_width(3)))?;
                chart.draw_series(values().map(|place| Circle::new(place, 5, series.colour.filled())))?;
            } else {
                chart.draw_series(DashedLineSeries::new(values(), 8, 7, series.colour.stroke_width(2)))?;
            }
        }
        Ok(())
    }

    fn legend_height(&self) -> i32 {
        (self.series.len().div_ceil(2) as i32) * (LETTERS + 6) + LETTERS / 2
    }

    /// Two columns: before, and after.
    fn legend<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        for (number, series) in (0..).zip(&self.series) {
            let (x, y) = (5 * LETTERS + number % 2 * SIZE.0 as i32 / 2, number / 2 * (LETTERS + 6) + LETTERS / 2);
            let line =
                |from: i32, to: i32| PathElement::new([(x + from, y), (x + to, y)], series.colour.stroke_width(3));
            if series.after {
                area.draw(&line(0, 60))?;
                area.draw(&Circle::new((x + 30, y), 5, series.colour.filled()))?;
            } else {
                for dash in 0..4 {
                    area.draw(&line(16 * dash, 16 * dash + 9))?;
                }
            }
            let style = ("sans-serif", LETTERS - 2).into_text_style(area).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw_text(&series.name, &style, (x + 75, y))?;
        }
        Ok(())
    }
}

/// A number with no more digits than it needs, at most three behind the point.
fn short(x: f64) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
