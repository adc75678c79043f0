"""What memory watching an arm for a day takes, hour by hour.

    python3 benches/watch_day.py [--rate 500] [--hours 24] [--armtwin target/release/armtwin] > docs/watched-day.md

A scenario is simulated with sixteen seeds; every row of the day is drawn from one of them, so that noise is as
fresh as sensors make it. The rows are written to a file (about 10 GB for a day at 125 Hz), which
`armtwin watch --follow` reads line by line, as it does while a file grows. Needs Linux and no package.
"""

from __future__ import annotations

import argparse
import random
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = ROOT / "scenarios" / "ur5_friction.toml"
SEEDS = 16
#: Between two times through, s: longer than what is bridged, as on an arm that waits for its next part.
REST_S = 2.0
EVERY_HOURS = 2


def run(armtwin: Path, *words: str) -> None:
    subprocess.run([armtwin, *words], check=True, stdout=subprocess.DEVNULL)


def numbers(csv: Path) -> tuple[str, list[str]]:
    """The header, and rows without their time."""
    header, *rows = csv.read_text().splitlines()
    return header, [row.split(",", 1)[1] for row in rows]


def write_day(path: Path, drawn: list[list[str]], header: str, rate_hz: float, hours: float) -> int:
    """Rows in all."""
    rng, written, begins = random.Random(1), 0, 0.0
    length = len(drawn[0])
    with path.open("w") as out:
        out.write(header + "\n")
        while begins < 3600 * hours:
            picks = rng.choices(drawn, k=length)
            out.writelines(f"{begins + k / rate_hz:.4f},{pick[k]}\n" for k, pick in enumerate(picks))
            begins += length / rate_hz + REST_S
            written += length
    return written


def resident_mb(pid: int) -> float:
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return float("nan")


def bytes_read(pid: int) -> int:
    return int(Path(f"/proc/{pid}/io").read_text().split()[1])


def main() -> None:
    asks = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    asks.add_argument("--rate", type=float, default=125.0, help="rows per second")
    asks.add_argument("--hours", type=float, default=24.0)
    asks.add_argument("--armtwin", type=Path, default=ROOT / "target" / "release" / "armtwin")
    asked = asks.parse_args()
    with tempfile.TemporaryDirectory(prefix="watched-day-") as name:
        folder = Path(name)
        scenario = folder / "scenario.toml"
        scenario.write_text(re.sub(r"(?m)^rate_hz = \d+", f"rate_hz = {asked.rate}", SCENARIO.read_text()))
        for seed in range(SEEDS):
            run(asked.armtwin, "simulate", str(scenario), "--seed", str(seed), "--out", str(folder / f"{seed}"))
        first = folder / "0" / "fit.csv"
        run(asked.armtwin, "identify", str(first), "--save-twin", str(folder / "twin.toml"))
        drawn = [numbers(folder / f"{seed}" / "fit.csv") for seed in range(SEEDS)]
        day = folder / "day.csv"
        rows = write_day(day, [rows for _, rows in drawn], drawn[0][0], asked.rate, asked.hours)
        last = (3600 * asked.hours) // 1
        words = ["watch", "--twin", folder / "twin.toml", "--from", day, "--follow", "--rate", f"{asked.rate}"]
        words += ["--fitted-on", first, "--history", folder / "watched", "--seconds", f"{last - 1}"]
        watching = subprocess.Popen([asked.armtwin, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        size, table, due, seen = day.stat().st_size, [], 0.0, 0.0
        while watching.poll() is None:
            try:
                hour = asked.hours * bytes_read(watching.pid) / size
                seen = resident_mb(watching.pid)
            except (FileNotFoundError, ProcessLookupError, IndexError):
                break
            if hour >= due + 0.02:
                table.append((due, seen))
                due += EVERY_HOURS
            time.sleep(0.05)
        assert watching.stderr is not None
        said = watching.stderr.read().decode()
        if watching.wait() != 0:
            sys.exit(said)
        table.append((asked.hours, seen))
    print("# A day of watching\n")
    print(f"Printed by `python3 benches/watch_day.py --rate {asked.rate:g} --hours {asked.hours:g}`: memory that")
    print(f"`armtwin watch` holds while it goes through {rows} rows of six joints at {asked.rate:g} Hz, as fast as")
    print("it can, with its history.\n")
    print("| hour | MB |")
    print("| ---: | ---: |")
    for hour, held in table:
        print(f"| {hour:g} | {held:.0f} |")


if __name__ == "__main__":
    main()
