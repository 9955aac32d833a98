from collections.abc import Callable, Sequence
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_Integers = NDArray[np.int64]
_Regions = tuple[list[str], _Integers]
_Given = Sequence[tuple[str, bool, _Floats]]
_Named = list[tuple[str, _Floats]]
Arrays = tuple[_Floats, _Integers, _Integers, list[str], _Named, _Named]

class SurfaceError(ValueError):
    """The surface is faulty."""

    line: Optional[int]
    """The line of the file that is wrong, counted from 1."""
    triangle: Optional[int]
    """The triangle that is wrong, counted from 0."""

class Cancelled(Exception):
    """The progress function returned False."""

class Meshed:
    @property
    def report(self) -> str: ...
    @property
    def warnings(self) -> list[str]: ...
    def vertices(self) -> _Floats: ...
    def faces(self, corners: int) -> _Integers: ...
    def polygons(self) -> list[_Integers]: ...
    def regions(self) -> _Integers: ...
    def region_names(self) -> list[str]: ...
    def source(self) -> _Integers: ...
    def barycentric(self) -> _Floats: ...
    def kind(self) -> _Integers: ...
    def attributes(self) -> _Named: ...
    def corner_attributes(self) -> _Named: ...
    def save(self, path: str, format: Optional[str], with_source: bool) -> Optional[str]: ...

def mesh(
    vertices: _Floats,
    triangles: _Integers,
    regions: Optional[_Regions],
    attributes: _Given,
    options: Sequence[tuple[str, str]],
    guides: Optional[tuple[bool, str]],
    sizes: Union[_Floats, str, None],
    edges: Union[_Integers, str, None],
    machine: tuple[str, Optional[str], str],
    progress: Optional[Callable[[str, float], Any]],
) -> Meshed: ...
def load(path: str, format: Optional[str]) -> tuple[Arrays, list[str]]: ...
def example(name: str, triangles: int) -> Arrays: ...
def save(
    path: str,
    format: Optional[str],
    vertices: _Floats,
    triangles: _Integers,
    regions: Optional[_Regions],
    attributes: _Given,
) -> Optional[str]: ...
def command_line(arguments: Sequence[str]) -> int: ...
def option_names() -> list[str]: ...
