use super::*;
use crate::surface::examples::Example;
use crate::surface::{FeatureOptions, Soup};

fn surface(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Surface {
    let soup = Soup { points: points.to_vec(), triangles: triangles.to_vec(), ..Soup::default() };
    Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A triangle, and another beyond its first edge.
fn two() -> Surface {
    surface(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.2, 1.0, 0.0], [0.4, -1.0, 0.5]], &[[0, 1, 2], [1, 0, 3]])
}

fn euler(points: &[Vec3], twins: &[u32]) -> i64 {
    let open = twins.iter().filter(|&&twin| twin == NONE).count();
    points.len() as i64 - ((twins.len() + open) / 2) as i64 + (twins.len() / 3) as i64
}

/// What is wrong with the parts of a surface.
fn fault(surface: &Surface, split: &Split) -> Option<String> {
    let origin = |h: u32| split.triangles[h as usize / 3][h as usize % 3];
    let target = |h: u32| origin(next(h));
    let facing = |corners: [Vec3; 3]| {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        (b - a).cross(c - a)
    };
    for (h, &twin) in (0..).zip(&split.twins) {
        if twin != NONE && (split.twins[twin as usize] != h || [origin(h), target(h)] != [target(twin), origin(twin)]) {
            return Some(format!("half-edge {h} and its twin {twin} do not agree"));
        }
    }
    let mut covered = vec![0.0; surface.triangle_count()];
    for (corners, &source) in split.triangles.iter().zip(&split.sources) {
        let whole = facing(surface.corners(source as usize));
        let part = facing(corners.map(|v| split.points[v as usize]));
        // Both lie in one plane up to the rounding of f32.
        if part.dot(whole) <= 0.0 || part.normalize().dot(whole.normalize()) < 1.0 - 1e-6 {
            return Some(format!("a part of triangle {source} looks another way"));
        }
        covered[source as usize] += part.length() / whole.length();
    }
    if let Some(t) = covered.iter().position(|share| (share - 1.0).abs() > 1e-5) {
        return Some(format!("the parts of triangle {t} cover {} of it", covered[t]));
    }
    for (h, &[first, last]) in (0..).zip(&split.parts) {
        let ends = [origin(first), target(last)];
        let joined = first == last || target(first) == origin(last);
        if ends != [surface.origin(h), surface.target(h)] || !joined {
            return Some(format!("half-edge {h} has the parts {first} and {last}"));
        }
        let other = surface.twin(h).map_or([NONE; 2], |twin| split.parts[twin as usize]);
        if [first, last].map(|part| split.twins[part as usize]) != [other[1], other[0]] {
            return Some(format!("the parts of half-edge {h} have not those of its twin as twins"));
        }
    }
    let [before, after] = [euler(&surface.points, &surface.twins), euler(&split.points, &split.twins)];
    (before != after).then(|| format!("Euler characteristic {after}, not {before}"))
}

/// The length of all marked edges, each once.
fn marked(split: &Split) -> f64 {
    let point = |h: u32| split.points[split.triangles[h as usize / 3][h as usize % 3] as usize].as_dvec3();
    let lower = split.on_lines.iter().filter(|&&h| h < split.twins[h as usize]);
    lower.map(|&h| point(h).distance(point(next(h)))).sum()
}

fn length(surface: &Surface, line: &[EdgePoint]) -> f64 {
    line.windows(2).map(|pair| pair[0].position(surface).distance(pair[1].position(surface))).sum()
}

#[test]
fn each_way_through_a_triangle_becomes_edges() {
    use EdgePoint::{Edge, Vertex};
    let surface = two();
    // Half-edges 0 to 2 are the first triangle's, 3 to 5 the second's; 0 and 3 are the edge between.
    let cases: [(&str, Vec<EdgePoint>, usize); 9] = [
        ("one edge, from the corner opposite", vec![Vertex(2), Edge(0, 0.3)], 4),
        ("one edge, from both corners opposite", vec![Vertex(2), Edge(0, 0.3), Vertex(3)], 4),
        ("two edges, the first corner cut off", vec![Edge(2, 0.4), Edge(0, 0.6)], 3 + 2),
        ("two edges, the second corner cut off", vec![Edge(0, 0.6), Edge(1, 0.1)], 3 + 2),
        ("two edges, the third corner cut off", vec![Edge(1, 0.9), Edge(2, 0.8)], 3 + 1),
        ("through both triangles", vec![Edge(1, 0.5), Edge(3, 0.2), Edge(5, 0.7)], 3 + 3),
        ("all three edges", vec![Edge(0, 0.4), Edge(1, 0.5), Edge(2, 0.6), Edge(0, 0.4)], 4 + 2),
        ("along an edge", vec![Vertex(0), Vertex(1)], 2),
        ("along an edge and on", vec![Edge(4, 0.5), Vertex(1), Vertex(2)], 2 + 1),
    ];
    for (name, line, count) in cases {
        let split = Split::along(&surface, std::slice::from_ref(&line));
        assert_eq!(fault(&surface, &split), None, "{name}");
        assert_eq!(split.triangles.len(), count, "{name}");
        assert!((marked(&split) - length(&surface, &line)).abs() < 1e-6, "{name}");
        let places: Vec<usize> = line.iter().filter(|place| matches!(place, Edge(..))).map(|_| 0).collect();
        let cuts = split.points.len() - surface.points.len();
        assert_eq!(cuts, places.len() - usize::from(name == "all three edges"), "{name}");
    }
}

#[test]
fn the_shorter_diagonal_halves_what_is_left() {
    // The cuts are vertices 4 and 5; the two diagonals of the quad that is left, the shorter first.
    let cases = [([(0, 0.8), (1, 0.8)], [[0, 5], [4, 2]]), ([(1, 0.9), (2, 0.1)], [[4, 0], [1, 5]])];
    for (cuts, diagonals) in cases {
        let split = Split::along(&two(), &[cuts.map(|(h, share)| EdgePoint::Edge(h, share)).to_vec()]);
        let [shorter, longer] = diagonals.map(|[v, w]: [u32; 2]| {
            let joined = split.triangles.iter().any(|t| t.contains(&v) && t.contains(&w));
            (split.points[v as usize].distance(split.points[w as usize]), joined)
        });
        assert!(shorter.0 < longer.0, "the case is the one meant");
        assert_eq!([shorter.1, longer.1], [true, false], "{cuts:?}");
    }
}

#[test]
fn broken_parts_are_seen() {
    let surface = two();
    let good =
        || Split::along(&surface, &[vec![EdgePoint::Edge(1, 0.5), EdgePoint::Edge(0, 0.8), EdgePoint::Edge(5, 0.7)]]);
    assert_eq!(fault(&surface, &good()), None);
    let seen = |change: fn(&mut Split), part: &str| {
        let mut split = good();
        change(&mut split);
        let fault = fault(&surface, &split).unwrap_or_default();
        assert!(fault.contains(part), "{fault:?} instead of {part:?}");
    };
    seen(|split| split.twins.swap(0, 1), "do not agree");
    seen(|split| split.points[4].z += 0.1, "looks another way");
    seen(|split| split.parts[0].swap(0, 1), "has the parts");
    seen(|split| split.sources.swap(0, 5), "of triangle");
    seen(|split| split.points.push(Vec3::ZERO), "Euler");
}

#[test]
fn lines_all_over_a_surface_leave_its_shape() {
    for name in Example::NAMES {
        let soup = name.parse::<Example>().expect("an example").generate(1_000);
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        // Through every third triangle, each time between two other edges or from a corner.
        let mut taken = vec![false; 3 * surface.triangle_count()];
        let mut lines = Vec::new();
        for t in (0..surface.triangle_count() as u32).step_by(3) {
            let k = t / 3 % 3;
            let [g, h] = [3 * t + k, 3 * t + (k + 1) % 3];
            let sides = [g, h].map(|h| h.min(surface.twins[h as usize]) as usize);
            if sides.iter().any(|&side| taken[side]) {
                continue;
            }
            sides.iter().for_each(|&side| taken[side] = true);
            let share = 0.1 + 0.8 * f64::from(t % 7) / 6.0;
            lines.push(vec![EdgePoint::Edge(g, share), EdgePoint::Edge(h, 1.0 - share)]);
        }
        assert!(lines.len() > 100, "{name}");
        let split = Split::along(&surface, &lines);
        assert_eq!(fault(&surface, &split), None, "{name}");
        let wanted: f64 = lines.iter().map(|line| length(&surface, line)).sum();
        assert!((marked(&split) / wanted - 1.0).abs() < 1e-5, "{name}");
        assert!(split.triangles.len() > surface.triangle_count() + 2 * lines.len(), "{name}");
    }
}
