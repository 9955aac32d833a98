"""The examples for many machines: Dask, and the script for SLURM in docs/cluster.md."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Optional

import pytest

import quadmosaic

PYTHON = Path(__file__).resolve().parents[1]


def table(path: Path) -> dict[str, dict[str, str]]:
    with path.open(newline="") as file:
        return {Path(row["surface"]).name: row for row in csv.DictReader(file)}


def faulty(folder: Path) -> Path:
    path = folder / "bad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n")
    return path


def run(*command: str, env: Optional[dict[str, str]] = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=env)


@pytest.mark.filterwarnings("ignore::quadmosaic.MeshWarning")
def test_dask_meshes_all_surfaces_but_the_one_that_fails(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="distributed is not installed (pip install distributed)")
    script, output = str(PYTHON / "examples" / "cluster.py"), tmp_path / "meshes"
    surfaces = ["example:torus:900", str(faulty(tmp_path)), "example:plate:600", "example:cone"]
    done = run(sys.executable, script, *surfaces, "--points", "200", "--set", "quads=all", "-o", str(output))
    assert done.returncode == 1 and "4 surfaces, 2 meshes without fault" in done.stdout, done.stderr
    rows = table(output / "results.csv")
    assert [row["status"] for row in rows.values()] == ["ok", "failed", "ok", "failed"]
    assert "line 3" in rows["bad.obj"]["message"] and "no example surface" in rows["example:cone"]["message"]
    for name in ("torus:900", "plate:600"):
        row, alone = rows[f"example:{name}"], tmp_path / "alone.obj"
        example, triangles = name.split(":")
        result = quadmosaic.mesh(quadmosaic.example(example, int(triangles)), points=200, backend="cpu", quads="all")
        quadmosaic.save(alone, result)
        assert Path(row["mesh"]).read_bytes() == alone.read_bytes() and int(row["vertices"]) == len(result.vertices)
    done = run(sys.executable, script, "-o", str(output))
    assert done.returncode == 2 and "there is no surface" in done.stderr
    # Without the two that fail it is a success.
    done = run(sys.executable, script, surfaces[0], "--points", "200", "-o", str(output))
    assert done.returncode == 0 and len(table(output / "results.csv")) == 1, done.stderr


@pytest.mark.skipif(os.name == "nt", reason="a script for bash")
def test_the_tasks_of_slurm_share_the_list(tmp_path: Path) -> None:
    text = (PYTHON.parent / "docs" / "cluster.md").read_text()
    found = re.search(r"```bash\n(#!/bin/bash\n#SBATCH.*?)```", text, re.DOTALL)
    assert found is not None
    script = tmp_path / "array.sh"
    script.write_text(found[1])
    surfaces = ["example:torus:900", str(faulty(tmp_path)), "example:plate:600"]
    (tmp_path / "parts.txt").write_text("\n".join(surfaces) + "\n")
    paths = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = []
    for task in ("0", "1"):
        slurm = {"SLURM_ARRAY_TASK_ID": task, "SLURM_ARRAY_TASK_COUNT": "2", "SLURM_CPUS_PER_TASK": "1"}
        command = ["bash", "-c", f"cd '{tmp_path}' && bash array.sh"]
        done.append(run(*command, env={**os.environ, "PATH": paths, **slurm}))
    # The faulty surface fails its task alone.
    assert [task.returncode for task in done] == [0, 1], [task.stderr for task in done]
    rows = [table(tmp_path / "meshes" / task / "results.csv") for task in ("0", "1")]
    assert [list(of_task) for of_task in rows] == [["example:torus:900", "example:plate:600"], ["bad.obj"]]
    assert rows[0]["example:plate:600"]["status"] == "ok" and rows[1]["bad.obj"]["status"] == "failed"
