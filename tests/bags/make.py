"""Writes the bags beside this file with the packages people use (pip install mcap
mcap-ros2-support rosbags pyarrow), from a recording simulated by `armtwin simulate`:

    armtwin simulate scenarios/ur5_friction.toml --out friction
    python tests/bags/make.py friction/fit.csv tests/bags

24 samples of it, joints in the driver's alphabetical order under a prefix (in another order in every
message of shuffled.mcap), calendar stamps, current as effort, other topics between them. expected.csv
holds the same samples as they should be read.
"""

import csv
import random
import shutil
import sys
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
===
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
===
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
""".replace("===", "=" * 80)
STRING = "string data\n"

UR = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
NAMES = [f"left_{name}_joint" for name in UR]
ORDER = sorted(range(6), key=lambda j: NAMES[j])
FIRST_NS = 1_700_000_000_123_456_789
LATENCY_NS = 350_000
SIGNALS = ["actual_q", "actual_qd", "actual_current"]


def main(source, out):
    out.mkdir(exist_ok=True)
    samples = pick(source)
    with open(out / "expected.csv", "w", newline="\n") as file:
        names = [f"{signal}_{j}" for signal in SIGNALS for j in range(6)]
        file.write(",".join(["timestamp", *names]) + "\n")
        for ns, *values in samples:
            cells = [f"{ns / 1e9!r}", *(repr(float(v)) for row in values for v in row)]
            file.write(",".join(cells) + "\n")
    mcap(out / "lz4.mcap", samples, CompressionType.LZ4)
    mcap(out / "zstd.mcap", samples, CompressionType.ZSTD)
    mcap(out / "plain.mcap", samples, CompressionType.NONE)
    mcap(out / "shuffled.mcap", samples, CompressionType.ZSTD, order=random.Random(1))
    mcap(out / "two_topics.mcap", samples[:3], CompressionType.ZSTD, ["/a/joint_states", "/b/joint_states"])
    mcap(out / "no_joint_states.mcap", samples[:3], CompressionType.ZSTD, [])
    rosbag(out / "folder_sqlite", samples, StoragePlugin.SQLITE3)
    shutil.copy(out / "folder_sqlite" / "folder_sqlite.db3", out / "rosbags.db3")
    rosbag(out / "folder_mcap", samples, StoragePlugin.MCAP)
    rosbag(out / "folder_packed", samples, StoragePlugin.MCAP, CompressionMode.MESSAGE)
    rosbag(out / "folder_packed_sqlite", samples, StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    split(out / "folder_split", samples)
    parquet(out / "pyarrow.parquet", samples)


def pick(source):
    """(ns from the start, q, qd, current) of 24 samples."""
    with open(source) as file:
        rows = list(csv.DictReader(file))
    at = np.linspace(0, len(rows) - 1, 24).astype(int)
    start = float(rows[0]["timestamp"])
    read = lambda row, signal: np.array([float(row[f"{signal}_{j}"]) for j in range(6)])
    stamp = lambda row: round((float(row["timestamp"]) - start) * 1e9)
    return [(stamp(rows[k]), *(read(rows[k], signal) for signal in SIGNALS)) for k in at]


def message(ns, signals, order=ORDER):
    stamp = FIRST_NS + ns
    q, qd, current = ([float(values[j]) for j in order] for values in signals)
    return {
        "header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": "base"},
        "name": [NAMES[j] for j in order],
        "position": q,
        "velocity": qd,
        "effort": current,
    }


def mcap(path, samples, compression, topics=("/joint_states",), order=None):
    with open(path, "wb") as file:
        with McapWriter(file, chunk_size=2048, compression=compression) as writer:
            state = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
            text = writer.register_msgdef("std_msgs/msg/String", STRING)
            for k, (ns, *signals) in enumerate(samples):
                at = FIRST_NS + ns + LATENCY_NS
                writer.write_message("/rosout", text, {"data": f"step {k}"}, log_time=at)
                joints = order.sample(ORDER, 6) if order else ORDER
                for topic in topics:
                    content = message(ns, signals, joints)
                    writer.write_message(topic, state, content, log_time=at, sequence=k)
                if "/joint_states" in topics and k % 8 == 0:
                    grip = message(ns, signals) | {"name": ["left_gripper_joint"]}
                    grip |= {"position": [0.5], "velocity": [], "effort": []}
                    writer.write_message("/joint_states", state, grip, log_time=at + 1)


def rosbag(path, samples, storage, packed=None):
    shutil.rmtree(path, ignore_errors=True)
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    bag = BagWriter(path, version=8, storage_plugin=storage)
    if packed:
        bag.set_compression(packed, CompressionFormat.ZSTD)
    with bag:
        topic = bag.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
        for ns, *signals in samples:
            m = message(ns, signals)
            stamp = types["builtin_interfaces/msg/Time"](**m["header"]["stamp"])
            header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="base")
            arrays = {f: np.array(m[f]) for f in ("position", "velocity", "effort")}
            state = types["sensor_msgs/msg/JointState"](header=header, name=m["name"], **arrays)
            data = store.serialize_cdr(state, "sensor_msgs/msg/JointState")
            bag.write(topic, FIRST_NS + ns + LATENCY_NS, data)


def split(path, samples):
    """In two files, as rosbag2 does with long bags, and without metadata.yaml."""
    shutil.rmtree(path, ignore_errors=True)
    path.mkdir()
    for number, part in enumerate([samples[:12], samples[12:]]):
        rosbag(path / "part", part, StoragePlugin.MCAP)
        shutil.move(path / "part" / "part.mcap", path / f"run_{number}.mcap")
        shutil.rmtree(path / "part")


def parquet(path, samples):
    """As pandas would: RTDE names, 32-bit temperatures, a text column, time in calendar ns."""
    columns = {"timestamp": pyarrow.array([ns for ns, *_ in samples], pyarrow.duration("ns"))}
    for k, signal in enumerate(SIGNALS):
        for j in range(6):
            columns[f"{signal}_{j}"] = [float(s[k + 1][j]) for s in samples]
    columns["joint_temperatures_0"] = pyarrow.array([30 + i for i in range(len(samples))], pyarrow.int32())
    for j in range(1, 6):
        columns[f"joint_temperatures_{j}"] = pyarrow.array([25.5] * len(samples), pyarrow.float32())
    columns["note"] = ["a"] * len(samples)
    pyarrow.parquet.write_table(pyarrow.table(columns), path, compression="snappy")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
