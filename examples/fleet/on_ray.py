"""Runs the jobs of a fleet on a Ray cluster: python on_ray.py fleet.yaml [ADDRESS]

Without an address Ray starts on this computer. A job whose worker is killed is done again by another one, up to three times.
"""

import os
import sys

import ray

import jobs


@ray.remote(num_cpus=1, max_retries=3, retry_exceptions=True)
def do(folder, fleet, job):
    if folder not in sys.path:
        sys.path.append(folder)
    import jobs

    return jobs.do(fleet, job)


def main(fleet, address=None):
    fleet = os.path.abspath(fleet)
    ray.init(address=address, include_dashboard=False, log_to_driver=False)
    folder = os.path.dirname(os.path.abspath(__file__))
    done = 0
    for names in jobs.rounds(fleet):
        done += len(ray.get([do.remote(folder, fleet, name) for name in names]))
    print(f"{done} jobs done")


if __name__ == "__main__":
    main(*sys.argv[1:3])
