//! Pictures: what is in front is seen, what is behind is not, and areas are what geometry says.

mod common;

use common::surfaces::{example, flat, surface};
use quadmosaic::compute::Cpu;
use quadmosaic::field::{Field, FieldOptions};
use quadmosaic::mesh::Mesh;
use quadmosaic::mosaic::{Mosaic, Tile};
use quadmosaic::picture::{
    Colour, Eye, FieldStyle, Image, Paint, PictureError, View, field_scene, mesh_scene, mosaic_scene, write_picture,
};
use std::f64::consts::PI;
use std::fs;

const PAPER: [u8; 3] = Colour::PAPER.0;

fn from(direction: [f64; 3], zoom: Option<([f64; 3], f64)>) -> View {
    View { eye: Eye::At(direction), up: None, zoom }
}

fn image(mesh: &Mesh, view: &View, size: [u32; 2]) -> Image {
    Image::of(&mesh_scene(mesh, Paint::Sides), view, size).unwrap_or_else(|error| panic!("{error}"))
}

fn count(image: &Image, of_kind: impl Fn([u8; 3]) -> bool) -> usize {
    image.pixels.iter().filter(|&&pixel| of_kind(pixel)).count()
}

fn pixel(image: &Image, x: u32, y: u32) -> [u8; 3] {
    image.pixels[(y * image.width + x) as usize]
}

/// Orange is far from grey, whatever the light.
fn is_orange([red, green, blue]: [u8; 3]) -> bool {
    red > green.saturating_add(40) && green > blue.saturating_add(20)
}

/// Faces over the square from -1 to 1 at these heights: a quad where the number of sides is 4, half of one where it is 3.
fn stack(faces: &[(f64, usize)]) -> Mesh {
    let mut mesh = Mesh::default();
    for &(height, sides) in faces {
        let first = mesh.points.len() as u32;
        mesh.points.extend([[-1.0, -1.0, height], [1.0, -1.0, height], [1.0, 1.0, height], [-1.0, 1.0, height]]);
        mesh.push_face(&(first..first + sides as u32).collect::<Vec<u32>>());
    }
    mesh
}

#[test]
fn a_sphere_has_the_area_of_a_disc() {
    let mesh = Mesh::from(example("sphere", 20_000));
    // The ball of radius 2 fills the picture: a pixel is a hundredth.
    for eye in [[0.0, 0.0, 1.0], [1.0, -2.0, 0.5]] {
        let drawn = image(&mesh, &from(eye, Some(([0.0; 3], 2.0))), [500, 400]);
        let disc = PI * 100.0_f64.powi(2);
        let found = count(&drawn, |pixel| pixel != PAPER) as f64;
        // A pixel that is covered in part counts as a whole: of those that a circle passes, 8 a radius, half is too much.
        let rim = 8.0 * 100.0;
        assert!(found > disc - 0.1 * rim && found < disc + rim, "{found} pixels for {disc}");
        // The polygon seen lies inside the circle, by less than a pixel.
        assert_eq!(pixel(&drawn, 250, 98), PAPER);
        assert_ne!(pixel(&drawn, 250, 102), PAPER);
        // A sphere that is a little larger is told apart.
        assert!(PI * 102.0_f64.powi(2) > disc + rim);
    }
}

#[test]
fn the_nearer_face_is_seen_whatever_the_order() {
    let above = from([0.0, 0.0, 1.0], None);
    let below = from([0.0, 0.0, -1.0], None);
    let [one, other] = [[(0.0, 3), (1.0, 4)], [(1.0, 4), (0.0, 3)]].map(|faces| stack(&faces));
    let covered = image(&one, &above, [200, 200]);
    assert_eq!(covered, image(&other, &above, [200, 200]));
    assert_eq!(count(&covered, is_orange), 0, "the triangle is below the quad");
    // From below all faces are seen from behind; the triangle hides half of the quad, and is told by its long side.
    assert_ne!(image(&one, &below, [200, 200]), image(&stack(&[(1.0, 4)]), &below, [200, 200]));
    // Without the quad it is seen; it is half of the square that fills the picture but for the margins.
    let mut alone = stack(&[(1.0, 4), (0.0, 3)]);
    alone.points[..4].iter_mut().for_each(|point| point[0] += 9.0);
    let seen = image(&alone, &from([0.0, 0.0, 1.0], Some(([0.0; 3], 1.0))), [200, 200]);
    let share = count(&seen, is_orange) as f64 / 40_000.0;
    // The sides, here a pixel wide, take some from the edge.
    assert!((share - 0.5).abs() < 0.02, "{share}");
}

#[test]
fn a_tilted_face_is_cut_by_the_one_it_passes_through() {
    // Two quads that cross along the y axis: each hides half of the other.
    let mut mesh = Mesh::new(vec![
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
    ]);
    mesh.push_face(&[0, 1, 2, 3]);
    mesh.push_face(&[4, 5, 6]);
    let drawn = image(&mesh, &from([0.0, 0.0, 1.0], Some(([0.0; 3], 1.0))), [300, 300]);
    // The triangle, where y is below x, is the nearer one where x is below 0: there it covers a quarter of the left half.
    let left = drawn.pixels.chunks(300).flat_map(|row| &row[..149]).filter(|&&pixel| is_orange(pixel)).count();
    assert!((left as f64 / 90_000.0 - 0.125).abs() < 0.02, "{left}");
    let right = drawn.pixels.chunks(300).flat_map(|row| &row[151..]).filter(|&&pixel| is_orange(pixel)).count();
    assert_eq!(right, 0);
}

#[test]
fn a_face_that_is_missing_is_seen_to_be_missing() {
    let mut mesh = Mesh::from(flat(8, 8, 1.0));
    let view = from([0.0, 0.0, 1.0], Some(([4.0, 4.0, 0.0], 4.0)));
    let whole = image(&mesh, &view, [400, 400]);
    assert_eq!(count(&whole, |pixel| pixel == PAPER), 0);
    let faces: Vec<Vec<u32>> = mesh.faces().map(<[u32]>::to_vec).collect();
    mesh = Mesh::new(mesh.points);
    faces.iter().enumerate().filter(|(number, _)| *number != 37).for_each(|(_, face)| mesh.push_face(face));
    let holed = image(&mesh, &view, [400, 400]);
    // Half of a cell of 50 by 50 pixels, less the lines round it, which are heavier for being a boundary now.
    let hole = count(&holed, |pixel| pixel == PAPER) as f64;
    assert!(hole > 0.8 * 1250.0 && hole <= 1250.0, "{hole}");
}

#[test]
fn lines_behind_a_face_are_hidden() {
    let sides = |mesh: &Mesh| {
        let drawn = image(mesh, &from([0.3, -0.4, 1.0], None), [800, 800]);
        count(&drawn, |pixel| pixel.iter().all(|&part| part < 100))
    };
    let grid = |height: f64| {
        let mut soup = flat(6, 6, 1.0);
        soup.points.iter_mut().for_each(|point| point[2] = height);
        Mesh::from(soup)
    };
    let lid = |height: f64| {
        let mut mesh = grid(0.0);
        let first = mesh.points.len() as u32;
        mesh.points.extend([[-2.0, -2.0, height], [8.0, -2.0, height], [8.0, 8.0, height], [-2.0, 8.0, height]]);
        mesh.push_face(&[first, first + 1, first + 2, first + 3]);
        mesh
    };
    // Above the grid the lid leaves its own four sides alone.
    let (covered, bare) = (sides(&lid(0.5)), sides(&lid(-0.5)));
    assert!(bare > 2 * covered && covered > 0, "{bare} {covered}");
}

#[test]
fn the_same_scene_gives_the_same_bytes_with_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let surface = surface(&example("block", 2_000));
    let field = Field::new(&surface, &FieldOptions::default(), &Cpu).unwrap_or_else(|error| panic!("{error}"));
    let bytes = |threads: usize, name: &str| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let path = folder.path().join(name);
            let scene = field_scene(&surface, &field, FieldStyle::Streamlines);
            write_picture(&path, &scene, &View::default(), [320, 200]).unwrap_or_else(|error| panic!("{error}"));
            fs::read(path).expect("it is there")
        })
    };
    for name in ["a.png", "a.svg"] {
        let first = bytes(1, name);
        assert_eq!(first, bytes(1, name));
        assert_eq!(first, bytes(2, name));
    }
    let png = bytes(2, "a.png");
    let decoder = png::Decoder::new(std::io::Cursor::new(png));
    let mut reader = decoder.read_info().expect("it is a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("it is small")];
    reader.next_frame(&mut pixels).expect("it is whole");
    assert_eq!([reader.info().width, reader.info().height], [320, 200]);
    let scene = field_scene(&surface, &field, FieldStyle::Streamlines);
    let image = Image::of(&scene, &View::default(), [320, 200]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(pixels, image.pixels.as_flattened());
}

/// The paths of a mesh's picture as SVG, seen from above.
fn paths(mesh: &Mesh) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.svg");
    write_picture(&path, &mesh_scene(mesh, Paint::Sides), &from([0.0, 0.0, 1.0], None), [200, 200])
        .unwrap_or_else(|error| panic!("{error}"));
    let text = fs::read_to_string(&path).expect("it is there");
    text.lines().filter(|line| line.starts_with("<path")).map(str::to_owned).collect()
}

#[test]
fn svg_leaves_out_what_is_hidden_and_draws_the_far_first() {
    assert_eq!(paths(&stack(&[(0.0, 3), (1.0, 4)])).len(), 1);
    let both = paths(&stack(&[(1.0, 3), (0.0, 4)]));
    assert_eq!(both.len(), 2);
    assert_eq!(both[0].matches('L').count(), 3, "the quad lies behind");
    assert_eq!(both[1].matches('L').count(), 2);
}

#[test]
fn svg_draws_a_face_after_what_it_hides_wherever_their_middles_are() {
    // A quad that rises from left to right, its middle at height 0, and a triangle over or under its left end.
    let ramp = |height: f64| {
        let (x, y) = (10.0, 2.0);
        let mut mesh = Mesh::new(vec![[-x, -y, -x], [x, -y, x], [x, y, x], [-x, y, -x]]);
        mesh.points.extend([[-9.0, -1.0, height], [-8.0, 0.0, height], [-9.0, 3.0, height]]);
        mesh.push_face(&[0, 1, 2, 3]);
        mesh.push_face(&[4, 5, 6]);
        paths(&mesh).iter().map(|path| path.matches('L').count()).collect::<Vec<_>>()
    };
    assert_eq!(ramp(-5.0), [3, 2], "farther than the middle of the quad, and yet above it");
    assert_eq!(ramp(-9.5), [2, 3], "below it, and seen beside it");

    // Three bars of which each hides the next: there is no order, and yet each is drawn once.
    let mut ring = Mesh::default();
    for turn in [0.0, 2.0 * PI / 3.0, 4.0 * PI / 3.0] {
        let first = ring.points.len() as u32;
        let (sin, cos) = f64::sin_cos(turn);
        let corner = |x: f64, y: f64, z: f64| [x * cos - y * sin, x * sin + y * cos, z];
        ring.points.extend([[-6.0, 1.5], [6.0, 1.5], [6.0, 2.5], [-6.0, 2.5]].map(|[x, y]| corner(x, y, x)));
        ring.push_face(&[first, first + 1, first + 2, first + 3]);
    }
    assert_eq!(paths(&ring).len(), 3);
}

#[test]
fn svg_leaves_out_what_is_hidden_of_a_line() {
    // The borders of a large triangle, over the right half of which another one lies.
    let drawn = |height: f64| {
        let mut mesh = Mesh::new(vec![[-8.0, -8.0, 0.0], [8.0, -8.0, 0.0], [0.0, 8.0, 0.0]]);
        mesh.points.extend([[0.0, -20.0, height], [20.0, 0.0, height], [0.0, 20.0, height]]);
        mesh.push_face(&[0, 1, 2]);
        mesh.push_face(&[3, 4, 5]);
        let lines = paths(&mesh).into_iter().filter(|path| !path.contains("fill"));
        let length = |path: String| {
            let ends: Vec<f64> = path.split(['M', 'L', ' ', '"']).filter_map(|part| part.parse().ok()).collect();
            (ends[0] - ends[2]).hypot(ends[1] - ends[3])
        };
        lines.map(length).sum::<f64>()
    };
    // 28 units wide and 40 high, of which 92 % of 200 pixels are filled; the lid's own borders are seen always.
    let unit = 0.92 * 200.0 / 40.0;
    let (slant, lid) = (17.89 * unit, (40.0 + 2.0 * 28.28) * unit);
    let (above, below) = (drawn(1.0), drawn(-1.0));
    // Pieces have at most 8 pixels; the lid's left side hides what is below.
    assert!((above - (slant + 8.0 * unit + lid)).abs() < 3.0 * 8.0, "{above}");
    assert!(below > above + 20.0, "{below}");
}

#[test]
fn a_spheres_field_has_red_dots_and_a_torus_none() {
    let red = |name: &str| {
        let surface = surface(&example(name, 4_000));
        let field = Field::new(&surface, &FieldOptions::default(), &Cpu).unwrap_or_else(|error| panic!("{error}"));
        let bends = field.singularities(&surface).iter().filter(|singularity| singularity.quarters > 0).count();
        let scene = field_scene(&surface, &field, FieldStyle::Crosses);
        let drawn = Image::of(&scene, &View::default(), [400, 400]).unwrap_or_else(|error| panic!("{error}"));
        let blue = count(&drawn, |[red, _, blue]| blue > red.saturating_add(60));
        assert!(blue > 1000, "{name}: crosses are drawn: {blue}");
        (bends, count(&drawn, |[red, green, _]| red > 150 && green < 60))
    };
    let (bends, dots) = red("sphere");
    assert!(bends >= 8 && dots > 20, "{bends} {dots}");
    assert_eq!(red("torus"), (0, 0));
}

#[test]
fn a_field_is_drawn_on_its_surface_alone() {
    let surface = surface(&example("sphere", 4_000));
    let field = Field::new(&surface, &FieldOptions::default(), &Cpu).unwrap_or_else(|error| panic!("{error}"));
    // A sphere of 100 pixels; lines are 0.6 wide, and lie a little above it.
    let view = from([0.0, 0.0, 1.0], Some(([0.0; 3], 2.0)));
    for style in [FieldStyle::Streamlines, FieldStyle::Crosses] {
        let drawn = Image::of(&field_scene(&surface, &field, style), &view, [400, 400]);
        let drawn = drawn.unwrap_or_else(|error| panic!("{error}"));
        let away = |at: usize| (at as f64 % 400.0 - 199.5).hypot((at / 400) as f64 - 199.5);
        let inked = |at: &usize| drawn.pixels[*at] != PAPER;
        let farthest = (0..160_000).filter(inked).map(away).fold(0.0, f64::max);
        assert!(farthest > 99.0 && farthest < 101.0, "{farthest}");
    }
}

/// Tiles of side `h` in rows on a flat square of that many cells, as unit-sized coordinates have it.
fn lattice(cells: usize) -> (quadmosaic::surface::Surface, Mosaic) {
    let surface = surface(&flat(cells, cells, 1.0));
    let h = (1.0 / surface.frame().diagonal) as f32;
    let mut tiles = Vec::new();
    for triangle in (0..2 * cells * cells).step_by(2) {
        let cell = triangle / 2;
        let place = [cell % cells, cell / cells].map(|k| (k as f32 + 0.5 - cells as f32 / 2.0) * h);
        let position = [place[0], place[1], 0.0];
        let (normal, axis) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        tiles.push(Tile { position, h, normal, triangle: triangle as u32, axis, quarters: 0 });
    }
    let mut mosaic = Mosaic::default();
    mosaic.tiles = tiles;
    (surface, mosaic)
}

#[test]
fn grout_takes_the_share_that_it_is_given() {
    let (surface, mosaic) = lattice(10);
    for grout in [0.1, 0.3] {
        let scene = mosaic_scene(&surface, &mosaic, grout, None);
        let view = from([0.0, 0.0, 1.0], Some(([5.0, 5.0, 0.0], 5.0)));
        let drawn = Image::of(&scene, &view, [500, 500]).unwrap_or_else(|error| panic!("{error}"));
        let tiles = count(&drawn, |[red, ..]| red > 160) as f32 / 250_000.0;
        // Sides of tiles fall on pixels' sides here, but for the picture's last digit.
        assert!((tiles - (1.0 - grout).powi(2)).abs() < 0.01, "{grout}: {tiles}");
    }
}

#[test]
fn tiles_are_seen_from_in_front_alone_and_above_what_bulges() {
    let stone = |drawn: &Image| count(drawn, |[red, ..]| red > 150) as f64 / drawn.pixels.len() as f64;
    let draw = |surface: &quadmosaic::surface::Surface, mosaic: &Mosaic, view: View| {
        let scene = mosaic_scene(surface, mosaic, 0.0, None);
        stone(&Image::of(&scene, &view, [200, 200]).unwrap_or_else(|error| panic!("{error}")))
    };
    let (plate, tiles) = lattice(10);
    let view = |height: f64| from([0.0, 0.0, height], Some(([5.0, 5.0, 0.0], 4.0)));
    assert_eq!([1.0, -1.0].map(|height| draw(&plate, &tiles, view(height))), [1.0, 0.0]);

    // A tile as large as the radius of its sphere is flat between its corners, and the sphere rises above it.
    let soup = example("sphere", 20_000);
    let ball = surface(&soup);
    let middle = |triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|v| soup.points[v as usize]);
        [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
    };
    let (top, middle) = (0..)
        .zip(soup.triangles.iter().map(|&triangle| middle(triangle)))
        .max_by(|a, b| a.1[2].total_cmp(&b.1[2]))
        .expect("it has triangles");
    let position = middle.map(|x| (x / ball.frame().diagonal) as f32);
    let h = (1.0 / ball.frame().diagonal) as f32;
    let (normal, axis) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let mut tile = Mosaic::default();
    tile.tiles = vec![Tile { position, h, normal, triangle: top, axis, quarters: 0 }];
    let view = from([0.0, 0.0, 1.0], Some(([0.0, 0.0, 1.0], 0.4)));
    assert_eq!(draw(&ball, &tile, view), 1.0);
    assert_eq!(draw(&ball, &Mosaic::default(), view), 0.0, "the sphere itself is no stone");
}

#[test]
fn what_cannot_be_drawn_or_written_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = mesh_scene(&stack(&[(0.0, 4)]), Paint::Quality);
    let write = |name: &str, size| write_picture(&folder.path().join(name), &scene, &View::default(), size);
    for size in [[0, 100], [100, 15], [20_000, 100]] {
        assert!(matches!(write("a.png", size), Err(PictureError::Size { .. })), "{size:?}");
        assert!(matches!(write("a.svg", size), Err(PictureError::Size { .. })), "{size:?}");
    }
    assert!(matches!(write("a.jpg", [100; 2]), Err(PictureError::Format { .. })));
    assert!(matches!(write("png", [100; 2]), Err(PictureError::Format { .. })));
    assert!(matches!(write("no/a.png", [100; 2]), Err(PictureError::Write(_))));
    assert_eq!(fs::read_dir(folder.path()).expect("it can be listed").count(), 0, "nothing is left");
    write("a.PNG", [100; 2]).unwrap_or_else(|error| panic!("{error}"));
    let nothing = mesh_scene(&Mesh::default(), Paint::Sides);
    let empty = Image::of(&nothing, &View::default(), [100; 2]);
    assert!(matches!(empty, Err(PictureError::Empty)));
}
