/* Measured curves, read as calcComp reads its Error File: the subscript, then linear interpolation between two nodes,
 * from the array of the direction of motion. Beyond the ends the last value holds.
 *
 * Two ways. `lookup`: every table has nodes of its own. `find` and `read`: all tables of an axis have the nodes of
 * that axis, so that the subscript is determined once for each axis, as calcComp does. */
#ifndef LOOKUP_H
#define LOOKUP_H

/* The nodes of a table: start, 1/step, the number of the last one. */
struct nodes {
    double start, per_step;
    long last;
};

/* A table over one axis; curve[0] is read in the positive direction of motion, curve[1] in the negative. */
struct table {
    struct nodes nodes;
    const double *curve[2];
};

/* Between which two nodes a position lies, and where. */
struct place {
    long node;
    double part;
};

static inline double lookup(const struct table *table, double position, long reverse)
{
    const double *curve = table->curve[reverse];
    double place = (position - table->nodes.start) * table->nodes.per_step;
    if (!(place > 0.0))
        return curve[0];
    if (place >= (double)table->nodes.last)
        return curve[table->nodes.last];
    long node = (long)place;
    return curve[node] + (curve[node + 1] - curve[node]) * (place - (double)node);
}

static inline struct place find(const struct nodes *nodes, double position)
{
    double place = (position - nodes->start) * nodes->per_step;
    if (!(place > 0.0))
        return (struct place){0, 0.0};
    if (place >= (double)nodes->last)
        return (struct place){nodes->last - 1, 1.0};
    long node = (long)place;
    return (struct place){node, place - (double)node};
}

static inline double read_curve(const double *curve, struct place place)
{
    return curve[place.node] + (curve[place.node + 1] - curve[place.node]) * place.part;
}

#endif
