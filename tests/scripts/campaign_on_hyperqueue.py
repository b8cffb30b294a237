"""A campaign under a real HyperQueue server with two workers that are killed in the middle: resumed, it ends with the bytes of one undisturbed process.

    pip install hyperqueue
    python tests/scripts/campaign_on_hyperqueue.py target/release/mbd

Three things are killed by SIGKILL: one shard (its task fails, `gather` names it, it alone is submitted again), the server with all workers and tasks
(everything is submitted again and goes on), and a process without a scheduler.

The script for Slurm in docs/campaigns.md runs as it stands there, by words of Slurm that do here what is asked of them: one task after the other,
some again, and the last one not at all at first.
"""

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SHARDS = 8
DISPERSED = """
seed = 11
cases = 199
block = 5

[params]
m_bob = { dist = "normal", sigma = "5 %" }
k = { dist = "uniform", low = "4 kN/m", high = "6 kN/m" }

[metrics]
peak = { max = "rope_left.tension" }
"""


def campaign(mbd, work, out, *more):
    return [str(mbd), "campaign", "swing", str(work / "dispersed.toml"), "--out", str(work / out), "--threads", "1", *more]


def quiet(command):
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def wait_for(what, why):
    for _ in range(1200):
        found = what()
        if found:
            return found
        time.sleep(0.025)
    sys.exit(f"never happened: {why}")


def blocks(folder):
    return len(list((folder / "blocks").glob("*[0-9].csv")))


def processes(text):
    """Processes of this test whose command holds a text."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
            except OSError:
                continue
            if text in words:
                found.append(int(entry.name))
    return found


def cluster(mbd, work, out, shards):
    """Runs shards on a server with two workers; in a process of its own, so that it can be killed."""
    from hyperqueue import Job, LocalCluster
    from hyperqueue.cluster import WorkerConfig

    with LocalCluster(worker_config=WorkerConfig(cores=1)) as local:
        local.start_worker(WorkerConfig(cores=1))
        client = local.client()
        job = Job(max_fails=None)
        for shard in shards:
            job.program(campaign(mbd, work, out, "--shard", f"{shard}/{SHARDS}", "--resume"))
        return client.wait_for_jobs([client.submit(job)], raise_on_error=False)


def start_cluster(mbd, work, out, shards):
    script = str(Path(__file__).resolve())
    command = [sys.executable, script, "--cluster", str(mbd), str(work), out, ",".join(map(str, shards))]
    # Tasks write their logs where they are submitted.
    return subprocess.Popen(command, cwd=work, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def overhead(mbd, work):
    """What the engine takes by itself: server and two workers, and as many tasks as there are shards that do nothing."""
    from hyperqueue import Job, LocalCluster
    from hyperqueue.cluster import WorkerConfig

    began = time.time()
    with LocalCluster(worker_config=WorkerConfig(cores=1)) as local:
        local.start_worker(WorkerConfig(cores=1))
        client, job = local.client(), Job()
        for _ in range(SHARDS):
            job.program([str(mbd), "--version"], stdout=None, stderr=None, cwd=work)
        if not client.wait_for_jobs([client.submit(job)], raise_on_error=False):
            sys.exit("tasks that do nothing fail")
        print(f"HyperQueue: server, two workers and {SHARDS} tasks that do nothing take {time.time() - began:.1f} s")


def same(work, out, what):
    alone, other = (work / name / "cases.csv" for name in ("alone", out))
    if alone.read_bytes() != other.read_bytes():
        sys.exit(f"{what}: other bytes")
    print(f"{what}: the same bytes")


def gather(mbd, work, out):
    return subprocess.run([str(mbd), "gather", str(work / out), "--shards", str(SHARDS)], capture_output=True, text=True)


SBATCH = """#!/bin/sh
# Every task of the array, one after the other, with what Slurm sets for it; `--array` on the command line counts before that of the script.
case "$1" in --array=*) array=${1#*=}; shift;; *) array=$(sed -n 's/^#SBATCH --array=//p' "$1");; esac
for task in $(seq "${array%-*}" "${array#*-}"); do
  SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=2 sh "$1" || exit
done
"""
SCENE = """
model = "Drop"
gravity = "[0.0, 0.0, -9.81] m/s^2"
[param]
drag = { value = "0.02 kg/m", in = "0 kg/m ..= 1 kg/m" }
[point.stone]
mass = "1 kg"
start = { at = "[0.0, 0.0, 100.0] m" }
[load]
air = { on = "stone", value = "-drag * norm(stone.velocity) * stone.velocity" }
"""
DROPS = """
cases = 64
block = 1
[params]
drag = { dist = "uniform", low = "0.01 kg/m", high = "0.03 kg/m" }
[metrics]
speed = { final = "stone.vz" }
[run]
until = "2 s"
"""


def slurm(mbd, work):
    """The script of the documentation, under words of Slurm."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "campaigns.md").read_text()
    script = next(part for part in page.split("```") if "#SBATCH" in part)
    work = work / "slurm"
    (work / "bin").mkdir(parents=True)
    job = work / "job.sh"
    job.write_text(script.split("\n", 1)[1])
    for name, text in {"sbatch": SBATCH, "srun": '#!/bin/sh\nexec "$@"\n', "mbd": f'#!/bin/sh\nexec {mbd} "$@"\n'}.items():
        (work / "bin" / name).write_text(text)
        (work / "bin" / name).chmod(0o755)
    (work / "scene.toml").write_text(SCENE)
    (work / "dispersions.toml").write_text(DROPS)
    environment = {**os.environ, "PATH": f"{work / 'bin'}:{os.environ['PATH']}"}

    def sh(command):
        return subprocess.run(command, shell=True, cwd=work, env=environment, capture_output=True, text=True)

    def must(command):
        done = sh(command)
        if done.returncode != 0:
            sys.exit(f"{command}: {done.stderr}")

    must("bash -n job.sh")
    must("sbatch --array=1-31 job.sh")
    told = sh("mbd gather results --shards 32")
    if told.returncode != 4 or "--array=32" not in told.stderr:
        sys.exit(f"gather must name shard 32: {told.stderr}")
    must("sbatch job.sh")
    must("mbd gather results --shards 32")
    must("mbd campaign scene.toml dispersions.toml --out alone --threads 1")
    if (work / "results" / "cases.csv").read_bytes() != (work / "alone" / "cases.csv").read_bytes():
        sys.exit("Slurm: other bytes")
    print("the script for Slurm, a task at first not run: the same bytes")


def main(mbd):
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "dispersed.toml").write_text(DISPERSED)
        if quiet(campaign(mbd, work, "alone")).returncode != 0:
            sys.exit("the campaign does not run")

        slurm(mbd, work)
        overhead(mbd, work)

        # One shard is killed.
        running = start_cluster(mbd, work, "shard", range(1, SHARDS + 1))
        victim = wait_for(lambda: processes(f"2/{SHARDS}"), "shard 2 runs")[0]
        os.kill(victim, signal.SIGKILL)
        if running.wait() == 0:
            sys.exit("a killed shard must fail its task")
        told = gather(mbd, work, "shard")
        if told.returncode != 4 or "--array=2" not in told.stderr:
            sys.exit(f"gather must name shard 2: {told.stderr}")
        if start_cluster(mbd, work, "shard", [2]).wait() != 0 or gather(mbd, work, "shard").returncode != 0:
            sys.exit("shard 2 does not go on")
        same(work, "shard", "HyperQueue, one shard killed and submitted again")

        # Server, workers and tasks are killed.
        running = start_cluster(mbd, work, "server", range(1, SHARDS + 1))
        wait_for(lambda: blocks(work / "server") >= 3, "three blocks")
        os.killpg(running.pid, signal.SIGKILL)
        for task in processes(str(work / "server")):
            os.kill(task, signal.SIGKILL)
        running.wait()
        if blocks(work / "server") >= 80:
            sys.exit("it was done before it was killed")
        if start_cluster(mbd, work, "server", range(1, SHARDS + 1)).wait() != 0 or gather(mbd, work, "server").returncode != 0:
            sys.exit("the campaign does not go on")
        same(work, "server", "HyperQueue, server and workers killed and started again")

        # A process without a scheduler is killed.
        running = subprocess.Popen(campaign(mbd, work, "process"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for(lambda: blocks(work / "process") >= 3, "three blocks")
        running.kill()
        running.wait()
        quiet(campaign(mbd, work, "process", "--resume"))
        same(work, "process", "one process, killed and resumed")


if __name__ == "__main__":
    if sys.argv[1] == "--cluster":
        mbd, work, out, shards = sys.argv[2:]
        sys.exit(0 if cluster(Path(mbd), Path(work), out, shards.split(",")) else 1)
    main(Path(sys.argv[1]).resolve())
