"""The Python package: arrays, files, options, errors, progress, threads, the command line."""

from __future__ import annotations

import inspect
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
import pytest

import quadmosaic
from quadmosaic import _native

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
CUBE = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)


def torus(rings: int, sides: int) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    u, v = np.meshgrid(np.arange(rings) * 2 * np.pi / rings, np.arange(sides) * 2 * np.pi / sides, indexing="ij")
    radius = 1 + 0.4 * np.cos(v)
    vertices = np.stack([radius * np.cos(u), radius * np.sin(u), 0.4 * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(rings), np.arange(sides), indexing="ij")
    a, b = i * sides + j, (i + 1) % rings * sides + j
    c, d = (i + 1) % rings * sides + (j + 1) % sides, i * sides + (j + 1) % sides
    return vertices, np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])


def mesh(vertices: Any, triangles: Any, points: Optional[int] = 400, **options: Any) -> quadmosaic.Result:
    return quadmosaic.mesh(vertices, triangles, points, backend="cpu", **options)


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "quadmosaic", *arguments], capture_output=True, text=True, timeout=100)


def volume(result: quadmosaic.Result) -> float:
    faces = np.concatenate([result.quads[:, [0, 1, 2]], result.quads[:, [0, 2, 3]], result.triangles])
    a, b, c = (result.vertices[faces[:, k]] for k in range(3))
    return float((np.cross(a, b) * c).sum() / 6)


def test_arrays_become_a_closed_mesh_on_the_surface() -> None:
    result = mesh(CORNERS, CUBE)
    assert result.vertices.dtype == np.float64 and result.quads.dtype == np.int64
    assert result.vertices.shape[1:] == (3,) and result.quads.shape[1:] == (4,) and result.triangles.shape[1:] == (3,)
    assert abs(len(result.vertices) - 400) < 20 and len(result.quads) > 20 * len(result.triangles)
    assert volume(result) == pytest.approx(1.0, abs=1e-12)
    # Each vertex lies in the plane of its triangle, and corners of the cube are vertices.
    a, b, c = (CORNERS[CUBE[result.source, k]] for k in range(3))
    off = ((result.vertices - a) * np.cross(b - a, c - a)).sum(axis=1)
    assert np.abs(off).max() < 1e-12
    assert sorted(map(tuple, result.vertices[result.kind == 3])) == sorted(map(tuple, CORNERS))
    assert result.report["mesh"]["vertices"] == len(result.vertices) and result.report["faults"]["list"] == []


def test_the_same_arrays_of_other_types_give_the_same_mesh() -> None:
    first = mesh(CORNERS, CUBE)
    for vertices, triangles in [
        (CORNERS.astype(np.float32), CUBE.astype(np.uint8)),
        (CORNERS.tolist(), CUBE.tolist()),
        (np.asfortranarray(CORNERS), np.repeat(CUBE, 2, axis=0)[::2]),
    ]:
        other = mesh(vertices, triangles)
        assert np.array_equal(first.vertices, other.vertices) and np.array_equal(first.quads, other.quads)
    assert len(mesh(CORNERS, CUBE, points=800).vertices) > 1.5 * len(first.vertices)


def test_regions_keep_their_faces() -> None:
    result = mesh(CORNERS, CUBE, regions=np.arange(12) // 2 % 2, region_names=["odd", "even"])
    assert result.region_names == ["odd", "even"] and len(result.regions) == len(result.quads) + len(result.triangles)
    region = np.arange(12) // 2 % 2
    middle = result.vertices[result.quads].mean(axis=1)
    on_x0 = middle[:, 0] == 0
    assert on_x0.any() and (result.regions[: len(middle)][on_x0] == region[0]).all()
    with pytest.raises(ValueError, match="there are 3 regions for 12 faces"):
        mesh(CORNERS, CUBE, regions=[0, 1, 0])


SEAM = 5 / 16


def seamed() -> quadmosaic.Surface:
    """The unit square with a temperature, colours, and texture coordinates that jump at x = 5 / 16."""
    x, y = (axis.ravel() / 16 for axis in np.meshgrid(np.arange(17), np.arange(17), indexing="ij"))
    vertices = np.stack([x, y, 0 * x], axis=1)
    a = (17 * np.arange(16)[:, np.newaxis] + np.arange(16)).ravel()
    triangles = np.concatenate([np.stack([a, a + 17, a + 18], axis=1), np.stack([a, a + 18, a + 1], axis=1)])
    corners = vertices[triangles]
    right = corners[:, :, 0].mean(axis=1) > SEAM
    texture = corners[:, :, :2] + 3.0 * right[:, np.newaxis, np.newaxis]
    attributes = {"heat": x + 2 * y, "RGB": np.stack([x, y, 0 * x], axis=1)}
    regions = np.zeros(len(triangles), dtype=np.int64)
    return quadmosaic.Surface(vertices, triangles, regions, [], attributes, {"TCoords": texture.reshape(-1, 2)})


def corners_of(result: quadmosaic.Result) -> Any:
    return np.concatenate([result.quads.ravel(), result.triangles.ravel()])


def test_attributes_of_vertices_and_corners_are_those_of_the_place() -> None:
    surface = seamed()
    kept, plain = (quadmosaic.mesh(surface, points=300, backend="cpu", keep_uv=keep) for keep in (True, False))
    for result in (kept, plain):
        x, y, _ = result.vertices.T
        assert result.attributes["heat"].shape == x.shape
        assert np.allclose(result.attributes["heat"], x + 2 * y, atol=1e-12)
        assert np.allclose(result.attributes["RGB"], np.stack([x, y, 0 * x], axis=1), atol=1e-12)
        assert result.attributes["TCoords"].shape == (len(x), 2)
        # The place of a vertex gives the same.
        at = surface.vertices[surface.triangles[result.source]]
        assert np.allclose((at * result.barycentric[:, :, np.newaxis]).sum(axis=1), result.vertices, atol=1e-9)
    corners, texture = corners_of(kept), kept.corner_attributes["TCoords"]
    assert texture.shape == (len(corners), 2) == (4 * len(kept.quads) + 3 * len(kept.triangles), 2)
    shift = texture - kept.vertices[corners, :2]
    right, left = (np.abs(shift - side).max(axis=1) < 1e-9 for side in (3.0, 0.0))
    # With keep_uv each face has one side's coordinates; without it some face lies across the seam.
    by_quad = right[: 4 * len(kept.quads)].reshape(-1, 4)
    assert (left | right).all() and (by_quad.all(axis=1) | ~by_quad.any(axis=1)).all()

    def across(result: quadmosaic.Result) -> int:
        xs = result.vertices[result.quads, 0]
        return int(((xs < SEAM - 1e-9).any(axis=1) & (xs > SEAM + 1e-9).any(axis=1)).sum())

    assert across(kept) == 0 < across(plain)
    # Other numbers, or none.
    moved = mesh(surface.vertices, surface.triangles, 300, attributes={"heat": -surface.attributes["heat"]})
    assert not np.allclose(moved.attributes["heat"], moved.vertices @ [1, 2, 0])
    assert mesh(CORNERS, CUBE).attributes == {} == mesh(CORNERS, CUBE).corner_attributes


def test_wrong_attributes_are_refused() -> None:
    surface = seamed()
    for attributes, message in [
        ({"heat": [1.0, 2.0]}, "the attribute heat has 2 rows for 8 vertices"),
        ({"heat": np.zeros((8, 0))}, "heat has no columns"),
        ({"heat": ["hot"] * 8}, "heat has the type <U3; give real numbers"),
        ({"heat": np.zeros((8, 1, 1))}, "heat has 3 dimensions"),
        ({"RGB": 255 * CORNERS}, "the colours RGB are not from 0 to 1"),
    ]:
        with pytest.raises(ValueError, match=message):
            mesh(CORNERS, CUBE, attributes=attributes)
    assert mesh(CORNERS, CUBE, attributes={"RGB": CORNERS}).attributes["RGB"].max() == 1.0
    with pytest.raises(ValueError, match="has 36 rows for 24 corners"):
        mesh(CORNERS, CUBE[:8], corner_attributes={"TCoords": np.zeros((36, 2))})
    with pytest.raises(ValueError, match="triangles cannot be used with a Surface"):
        mesh(surface, surface.triangles)
    with pytest.raises(ValueError, match="triangles are missing"):
        quadmosaic.mesh(CORNERS, points=100)


def test_attributes_survive_files(tmp_path: Path) -> None:
    surface = seamed()
    path = tmp_path / "plate.obj"
    with pytest.warns(quadmosaic.MeshWarning, match="not carried to .*plate.obj: heat; ply, vtk and vtu hold"):
        quadmosaic.save(path, surface)
    read = quadmosaic.load(path)
    assert np.array_equal(read.triangles, surface.triangles) and list(read.corner_attributes) == ["TCoords"]
    assert np.array_equal(read.corner_attributes["TCoords"], surface.corner_attributes["TCoords"])
    assert np.array_equal(read.attributes["RGB"], surface.attributes["RGB"])
    path = tmp_path / "plate.ply"
    quadmosaic.save(path, replace(surface, corner_attributes={}))
    assert np.array_equal(quadmosaic.load(path).attributes["heat"], surface.attributes["heat"])

    result = quadmosaic.mesh(surface, points=300, backend="cpu", keep_uv=True)
    with pytest.warns(quadmosaic.MeshWarning, match="heat"):
        quadmosaic.save(tmp_path / "mesh.obj", result)
    again = quadmosaic.load(tmp_path / "mesh.obj")
    corners = np.concatenate([result.quads[:, [0, 1, 2]].ravel(), result.triangles.ravel()])
    assert len(again.corner_attributes["TCoords"]) >= len(corners)
    quadmosaic.save(tmp_path / "mesh.ply", result, with_source=True)
    with pytest.warns(quadmosaic.MeshWarning, match="not read from .*mesh.ply: source_triangle$"):
        again = quadmosaic.load(tmp_path / "mesh.ply")
    assert np.allclose(again.attributes["heat"], result.attributes["heat"])
    assert np.allclose(np.stack([again.attributes[f"source_barycentric_{k}"] for k in range(3)], 1), result.barycentric)
    quadmosaic.save(tmp_path / "bare.ply", result)
    assert not any("source" in name for name in quadmosaic.load(tmp_path / "bare.ply").attributes)
    with pytest.raises(ValueError, match="with_source goes with ply, vtk and vtu"):
        quadmosaic.save(tmp_path / "mesh.stl", result, with_source=True)
    with pytest.raises(ValueError, match="with_source cannot be used with a Surface"):
        quadmosaic.save(tmp_path / "mesh.ply", surface, with_source=True)


def test_arrays_that_are_not_read_are_warned_of(tmp_path: Path) -> None:
    path = tmp_path / "cube.vtk"
    quadmosaic.save(path, mesh(CORNERS, CUBE, 100))
    with pytest.warns(quadmosaic.MeshWarning, match="not read from .*cube.vtk: .*shape"):
        quadmosaic.load(path)


def test_keep_uv_is_that_of_the_command_line(tmp_path: Path) -> None:
    surface = replace(seamed(), attributes={})
    path, ours, theirs = (tmp_path / name for name in ("plate.obj", "ours.obj", "theirs.obj"))
    quadmosaic.save(path, surface)
    quadmosaic.save(ours, quadmosaic.mesh(quadmosaic.load(path), points=300, backend="cpu", keep_uv=True))
    done = command("mesh", str(path), "--points", "300", "--backend", "cpu", "--keep-uv", "-o", str(theirs), "-q")
    assert done.returncode == 0 and ours.read_bytes() == theirs.read_bytes()
    done = command("mesh", str(path), "--points", "300", "--backend", "cpu", "-o", str(theirs), "-q")
    assert done.returncode == 0 and ours.read_bytes() != theirs.read_bytes()


def test_examples_are_those_of_the_command_line(tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.off", tmp_path / "theirs.off"
    for name in ["m6", "torus", "sphere", "plate", "block"]:
        quadmosaic.save(ours, quadmosaic.example(name, 600))
        assert command("example", name, "--triangles", "600", "-o", str(theirs)).returncode == 0
        assert ours.read_bytes() == theirs.read_bytes()
    with pytest.raises(ValueError, match="no example surface \"cone\"; choose one of m6"):
        quadmosaic.example("cone")
    with pytest.raises(ValueError, match="ask for 1 to 20000000 triangles"):
        quadmosaic.example("m6", 0)


FORMATS = ["obj", "ply", "stl", "off", "vtk", "vtu", "msh", "msh22", "su2", "inp", "bdf", "glb"]


@pytest.mark.parametrize("format", FORMATS)
def test_files_are_those_of_the_command_line(tmp_path: Path, format: str) -> None:
    cube, ours, theirs = tmp_path / "cube.off", tmp_path / f"ours.{format}", tmp_path / f"theirs.{format}"
    quadmosaic.save(cube, quadmosaic.Surface(CORNERS, CUBE, np.zeros(12, dtype=np.int64), []))
    surface = quadmosaic.load(cube)
    assert np.array_equal(surface.vertices, CORNERS) and np.array_equal(surface.triangles, CUBE)
    quadmosaic.save(ours, mesh(surface.vertices, surface.triangles, points=100), format=format)
    done = command("mesh", str(cube), "--points", "100", "--backend", "cpu", "-o", str(theirs), "--to", format, "-q")
    assert done.returncode == 0 and done.stderr == ""
    assert ours.read_bytes() == theirs.read_bytes()
    if format in ["obj", "ply", "stl", "off", "vtk", "vtu", "msh"]:
        # Arrays of faces and integers of vertices are not read again, and the warning says so.
        warnings.simplefilter("ignore", quadmosaic.MeshWarning)
        assert len(quadmosaic.load(ours, format=format).triangles) > 100


def test_a_faulty_file_names_its_line(tmp_path: Path) -> None:
    path = tmp_path / "bad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n")
    with pytest.raises(quadmosaic.SurfaceError, match="line 3") as caught:
        quadmosaic.load(path)
    assert (caught.value.line, caught.value.triangle) == (3, None)
    with pytest.raises(FileNotFoundError):
        quadmosaic.load(tmp_path / "none.obj")
    with pytest.raises(ValueError, match="the formats are obj"):
        quadmosaic.save(tmp_path / "mesh.xyz", mesh(CORNERS, CUBE))


def test_a_faulty_array_names_its_triangle() -> None:
    wrong = CUBE.copy()
    wrong[5, 1] = 8
    with pytest.raises(quadmosaic.SurfaceError, match=r"triangles\[5\] uses vertex 8") as caught:
        mesh(CORNERS, wrong)
    assert (caught.value.line, caught.value.triangle) == (None, 5)
    with pytest.raises(quadmosaic.SurfaceError, match="no triangles"):
        mesh(CORNERS, CUBE[:0])
    with pytest.raises(quadmosaic.SurfaceError, match="not finite"):
        mesh(np.where(CORNERS == 0, np.nan, CORNERS), CUBE)
    with pytest.raises(ValueError, match=r"triangles has the shape \(12, 2\)"):
        mesh(CORNERS, CUBE[:, :2])
    with pytest.raises(ValueError, match="whole numbers"):
        mesh(CORNERS, CUBE + 0.5)


WRONG = {
    "points": 3,
    "size": -1.0,
    "symmetry": "w",
    "keep_boundary": -1.0,
    "refine_curvature": 91.0,
    "around": 101,
    "max_growth": 1.0,
    "weld": "3%%",
    "drop_parts": "0",
    "fill_holes": "x",
    "crease": 181.0,
    "ridge": 0.5,
    "align": "normals",
    "fit": 1.5,
    "fit_range": 11.0,
    "aspect": 21.0,
    "max_distance": 0.5,
    "max_angle": 46.0,
    "smoothing": 1001,
}


@pytest.mark.parametrize("name", WRONG)
def test_options_have_the_messages_of_the_command_line(name: str) -> None:
    value = WRONG[name]
    with pytest.raises(ValueError, match=f"^invalid value '.*' for {name}: ") as caught:
        quadmosaic.mesh(CORNERS, CUBE, backend="cpu", **{name: value})  # type: ignore[arg-type]
    message = str(caught.value).split(": ", 1)[1]
    said = command("mesh", "example:block", "-o", "none.obj", f"--{name.replace('_', '-')}={value}").stderr
    assert message in " ".join(said.split()), said


def test_a_symmetric_mesh_is_its_own_image() -> None:
    sphere = quadmosaic.example("sphere", 2_000)

    def images(**options: str) -> bool:
        result = quadmosaic.mesh(sphere, points=400, backend="cpu", **options)  # type: ignore[arg-type]
        points = {tuple(point) for point in result.vertices.tolist()}
        return all((x, y, -z) in points for x, y, z in points)

    assert images(symmetry="z")
    assert not images()


def test_the_boundary_is_kept_bit_for_bit() -> None:
    plate = quadmosaic.example("plate", 1_000)
    x, y = plate.vertices[:, 0] - 0.5, plate.vertices[:, 1] - 0.5
    is_rim = (np.abs(x) == 0.5) | (np.abs(y) == 0.5) | (np.abs(np.hypot(x, y) - 0.2) < 1e-12)
    rim = {tuple(point) for point in plate.vertices[is_rim].tolist()}

    def kept(keep_boundary: Union[bool, float]) -> set[tuple[float, ...]]:
        result = quadmosaic.mesh(plate, points=400, backend="cpu", keep_boundary=keep_boundary)
        return {tuple(point) for point in result.vertices[result.kind != 0].tolist()}

    assert len(rim) > 30 and kept(True) == rim
    assert kept(False) != rim
    # 20 intervals on each side, and an even number near 8 pi round the hole.
    assert len(kept(0.05)) == 4 * 20 + 26


def test_options_are_those_of_the_library_and_keywords() -> None:
    parameters = inspect.signature(quadmosaic.mesh).parameters
    assert set(_native.option_names()) <= set(parameters)
    positional = [name for name, it in parameters.items() if it.kind is not inspect.Parameter.KEYWORD_ONLY]
    assert positional == ["vertices", "triangles", "points"]
    assert len(mesh(CORNERS, CUBE, quads="all").triangles) == 0
    assert len(mesh(CORNERS, CUBE, no_cleanup=True).triangles) >= len(mesh(CORNERS, CUBE).triangles)
    with pytest.raises(ValueError, match="invalid value 'few' for quads: write one of paper, most, all"):
        mesh(CORNERS, CUBE, quads="few")
    with pytest.raises(ValueError, match="points cannot be used with size"):
        mesh(CORNERS, CUBE, points=100, size=0.1)
    with pytest.raises(ValueError, match="no_cleanup cannot be used with quads"):
        mesh(CORNERS, CUBE, quads="all", no_cleanup=True)
    with pytest.raises(ValueError, match="invalid value 'tpu' for backend: write one of auto, cpu, gpu"):
        quadmosaic.mesh(CORNERS, CUBE, backend="tpu")
    with pytest.raises(ValueError, match="invalid value '-1' for threads"):
        mesh(CORNERS, CUBE, threads=-1)
    with pytest.raises(TypeError, match="layers"):
        mesh(CORNERS, CUBE, layers=3)


def test_memory_and_time_are_limited() -> None:
    with pytest.raises(MemoryError, match="more than the limit of 20.00 MB; [0-9]+ points would fit"):
        mesh(CORNERS, CUBE, points=100_000, max_memory="20M")
    with pytest.raises(MemoryError, match="limit of 20.00 MB"):
        mesh(CORNERS, CUBE, points=100_000, max_memory=20 * 1024**2)
    with pytest.raises(TimeoutError, match="there is no mesh yet after 0.000001 s"):
        mesh(CORNERS, CUBE, time_limit=1e-6)
    with pytest.raises(ValueError, match="invalid value 'much' for max_memory: write a number of bytes"):
        mesh(CORNERS, CUBE, max_memory="much")
    assert np.array_equal(mesh(CORNERS, CUBE, max_memory="1G", time_limit=600).quads, mesh(CORNERS, CUBE).quads)


def test_layouts_and_presets_are_overridden() -> None:
    quads = mesh(CORNERS, CUBE, layout="quads")
    assert np.array_equal(quads.quads, mesh(CORNERS, CUBE, quads="all", fit=1, rows="continuous").quads)
    assert len(quads.triangles) == 0
    fem = mesh(CORNERS, CUBE, preset="fem", layout="mosaic")
    assert len(mesh(CORNERS, CUBE, preset="fem").triangles) == 0
    assert np.array_equal(fem.quads, mesh(CORNERS, CUBE).quads)
    light = quadmosaic.mesh(CORNERS, CUBE, 200, preset="retopo", backend="cpu")
    assert light.report["asked"] == {"points": 200}
    assert quadmosaic.mesh(CORNERS, CUBE, preset="retopo", backend="cpu").report["asked"] == {"points": 1500}
    contradictions: list[tuple[str, dict[str, Any]]] = [
        ("--quads=paper", {"quads": "paper"}),
        ("--no-cleanup", {"no_cleanup": True}),
    ]
    for argument, options in contradictions:
        with pytest.raises(ValueError, match="^the layout quads ") as caught:
            mesh(CORNERS, CUBE, layout="quads", **options)
        said = command("mesh", "example:block", "-o", "none.obj", "--layout", "quads", argument).stderr
        assert str(caught.value) in " ".join(said.split()), said
    with pytest.raises(ValueError, match="invalid value 'odd' for layout: write one of mosaic, even, quads"):
        mesh(CORNERS, CUBE, layout="odd")
    with pytest.raises(ValueError, match="invalid value 'cad' for preset: write one of cfd, fem, scan, retopo, paper"):
        mesh(CORNERS, CUBE, preset="cad")


def test_guides_and_sizes_from_lists_and_files(tmp_path: Path) -> None:
    vertices, triangles = torus(40, 20)
    plain = mesh(vertices, triangles)
    guide = ([1.4, 0.0, 0.0], [0.0, 1.0, 1.0], 0.3)
    guided = mesh(vertices, triangles, guides=[guide])
    assert guided.report["field"]["guides"][0]["crosses"] > 0
    assert not np.array_equal(plain.vertices, guided.vertices)
    path = tmp_path / "guides.csv"
    path.write_text("1.4,0,0,0,1,1,0.3\n")
    for same in [path, str(path), [dict(point=np.array(guide[0]), direction=guide[1], radius=np.float32(0.3))]]:
        other = mesh(vertices, triangles, guides=same)
        assert np.allclose(other.vertices, guided.vertices, atol=1e-6)
    with pytest.raises(ValueError, match=r"guides, guides\[0\]: the direction"):
        mesh(vertices, triangles, guides=[([0, 0, 0], [0, 0, 0])])

    sizes = np.array([[1.4, 0, 0, 0.05], [-1.4, 0, 0, 0.2]])
    graded = mesh(vertices, triangles, points=None, sizes=sizes)
    right = (graded.vertices[:, 0] > 0).mean()
    assert right > 0.6 and abs((plain.vertices[:, 0] > 0).mean() - 0.5) < 0.05
    with pytest.raises(ValueError, match="sizes, vertex 1"):
        mesh(vertices, triangles, sizes=sizes * [1, 1, 1, -1] + [[0, 0, 0, 1], [0, 0, 0, 0]])


def test_warnings_are_warned() -> None:
    with pytest.warns(quadmosaic.MeshWarning, match="away from the surface"):
        mesh(CORNERS, CUBE, guides=[([9, 9, 9], [1, 0, 0])])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh(CORNERS, CUBE)


def test_progress_is_told_and_can_cancel() -> None:
    told: list[tuple[str, float]] = []
    caller = threading.current_thread()

    def note(stage: str, share: float) -> None:
        assert threading.current_thread() is caller
        told.append((stage, share))

    mesh(CORNERS, CUBE, progress=note)
    assert told and all(0 <= share <= 1 for _, share in told)
    with pytest.raises(quadmosaic.Cancelled):
        mesh(CORNERS, CUBE, points=200_000, progress=lambda stage, share: False)

    def fails(stage: str, share: float) -> None:
        raise KeyError(stage)

    with pytest.raises(KeyError):
        mesh(CORNERS, CUBE, points=200_000, progress=fails)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_a_run() -> None:
    script = (
        "import signal, sys; sys.path.insert(0, sys.argv[1]); from test_quadmosaic import *\n"
        # A shell that starts this in the background has it ignored.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "print('go', flush=True)\n"
        "try: mesh(*torus(400, 200), points=1_000_000)\n"
        "except KeyboardInterrupt: print('interrupted', flush=True)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", script, str(Path(__file__).parent)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None and process.stdout.readline() == "go\n"
    time.sleep(1.0)
    sent = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    print(f"interrupted after {time.monotonic() - sent:.3f} s")
    process.wait(timeout=60)


def test_other_threads_run_during_a_mesh() -> None:
    counted, stop = [0], threading.Event()

    def count() -> None:
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    mesh(*torus(100, 50), points=20_000)
    during = counted[0] - before
    stop.set()
    thread.join()
    # One that waits for the mesh counts once or twice.
    assert during > 10


def test_threads_share_a_backend_and_get_the_same_mesh() -> None:
    alone = mesh(CORNERS, CUBE)
    found: list[quadmosaic.Result] = []
    threads = [threading.Thread(target=lambda: found.append(mesh(CORNERS, CUBE, threads=1))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(np.array_equal(other.vertices, alone.vertices) for other in found)


def mesh_and_save(queue: Any, path: Path) -> None:
    result = mesh(*torus(60, 30), 3_000)
    quadmosaic.save(path, result)
    queue.put(len(result.vertices))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no process can be forked here")
def test_a_forked_process_has_threads_of_its_own(tmp_path: Path) -> None:
    result = mesh(*torus(60, 30), 3_000)
    quadmosaic.save(tmp_path / "parent.obj", result)
    forked = multiprocessing.get_context("fork")
    queue = forked.Queue()
    child = forked.Process(target=mesh_and_save, args=(queue, tmp_path / "child.obj"))
    child.start()
    try:
        assert queue.get(timeout=60) == len(result.vertices)
    finally:
        child.kill()
    child.join()
    assert (tmp_path / "child.obj").read_bytes() == (tmp_path / "parent.obj").read_bytes()


def test_other_packages_take_the_mesh() -> None:
    result = mesh(CORNERS, CUBE, attributes={"heat": CORNERS[:, 0], "kind": CORNERS[:, 1]})
    faces = len(result.quads) + len(result.triangles)
    pyvista = pytest.importorskip("pyvista")
    assert list(result.to_pyvista().point_data) == ["heat", "kind", "source"]
    assert result.to_pyvista().n_cells == faces and result.to_pyvista().volume == pytest.approx(1.0, abs=1e-6)
    assert pyvista is not None
    pytest.importorskip("trimesh")
    assert np.allclose(result.to_trimesh().vertex_attributes["heat"], result.vertices[:, 0])
    assert result.to_trimesh().is_watertight and result.to_trimesh().volume == pytest.approx(1.0)
    pytest.importorskip("meshio")
    cells = result.to_meshio().cells
    assert np.array_equal(result.to_meshio().point_data["kind"], result.kind)
    assert sum(len(block.data) for block in cells) == faces and cells[0].type == "quad"


def test_holes_can_be_left_as_polygons() -> None:
    result = mesh(*torus(60, 30), points=2_000, holes="leave", no_cleanup=True, smoothing=0)
    assert result.polygons and all(len(polygon) > 4 for polygon in result.polygons)
    assert len(result.regions) == len(result.quads) + len(result.triangles) + len(result.polygons)


def test_sizes_stand_for_arrays() -> None:
    surface = quadmosaic.example("torus", 2_000)
    assert repr(surface) == f"Surface({len(surface.vertices)} vertices, {len(surface.triangles)} triangles)"
    for holes in ("patterns", "leave"):
        result = mesh(surface.vertices, surface.triangles, 500, holes=holes, no_cleanup=True, smoothing=0)
        sizes = f"{len(result.vertices)} vertices, {len(result.quads)} quads, {len(result.triangles)} triangles"
        polygons = f", {len(result.polygons)} polygons" if holes == "leave" else ""
        assert repr(result) == f"Result({sizes}{polygons})"


def test_objects_are_compared_by_identity_and_a_result_says_why_it_is_not_pickled() -> None:
    surface = quadmosaic.example("torus", 1_000)
    result = mesh(surface.vertices, surface.triangles, 200)
    again = mesh(surface.vertices, surface.triangles, 200)
    assert result == result != again and surface == surface != quadmosaic.example("torus", 1_000)
    assert (pickle.loads(pickle.dumps(surface)).vertices == surface.vertices).all()
    with pytest.raises(TypeError, match="save it and return the path"):
        pickle.dumps(result)


def test_the_command_line_is_there() -> None:
    done = command("--version")
    assert done.returncode == 0 and done.stdout.strip() == f"quadmosaic {quadmosaic.__version__}"
    assert command("mesh").returncode == 2
    done = command("mesh", "none.stl", "-o", "out.obj")
    assert done.returncode == 1 and done.stderr.startswith("error: there is no file none.stl")
