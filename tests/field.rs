//! The cross field: constant where it can be, of the right total index, and along every feature.

mod common;

use common::surfaces::{EXAMPLES, example, flat, surface, unit_corners};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Complex, Field, FieldOptions, Guide};
use quadmosaic::mosaic::sow;
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
    let tiles = sow::sow(surface, field, 0.01);
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

#[test]
fn a_guide_is_followed_within_its_radius() {
    let soup = flat(40, 40, 1.0);
    let plate = surface(&soup);
    let centre = [20.0, 20.0, 0.0];
    let guide = Guide::vector(centre, [0.8, 0.6, 0.5]).within(6.0);
    let guided = field(&plate, &[guide]);
    let turn = 0.6f64.atan2(0.8);
    let (mut inside, mut outside) = (0, 0);
    for tile in sow::sow(&plate, &guided, 0.01) {
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
    let (columns, degrees) = (16, 20.0);
    let found = across(columns, degrees);
    // The guides reach the nearest triangle too, which may lie on the near side: the last column but one is not tested.
    assert!(found[0].abs() < 1e-3 && (found[columns] - degrees).abs() < 1e-3, "{found:?}");
    let turn = 4.0 * degrees.to_radians();
    for (i, &angle) in found.iter().enumerate().take(columns - 1) {
        let share = i as f64 / columns as f64;
        // Unnormalised sweeps give the chord between the two numbers, normalised ones the arc; a mix lies between.
        let arc = degrees * share;
        let chord = (share * turn.sin()).atan2(1.0 + share * (turn.cos() - 1.0)).to_degrees() / 4.0;
        let (low, high) = (arc.min(chord), arc.max(chord));
        // What the sweeps leave of the error: a column's worth of the turn.
        let slack = degrees / columns as f64;
        assert!((low - slack..=high + slack).contains(&angle), "column {i}: {angle}, not {low} to {high}: {found:?}");
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
    let smooth = Surface::new(&soup, &FeatureOptions { crease: 95.0, corner: 50.0 }).expect("an example");
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
