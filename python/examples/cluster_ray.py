"""Meshes many surfaces on a Ray cluster, with a table of results: as cluster.py does on Dask.

    python cluster_ray.py parts/*.stl --points 2000 -o meshes                    two workers on this machine
    python cluster_ray.py --list parts.txt --scheduler auto -o meshes            those of a cluster

Needs `pip install quadmosaic ray`, on each worker too.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator

import cluster
import ray


def main() -> int:
    arguments = cluster.parsed(__doc__, "the address of a Ray cluster")
    todo = cluster.jobs(arguments)
    local = {"num_cpus": arguments.workers, "include_dashboard": False} if arguments.scheduler is None else {}
    ray.init(address=arguments.scheduler or "local", logging_level="warning", **local)
    # Workers have no cluster.py.
    ray.cloudpickle.register_pickle_by_value(cluster)
    mesh_one = ray.remote(cluster.mesh_one)
    begun = time.perf_counter()
    futures = {mesh_one.remote(*job): number for number, job in enumerate(todo)}

    def done() -> Iterator[tuple[int, cluster.Row]]:
        left = list(futures)
        while left:
            (first,), left = ray.wait(left)
            number = futures[first]
            try:
                yield number, ray.get(first)
            except ray.exceptions.RayError as error:
                yield number, cluster.Row(todo[number][0], message=repr(error))

    return cluster.collected(done(), arguments.output, begun)


if __name__ == "__main__":
    sys.exit(main())
