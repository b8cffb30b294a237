"""Robots as people have them, read by `mbd` and by Pinocchio: joint accelerations from the same states. For developers; nothing of it runs in CI.

    pip install pin example-robot-data
    cargo build --release
    python tests/scripts/robots.py target/release/mbd                  # the table of all robots of example-robot-data
    python tests/scripts/robots.py target/release/mbd human icub       # of these alone
    python tests/scripts/robots.py target/release/mbd --reference      # writes tests/reference/robots/urdf_*.json
    python tests/scripts/robots.py target/release/mbd --store          # the table, and tests/reference/robots/example_robot_data.csv

Damping, friction and `mimic` are taken out of a copy of each file first: Pinocchio leaves them out of its accelerations.
"""

import csv, json, math, random, re, subprocess, sys, tempfile
import xml.etree.ElementTree as xml
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent.parent
OWN = HERE.parent / "mbd-macros/compiler/tests/urdf"


def plain(path, folder):
    """A copy without damping, friction and mimic."""
    tree = xml.parse(path)
    for joint in tree.getroot().iter("joint"):
        for name in ("dynamics", "mimic"):
            for element in joint.findall(name):
                joint.remove(element)
    copy = Path(folder) / "robot.urdf"
    tree.write(copy)
    return copy


def moving(path):
    """Names and kinds of the joints that move, in the order of the file."""
    joints = xml.parse(path).getroot().findall("joint")
    return [(j.get("name"), j.get("type")) for j in joints if j.get("type") != "fixed"]


def model_of(path, free):
    if free:
        return pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    return pin.buildModelFromUrdf(str(path))


def state(joints, seed):
    """Coordinate and rate of every joint [rad, rad/s; m, m/s]."""
    dice = random.Random(seed)
    values = {}
    for name, kind in joints:
        scale = 0.1 if kind == "prismatic" else 1.0
        values[name] = [round(scale * dice.uniform(-1, 1), 3) for _ in range(2)]
    return values


def by_pinocchio(model, values):
    """Accelerations of the joints without joint forces, the base (if free) at rest at the origin."""
    q, v = pin.neutral(model), np.zeros(model.nv)
    for name, (angle, rate) in values.items():
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2:
            q[joint.idx_q], q[joint.idx_q + 1] = math.cos(angle), math.sin(angle)
        else:
            q[joint.idx_q] = angle
        v[joint.idx_v] = rate
    accelerations = pin.aba(model, model.createData(), q, v, np.zeros(model.nv))
    return {name: accelerations[model.joints[model.getJointId(name)].idx_v] for name in values}


def call(mbd, *arguments):
    return subprocess.run([mbd, *map(str, arguments)], capture_output=True, text=True, timeout=900)


def by_mbd(mbd, path, values, free, unchecked, relative, folder):
    """The same by a declaration that takes the file in; else what was told."""
    fields = (["base: free"] if free else []) + (["inertias: unchecked"] if unchecked else [])
    family = "coordinates: relative; " if relative else ""
    head = f'pub model R {{ {family}urdf: "{path.name}" {{ {", ".join(fields)} }}'
    scene = Path(folder) / "robot.mbd"
    word = lambda name: re.sub(r"\W", "_", name)
    links = {word(link.get("name")) for link in xml.parse(path).getroot().findall("link")}
    # A name that a link has, too, may get `_joint` behind it.
    renamed = {name for name in map(word, values) if name in links}
    while True:
        names = [word(name) + ("_joint" if word(name) in renamed else "") for name in values]
        scene.write_text(head + "".join(f" extend {name} {{ }}" for name in names) + " }\n")
        kept = re.findall(r"declares nothing that is called `(\w+)_joint`", call(mbd, "check", scene).stderr)
        if not kept:
            break
        renamed -= set(kept)
    text = [head]
    for index, (name, (_, (at, rate))) in enumerate(zip(names, values.items())):
        text.append(f"extend {name} {{ start: {at!r} {{u}}, start_rate: {rate!r} {{u}}/s }}")
        text.append(f"output a{index} = {name}.{{c}}_acceleration;")
    kinds = dict(moving(path))
    lines = [text[0]]
    for index, name in enumerate(values):
        slides = kinds[name] == "prismatic"
        for line in text[1 + 2 * index : 3 + 2 * index]:
            lines.append(line.replace("{u}", "m" if slides else "rad").replace("{c}", "slide" if slides else "angle"))
    scene.write_text("\n".join(lines) + "\n}\n")
    out = Path(folder) / "out"
    ran = call(mbd, "run", scene, "--out", out, "--dt", "1e-9", "--until", "1e-9", "--no-estimate")
    if ran.returncode not in (0, 3):
        return (ran.stderr or ran.stdout).strip()
    with open(next(out.rglob("*.csv"))) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    first = dict(zip(rows[0], rows[1]))
    column = lambda name: next(v for k, v in first.items() if k.split(" ")[0].split("[")[0].strip() == name)
    return {name: float(column(f"a{index}")) for index, name in enumerate(values)}


def compare(mbd, path, folder):
    """One line a robot: links, freedoms, agreement with base at rest and flying, or what was told."""
    row = {"file": str(path).split("robots/", 1)[-1]}
    copy = plain(path, folder)
    joints = moving(copy)
    row["joints"] = len(joints)
    for free in (False, True):
        key = "free" if free else "fixed"
        if not joints:
            row[key] = "nothing moves"
            continue
        values = state(joints, 1)
        want = by_pinocchio(model_of(copy, free), values)
        have = by_mbd(mbd, copy, values, free, False, False, folder)
        if isinstance(have, str) and "inertias: unchecked" in have:
            wrong, without = have.count("the inertia of link"), have.count("moves and has no mass")
            row["told"] = f"{wrong} impossible inertias, {without} links without mass"
            have = by_mbd(mbd, copy, values, free, True, False, folder)
        if isinstance(have, str) and "coordinates: relative" in have:
            row["told"] += ", by relative coordinates"
            have = by_mbd(mbd, copy, values, free, True, True, folder)
        if isinstance(have, str):
            row[key] = have.splitlines()[0].split(": ", 1)[-1]
            continue
        scale = max(abs(a) for a in want.values()) or 1.0
        row[key] = f"{max(abs(have[n] - want[n]) for n in want) / scale:.1e}"
    return row


def reference(name):
    """Accelerations of a robot of our own at eight states, by Pinocchio alone."""
    with tempfile.TemporaryDirectory() as folder:
        copy = plain(OWN / f"{name}.urdf", folder)
        joints = moving(copy)
        stored = []
        for free in (False, True):
            model = model_of(copy, free)
            for seed in range(1, 5):
                values = state(joints, seed)
                stored.append({"free": free, "state": values, "acceleration": by_pinocchio(model, values)})
    provenance = f"Pinocchio {pin.__version__}, aba of {name}.urdf without damping, friction and mimic; base at rest"
    text = json.dumps({"case": f"urdf_{name}", "provenance": provenance, "states": stored}, indent=1)
    (HERE / f"reference/robots/urdf_{name}.json").write_text(text + "\n")


def main():
    mbd = str(Path(sys.argv[1]).resolve())
    if "--reference" in sys.argv:
        return [reference(name) for name in ("arm", "hip")]
    root = Path(pin.__file__)
    while not (root / "share/example-robot-data").exists():
        root = root.parent
    wanted = [word for word in sys.argv[2:] if not word.startswith("--")]
    rows = []
    for path in sorted((root / "share/example-robot-data/robots").rglob("*.urdf")):
        if wanted and path.stem not in wanted:
            continue
        with tempfile.TemporaryDirectory() as folder:
            try:
                row = compare(mbd, path, folder)
            except Exception as error:
                row = {"file": str(path).split("robots/", 1)[-1], "told": f"{type(error).__name__}: {error}".splitlines()[0]}
            print(" | ".join(f"{key}: {value}" if key != "file" else value for key, value in row.items()), flush=True)
            rows.append(row)
    if "--store" in sys.argv:
        store(rows)


def store(rows):
    """The table as a file, with what it is made by."""
    versions = f"Pinocchio {version('pin')}, example-robot-data {version('example-robot-data')}"
    with open(HERE / "reference/robots/example_robot_data.csv", "w", newline="") as file:
        file.write(f"# {versions}: largest difference of joint accelerations in one random state over the largest of them\n")
        table = csv.DictWriter(file, ["file", "joints", "fixed", "free", "told"], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


main()
