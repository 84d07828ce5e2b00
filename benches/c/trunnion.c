/* The five-axis mill by hand: the part turns on C, C on the trunnion A, the tool moves in X, Y and Z. 43 error motions:
 * 30 tables and 13 numbers of alignment. The error is gathered where it is simplest, frame by frame: that of the tool
 * in the directions of the bed, less that of the trunnion, turned into its frame, less that of C, turned into the part.
 * The command is found in the directions of the bed, where the slides are, so that sines and cosines and the
 * tables of A and C are read once. */
#define _GNU_SOURCE
#include <math.h>
#include <string.h>

#include "lookup.h"

struct constants {
    double Ya, Za, Xc, Yc, Zc, Xt, Yt, Zt;
};

struct motions {
    double exx, eyx, ezx, eax, ebx, ecx;
    double exy, eyy, ezy, eay, eby, ecy;
    double exz, eyz, ezz, eaz, ebz, ecz;
    double exa, eya, eza, eaa, eba, eca;
    double exc, eyc, ezc, eac, ebc, ecc;
    double ec0y, ea0z, eb0z;
    double ey0a, ez0a, ea0a, eb0a, ec0a;
    double ex0c, ey0c, ea0c, eb0c, ec0c;
};

enum { AXES = 5, SLIDES = 3, EACH = 6, TABLES = AXES * EACH, MOST_STEPS = 20 };
static const double TOLERANCE = 1e-10;

struct trunnion {
    struct constants constants;
    struct table tables[TABLES];
    struct motions fixed; /* the alignments; the others come from the tables */
};

struct turn {
    double sin_a, cos_a, sin_c, cos_c;
};

static inline struct turn turned(const double p[5])
{
    struct turn turn;
    sincos(p[3], &turn.sin_a, &turn.cos_a);
    sincos(p[4], &turn.sin_c, &turn.cos_c);
    return turn;
}

/* The table runs against A and C: the frame of the trunnion is that of the bed turned by -a. */
static inline void into_trunnion(const struct turn *turn, const double bed[3], double own[3])
{
    own[0] = bed[0];
    own[1] = turn->cos_a * bed[1] - turn->sin_a * bed[2];
    own[2] = turn->sin_a * bed[1] + turn->cos_a * bed[2];
}

static inline void into_part(const struct turn *turn, const double trunnion[3], double own[3])
{
    own[0] = turn->cos_c * trunnion[0] - turn->sin_c * trunnion[1];
    own[1] = turn->sin_c * trunnion[0] + turn->cos_c * trunnion[1];
    own[2] = trunnion[2];
}

/* error -= shift + angle x arm */
static inline void less_body(double error[3], double dx, double dy, double dz, double a, double b, double g,
                             const double arm[3])
{
    error[0] -= dx + b * arm[2] - g * arm[1];
    error[1] -= dy + g * arm[0] - a * arm[2];
    error[2] -= dz + a * arm[1] - b * arm[0];
}

/* The error in the directions of the trunnion's own frame. */
static inline void in_trunnion(const struct constants *c, const double p[5], const struct turn *turn,
                               const struct motions *e, double own[3])
{
    double x = p[0], y = p[1], z = p[2];
    double tip[3] = {x + c->Xt, y + c->Yt, z + c->Zt};
    double a = e->eax + e->eay, b = e->ebx + e->eby, g = e->ecy + e->ecz;
    double bed[3] = {
        e->exx + e->exy + e->exz + b * tip[2] + e->ebz * c->Zt - e->ecx * tip[1] - g * c->Yt - e->ec0y * y + e->eb0z * z,
        e->eyx + e->eyy + e->eyz + (e->ecx + g) * c->Xt - a * tip[2] - e->eaz * c->Zt - e->ea0z * z,
        e->ezx + e->ezy + e->ezz + e->eax * tip[1] + (e->eay + e->eaz) * c->Yt - (b + e->ebz) * c->Xt,
    };
    double arm[3] = {tip[0], tip[1] - c->Ya, tip[2] - c->Za}, own_arm[3];
    less_body(bed, e->exa, e->eya + e->ey0a, e->eza + e->ez0a, -e->eaa - e->ea0a, e->eba + e->eb0a, e->eca + e->ec0a,
              arm);
    into_trunnion(turn, bed, own);
    into_trunnion(turn, arm, own_arm);
    own_arm[0] -= c->Xc;
    own_arm[1] -= c->Yc;
    own_arm[2] -= c->Zc;
    less_body(own, e->exc + e->ex0c, e->eyc + e->ey0c, e->ezc, e->eac + e->ea0c, e->ebc + e->eb0c, -e->ecc - e->ec0c,
              own_arm);
}

void trunnion_equations(const struct constants *c, const double p[5], const struct motions *e, double out[3])
{
    struct turn turn = turned(p);
    double own[3];
    in_trunnion(c, p, &turn, e, own);
    into_part(&turn, own, out);
}

static inline void read_own(const struct trunnion *machine, const double p[5], const long reverse[5], int from, int to,
                            struct motions *e)
{
    double *motion = &e->exx;
    for (int axis = from; axis < to; ++axis)
        for (int k = 0; k < EACH; ++k)
            motion[axis * EACH + k] = lookup(&machine->tables[axis * EACH + k], p[axis], reverse[axis]);
}

static inline void read_shared(const struct trunnion *machine, const double p[5], const long reverse[5], int from,
                               int to, struct motions *e)
{
    double *motion = &e->exx;
    for (int axis = from; axis < to; ++axis) {
        const struct table *tables = &machine->tables[axis * EACH];
        struct place place = find(&tables->nodes, p[axis]);
        for (int k = 0; k < EACH; ++k)
            motion[axis * EACH + k] = read_curve(tables[k].curve[reverse[axis]], place);
    }
}

#define DEFINE_SLIDES(name, read)                                                                                     \
    /* The commands of the slides, those of A and C being there; the number of steps, or 0 where it does not end. */  \
    static inline int slides_##name(const struct trunnion *machine, const double target[5], const long reverse[5],    \
                                    const struct turn *turn, struct motions *e, double command[5])                    \
    {                                                                                                                 \
        double before[3] = {0}, own[3], move[3];                                                                      \
        for (int step = 1; step <= MOST_STEPS; ++step) {                                                              \
            double square = 0.0;                                                                                      \
            read(machine, command, reverse, 0, SLIDES, e);                                                            \
            in_trunnion(&machine->constants, command, turn, e, own);                                                  \
            move[0] = own[0];                                                                                         \
            move[1] = turn->cos_a * own[1] + turn->sin_a * own[2];                                                    \
            move[2] = turn->cos_a * own[2] - turn->sin_a * own[1];                                                    \
            for (int axis = 0; axis < SLIDES; ++axis) {                                                               \
                double change = move[axis] - before[axis];                                                            \
                square += change * change;                                                                            \
                command[axis] = target[axis] - move[axis];                                                            \
                before[axis] = move[axis];                                                                            \
            }                                                                                                         \
            if (square <= TOLERANCE * TOLERANCE)                                                                      \
                return step;                                                                                          \
        }                                                                                                             \
        memcpy(command, target, AXES * sizeof *command);                                                              \
        return 0;                                                                                                     \
    }

#define DEFINE_CYCLES(name, read)                                                                                     \
    void trunnion_error_##name(const struct trunnion *machine, const double p[5], const long reverse[5],              \
                               double out[3])                                                                         \
    {                                                                                                                 \
        struct motions e = machine->fixed;                                                                            \
        read(machine, p, reverse, 0, AXES, &e);                                                                       \
        trunnion_equations(&machine->constants, p, &e, out);                                                          \
    }                                                                                                                 \
                                                                                                                      \
    int trunnion_compensate_##name(const struct trunnion *machine, const double target[5], const long reverse[5],     \
                                   double command[5])                                                                 \
    {                                                                                                                 \
        struct motions e = machine->fixed;                                                                            \
        struct turn turn = turned(target);                                                                            \
        memcpy(command, target, AXES * sizeof *command);                                                              \
        read(machine, target, reverse, SLIDES, AXES, &e);                                                             \
        return slides_##name(machine, target, reverse, &turn, &e, command);                                           \
    }

/* The commands of A and C at which they stand at the angles wanted: c + e(c) = target, e being the error of each one's own angle. */
static inline int turn_axes(const struct trunnion *machine, const double target[5], const long reverse[5],
                            double command[5])
{
    const struct table *a = &machine->tables[3 * EACH + 3], *c = &machine->tables[4 * EACH + 5];
    for (int step = 1; step <= MOST_STEPS; ++step) {
        double to_a = target[3] - lookup(a, command[3], reverse[3]) - machine->fixed.ea0a;
        double to_c = target[4] - lookup(c, command[4], reverse[4]) - machine->fixed.ec0c;
        double da = to_a - command[3], dc = to_c - command[4];
        command[3] = to_a;
        command[4] = to_c;
        if (da * da + dc * dc <= TOLERANCE * TOLERANCE)
            return step;
    }
    return 0;
}

#define DEFINE_TURNING(name, read)                                                                                    \
    int trunnion_turning_##name(const struct trunnion *machine, const double target[5], const long reverse[5],        \
                                double command[5])                                                                    \
    {                                                                                                                 \
        struct motions e = machine->fixed;                                                                            \
        struct turn turn = turned(target);                                                                            \
        memcpy(command, target, AXES * sizeof *command);                                                              \
        if (!turn_axes(machine, target, reverse, command))                                                            \
            return 0;                                                                                                 \
        read(machine, command, reverse, SLIDES, AXES, &e);                                                            \
        e.eaa = e.ea0a = e.ecc = e.ec0c = 0.0;                                                                        \
        return slides_##name(machine, target, reverse, &turn, &e, command);                                           \
    }

DEFINE_SLIDES(own, read_own)
DEFINE_SLIDES(shared, read_shared)
DEFINE_CYCLES(own, read_own)
DEFINE_CYCLES(shared, read_shared)
DEFINE_TURNING(own, read_own)
DEFINE_TURNING(shared, read_shared)
