"""What is taken for a recording or a motion, and what is refused by name."""

from __future__ import annotations

import numpy as np
import pytest

import armtwin as at

T, N = 400, 6
RNG = np.random.default_rng(5)
TIME = np.arange(T) * 0.008
Q = np.cumsum(RNG.normal(size=(T, N)), axis=0) * 0.01
QD, QDD = RNG.normal(size=(2, T, N))


def strided(array: np.ndarray) -> np.ndarray:
    wide = np.full((array.shape[0] * 2, array.shape[1] * 3), np.nan)
    wide[::2, ::3] = array
    return wide[::2, ::3]


def test_torque_is_the_same_for_all_layouts(twin: at.Twin) -> None:
    expected = twin.torque(Q, QD, QDD)
    assert expected.shape == (T, N)
    for layout in (strided, np.asfortranarray, lambda a: a[::-1][::-1]):
        np.testing.assert_array_equal(twin.torque(layout(Q), layout(QD), layout(QDD)), expected)
    one = twin.torque(Q[7], QD[7], QDD[7])
    np.testing.assert_array_equal(one, expected[7])
    assert twin.torque(Q[:0], QD[:0], QDD[:0]).shape == (0, N)


def test_other_dtypes_are_numbers_too(twin: at.Twin) -> None:
    for dtype in (np.float32, np.float16, np.int64, np.int8, ">f8"):
        q, qd, qdd = (a.astype(dtype) for a in (Q, QD, QDD))
        wide = [a.astype(np.float64) for a in (q, qd, qdd)]
        np.testing.assert_array_equal(twin.torque(q, qd, qdd), twin.torque(*wide))
    for dtype in (np.complex128, "U3"):
        with pytest.raises(at.InputError, match="dtype"):
            twin.torque(Q.astype(dtype), QD, QDD)


def test_rigid_body_identities(twin: at.Twin) -> None:
    robot = twin.robot
    tau = robot.inverse_dynamics(Q, QD, QDD)
    np.testing.assert_allclose(robot.regressor(Q, QD, QDD) @ robot.inertial_parameters, tau, atol=1e-9)
    mass = robot.mass_matrix(Q)
    assert mass.shape == (T, N, N)
    still = np.zeros_like(QD)
    by_mass = np.einsum("tij,tj->ti", mass, QDD) + robot.gravity(Q)
    np.testing.assert_allclose(robot.inverse_dynamics(Q, still, QDD), by_mass, atol=1e-9)
    np.testing.assert_array_equal(robot.mass_matrix(Q[3]), mass[3])
    np.testing.assert_allclose(twin.torque(Q, QD, QDD), tau + QDD * twin.rotor_inertia, atol=1e-9)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"q": Q[:, 0]}, r"q has the shape \(400,\)"),
        ({"q": Q[None]}, r"q has the shape \(1, 400, 6\)"),
        ({"qd": QD[:-1]}, r"qd has the shape \(399, 6\)"),
        ({"current": QD[:, :5]}, r"current has the shape \(400, 5\)"),
        ({"t": TIME[::-1]}, "goes backwards"),
        ({"t": np.zeros(T)}, "repeats"),
        ({"names": ["a", "b"]}, "2 names for 6 joints"),
        ({"columns": {"tool": np.zeros(3)}}, "tool has 3 samples, time has 400"),
    ],
)
def test_recordings_that_are_none_are_refused(wrong: dict, says: str) -> None:
    with pytest.raises(at.InputError, match=says):
        at.Recording(**{"t": TIME, "q": Q, "qd": QD, "current": QDD, **wrong})


def test_wrong_shapes_of_a_motion_are_named(twin: at.Twin) -> None:
    with pytest.raises(at.InputError, match=r"qd has the shape \(399, 6\), \(400, 6\) is needed"):
        twin.torque(Q, QD[1:], QDD)
    with pytest.raises(at.InputError, match=r"q has the shape \(400, 5\)"):
        twin.robot.mass_matrix(Q[:, :5])


def test_few_rows_without_a_number_go_and_many_are_refused() -> None:
    holes = Q.copy()
    holes[[50, 90], [2, 4]] = np.nan
    recording = at.Recording(TIME, holes, current=QDD)
    assert len(recording) == T - 2
    assert "dropped 2 row(s)" in recording.notes[0]
    np.testing.assert_array_equal(recording["current"], np.delete(QDD, [50, 90], axis=0))
    holes[100:200, 3] = np.inf
    with pytest.raises(at.InputError, match=r"no number .* actual_q_3|actual_q_2"):
        at.Recording(TIME, holes, current=QDD)


def test_a_recording_gives_back_what_it_got(tmp_path) -> None:
    recording = at.Recording(TIME, strided(Q), qd=QD.astype(np.float32), current=QDD, columns={"tool": TIME})
    np.testing.assert_array_equal(recording.t, TIME)
    np.testing.assert_array_equal(recording.q, Q)
    np.testing.assert_array_equal(recording["actual_qd"], QD.astype(np.float32))
    np.testing.assert_array_equal(recording["tool"], TIME)
    assert "tool" in recording and "temperature" not in recording
    for name in ("a.csv", "a.csv.gz", "a.parquet", "a.mcap"):
        recording.save(tmp_path / name)
        np.testing.assert_array_equal(at.read(tmp_path / name).q, Q)
    frame = recording.to_pandas()
    again = at.Recording.from_pandas(
        frame, q=[f"actual_q_{j}" for j in range(N)], current=[f"actual_current_{j}" for j in range(N)]
    )
    np.testing.assert_array_equal(again["current"], QDD)
    with pytest.raises(at.InputError, match="no column nowhere"):
        at.Recording.from_pandas(frame, q=["nowhere"])


def test_names_put_columns_in_order_and_must_match(twin: at.Twin, sim: at.Simulation) -> None:
    order = [3, 0, 5, 1, 4, 2]
    names = [twin.joints[j] for j in order]
    q, qd, current = (sim.fit[key] for key in ("q", "qd", "current"))
    shuffled = at.Recording(sim.fit.t, q[:, order], qd=qd[:, order], current=current[:, order], names=names)
    plain = at.Recording(sim.fit.t, q, qd=qd, current=current)
    by_name = at.identify(twin, shuffled, methods=["nlse"])
    assert repr(by_name.table) == repr(at.identify(twin, plain, methods=["nlse"]).table)
    other = at.Recording(sim.fit.t, q, current=current, names=[*twin.joints[:5], "elbow"])
    with pytest.raises(at.InputError, match="its joints are .*elbow.*those of ur5 are"):
        at.identify(twin, other)


def test_another_number_of_joints_is_another_arm(twin: at.Twin) -> None:
    with pytest.raises(at.InputError, match="it has 5 joints, the ur5 has 6"):
        at.identify(twin, at.Recording(TIME, Q[:, :5], current=QDD[:, :5]))
