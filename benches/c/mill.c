/* The three-axis mill XYFZ by hand: the table moves in X on Y, Z carries the tool. 21 error motions: 18 tables and three
 * squarenesses. What multiplies the same lever is added first. */
#include "cycle.h"

struct constants {
    double Xt, Yt, Zt;
};

struct motions {
    double exx, eyx, ezx, eax, ebx, ecx;
    double exy, eyy, ezy, eay, eby, ecy;
    double exz, eyz, ezz, eaz, ebz, ecz;
    double ec0y, ea0z, eb0z;
};

enum { AXES = 3, EACH = 6, TABLES = AXES * EACH, MOTIONS = TABLES + 3 };

struct mill {
    struct constants constants;
    struct table tables[TABLES];
    struct motions fixed; /* the squarenesses; the others come from the tables */
};

static inline void equations(const struct constants *c, const double p[3], const struct motions *e, double out[3])
{
    double x = p[0], y = p[1], z = p[2];
    double table_a = e->eax + e->eay, table_b = e->ebx + e->eby, table_c = e->ecx + e->ecy;
    double a = table_a - e->eaz, b = table_b - e->ebz, g = table_c - e->ecz;
    out[0] = e->exx - e->exy + e->exz - table_b * z + table_c * y - b * c->Zt + g * c->Yt - e->ec0y * y + e->eb0z * z;
    out[1] = e->eyy - e->eyx + e->eyz - e->ecx * x + table_a * z - g * c->Xt + a * c->Zt - e->ea0z * z;
    out[2] = e->ezz - e->ezx - e->ezy + e->ebx * x - table_a * y + b * c->Xt - a * c->Yt;
}

void mill_equations(const struct constants *c, const double p[3], const struct motions *e, double out[3])
{
    equations(c, p, e, out);
}

static inline void error_own(const struct mill *mill, const double p[3], const long reverse[3], double out[3])
{
    struct motions e = mill->fixed;
    double *motion = &e.exx;
    for (int axis = 0; axis < AXES; ++axis)
        for (int k = 0; k < EACH; ++k)
            motion[axis * EACH + k] = lookup(&mill->tables[axis * EACH + k], p[axis], reverse[axis]);
    equations(&mill->constants, p, &e, out);
}

static inline void error_shared(const struct mill *mill, const double p[3], const long reverse[3], double out[3])
{
    struct motions e = mill->fixed;
    double *motion = &e.exx;
    for (int axis = 0; axis < AXES; ++axis) {
        const struct table *tables = &mill->tables[axis * EACH];
        struct place place = find(&tables->nodes, p[axis]);
        for (int k = 0; k < EACH; ++k)
            motion[axis * EACH + k] = read_curve(tables[k].curve[reverse[axis]], place);
    }
    equations(&mill->constants, p, &e, out);
}

/* Every slide moves the tip by +1 in its own direction. */
static inline void moves(const double error[3], double move[3])
{
    memcpy(move, error, AXES * sizeof *move);
}

DEFINE_CYCLES(mill, AXES, moves)
