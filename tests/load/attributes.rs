//! Colours, texture coordinates and other numbers of vertices and corners.

use super::SQUARE;
use quadmosaic::surface::load::read_stream;
use quadmosaic::surface::{Attribute, AttributeKind, Attributes};

fn read(text: &str) -> Attributes {
    read_stream(text.as_bytes(), "attributes", None).unwrap_or_else(|error| panic!("{text}: {error}")).attributes
}

/// The name, kind and values of each attribute.
fn told(attributes: &Attributes) -> Vec<(&str, AttributeKind, &[f64])> {
    attributes.list.iter().map(|Attribute { name, kind, values, .. }| (&**name, *kind, &values[..])).collect()
}

const COLOURS: [f64; 12] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
const HEAT: [f64; 4] = [0.5, -1.0, 2.0, 8.0];
const TEXTURE: [f64; 8] = [0.0, 0.0, 0.5, 0.0, 0.5, 1.0, 0.0, 1.0];

#[test]
fn corners_of_obj_keep_their_texture_coordinates_when_polygons_are_split() {
    let textures = "vt 0 0\nvt 2 0\nvt 2 2\nvt 0 2\nvt 9 9\n";
    let read = read_stream(format!("{SQUARE}{textures}f 1/1 2/2 3/3 4/4\nf 3/5 2/2 1/1\n").as_bytes(), "a", None);
    let soup = read.expect("it is a surface");
    let [texture] = &soup.attributes.list[..] else { panic!("one attribute") };
    for (triangle, corners) in soup.triangles.iter().enumerate() {
        for (k, &v) in corners.iter().enumerate() {
            let [x, y, _] = soup.points[v as usize];
            let wanted = if triangle == 2 && v == 2 { [9.0, 9.0] } else { [2.0 * x, 2.0 * y] };
            assert_eq!(texture.at_corner(3 * triangle + k, v), wanted, "corner {k} of {triangle}");
        }
    }
    let plain = read_stream(format!("{SQUARE}f 1 2 3 4\n").as_bytes(), "a", None).expect("it is a surface");
    assert_eq!(plain.attributes, Attributes::default());
}

#[test]
fn properties_of_ply_are_known_by_their_names() {
    let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                property float nx\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
                property float s\nproperty float t\nproperty double heat\nproperty int flag\n";
    let faces = "element face 1\nproperty list uchar int vertex_indices\nproperty uchar shade\nend_header\n";
    let rows = "0 0 0 1 255 0 0 9 0 0 0.5 7\n1 0 0 1 0 255 0 9 0.5 0 -1 7\n\
                1 1 0 1 0 0 255 9 0.5 1 2 7\n0 1 0 1 255 255 255 9 0 1 8 7\n4 0 1 2 3 1\n";
    let read = self::read(&format!("{head}{faces}{rows}"));
    let wanted = [
        ("RGB", AttributeKind::Colour, &COLOURS[..]),
        ("TCoords", AttributeKind::Texture, &TEXTURE),
        ("heat", AttributeKind::Numbers, &HEAT),
    ];
    assert_eq!(told(&read), wanted);
    assert_eq!(read.left_out, ["alpha", "flag", "shade of faces"]);

    let corners = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
                   0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 8 0 0 0.5 0 0.5 1 0 1\n";
    let read = self::read(corners);
    assert_eq!(told(&read), [("TCoords", AttributeKind::Texture, &TEXTURE[..])]);
    assert_eq!(read.list[0].of_corners.len(), 6);
    let some = self::read(&corners.replace("8 0 0 0.5 0 0.5 1 0 1", "2 0 0"));
    assert!(some.list.is_empty() && some.left_out.len() == 1);
}

#[test]
fn arrays_of_points_of_vtk_are_read() {
    let head = "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\n\
                POLYGONS 1 5\n4 0 1 2 3\n";
    let data = "POINT_DATA 4\nSCALARS heat double 1\nLOOKUP_TABLE default\n0.5 -1 2 8\n\
                COLOR_SCALARS shade 3\n1 0 0 0 1 0 0 0 1 1 1 1\nTEXTURE_COORDINATES uv 2 float\n0 0 .5 0 .5 1 0 1\n\
                NORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\nSCALARS flag int\nLOOKUP_TABLE default\n1 2 3 4\n\
                CELL_DATA 1\nSCALARS stress float\nLOOKUP_TABLE default\n3\n";
    let read = self::read(&format!("{head}{data}"));
    let wanted = vec![
        ("heat", AttributeKind::Numbers, &HEAT[..]),
        ("RGB", AttributeKind::Colour, &COLOURS),
        ("TCoords", AttributeKind::Texture, &TEXTURE),
    ];
    assert_eq!(told(&read), wanted);
    assert_eq!(read.left_out, ["flag", "stress of cells"]);

    let array = |name: &str, kind: &str, components: usize, numbers: &str| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{numbers}</DataArray>"
        )
    };
    let vtu = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points>{}</Points>\
         <Cells>{}{}{}</Cells><PointData>{}{}{}{}</PointData><CellData>{}{}</CellData></Piece></UnstructuredGrid></VTKFile>",
        array("p", "Float32", 3, "0 0 0 1 0 0 1 1 0 0 1 0"),
        array("connectivity", "Int32", 1, "0 1 2 3"),
        array("offsets", "Int32", 1, "4"),
        array("types", "UInt8", 1, "9"),
        array("heat", "Float64", 1, "0.5 -1 2 8"),
        array("shade", "UInt8", 3, "255 0 0 0 255 0 0 0 255 255 255 255"),
        array("Texture Coordinates", "Float32", 2, "0 0 .5 0 .5 1 0 1"),
        array("flag", "Int32", 1, "1 2 3 4"),
        array("region", "Int32", 1, "3"),
        array("stress", "Float32", 1, "3"),
    );
    let read = self::read(&vtu);
    assert_eq!(told(&read), wanted);
    assert_eq!(read.left_out, ["flag", "stress of cells"]);
}
