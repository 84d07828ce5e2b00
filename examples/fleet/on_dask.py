"""Runs the jobs of a fleet on a Dask cluster: python on_dask.py fleet.yaml [ADDRESS]

Without an address a cluster of as many processes as processors starts on this computer. A worker that is killed is started again, and its
job is done again, up to three times. `dask_jobqueue` and `dask_kubernetes` give clusters on SLURM and on Kubernetes.
"""

import os
import sys

from distributed import Client, LocalCluster

import jobs


def do(folder, fleet, job):
    if folder not in sys.path:
        sys.path.append(folder)
    import jobs

    return jobs.do(fleet, job)


def main(fleet, address=None):
    fleet = os.path.abspath(fleet)
    folder = os.path.dirname(os.path.abspath(__file__))
    cluster = address or LocalCluster(n_workers=os.cpu_count(), threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        done = 0
        for names in jobs.rounds(fleet):
            futures = [client.submit(do, folder, fleet, name, key=name, retries=3, pure=False) for name in names]
            done += len(client.gather(futures))
    print(f"{done} jobs done")


if __name__ == "__main__":
    main(*sys.argv[1:3])
