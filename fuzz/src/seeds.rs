//! What the targets begin with, made by the library's own examples and writers.

use crate::bytes::of_soup;
use quadmosaic::Soup;
use quadmosaic::export::{Format, MeshFile, write_mesh_to};
use quadmosaic::mesh::Mesh;
use quadmosaic::options::{NAMES, Preset};
use quadmosaic::surface::Regions;
use std::f64::consts::TAU;

/// The seeds of a target.
pub fn seeds(target: &str) -> Vec<Vec<u8>> {
    match target {
        "obj" => [written(&[Format::Obj]), texts(OBJ)].concat(),
        "stl" => [written(&[Format::Stl]), texts(STL)].concat(),
        "ply" => [written(&[Format::Ply]), texts(PLY)].concat(),
        "off" => [written(&[Format::Off]), texts(OFF)].concat(),
        "msh" => [written(&[Format::Msh, Format::Msh22]), texts(MSH)].concat(),
        "vtk" => [written(&[Format::Vtk]), texts(VTK)].concat(),
        "vtu" => [written(&[Format::Vtu]), texts(VTU)].concat(),
        "vtp" => texts(VTP),
        "any" => ["obj", "stl", "ply", "off", "msh", "vtk", "vtu", "vtp"].into_iter().flat_map(seeds).collect(),
        "guides" => texts(GUIDES),
        "sizes" => [texts(SIZES), texts(PLY)].concat(),
        "edges" => texts(EDGES),
        "options" => options(),
        "config" => texts(CONFIG),
        "check" => meshes(),
        "pipeline" => surfaces(),
        _ => Vec::new(),
    }
}

/// A plate of two regions as each of the formats, with quads and with triangles alone.
fn written(formats: &[Format]) -> Vec<Vec<u8>> {
    let bytes = |format: &Format| {
        [plate(&["wing", "upper skin"]), plate(&[])].map(|mesh| {
            let mut bytes = Vec::new();
            let file = MeshFile::new(&mesh, &[]);
            write_mesh_to(&mut bytes, *format, &file).expect("a vector takes all");
            bytes
        })
    };
    formats.iter().flat_map(bytes).collect()
}

/// Two quads and two triangles; the last two faces are of the second region.
fn plate(names: &[&str]) -> Mesh {
    let points = (0..8).map(|v| [f64::from(v % 4), f64::from(v / 4), 0.25 * f64::from(v % 3)]).collect();
    let mut mesh = Mesh::new(points);
    for face in [&[0, 1, 5, 4][..], &[1, 2, 6, 5], &[2, 3, 7], &[2, 7, 6]] {
        mesh.push_face(face);
    }
    if !names.is_empty() {
        let names = names.iter().map(|&name| name.to_owned()).collect();
        mesh.regions = Regions { names, of_face: vec![0, 0, 1, 1] };
    }
    mesh
}

fn texts(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

/// Each option with some values, and the presets.
fn options() -> Vec<Vec<u8>> {
    let values = ["5", "0.5", "true", "all", "0.1%", "curvature:1", "y:0.5", "ridges:0.1", "0,0,0,1,1,1:0.1:1.2"];
    let lines = |value: &str| NAMES.map(|name| format!("{name}={value}\n")).concat();
    let presets = Preset::ALL.map(|preset| format!("preset={}\nlayout=quads\n", preset.name()));
    values.into_iter().map(lines).chain(presets).map(String::into_bytes).collect()
}

fn meshes() -> Vec<Vec<u8>> {
    let faces = |soup: &Soup| {
        let mut bytes = of_soup(soup);
        let faces = bytes.split_off(1 + 3 * soup.points.len());
        bytes.extend(faces.chunks(3).flat_map(|face| [&[3], face].concat()));
        bytes
    };
    small().iter().map(faces).collect()
}

fn surfaces() -> Vec<Vec<u8>> {
    let with = |options: &'static [u8]| move |soup: &Soup| [options, &of_soup(soup)].concat();
    let small = small();
    // The count less 4, the settings, and their values.
    let plain = small.iter().map(with(&[20, 0]));
    plain
        .chain(small.iter().map(with(&[40, 0b11, 2, 1])))
        .chain(small.iter().map(with(&[9, 0b10_1000, 2, 1])))
        .collect()
}

/// Surfaces of so few triangles that a mesh of them takes some milliseconds. Coordinates are sixteenths.
fn small() -> Vec<Soup> {
    let tetrahedron = Soup::new(
        vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]],
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    );
    // Three sheets meet on an edge.
    let fin = Soup::new(
        vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 2.0]],
        vec![[0, 1, 2], [0, 2, 3], [0, 2, 4]],
    );
    let plane = grid(4, 4, [false; 2], |u, v| [4.0 * u, 4.0 * v, 0.0]);
    let wavy = grid(5, 4, [false; 2], |u, v| [5.0 * u, 4.0 * v, (7.0 * u).sin()]);
    let tube = grid(6, 3, [true, false], |u, v| [2.0 * u.cos(), 2.0 * u.sin(), 4.0 * v]);
    let torus = grid(7, 5, [true; 2], |u, v| [(3.0 + v.cos()) * u.cos(), (3.0 + v.cos()) * u.sin(), v.sin()]);
    [tetrahedron, fin, cube(), plane, wavy, tube, torus].into()
}

fn cube() -> Soup {
    let points = (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2].map(|side| 3.0 * f64::from(side))).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Soup::new(points, sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// So many cells each way; what is closed runs from 0 to a full turn, else from 0 to 1.
fn grid(columns: u32, rows: u32, closed: [bool; 2], at: impl Fn(f64, f64) -> [f64; 3]) -> Soup {
    let [wide, high] = [(columns, closed[0]), (rows, closed[1])].map(|(n, closed)| if closed { n } else { n + 1 });
    let end = closed.map(|closed| if closed { TAU } else { 1.0 });
    let share = |i: u32, n: u32, end: f64| end * f64::from(i) / f64::from(n);
    let points = (0..high).flat_map(|j| (0..wide).map(move |i| (i, j)));
    let points = points.map(|(i, j)| at(share(i, columns, end[0]), share(j, rows, end[1]))).collect();
    let vertex = |i: u32, j: u32| j % high * wide + i % wide;
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let halves = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Soup::new(points, halves.collect())
}

const OBJ: &[&str] = &[
    "# c\nmtllib a.mtl\no one\ng wing tip\nusemtl red\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3//1\nf -4 -2 -1\n",
    "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 \\\n4 5\nl 1 2\ns off\n",
];
const STL: &[&str] = &[
    "solid wing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid wing\nsolid tip\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1e-3 0 1\nvertex 0 1 1\nendloop\nendfacet\nendsolid tip\n",
];
const PLY: &[&str] = &[
    "ply\nformat ascii 1.0\ncomment region 3 wing\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\nproperty float size\nelement face 2\nproperty list uchar int vertex_indices\nproperty int region\nend_header\n0 0 0 255 0.5\n1 0 0 0 1\n1 1 0 9 2\n0 1 0 7 3\n3 0 1 2 3\n3 0 2 3 3\n",
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n6 0 1 2 -1 1 3\n",
];
const OFF: &[&str] = &[
    "OFF\n# c\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3\n",
    "COFF 5 1 0\n0 0 0 1 1 1 1\n4 0 0 1 1 1 1\n4 4 0 1 0 0 1\n2 1 0 1 1 1 1\n0 4 0 1 1 1 1\n5 0 1 2 3 4\n",
];
const MSH: &[&str] = &[
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"wing\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n9 0 1 0\n$EndNodes\n$Elements\n3\n1 2 2 7 1 1 2 3\n2 2 2 7 1 1 3 9\n3 15 2 0 1 1\n$EndElements\n",
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"wing\"\n$EndPhysicalNames\n$Entities\n0 0 1 0\n1 0 0 0 1 1 0 1 7 0\n$EndEntities\n$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n$Elements\n1 1 1 1\n2 1 3 1\n1 1 2 3 4\n$EndElements\n",
];
const VTK: &[&str] = &[
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0\n1 1 0 0 1 0\nPOLYGONS 1 5\n4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\nCELL_DATA 2\nSCALARS region int 1\nLOOKUP_TABLE default\n1 2\nFIELD FieldData 1\nwing 1 1 int\n1\nPOINT_DATA 4\nVECTORS n float\n0 0 1 0 0 1 0 0 1 0 0 1\n",
    "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 1 1 0 0 1 0\nCELLS 3 6\nOFFSETS vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n0 1 2 0 2 3\nCELL_TYPES 2\n5 5\n",
];
const VTU: &[&str] = &[
    "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"2\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 2 3</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3 6</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 5</DataArray></Cells><CellData><DataArray type=\"Int32\" Name=\"region\" format=\"ascii\">1 2</DataArray></CellData></Piece></UnstructuredGrid></VTKFile>\n",
];
const VTP: &[&str] = &[
    "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"BigEndian\" header_type=\"UInt64\"><PolyData><FieldData><DataArray type=\"Int32\" Name=\"wing\" NumberOfTuples=\"1\" format=\"ascii\">1</DataArray></FieldData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"1\" NumberOfStrips=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray></Polys></Piece></PolyData></VTKFile>\n",
    "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"binary\">DAAAAAAAAAABAAAAAgAAAA==</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"binary\">BAAAAAMAAAA=</DataArray></Polys></Piece></PolyData><AppendedData encoding=\"base64\">_JAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAA==</AppendedData></VTKFile>\n",
];
const GUIDES: &[&str] = &[
    "x,y,z,dx,dy,dz,radius,weight\n0,0,0,1,0,0,0.1,2\n",
    "0 0 0 1 0 0\n1 0 0 0 1 0 0.5\n",
    "# c\nx;y;z;dx;dy;dz;w\n0;0;0;1;0;0;1\n",
    "{\"guides\": [{\"point\": [0, 0, 0], \"direction\": [1, 0, 0], \"radius\": 0.1, \"weight\": 2, \"name\": \"a\"}, {\"stroke\": [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}]}",
    "[{\"points\": [[0, 0, 0], [1, 0, 0]]}]",
];
const SIZES: &[&str] =
    &["x,y,z,size\n0,0,0,0.1\n1,0,0,2.5e-1\n", "0 0 0 1 # c\n\n1 0 0 2\n", "size;z;y;x;n\n1;0;0;0;5\n"];
const EDGES: &[&str] = &["1 2\n3 4 # c\n", "0,0,0,1,0,0\n", "0 0 0; 1 0 0\n", "\"0 0 0\",\"1 0 0\"\n"];
const CONFIG: &[&str] = &[
    "points = 6000\nquads = \"all\"\nstrict = true\nguide = [\"0,0,0,1,0,0\", \"1,0,0,0,1,0\"]\n",
    "preset = \"cfd\"\nfit = 0.5\nsize-at = [\"ridges:0.1\"]\nholes = 'leave'\n# c\ncrease = 30\n",
    "layout = \"quads\"\nrows = \"continuous\"\nmax-growth = 1.2\nno-cleanup = false\n[table]\na = { b = 1979-05-27 }\n",
];
