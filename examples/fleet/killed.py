"""Whether an engine loses or doubles anything when a worker is killed: python killed.py ENGINE FLEET

In: `on_ray.py` or `on_dask.py`, and a fleet file without results. Runs the engine, kills a call of `abbe` and its parent, the worker, while jobs
are under way, and holds the results against those of `abbe fleet run`, byte for byte.
"""

import hashlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ABBE = os.environ.get("ABBE", "abbe")


def sums(folder):
    files = sorted(Path(folder).rglob("*.parquet"))
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def worker_of(fleet):
    """The process of a job under way, and its parent; ours alone, by the path of the fleet."""
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
                parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            except (OSError, ValueError, IndexError):
                continue
            if b"--job" in words and fleet.encode() in words:
                return int(entry.name), parent
    return None


def main(engine, fleet):
    fleet = os.path.abspath(fleet)
    results = Path(fleet).parent / "results"
    run = subprocess.Popen([sys.executable, engine, fleet])
    killed = 0
    while run.poll() is None:
        found = worker_of(fleet)
        if found and killed < 1:
            for process in reversed(found):
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            killed += 1
        time.sleep(0.05)
    if run.returncode != 0:
        sys.exit(f"{engine} ended with {run.returncode}")
    with_engine = sums(results)
    with tempfile.TemporaryDirectory() as aside:
        shutil.move(results, Path(aside) / "results")
        subprocess.run([ABBE, "fleet", "run", fleet, "--quiet"], check=True)
    alone = sums(results)
    print(f"{killed} worker killed; {len(with_engine)} files, {'the same' if with_engine == alone else 'others'} as without the engine")
    sys.exit(with_engine != alone or killed == 0)


if __name__ == "__main__":
    main(*sys.argv[1:3])
