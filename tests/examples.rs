//! Invariants of the example surfaces, at several resolutions.

use std::collections::{BTreeMap, BTreeSet};

use quadmosaic::surface::Soup;
use quadmosaic::surface::examples::{Example, M6Options};

type Vector = [f64; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

fn corners(soup: &Soup) -> impl Iterator<Item = [Vector; 3]> {
    soup.triangles.iter().map(|triangle| triangle.map(|index| soup.points[index as usize]))
}

fn area(soup: &Soup) -> f64 {
    corners(soup).map(|[a, b, c]| 0.5 * length(cross(minus(b, a), minus(c, a)))).sum()
}

/// Enclosed volume. For a surface open in a plane through the origin, the volume it encloses together with that plane.
fn volume(soup: &Soup) -> f64 {
    corners(soup).map(|[a, b, c]| dot(a, cross(b, c)) / 6.0).sum()
}

/// The smallest angle of each triangle in degrees, ascending.
fn smallest_angles(soup: &Soup) -> Vec<f64> {
    let angle = |a, b, c| {
        let (b, c) = (minus(b, a), minus(c, a));
        length(cross(b, c)).atan2(dot(b, c)).to_degrees()
    };
    let mut angles: Vec<f64> =
        corners(soup).map(|[a, b, c]| angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b))).collect();
    angles.sort_by(f64::total_cmp);
    angles
}

fn bounds(soup: &Soup) -> [Vector; 2] {
    let around = |pick: fn(f64, f64) -> f64| {
        soup.points.iter().copied().reduce(|a, b| std::array::from_fn(|axis| pick(a[axis], b[axis])))
    };
    [around(f64::min), around(f64::max)].map(|corner| corner.expect("a surface has points"))
}

/// Euler characteristic and number of boundary loops of a manifold, consistently oriented surface without loose or
/// doubled points; otherwise the first reason why it is none.
fn topology(soup: &Soup) -> Result<(i64, usize), String> {
    let mut edges = BTreeSet::new();
    let mut around = vec![Vec::new(); soup.points.len()];
    for &[a, b, c] in &soup.triangles {
        for [from, to, far] in [[a, b, c], [b, c, a], [c, a, b]] {
            if from == to || !edges.insert((from, to)) {
                return Err(format!("edge {from}-{to} is degenerate, not manifold or not consistently oriented"));
            }
            around[from as usize].push((to, far));
        }
    }
    for (point, fan) in around.iter().enumerate() {
        // Walk the triangles round the point, from its open side where it has one.
        let next: BTreeMap<_, _> = fan.iter().copied().collect();
        let entered: BTreeSet<_> = fan.iter().map(|&(_, far)| far).collect();
        let Some(start) = next.keys().find(|to| !entered.contains(to)).or(next.keys().next()) else {
            return Err(format!("point {point} has no triangle"));
        };
        let mut steps = 0;
        let mut at = *start;
        while let Some(&far) = next.get(&at) {
            steps += 1;
            at = far;
            if at == *start {
                break;
            }
        }
        if steps != fan.len() {
            return Err(format!("point {point} has more than one fan"));
        }
    }
    let bits: BTreeSet<_> = soup.points.iter().map(|point| point.map(f64::to_bits)).collect();
    if bits.len() != soup.points.len() {
        return Err("some points are doubled".into());
    }
    let boundary: BTreeMap<_, _> = edges.iter().filter(|&&(a, b)| !edges.contains(&(b, a))).copied().collect();
    let mut open: BTreeSet<_> = boundary.keys().copied().collect();
    let mut loops = 0;
    while let Some(mut at) = open.pop_first() {
        loops += 1;
        while open.remove(&boundary[&at]) {
            at = boundary[&at];
        }
    }
    let edge_count = (edges.len() + boundary.len()) / 2;
    Ok((soup.points.len() as i64 - edge_count as i64 + soup.triangles.len() as i64, loops))
}

fn wing(blunt: bool, flat_tip: bool, whole_span: bool) -> Example {
    Example::M6(M6Options { blunt, flat_tip, whole_span })
}

fn all() -> Vec<Example> {
    let mut all = vec![Example::Torus, Example::Sphere, Example::Plate, Example::Block];
    for bits in 0..8 {
        all.push(wing(bits & 1 != 0, bits & 2 != 0, bits & 4 != 0));
    }
    all
}

#[test]
fn every_example_is_a_manifold_of_the_right_kind() {
    for example in all() {
        let expected = match example {
            Example::Torus | Example::Block => (0, 0),
            Example::Sphere => (2, 0),
            Example::Plate => (0, 2),
            Example::M6(M6Options { whole_span: true, .. }) => (2, 0),
            Example::M6(_) => (1, 1),
        };
        for count in [0, 500, 3_000, 20_000] {
            assert_eq!(topology(&example.generate(count)), Ok(expected), "{example:?}, {count} triangles");
        }
    }
}

#[test]
fn the_topology_check_sees_what_is_wrong() {
    let whole = Example::Sphere.generate(500);
    let mut holed = whole.clone();
    holed.triangles.pop();
    assert_eq!(topology(&holed), Ok((1, 1)));
    let mut flipped = whole.clone();
    flipped.triangles[7].swap(0, 1);
    assert!(topology(&flipped).is_err());
    let mut doubled = whole.clone();
    doubled.points.push(doubled.points[0]);
    assert!(topology(&doubled).is_err());
    let mut pinched = whole;
    let count = pinched.points.len() as u32;
    pinched.points.extend([[2.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    pinched.triangles.push([0, count, count + 1]);
    assert!(topology(&pinched).is_err());
}

#[test]
fn the_count_is_about_what_was_asked_for() {
    for example in all() {
        for asked in [500, 610, 777, 1_000, 1_300, 5_000, 20_000, 100_000, 1_000_000] {
            let made = example.generate(asked).triangles.len();
            assert!(made * 10 >= asked * 8 && made * 10 <= asked * 12, "{example:?}: asked {asked}, made {made}");
        }
    }
}

#[test]
fn the_same_call_gives_the_same_bytes() {
    for example in all() {
        assert_eq!(example.generate(2_000), example.generate(2_000), "{example:?}");
    }
}

#[test]
fn every_example_faces_outward() {
    for example in all() {
        let soup = example.generate(20_000);
        match example {
            Example::Plate => {
                assert!(corners(&soup).all(|[a, b, c]| cross(minus(b, a), minus(c, a))[2] > 0.0), "the plate faces up")
            }
            _ => assert!(volume(&soup) > 0.0, "{example:?}"),
        }
    }
}

#[test]
fn sizes_are_those_of_the_closed_forms() {
    use std::f64::consts::PI;
    // Chords of a circle of n steps lose (2 pi / n)^2 / 6 of its area: below 0.2 % with more than 60 steps, which
    // each of these has at 20,000 triangles; a surface curved both ways loses at most twice that.
    let near = |what: &str, found: f64, exact: f64| {
        assert!((found / exact - 1.0).abs() < 0.004, "{what}: {found} instead of {exact}");
    };
    let [torus, sphere, plate, block] =
        [Example::Torus, Example::Sphere, Example::Plate, Example::Block].map(|example| example.generate(20_000));
    near("area of the torus", area(&torus), 4.0 * PI * PI * 0.4);
    near("volume of the torus", volume(&torus), 2.0 * PI * PI * 0.16);
    near("area of the sphere", area(&sphere), 4.0 * PI);
    near("volume of the sphere", volume(&sphere), 4.0 / 3.0 * PI);
    near("area of the plate", area(&plate), 1.0 - 0.04 * PI);
    near("volume of the block", volume(&block), 4.0 - 0.49 * PI);
    near("area of the block", area(&block), 2.0 * (4.0 - 0.49 * PI) + 8.0 + 1.4 * PI);
    assert_eq!(bounds(&plate), [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(bounds(&block), [[-1.0, -1.0, -0.5], [1.0, 1.0, 0.5]]);
}

#[test]
fn triangles_are_well_shaped() {
    for example in all() {
        for count in [500, 3_000, 20_000, 100_000] {
            let angles = smallest_angles(&example.generate(count));
            let slender = angles.partition_point(|&angle| angle < 20.0) as f64 / angles.len() as f64;
            let median = angles[angles.len() / 2];
            println!("{example:?} {count}: smallest {:.2}, median {median:.1}, below 20: {slender:.4}", angles[0]);
        }
    }
}
