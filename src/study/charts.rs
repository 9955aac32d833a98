//! The charts of a study: a measure by theta and by L, as the paper's figure 6 has them, and by the fit.

use super::{Figures, Plan, Row, StudyError, Subject, Table};
use crate::export::atomic;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// The size of a chart, in SVG's units.
const SIZE: (u32, u32) = (1200, 560);
/// Height of letters, in the same.
const LETTERS: i32 = 20;

/// A measure that has a chart.
pub(super) struct Measure {
    /// Its name on the chart.
    pub name: &'static str,
    /// How the name of its file ends.
    pub stem: &'static str,
    of: Of,
    scale: Scale,
}

/// The object of a measure.
enum Of {
    Meshes(fn(&Figures) -> Option<f64>),
    Tiles(fn(&Row) -> f64),
}

/// The fixed end of a chart's scale.
enum Scale {
    To(f64),
    From(f64),
}

const MEASURES: [Measure; 5] = [
    Measure {
        name: "Qr, share of quads",
        stem: "qr",
        of: Of::Meshes(|figures| Some(figures.qr)),
        scale: Scale::To(1.0),
    },
    Measure { name: "Qg, shape of quads", stem: "qg", of: Of::Meshes(|figures| figures.qg), scale: Scale::To(1.0) },
    Measure { name: "Tg, shape of triangles", stem: "tg", of: Of::Meshes(|figures| figures.tg), scale: Scale::To(1.0) },
    Measure {
        name: "irregular vertices, % of all",
        stem: "irregular",
        of: Of::Meshes(|figures| Some(100.0 * figures.irregular as f64 / figures.vertices.max(1) as f64)),
        scale: Scale::From(0.0),
    },
    Measure {
        name: "largest side of a tile over the smallest",
        stem: "sides",
        of: Of::Tiles(|row| row.side_range),
        scale: Scale::From(1.0),
    },
];

/// The measures that a plan has charts of: those of meshes where a value is varied, that of tiles where the fit is.
pub(super) fn measures(plan: &Plan) -> impl Iterator<Item = &'static Measure> {
    let varied = plan.swept().map(|values| values.len() > 1);
    let shown = move |measure: &&Measure| match measure.of {
        Of::Meshes(_) => varied.contains(&true),
        Of::Tiles(_) => varied[2],
    };
    MEASURES.iter().filter(shown)
}

/// The name of a chart's file.
pub(super) fn file(subject: &Subject, measure: &Measure) -> String {
    format!("{}-{}.svg", subject.stem, measure.stem)
}

/// Writes the charts of a surface as SVG.
pub(super) fn write(folder: &Path, subject: &Subject, plan: &Plan, table: &Table) -> Result<(), StudyError> {
    for measure in measures(plan) {
        let path = folder.join(file(subject, measure));
        let mut text = String::new();
        let drawn = Chart::new(subject, plan, table, measure).draw(SVGBackend::with_string(&mut text, SIZE));
        drawn.map_err(|error| StudyError::Chart { path: path.clone(), reason: error.to_string() })?;
        atomic(&path, |writer| writer.write_all(text.as_bytes()))?;
    }
    Ok(())
}

/// Values of a measure for one number of points.
struct Series {
    name: String,
    colour: RGBColor,
    style: Style,
    /// For each panel.
    panels: Vec<Vec<(f64, f64)>>,
}

/// The style of a line: before clean-up, after the paper's, and the program's meshes.
#[derive(Clone, Copy, PartialEq)]
enum Style {
    Dashed,
    Plain,
    Dotted,
}

const STYLES: [(Style, &str); 3] =
    [(Style::Dashed, "before clean-up"), (Style::Plain, "paper's clean-up"), (Style::Dotted, "final")];

struct Chart {
    title: String,
    /// The varied value of each panel.
    axes: Vec<String>,
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
        let usual = plan.usual();
        let [theta, l, _] = usual;
        let names = [
            format!("theta in degrees (L = {l})"),
            format!("L in tile sides (theta = {theta})"),
            format!("fit (theta = {theta}, L = {l})"),
        ];
        let varied: Vec<(usize, &[f64])> =
            plan.swept().into_iter().enumerate().filter(|(_, values)| values.len() > 1).collect();
        let mut series = Vec::new();
        for (&points, &colour) in plan.points.iter().zip(COLOURS.iter().cycle()) {
            for (stage, (style, stage_name)) in STYLES.into_iter().enumerate() {
                let value = |row: &Row| match measure.of {
                    Of::Meshes(of) => of(row.figures()[stage]),
                    Of::Tiles(of) => (style == Style::Dotted).then(|| of(row)),
                };
                let panel = |&(sweep, values): &(usize, &[f64])| {
                    let shown = |row: &&Row| {
                        let setting = row.setting();
                        let others = (0..3).all(|k| k == sweep || setting[k] == usual[k]);
                        row.surface == subject.name
                            && row.points == points
                            && others
                            && values.contains(&setting[sweep])
                    };
                    let rows = table.rows.iter().filter(shown);
                    let mut places: Vec<(f64, f64)> =
                        rows.filter_map(|row| Some((row.setting()[sweep], value(row)?))).collect();
                    places.sort_by(|a, b| a.0.total_cmp(&b.0));
                    places
                };
                let name = format!("{points} points, {stage_name}");
                series.push(Series { name, colour, style, panels: varied.iter().map(panel).collect() });
            }
        }
        series.retain(|series| series.panels.iter().any(|panel| !panel.is_empty()));
        let values = series.iter().flat_map(|series| &series.panels).flatten().map(|point| point.1);
        let (least, most) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
        // The scale does not magnify small differences near the best value.
        let (low, high) = match measure.scale {
            Scale::To(best) => ((20.0 * least - 0.2).floor().clamp(0.0, 18.0) / 20.0, best),
            Scale::From(low) => (low, (1.1 * most).ceil().max(low + 1.0)),
        };
        let title = format!("{}: {}", subject.stem, measure.name);
        let axes = varied.iter().map(|&(sweep, _)| names[sweep].clone()).collect();
        Self { title, axes, series, low, high }
    }

    fn draw<B: DrawingBackend>(&self, backend: B) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let area = backend.into_drawing_area();
        area.fill(&WHITE)?;
        let (title, rest) = area.split_vertically(2 * LETTERS);
        let style = ("sans-serif", LETTERS + 4).into_text_style(&title);
        title.draw_text(&self.title, &style, (LETTERS, LETTERS / 2))?;
        let (panels, legend) = rest.split_vertically(SIZE.1 as i32 - 2 * LETTERS - self.legend_height());
        for ((area, panel), title) in panels.split_evenly((1, self.axes.len())).iter().zip(0..).zip(&self.axes) {
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
        // The panel is empty; plotters does not return from an infinite range.
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
            match series.style {
                Style::Dashed => {
                    chart.draw_series(DashedLineSeries::new(values(), 8, 7, series.colour.stroke_width(2)))?;
                }
                Style::Plain => {
                    chart.draw_series(LineSeries::new(values(), series.colour.stroke_width(2)))?;
                }
                Style::Dotted => {
                    chart.draw_series(LineSeries::new(values(), series.colour.stroke_width(3)))?;
                    chart.draw_series(values().map(|place| Circle::new(place, 5, series.colour.filled())))?;
                }
            }
        }
        Ok(())
    }

    fn legend_height(&self) -> i32 {
        (self.series.len().div_ceil(STYLES.len()) as i32) * (LETTERS + 6) + LETTERS / 2
    }

    /// A column for each style.
    fn legend<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let columns = STYLES.len() as i32;
        for (number, series) in (0..).zip(&self.series) {
            let x = 2 * LETTERS + number % columns * SIZE.0 as i32 / columns;
            let y = number / columns * (LETTERS + 6) + LETTERS / 2;
            let line = |from: i32, to: i32, width: u32| {
                PathElement::new([(x + from, y), (x + to, y)], series.colour.stroke_width(width))
            };
            match series.style {
                Style::Dashed => (0..4).try_for_each(|dash| area.draw(&line(14 * dash, 14 * dash + 8, 2)))?,
                Style::Plain => area.draw(&line(0, 50, 2))?,
                Style::Dotted => {
                    area.draw(&line(0, 50, 3))?;
                    area.draw(&Circle::new((x + 25, y), 5, series.colour.filled()))?;
                }
            }
            let style = ("sans-serif", LETTERS - 2).into_text_style(area).pos(Pos::new(HPos::Left, VPos::Center));
            area.draw_text(&series.name, &style, (x + 60, y))?;
        }
        Ok(())
    }
}

/// A number with no more digits than it needs, at most three behind the point.
fn short(x: f64) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
