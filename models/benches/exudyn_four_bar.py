"""Exudyn on the four-bars of `benches/joints`: time of a step, and how many steps keep the first crank within 1e-6 rad.

Optional: a yardstick from outside, no part of the build. Needs Python 3.11 and `pip install exudyn numpy`. Run

    python models/benches/exudyn_four_bar.py

right before or after `cargo bench -p benches --bench joints`, on the same quiet machine. Four-bars are two-dimensional bodies on revolute
joints in the plane, the smallest model Exudyn has of them, by its trapezoidal rule on the index 2 equations; the linear solver and the kind
of Newton iteration are the best of four. The best of several runs is printed.
"""

import itertools
import time

import exudyn as exu
import exudyn.itemInterface as item
import numpy as np

GRAVITY = 9.81


def n_four_bar(loops):
    """IFToMM A02: `loops` windows of rods of 1 m and 1 kg between `loops` + 1 cranks; all cranks start upright, at -1 rad/s."""
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    ground = mbs.AddObject(item.ObjectGround())
    body = {}

    def rod(x, y, angle, velocity, rate):
        node = mbs.AddNode(
            item.NodeRigidBody2D(
                referenceCoordinates=[x, y, angle],
                initialVelocities=[velocity[0], velocity[1], rate],
            )
        )
        made = mbs.AddObject(
            item.ObjectRigidBody2D(mass=1.0, inertia=1.0 / 12.0, nodeNumber=node)
        )
        centre = mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=made, localPosition=[0, 0, 0]))
        mbs.AddLoad(item.Force(markerNumber=centre, loadVector=[0, -GRAVITY, 0]))
        return node, made

    def pin(one, at_one, other, at_other):
        markers = [
            mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=number, localPosition=place))
            for number, place in ((one, at_one), (other, at_other))
        ]
        mbs.AddObject(item.RevoluteJoint2D(markerNumbers=markers))

    left, right = [-0.5, 0, 0], [0.5, 0, 0]
    cranks = [rod(i, 0.5, np.pi / 2, (0.5, 0.0), -1.0) for i in range(loops + 1)]
    couplers = [rod(i + 0.5, 1.0, 0.0, (1.0, 0.0), 0.0) for i in range(loops)]
    for i, (_, crank) in enumerate(cranks):
        pin(ground, [float(i), 0, 0], crank, left)
    for i, (_, coupler) in enumerate(couplers):
        pin(cranks[i][1], right, coupler, left)
        pin(coupler, right, cranks[i + 1][1], right)
    mbs.Assemble()
    return mbs, cranks[0][0]


def settings(steps, step, solver, modified):
    made = exu.SimulationSettings()
    made.timeIntegration.numberOfSteps = steps
    made.timeIntegration.endTime = steps * step
    made.timeIntegration.verboseMode = 0
    made.timeIntegration.newton.useModifiedNewton = modified
    made.solution.file.write = False
    made.solution.sensors.writePeriod = 1e9
    made.linearSolver.solverType = solver
    made.parallel.numberOfThreads = 1
    return made


def run(loops, steps, step, solver, modified):
    mbs, crank = n_four_bar(loops)
    begin = time.perf_counter()
    mbs.SolveDynamic(
        settings(steps, step, solver, modified),
        solverType=exu.DynamicSolverType.TrapezoidalIndex2,
        storeSolver=False,
    )
    spent = time.perf_counter() - begin
    return spent, mbs.GetNodeOutput(crank, exu.OutputVariableType.Coordinates)[2]


def four_bars():
    choices = list(
        itertools.product(
            (exu.LinearSolverType.EXUdense, exu.LinearSolverType.EigenSparse), (False, True)
        )
    )
    # 0.4 s: the cranks do not yet pass their flat position, where every solver of the plain rows fails.
    for loops in (1, 10):
        step, steps = 1e-4, 4000
        best = {
            choice: min(
                # The difference of two lengths of run leaves out what is done once.
                (run(loops, steps, step, *choice)[0] - run(loops, steps // 2, step, *choice)[0])
                / (steps - steps // 2)
                for _ in range(3)
            )
            for choice in choices
        }
        choice = min(best, key=best.get)
        fine = run(loops, 16000, 0.4 / 16000, *choice)[1]
        for count in (20, 40, 80, 160, 240, 320, 400, 640, 1000, 2000):
            error = abs(run(loops, count, 0.4 / count, *choice)[1] - fine)
            if error <= 1e-6:
                break
        print(
            f"{loops} four-bars: {best[choice] * 1e6:.1f} us a step; {count} steps to 0.4 s leave the first crank off by "
            f"{error:.1e} rad: {best[choice] * 1e6 * count / 0.4:.0f} us per simulated second ({choice})"
        )


if __name__ == "__main__":
    four_bars()
