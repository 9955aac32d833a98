//! Repairs that are asked for, each with a partner: without it the surface is another one.

#[path = "common/surfaces.rs"]
mod surfaces;

use glam::DVec3;
use quadmosaic::compute::Cpu;
use quadmosaic::pipeline::{Fineness, Options, PipelineError, run, unwatched};
use quadmosaic::surface::{FeatureOptions, Length, Regions, RepairOptions, Soup, Surface, SurfaceError};
use std::f64::consts::{PI, TAU};
use surfaces::{example, flat};

/// Features are the boundary's loops.
fn boundary_only() -> FeatureOptions {
    FeatureOptions { crease: 180.0, corner: 180.0, ..FeatureOptions::default() }
}

fn repaired(soup: &Soup, repairs: &RepairOptions) -> Surface {
    Surface::repaired(soup, &boundary_only(), repairs, 0.0).unwrap_or_else(|error| panic!("{error}"))
}

/// The Euler characteristic and the number of boundary loops.
fn topology(surface: &Surface) -> (i64, usize) {
    let loops = surface.features().curves();
    let boundary: usize = loops.iter().map(|curve| curve.half_edges.len()).sum();
    let edges = (3 * surface.triangle_count() + boundary) / 2;
    (surface.vertex_count() as i64 - edges as i64 + surface.triangle_count() as i64, loops.len())
}

fn fill(size: Length) -> RepairOptions {
    RepairOptions { fill_holes: Some(size), ..RepairOptions::default() }
}

fn drop(size: Length) -> RepairOptions {
    RepairOptions { drop_parts: Some(size), ..RepairOptions::default() }
}

/// Without the triangles that have a corner for which this holds.
fn without(soup: &Soup, goes: impl Fn(DVec3) -> bool) -> Soup {
    assert!(soup.regions.of_face.is_empty());
    let stays = |t: &&[u32; 3]| !t.iter().any(|&v| goes(DVec3::from(soup.points[v as usize])));
    Soup { triangles: soup.triangles.iter().filter(stays).copied().collect(), ..soup.clone() }
}

/// A unit sphere with three small holes and a large one.
fn pierced() -> Soup {
    let small = [DVec3::X, DVec3::Y, DVec3::new(-0.6, -0.8, 0.0)];
    without(&example("sphere", 4_000), |p| small.iter().any(|s| s.distance(p) < 0.1) || p.distance(DVec3::Z) < 0.5)
}

#[test]
fn holes_below_the_size_are_filled() {
    let soup = pierced();
    let open = repaired(&soup, &RepairOptions::default());
    assert_eq!((topology(&open), open.repairs().filled_holes.count), ((-2, 4), 0));

    let filled = repaired(&soup, &fill(Length::Model(0.6)));
    assert_eq!((topology(&filled), filled.repairs().filled_holes.count), ((1, 1), 3));
    let at = &filled.repairs().filled_holes.at;
    assert!(at.iter().all(|&p| (DVec3::from(p).length() - 1.0).abs() < 0.05), "{at:?}");
    // Four flat caps of radius r are smaller than the sphere's by about pi r^4 / 4.
    let whole = repaired(&soup, &fill(Length::Diagonals(1.0)));
    assert_eq!(topology(&whole), (2, 0));
    let sphere = repaired(&example("sphere", 4_000), &RepairOptions::default());
    let unit = 4.0 * whole.frame().diagonal.powi(2);
    let lost = unit / 4.0 * (sphere.area() * (sphere.frame().diagonal / whole.frame().diagonal).powi(2) - whole.area());
    assert!((0.0..0.1).contains(&lost), "the caps lose {lost} of an area of 12.6");
    assert_eq!(whole.repairs().flipped_triangles.count, 0, "the surface looks outward as before");
}

#[test]
fn the_outline_of_a_sheet_is_no_hole() {
    let sheet = flat(12, 12, 1.0);
    let holed = without(&sheet, |p| p.distance(DVec3::new(6.0, 6.0, 0.0)) < 1.5);
    assert_eq!(topology(&repaired(&holed, &RepairOptions::default())), (0, 2));
    let filled = repaired(&holed, &fill(Length::Model(1e3)));
    assert_eq!((topology(&filled), filled.repairs().filled_holes.count), ((1, 1), 1));
    let [filled, whole] = [filled, repaired(&sheet, &RepairOptions::default())].map(|surface| surface.area());
    assert!((filled / whole - 1.0).abs() < 1e-6, "{filled}, not {whole}");
}

#[test]
fn holes_that_touch_are_filled_each() {
    // Two squares of a plate that have a corner in common.
    let missing = |t: &[u32; 3], soup: &Soup| {
        let middle = t.iter().map(|&v| DVec3::from(soup.points[v as usize])).sum::<DVec3>() / 3.0;
        [[3.5, 3.5], [4.5, 4.5]].iter().any(|&[x, y]| (middle.x - x).abs() < 0.5 && (middle.y - y).abs() < 0.5)
    };
    let mut soup = flat(8, 8, 1.0);
    let kept: Vec<_> = soup.triangles.iter().filter(|t| !missing(t, &soup)).copied().collect();
    soup.triangles = kept;
    assert_eq!(soup.triangles.len(), 124);
    let filled = repaired(&soup, &fill(Length::Model(2.0)));
    assert_eq!((topology(&filled), filled.repairs().filled_holes.count, filled.triangle_count()), ((1, 1), 2, 128));
    assert_eq!(repaired(&soup, &fill(Length::Model(1.0))).repairs().filled_holes.count, 0, "their diagonals are 1.41");
}

#[test]
fn a_filling_belongs_to_a_region_beside_it() {
    let mut soup = without(&flat(12, 12, 1.0), |p| p.distance(DVec3::new(3.0, 6.0, 0.0)) < 0.5);
    let left = |t: &[u32; 3]| t.iter().all(|&v| soup.points[v as usize][0] <= 6.0);
    let of_face: Vec<u32> = soup.triangles.iter().map(|t| u32::from(left(t))).collect();
    soup.regions = Regions { names: vec!["right".to_owned(), "left".to_owned()], of_face };
    let filled = repaired(&soup, &fill(Length::Model(4.0)));
    assert_eq!(filled.repairs().filled_holes.count, 1);
    let new = &filled.regions().of_face[soup.triangles.len()..];
    assert!(!new.is_empty() && new.iter().all(|&region| region == 1), "{new:?}");
}

/// Three spheres of radius 1, 0.1 and 0.03.
fn spheres() -> Soup {
    let mut all = Soup::default();
    for (radius, x) in [(1.0, 0.0), (0.1, 2.0), (0.03, 3.0)] {
        let one = example("sphere", 500);
        let first = all.points.len() as u32;
        all.points.extend(one.points.iter().map(|p| [radius * p[0] + x, radius * p[1], radius * p[2]]));
        all.triangles.extend(one.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

#[test]
fn parts_below_the_size_are_dropped() {
    let soup = spheres();
    for (size, dropped) in [(0.05, 0), (0.2, 1), (0.5, 2)] {
        let mended = repaired(&soup, &drop(Length::Model(size)));
        assert_eq!(mended.repairs().dropped_parts.count, dropped, "{size}");
        assert_eq!(topology(&mended), (2 * (3 - dropped as i64), 0), "{size}");
    }
    let none = Surface::repaired(&soup, &boundary_only(), &drop(Length::Model(4.0)), 0.0).err();
    let Some(SurfaceError::AllPartsSmall { limit, largest }) = none else { panic!("{none:?}") };
    assert!((limit - 4.0).abs() < 1e-9 && (3.0..3.5).contains(&largest), "{limit}, {largest}");
}

#[test]
fn no_hole_of_a_dropped_part_is_filled() {
    let soup = without(&spheres(), |p| p.distance(DVec3::new(3.03, 0.0, 0.0)) < 0.01);
    let both = RepairOptions { fill_holes: Some(Length::Model(0.5)), ..drop(Length::Model(0.2)) };
    let counts = |options| {
        let mended = repaired(&soup, options);
        [mended.repairs().dropped_parts.count, mended.repairs().filled_holes.count]
    };
    assert_eq!(counts(&both), [1, 0]);
    assert_eq!(counts(&RepairOptions { drop_parts: None, ..both }), [0, 1]);
}

#[test]
fn sizes_are_in_model_units_diagonals_or_sides_of_a_tile() {
    assert_eq!("0.25".parse(), Ok(Length::Model(0.25)));
    assert_eq!("0.5%".parse(), Ok(Length::Diagonals(0.005)));
    assert_eq!("3x".parse(), Ok(Length::Tiles(3.0)));
    for wrong in ["", "x", "%", "-1", "0", "1e400", "nan", "3 x", "2t"] {
        assert!(wrong.parse::<Length>().is_err(), "{wrong:?}");
    }
    // The spheres' area is 12.7: a thousand tiles have a side of 0.113, five of 0.3 have one of 0.3.
    let parts = |fineness, size| {
        let options = Options { repairs: drop(size), ..Options::new(fineness) };
        let outcome = run(&spheres(), &options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}"));
        outcome.meshed.faults.components
    };
    assert_eq!(parts(Fineness::Points(1_000), Length::Tiles(2.0)), 2);
    assert_eq!(parts(Fineness::Points(1_000), Length::Tiles(4.0)), 1);
    assert_eq!(parts(Fineness::Size(0.3), Length::Tiles(2.0)), 1);
    assert_eq!(parts(Fineness::Size(0.2), Length::Diagonals(0.05)), 2, "the diagonal is 4.9");
}

#[test]
fn a_length_that_is_none_is_refused_by_name() {
    let soup = example("sphere", 500);
    for (wrong, name) in [
        (drop(Length::Model(-1.0)), "dropping parts"),
        (fill(Length::Model(f64::NAN)), "filling holes"),
        (RepairOptions { weld: Some(Length::Diagonals(0.5)), ..RepairOptions::default() }, "welding"),
    ] {
        let options = Options { repairs: wrong, ..Options::new(Fineness::Points(100)) };
        let refusal = run(&soup, &options, &Cpu, &unwatched).err();
        let named = matches!(&refusal, Some(PipelineError::Surface(SurfaceError::RepairLength { name: found, .. })) if *found == name);
        assert!(named, "{wrong:?}: {:?}", refusal.map(|refusal| refusal.to_string()));
    }
}

/// A box of 2 by 2 by 1 without its top, and a lid of this half width at a height of `1 + gap`.
fn lidded(gap: f64, half: f64) -> Soup {
    let square = |half: f64, z: f64| [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    let points = [square(1.0, 0.0), square(1.0, 1.0), square(half, 1.0 + gap)].concat();
    let quads = [[0, 3, 2, 1], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [8, 9, 10, 11]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Soup { points, triangles, ..Soup::default() }
}

fn welding(tolerance: Length) -> RepairOptions {
    RepairOptions { weld: Some(tolerance), ..RepairOptions::default() }
}

/// What the whole method makes of it: Euler characteristic, boundary loops, components.
fn meshed(soup: &Soup, points: usize, repairs: RepairOptions) -> [i64; 3] {
    let options = Options { repairs, ..Options::new(Fineness::Points(points)) };
    let outcome = run(soup, &options, &Cpu, &unwatched).unwrap_or_else(|error| panic!("{error}"));
    assert!(outcome.meshed.differences.is_empty(), "{:?}", outcome.meshed.differences);
    let faults = outcome.meshed.faults;
    [faults.euler, faults.boundary_loops as i64, faults.components as i64]
}

#[test]
fn a_lid_that_floats_is_welded_on() {
    let soup = lidded(1e-5, 1.0);
    assert_eq!(meshed(&soup, 300, RepairOptions::default()), [2, 2, 2], "a box without a lid, and a lid");
    assert_eq!(meshed(&soup, 300, welding(Length::Model(2e-5))), [2, 0, 1]);
    assert_eq!(meshed(&soup, 300, welding(Length::Model(0.5e-5))), [2, 2, 2], "the gap is wider");
    let gap = repaired(&soup, &welding(Length::Diagonals(1e-5))).repairs().largest_gap;
    assert!((gap - 1e-5).abs() < 1e-12, "{gap}");
}

/// A plate with a round hole of radius 1, `plate` chords round it, and a closed drum of `drum` chords on its rim.
fn boss(plate: usize, drum: usize) -> Soup {
    let mut soup = Soup::default();
    let circle = |count: usize, radius: f64, z: f64| {
        let angle = move |k: usize| TAU * k as f64 / count as f64;
        (0..count).map(move |k| [radius * angle(k).cos(), radius * angle(k).sin(), z])
    };
    let band = |soup: &mut Soup, rings: [Vec<[f64; 3]>; 2]| {
        let (first, count) = (soup.points.len() as u32, rings[0].len() as u32);
        soup.points.extend(rings.concat());
        for i in 0..count {
            let [a, b] = [i, (i + 1) % count].map(|k| first + k);
            soup.triangles.extend([[a, b, b + count], [a, b + count, a + count]]);
        }
    };
    band(&mut soup, [circle(plate, 3.0, 0.0).collect(), circle(plate, 1.0, 0.0).collect()]);
    band(&mut soup, [circle(drum, 1.0, 0.0).collect(), circle(drum, 1.0, 1.5).collect()]);
    let (top, first) = (soup.points.len() as u32, soup.points.len() as u32 - drum as u32);
    soup.points.push([0.0, 0.0, 1.5]);
    soup.triangles.extend((0..drum as u32).map(|i| [first + i, first + (i + 1) % drum as u32, top]));
    soup
}

#[test]
fn rims_of_other_chords_are_sewn() {
    // No vertex of one is one of the other's but at 0 and 180 degrees.
    let soup = boss(32, 46);
    // The sagitta of a chord of 32.
    let sagitta = 1.0 - (PI / 32.0).cos();
    assert_eq!(topology(&repaired(&boss(46, 46), &RepairOptions::default())), (1, 1), "a disc with a boss");
    assert_ne!(topology(&repaired(&soup, &RepairOptions::default())), (1, 1));
    let sewn = repaired(&soup, &welding(Length::Model(sagitta)));
    assert_eq!(topology(&sewn), (1, 1));
    assert_eq!(sewn.repairs().sewn_vertices.count, 32 + 46 - 2 * 2);
    let gap = sewn.repairs().largest_gap;
    assert!((0.8 * sagitta..=sagitta).contains(&gap), "{gap} for {sagitta}");
    assert_ne!(topology(&repaired(&soup, &welding(Length::Model(0.2 * sagitta)))), (1, 1), "the gap is wider");
    assert_eq!(meshed(&soup, 300, welding(Length::Model(sagitta))), [1, 1, 1]);
}

#[test]
fn corners_a_few_steps_of_single_precision_apart_are_one() {
    // Each triangle has corners of its own, as in STL, which differ by up to two steps of f32 in each coordinate.
    let noisy = |steps: i32| {
        let soup = example("sphere", 1_000);
        let mut random = surfaces::scattered(5);
        let mut torn = Soup::default();
        for triangle in &soup.triangles {
            let first = torn.points.len() as u32;
            torn.points.extend(triangle.map(|v| {
                soup.points[v as usize].map(|x| {
                    let mut x = x as f32 + 1.0;
                    for _ in 0..(random() * f64::from(steps + 1)) as i32 {
                        x = x.next_up();
                    }
                    f64::from(x)
                })
            }));
            torn.triangles.push([first, first + 1, first + 2]);
        }
        torn
    };
    assert_eq!(topology(&repaired(&noisy(2), &RepairOptions::default())), (2, 0));
    assert_ne!(topology(&repaired(&noisy(40), &RepairOptions::default())), (2, 0), "that many are no rounding");
}

/// The surface with what a search for contacts finds, for tiles of this side in model units.
fn searched(soup: &Soup, repairs: &RepairOptions, side: f64) -> Surface {
    let surface = repaired(soup, repairs);
    let side = side / surface.frame().diagonal;
    surface.with_contacts(side)
}

/// Crossing pairs, coincident pairs, touching edges.
fn contacts(soup: &Soup) -> [usize; 3] {
    let surface = searched(soup, &RepairOptions::default(), 0.1);
    let found = surface.contacts();
    [found.crossing.count, found.coincident.count, found.touching.count]
}

#[test]
fn rims_side_by_side_are_told_with_the_tolerance_that_sews_them() {
    for (soup, side, whole) in [(lidded(1e-5, 1.0), 0.2, (2, 0)), (boss(32, 46), 0.3, (1, 1))] {
        let surface = searched(&soup, &RepairOptions::default(), side);
        let found = surface.contacts().near_rims.expect("rims side by side");
        assert!(found.gap <= 0.02 * side && found.tolerance < 1.3 * found.gap, "{found:?}");
        let sewn = searched(&soup, &welding(Length::Model(found.tolerance)), side);
        assert_eq!((topology(&sewn), sewn.contacts().near_rims), (whole, None));
        // Beside tiles a fiftieth as large the gap is none.
        let fine = searched(&soup, &RepairOptions::default(), found.gap);
        assert_eq!(fine.contacts().near_rims, None);
    }
}

#[test]
fn rims_that_belong_apart_are_not_told() {
    // Finely divided rims, a hole, a wedge that opens at five degrees.
    let wedge = {
        let mut soup = flat(20, 4, 0.1);
        let first = soup.points.len() as u32;
        let other = flat(20, 4, 0.1);
        let (s, c) = 5f64.to_radians().sin_cos();
        soup.points.extend(other.points.iter().map(|&[x, y, _]| [x * c - y * s, -x * s - y * c, 0.0]));
        soup.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        soup
    };
    for soup in [flat(200, 200, 0.01), pierced(), example("plate", 2_000), wedge] {
        for side in [0.05, 0.2] {
            assert_eq!(searched(&soup, &RepairOptions::default(), side).contacts().near_rims, None);
        }
    }
}

fn joined(soups: &[Soup]) -> Soup {
    let mut all = Soup::default();
    for soup in soups {
        let first = all.points.len() as u32;
        all.points.extend(&soup.points);
        all.triangles.extend(soup.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

fn moved(mut soup: Soup, by: [f64; 3]) -> Soup {
    soup.points.iter_mut().for_each(|p| *p = [0, 1, 2].map(|k| p[k] + by[k]));
    soup
}

/// A wall of `columns` by 3 squares of this side over the line from `start` along `way`.
fn wall(columns: usize, cell: f64, start: [f64; 3], [dx, dy]: [f64; 2]) -> Soup {
    let mut soup = flat(columns, 3, cell);
    soup.points.iter_mut().for_each(|p| *p = [start[0] + p[0] * dx, start[1] + p[0] * dy, start[2] + p[1]]);
    soup
}

/// A box of `m` squares along each side.
fn cube(m: usize, low: [f64; 3], size: f64, turned: bool) -> Soup {
    let mut soup = Soup::default();
    for axis in 0..3 {
        for end in [0.0, 1.0] {
            let mut face = flat(m, m, size / m as f64);
            if turned {
                // The other diagonals.
                face.points.iter_mut().for_each(|p| p[0] = size - p[0]);
            }
            face.points.iter_mut().for_each(|p| {
                let [x, y, _] = *p;
                let mut q = low;
                q[axis] += end * size;
                q[(axis + 1) % 3] += x;
                q[(axis + 2) % 3] += y;
                *p = q;
            });
            soup = joined(&[soup, face]);
        }
    }
    soup
}

#[test]
fn crossing_coincident_and_touching_sheets_are_told() {
    let sphere = example("sphere", 1_000);
    let apart = joined(&[sphere.clone(), moved(sphere.clone(), [2.1, 0.1, 0.05])]);
    assert_eq!(contacts(&apart), [0; 3]);
    let crossing = joined(&[sphere.clone(), moved(sphere, [1.5, 0.1, 0.05])]);
    let [crosses, 0, 0] = contacts(&crossing) else { panic!("{:?}", contacts(&crossing)) };
    assert!(crosses > 20, "{crosses}");
    let at = searched(&crossing, &RepairOptions::default(), 0.1).contacts().crossing.at[0];
    let distances = [0.0, 1.5].map(|x| DVec3::from(at).distance(DVec3::new(x, 0.0, 0.0)));
    assert!(distances.iter().all(|d| (d - 1.0).abs() < 0.3), "{at:?} is on both spheres");

    let boxes = |x: f64| joined(&[cube(3, [0.0; 3], 1.0, false), cube(3, [x, 0.0, 0.0], 1.0, true)]);
    assert_eq!(contacts(&boxes(1.1)), [0; 3]);
    let [0, coincident, 0] = contacts(&boxes(1.0)) else { panic!("{:?}", contacts(&boxes(1.0))) };
    assert!(coincident >= 18, "{coincident} pairs on a wall of 18 triangles");

    let floor = |z: f64| joined(&[flat(10, 10, 0.4), wall(7, 0.3, [0.73, 1.13, z], [0.9, 0.4])]);
    assert_eq!(contacts(&floor(0.0)), [0, 0, 7]);
    assert_eq!(contacts(&floor(0.1)), [0; 3]);
    let [crosses, 0, 0] = contacts(&floor(-0.1)) else { panic!("{:?}", contacts(&floor(-0.1))) };
    assert!(crosses > 7, "the wall passes through the floor: {crosses}");
}

#[test]
fn whole_surfaces_have_no_contacts() {
    for (name, ..) in surfaces::EXAMPLES {
        assert_eq!(contacts(&example(name, 6_000)), [0; 3], "{name}");
    }
    // A disc whose corners are cut off in turns: slivers lie along its rim.
    let point = |k: u32| [(f64::from(k) * TAU / 4096.0).cos(), (f64::from(k) * TAU / 4096.0).sin(), 0.0];
    let mut disc = Soup { points: (0..4096).map(point).collect(), ..Soup::default() };
    for step in (0..11).map(|level| 1 << level) {
        disc.triangles.extend((0..4096).step_by(2 * step).map(|k| [k, k + step as u32, (k + 2 * step as u32) % 4096]));
    }
    assert_eq!(disc.triangles.len(), 4094);
    assert_eq!(contacts(&disc), [0; 3]);
    // A flat floor with a wall that shares its edges.
    let conforming = joined(&[flat(10, 10, 0.4), wall(6, 0.4, [0.8, 1.2, 0.0], [1.0, 0.0])]);
    assert_eq!(contacts(&conforming), [0; 3]);
}

fn imprint() -> RepairOptions {
    RepairOptions { imprint: true, ..RepairOptions::default() }
}

#[test]
fn walls_are_joined_to_the_floor_they_stand_on() {
    let plate = || flat(10, 10, 0.4);
    let whole = repaired(&plate(), &RepairOptions::default());
    let cases = [
        ("within the floor", joined(&[plate(), wall(7, 0.3, [0.73, 1.13, 0.0], [0.9, 0.43])])),
        ("in one triangle", joined(&[flat(1, 1, 4.0), wall(2, 0.5, [2.2, 1.0, 0.0], [1.0, 0.2])])),
        ("along edges, with other vertices", joined(&[plate(), wall(7, 0.31, [0.6, 1.2, 0.0], [1.0, 0.0])])),
        ("along diagonals", joined(&[plate(), wall(5, 0.5, [0.4, 0.4, 0.0], [1.0, 1.0])])),
        ("one long wall over many triangles", joined(&[plate(), wall(1, 3.3, [0.3, 0.31, 0.0], [0.8, 0.6])])),
        (
            "two walls that meet at a corner",
            joined(&[
                plate(),
                wall(4, 0.4, [1.03, 1.01, 0.0], [1.0, 0.3]),
                wall(4, 0.4, [1.03, 1.01, 0.0], [-0.2, 1.0]),
            ]),
        ),
    ];
    for (name, soup) in cases {
        let before = searched(&soup, &RepairOptions::default(), 0.2);
        let (touching, seams) = (before.contacts().touching.count, before.repairs().joined_edges.count);
        assert!(touching > 0 && seams == 0, "{name}: {touching}, {seams}");
        let after = searched(&soup, &imprint(), 0.2);
        assert_eq!(after.contacts().touching.count, 0, "{name}");
        assert!(after.repairs().joined_edges.count >= touching, "{name}: {}", after.repairs().joined_edges.count);
        assert_eq!(after.repairs().imprinted_edges.count, touching, "{name}");
        // No area comes or goes.
        let [a, b] = [&before, &after].map(|surface| surface.area());
        assert!((a - b).abs() < 1e-6 * a, "{name}: {a}, {b}");
        assert_eq!(after.contacts().coincident.count + after.contacts().crossing.count, 0, "{name}");
    }
    assert_eq!(repaired(&plate(), &imprint()).triangle_count(), whole.triangle_count(), "nothing to join");
}

#[test]
fn the_mesh_branches_where_a_wall_was_joined() {
    let soup = joined(&[flat(10, 10, 0.4), wall(7, 0.3, [0.73, 1.13, 0.0], [0.9, 0.43])]);
    assert_eq!(meshed(&soup, 500, RepairOptions::default()), [2, 2, 2], "a floor and a wall");
    let [euler, _, components] = meshed(&soup, 500, imprint());
    assert_eq!([euler, components], [1, 1], "one piece without a handle");
}
