"""The jobs: what they say, how they are followed, ended, pickled, and run beside each other."""

from __future__ import annotations

import copy
import json
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import armtwin as at


def test_identification_has_values_with_intervals(twin: at.Twin, sim: at.Simulation, tmp_path: Path) -> None:
    fit = at.identify(twin, sim.fit, check=sim.check, include=["payload"], methods=["nlse"])
    coulomb = fit["joint 2"].coulomb
    assert coulomb.unit == "N.m" and coulomb.low < coulomb.value < coulomb.high
    assert abs(coulomb.value - 7) < 0.7
    mass = next(p for p in fit.arm if p.name == "payload_mass")
    assert abs(mass.value - 2) < 0.2
    with pytest.raises(KeyError, match="joint 1 to joint 6"):
        fit["joint 7"]
    with pytest.raises(AttributeError, match="no parameter stribeck"):
        fit["joint 2"].stribeck
    assert fit.to_dict()["schema"] == "armtwin.identification/1"
    assert fit.to_pandas().shape[0] == len(fit.table)
    assert "<table>" in fit._repr_html_() and "joint" in repr(fit)
    predicted = fit.predict(sim.check)
    assert predicted.torque.shape == predicted.measured.shape == predicted.slides.shape
    assert max(predicted.rms_nm()) < 3.0
    for name in ("fit.json", "fit.html", "fit.toml"):
        fit.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 100
    saved = at.Twin.load(tmp_path / "fit.toml")
    assert saved.values.keys() == fit.twin.values.keys()
    for name, values in fit.twin.values.items():
        np.testing.assert_array_equal(saved.values[name], values)
    # Least squares' mass beside the model's links: what is told beside uncertain ones holds it.
    assert mass.low < saved.values["payload_mass"][0] < mass.high
    np.testing.assert_array_equal(at.predict(saved, sim.check).torque, predicted.torque)
    with pytest.raises(at.InputError, match="end the name in"):
        fit.save(tmp_path / "fit.xlsx")


def test_a_diagnosis_names_the_hidden_effect(dx: at.Diagnosis, tmp_path: Path) -> None:
    assert dx.causes[0].effect == "payload", dx.sentence
    assert dx.causes[0].effect in dx.sentence and dx.sentence in repr(dx)
    assert dx.shrink.after_nm < dx.shrink.before_nm
    assert len(dx.gap.joints) == 6 and "rms_nm" in repr(dx.gap.table)
    assert dx.to_dict()["causes"][0]["parameters"][0]["value"] == dx.causes[0].parameters[0].value
    assert abs(sum(row[2] for row in dx.ranking) - 1) < 1e-6
    trace = dx.traces[0]
    assert trace.t.shape == trace.before.shape == trace.after.shape
    for name in ("dx.json", "dx.html", "dx.rrd", "dx.toml"):
        dx.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 100
    mended = at.Twin.load(tmp_path / "dx.toml")
    assert "payload" in mended.effects


def test_wishes_that_make_no_sense_are_refused(twin: at.Twin, sim: at.Simulation) -> None:
    for wrong, says in [
        ({"without": ["payloat"]}, "payloat: no such effect"),
        ({"mass_error": 7.0}, "mass_error 7"),
        ({"check": sim.fit}, "same samples"),
        ({"signals": at.Signals(margin_s=100.0)}, "s"),
    ]:
        with pytest.raises(at.InputError, match=says):
            at.diagnose(twin, sim.fit, **wrong)
    for wrong, says in [
        ({"terms": ["nothing"]}, "no term `nothing`"),
        ({"methods": ["magic"]}, "choose from pso, nlse, mcmc"),
        ({"include": ["inertia", "payload"]}, "leave `payload`"),
        ({"bounds": {"viscous": (2.0, 1.0)}}, "viscous"),
        ({"payload": 2.0}, "go together"),
    ]:
        with pytest.raises(at.InputError, match=says):
            at.identify(twin, sim.fit, **wrong)
    with pytest.raises(at.InputError, match="no effect payloat"):
        at.simulate(twin, effects={"payloat": {"mass": 1}})


def test_what_contradicts_itself_is_doubted_and_may_be_forced(twin: at.Twin, sim: at.Simulation) -> None:
    milli = at.Recording(sim.fit.t, sim.fit.q, qd=sim.fit["qd"], current=1000 * sim.fit["current"])
    with pytest.raises(at.DoubtfulRecording, match="force=True"):
        at.identify(twin, milli)
    with pytest.warns(UserWarning, match="recording"):
        at.identify(twin, milli, force=True, methods=["nlse"])


def test_an_arm_without_gains_wants_torque(sim: at.Simulation) -> None:
    arm = at.Twin.from_urdf("ur10e")
    current = at.Recording(sim.fit.t, sim.fit.q, current=sim.fit["current"])
    with pytest.raises(at.InputError, match="no torque constants"):
        at.identify(arm, current)


def test_progress_is_told_in_the_calling_thread_and_may_end_the_work(twin: at.Twin, sim: at.Simulation) -> None:
    told: list[tuple[str, int, int]] = []
    here = threading.get_ident()

    def listen(doing: str, done: int, of: int) -> None:
        assert threading.get_ident() == here
        told.append((doing, done, of))

    at.identify(twin, sim.fit, progress=listen)
    assert told[-1] == ("fitting joint", 12, 12)

    class Enough(Exception):
        pass

    def enough(doing: str, done: int, of: int) -> None:
        raise Enough

    with pytest.raises(Enough):
        at.diagnose(twin, sim.fit, check=sim.check, progress=enough)


SLEEPER = """
import signal
import sys
import armtwin as at
# A shell's background jobs ignore SIGINT, and Python then leaves it so.
signal.signal(signal.SIGINT, signal.default_int_handler)
twin = at.Twin.from_urdf("ur5", rotor_inertia=[1.1, 1.1, 1.1, 0.14, 0.14, 0.14])
sim = at.simulate(twin, at.motions.mixed(seconds=20), snr_db=30)
def told(doing, done, of):
    print("begun", flush=True)
try:
    if sys.argv[1] == "simulate":
        at.simulate(twin, at.motions.mixed(seconds=5000), progress=told)
    elif sys.argv[1] == "identify":
        at.identify(twin, sim.fit, methods=["mcmc", "pso"], direct_cost=True, progress=told)
    else:
        at.diagnose(twin, sim.fit, progress=told)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("job", ["simulate", "identify", "diagnose"])
def test_ctrl_c_ends_long_work(job: str) -> None:
    child = subprocess.Popen([sys.executable, "-c", SLEEPER, job], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    assert child.stdout.readline() == "begun\n"
    child.send_signal(signal.SIGINT)
    said, _ = child.communicate(timeout=120)
    assert said.endswith("interrupted\n")
    assert child.returncode == 0


def test_threads_find_the_same_and_do_not_wait_for_each_other(twin: at.Twin, sim: at.Simulation) -> None:
    alone = at.identify(twin, sim.fit, check=sim.check)
    running = threading.Event()
    seen = threading.Event()

    def listen(doing: str, done: int, of: int) -> None:
        running.set()
        assert seen.wait(60), "the other thread never ran while this one worked"

    def work(_: int) -> at.Identification:
        return at.identify(twin, sim.fit, check=sim.check, progress=listen)

    with ThreadPoolExecutor(3) as pool:
        jobs = [pool.submit(work, k) for k in range(3)]
        assert running.wait(60)
        seen.set()
        together = [job.result() for job in jobs]
    for fit in together:
        assert repr(fit.table) == repr(alone.table)
        assert [j.rms_nm for j in fit] == [j.rms_nm for j in alone]


@pytest.mark.parametrize("call", ["torque", "inverse_dynamics", "mass_matrix", "regressor", "Recording", "identify"])
def test_other_threads_count_on_while_the_engine_works(twin: at.Twin, sim: at.Simulation, call: str) -> None:
    array = np.random.default_rng(1).normal(size=(100_000, 6))
    time_s = np.arange(100_000) * 0.008
    work: dict[str, Callable[[], object]] = {
        "torque": lambda: twin.torque(array, array, array),
        "inverse_dynamics": lambda: twin.robot.inverse_dynamics(array, array, array),
        "mass_matrix": lambda: twin.robot.mass_matrix(array),
        "regressor": lambda: twin.robot.regressor(array[:20_000], array[:20_000], array[:20_000]),
        "Recording": lambda: at.Recording(time_s, array, current=array),
        "identify": lambda: at.identify(twin, sim.fit),
    }
    count, done = 0, threading.Event()

    def counts() -> None:
        nonlocal count
        while not done.is_set():
            count += 1
            time.sleep(0)

    usual = sys.getswitchinterval()
    thread = threading.Thread(target=counts)
    # Threads then change only where somebody lets go of the interpreter.
    sys.setswitchinterval(1000.0)
    try:
        thread.start()
        for _ in range(20):
            before = count
            work[call]()
            if count > before:
                break
        else:
            pytest.fail("no other thread ran")
    finally:
        done.set()
        sys.setswitchinterval(usual)
        thread.join()


def test_results_can_be_pickled_and_copied(
    twin: at.Twin, sim: at.Simulation, dx: at.Diagnosis, tmp_path: Path
) -> None:
    again = pickle.loads(pickle.dumps(twin))
    assert again == twin and again.to_toml() == twin.to_toml()
    recording = pickle.loads(pickle.dumps(sim.fit))
    np.testing.assert_array_equal(recording["current"], sim.fit["current"])
    assert recording.source == sim.fit.source
    fit = at.identify(twin, sim.fit, methods=["nlse"])
    back = pickle.loads(pickle.dumps(fit))
    assert back.to_dict() == fit.to_dict() and back.twin == fit.twin
    np.testing.assert_array_equal(back.predict(sim.check).torque, fit.predict(sim.check).torque)
    other = copy.deepcopy(dx)
    assert other.to_dict() == dx.to_dict() and other.mended == dx.mended
    np.testing.assert_array_equal(other.traces[2].after, dx.traces[2].after)
    for one, name in ((dx, "one"), (other, "other")):
        one.report(tmp_path / f"{name}.html")
        one.rerun(tmp_path / f"{name}.rrd")
    assert (tmp_path / "one.html").read_bytes() == (tmp_path / "other.html").read_bytes()
    sims = pickle.loads(pickle.dumps(sim))
    assert json.dumps(sims.truth) == json.dumps(sim.truth)


def test_the_catalogue_says_what_can_be_hidden() -> None:
    catalogue = at.effects()
    assert catalogue["payload"]["parameters"][0]["name"] == "payload_mass"
    assert len(catalogue) > 20


def test_a_motion_is_within_limits_and_repeats(twin: at.Twin) -> None:
    motion = at.motions.random_sines(seconds=10, seed=4, speed=0.5)
    one, two = motion.sampled(twin), motion.sampled(twin)
    np.testing.assert_array_equal(one.q, two.q)
    assert one.q.shape == (len(one.t), 6) and np.abs(one.qd).max() <= 0.5 + 1e-9
