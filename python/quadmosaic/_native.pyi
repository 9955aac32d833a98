from collections.abc import Callable, Sequence
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_Integers = NDArray[np.int64]
_Regions = tuple[list[str], _Integers]

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
    def kind(self) -> _Integers: ...
    def save(self, path: str, format: Optional[str]) -> None: ...

def mesh(
    vertices: _Floats,
    triangles: _Integers,
    regions: Optional[_Regions],
    options: Sequence[tuple[str, str]],
    guides: Optional[tuple[bool, str]],
    sizes: Union[_Floats, str, None],
    edges: Union[_Integers, str, None],
    machine: tuple[str, Optional[str], str],
    progress: Optional[Callable[[str, float], Any]],
) -> Meshed: ...
def load(path: str, format: Optional[str]) -> tuple[_Floats, _Integers, list[str], _Integers]: ...
def save(
    path: str,
    format: Optional[str],
    vertices: _Floats,
    quads: _Integers,
    triangles: _Integers,
    regions: Optional[_Regions],
) -> None: ...
def command_line(arguments: Sequence[str]) -> int: ...
def option_names() -> list[str]: ...
