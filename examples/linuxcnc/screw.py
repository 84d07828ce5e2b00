#!/usr/bin/python3
"""Takes the place of the operator of LinuxCNC, whose own tables of screw compensation are looked at.

In: the running controller of screw.ini. Out: samples of every servo cycle (screw.txt), and `screwed` where all went as it
should: every axis has gone through its table in both directions.
"""

import subprocess
import time

from drive import command, linuxcnc, mode, move, stat, switched_on, wait

PATH = ["G21 G90 G1 X550 Y280 Z-110 F5000", "G1 X0 Y0 Z0", "G1 X300 Y150 Z-60", "G1 X100 Y50 Z-20"]


def main():
    with open("screw.txt", "w") as samples, subprocess.Popen(["halsampler"], stdout=samples) as sampler:
        try:
            switched_on()
            mode(linuxcnc.MODE_MANUAL)
            command.teleop_enable(0)
            command.wait_complete()
            command.home(-1)
            wait("the joints are not homed", lambda: all(stat.homed[: stat.joints]))
            for block in PATH:
                move(block)
            time.sleep(0.2)
        finally:
            sampler.terminate()
    with open("screwed", "w"):
        pass


main()
