"""Meshes many surfaces on a Dask cluster, with a table of results.

    python cluster.py parts/*.stl --points 2000 -o meshes                        two workers on this machine
    python cluster.py --list parts.txt --scheduler tcp://head:8786 -o meshes     those of a cluster

A surface is a file or an example (example:m6, example:torus:2000). The workers read and write files themselves: all of them must see
the surfaces and the folder. A surface that fails, or ends its worker, is a row of the table; the others go on. The exit code is 0 where
each surface has a mesh without fault or difference, else 1.

Needs `pip install quadmosaic distributed`, on each worker too.
"""

from __future__ import annotations

import argparse
import csv
import os
import re
import socket
import sys
import time
import warnings
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Optional

import quadmosaic


@dataclass
class Row:
    """What became of a surface."""

    surface: str
    mesh: str = ""
    """The file of the mesh; empty where there is none."""
    status: str = "failed"
    """ok; wrong: the mesh has a fault or a difference; failed: there is no mesh."""
    message: str = ""
    vertices: int = 0
    quads: int = 0
    triangles: int = 0
    qr: Optional[float] = None
    seconds: float = 0.0
    worker: str = ""


def read(surface: str) -> quadmosaic.Surface:
    """A file, or example:NAME or example:NAME:TRIANGLES."""
    kind, *rest = surface.split(":")
    return quadmosaic.example(rest[0], *map(int, rest[1:])) if kind == "example" else quadmosaic.load(surface)


def mesh_one(surface: str, path: str, options: dict[str, Any]) -> Row:
    """Meshes a surface on one thread and writes the mesh; a failure is a row too."""
    warnings.simplefilter("ignore", quadmosaic.MeshWarning)
    started = time.perf_counter()
    row = Row(surface, worker=f"{socket.gethostname()}:{os.getpid()}")
    try:
        result = quadmosaic.mesh(read(surface), backend="cpu", threads=1, **options)
        quadmosaic.save(path, result)
        faults, differences = result.report["faults"]["list"], result.report["differences"]
        row.mesh, row.status = path, "wrong" if faults or differences else "ok"
        row.message = f"faults: {len(faults)}, differences: {len(differences)}" if faults or differences else ""
        row.vertices, row.quads, row.triangles = len(result.vertices), len(result.quads), len(result.triangles)
        row.qr = result.report["mesh"]["qr"]
    except Exception as error:
        row.message = str(error)
    row.seconds = time.perf_counter() - started
    return row


def parsed(description: Optional[str], scheduler: str) -> argparse.Namespace:
    """The arguments; `scheduler` says what --scheduler names."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("surfaces", nargs="*", help="files or examples")
    parser.add_argument("--list", type=Path, help="a file of more surfaces, one a line")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the folder of the meshes and of results.csv")
    parser.add_argument("--to", default="obj", help="the format of the meshes")
    parser.add_argument("--points", help="the wanted number of vertices")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="any option of quadmosaic.mesh")
    parser.add_argument("--scheduler", help=scheduler)
    parser.add_argument("--workers", type=int, default=2, help="workers on this machine, without --scheduler")
    arguments = parser.parse_args()
    if not arguments.surfaces and arguments.list is None:
        parser.error("there is no surface: name some, or a --list of them")
    return arguments


def jobs(arguments: argparse.Namespace) -> list[tuple[str, str, dict[str, Any]]]:
    """The arguments of `mesh_one` for each surface; each mesh has a name of its own."""
    surfaces: list[str] = list(arguments.surfaces)
    if arguments.list is not None:
        surfaces += [line for line in map(str.strip, arguments.list.read_text().splitlines()) if line]
    options: dict[str, Any] = dict(pair.split("=", 1) for pair in arguments.set)
    if arguments.points is not None:
        options["points"] = arguments.points
    folder: Path = arguments.output.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    names = [f"{number:04}_{re.sub('[^A-Za-z0-9_-]', '_', Path(it).stem)}" for number, it in enumerate(surfaces)]
    places = [it if it.startswith("example:") else str(Path(it).absolute()) for it in surfaces]
    return [(place, str(folder / f"{name}.{arguments.to}"), options) for place, name in zip(places, names)]


def collected(done: Iterable[tuple[int, Row]], folder: Path, begun: float) -> int:
    """Prints rows as they come, writes the table in the order of the surfaces, and returns the exit code."""
    rows: dict[int, Row] = {}
    for number, row in done:
        rows[number] = row
        what = row.message or f"{row.vertices} vertices in {row.seconds:.2f} s"
        print(f"{row.status:6} {row.surface}: {what}", flush=True)
    table = folder / "results.csv"
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Row)])
        writer.writeheader()
        writer.writerows(asdict(rows[number]) for number in sorted(rows))
    took, sound = time.perf_counter() - begun, sum(row.status == "ok" for row in rows.values())
    print(f"{len(rows)} surfaces, {sound} meshes without fault, {len(rows) / took:.2f} a second, {table}")
    return 0 if sound == len(rows) else 1


def main() -> int:
    from distributed import Client, LocalCluster, as_completed

    arguments = parsed(__doc__, "the address of a Dask scheduler")
    todo = jobs(arguments)
    local = None
    if arguments.scheduler is None:
        local = LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
    try:
        with Client(arguments.scheduler if local is None else local) as client:
            begun = time.perf_counter()
            # Not pure: a mesh is a file too, which may have been deleted since.
            futures = {client.submit(mesh_one, *job, pure=False): number for number, job in enumerate(todo)}

            def row(future: Any, number: int) -> Row:
                error = future.exception()
                return future.result() if error is None else Row(todo[number][0], message=repr(error))

            done = ((futures[future], row(future, futures[future])) for future in as_completed(futures))
            return collected(done, arguments.output, begun)
    finally:
        if local is not None:
            local.close()


if __name__ == "__main__":
    sys.exit(main())
