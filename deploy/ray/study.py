#!/usr/bin/env python3
"""Runs a study of armtwin on a Ray cluster, shard by shard.

    python3 deploy/ray/study.py scenarios/studies/detection.toml --out detection --shards 64

Every shard is one Ray task: it runs `armtwin study --shard K/N` on its node, in a folder that the
node keeps, and sends the finished cells back. No shared file system is needed, only the program on
every node. Shards that are back are not run again when the driver is started anew; Ray repeats
those whose node died. At the end the shards are merged: the tables are those of a single run.
"""

import argparse
import hashlib
import io
import pathlib
import subprocess
import sys
import tarfile
import tempfile

import ray


def shard(program, study, number, of, cpus):
    """Runs on a node: the shard's folder as a tar archive, and the node it was made on."""
    key = hashlib.sha256(f"{of} {study}".encode()).hexdigest()[:16]
    folder = pathlib.Path(tempfile.gettempdir()) / f"armtwin-{key}-{number}"
    folder.mkdir(exist_ok=True)
    file = folder / "study.toml"
    file.write_text(study)
    out = folder / "out"
    command = [program, "study", str(file), "--out", str(out)]
    command += ["--shard", f"{number}/{of}", "--jobs", str(cpus)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"shard {number}/{of}: {done.stderr.strip()}")
    archive = io.BytesIO()
    with tarfile.open(fileobj=archive, mode="w") as tar:
        tar.add(out, arcname=".")
    return archive.getvalue(), ray.get_runtime_context().get_node_id()


def unpack(archive, folder):
    """Under its final name only when whole."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as half:
        whole = pathlib.Path(half) / "shard"
        with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
            tar.extractall(whole, filter="data")
        whole.rename(folder)


def run(study, out, shards, program="armtwin", cpus=1):
    """Runs all shards that are not in `out` yet and merges; the nodes that worked."""
    text = pathlib.Path(study).read_text()
    folders = [pathlib.Path(out) / "shards" / f"{k}-of-{shards}" for k in range(1, shards + 1)]
    task = ray.remote(num_cpus=cpus, max_retries=3)(shard)
    open_tasks = {
        task.remote(program, text, k, shards, cpus): folder
        for k, folder in enumerate(folders, 1)
        if not folder.exists()
    }
    nodes = set()
    while open_tasks:
        ready, _ = ray.wait(list(open_tasks), num_returns=1)
        archive, node = ray.get(ready[0])
        unpack(archive, open_tasks.pop(ready[0]))
        nodes.add(node)
        if sys.stderr.isatty():
            print(f"\r{len(open_tasks)} of {shards} shards left ", end="", file=sys.stderr)
    merge = [program, "study", "merge", *map(str, folders), "--out", str(out)]
    subprocess.run(merge, check=True)
    return nodes


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study")
    parser.add_argument("--out", required=True)
    parser.add_argument("--shards", type=int, required=True, help="a few per core of the cluster")
    parser.add_argument("--cpus", type=int, default=1, help="of a shard")
    parser.add_argument("--armtwin", default="armtwin", help="the program, on every node")
    parser.add_argument("--address", default="auto", help="of the cluster; local: start one here")
    args = parser.parse_args()
    ray.init(address=None if args.address == "local" else args.address)
    nodes = run(args.study, args.out, args.shards, args.armtwin, args.cpus)
    print(f"{args.out}: {args.shards} shards, {len(nodes)} nodes worked")


if __name__ == "__main__":
    main()
