//! The page of a study: its table, charts and pictures in one self-contained file.

use super::charts::{self, measures};
use super::{Figures, Plan, Row, StudyError, Subject, Table};
use crate::export::atomic;
use base64::prelude::{BASE64_STANDARD, Engine};
use std::fs;
use std::path::Path;

const STYLE: &str = "body{font:16px/1.5 sans-serif;color:#2c3038;max-width:1240px;margin:2em auto;padding:0 1em}\
    table{border-collapse:collapse;font-variant-numeric:tabular-nums}td,th{padding:.2em .7em;text-align:right;\
    border-bottom:1px solid #dde1e6}th:first-child,td:first-child{text-align:left}svg,img{max-width:100%;height:auto}\
    figure{margin:1em 0;display:inline-block;max-width:32%}figcaption{font-size:14px}.chart{display:block}";

/// What the paper reports of the ONERA M6 wing (section 4).
const PAPER: &str = "<tr><td>the paper, M6</td><td>6000 to 60000</td><td></td><td></td><td>about 0.80</td><td>about 0.90</td><td></td>\
    <td></td><td>about 0.8</td><td></td><td>0.91 to 0.93</td></tr>";

const HEAD: &str = "<tr><th rowspan=\"2\">surface</th><th rowspan=\"2\">points</th><th rowspan=\"2\">fit</th>\
    <th rowspan=\"2\">vertices</th><th colspan=\"3\">Qr</th><th colspan=\"3\">Qg</th><th>Tg</th>\
    <th colspan=\"3\">irregular vertices</th><th rowspan=\"2\">sides, largest<br>over smallest</th>\
    <th rowspan=\"2\">faults</th><th rowspan=\"2\">ms</th></tr>\
    <tr><th>before</th><th>paper's</th><th>final</th><th>before</th><th>paper's</th><th>final</th><th>final</th>\
    <th>before</th><th>paper's</th><th>final</th></tr>";

/// Writes `study.html`; charts and pictures are those of the folder.
pub(super) fn write(folder: &Path, subjects: &[Subject], plan: &Plan, table: &Table) -> Result<(), StudyError> {
    let [theta, l, _] = plan.usual();
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Study</title><style>{STYLE}</style></head>\n\
         <body>\n<h1>Study</h1>\n<p>{}. In the table theta is {theta} degrees and L {l}. \
         Meshes are measured before clean-up, after the paper's clean-up and smoothing, and as the program leaves
         them.</p>\n<table>\n{HEAD}\n",
        table.program
    );
    for row in table.rows.iter().filter(|row| row.setting()[..2] == [theta, l]) {
        page.push_str(&line(row));
    }
    page.push_str(&format!("{PAPER}\n</table>\n"));
    for subject in subjects {
        page.push_str(&format!("<h2>{}</h2>\n", escaped(&subject.name)));
        for measure in measures(plan) {
            let svg = read(folder, &charts::file(subject, measure))?;
            page.push_str(&format!("<div class=\"chart\">{}</div>\n", String::from_utf8_lossy(&svg)));
        }
        for &points in &plan.points {
            page.push_str(&format!("<h3>{points} points</h3>\n"));
            let kinds = [("mosaic", "mosaic"), ("before", "mesh before clean-up"), ("after", "final mesh")];
            for (what, title) in kinds {
                let png = BASE64_STANDARD.encode(read(folder, &subject.file(points, what))?);
                page.push_str(&format!(
                    "<figure><img alt=\"{title}\" src=\"data:image/png;base64,{png}\"><figcaption>{title}</figcaption></figure>\n"
                ));
            }
        }
    }
    page.push_str("</body></html>\n");
    Ok(atomic(&folder.join("study.html"), |writer| writer.write_all(page.as_bytes()))?)
}

fn line(row: &Row) -> String {
    let Row { surface, points, fit, after, faults, side_range, mosaic_ms, mesh_ms, .. } = row;
    let shown = |mean: Option<f64>| mean.map_or("none".to_owned(), |mean| format!("{mean:.3}"));
    let three = |of: &dyn Fn(&Figures) -> String| row.figures().map(of).join("</td><td>");
    format!(
        "<tr><td>{}</td><td>{points}</td><td>{fit}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
         <td>{side_range:.2}</td><td>{faults}</td><td>{:.0}</td></tr>\n",
        escaped(surface),
        after.vertices,
        three(&|figures| format!("{:.3}", figures.qr)),
        three(&|figures| shown(figures.qg)),
        shown(after.tg),
        three(&|figures| figures.irregular.to_string()),
        mosaic_ms + mesh_ms
    )
}

fn read(folder: &Path, name: &str) -> Result<Vec<u8>, StudyError> {
    let path = folder.join(name);
    fs::read(&path).map_err(|error| StudyError::Read { path, reason: error.to_string() })
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
