#!/usr/bin/python3
"""Takes the place of the operator of LinuxCNC, with a machine of five axes.

In: the running controller of five.ini, the machine file (machine.yaml) and Abbe's equations of it (equations.json). Out: samples of
every servo cycle (five.txt), and `fived` where all went as it should. It first holds three against each other which say where the tip
of the tool is: LinuxCNC's kinematics, the simulated machine and Abbe's equations. Then it runs five.ngc without compensation and
with it.
"""

import json
import math
import re
import subprocess
import sys
import time

from drive import OFF, ON, SETTING_UP
from drive import compensate, home, linuxcnc, move, phase, pin, run_program, settled, stat, switched_on

# mm: halcmd writes seven digits.
SAME = 1e-3


def equations():
    """What names in them stand for, but for those of axes, and the tip of the tool in X, Y and Z."""
    with open("machine.yaml") as machine, open("equations.json") as derived:
        constants = re.findall(r"^  (\w+): (\S+) mm", machine.read(), re.MULTILINE)
        directions = json.load(derived)["directions"]
    names = {"sin": math.sin, "cos": math.cos} | {name: float(value) for name, value in constants}
    return names, [direction["nominal"] for direction in directions]


def tips(axes, names, nominal):
    """Where the tip is by LinuxCNC, by the simulated machine and by Abbe, mm."""
    stat.poll()
    joints = zip(axes, stat.joint_actual_position)
    positions = {axis: math.radians(at) if axis in "abc" else at for axis, at in joints}
    return (
        stat.actual_position[:3],
        [float(pin(f"plant.{direction}.nominal")) for direction in "xyz"],
        [eval(expression, names | positions) for expression in nominal],
    )


def hold_against_each_other(axes, blocks):
    """How far each says that the tip goes from where it is with all axes at zero, which LinuxCNC calls zero whatever the tool."""
    names, nominal = equations()
    zero = tips(axes, names, nominal)
    for block in blocks:
        move(block)
        gone = [[to - at for to, at in zip(*both)] for both in zip(tips(axes, names, nominal), zero)]
        apart = max(math.dist(gone[0], other) for other in gone[1:])
        print(f"{block}: LinuxCNC, the plant and Abbe are {apart * 1e3:.2f} um apart")
        if apart > SAME:
            sys.exit(f"by LinuxCNC, the plant and Abbe the tip is {gone} mm from zero")


def main():
    axes = linuxcnc.ini("five.ini").find("ABBE", "AXES").lower()
    with open("five.ngc") as program:
        _, settings, feed, *moves, back, _ = program.read().splitlines()
    with open("five.txt", "w") as samples, subprocess.Popen(["halsampler"], stdout=samples) as sampler:
        try:
            switched_on()
            home()
            move(f"{settings} {feed}")
            hold_against_each_other(axes, moves[:3])
            move(back)
            phase(OFF)
            run_program("five.ngc")
            phase(SETTING_UP)
            compensate(True)
            settled("1")
            phase(ON)
            run_program("five.ngc")
            phase(SETTING_UP)
            time.sleep(0.2)
            if pin("sampler.0.overruns") != "0":
                sys.exit("samples are lost: this machine is too busy to be looked at")
        finally:
            sampler.terminate()
    with open("fived", "w"):
        pass


main()
