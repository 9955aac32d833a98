"""Quad-dominant surface meshes from triangle surfaces.

    result = quadmosaic.mesh(vertices, triangles, points=6000)
    result.vertices, result.quads, result.triangles
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, NoReturn, Optional, TypeVar, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._native import Cancelled, SurfaceError

if TYPE_CHECKING:
    import meshio
    import pyvista
    import trimesh

__all__ = ["Cancelled", "MeshWarning", "Result", "Surface", "SurfaceError", "example", "load", "mesh", "save"]

__version__ = version("quadmosaic")

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Path = Union[str, "os.PathLike[str]"]
Length = Union[float, str]
T = TypeVar("T")
Guide = Union[Sequence[Any], "dict[str, Any]"]
"""(point, direction[, radius[, weight]]), or a dict with point and direction, or with the points of a stroke; both perhaps with radius
and weight."""


if "XDG_RUNTIME_DIR" not in os.environ:
    # On a server without a desktop, a layer that Mesa puts before the driver of a GPU complains on stderr at every start.
    os.environ.setdefault("NODEVICE_SELECT", "1")


class MeshWarning(UserWarning):
    """What a user should know of a result."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles of a file."""

    vertices: Floats
    """(n, 3), in the order of the file."""
    triangles: Integers
    """(k, 3), counted from 0; polygons are split."""
    regions: Integers
    """(k,): the region of each triangle, an index into region_names; 0 where there is none."""
    region_names: list[str]
    """Empty where the file has no regions."""
    attributes: dict[str, Floats] = field(default_factory=dict)
    """Numbers of vertices by name: (n,), or (n, c) of more than one component. RGB (n, 3) is a colour from 0 to 1, TCoords (n, 2) are
    texture coordinates."""
    corner_attributes: dict[str, Floats] = field(default_factory=dict)
    """Numbers of the corners of triangles by name: (3 k,) or (3 k, c), the corners of a triangle one after the other. A file has
    TCoords here where they jump at seams."""

    def __repr__(self) -> str:
        return f"Surface({len(self.vertices)} vertices, {len(self.triangles)} triangles)"


@dataclass(frozen=True, eq=False)
class Result:
    """A finished mesh."""

    vertices: Floats
    """(n, 3), in the units of the surface."""
    quads: Integers
    """(m, 4), counter-clockwise seen from outside."""
    triangles: Integers
    """(k, 3)."""
    polygons: list[Integers]
    """Faces of more than four corners: with holes="leave" alone."""
    regions: Integers
    """The region of each face: quads, then triangles, then polygons; an index into region_names, 0 where there is none."""
    region_names: list[str]
    """Empty where the surface has no regions."""
    source: Integers
    """(n,): the triangle of the surface that each vertex lies on."""
    barycentric: Floats
    """(n, 3): the barycentric coordinates of each vertex in that triangle."""
    kind: Integers
    """(n,): 0 free, 1 on a boundary, 2 on a feature curve, 3 a corner."""
    attributes: dict[str, Floats]
    """The surface's attributes at each vertex, by name: (n,), or (n, c) of more than one component. Where values jump at a seam, those
    of one side."""
    corner_attributes: dict[str, Floats]
    """Texture coordinates that jump at seams, by name: (4 m + 3 k + ..., 2), of the corners of quads, then of triangles, then of
    polygons, those of a face one after the other. A name is in attributes too."""
    report: dict[str, Any]
    """The figures that the command line writes by --report."""
    _meshed: _native.Meshed

    def __repr__(self) -> str:
        polygons = f", {len(self.polygons)} polygons" if self.polygons else ""
        return f"Result({len(self.vertices)} vertices, {len(self.quads)} quads, {len(self.triangles)} triangles{polygons})"

    def __reduce__(self) -> NoReturn:
        raise TypeError("a Result cannot be pickled: return its arrays to another process, or save it and return the path")

    def to_pyvista(self) -> pyvista.PolyData:
        """The mesh as pyvista.PolyData, with the arrays region, kind and source, and the attributes of vertices."""
        import pyvista

        sizes = [(self.quads, 4), (self.triangles, 3)]
        faces = [np.insert(faces, 0, size, axis=1).ravel() for faces, size in sizes]
        faces += [np.insert(polygon, 0, len(polygon)) for polygon in self.polygons]
        mesh = pyvista.PolyData(self.vertices, faces=np.concatenate(faces))
        mesh.cell_data["region"] = self.regions
        for name, values in self._of_vertices().items():
            mesh.point_data[name] = values
        return mesh

    def to_trimesh(self) -> trimesh.Trimesh:
        """The mesh as trimesh.Trimesh, with kind, source and attributes as vertex_attributes: each quad is two triangles, and polygons
        are left out."""
        import trimesh

        faces = np.concatenate([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]], self.triangles])
        return trimesh.Trimesh(self.vertices, faces, process=False, vertex_attributes=self._of_vertices())

    def to_meshio(self) -> meshio.Mesh:
        """The mesh as meshio.Mesh, with the arrays region, kind and source, and the attributes of vertices; polygons are left out."""
        import meshio

        quads, faces = len(self.quads), len(self.quads) + len(self.triangles)
        blocks = [("quad", self.quads, self.regions[:quads]), ("triangle", self.triangles, self.regions[quads:faces])]
        blocks = [block for block in blocks if len(block[1]) > 0]
        return meshio.Mesh(
            self.vertices,
            [(kind, cells) for kind, cells, _ in blocks],
            point_data=self._of_vertices(),
            cell_data={"region": [regions for _, _, regions in blocks]},
        )

    def _of_vertices(self) -> dict[str, Any]:
        """The arrays of vertices by name; kind and source are never those of the surface."""
        return {**self.attributes, "kind": self.kind, "source": self.source}


def mesh(
    vertices: Union[npt.ArrayLike, Surface],
    triangles: Optional[npt.ArrayLike] = None,
    points: Optional[int] = None,
    *,
    guides: Union[Path, Sequence[Guide], None] = None,
    sizes: Union[Path, npt.ArrayLike, None] = None,
    progress: Optional[Callable[[str, float], Optional[bool]]] = None,
    regions: Optional[npt.ArrayLike] = None,
    region_names: Optional[Sequence[str]] = None,
    attributes: Optional[Mapping[str, npt.ArrayLike]] = None,
    corner_attributes: Optional[Mapping[str, npt.ArrayLike]] = None,
    preset: Optional[str] = None,
    layout: Optional[str] = None,
    size: Optional[float] = None,
    symmetry: Optional[str] = None,
    keep_boundary: Union[bool, float] = False,
    refine_curvature: Optional[float] = None,
    around: Optional[int] = None,
    max_growth: Optional[float] = None,
    size_at: Union[str, Sequence[str], None] = None,
    around_holes: Optional[int] = None,
    min_size: Optional[float] = None,
    max_size: Optional[float] = None,
    weld: Optional[Length] = None,
    imprint: bool = False,
    drop_parts: Optional[Length] = None,
    fill_holes: Optional[Length] = None,
    crease: Optional[float] = None,
    ignore_regions: bool = False,
    keep_uv: bool = False,
    feature_edges: Union[Path, npt.ArrayLike, None] = None,
    ridge: Optional[float] = None,
    align: Optional[str] = None,
    rows: Optional[str] = None,
    fit: Optional[float] = None,
    fit_range: Optional[float] = None,
    aspect: Optional[float] = None,
    max_distance: Optional[float] = None,
    max_angle: Optional[float] = None,
    holes: Optional[str] = None,
    quads: Optional[str] = None,
    no_cleanup: bool = False,
    smoothing: Optional[int] = None,
    max_memory: Union[int, str, None] = None,
    time_limit: Optional[float] = None,
    backend: str = "auto",
    adapter: Optional[str] = None,
    threads: int = 0,
) -> Result:
    """Meshes triangles.

    vertices: (n, 3). triangles: (k, 3), counted from 0. Or a Surface for both, with its regions and attributes. points: the wanted number of vertices, 6000 where neither size nor sizes is
    given. guides: a file, or a list of Guide. sizes: a file, or rows of x, y, z and the wanted edge length there. progress: called with
    the name of a stage and the share of it that is done; where it returns False, Cancelled is raised. regions: the region of each
    triangle, an index into region_names. attributes, corner_attributes: numbers of vertices and of the corners of triangles, as Surface
    has them; the mesh gets them by linear interpolation. feature_edges: a file, or pairs of vertices. keep_boundary: True keeps the
    vertices of the boundary, a number points about so far apart on it.

    preset, layout: options that are set together; others override what they set. What contradicts a layout is refused.

    max_memory: bytes, or text as "2G"; MemoryError where the run is predicted to need more. time_limit: seconds, after which the best mesh so
    far is the result, with a warning; TimeoutError where there is none yet.

    The other options are those of `quadmosaic mesh`, with _ for -; None is the default there. All threads of a process share its
    backends, each of which is made once.

    Raises SurfaceError where the surface is faulty, ValueError where an option is, and RuntimeError where the backend fails. Warns by
    MeshWarning.
    """
    given: dict[str, Any] = dict(locals())
    # A preset and a layout come first: the others override what they set.
    values = {name: given[name] for name in _OPTIONS}
    if isinstance(vertices, Surface):
        if triangles is not None:
            raise ValueError("triangles cannot be used with a Surface, which has its own")
        surface = vertices
        vertices, triangles = surface.vertices, surface.triangles
        if regions is None and surface.region_names:
            regions, region_names = surface.regions, surface.region_names
        attributes = surface.attributes if attributes is None else attributes
        corner_attributes = surface.corner_attributes if corner_attributes is None else corner_attributes
    if triangles is None:
        raise ValueError("triangles are missing; give them beside vertices, or a Surface")
    if points is not None and size is not None:
        raise ValueError("points cannot be used with size; give one of them")
    if quads is not None and no_cleanup:
        raise ValueError("no_cleanup cannot be used with quads; give one of them")
    meshed = _native.mesh(
        _floats(vertices, "vertices"),
        _integers(triangles, "triangles"),
        None if regions is None else _regions(regions, region_names),
        _attributes(attributes or {}, corner_attributes or {}),
        [(name, text) for name, value in values.items() for text in _texts(value)],
        _guides(guides),
        _file_or(_floats, sizes, "sizes"),
        _file_or(_integers, feature_edges, "feature_edges"),
        (backend, adapter, _text(threads)),
        progress,
    )
    for warning in meshed.warnings:
        warnings.warn(warning, MeshWarning, stacklevel=2)
    return Result(
        vertices=meshed.vertices(),
        quads=meshed.faces(4),
        triangles=meshed.faces(3),
        polygons=meshed.polygons(),
        regions=meshed.regions(),
        region_names=meshed.region_names(),
        source=meshed.source(),
        barycentric=meshed.barycentric(),
        kind=meshed.kind(),
        attributes=_named(meshed.attributes()),
        corner_attributes=_named(meshed.corner_attributes()),
        report=json.loads(meshed.report),
        _meshed=meshed,
    )


def load(path: Path, *, format: Optional[str] = None) -> Surface:
    """Reads the triangles of an OBJ, STL, PLY, OFF, MSH, VTK, VTU or VTP file, perhaps in gzip, told apart by content.

    format: that of a file whose content leaves it open. Raises SurfaceError, with the line or the triangle where one is wrong. Warns by
    MeshWarning of arrays that are not read, as numbers of faces and integers of vertices.
    """
    arrays, left_out = _native.load(os.fspath(path), format)
    if left_out:
        warnings.warn(f"not read from {os.fspath(path)}: {', '.join(left_out)}", MeshWarning, stacklevel=2)
    return _surface(arrays)


def example(name: str, triangles: int = 20_000) -> Surface:
    """An example surface of about so many triangles: m6, torus, sphere, plate, block or flange."""
    return _surface(_native.example(name, triangles))


def save(
    path: Path, mesh: Union[Result, Surface], *, format: Optional[str] = None, with_source: bool = False
) -> None:
    """Writes a mesh or a surface, with its attributes, to a file, whole or not at all.

    format: obj, ply, stl, off, vtk, vtu, msh, msh22, su2, inp, bdf or glb; without it, the extension tells it. with_source: a Result's
    source and barycentric are written too, as the arrays source_triangle and source_barycentric of PLY, VTK and VTU. Warns by
    MeshWarning of attributes that the format does not hold.
    """
    if isinstance(mesh, Result):
        warning = mesh._meshed.save(os.fspath(path), format, with_source)
    elif with_source:
        raise ValueError("with_source cannot be used with a Surface, which has no source")
    else:
        regions = (mesh.region_names, mesh.regions) if mesh.region_names else None
        vertices, triangles = _floats(mesh.vertices, "vertices"), _integers(mesh.triangles, "triangles")
        attributes = _attributes(mesh.attributes, mesh.corner_attributes)
        warning = _native.save(os.fspath(path), format, vertices, triangles, regions, attributes)
    if warning is not None:
        warnings.warn(warning, MeshWarning, stacklevel=2)


_OPTIONS = tuple(_native.option_names())


def _texts(value: Any) -> list[str]:
    """The values of an option, each as the command line writes it; none where it is not given."""
    if value is None or value is False:
        return []
    return [_text(item) for item in value] if isinstance(value, (list, tuple)) else [_text(value)]


def _text(value: Any) -> str:
    """A value as the command line writes it."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    return str(value.item() if isinstance(value, np.generic) else value)


def _file_or(array: Callable[[npt.ArrayLike, str], T], value: Any, name: str) -> Union[str, T, None]:
    """The path of a file, or an array."""
    if value is None:
        return None
    return os.fspath(value) if isinstance(value, (str, os.PathLike)) else array(value, name)


def _floats(array: npt.ArrayLike, name: str) -> Floats:
    return _two_dimensional(np.asarray(array, dtype=np.float64), name)


def _integers(array: npt.ArrayLike, name: str) -> Integers:
    given = np.asarray(array)
    if given.size > 0 and given.dtype.kind not in "iu":
        raise ValueError(f"{name} has the type {given.dtype}; give whole numbers")
    return _two_dimensional(given.astype(np.int64, copy=False), name)


def _two_dimensional(array: npt.NDArray[Any], name: str) -> npt.NDArray[Any]:
    if array.ndim != 2:
        raise ValueError(f"{name} has {array.ndim} dimensions; give rows and columns")
    return array


def _regions(regions: npt.ArrayLike, names: Optional[Sequence[str]]) -> tuple[list[str], Integers]:
    numbers = np.asarray(regions)
    if numbers.ndim != 1 or numbers.size > 0 and numbers.dtype.kind not in "iu":
        raise ValueError("regions are one whole number for each triangle")
    count = int(numbers.max(initial=-1)) + 1
    named = [f"region_{number}" for number in range(count)] if names is None else list(names)
    return named, numbers.astype(np.int64, copy=False)


def _attributes(
    of_vertices: Mapping[str, npt.ArrayLike], of_corners: Mapping[str, npt.ArrayLike]
) -> list[tuple[str, bool, Floats]]:
    """The name, whether it is of corners, and two-dimensional numbers; a name of both is of corners."""
    given = [(name, False, array) for name, array in of_vertices.items() if name not in of_corners]
    given += [(name, True, array) for name, array in of_corners.items()]
    return [(name, is_of_corners, _columns(array, name)) for name, is_of_corners, array in given]


def _columns(array: npt.ArrayLike, name: str) -> Floats:
    numbers = np.asarray(array)
    if numbers.dtype.kind not in "biuf":
        raise ValueError(f"the attribute {name} has the type {numbers.dtype}; give real numbers")
    numbers = numbers.astype(np.float64, copy=False)
    return _two_dimensional(numbers[:, np.newaxis] if numbers.ndim == 1 else numbers, f"the attribute {name}")


def _named(arrays: Sequence[tuple[str, Floats]]) -> dict[str, Floats]:
    """Arrays by name, those of one column without columns."""
    return {name: array[:, 0] if array.shape[1] == 1 else array for name, array in arrays}


def _surface(arrays: _native.Arrays) -> Surface:
    vertices, triangles, regions, region_names, of_vertices, of_corners = arrays
    return Surface(vertices, triangles, regions, region_names, _named(of_vertices), _named(of_corners))


def _guides(guides: Union[Path, Sequence[Guide], None]) -> Optional[tuple[bool, str]]:
    """A file, or the text of one in JSON."""
    if guides is None:
        return None
    if isinstance(guides, (str, os.PathLike)):
        return True, os.fspath(guides)
    vectors: list[dict[str, Any]] = []
    strokes: list[dict[str, Any]] = []
    for guide in guides:
        if not isinstance(guide, dict):
            guide = dict(zip(("point", "direction", "radius", "weight"), guide))
        (strokes if "points" in guide else vectors).append(guide)
    if not vectors and not strokes:
        return None
    return False, json.dumps({"guides": vectors, "strokes": strokes}, default=_plain)


def _plain(value: Any) -> Any:
    """An array or a number of numpy as JSON has it."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"{value!r} is no number")
