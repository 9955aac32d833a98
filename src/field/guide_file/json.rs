//! Guides and strokes from JSON.

use super::{Guide, GuideFault, GuideFileError, checked};
use serde::Deserialize;

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct File {
    guides: Vec<Vector>,
    strokes: Vec<Stroke>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Vector {
    point: [f64; 3],
    direction: [f64; 3],
    radius: Option<f64>,
    weight: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Stroke {
    points: Vec<[f64; 3]>,
    radius: Option<f64>,
    weight: Option<f64>,
}

/// Reads guides, then strokes.
pub(super) fn read(text: &str, file: &str) -> Result<Vec<Guide>, GuideFileError> {
    let read = if text.trim_start().starts_with('[') {
        serde_json::from_str(text).map(|guides| File { guides, ..File::default() })
    } else {
        serde_json::from_str(text)
    };
    let File { guides, strokes } = read.map_err(|source| GuideFileError::Json { file: file.to_owned(), source })?;
    let guides = guides.into_iter().map(|vector| {
        let Vector { point, direction, radius, weight } = vector;
        Guide { radius: radius.unwrap_or_default(), weight, ..Guide::vector(point, direction) }
    });
    let strokes = strokes.into_iter().map(|stroke| {
        let Stroke { points, radius, weight } = stroke;
        Guide { radius: radius.unwrap_or_default(), weight, ..Guide::stroke(points) }
    });
    let place = |list: &'static str| move |(number, guide): (usize, Guide)| (format!("{list}[{number}]"), guide);
    let all = guides.enumerate().map(place("guides")).chain(strokes.enumerate().map(place("strokes")));
    all.map(|(place, guide)| {
        let name = format!("{file}, {place}");
        let failed = |fault: GuideFault| GuideFileError::Guide { file: file.to_owned(), place, fault };
        Ok(checked(guide).map_err(failed)?.named(name))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{read, refused};
    use super::*;

    #[test]
    fn guides_and_strokes_are_read() {
        let text = r#"{
            "strokes": [{"points": [[0, 0, 0], [1, 0, 0], [1, 1.5, 0]], "weight": 3, "radius": 1e-2}],
            "guides": [{"point": [1, 2, 3], "direction": [0, -1, 0.5]},
                       {"direction": [1, 0, 0], "point": [0, 0, 0], "radius": 2, "weight": 0.5}]
        }"#;
        let line = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.5, 0.0]];
        let expected = [
            Guide::vector([1.0, 2.0, 3.0], [0.0, -1.0, 0.5]).named("guides.json, guides[0]"),
            Guide::vector([0.0; 3], [1.0, 0.0, 0.0]).within(2.0).with_weight(0.5).named("guides.json, guides[1]"),
            Guide::stroke(line).within(0.01).with_weight(3.0).named("guides.json, strokes[0]"),
        ];
        assert_eq!(read("guides.json", text).expect("they are guides"), expected);
        let bare = r#"[{"point": [1, 2, 3], "direction": [0, -1, 0.5]}]"#;
        assert_eq!(read("guides.json", bare).expect("they are guides"), expected[..1]);
    }

    #[test]
    fn wrong_places_are_named() {
        refused(&[
            ("{\"guides\": [\n{\"point\": [0, 0, 0]}]}", "missing field `direction` at line 2 column 20"),
            ("[{\"point\": [0, 0], \"direction\": [1, 0, 0]}]", "at line 1 column"),
            ("{\"strokes\": [],\n \"guide\": []}", "unknown field `guide`, expected `guides` or `strokes` at line 2"),
            ("[\n{\"point\": [0, 0, 0], \"dir\"", "at line 2 column"),
            ("{\"guides\": [}", "line 1 column 13; write {\"guides\": "),
            ("[{\"point\": [0, 0, 1e999], \"direction\": [1, 0, 0]}]", "number out of range"),
            (
                "[{\"point\": [0, 0, 0], \"direction\": [1, 0, 0]}, {\"point\": [0, 0, 0], \"direction\": [0, 0, 0]}]",
                "guides[1]: the direction (dx, dy, dz) is zero",
            ),
            (
                "[{\"point\": [0, 0, 0], \"direction\": [1, 0, 0], \"radius\": -1}]",
                "guides[0]: the radius -1 is negative",
            ),
            (
                "[{\"point\": [0, 0, 0], \"direction\": [1, 0, 0], \"weight\": 0}]",
                "guides[0]: the weight 0 is not above 0",
            ),
            ("{\"strokes\": [{\"points\": [[1, 1, 1], [1, 1, 1]]}]}", "strokes[0]: the stroke has not two points"),
            ("{\"strokes\": [{\"points\": []}]}", "strokes[0]: the stroke has not two points"),
        ]);
    }
}
