"""Twins of MuJoCo's models have MuJoCo's dynamics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import armtwin as at

mujoco = pytest.importorskip("mujoco")

MODEL = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <body name="base" pos="0 0 0.2" quat="0.9 0.1 0.2 0.3">
      <inertial mass="4" pos="0 0 0" diaginertia="0.1 0.1 0.1"/>
      <body name="upper" pos="0.1 0 0.3" euler="0.3 -0.4 0.5">
        <joint name="shoulder" axis="0 1 0" pos="0.02 0 0.05" armature="0.5" frictionloss="3" damping="7"
               range="-2 2" limited="true"/>
        <inertial mass="3" pos="0.1 0.02 0.2" quat="0.8 0.1 0.5 0.2" diaginertia="0.05 0.04 0.02"/>
        <body name="tool_mount" pos="0 0 0.4">
          <inertial mass="0.5" pos="0 0.05 0" diaginertia="0.001 0.001 0.001"/>
          <body name="fore" pos="0.05 0 0.1" euler="1.2 0 0.2">
            <joint name="elbow" axis="1 0 0.2" armature="0.2" frictionloss="1" damping="2"/>
            <inertial mass="1.5" pos="0 0.1 0.15" diaginertia="0.02 0.02 0.01"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "arm.xml"
    path.write_text(MODEL)
    return path


def test_torque_is_that_of_mujoco(model: Path) -> None:
    arm = at.Twin.from_mjcf(model)
    assert arm.joints == ["shoulder", "elbow"]
    np.testing.assert_array_equal(arm.rotor_inertia, [0.5, 0.2])
    np.testing.assert_array_equal(arm.values["coulomb"], [3, 1])
    np.testing.assert_array_equal(arm.values["viscous"], [7, 2])
    theirs = mujoco.MjModel.from_xml_path(str(model))
    theirs.dof_frictionloss[:] = 0
    # Poses beyond the limits, which would push back.
    theirs.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    data = mujoco.MjData(theirs)
    rng = np.random.default_rng(3)
    for q, qd, qdd in rng.normal(size=(20, 3, 2)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q, qd, qdd
        mujoco.mj_inverse(theirs, data)
        expected = data.qfrc_inverse + [3, 1] * np.sign(qd)
        np.testing.assert_allclose(arm.torque(q, qd, qdd), expected, rtol=1e-9, atol=1e-9)


def test_a_model_becomes_a_twin_that_can_be_saved(model: Path, tmp_path: Path) -> None:
    arm = at.Twin.from_mjcf(model, friction="open", gains=[10, 12])
    assert arm.values == {} and arm.gains.tolist() == [10, 12]
    arm.save(tmp_path / "twin.toml")
    again = at.Twin.load(tmp_path / "twin.toml")
    q, qd, qdd = np.random.default_rng(1).normal(size=(3, 5, 2))
    np.testing.assert_allclose(again.torque(q, qd, qdd), arm.torque(q, qd, qdd), rtol=1e-12)
    with pytest.raises(at.InputError, match="no body nowhere"):
        at.Twin.from_mjcf(model, tip="nowhere")
    shorter = at.Twin.from_mjcf(model, tip="tool_mount")
    assert shorter.joints == ["shoulder"]
    model.write_text("<mujoco><worldbody/></mujoco>")
    with pytest.raises(at.InputError):
        at.Twin.from_mjcf(model)
