//! The periodic solve: rows in step, on features and on both backends.

mod common;

use common::surfaces::{example, surface};
use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::gpu::GpuBackend;
use quadmosaic::parametrize::Parametrization;
use quadmosaic::parametrize::Rows;
use quadmosaic::parametrize::integer_grid::integer_grid;
use quadmosaic::surface::{Soup, Surface};

fn field(surface: &Surface) -> Field {
    Field::new(surface, &FieldOptions::default(), &Cpu).expect("the CPU does not fail")
}

/// A flat rectangle of so many cells.
fn rectangle(columns: u32, rows: u32) -> Surface {
    let mut soup = Soup::default();
    for j in 0..=rows {
        soup.points.extend((0..=columns).map(|i| [f64::from(i), f64::from(j), 0.0]));
    }
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let a = j * (columns + 1) + i;
        let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
        soup.triangles.extend([[a, b, c], [a, c, d]]);
    }
    surface(&soup)
}

/// The largest distance of a number from a whole one.
fn off_whole(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|x| (x - x.round()).abs()).fold(0.0, f64::max)
}

#[test]
fn rows_on_a_rectangle_are_straight_and_keep_to_its_sides() {
    let (columns, rows) = (30, 20);
    let surface = rectangle(columns, rows);
    let field = field(&surface);
    // Tiles two cells wide fit; tiles of 2.2 cells are 13.6 and 9.1 a side, and have to give way.
    let cell = 1.0 / surface.frame().diagonal;
    let in_cells = |position: [f32; 3]| {
        let [x, y, _] = surface.frame().to_model(position.map(f64::from));
        [x / 2.0, y / 2.0]
    };
    for (side, fits) in [(2.0, true), (2.2, false)] {
        let phases = Parametrization::solve(&surface, &field, |_| side * cell, &[], Rows::Paper, &Cpu)
            .expect("the CPU does not fail");
        let points = integer_grid(&surface, &field, &phases, (side * cell) as f32);
        let off = off_whole(points.iter().flat_map(|point| in_cells(point.place())));
        // Parametrization are f32 and in radians: 1e-6 of a tile, and 200 sweeps of them.
        assert_eq!(off < 1e-4, fits, "{side}: {off}");
        if fits {
            let mut places: Vec<[i64; 2]> =
                points.iter().map(|point| in_cells(point.place()).map(|x| x.round() as i64)).collect();
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len() as u32, (columns / 2 + 1) * (rows / 2 + 1), "a tile at each crossing");
        }
    }
}

#[test]
fn steps_close_round_a_triangle_but_where_rows_end() {
    let torus = surface(&example("torus", 20_000));
    let field = field(&torus);
    let phases =
        Parametrization::solve(&torus, &field, |_| 0.02, &[], Rows::Paper, &Cpu).expect("the CPU does not fail");
    let round = |t: u32| {
        let [a, b] = [phases.step(3 * t), phases.step_at_end(3 * t + 2)];
        // The second side's step, as the first corner reads it.
        let there = phases.step(3 * t + 1);
        let turned = |[u, v]: [f64; 2]| [[u, v], [-v, u], [-u, -v], [v, -u]];
        let sums = turned(there).map(|c| (a[0] + b[0] + c[0]).abs() + (a[1] + b[1] + c[1]).abs());
        sums.into_iter().fold(f64::MAX, f64::min)
    };
    let triangles = torus.triangle_count() as u32;
    let open = (0..triangles).filter(|&t| round(t) > 1e-6).count();
    // A torus of these radii has rows of 2 pi (1 + 0.4) to 2 pi (1 - 0.4) lengths: some end, few triangles are hit.
    assert!(open > 0 && open < triangles as usize / 50, "{open} of {triangles}");
}

#[test]
fn the_phases_are_the_same_on_both_backends() {
    let Some(gpu) = common::gpu() else { return };
    let backend = GpuBackend::new(gpu).expect("kernels");
    let backends: [&dyn Backend; 2] = [&Cpu, &backend];
    for name in ["torus", "block", "m6", "plate"] {
        let surface = surface(&example(name, 12_000));
        let field = field(&surface);
        let [cpu, other] = backends.map(|backend| {
            let phases = Parametrization::solve(&surface, &field, |_| 0.03, &[], Rows::Paper, backend)
                .expect("no backend fails");
            (0..3 * surface.triangle_count() as u32).map(|corner| phases.at(corner)).collect::<Vec<_>>()
        });
        let off = |[a, b]: [&[f64; 2]; 2]| off_whole([a[0] - b[0], a[1] - b[1]].into_iter());
        if gpu.adapter().hardware {
            // Other roundings of 1e-7 may put a row end one triangle further, no more.
            let far = cpu.iter().zip(&other).filter(|(a, b)| off([a, b]) > 1e-2).count();
            assert!(far * 100 < cpu.len(), "{name}: {far} of {} differ", cpu.len());
        } else {
            assert_eq!(cpu, other, "{name}");
        }
        let moved = Parametrization::solve(&surface, &field, |_| 0.0301, &[], Rows::Paper, backends[1])
            .expect("no backend fails");
        let far = (0..).zip(&cpu).filter(|(corner, a)| off([a, &moved.at(*corner)]) > 1e-2).count();
        assert!(far * 10 > cpu.len(), "{name}: another side gives other phases");
    }
}
