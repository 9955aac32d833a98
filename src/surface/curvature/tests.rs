use super::*;
use crate::surface::examples::Example;
use crate::surface::{FeatureOptions, Soup};
use std::f64::consts::{FRAC_PI_2, PI};

/// A grid of `columns` by `rows` cells over the unit square, placed by `place`, its normal up where that keeps z.
fn sheet(columns: usize, rows: usize, place: impl Fn(f64, f64) -> [f64; 3]) -> Surface {
    let mut soup = Soup::default();
    for j in 0..=rows {
        soup.points.extend((0..=columns).map(|i| place(i as f64 / columns as f64, j as f64 / rows as f64)));
    }
    for j in 0..rows {
        for i in 0..columns {
            let at = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            soup.triangles.extend(halves);
        }
    }
    surface(&soup)
}

fn surface(soup: &Soup) -> Surface {
    Surface::new(soup, &FeatureOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The curvatures for model units at the vertex nearest to a place, with the disc's radius in model units.
fn at(surface: &Surface, radius: f64, place: [f64; 3]) -> Curvature {
    let diagonal = surface.frame().diagonal;
    let place = DVec3::from(surface.frame().to_unit(place));
    let distance = |v: usize| surface.points[v].as_dvec3().distance(place);
    let nearest = (0..surface.vertex_count()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    let found = curvatures(surface, radius / diagonal)[nearest.expect("a vertex")];
    Curvature { values: found.values.map(|value| value / diagonal), ..found }
}

fn near(found: [f64; 2], wanted: [f64; 2], slack: f64) -> bool {
    found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() <= slack)
}

#[test]
fn a_cylinder_bends_across_its_axis() {
    // Radius 2, the axis along y, seen from outside and from inside.
    let arch = |side: f64| {
        sheet(60, 80, move |x, y| {
            let (s, c) = (2.0 * (x - 0.5)).sin_cos();
            [side * 2.0 * s, 6.0 * y, 2.0 * c]
        })
    };
    // Rows of edges are 1/15 apart; three of them on either side are 7 % less than the disc, thirteen 1 %.
    for (radius, slack) in [(0.0, 0.01), (0.2, 0.035), (0.9, 0.01)] {
        let out = at(&arch(1.0), radius, [0.0, 3.0, 2.0]);
        assert!(near(out.values, [0.5, 0.0], slack), "{radius}: {:?}", out.values);
        assert!(out.directions[0].x.abs() > 0.999 && out.directions[1].y.abs() > 0.999, "{out:?}");
        assert!(out.directions[0].cross(out.directions[1]).z.abs() > 0.99);
        let inside = at(&arch(-1.0), radius, [0.0, 3.0, 2.0]);
        assert!(near(inside.values, [-0.5, 0.0], slack), "{radius}: {:?}", inside.values);
    }
}

#[test]
fn a_sphere_bends_alike_in_all_directions() {
    let sphere = surface(&Example::Sphere.generate(8_000));
    // Two edges, four, and eight, when the disc is a cap: cos^2 at its rim is 16 % less, 5 % in the mean.
    for (radius, slack) in [(0.1, 0.12), (0.2, 0.06), (0.4, 0.06)] {
        let normals = vertex_normals(&sphere);
        let found = curvatures(&sphere, radius / sphere.frame().diagonal);
        for (v, bend) in found.iter().enumerate() {
            assert!(near(bend.values.map(|k| k / sphere.frame().diagonal), [1.0; 2], slack), "{v}: {bend:?}");
            let [u, w] = bend.directions;
            let frame = [u.dot(w), u.dot(normals[v]), w.dot(normals[v]), u.length() - 1.0, w.length() - 1.0];
            assert!(frame.iter().all(|x| x.abs() < 1e-9), "{v}: {frame:?}");
        }
    }
}

#[test]
fn a_saddle_bends_both_ways() {
    // z = x y / 4: curvature 1/4 along one diagonal and -1/4 along the other, where x = y = 0.
    let saddle = sheet(60, 60, |x, y| {
        let (x, y) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        [x, y, x * y / 4.0]
    });
    let found = at(&saddle, 0.25, [0.0; 3]);
    assert!((found.values[0].abs() - 0.25).abs() < 0.01, "{:?}", found.values);
    assert!((found.values[0] + found.values[1]).abs() < 0.01, "{:?}", found.values);
    // Convex from above where the surface falls: along x = -y.
    let falling = if found.values[0] > 0.0 { found.directions[0] } else { found.directions[1] };
    assert!((falling.x + falling.y).abs() < 0.02 && falling.z.abs() < 1e-6, "{falling}");
}

/// Two flat flanks and a round of `turn` radians and this radius between them, its axis along y through y = 2.
fn fillet(turn: f64, round: f64) -> Surface {
    let strips = 12;
    let flank = 24;
    let columns = strips + 2 * flank;
    sheet(columns, 60, move |x, y| {
        let column = (x * columns as f64).round() - flank as f64;
        let share = (column / strips as f64).clamp(0.0, 1.0) - 0.5;
        let beyond = if column < 0.0 { column } else { (column - strips as f64).max(0.0) } / flank as f64;
        let (s, c) = (turn * share).sin_cos();
        [round * s + 2.0 * beyond * c, 4.0 * y, round * c - 2.0 * beyond * s]
    })
}

#[test]
fn a_narrow_fillet_turns_by_its_angle_within_a_tile() {
    // Discs off the fillet have shorter chords of it, and a ball takes more of a flank that bends towards its centre.
    for (turn, loss) in [(0.5, 0.05), (FRAC_PI_2, 0.15), (2.0, 0.2)] {
        let surface = fillet(turn, 0.01);
        for side in [0.6, 1.2] {
            let found = at(&surface, radius_of_tile(side), [0.0, 2.0, 0.01]);
            let share = found.values[0] * side / turn;
            assert!((1.0 - loss..1.01).contains(&share), "{turn}, {side}: {:?}", found.values);
            assert!(found.values[1].abs() * side < 0.02 && found.directions[1].y.abs() > 0.999, "{found:?}");
            // With all of the surface's bend beyond the disc there is none.
            let flank = at(&surface, 0.3, [1.5 * (turn / 2.0).cos(), 2.0, -1.5 * (turn / 2.0).sin()]);
            assert!(near(flank.values, [0.0; 2], 1e-4), "{:?}", flank.values);
        }
    }
    // A fillet wider than the disc has its own curvature, at any scale.
    let wide = at(&fillet(FRAC_PI_2, 2.0), radius_of_tile(0.6), [0.0, 2.0, 2.0]);
    // Its twelve strips are 0.26 wide, and the disc 0.38.
    assert!(near(wide.values, [0.5, 0.0], 0.05), "{:?}", wide.values);
}

#[test]
fn features_bound_the_disc() {
    // A roof of 60 degrees, creased, and one of 30 degrees, smooth.
    let roof = |degrees: f64| {
        let slope = (degrees / 2.0).to_radians().tan();
        sheet(20, 20, move |x, y| [x - 0.5, y, -slope * (x - 0.5).abs()])
    };
    for place in [[0.0, 0.5, 0.0], [0.1, 0.5, 0.0]] {
        // Coordinates are rounded by 2^-25 of a diagonal of 1.5: edges of 0.05 turn by 2e-6, a disc bends by a few 1e-5.
        assert!(near(at(&roof(60.0), 0.2, place).values, [0.0; 2], 1e-4), "{place:?}");
    }
    let expected = 2.0 * 30f64.to_radians() / (PI * 0.2);
    let smooth = at(&roof(30.0), 0.2, [0.0, 0.5, 0.0]).values;
    assert!((smooth[0] / expected - 1.0).abs() < 0.05, "{smooth:?}, not {expected}");
    // The block is flat but for its bore, of radius 0.7, which is hollow.
    let block = surface(&Example::Block.generate(8_000));
    let diagonal = block.frame().diagonal;
    for (v, bend) in curvatures(&block, 0.2 / diagonal).iter().enumerate() {
        let place = DVec3::from(block.frame().to_model(block.points[v].as_dvec3().into()));
        let bore = (place.x.hypot(place.y) - 0.7).abs() < 1e-3;
        let on_feature = (0..3 * block.triangle_count() as u32)
            .any(|h| block.features().is_feature(h) && [block.origin(h), block.target(h)].contains(&(v as u32)));
        let wanted = if bore { [-1.0 / 0.7, 0.0] } else { [0.0; 2] };
        if !(bore && on_feature) {
            assert!(near(bend.values.map(|k| k / diagonal), wanted, 0.05), "{place}: {bend:?}");
        }
    }
}

#[test]
fn the_curvature_is_the_same_every_time() {
    let surface = surface(&Example::Torus.generate(4_000));
    let values = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| curvatures(&surface, 0.1).iter().map(|bend| bend.values).collect::<Vec<_>>())
    };
    assert_eq!(values(1), values(2));
    assert_ne!(values(1), curvatures(&surface, 0.05).iter().map(|bend| bend.values).collect::<Vec<_>>());
}
