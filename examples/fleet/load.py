"""How many recordings a second, how much memory, and what a kill loses: python load.py FOLDER [RECORDINGS [ROWS [KILLS]]]

In: a folder for a fleet that is made. Simulates recordings of so many rows, runs the fleet undisturbed, then anew with SIGKILL at random
moments, goes on, and counts what is there: every recording once, the same bytes as before.
"""

import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

ABBE = os.environ.get("ABBE", "abbe")


def make(folder, count, rows):
    """Lines of X there and back with a lost motion of 4 um and a noise of 1 um: 40 recordings each of so many machines as it takes."""
    random.seed(1)
    machines = (count + 39) // 40
    fleet = ["fleet: 1", "machines:"]
    for machine in range(machines):
        name = f"m{machine:04}"
        (folder / name).mkdir(parents=True, exist_ok=True)
        fleet.append(f'  {name}: {{kind: stage, recordings: "{name}/*.yaml"}}')
        for number in range(min(40, count - 40 * machine)):
            lines = ["t,xc,xm"]
            for row in range(rows):
                part = 2 * row / rows
                x = 200 * (part if part < 1 else 2 - part)
                off = 0.002 if part < 1 else -0.002
                lines.append(f"{0.01 * row:.2f},{x:.4f},{x - off + random.gauss(0, 0.001):.5f}")
            (folder / name / f"{number:02}.csv").write_text("\n".join(lines) + "\n")
            date = f"{2020 + number // 12:04}-{number % 12 + 1:02}-01"
            (folder / name / f"{number:02}.yaml").write_text(
                f"recording: 1\nmachine: FX\ndate: {date}\ninstrument: position\ndata: {number:02}.csv\nchannels:\n"
                "  time: {column: t, unit: s}\n  command.x: {column: xc, unit: mm}\n  measured.x: {column: xm, unit: mm}\n"
            )
    (folder / "fleet.yaml").write_text("\n".join(fleet) + "\n")


def memory(process):
    try:
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("VmHWM"):
                return int(line.split()[1]) / 1024
    except OSError:
        pass
    return 0.0


def run(fleet, seconds=None):
    """Runs until the end, or kills after some seconds; the time, and the most memory, MiB."""
    begun, peak = time.time(), 0.0
    process = subprocess.Popen([ABBE, "fleet", "run", str(fleet), "--quiet"])
    while process.poll() is None:
        peak = max(peak, memory(process.pid))
        if seconds is not None and time.time() - begun > seconds:
            process.send_signal(signal.SIGKILL)
            process.wait()
            return time.time() - begun, peak, True
        time.sleep(0.05)
    if process.returncode != 0:
        sys.exit(f"the run ended with {process.returncode}")
    return time.time() - begun, peak, False


def sums(results):
    """Every file of the results by what it holds."""
    files = sorted(path for path in results.rglob("*") if path.is_file())
    return {str(path.relative_to(results)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def main(folder, count="10000", rows="4000", kills="20"):
    folder, count = Path(folder), int(count)
    make(folder, count, int(rows))
    fleet = folder / "fleet.yaml"
    alone, most_alone, _ = run(fleet)
    print(f"{count} recordings of {rows} rows: {alone:.0f} s, {count / alone:.2f} a second, {most_alone:.0f} MiB at most", flush=True)
    undisturbed = sums(folder / "results")
    if int(kills) == 0:
        again, _, _ = run(fleet)
        print(f"nothing to do takes {again:.1f} s")
        return
    shutil.move(folder / "results", folder / "undisturbed")
    random.seed(2)
    killed, peak = 0, 0.0
    # So that the moments are spread over the whole run.
    share = 2 * alone / int(kills)
    for _ in range(int(kills)):
        _, most, was_killed = run(fleet, random.uniform(0.0, 0.9 * share))
        peak, killed = max(peak, most), killed + was_killed
    _, most, _ = run(fleet)
    for table in ["recordings", "verdicts", "parameters", "followed"]:
        files = list((folder / "results" / table).rglob("*.parquet"))
        names = {file.name.split("-")[0] for file in files}
        assert len(files) == len(names) == count, f"{table}: {len(files)} files of {len(names)} recordings, not {count}"
    left = {path: sum for path, sum in sums(folder / "results").items() if not path.endswith(".part")}
    assert left == undisturbed, "other bytes than of the run that was not disturbed"
    again, _, _ = run(fleet)
    print(f"killed {killed} times, {max(peak, most):.0f} MiB at most: nothing lost, nothing twice, the same bytes as undisturbed")
    print(f"nothing to do takes {again:.1f} s")


if __name__ == "__main__":
    main(*sys.argv[1:5])
