/* One cycle of a controller around `error_own` and `error_shared` of a machine whose slides move the tip along the
 * axes of the part: the error, and the command that cancels it, by the fixed point c <- target - moves(E(c)). */
#ifndef CYCLE_H
#define CYCLE_H

#include <math.h>
#include <string.h>

#include "lookup.h"

enum { MOST_STEPS = 20 };
static const double TOLERANCE = 1e-10;

#define DEFINE_COMPENSATE(machine, axes, moves, name, error)                                                          \
    int machine##_compensate_##name(const struct machine *machine, const double target[axes],                         \
                                    const long reverse[axes], double command[axes])                                   \
    {                                                                                                                  \
        double before[axes] = {0}, move[axes], e[3];                                                                  \
        memcpy(command, target, sizeof before);                                                                       \
        for (int step = 1; step <= MOST_STEPS; ++step) {                                                              \
            double square = 0.0;                                                                                      \
            error(machine, command, reverse, e);                                                                      \
            moves(e, move);                                                                                           \
            for (int axis = 0; axis < axes; ++axis) {                                                                 \
                double change = move[axis] - before[axis];                                                            \
                square += change * change;                                                                            \
                command[axis] = target[axis] - move[axis];                                                            \
                before[axis] = move[axis];                                                                            \
            }                                                                                                          \
            if (square <= TOLERANCE * TOLERANCE)                                                                      \
                return step;                                                                                          \
        }                                                                                                              \
        memcpy(command, target, sizeof before);                                                                       \
        return 0;                                                                                                      \
    }

#define DEFINE_CYCLES(machine, axes, moves)                                                                           \
    void machine##_error_own(const struct machine *machine, const double p[axes], const long reverse[axes],           \
                             double out[3])                                                                           \
    {                                                                                                                  \
        error_own(machine, p, reverse, out);                                                                          \
    }                                                                                                                  \
    void machine##_error_shared(const struct machine *machine, const double p[axes], const long reverse[axes],        \
                                double out[3])                                                                        \
    {                                                                                                                  \
        error_shared(machine, p, reverse, out);                                                                       \
    }                                                                                                                  \
    DEFINE_COMPENSATE(machine, axes, moves, own, error_own)                                                           \
    DEFINE_COMPENSATE(machine, axes, moves, shared, error_shared)

#endif
