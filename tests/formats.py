"""Reads every format that `quadmosaic mesh` writes with programs that are not ours, and compares what they find.

The OBJ file, read by a few lines here, is the reference: points, faces and the region of each face."""

import collections
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

import gmsh
import meshio
import numpy as np
import pyvista
import trimesh

PROGRAM = sys.argv[1]
FORMATS = ["obj", "ply", "stl", "off", "vtk", "vtu", "msh", "msh22", "su2", "inp", "bdf", "glb"]
WITH_POLYGONS = ["obj", "ply", "stl", "off", "vtk", "vtu", "glb"]


def run(*arguments, **options):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, **options)


class Reference:
    """The mesh, as the OBJ file has it."""

    def __init__(self, path):
        self.points, self.faces, self.regions, region = [], [], [], ""
        for words in map(str.split, path.read_text().splitlines()):
            if words[0] == "v":
                self.points.append([float(word) for word in words[1:]])
            elif words[0] == "g":
                region = " ".join(words[1:])
            elif words[0] == "f":
                self.faces.append([int(word) - 1 for word in words[1:]])
                self.regions.append(region)
        self.points = np.array(self.points)
        self.names = list(dict.fromkeys(self.regions))

    def of(self, corners, region=None):
        """The faces of so many corners, of a region."""
        pairs = zip(self.faces, self.regions)
        return [face for face, name in pairs if len(face) == corners and region in (None, name)]


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def same_faces(found, expected, what):
    expect([list(map(int, face)) for face in found] == expected, f"{what}: {len(found)} faces, {len(expected)} expected")


def same_points(found, mesh, what, tolerance=0.0):
    found = np.asarray(found)
    expect(found.shape == mesh.points.shape, f"{what}: {found.shape} points")
    error = np.abs(found - mesh.points).max()
    expect(error <= tolerance, f"{what}: points differ by {error}")


def has_points(found, mesh, what):
    """Whether each point of the mesh is among those found, which are f32."""
    distances = np.linalg.norm(mesh.points[:, None] - np.asarray(found), axis=2).min(axis=1)
    expect(distances.max() <= 1e-6, f"{what}: points differ by {distances.max()}")


def cells(read, corners):
    """The cells of meshio's mesh of so many corners, in their order."""
    kind = {3: "triangle", 4: "quad", 5: "polygon"}[corners]
    blocks = [block.data for block in read.cells if block.type == kind]
    return np.concatenate(blocks) if blocks else []


def check_meshio(path, mesh, tolerance=0.0, form=None):
    read = meshio.read(path, file_format=form)
    same_points(read.points, mesh, path.name, tolerance)
    for corners in (3, 4):
        same_faces(cells(read, corners), mesh.of(corners), f"{path.name}, {corners} corners")
    return read


def identifier(name):
    return name.replace(" ", "_") or "surface"


def check_obj(path, mesh):
    check_meshio(path, mesh)


def check_ply(path, mesh):
    """VTK reads points as f32; meshio does not read properties behind a list, so no regions."""
    if mesh.names == [""]:
        check_meshio(path, mesh)
    surface = pyvista.read(path)
    same_points(surface.points, mesh, path.name, 1e-6)
    same_faces(list(surface.irregular_faces), mesh.faces, "ply by VTK")
    text = path.read_bytes().split(b"end_header\n")[0].decode()
    for number, name in enumerate(mesh.names if mesh.names != [""] else []):
        expect(f"comment region {number} {name}\n" in text, f"ply: the name {name}")


def check_stl(path, mesh):
    count = sum(len(face) - 2 for face in mesh.faces)
    read = meshio.read(path)
    expect(len(cells(read, 3)) == count, f"stl: {len(cells(read, 3))} triangles")
    surface = pyvista.read(path)
    expect(surface.n_cells == count, "stl by VTK: the number of triangles")
    has_points(surface.points, mesh, "stl by VTK")
    if mesh.names != [""]:
        solids = [line[6:] for line in path.read_text().splitlines() if line.startswith("solid ")]
        expect(solids == mesh.names, f"stl: the solids {solids}")


def check_off(path, mesh):
    """trimesh splits quads, and does not read larger faces."""
    if max(map(len, mesh.faces)) <= 4:
        read = trimesh.load(path, process=False, force="mesh")
        same_points(read.vertices, mesh, path.name)
        expect(len(read.faces) == sum(len(face) - 2 for face in mesh.faces), "off: the number of triangles")
    lines = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    expect(lines[1] == [str(len(mesh.points)), str(len(mesh.faces)), "0"], "off: the counts")
    count = len(mesh.points)
    same_points([[float(x) for x in line] for line in lines[2 : 2 + count]], mesh, path.name)
    same_faces([line[1:] for line in lines[2 + count :]], mesh.faces, "off")


def check_vtk(path, mesh):
    read = check_meshio(path, mesh)
    grid = pyvista.read(path)
    same_points(grid.points, mesh, path.name)
    kinds = [{3: 5, 4: 9}.get(len(face), 7) for face in mesh.faces]
    expect(list(grid.celltypes) == kinds, f"{path.name}: the types of cells")
    offsets = grid.cell_offsets
    same_faces([grid.cell_connectivity[a:b] for a, b in zip(offsets, offsets[1:])], mesh.faces, f"{path.name} by VTK")
    if mesh.names != [""]:
        names = {int(np.ravel(value)[0]): name for name, value in grid.field_data.items()}
        expect([names[number] for number in grid.cell_data["region"]] == mesh.regions, f"{path.name}: regions {names}")
        expect(len(read.field_data) == len(mesh.names) or path.suffix == ".vtk", f"{path.name}: {read.field_data}")
    for corners, shape, jacobian in zip(map(len, mesh.faces), grid.cell_data["shape"], grid.cell_data["scaled_jacobian"]):
        expect(corners > 4 or 0.1 < shape <= 1 + 1e-12, f"{path.name}: a shape of {shape}")
        expect((corners != 4) == np.isnan(jacobian), f"{path.name}: a Jacobian of {jacobian}")
    expect(abs(np.linalg.norm(grid.point_data["field"], axis=1) - 1).max() < 1e-6, "unit vectors of the field")
    expect(set(grid.point_data["kind"]) <= {0, 1, 2, 3}, "kinds of vertices")
    expect("source_triangle" not in grid.point_data, "sources that were not asked for")
    # Of a legacy file with larger faces, meshio reads no arrays of cells.
    arrays = {"region", "shape", "scaled_jacobian"} if path.suffix == ".vtu" or 7 not in kinds else set()
    expect(set(read.cell_data) == arrays, f"{path.name}: arrays of cells {set(read.cell_data)}")


def check_vtu(path, mesh):
    check_vtk(path, mesh)


def check_msh(path, mesh):
    read = check_meshio(path, mesh)
    names = [name or "surface" for name in mesh.names]
    expect(list(read.field_data) == names, f"{path.name}: physical groups {list(read.field_data)}")
    gmsh.open(str(path))
    tags, points, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    same_points(points.reshape(-1, 3)[order], mesh, f"{path.name} by Gmsh")
    found = {gmsh.model.getPhysicalName(dim, tag): (dim, tag) for dim, tag in gmsh.model.getPhysicalGroups()}
    expect(sorted(found) == sorted(names), f"{path.name}: {found}")
    for region, name in zip(mesh.names, names):
        for kind, corners in ((2, 3), (3, 4)):
            nodes = []
            for entity in gmsh.model.getEntitiesForPhysicalGroup(*found[name]):
                nodes.extend(gmsh.model.mesh.getElementsByType(kind, entity)[1])
            same_faces(np.array(nodes).reshape(-1, corners) - 1, mesh.of(corners, region), f"{path.name}: {name}")


def check_msh22(path, mesh):
    check_msh(path, mesh)


def check_su2(path, mesh):
    check_meshio(path, mesh)
    tags = [line.split("=")[1].strip() for line in path.read_text().splitlines() if line.startswith("MARKER_TAG")]
    expect(tags == list(map(identifier, mesh.names)), f"su2: markers {tags}")


def check_inp(path, mesh):
    read = check_meshio(path, mesh, tolerance=1e-15)
    expect(list(read.cell_sets) == list(map(identifier, mesh.names)), f"inp: sets {list(read.cell_sets)}")
    for region, sets in zip(mesh.names, read.cell_sets.values()):
        count = sum(len(some) for some in sets)
        expect(count == mesh.regions.count(region), f"inp: {count} elements of {region}")
    expect("FEATURE" in read.point_sets, f"inp: node sets {list(read.point_sets)}")


def check_bdf(path, mesh):
    read = check_meshio(path, mesh, tolerance=1e-13)
    properties = np.concatenate(read.cell_data["nastran:ref"])
    expect(list(properties) == [1 + mesh.names.index(region) for region in mesh.regions], "bdf: properties")
    gmsh.open(str(path))
    found = [len(gmsh.model.mesh.getElementsByType(kind)[0]) for kind in (2, 3)]
    expect(found == [len(mesh.of(3)), len(mesh.of(4))], f"bdf by Gmsh: {found}")


def check_glb(path, mesh):
    scene = trimesh.load(path, process=False, force="scene")
    solids = [part for part in scene.geometry.values() if isinstance(part, trimesh.Trimesh)]
    count = sum(len(face) - 2 for face in mesh.faces)
    expect(sum(len(solid.faces) for solid in solids) == count, "glb: the number of triangles")
    has_points(scene.to_geometry().vertices, mesh, "glb")
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    content = json.loads(data[20 : 20 + length])
    expect([node.get("name", "") for node in content["nodes"]] == mesh.names, "glb: the nodes")
    lines = sum(content["accessors"][part["primitives"][1]["indices"]]["count"] for part in content["meshes"])
    edges = set()
    for face, region in zip(mesh.faces, mesh.regions):
        edges |= {(region, *sorted(side)) for side in zip(face, face[1:] + face[:1])}
    expect(lines == 2 * len(edges), f"glb: {lines} ends of lines, {len(edges)} edges")


def expect_refusal(check, path, mesh):
    """The check fails where a point is elsewhere."""
    points = mesh.points.copy()
    mesh.points[7] += 1e-3
    try:
        check(path, mesh)
    except AssertionError:
        return
    finally:
        mesh.points = points
    raise AssertionError(f"{path.name}: a moved point is not seen")


def box(path):
    """A box of three named regions, tilted, off the origin."""
    points = [[x, y, z] for x in (0.1, 1.3) for y in (0.0, 0.7) for z in (0.3, 1.0 / 3 + 1)]
    sides = {
        "bottom": [[0, 4, 6, 2]],
        "top side": [[1, 3, 7, 5]],
        "walls": [[0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]],
    }
    lines = ["v {!r} {!r} {!r}".format(*point) for point in points]
    for name, quads in sides.items():
        lines.append(f"g {name}")
        for a, b, c, d in quads:
            lines += [f"f {a + 1} {b + 1} {c + 1}", f"f {a + 1} {c + 1} {d + 1}"]
    path.write_text("\n".join(lines) + "\n")


def check_exactness(folder, mesh):
    """Corners keep their bits; vertices on planes lie on them."""
    given = {tuple(point) for point in mesh.source.points}
    expect(given <= {tuple(point) for point in mesh.points}, "the corners of the box are vertices, bit for bit")
    for axis, values in enumerate(zip(*given)):
        for value in set(values):
            near = np.abs(mesh.points[:, axis] - value) < 1e-6
            expect(near.sum() > 20 and (mesh.points[near, axis] == value).all(), f"the plane {axis} = {value}")
    run("mesh", "example:m6", "--points", "2000", "-o", folder / "wing.obj")
    wing = Reference(folder / "wing.obj")
    root = np.abs(wing.points[:, 1]) < 1e-6
    expect(root.sum() > 20 and (wing.points[root, 1] == 0.0).all(), "the root of the wing has y = 0")


def solved(folder, name, model):
    """The displacements that CalculiX finds."""
    (folder / f"{name}.inp").write_text(model)
    solver = subprocess.run(["ccx", name], cwd=folder, capture_output=True, text=True)
    expect(solver.returncode == 0 and "*ERROR" not in solver.stdout, f"CalculiX: {solver.stdout[-2000:]}")
    lines = (folder / f"{name}.frd").read_text().split("-4  DISP")[1].splitlines()
    lines = lines[: [line.strip() for line in lines].index("-3")]
    return np.array([[float(line[13 + 12 * k : 25 + 12 * k]) for k in range(3)] for line in lines if line[:3] == " -1"])


def check_calculix(folder):
    """A clamped plate under pressure, of the elements of an INP file."""
    run("mesh", "example:plate", "--points", "300", "--quads", "paper", "-o", folder / "plate.inp")
    model = """*INCLUDE, INPUT=plate.inp
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SHELL SECTION, ELSET=surface, MATERIAL=STEEL
0.01
*BOUNDARY
BOUNDARY, 1, 6
*STEP
*STATIC
*DLOAD
surface, P, 0.01
*NODE FILE
U
*END STEP
"""
    values = solved(folder, "model", model)
    deflection = np.abs(values[:, 2]).max()
    expect(np.isfinite(values).all() and 1e-6 < deflection < 1e-1, f"CalculiX: a deflection of {deflection}")
    print(f"CalculiX: {len(values)} nodes of the expanded shell, largest deflection {deflection:.3e}")


def check_sources(folder):
    """The points of the input that the sources name are the vertices."""
    source = Reference(folder / "box.obj")
    for form in ("ply", "vtk", "vtu"):
        path = folder / f"sources.{form}"
        run("mesh", folder / "box.obj", "--points", "600", "--with-source", "-o", path)
        data = pyvista.read(path)
        if form == "ply":
            rows = ply_vertices(path)
            columns = lambda *names: np.stack([rows[name] for name in names], 1)
            points, triangles = columns("x", "y", "z"), rows["source_triangle"]
            weights = columns(*(f"source_barycentric_{k}" for k in range(3)))
        else:
            points, arrays = data.points, data.point_data
            triangles, weights = arrays["source_triangle"], arrays["source_barycentric"]
        places = np.einsum("ij,ijk->ik", weights, source.points[np.array(source.faces)[triangles]])
        off = np.linalg.norm(places - points, axis=1).max()
        expect(len(points) > 500 and off < 1e-9, f"{path.name}: vertices are {off} off their sources")
        triangles = np.roll(triangles, 1)
        places = np.einsum("ij,ijk->ik", weights, source.points[np.array(source.faces)[triangles]])
        expect(np.linalg.norm(places - points, axis=1).max() > 0.1, f"{path.name}: any source fits")


def ply_vertices(path):
    """The properties of a PLY file's vertices, by name; VTK and trimesh drop those that they do not know."""
    head, body = path.read_bytes().split(b"end_header\n", 1)
    kinds = {"double": "<f8", "int": "<i4", "uchar": "u1"}
    words = [line.split() for line in head.decode().split("element face")[0].splitlines()]
    count = next(int(line[2]) for line in words if line[:2] == ["element", "vertex"])
    record = np.dtype([(line[2], kinds[line[1]]) for line in words if line[0] == "property"])
    return np.frombuffer(body, record, count)


def painted(folder):
    """A tilted square of 12 by 12 quads as PLY: red is x, blue is y; texture coordinates are x and y / 2, and heat is x - y."""
    side = 12
    head = ["ply", "format ascii 1.0", f"element vertex {(side + 1) ** 2}"]
    head += [f"property float {name}" for name in ("x", "y", "z")]
    head += [f"property uchar {name}" for name in ("red", "green", "blue")]
    head += [f"property double {name}" for name in ("s", "t", "heat")]
    head += [f"element face {side**2}", "property list uchar int vertex_indices", "end_header"]
    rows = []
    for i in range(side + 1):
        for j in range(side + 1):
            x, y = i / side, j / side
            rows.append(f"{x} {y} {x + y} {round(255 * x)} 0 {round(255 * y)} {x} {y / 2} {x - y}")
    for i in range(side):
        for j in range(side):
            corner = i * (side + 1) + j
            rows.append(f"4 {corner} {corner + side + 1} {corner + side + 2} {corner + 1}")
    (folder / "painted.ply").write_text("\n".join(head + rows) + "\n")


def check_attributes(folder):
    """Colours, texture coordinates and numbers, as other programs find them at the vertices."""
    painted(folder)

    def expect_values(points, form, colours=None, textures=None, heat=None):
        x, y = np.asarray(points).T[:2]
        for name, found, wanted, most in (
            ("colours", colours, np.stack([x, 0 * x, y], 1), 0.02),
            ("texture coordinates", textures, np.stack([x, y / 2], 1), 1e-6),
            ("heat", heat, x - y, 1e-6),
        ):
            off = 0 if found is None else np.abs(np.asarray(found) - wanted).max()
            expect(off <= most, f"{form}: {name} are {off} off")
            expect(found is None or np.ptp(wanted) > 10 * most, f"{form}: {name} are all the same")

    for form in ("obj", "ply", "vtk", "vtu", "glb"):
        path = folder / f"painted.out.{form}"
        done = run("mesh", folder / "painted.ply", "--points", "200", "-o", path)
        told = "not carried" in done.stderr.decode()
        expect(told == (form in ("obj", "glb")), f"{form}: {done.stderr.decode()}")
        if form in ("vtk", "vtu"):
            grid = pyvista.read(path)
            arrays = grid.point_data
            expect_values(grid.points, form, arrays["RGB"] / 255, arrays["TCoords"], arrays["heat"])
        elif form == "ply":
            rows = ply_vertices(path)
            columns = lambda *names: np.stack([rows[name] for name in names], 1)
            expect_values(columns("x", "y", "z"), form, columns("red", "green", "blue") / 255, columns("s", "t"), rows["heat"])
            read = pyvista.read(path).point_data
            expect(np.array_equal(read["RGB"], columns("red", "green", "blue")), f"ply by VTK: {list(read)}")
        elif form == "obj":
            lines = [line.split() for line in path.read_text().splitlines()]
            rows = np.array([[float(word) for word in line[1:]] for line in lines if line[0] == "v"])
            expect_values(rows[:, :3], form, rows[:, 3:])
            read = pyvista.read(path)
            expect_values(read.points, "obj by VTK", textures=read.point_data.active_texture_coordinates)
        else:
            meshes = trimesh.load(path, process=False, force="scene").geometry.values()
            for mesh in (mesh for mesh in meshes if isinstance(mesh, trimesh.Trimesh)):
                visual, (content, positions) = mesh.visual, glb(path)
                middle = content["nodes"][0]["translation"]
                expect_values(positions["POSITION"] + middle, form, positions["COLOR_0"])
                # glTF counts from the top; trimesh turns it back.
                flipped = positions["TEXCOORD_0"] * [1, -1] + [0, 1]
                expect_values(positions["POSITION"] + middle, form, textures=flipped)
                expect(len(mesh.vertices) == len(flipped), f"glb by trimesh: {visual}")


def glb(path):
    """The content of a GLB file, and the attributes of its first primitive."""
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    content = json.loads(data[20 : 20 + length])
    attributes = {}
    for name, number in content["meshes"][0]["primitives"][0]["attributes"].items():
        accessor = content["accessors"][number]
        width = int(accessor["type"][-1])
        at = 28 + length + accessor.get("byteOffset", 0)
        attributes[name] = np.frombuffer(data, "<f4", width * accessor["count"], at).reshape(-1, width).astype(float)
    return content, attributes


def check_named_wing(folder):
    """The README's wing: named solids of an STL file in millimetres go to SU2 and MSH with their names."""
    run("example", "m6", "--triangles", "4000", "-o", folder / "m6.obj")
    wing = Reference(folder / "m6.obj")
    points = 1000 * wing.points
    parts = {"upper": [], "lower": [], "tip": []}
    tip = points[:, 1].max() - 20
    for face in wing.faces:
        middle = points[face].mean(axis=0)
        parts["tip" if middle[1] > tip else "upper" if middle[2] > 0 else "lower"].append(face)
    with open(folder / "wing.stl", "w") as file:
        for name, faces in parts.items():
            file.write(f"solid {name}\n")
            for face in faces:
                file.write("facet normal 0 0 0\nouter loop\n")
                file.writelines("vertex {!r} {!r} {!r}\n".format(*map(float, points[v])) for v in face)
                file.write("endloop\nendfacet\n")
            file.write(f"endsolid {name}\n")
    for form in ("su2", "msh", "obj"):
        done = run("mesh", folder / "wing.stl", "--size", "25", "-o", folder / f"wing.{form}")
        expect(b"warning" not in done.stderr, f"the named wing: {done.stderr.decode()}")
    mesh = Reference(folder / "wing.obj")
    expect(sorted(mesh.names) == sorted(parts), f"the named wing: {mesh.names}")
    check_su2(folder / "wing.su2", mesh)
    check_msh(folder / "wing.msh", mesh)
    print(f"the wing in millimetres: {len(mesh.faces)} faces of {', '.join(mesh.names)} in SU2 and MSH")


def check_bracket(folder):
    """A bracket of three plates that meet in T-joints, all quads, clamped at its foot and pressed at its wall."""
    corners = {
        "foot": [(0, 0, 0), (80, 0, 0), (80, 60, 0), (0, 60, 0)],
        "wall": [(40, 0, 0), (40, 60, 0), (40, 60, 50), (40, 0, 50)],
        "rib": [(40, 30, 0), (80, 30, 0), (40, 30, 50)],
    }
    # Plates are cut where others stand on them.
    x, y, z = [0, 40, 80], [0, 30, 60], [0, 50]
    quads = [("foot", [(x[i], y[j], 0), (x[i + 1], y[j], 0), (x[i + 1], y[j + 1], 0), (x[i], y[j + 1], 0)]) for i in (0, 1) for j in (0, 1)]
    quads += [("wall", [(40, y[j], 0), (40, y[j + 1], 0), (40, y[j + 1], 50), (40, y[j], 50)]) for j in (0, 1)]
    quads += [("rib", corners["rib"])]
    lines = []
    count = 0
    for name, places in quads:
        lines.append(f"g {name}")
        lines += ["v {} {} {}".format(*place) for place in places]
        lines.append("f " + " ".join(str(count + k + 1) for k in range(len(places))))
        count += len(places)
    (folder / "bracket.obj").write_text("\n".join(lines) + "\n")
    run("mesh", folder / "bracket.obj", "--size", "6", "--quads", "all", "-o", folder / "bracket.inp")
    read = meshio.read(folder / "bracket.inp")
    expect([block.type for block in read.cells] == ["quad"] * 3, f"the bracket: {read.cells}")
    expect(set(read.cell_sets) == set(corners), f"the bracket: sets {list(read.cell_sets)}")
    sides = [tuple(sorted(side)) for block in read.cells for face in block.data for side in zip(face, np.roll(face, 1))]
    joints = sum(count > 2 for count in collections.Counter(sides).values())
    expect(joints > 15, f"the bracket: {joints} edges of more than two faces")
    clamped = [number + 1 for number, point in enumerate(read.points) if point[2] == 0]
    model = "*INCLUDE, INPUT=bracket.inp\n*NSET, NSET=CLAMPED\n" + "\n".join(f"{number}," for number in clamped)
    model += "\n*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n"
    model += "".join(f"*SHELL SECTION, ELSET={name}, MATERIAL=STEEL\n3.\n" for name in corners)
    model += "*BOUNDARY\nCLAMPED, 1, 6\n*STEP\n*STATIC\n*DLOAD\nwall, P, 0.1\n*NODE FILE\nU\n*END STEP\n"
    values = solved(folder, "bracket_model", model)
    deflection = np.linalg.norm(values, axis=1).max()
    expect(np.isfinite(values).all() and 1e-4 < deflection < 10, f"CalculiX: a deflection of {deflection}")
    print(f"CalculiX: a bracket of {len(sides) // 4} quads, largest deflection {deflection:.3e}")


def check_streams(folder):
    arguments = ["mesh", folder / "box.obj", "--points", "600", "--quads", "paper"]
    for form in FORMATS:
        whole = (folder / f"mesh.{form}").read_bytes()
        expect(run(*arguments, "-o", "-", "--to", form).stdout == whole, f"{form}: standard output has the file's bytes")
    done = run(*arguments, "-o", folder / "again.obj", "--report", "-")
    expect(json.loads(done.stdout)["mesh"]["vertices"] > 0, "the report on standard output")


def main():
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        box(folder / "box.obj")
        run("example", "plate", "--triangles", "500", "-o", folder / "plate.obj")
        for source, options, formats in (
            ("plate", ["--holes", "leave", "--no-cleanup"], WITH_POLYGONS),
            ("plate", [], FORMATS),
            ("box", ["--quads", "paper"], FORMATS),
        ):
            arguments = ["mesh", folder / f"{source}.obj", "--points", "600", *options]
            run(*arguments, "-o", folder / "mesh.obj")
            mesh = Reference(folder / "mesh.obj")
            counts = [len(mesh.of(4)), len(mesh.of(3)), sum(len(face) > 4 for face in mesh.faces)]
            some_larger = formats != FORMATS
            expect(counts[0] > 100 and (counts[1] > 0 or some_larger) and (counts[2] > 0) == some_larger, f"faces: {counts}")
            for form in formats:
                path = folder / f"mesh.{form}"
                run(*arguments, "--to", form, "-o", path)
                # Gmsh knows formats by extensions.
                if form == "msh22":
                    path = path.rename(folder / "mesh22.msh")
                check = globals()[f"check_{form}"]
                check(path, mesh)
                expect_refusal(check, path, mesh)
                if form == "msh22":
                    path.rename(folder / "mesh.msh22")
            print("{}: {} quads, {} triangles, {} larger faces read back in {} formats".format(source, *counts, len(formats)))
        mesh.source = Reference(folder / "box.obj")
        check_exactness(folder, mesh)
        check_sources(folder)
        check_attributes(folder)
        check_named_wing(folder)
        check_bracket(folder)
        check_streams(folder)
        check_calculix(folder)
    gmsh.finalize()


main()
