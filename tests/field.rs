//! The cross field: constant where it can be, of the right total index, and along every feature.

mod common;

use common::surfaces::{EXAMPLES, example, flat, surface, unit_corners};
use glam::DVec3;
use quadmosaic::compute::{Complex, Cpu};
use quadmosaic::field::{Align, Field, FieldOptions, Guide, GuideTrouble, SingularityLocation};
use quadmosaic::mosaic::seed;
use quadmosaic::surface::{FeatureOptions, Soup, Surface};
use std::f64::consts::FRAC_PI_2;

fn field(surface: &Surface, guides: &[Guide]) -> Field {
    Field::new(surface, &FieldOptions::guided(guides), &Cpu).expect("the CPU does not fail")
}

/// The angle of a cross from its representation number, in -pi/4..=pi/4.
fn angle(z: Complex) -> f64 {
    f64::from(z[1]).atan2(f64::from(z[0])) / 4.0
}

/// A difference of two crosses' angles, in -pi/4..=pi/4.
fn wrapped(angle: f64) -> f64 {
    angle - (angle / FRAC_PI_2).round() * FRAC_PI_2
}

/// The largest angle between the field and a direction in the plane z = 0, at many places.
fn off(surface: &Surface, field: &Field, direction: f64) -> f64 {
    let tiles = seed::seed(surface, field, 0.01);
    assert!(tiles.len() > 2_000);
    let turn = |axis: [f32; 3]| f64::from(axis[1]).atan2(f64::from(axis[0]));
    tiles.iter().map(|tile| wrapped(turn(tile.axis) - direction).abs()).fold(0.0, f64::max)
}

#[test]
fn on_a_rectangle_the_field_is_constant() {
    // Sides, guide and all the links between agree, so that nothing is left to smooth but rounding.
    for turn in [0.0, 0.3, 1.1] {
        let (s, c) = f64::sin_cos(turn);
        let mut soup = flat(30, 20, 0.1);
        soup.points.iter_mut().for_each(|p| *p = [c * p[0] - s * p[1], s * p[0] + c * p[1], 0.0]);
        let plate = surface(&soup);
        let guide = Guide::vector(soup.points[200], [c, s, 0.0]);
        for guides in [&[][..], &[guide]] {
            let constant = field(&plate, guides);
            assert!(off(&plate, &constant, turn) < 1e-4, "{turn}: {}", off(&plate, &constant, turn));
        }
        // A guide against the sides bends it.
        let against = Guide::vector(soup.points[200], [(turn + 0.5).cos(), (turn + 0.5).sin(), 0.0]);
        let bent = field(&plate, &[against]);
        assert!(off(&plate, &bent, turn) > 0.3, "the guide is followed at its point");
    }
}

/// A developable surface: the soup, and its triangles' corners laid out in the plane.
struct Developed {
    soup: Soup,
    laid_out: Vec<[[f64; 2]; 3]>,
}

/// `columns` by `rows` quads between `place(i, j)`, which gives a point in space and its place in the plane.
fn developed(columns: usize, rows: usize, place: impl Fn(usize, usize) -> ([f64; 3], [f64; 2])) -> Developed {
    let grid = flat(columns, rows, 1.0);
    let (points, plane): (Vec<_>, Vec<_>) =
        grid.points.iter().map(|p| place(p[0].round() as usize, p[1].round() as usize)).unzip();
    let laid_out = grid.triangles.iter().map(|corners| corners.map(|corner| plane[corner as usize])).collect();
    Developed { soup: Soup { points, triangles: grid.triangles, ..Soup::default() }, laid_out }
}

/// A tube of flat strips along z, a whole turn round; its ends are open.
fn tube(columns: usize, rows: usize) -> Developed {
    let width = 2.0 * (std::f64::consts::PI / columns as f64).sin();
    developed(columns, rows, |i, j| {
        // The last column is the first, for welding.
        let (s, c) = (std::f64::consts::TAU * (i % columns) as f64 / columns as f64).sin_cos();
        let height = 0.7 * width * j as f64;
        ([c, s, height], [width * i as f64, height])
    })
}

/// A cone of flat strips, cut open, half a turn round, that lies in the plane as a square with a smaller one taken out of
/// one corner: all its sides are straight there.
fn cone(columns: usize, rows: usize) -> Developed {
    use std::f64::consts::PI;
    // Strips that are `narrow` wide at the apex in the plane make half a turn in space: of two unit vectors along
    // neighbouring rulings, cos narrow = sin^2 cos(turn) + cos^2, with the angle between ruling and axis.
    let (narrow, turn) = (FRAC_PI_2 / columns as f64, PI / columns as f64);
    let sine = ((1.0 - narrow.cos()) / (1.0 - turn.cos())).sqrt();
    developed(columns, rows, |i, j| {
        let (s, c) = (narrow * i as f64).sin_cos();
        let along = (1.0 + j as f64 / rows as f64) / s.max(c);
        let (around_s, around_c) = (turn * i as f64).sin_cos();
        let radius = along * sine;
        ([radius * around_c, radius * around_s, along * (1.0 - sine * sine).sqrt()], [along * s, along * c])
    })
}

/// The largest angle between a field and the direction of x in the plane.
fn off_constant(field: &Field, laid_out: &[[[f64; 2]; 3]]) -> f64 {
    let off = |(crosses, [a, b, _]): (&[Complex; 3], &[[f64; 2]; 3])| {
        let edge = (b[1] - a[1]).atan2(b[0] - a[0]);
        crosses.iter().map(|&z| wrapped(angle(z) + edge).abs()).fold(0.0, f64::max)
    };
    field.in_triangles().iter().zip(laid_out).map(off).fold(0.0, f64::max)
}

#[test]
fn on_developable_surfaces_the_field_is_constant() {
    let square = developed(150, 150, |i, j| {
        let (s, c) = 0.3f64.sin_cos();
        let [x, y] = [i as f64, j as f64];
        ([c * x - s * y, s * x + c * y, 0.0], [x, y])
    });
    for (name, developed) in [("square", square), ("tube", tube(200, 150)), ("cone", cone(200, 120))] {
        let surface = surface(&developed.soup);
        assert_eq!(surface.triangle_count(), developed.laid_out.len(), "{name}");
        let constant = field(&surface, &[]);
        let off = off_constant(&constant, &developed.laid_out);
        println!("{name}: {off:.1e} radians from constant");
        // A triangle's crosses are turned to its first edge in f32: 2^-24 of four times the angle; the field's links are
        // unit numbers of as many digits, and their errors add up over some hundred rows.
        assert!(off < 1e-4, "{name}: {off}");
        let middle = developed.soup.points[developed.soup.points.len() / 2];
        let guide = Guide::vector(middle, [0.3, 0.2, 0.6]);
        assert!(off_constant(&field(&surface, &[guide]), &developed.laid_out) > 0.1, "{name}: a guide bends it");
    }
}

#[test]
fn a_guide_is_followed_within_its_radius() {
    let soup = flat(40, 40, 1.0);
    let plate = surface(&soup);
    let centre = [20.0, 20.0, 0.0];
    let guide = Guide::vector(centre, [0.8, 0.6, 0.5]).within(6.0);
    let guided = field(&plate, &[guide]);
    let turn = 0.6f64.atan2(0.8);
    let (mut inside, mut outside) = (0, 0);
    for tile in seed::seed(&plate, &guided, 0.01) {
        let at = DVec3::from(plate.frame().to_model(tile.position.map(f64::from)));
        let off = wrapped(f64::from(tile.axis[1]).atan2(f64::from(tile.axis[0])) - turn).abs();
        let distance = at.distance(DVec3::from(centre));
        // A triangle reaches 1.5 beyond its corners.
        if distance < 4.5 {
            assert!(off < 1e-4, "{distance} from the guide's point: {off}");
            inside += 1;
        } else if distance > 18.0 {
            outside += usize::from(off > 0.3);
        }
    }
    assert!(inside > 100 && outside > 100, "{inside} inside, {outside} outside that follow the sides");
}

/// On a strip between 0 degrees (the boundary x = 0) and `degrees` (a column of guides), the crosses' angles by column.
fn across(columns: usize, degrees: f64) -> Vec<f64> {
    // Ten times as high as wide: the ends die away as exp(-pi y / width), to 1e-6 at the middle.
    let rows = 10 * columns;
    let soup = flat(2 * columns, rows, 1.0);
    let strip = surface(&soup);
    let (s, c) = degrees.to_radians().sin_cos();
    let guides: Vec<Guide> =
        (0..=rows).map(|j| Guide::vector([columns as f64, j as f64, 0.0], [c, s, 0.0]).within(0.1)).collect();
    let field = field(&strip, &guides);
    let mut found = vec![f64::NAN; columns + 1];
    for (t, corners) in soup.triangles.iter().enumerate() {
        let first = DVec3::from(soup.points[corners[1] as usize]) - DVec3::from(soup.points[corners[0] as usize]);
        for (k, &corner) in corners.iter().enumerate() {
            let [x, y, _] = soup.points[corner as usize];
            if x <= columns as f64 && y == (rows / 2) as f64 {
                found[x as usize] = wrapped(angle(field.in_triangles()[t][k]) + first.y.atan2(first.x)).to_degrees();
            }
        }
    }
    found
}

#[test]
fn between_two_directions_the_field_interpolates() {
    let (columns, degrees) = (32, 20.0);
    let found = across(columns, degrees);
    // The guides reach the nearest triangle too, which may lie on the near side: the last column but one is not tested.
    assert!(found[0].abs() < 1e-3 && (found[columns] - degrees).abs() < 1e-3, "{found:?}");
    // Four times the angle is what is interpolated, linearly: the chord between two representation numbers, not the arc.
    let turn = 4.0 * degrees.to_radians();
    let harmonic = |x: f64| (x * turn.sin()).atan2(1.0 + x * (turn.cos() - 1.0)).to_degrees() / 4.0;
    for (i, &angle) in found.iter().enumerate().take(columns - 1) {
        let wanted = harmonic(i as f64 / columns as f64);
        assert!((angle - wanted).abs() < 0.5, "column {i}: {angle}, not {wanted}: {found:?}");
    }
    assert!(found.windows(2).all(|w| w[1] >= w[0] - 1e-3), "monotone: {found:?}");
    let opposite = across(columns, -degrees);
    assert!(found.iter().zip(&opposite).all(|(a, b)| (a + b).abs() < 0.2), "mirrored: {found:?} {opposite:?}");
}

/// The quarters of a turn that the field makes round all triangles together.
///
/// In a triangle the three crosses' differences add up to quarters of a turn. The two triangles at an edge read one
/// difference with the edge's curvature between them, which is small, so both must round it to the same branch.
fn total_quarters(surface: &Surface, crosses: &[[Complex; 3]], twins: &[Option<usize>]) -> i64 {
    let difference = |h: usize| wrapped(angle(crosses[h / 3][(h + 1) % 3]) - angle(crosses[h / 3][h % 3]));
    let branch = |h: usize| match twins[h] {
        Some(twin) if twin < h => {
            let wanted = -difference(twin);
            wanted + wrapped(difference(h) - wanted)
        }
        _ => difference(h),
    };
    (0..surface.triangle_count())
        .map(|t| {
            let quarters = (3 * t..3 * t + 3).map(branch).sum::<f64>() / FRAC_PI_2;
            assert!((quarters - quarters.round()).abs() < 1e-4, "triangle {t}: {quarters}");
            quarters.round() as i64
        })
        .sum()
}

/// The other half-edge of each, from the soup's indices: half-edge `3 t + k` runs from corner `k` of triangle `t`.
fn twins(soup: &Soup) -> Vec<Option<usize>> {
    let ends = |h: usize| (soup.triangles[h / 3][h % 3], soup.triangles[h / 3][(h + 1) % 3]);
    let all: std::collections::HashMap<_, _> = (0..3 * soup.triangles.len()).map(|h| (ends(h), h)).collect();
    (0..3 * soup.triangles.len()).map(|h| all.get(&(ends(h).1, ends(h).0)).copied()).collect()
}

/// The quarters that the field must make: four times the Euler characteristic, less what the corners of features turn.
fn wanted_quarters(surface: &Surface, field: &Field, soup: &Soup, characteristic: i64) -> i64 {
    let boundary: std::collections::HashSet<u32> = twins(soup)
        .iter()
        .enumerate()
        .filter(|(_, twin)| twin.is_none())
        .flat_map(|(h, _)| [h, h / 3 * 3 + (h + 1) % 3])
        .map(|h| field.sectors().of_corner[h])
        .collect();
    let at_corners: i64 = surface
        .features()
        .corners()
        .map(|v| {
            let sectors = field.sectors().of_vertex(v);
            let quarters: i64 = sectors.iter().map(|&s| i64::from(field.sectors().quarters[s as usize])).sum();
            let flat = if sectors.iter().any(|s| boundary.contains(s)) { 2 } else { 4 };
            flat - quarters
        })
        .sum();
    4 * characteristic - at_corners
}

#[test]
fn the_field_turns_as_often_as_the_surface_asks() {
    // The wing is left to the unit test of sectors: where its trailing edge ends at the tip it is a cone of 171 degrees,
    // and more than an eighth of a turn lies on one edge.
    for (name, characteristic, _) in EXAMPLES.into_iter().filter(|example| example.0 != "m6") {
        let soup = example(name, 4_000);
        let surface = surface(&soup);
        let field = field(&surface, &[]);
        let twins = twins(&soup);
        let found = total_quarters(&surface, field.in_triangles(), &twins);
        let wanted = wanted_quarters(&surface, &field, &soup, characteristic);
        assert_eq!(found, wanted, "{name}");
        let by_hand = match name {
            "sphere" => 8,
            "torus" => 0,
            // A square's four corners are quarters; on the block three squares meet at each of eight.
            "plate" => -4,
            "block" => -8,
            _ => wanted,
        };
        assert_eq!(wanted, by_hand, "{name}");
        if name == "sphere" {
            // Each cross mirrored in its triangle's first edge: a field that turns the other way.
            let mirrored: Vec<_> = field.in_triangles().iter().map(|z| z.map(|[x, y]| [x, -y])).collect();
            assert_ne!(total_quarters(&surface, &mirrored, &twins), found);
        }
    }
}

#[test]
fn the_cross_follows_every_feature() {
    for name in ["block", "plate", "m6"] {
        let soup = example(name, 4_000);
        let surface = surface(&soup);
        let field = field(&surface, &[]);
        let features = surface.features();
        // Between two vertices of a smooth curve the cross at each is along the curve's tangent there, half the turn at
        // the vertex off the edge; on a sector of other than 90 or 180 degrees its scaling adds the excess's half.
        let (mut tested, mut blunt) = (0, 0);
        for h in 0..3 * surface.triangle_count() {
            if !features.is_feature(h as u32) {
                continue;
            }
            let (t, k) = (h / 3, h % 3);
            let corners = unit_corners(&soup, surface.frame(), t);
            let sides = [0, 1, 2].map(|i| corners[(i + 1) % 3] - corners[i]);
            let up = sides[0].cross(sides[1]).normalize();
            let edge = (sides[0].cross(sides[k]).dot(up)).atan2(sides[0].dot(sides[k]));
            for end in [k, (k + 1) % 3] {
                let sector = field.sectors().of_corner[3 * t + end] as usize;
                let quarters = f64::from(field.sectors().quarters[sector]);
                assert!(quarters > 0.0, "{name}: a feature's sector is not whole");
                let angles: f64 = sector_angle(&surface, &soup, &field, sector as u32);
                // The triangle's corner is a share of the sector, and so is its part of the excess.
                let excess = (angles - quarters * FRAC_PI_2).abs();
                let off = wrapped(angle(field.in_triangles()[t][end]) - edge).abs();
                assert!(off <= excess / 2.0 + 1e-4, "{name}, half-edge {h}: {off} off, {excess} excess");
                blunt += usize::from(excess > 0.5);
                tested += 1;
            }
        }
        assert!(
            tested > 100 && blunt <= 2,
            "{name}: {tested} ends, {blunt} of them scaled so much that they say nothing"
        );
    }
    // Where an edge is no feature, the field need not follow it.
    let soup = example("block", 4_000);
    let smooth =
        Surface::new(&soup, &FeatureOptions { crease: 95.0, ..FeatureOptions::default() }).expect("an example");
    assert!(field(&smooth, &[]).sectors().quarters.iter().all(|&q| q == 0));
}

/// The sum of a sector's corner angles in space.
fn sector_angle(surface: &Surface, soup: &Soup, field: &Field, sector: u32) -> f64 {
    let of_corner = &field.sectors().of_corner;
    (0..of_corner.len())
        .filter(|&c| of_corner[c] == sector)
        .map(|c| {
            let corners = unit_corners(soup, surface.frame(), c / 3);
            let [o, p, q] = [0, 1, 2].map(|i| corners[(c + i) % 3]);
            (p - o).angle_between(q - o)
        })
        .sum()
}

#[test]
fn the_field_is_the_same_every_time() {
    let block = surface(&example("block", 3_000));
    let crosses = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| field(&block, &[]).crosses().to_vec())
    };
    let once = crosses(1);
    assert_eq!(once, crosses(1));
    assert_eq!(once, crosses(2));
    let guide = Guide::vector([0.9, 0.0, 0.5], [1.0, 0.5, 0.0]);
    assert_ne!(once, field(&block, &[guide]).crosses());
    assert!(once.iter().all(|z| (f64::from(z[0]).hypot(f64::from(z[1])) - 1.0).abs() < 1e-6), "unit numbers");
}

#[test]
fn singularities_add_up_to_the_euler_characteristic() {
    for (name, characteristic, _) in EXAMPLES {
        let soup = example(name, 4_000);
        let surface = surface(&soup);
        let field = field(&surface, &[]);
        let found = field.singularities(&surface);
        assert_eq!(found.iter().map(|s| s.quarters).sum::<i32>(), 4 * characteristic as i32, "{name}");
        let in_triangles: i32 =
            found.iter().filter(|s| matches!(s.location, SingularityLocation::Triangle(_))).map(|s| s.quarters).sum();
        if name != "m6" {
            let crosses = field.in_triangles();
            assert_eq!(i64::from(in_triangles), total_quarters(&surface, crosses, &twins(&soup)), "{name}");
        }
        for singularity in &found {
            assert_ne!(singularity.quarters, 0, "{name}");
            let place = DVec3::from(singularity.position);
            match singularity.location {
                SingularityLocation::Triangle(t) => {
                    let corners = unit_corners(&soup, surface.frame(), t as usize);
                    assert!(common::surfaces::distance(place, corners) < 1e-6, "{name}: {singularity:?}");
                }
                SingularityLocation::Corner(v) => assert!(surface.features().is_corner(v), "{name}: {singularity:?}"),
            }
        }
        match name {
            "sphere" => assert!(found.len() == 8 && found.iter().all(|s| s.index() == 0.25), "{found:?}"),
            // Three right angles at each of eight corners; the bore has none.
            "block" => {
                let corners: Vec<_> =
                    found.iter().filter(|s| matches!(s.location, SingularityLocation::Corner(_))).collect();
                assert!(corners.len() == 8 && corners.iter().all(|s| s.index() == 0.25), "{found:?}");
                assert_eq!(in_triangles, -8);
            }
            _ => {}
        }
    }
}

#[test]
fn without_features_the_field_alone_makes_up_the_euler_characteristic() {
    for (name, characteristic) in [("fish_blub", 2), ("spot", 2), ("anchor", -6)] {
        let Some(path) = common::shared(&format!("models/{name}.obj")) else { continue };
        let soup = quadmosaic::surface::load::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let smooth = FeatureOptions { crease: 180.0, ..FeatureOptions::default() };
        let surface = Surface::new(&soup, &smooth).unwrap_or_else(|error| panic!("{error}"));
        let found = field(&surface, &[]).singularities(&surface);
        assert!(
            found.iter().all(|s| matches!(s.location, SingularityLocation::Triangle(_))),
            "{name}: no features, no corners"
        );
        assert_eq!(found.iter().map(|s| s.quarters).sum::<i32>(), 4 * characteristic, "{name}");
    }
}

/// The angle of a field's cross in degrees, against the x axis, in the triangle under a point of the plane z = 0.
fn degrees_at(soup: &Soup, surface: &Surface, field: &Field, place: [f64; 2]) -> f64 {
    let place = DVec3::from(surface.frame().to_unit([place[0], place[1], 0.0]));
    let distance = |t: usize| common::surfaces::distance(place, unit_corners(soup, surface.frame(), t));
    let t = (0..surface.triangle_count()).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).expect("a triangle");
    let corners = unit_corners(soup, surface.frame(), t);
    let first = corners[1] - corners[0];
    wrapped(angle(field.in_triangles()[t][0]) + first.y.atan2(first.x)).to_degrees()
}

#[test]
fn a_weight_draws_the_field_part_of_the_way() {
    let soup = flat(60, 60, 1.0);
    let plate = surface(&soup);
    let centre = [30.0, 30.0];
    let guide = Guide::vector([30.0, 30.0, 0.0], [20f64.to_radians().cos(), 20f64.to_radians().sin(), 0.0]).within(6.0);
    let with = |guide: Guide| degrees_at(&soup, &plate, &field(&plate, &[guide]), centre);
    let found: Vec<f64> = [0.01, 0.1, 1.0, 10.0, 100.0].map(|weight| with(guide.clone().with_weight(weight))).to_vec();
    assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{found:?}");
    // As with conductances, ln(30 / 6) = 1.6 against 1 between the guide and the sides: 1.6 / 2.6 of the way.
    assert!(found[0] < 2.0 && (6.0..16.0).contains(&found[2]) && found[4] > 19.5, "{found:?}");
    assert!((with(guide.clone()) - 20.0).abs() < 1e-3, "without weight it is exact");
    // What pulls both ways alike does not pull at all, and what is exact is not pulled.
    let against = Guide::vector([30.0, 30.0, 0.0], [25f64.to_radians().cos(), -25f64.to_radians().sin(), 0.0]);
    let soft = |guide: &Guide| guide.clone().within(6.0).with_weight(1.0);
    let both = degrees_at(&soup, &plate, &field(&plate, &[soft(&guide), soft(&against)]), centre);
    assert!(both.abs() < 0.5 * found[2], "{both} of two that disagree");
    let exact = degrees_at(&soup, &plate, &field(&plate, &[guide.clone(), soft(&against)]), centre);
    assert!((exact - 20.0).abs() < 1e-3, "{exact}");
}

#[test]
fn a_stroke_guides_by_its_tangents() {
    let soup = flat(60, 60, 1.0);
    let plate = surface(&soup);
    let on_arc = |degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        [30.0 + 15.0 * c, 30.0 + 15.0 * s]
    };
    let points: Vec<_> = (0..=60).map(|i| on_arc(f64::from(i))).map(|[x, y]| [x, y, 0.0]).collect();
    for radius in [0.0, 2.0] {
        let guided = field(&plate, &[Guide::stroke(points.clone()).within(radius)]);
        let report = &guided.guides()[0];
        assert!(report.trouble.is_none() && report.crosses > 20, "{report:?}");
        let off = |degrees: f64, field: &Field| {
            let found = degrees_at(&soup, &plate, field, on_arc(degrees));
            wrapped((found - degrees).to_radians()).to_degrees().abs()
        };
        // The corners of the triangle there are up to one away, where the tangent is 4 degrees another.
        let worst = (5..=55).map(|i| off(f64::from(i), &guided)).fold(0.0, f64::max);
        assert!(worst < 5.0, "{radius}: {worst}");
        let plain = field(&plate, &[]);
        assert!((5..=55).any(|i| off(f64::from(i), &plain) > 30.0), "the plain field does not follow the arc");
    }
}

#[test]
fn what_has_no_effect_is_reported() {
    let plate = surface(&flat(41, 40, 1.0));
    let troubles = [
        (Guide::vector([20.0, 20.0, 0.5], [1.0, 1.0, 0.0]), None),
        (Guide::vector([20.0, 20.0, 3.0], [1.0, 1.0, 0.0]), Some("far")),
        (Guide::vector([20.0, 20.0, 3.0], [1.0, 1.0, 0.0]).within(4.0), None),
        (Guide::vector([20.0, 20.0, 0.5], [1.0, 1.0, 0.0]).within(0.4), Some("far")),
        (Guide::vector([20.0, 20.0, 0.0], [0.05, 0.0, 1.0]), Some("along_normal")),
        (Guide::vector([20.0, 20.0, 0.0], [0.5, 0.0, 1.0]), None),
        // A triangle that fills the plate's corner.
        (Guide::vector([41.0, 0.0, 0.0], [1.0, 1.0, 0.0]), Some("on_features")),
        (Guide::vector([41.0, 0.0, 0.0], [1.0, 1.0, 0.0]).within(3.0), None),
        (Guide::stroke(vec![[5.0, 5.0, 0.0], [30.0, 30.0, 0.0]]), None),
        (Guide::stroke(vec![[5.0, 5.0, 0.0], [30.0, 30.0, 20.0]]), Some("partly_far")),
        (Guide::stroke(vec![[5.0, 5.0, 9.0], [30.0, 30.0, 9.0]]), Some("far")),
    ];
    let guides: Vec<Guide> = troubles.iter().map(|(guide, _)| guide.clone().named("north")).collect();
    let guided = field(&plate, &guides);
    assert_eq!(guided.guides().len(), troubles.len());
    for (report, (guide, expected)) in guided.guides().iter().zip(&troubles) {
        let kind = match &report.trouble {
            None => None,
            Some(GuideTrouble::Far { .. }) => Some("far"),
            Some(GuideTrouble::PartlyFar { .. }) => Some("partly_far"),
            Some(GuideTrouble::AlongNormal) => Some("along_normal"),
            Some(GuideTrouble::OnFeatures) => Some("on_features"),
            Some(_) => Some("another"),
        };
        assert_eq!(kind, *expected, "{guide:?}: {report:?}");
        assert_eq!(report.name, "north");
        assert_eq!(report.crosses == 0, matches!(kind, Some("far" | "along_normal" | "on_features")), "{report:?}");
        if kind.is_some_and(|kind| kind != "partly_far") {
            assert_eq!(field(&plate, std::slice::from_ref(guide)).crosses(), field(&plate, &[]).crosses(), "{guide:?}");
        }
    }
    let Some(GuideTrouble::Far { distance, limit }) = guided.guides()[1].trouble else { panic!("it is far") };
    // 2 % of the diagonal.
    assert!((distance - 3.0).abs() < 1e-4 && (limit - 0.02 * 41f64.hypot(40.0)).abs() < 1e-4, "{distance} {limit}");
}

#[test]
fn aligned_the_field_follows_curvature() {
    // A torus' meridians and parallels are its lines of curvature; the size must not matter.
    let off = |scale: f64, weight: Option<f64>| {
        let mut soup = example("torus", 6_000);
        soup.points.iter_mut().for_each(|p| *p = p.map(|x| x * scale));
        let torus = surface(&soup);
        let align = weight.map(|weight| Align { weight, side: None });
        // Without it the field obeys a guide at 45 degrees on the side of positive x; the other side is measured.
        let guide = Guide::vector([1.4 * scale, 0.0, 0.0], [0.0, 1.0, 1.0]);
        let options = FieldOptions { align, ..FieldOptions::guided([guide]) };
        let field = Field::new(&torus, &options, &Cpu).expect("the CPU does not fail");
        let far = seed::seed(&torus, &field, 0.03).into_iter().filter(|tile| tile.position[0] < 0.0);
        let off = far.map(|tile| {
            let [at, axis] = [tile.position, tile.axis].map(|v| DVec3::from(v.map(f64::from)));
            let parallel = DVec3::new(-at.y, at.x, 0.0).normalize();
            let off = axis.dot(parallel).clamp(-1.0, 1.0).acos();
            wrapped(off).abs().to_degrees()
        });
        off.fold(0.0, f64::max)
    };
    let aligned = off(1.0, Some(10.0));
    assert!(aligned < 6.0, "{aligned}");
    assert!((aligned - off(1e-3, Some(10.0))).abs() < 0.1, "{aligned}, small {}", off(1e-3, Some(10.0)));
    assert!(off(1.0, None) > 10.0, "{}", off(1.0, None));
    assert_eq!(off(1.0, Some(0.0)), off(1.0, None));
    // A guide speaks louder, and so does a feature.
    let block = surface(&example("block", 3_000));
    let guide = Guide::vector([0.9, 0.0, 0.5], [1.0, 0.5, 0.0]);
    let options = FieldOptions {
        guides: vec![guide.clone()],
        align: Some(Align { weight: 10.0, side: None }),
        ..FieldOptions::default()
    };
    let [both, alone] =
        [options, FieldOptions::guided([guide])].map(|options| Field::new(&block, &options, &Cpu).expect("it works"));
    let held = |sector: &usize| both.sectors().quarters[*sector] > 0;
    assert!((0..both.crosses().len()).filter(held).all(|s| both.crosses()[s] == alone.crosses()[s]));
    assert_ne!(both.crosses(), alone.crosses());
}

#[test]
fn a_guide_stays_on_its_side_of_a_thin_part() {
    // The wing is 0.07 thick there, and its edges 0.2 away.
    let wing = surface(&example("m6", 6_000));
    let [above, below] = [1.0, -1.0].map(|side| {
        let guide = Guide::vector([0.45, 0.41, 0.033 * side], [1.0, 0.6, 0.0]).within(0.1);
        field(&wing, &[guide])
    });
    let plain = field(&wing, &[]);
    let turned = |field: &Field| -> Vec<f64> {
        let pairs = field.crosses().iter().zip(plain.crosses());
        pairs.map(|(a, b)| wrapped(angle(*a) - angle(*b)).abs()).collect()
    };
    let (above, below) = (turned(&above), turned(&below));
    let [mut apart, mut both] = [0, 0];
    for (a, b) in above.iter().zip(&below) {
        apart += usize::from(a.max(*b) > 0.5 && a.min(*b) < 0.2);
        both += usize::from(a.min(*b) > 0.5);
    }
    assert!(apart > 50 && both == 0, "{apart} crosses are turned by one of them, {both} by both");
}
