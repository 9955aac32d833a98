//! Welding, orientation and features: what goes in broken comes out whole, and what cannot is refused by name.

mod common;

use common::surfaces::{EXAMPLES, example, flat, scattered, surface, twisted_strip};
use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::mosaic::{CurveParameters, Tile, feature_samples, seed};
use quadmosaic::surface::{FeatureOptions, Soup, Surface, SurfaceError};

/// Every triangle with corners of its own.
fn torn(soup: &Soup) -> Soup {
    let points = soup.triangles.iter().flatten().map(|&index| soup.points[index as usize]).collect();
    let triangles = (0..soup.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Soup { points, triangles, ..Default::default() }
}

/// Without creases and corners, features are the boundary's loops.
fn boundary_only() -> FeatureOptions {
    FeatureOptions { crease: 180.0, corner: 180.0, ..FeatureOptions::default() }
}

/// Vertices, edges, faces and boundary loops.
fn counts(surface: &Surface) -> [usize; 4] {
    let bare = surface.features().curves();
    assert!(bare.iter().all(|curve| curve.closed), "ask for the boundary only");
    let boundary: usize = bare.iter().map(|curve| curve.half_edges.len()).sum();
    let faces = surface.triangle_count();
    [surface.vertex_count(), (3 * faces + boundary) / 2, faces, bare.len()]
}

fn euler([vertices, edges, faces, _]: [usize; 4]) -> i64 {
    vertices as i64 - edges as i64 + faces as i64
}

fn new(soup: &Soup) -> Surface {
    Surface::new(soup, &boundary_only()).unwrap_or_else(|error| panic!("{error}"))
}

/// Edges of the soup, whatever the surface makes of it.
fn edge_count(soup: &Soup) -> usize {
    let mut edges: Vec<[u32; 2]> = soup
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges.len()
}

/// Tiles scattered over the surface: its normals and places, seen from outside the crate.
fn samples(surface: &Surface) -> Vec<Tile> {
    let field = Field::new(surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
    seed::seed(surface, &field, 0.03)
}

#[test]
fn a_soup_of_loose_triangles_is_welded_into_the_example() {
    for (name, characteristic, loops) in EXAMPLES {
        let soup = example(name, 3_000);
        let welded = new(&torn(&soup));
        let found = counts(&welded);
        assert_eq!(found, [soup.points.len(), edge_count(&soup), soup.triangles.len(), loops], "{name}");
        assert_eq!(euler(found), characteristic, "{name}");
        let joined = 3 * soup.triangles.len() - soup.points.len();
        assert_eq!(welded.repairs().welded_points.count, joined, "{name}");
        assert_eq!(welded.repairs().flipped_triangles.count, 0, "{name}");
    }
}

#[test]
fn a_torn_corner_is_seen() {
    let mut soup = torn(&example("sphere", 1_000));
    // A corner of one triangle, 1e-3 of the diagonal off its neighbours: far over the welding distance.
    soup.points[100][0] += 3e-3;
    let [.., loops] = counts(&new(&soup));
    assert_eq!(loops, 1, "the gap beside the displaced corner is a boundary");
    // 1e-8 of the diagonal off is welded.
    soup.points[100][0] -= 3e-3 - 3e-8;
    let found = counts(&new(&soup));
    assert_eq!((found[3], euler(found)), (0, 2));
}

#[test]
fn random_orientation_is_mended() {
    for (name, characteristic, loops) in EXAMPLES {
        let soup = example(name, 2_000);
        let mut mixed = soup.clone();
        let mut random = scattered(7);
        let mut turned = 0;
        for triangle in &mut mixed.triangles {
            if random() < 0.3 {
                triangle.swap(1, 2);
                turned += 1;
            }
        }
        let [whole, mended] = [&soup, &mixed].map(new);
        assert_eq!(mended.repairs().flipped_triangles.count, turned, "{name}");
        let found = counts(&mended);
        assert_eq!((euler(found), found[3]), (characteristic, loops), "{name}");
        // The same triangles, looking the same way.
        let [whole, mended] = [&whole, &mended].map(samples);
        assert_eq!(whole.len(), mended.len(), "{name}");
        for (a, b) in whole.iter().zip(&mended) {
            let facing = DVec3::from(a.normal.map(f64::from)).dot(DVec3::from(b.normal.map(f64::from)));
            assert!(a.triangle == b.triangle && facing > 0.999, "{name}: triangle {} looks the other way", a.triangle);
        }
    }
}

#[test]
fn an_inward_sphere_is_turned_outward() {
    let outward = |tiles: &[Tile]| {
        tiles.iter().all(|t| DVec3::from(t.position.map(f64::from)).dot(DVec3::from(t.normal.map(f64::from))) > 0.0)
    };
    let mut soup = example("sphere", 1_000);
    soup.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let turned = surface(&soup);
    assert_eq!(turned.repairs().flipped_triangles.count, soup.triangles.len());
    let tiles = samples(&turned);
    assert!(outward(&tiles));
    // An open surface has no outside: with one triangle less it stays as it was given.
    soup.triangles.pop();
    let open = surface(&soup);
    assert_eq!(open.repairs().flipped_triangles.count, 0);
    assert!(!outward(&samples(&open)));
}

#[test]
fn an_inward_sphere_inside_another_is_a_cavity_and_stays() {
    let sphere = |scale: f64, shift: f64, is_inward: bool| {
        let mut soup = example("sphere", 1_000);
        soup.points.iter_mut().for_each(|p| *p = [scale * p[0] + shift, scale * p[1], scale * p[2]]);
        if is_inward {
            soup.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        soup
    };
    let turned = |parts: [Soup; 2]| {
        let [mut both, other] = parts;
        let first = both.points.len() as u32;
        both.points.extend(other.points);
        both.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v + first)));
        surface(&both).repairs().flipped_triangles.count
    };
    let count = example("sphere", 1_000).triangles.len();
    assert_eq!(turned([sphere(1.0, 0.0, false), sphere(0.5, 0.0, true)]), 0);
    assert_eq!(turned([sphere(1.0, 0.0, false), sphere(0.5, 0.0, false)]), 0, "a part inside another");
    assert_eq!(turned([sphere(1.0, 0.0, false), sphere(0.5, 3.0, true)]), count, "beside the other");
    assert_eq!(turned([sphere(1.0, 0.0, true), sphere(0.5, 0.0, false)]), 2 * count, "turned with the outer one");
}

#[test]
fn two_triangles_on_one_line_are_dropped_and_two_with_height_are_one() {
    // Two triangles back to back over an edge: their third corner is its middle, or stands above it.
    let soup = example("sphere", 1_000);
    let [a, b, _] = soup.triangles[0];
    let middle = |k: usize| (soup.points[a as usize][k] + soup.points[b as usize][k]) / 2.0;
    for (height, [degenerate, repeated, joined]) in [(1.0, [2, 0, 0]), (1.2, [0, 1, 1])] {
        let mut soup = soup.clone();
        soup.points.push([0, 1, 2].map(|k| height * middle(k)));
        let top = soup.points.len() as u32 - 1;
        soup.triangles.extend([[a, b, top], [b, a, top]]);
        let repairs = surface(&soup).repairs().clone();
        let found = [&repairs.degenerate_triangles, &repairs.duplicate_triangles, &repairs.joined_edges];
        assert_eq!(found.map(|places| places.count), [degenerate, repeated, joined], "{height}");
    }
}

#[test]
fn duplicates_and_degenerate_triangles_are_dropped_and_counted() {
    let clean = example("sphere", 1_000);
    let mut soup = clean.clone();
    let [a, b, c] = soup.triangles[5];
    soup.triangles.extend([[a, b, c], [c, a, b], [a, c, b], [a, a, b], [b, c, c]]);
    soup.points.extend([[9.0, 9.0, 9.0], [0.0, 0.0, 0.0]]);
    let mended = new(&soup);
    let repairs = mended.repairs();
    assert_eq!(
        (repairs.duplicate_triangles.count, repairs.degenerate_triangles.count, repairs.unused_points.count),
        (3, 2, 2)
    );
    assert_eq!(counts(&mended), counts(&new(&clean)));
    assert_eq!(mended.frame(), new(&clean).frame(), "points that no triangle uses have no part in the frame");
}

fn tetrahedron(first: u32) -> [[u32; 3]; 4] {
    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|t| t.map(|v| v + first))
}

#[test]
fn a_bow_tie_becomes_two_vertices() {
    let corner = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mirrored = corner.map(|p| p.map(|x| -x));
    let mut soup = Soup { points: corner.to_vec(), triangles: tetrahedron(0).to_vec(), ..Soup::default() };
    soup.points.extend(mirrored);
    soup.triangles.extend(tetrahedron(4));
    let apart = new(&soup);
    assert_eq!(
        (apart.vertex_count(), apart.repairs().joined_vertices.count, apart.repairs().welded_points.count),
        (8, 1, 1)
    );
    assert_eq!(euler(counts(&apart)), 4, "two spheres");
    assert_eq!(apart.repairs().flipped_triangles.count, 4, "the mirror image looks inward as it is given");
    // Moved apart they touch no more.
    soup.points[4..].iter_mut().for_each(|p| p[0] -= 1.0);
    assert_eq!(new(&soup).repairs().joined_vertices.count, 0);
}

/// Three pages at one spine.
fn book() -> Soup {
    Soup {
        points: vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
        triangles: vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        ..Soup::default()
    }
}

#[test]
fn sheets_that_meet_at_an_edge_are_cut_there_and_told() {
    let apart = new(&book());
    assert_eq!(apart.vertex_count(), 9, "each page has its own ends of the spine");
    let repairs = apart.repairs();
    assert_eq!((repairs.joined_edges.count, repairs.joined_vertices.count), (1, 4));
    let place = repairs.joined_edges.at[0].map(|x| (x * 1e6).round() / 1e6);
    assert_eq!(place, [0.0, 0.0, 0.5], "the middle of the spine");
    let mut two = book();
    two.triangles.pop();
    let whole = new(&two);
    assert_eq!((whole.repairs().joined_edges.count, whole.vertex_count()), (0, 4), "two pages are one sheet");
}

/// A box of one cell along x from `from` to `to`, its cross-section the unit square moved by `shift` along y.
fn cell(soup: &mut Soup, from: f64, to: f64, shift: f64) {
    let first = soup.points.len() as u32;
    for x in [from, to] {
        soup.points.extend([[x, shift, 0.0], [x, shift + 1.0, 0.0], [x, shift + 1.0, 1.0], [x, shift, 1.0]]);
    }
    let quads = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    for [a, b, c, d] in quads.map(|quad| quad.map(|v| v + first)) {
        soup.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

#[test]
fn solids_in_contact_stay_solids() {
    // Two boxes that share an edge: four triangles meet there, and each box keeps its own two.
    let mut soup = Soup::default();
    cell(&mut soup, 0.0, 1.0, 0.0);
    cell(&mut soup, 1.0, 2.0, 1.0);
    for turned in [false, true] {
        let mut soup = soup.clone();
        if turned {
            soup.triangles.iter_mut().skip(12).for_each(|t| t.swap(1, 2));
        }
        let boxes = Surface::new(&soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(boxes.repairs().joined_edges.count, 1, "turned: {turned}");
        if !turned {
            assert_eq!(boxes.vertex_count(), 16);
            assert_eq!(boxes.boundary_length(), 0.0, "both are closed");
            assert_eq!(boxes.features().curves().len(), 24);
        }
    }
}

#[test]
fn a_triangle_without_height_is_flipped_away() {
    let mut soup = example("block", 2_000);
    let whole = new(&soup);
    // A point on the longest edge of one triangle makes a cap beside it.
    let [a, b, c] = soup.triangles[7];
    let middle = soup.points.len() as u32;
    let between = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|k| (p[k] + q[k]) / 2.0);
    soup.points.push(between(soup.points[a as usize], soup.points[b as usize]));
    soup.triangles[7] = [middle, b, c];
    soup.triangles.extend([[a, middle, c], [a, b, middle]]);
    let mended = new(&soup);
    assert_eq!(mended.repairs().flipped_caps.count, 1);
    assert_eq!(euler(counts(&mended)), euler(counts(&whole)));
    assert!((mended.area() - whole.area()).abs() < 1e-6);
    assert_eq!(whole.repairs().flipped_caps.count, 0);
}

#[test]
fn a_part_too_small_to_have_a_shape_is_dropped_and_told() {
    let soup = example("sphere", 1_000);
    let whole = new(&soup);
    for (size, dropped) in [(1e-6, 1), (1e-3, 0)] {
        let first = soup.points.len() as u32;
        let mut two = soup.clone();
        two.points.extend([[0.0, 0.0, 0.0], [size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size]]);
        two.triangles.extend(tetrahedron(first));
        let mended = new(&two);
        assert_eq!(mended.repairs().dropped_specks.count, dropped, "{size}");
        assert_eq!(euler(counts(&mended)), if dropped == 1 { euler(counts(&whole)) } else { 4 }, "{size}");
    }
}

#[test]
fn what_is_no_surface_is_refused_by_name() {
    let refused = |soup: &Soup| matches!(Surface::new(soup, &boundary_only()), Err(SurfaceError::NotOrientable { .. }));
    assert!(refused(&twisted_strip(24, 1)), "a Moebius strip has one side");
    let annulus = twisted_strip(24, 2);
    assert!(!refused(&annulus));
    assert_eq!((euler(counts(&new(&annulus))), counts(&new(&annulus))[3]), (0, 2), "two half turns make two sides");
    assert!(refused(&closed_grid(true)), "a Klein bottle has one side");
    assert_eq!((euler(counts(&new(&closed_grid(false)))), counts(&new(&closed_grid(false)))[3]), (0, 0));
}

/// A grid closed both ways, the second time mirrored if asked. Only its topology means anything.
fn closed_grid(mirrored: bool) -> Soup {
    let count = 8u32;
    let at = |i: u32, j: u32| {
        let i = if j == count && mirrored { count - i } else { i };
        j % count * count + i % count
    };
    let mut random = scattered(3);
    let mut soup =
        Soup { points: (0..count * count).map(|_| [random(), random(), random()]).collect(), ..Soup::default() };
    for j in 0..count {
        for i in 0..count {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            soup.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    soup
}

#[test]
fn what_cannot_be_computed_with_is_refused_by_name() {
    let good = flat(2, 2, 1.0);
    let refusal = |change: fn(&mut Soup)| {
        let mut soup = good.clone();
        change(&mut soup);
        Surface::new(&soup, &FeatureOptions::default()).err()
    };
    assert_eq!(refusal(|_| {}), None);
    assert_eq!(refusal(|s| s.triangles.clear()), Some(SurfaceError::Empty));
    assert_eq!(refusal(|s| s.points.fill([1.0; 3])), Some(SurfaceError::NoArea { given: 8 }));
    assert_eq!(refusal(|s| s.points[4][1] = f64::NAN), Some(SurfaceError::NotFinite { point: 4 }));
    assert_eq!(refusal(|s| s.points[4][1] = 1e200), Some(SurfaceError::NotFinite { point: 4 }));
    let past = SurfaceError::IndexOutOfRange { triangle: 3, index: 9, points: 9 };
    assert_eq!(refusal(|s| s.triangles[3][1] = 9), Some(past));
}

#[test]
fn creases_boundaries_and_corners_are_found() {
    let found = |name: &str, options: FeatureOptions| {
        let surface = Surface::new(&example(name, 4_000), &options).expect("an example");
        let features = surface.features();
        let round = features.curves().iter().filter(|curve| curve.closed).count();
        (round, features.curves().len() - round, features.corners().count())
    };
    let default = FeatureOptions::default();
    assert_eq!(found("block", default), (2, 12, 8), "the bore's two rims, a box's edges and corners");
    assert_eq!(found("plate", default), (1, 4, 4), "the hole's rim, a square's sides and corners");
    assert_eq!(found("sphere", default), (0, 0, 0));
    assert_eq!(found("torus", default), (0, 0, 0));
    assert_eq!(found("block", FeatureOptions { crease: 95.0, ..default }), (0, 0, 0), "no dihedral angle is over 90");
    assert_eq!(found("plate", FeatureOptions { corner: 95.0, ..default }), (2, 0, 0), "no turn is over 90");
}

#[test]
fn feature_curves_are_chains_of_feature_edges() {
    for (name, ..) in EXAMPLES {
        let surface = surface(&example(name, 4_000));
        let features = surface.features();
        let mut on_curves = 0;
        for curve in features.curves() {
            assert_eq!(curve.vertices.len(), curve.half_edges.len() + 1, "{name}");
            assert!(curve.half_edges.iter().all(|&h| features.is_feature(h)), "{name}");
            let [first, last] = [curve.vertices[0], *curve.vertices.last().expect("a curve has vertices")];
            assert_eq!(curve.closed, !features.is_corner(first), "{name}");
            assert!(if curve.closed { first == last } else { features.is_corner(last) }, "{name}");
            assert!(curve.vertices[1..curve.vertices.len() - 1].iter().all(|&v| !features.is_corner(v)), "{name}");
            on_curves += curve.half_edges.len();
        }
        // Each feature edge lies on one curve: a crease has two half-edges, a boundary edge one.
        let marked = (0..3 * surface.triangle_count() as u32).filter(|&h| features.is_feature(h)).count();
        let bare = Surface::new(&example(name, 4_000), &boundary_only()).expect("an example");
        let boundary: usize = bare.features().curves().iter().map(|c| c.half_edges.len()).sum();
        assert_eq!(on_curves, boundary + (marked - boundary) / 2, "{name}");
    }
}

#[test]
fn the_frame_maps_there_and_back() {
    for (offset, scale) in [(0.0, 1.0), (1e6, 1.0), (-3e4, 1e-6), (1e3, 1e6)] {
        let mut soup = example("m6", 1_000);
        soup.points.iter_mut().flatten().for_each(|x| *x = *x * scale + offset);
        let surface = surface(&soup);
        let frame = surface.frame();
        // Two roundings of numbers no larger than the farthest coordinate.
        let largest = soup.points.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
        let error = |point: [f64; 3]| DVec3::from(frame.to_model(frame.to_unit(point))).distance(point.into());
        let worst = soup.points.iter().map(|&p| error(p)).fold(0.0, f64::max);
        assert!(worst <= 4.0 * f64::EPSILON * (largest + frame.diagonal), "offset {offset}, scale {scale}: {worst:e}");
        let unit: Vec<DVec3> = soup.points.iter().map(|&p| frame.to_unit(p).into()).collect();
        let (low, high) = unit.iter().fold((DVec3::MAX, DVec3::MIN), |(l, h), &p| (l.min(p), h.max(p)));
        // Cancellation costs what the offset is large against the diagonal.
        let tolerance = 4.0 * f64::EPSILON * (1.0 + largest / frame.diagonal);
        assert!(((high - low).length() - 1.0).abs() < tolerance, "the box's diagonal becomes one");
        assert!((high + low).length() < 2.0 * tolerance, "and its centre the origin");
    }
}

/// All vertices' places in unit-sized coordinates: with every edge a crease each vertex is a corner and seats a tile.
fn places(soup: &Soup) -> Vec<DVec3> {
    let surface = Surface::new(soup, &FeatureOptions { crease: 1e-2, ..FeatureOptions::default() }).expect("a sphere");
    assert_eq!(surface.features().corners().count(), surface.vertex_count());
    let field = Field::new(&surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail");
    let (samples, tiles) = feature_samples::sample_features(&surface, &field, 1.0, &CurveParameters::default());
    assert_eq!(samples.len(), surface.vertex_count(), "no edge is long enough for a tile of its own");
    samples.iter().map(|sample| DVec3::from(tiles[sample.first_side as usize].position.map(f64::from))).collect()
}

#[test]
fn a_sphere_is_the_same_wherever_it_is_and_whatever_its_size() {
    let at_home = example("sphere", 1_000);
    let wanted = places(&at_home);
    // Unit-sized coordinates lie below 0.5, where neighbouring f32 are 2^-25 apart; near a tie two roundings fall that
    // far apart. At 1e6 the f64 input is rounded to 1.2e-10, a third of that in diagonals.
    let tolerance = 2f64.powi(-25) * 1.01;
    let worst = |soup: &Soup| {
        let moved = places(soup);
        assert_eq!(moved.len(), wanted.len());
        moved.iter().zip(&wanted).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f64::max)
    };
    for (offset, scale) in [(1e6, 1.0), (0.0, 1e-6), (0.0, 1e6), (1.0, 1e-6)] {
        let mut soup = at_home.clone();
        soup.points.iter_mut().flatten().for_each(|x| *x = *x * scale + offset);
        assert!(worst(&soup) <= tolerance, "offset {offset}, scale {scale}: {:e}", worst(&soup));
    }
    let mut dented = at_home.clone();
    dented.points[40][0] += 1e-6;
    assert!(worst(&dented) > tolerance, "a dent of a millionth of the radius is seen");
}
