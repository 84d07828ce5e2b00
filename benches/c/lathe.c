/* The Excello 921 by hand: equations (3-25) and (3-26) of the report, and around them what its calcComp does: the
 * subscripts, the components by direction of motion, the sum. The spindle and the part ride on Z, the tool on X. */
#include "cycle.h"

struct constants {
    double X1, Z1, X2, Xt, Zt;
};

struct motions {
    double dxx, dzx, eyx, dxz, dzz, eyz, alpha, beta;
};

enum { TABLES = 6, AXES = 2 };

struct lathe {
    struct constants constants;
    struct table tables[TABLES];
    struct motions fixed; /* alpha and beta; the others come from the tables */
};

static inline void equations(const struct constants *c, double x, double z, const struct motions *e, double out[3])
{
    out[0] = e->dxx - e->dxz + c->Zt * e->eyx + (z + c->Z1 - c->Zt) * e->eyz - e->beta * z;
    out[1] = 0.0;
    out[2] = e->dzx - e->dzz - c->Xt * e->eyx + (x - c->X1 + c->X2 + c->Xt) * e->eyz - e->alpha * x;
}

void lathe_equations(const struct constants *c, const double p[2], const struct motions *e, double out[3])
{
    equations(c, p[0], p[1], e, out);
}

static inline void error_own(const struct lathe *lathe, const double p[2], const long reverse[2], double out[3])
{
    struct motions e = lathe->fixed;
    e.dxx = lookup(&lathe->tables[0], p[0], reverse[0]);
    e.dzx = lookup(&lathe->tables[1], p[0], reverse[0]);
    e.eyx = lookup(&lathe->tables[2], p[0], reverse[0]);
    e.dxz = lookup(&lathe->tables[3], p[1], reverse[1]);
    e.dzz = lookup(&lathe->tables[4], p[1], reverse[1]);
    e.eyz = lookup(&lathe->tables[5], p[1], reverse[1]);
    equations(&lathe->constants, p[0], p[1], &e, out);
}

static inline void error_shared(const struct lathe *lathe, const double p[2], const long reverse[2], double out[3])
{
    const struct table *tables = lathe->tables;
    struct motions e = lathe->fixed;
    struct place x = find(&tables[0].nodes, p[0]), z = find(&tables[3].nodes, p[1]);
    e.dxx = read_curve(tables[0].curve[reverse[0]], x);
    e.dzx = read_curve(tables[1].curve[reverse[0]], x);
    e.eyx = read_curve(tables[2].curve[reverse[0]], x);
    e.dxz = read_curve(tables[3].curve[reverse[1]], z);
    e.dzz = read_curve(tables[4].curve[reverse[1]], z);
    e.eyz = read_curve(tables[5].curve[reverse[1]], z);
    equations(&lathe->constants, p[0], p[1], &e, out);
}

/* X moves the tip by +1 in X, Z moves the part and so the tip by -1 in Z. */
static inline void moves(const double error[3], double move[2])
{
    move[0] = error[0];
    move[1] = -error[2];
}

DEFINE_CYCLES(lathe, AXES, moves)
