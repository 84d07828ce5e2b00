"""The jobs of a fleet as any engine hands them out. In: a fleet file. Out: names of jobs, and a function that does one of them.

Every job is a call of `abbe fleet run --job`, which writes its result whole or not at all, under a name that follows from what it was made
from. So a job may be done twice, on two computers, or by a worker that was killed and another after it: the files are the same bytes.
The folder of the fleet must be at one place for all workers: a shared folder, or an object store that is mounted.
"""

import json
import os
import subprocess

ABBE = os.environ.get("ABBE", "abbe")


def listed(fleet):
    """The jobs that are still to be done: those that diagnose, then those that follow what was found; and why others cannot be done now,
    empty where there are none."""
    told = subprocess.run([ABBE, "fleet", "run", fleet, "--list"], capture_output=True, text=True)
    # Status 1: some recordings cannot be read now, and are not in the list.
    if told.returncode not in (0, 1):
        raise RuntimeError(told.stderr.strip())
    return [json.loads(line) for line in told.stdout.splitlines()], told.stderr.strip() if told.returncode else ""


def do(fleet, job):
    """Does one job; an engine tries again what raises."""
    done = subprocess.run([ABBE, "fleet", "run", fleet, "--job", job], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{job}: {done.stderr.strip()}")
    return job


def rounds(fleet):
    """The jobs in rounds: what is followed is known when all recordings of a machine are diagnosed, so the list is read anew after
    each round, until nothing is left. Raises at the end where recordings are missing."""
    before = None
    while True:
        left, missing = listed(fleet)
        names = [job["job"] for job in left]
        if not names and missing:
            raise RuntimeError(missing)
        if not names:
            return
        if names == before:
            raise RuntimeError(f"{len(names)} jobs were done and are still to be done")
        yield names
        before = names
