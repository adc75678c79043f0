"""Times pandas on the file `cargo bench --bench recording` leaves behind (run by hand).

    python benches/recording_pandas.py target/tmp/recording_6000x43.csv
"""
import sys
import time

import pandas

best = float("inf")
for _ in range(50):
    start = time.perf_counter()
    frame = pandas.read_csv(sys.argv[1])
    best = min(best, time.perf_counter() - start)
print(f"pandas {pandas.__version__}: {frame.shape[0]} x {frame.shape[1]} in {1e3 * best:.2f} ms")
