#!/usr/bin/python3
"""Draws the errors of one machine of five axes.

In: draw.py SEED MACHINE AXES, a machine file and the letters of its axes. Out, in the folder that it is started in: drawn.h, from
which plant.c has its errors, and specimen.yaml, which states them as a measurement without noise would. It exists so that nobody
has chosen an error: all six motions of each axis, the squareness of slides, and where each rotary axis is.
"""

import random
import sys

DIRECTIONS = "XYZABC"

# What is usual for machines of this size: mm, rad; positioning of a rotary axis is 20 arcsec.
DISPLACEMENT, ROTATION, OWN_ANGLE, PLAY = 0.01, 50e-6, 97e-6, 0.006
# A slide errs by that much over this travel, mm; and its wave is that of a screw.
TRAVEL, PITCH = 300, 10


def is_rotary(axis):
    return axis in "ABC"


def unit(direction):
    return "rad" if is_rotary(direction) else "mm"


def usual(direction):
    return ROTATION if is_rotary(direction) else DISPLACEMENT


def motion(axis, direction):
    """A curve, and the amplitude, period and phase of a wave: of a slide a tenth of the curve, of a rotary axis once or twice a turn."""
    most, phase, part = usual(direction), random.uniform(0, 6), random.uniform(0.3, 1)
    if is_rotary(axis):
        most = OWN_ANGLE if direction == axis else most
        return [0, 0, 0], most * part, random.choice([360, 180]), phase
    slope, bend = (random.uniform(-1, 1) * most / TRAVEL**power for power in (1, 2))
    return [0, slope, bend], most * part / 10, PITCH, phase


def aligned(axis):
    """X is the direction of the frame; Y has one angle to it, Z two; a rotary axis two places across it, two tilts and its zero."""
    of_slide = {"X": "", "Y": "C", "Z": "AB"}
    across = [direction for direction in DIRECTIONS if DIRECTIONS.index(direction) != "ABC".find(axis)]
    directions = across if is_rotary(axis) else of_slide[axis]
    return {direction: 2 * random.uniform(-1, 1) * usual(direction) for direction in directions}


def for_plant(axis, play, motions, alignments):
    """A line of drawn.h, mm and rad."""
    angle = " * M_PI / 180" if is_rotary(axis) else ""
    waves = (
        f"[{direction}] = {{{{{curve[0]}, {curve[1]}, {curve[2]}}}, {amplitude}, {period}{angle}, {phase}}}"
        for direction, (curve, amplitude, period, phase) in motions.items()
    )
    lines = (f"[{direction}] = {value}" for direction, value in alignments.items())
    return f"#define DRAWN_{axis} .play = {play}, .motion = {{{', '.join(waves)}}}, .aligned = {{{', '.join(lines)}}}\n"


def for_calibration(axis, play, motions, alignments):
    """The lines of specimen.yaml."""
    position, text = "deg" if is_rotary(axis) else "mm", ""
    for direction, (curve, amplitude, period, phase) in motions.items():
        text += f"  E{direction}{axis}:\n"
        text += f"    - cyclic: {{period: {period} {position}, amplitude: {amplitude} {unit(direction)}, phase: {phase} rad}}\n"
        if any(curve):
            text += f"    - polynomial: {{axis: {axis}, per: mm, unit: {unit(direction)}, coefficients: {curve}}}\n"
        if play and direction == axis:
            text += f"    - backlash: {{lost_motion: {play} mm}}\n"
    return text + "".join(f"  E{direction}0{axis}: {value} {unit(direction)}\n" for direction, value in alignments.items())


def main():
    seed, machine, axes = sys.argv[1:]
    random.seed(seed)
    with open("drawn.h", "w") as plant, open("specimen.yaml", "w") as calibration:
        plant.write(f"/* For plant.c: {sys.argv} */\n")
        calibration.write(f"calibration: 1\nmachine: {machine}\nsource: draw.py {seed}\n")
        # Where the tool stands nearly along C, C has to turn far for little, and the slides follow it.
        calibration.write("limits: {compensation: 2 mm, rotation: 0.2 deg, fade: 0.5 s}\nerrors:\n")
        for axis in axes:
            play = 0 if is_rotary(axis) else PLAY * random.uniform(0.3, 1)
            errors = play, {direction: motion(axis, direction) for direction in DIRECTIONS}, aligned(axis)
            plant.write(for_plant(axis, *errors))
            calibration.write(for_calibration(axis, *errors))


main()
