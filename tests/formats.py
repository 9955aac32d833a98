"""Reads every format that `quadmosaic mesh` writes with programs that are not ours, and compares what they find.

The OBJ file, read by a few lines here, is the reference: points, faces and the region of each face."""

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
    # The point of the input that the source names is the vertex.
    source = mesh.source
    corners = source.points[np.array(source.faces)[grid.point_data["source_triangle"]]]
    places = np.einsum("ij,ijk->ik", grid.point_data["source_barycentric"], corners)
    same_points(places, mesh, f"{path.name}: sources", 1e-9)
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
    (folder / "model.inp").write_text(model)
    solver = subprocess.run(["ccx", "model"], cwd=folder, capture_output=True, text=True)
    expect(solver.returncode == 0 and "*ERROR" not in solver.stdout, f"CalculiX: {solver.stdout[-2000:]}")
    lines = (folder / "model.frd").read_text().split("-4  DISP")[1].splitlines()
    lines = lines[: [line.strip() for line in lines].index("-3")]
    values = np.array([[float(line[13 + 12 * k : 25 + 12 * k]) for k in range(3)] for line in lines if line[:3] == " -1"])
    deflection = np.abs(values[:, 2]).max()
    expect(np.isfinite(values).all() and 1e-6 < deflection < 1e-1, f"CalculiX: a deflection of {deflection}")
    print(f"CalculiX: {len(values)} nodes of the expanded shell, largest deflection {deflection:.3e}")


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
            mesh.source = Reference(folder / f"{source}.obj")
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
        check_exactness(folder, mesh)
        check_streams(folder)
        check_calculix(folder)
    gmsh.finalize()


main()
