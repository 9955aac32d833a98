//! Pictures as SVG: what is visible, each face after those that it hides.

use super::legend::{Layout, MARKS};
use super::order::painting_order;
use super::raster::{EMPTY, FINE, Sight};
use super::scene::{Corner, Face, NO_PEN};
use super::shading::shaded;
use super::view::Camera;
use super::{Colour, Legend, PictureError, Scene, View};
use glam::{DVec3, Vec3Swizzles};
use std::fmt::Write;

/// Lines are seen or not in pieces of at most so many pixels.
const LONGEST: f64 = 8.0;

/// A scene as SVG. Faces of which no sample is visible are left out.
///
/// # Errors
/// As [`Image::of`](super::Image::of).
pub(super) fn svg(scene: &Scene, view: &View, size: [u32; 2]) -> Result<String, PictureError> {
    let camera = Camera::new(scene, view, size)?;
    let scene = &scene.with_lines_cut(LONGEST, |line| {
        let [a, b] = line.ends.map(|end| camera.project(end).xy());
        a.distance(b)
    });
    let sight = Sight::new(scene, &camera);
    let seen = sight.each_band(|band| {
        let mut seen: Vec<u32> = band.seen.iter().copied().filter(|&seen| seen != EMPTY).collect();
        seen.sort_unstable();
        seen.dedup();
        seen
    });
    let mut seen = seen.concat();
    seen.sort_unstable();
    seen.dedup();
    let lines = seen.split_off(seen.partition_point(|&seen| (seen as usize) < scene.faces.len()));

    let [width, height] = size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         stroke-linecap=\"round\" stroke-linejoin=\"round\">\n<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
        Colour::PAPER.hex()
    );
    for face in painting_order(&sight, &seen) {
        draw_face(&mut text, &sight, &scene.faces[face as usize]);
    }
    for seen in lines {
        let Some((number, line)) = sight.line(seen) else { continue };
        let pen = line.pen as usize;
        let [a, b] = sight.ends(number);
        stroke(&mut text, &format!("{}L{}", place(a), place(b)), scene.pens[pen].colour, sight.widths[pen]);
    }
    if let Some(legend) = &scene.legend {
        draw_legend(&mut text, legend, size);
    }
    text.push_str("</svg>\n");
    Ok(text)
}

fn draw_face(text: &mut String, sight: &Sight, face: &Face) {
    let corners = sight.scene.corners_of(face);
    let places: Vec<String> = sight.outline(face).map(place).collect();
    let fill = shaded(sight, face, None);
    let pen = corners[0].pen;
    let one = corners.iter().all(|corner| corner.pen == pen);
    // Without a line of its own colour, what lies behind would shine through between faces.
    let (colour, width) = match one && pen != NO_PEN {
        true => (sight.scene.pens[pen as usize].colour, sight.widths[pen as usize]),
        false => (fill, FINE as f64 / 2.0),
    };
    let path = places.join("L");
    let (fill, colour) = (fill.hex(), colour.hex());
    writeln!(text, "<path d=\"M{path}Z\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"{}\"/>", pixels(width))
        .expect("a string takes all");
    if !one {
        let drawn = |(_, corner): &(usize, &Corner)| corner.pen != NO_PEN;
        for (k, corner) in corners.iter().enumerate().filter(drawn) {
            let pen = corner.pen as usize;
            let path = format!("{}L{}", places[k], places[(k + 1) % places.len()]);
            stroke(text, &path, sight.scene.pens[pen].colour, sight.widths[pen]);
        }
    }
}

fn stroke(text: &mut String, path: &str, colour: Colour, width: f64) {
    writeln!(text, "<path d=\"M{path}\" stroke=\"{}\" stroke-width=\"{}\"/>", colour.hex(), pixels(width))
        .expect("a string takes all");
}

fn draw_legend(text: &mut String, legend: &Legend, size: [u32; 2]) {
    let Layout { left, top, width, height, text: letters } = Layout::of(size);
    let ink = Colour::INK.hex();
    let steps = 20;
    let mut put = |line: String| {
        text.push_str(&line);
        text.push('\n');
    };
    put("<defs><linearGradient id=\"quality\">".to_owned());
    for step in 0..=steps {
        let share = f64::from(step) / f64::from(steps);
        put(format!("<stop offset=\"{share}\" stop-color=\"{}\"/>", Colour::of_quality(share).hex()));
    }
    put("</linearGradient></defs>".to_owned());
    put(format!(
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"url(#quality)\"/>"
    ));
    put(format!("<g font-family=\"sans-serif\" font-size=\"{:.1}\" fill=\"{ink}\">", 0.8 * letters));
    let title = legend.title.replace('&', "&amp;").replace('<', "&lt;");
    put(format!("<text x=\"{left:.1}\" y=\"{:.1}\">{title}</text>", top - 0.5 * letters));
    for ((share, mark), anchor) in MARKS.into_iter().zip(["start", "middle", "end"]) {
        let (x, y) = (left + share * width, top + height + letters);
        put(format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{mark}</text>"));
    }
    put("</g>".to_owned());
}

/// A place in pixels, to a hundredth.
fn place(at: DVec3) -> String {
    let [x, y] = at.xy().to_array().map(pixels);
    format!("{x} {y}")
}

fn pixels(samples: f64) -> f64 {
    (samples / FINE as f64 * 100.0).round() / 100.0 + 0.0
}
