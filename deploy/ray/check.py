#!/usr/bin/env python3
"""Checks study.py on a cluster of two nodes on this machine: check.py ARMTWIN STUDY OUT.

Both nodes must have worked, a second start must have nothing left to do, and OUT then holds the
merged tables, to be compared with those of a single run.
"""

import pathlib
import sys

import ray
from ray.cluster_utils import Cluster

import study


def main():
    program, file, out = sys.argv[1:]
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address)
    nodes = study.run(file, out, 4, program)
    assert len(nodes) == 2, f"{len(nodes)} of 2 nodes worked"
    before = (pathlib.Path(out) / "cells.parquet").read_bytes()
    assert not study.run(file, out, 4, program), "finished shards were run again"
    assert (pathlib.Path(out) / "cells.parquet").read_bytes() == before
    ray.shutdown()
    cluster.shutdown()
    print("two nodes worked")


if __name__ == "__main__":
    main()
