#!/usr/bin/python3
"""Takes the place of the operator of LinuxCNC.

In: the running controller of mill.ini. Out: samples of every servo cycle (samples.txt), and `driven` where all went as it
should. It homes the mill, runs mill.ngc without compensation and with it, and switches it while the mill stands, while it
moves and while its thermometer is silent. It exists so that the test needs no screen.
"""

import subprocess
import sys
import time

import linuxcnc

command, stat, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()

# What is sampled under which number; samples.rs has the same.
SETTING_UP, OFF, ON, STANDING, MOVING, SILENT = range(6)


def hal(*words):
    subprocess.run(["halcmd", *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def pin(name):
    return subprocess.run(["halcmd", "getp", name], check=True, capture_output=True, text=True).stdout.strip()


def wait(what, until, seconds=60):
    """Waits until something holds; any error that LinuxCNC tells ends the test."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        error = errors.poll()
        if error:
            sys.exit(f"LinuxCNC says: {error[1]}")
        stat.poll()
        if until():
            return
        time.sleep(0.01)
    sys.exit(f"after {seconds} s: {what}")


def idle():
    return stat.interp_state == linuxcnc.INTERP_IDLE and stat.inpos and stat.queue == 0


def mode(wanted):
    command.mode(wanted)
    command.wait_complete()


def move(block):
    mode(linuxcnc.MODE_MDI)
    command.mdi(block)
    command.wait_complete(0.1)
    wait(block, idle)


def approach():
    """To where the program begins, towards greater positions on every axis: so a recording may begin. Corrections that fade in
    there move the screws on and reverse none."""
    move("G21 G90 G1 X55 Y35 Z-115 F5000")
    move("G1 X60 Y40 Z-110")


def run_program(name):
    mode(linuxcnc.MODE_AUTO)
    command.program_open(name)
    command.auto(linuxcnc.AUTO_RUN, 0)
    wait("the program does not begin", lambda: stat.interp_state != linuxcnc.INTERP_IDLE)
    wait("the program does not end", idle)


def phase(number):
    hal("sets", "phase", number)


def compensate(wanted):
    hal("sets", "compensate", int(wanted))


def settled(status):
    wait(
        f"abbe.status {pin('abbe.status')} in place of {status}, or no end of a fade",
        lambda: pin("abbe.status") == status and pin("abbe.settling") == "FALSE",
        10,
    )


def switched_on():
    command.state(linuxcnc.STATE_ESTOP_RESET)
    command.wait_complete()
    command.state(linuxcnc.STATE_ON)
    wait("the machine is not switched on", lambda: stat.task_state == linuxcnc.STATE_ON)


def home():
    """Before it a machine does not know where it is, and nothing may be corrected."""
    mode(linuxcnc.MODE_MANUAL)
    command.teleop_enable(0)
    command.wait_complete()
    compensate(True)
    time.sleep(0.2)
    if pin("abbe.enabled") != "FALSE" or pin("abbe.status") != "5":
        sys.exit("an axis that is not homed is compensated")
    compensate(False)
    command.home(-1)
    wait("the joints are not homed", lambda: all(stat.homed[: stat.joints]))


def change_tools():
    """The calibration has a tool 7 and no tool 9. The plant has one tool, so that no correction is judged here."""
    for number, lacks in ((7, "FALSE"), (9, "TRUE"), (0, "FALSE")):
        hal("setp", "abbe.tool", number)
        wait(f"abbe.no-tool is not {lacks} with tool {number}", lambda lacks=lacks: pin("abbe.no-tool") == lacks)
        settled("1")


def main():
    with open("samples.txt", "w") as samples, subprocess.Popen(["halsampler"], stdout=samples) as sampler:
        try:
            switched_on()
            home()
            approach()
            phase(OFF)
            run_program("mill.ngc")
            phase(SETTING_UP)
            approach()
            phase(STANDING)
            compensate(True)
            settled("1")
            phase(ON)
            run_program("mill.ngc")
            phase(MOVING)
            mode(linuxcnc.MODE_MDI)
            command.mdi("G1 X240 Y200 Z-10 F3000")
            for wanted in (False, True):
                time.sleep(1)
                compensate(wanted)
            wait("the motion does not end", idle)
            settled("1")
            phase(SILENT)
            hal("setp", "abbe.sensor.table.valid", 0)
            settled("3")
            hal("setp", "abbe.sensor.table.valid", 1)
            settled("1")
            phase(SETTING_UP)
            change_tools()
            time.sleep(0.2)
            if pin("sampler.0.overruns") != "0":
                sys.exit("samples are lost: this machine is too busy to be looked at")
        finally:
            sampler.terminate()
    with open("driven", "w"):
        pass


if __name__ == "__main__":
    main()
