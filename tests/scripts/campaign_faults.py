"""Campaigns that meet faults, and what others read of them: a full disk, twenty kills, 100,000 cases, pandas and polars.

    pip install pandas polars pyarrow
    python tests/scripts/campaign_faults.py target/release/mbd

A disk is full where a limit of the shell on the size of files says so: writing fails there as it does on a full disk.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STONE = """
pub model Stone {
    gravity: [0.0, 0.0, -10.0] m/s^2;
    param mass = 1 kg in 0.1 kg ..= 10 kg;
    point stone { mass: mass, start at [0.0, 0.0, 2.0] m velocity [3.0, 0.0, 10.0] m/s }
    load air on stone = -0.02 kg/m * norm(stone.velocity) * stone.velocity;
    output height = stone.position.z;
}
"""
DISPERSED = """
seed = 5
cases = CASES
block = BLOCK

[params]
mass = { dist = "uniform", low = "0.5 kg", high = "2 kg" }

[start]
stone.vx = { dist = "normal", sigma = "1 m/s" }

[metrics]
top = { max = "height" }
east = { final = "stone.x" }

[envelopes]
columns = ["height"]
every = "0.25 s"

[histories]
cases = [0, 3]

[run]
until = "1 s"
step = "0.05 s"
"""


def write(work, cases, block):
    (work / "stone.mbd").write_text(STONE)
    (work / "dispersed.toml").write_text(DISPERSED.replace("CASES", str(cases)).replace("BLOCK", str(block)))


def campaign(mbd, work, out, *more):
    return [str(mbd), "campaign", str(work / "stone.mbd"), str(work / "dispersed.toml"), "--out", str(work / out), *more]


def run(command):
    return subprocess.run(command, capture_output=True, text=True)


def demand(holds, why):
    if not holds:
        sys.exit(why)


def whole(mbd, work):
    done = run(campaign(mbd, work, "alone"))
    demand(done.returncode == 0, f"the campaign does not run: {done.stderr}")


def same(work, out, what):
    for name in ("cases.csv", "envelopes.csv"):
        alone, other = (work / folder / name for folder in ("alone", out))
        demand(alone.read_bytes() == other.read_bytes(), f"{what}: other bytes in {name}")
    print(f"{what}: the same bytes")


def full_disk(mbd, work):
    write(work, 600, 100)
    whole(mbd, work)
    # Whoever ignores the signal is told by the write. Files may have 4 or 8 kB, as the shell counts.
    limited = ["sh", "-c", 'trap "" XFSZ; ulimit -f 8; exec "$0" "$@"']
    done = run(limited + campaign(mbd, work, "full"))
    demand(done.returncode == 1, f"a full disk must end with 1, not {done.returncode}")
    demand("cannot write" in done.stderr and "/00000000." in done.stderr, f"the file is not named: {done.stderr}")
    demand("panicked" not in done.stderr, done.stderr)
    left = [path.name for path in (work / "full").rglob("*") if path.is_file()]
    demand(not any("part" in name for name in left), f"half a file is left: {left}")
    demand(not list((work / "full" / "blocks").iterdir()), "a block that is not whole is there")
    demand(run(campaign(mbd, work, "full", "--resume")).returncode == 0, "it does not go on")
    same(work, "full", "full disk, then room")
    # The page, too, is written whole or not at all.
    done = run(limited + [str(mbd), "report", str(work / "full")])
    demand(done.returncode == 1 and not (work / "full" / "report.html").exists(), "half a page is there")
    demand(run([str(mbd), "report", str(work / "full")]).returncode == 0, "there is room, and no page")
    for case in (0, 3):
        alike(work / "full" / "histories" / f"case_{case:06}")


def alike(path):
    """The frames of a table, which pandas and polars read alike from both of its files."""
    import pandas
    import polars

    cases, frame = pandas.read_csv(path.with_suffix(".csv")), polars.read_csv(path.with_suffix(".csv"), infer_schema_length=None)
    columns, other = polars.read_parquet(path.with_suffix(".parquet")), pandas.read_parquet(path.with_suffix(".parquet"))
    # What CSV has no word for: numbers that happen to be whole, and texts that are all missing.
    demand(columns.cast(frame.schema).equals(frame), f"{path}: polars reads another table from Parquet")
    demand(other.astype(cases.dtypes.to_dict()).equals(cases), f"{path}: pandas reads another table from Parquet")
    return cases, frame


def kills(mbd, work):
    write(work, 6000, 10)
    whole(mbd, work)
    chance, killed, deadline = random.Random(2003), 0, time.time() + 300
    while killed < 20:
        demand(time.time() < deadline, "it was never under way")
        began = len(list((work / "killed" / "blocks").glob("*[0-9].csv"))) if killed else 0
        if began >= 601:
            # It was done before it was killed often enough: some of it is taken away, as a lost disk would.
            for block in chance.sample(sorted((work / "killed" / "blocks").glob("*[0-9].csv")), 400):
                block.unlink()
        running = subprocess.Popen(campaign(mbd, work, "killed", "--resume"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.005, 0.08))
        if running.poll() is None:
            running.kill()
            killed += 1
        running.wait()
    demand(run(campaign(mbd, work, "killed", "--resume")).returncode == 0, "it does not go on")
    same(work, "killed", "twenty kills")


def peak_memory(command):
    """The most memory that a command had [kB], and how long it took [s]."""
    began, most = time.time(), 0
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    while running.poll() is None:
        try:
            status = Path(f"/proc/{running.pid}/status").read_text()
            most = max([most] + [int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM")])
        except OSError:
            pass
        time.sleep(0.002)
    demand(running.returncode == 0, f"{command} ends with {running.returncode}")
    return most, time.time() - began


def many(mbd, work):
    flown, gathered = {}, {}
    for cases in (10_000, 100_000):
        write(work, cases, 100)
        out = f"of_{cases}"
        # Shards are not put together: that is measured by itself.
        memory = [peak_memory(campaign(mbd, work, out, "--shard", f"{shard}/2")) for shard in (1, 2)]
        flown[cases] = max(most for most, _ in memory), sum(took for _, took in memory)
        gathered[cases] = peak_memory([str(mbd), "gather", str(work / out)])
        print(f"{cases} cases: {flown[cases][0]} kB to fly them, {flown[cases][1]:.1f} s; {gathered[cases][0]} kB to put them together, {gathered[cases][1]:.1f} s")
    demand(flown[100_000][0] < 1.2 * flown[10_000][0], "memory grows with the cases")
    # All numbers of the table at once: some hundred bytes a case.
    demand(gathered[100_000][0] - gathered[10_000][0] < 60_000, "putting together takes more than 600 bytes a case")
    demand(gathered[100_000][1] < 30, "putting together takes long")
    return work / "of_100000"


def libraries(folder):
    import numpy
    import polars

    manifest = json.loads((folder / "manifest.json").read_text())
    cases, frame = alike(folder / "cases")
    names = [f"{it['name']} [{it['unit']}]" for it in manifest["dispersed"] + manifest["metrics"]]
    for name in names:
        demand(cases[name].dtype == "float64" and frame[name].dtype == polars.Float64, f"{name} is not read as numbers")
        demand((cases[name].to_numpy() == frame[name].to_numpy()).all(), f"{name} is read differently")
    demand(len(cases) == frame.height == manifest["cases"] == 100_001, "cases are missing")
    over_time = polars.read_csv(folder / "envelopes.csv")
    blocks = [numpy.load(path) for path in sorted((folder / "envelopes").glob("*.npy"))]
    numbers = numpy.concatenate(blocks, axis=2)
    demand(numbers.shape == (1, 5, 100_001), f"the blocks are {numbers.shape}")
    for line, find in (("min", numpy.nanmin), ("max", numpy.nanmax)):
        found = find(numbers[0, :, 1:], axis=1)
        demand((over_time[f"height.{line} [m]"].to_numpy() == found).all(), f"numpy finds another {line}")
    demand((over_time["height.nominal [m]"].to_numpy() == numbers[0, :, 0]).all(), "numpy finds another nominal")
    median = numpy.nanquantile(numbers[0, :, 1:], 0.5, axis=1, method="inverted_cdf")
    demand((over_time["height.p50 [m]"].to_numpy() == median).all(), "numpy finds another median")
    print("pandas, polars and numpy read the same numbers")


def main(mbd):
    for part in (full_disk, kills):
        with tempfile.TemporaryDirectory() as folder:
            part(mbd, Path(folder))
    with tempfile.TemporaryDirectory() as folder:
        libraries(many(mbd, Path(folder)))


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
