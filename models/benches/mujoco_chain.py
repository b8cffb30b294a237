"""MuJoCo on the chain of eight of `benches/lanes.rs`: runs of 1 s by its `rollout`, RK4 in steps of 1 ms, on one thread.

Optional: a yardstick from outside, no part of the build. Needs Python 3.11 and `pip install mujoco numpy`. Run

    python models/benches/mujoco_chain.py

right before or after `cargo bench -p benches --bench lanes -- RK4`, on the same quiet machine: a second of its group "100 steps of RK4 of a chain of
eight" is ten of these. MuJoCo is given minimal coordinates, no contacts, no limits and no sensors. The best of several passes is printed.
"""

import time

import mujoco
import numpy as np
from mujoco import rollout

RODS, STEP, STEPS, RUNS, PASSES = 8, 1e-3, 1000, 32, 5


def chain():
    """Eight slender rods on hinges, axes y and x in turn, as `Chain` of `benches/lanes.rs` has them."""
    rods = "".join(
        f'<body pos="0 0 {-1.0 if rod else -0.5}"><joint type="hinge" axis="{"1 0 0" if rod % 2 else "0 1 0"}" pos="0 0 0.5"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="0.0833 0.0833 0.001"/>'
        for rod in range(RODS))
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{STEP}" integrator="RK4" gravity="0 0 -9.81"><flag contact="disable" constraint="disable"/></option>'
        f'<worldbody>{rods}{"</body>" * RODS}</worldbody></mujoco>')


def main():
    model = chain()
    data = mujoco.MjData(model)
    start = np.zeros((RUNS, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    start[:, 1:1 + 2 * RODS] = 0.1 * np.arange(2 * RODS) - 0.5
    state = None
    best = np.inf
    for _ in range(PASSES):
        begun = time.perf_counter()
        state, _ = rollout.rollout(model, data, start, nstep=STEPS)
        best = min(best, time.perf_counter() - begun)
    print(f"MuJoCo {mujoco.__version__}: {RUNS / best:.0f} runs of {STEP * STEPS:.0f} s a second; first angles at 0.1 s {state[0, 99, 1:4]}")


if __name__ == "__main__":
    main()
