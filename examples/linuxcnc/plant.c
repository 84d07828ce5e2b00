/*
 * A machine with errors, for tests: a HAL component of LinuxCNC between commands and feedback.
 *
 * In: the command of each drive, the position that was wanted of it, and a temperature. Out: what each drive's encoder says, where the
 * tip of the tool truly stands relative to the part, where it should, and by how much the tool is turned. It exists as an oracle
 * that shares nothing with Abbe: rigid bodies with finite rotations, a play that is a play, and numbers of its own. Which machine
 * it is, and its numbers, stand in the header that it is compiled with: -DMACHINE='"mill.h"'.
 *
 * The drives follow their commands at once: what they would lag behind is no error of the geometry.
 */
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "rtapi.h"
#include "rtapi_app.h"
#include "hal.h"

MODULE_AUTHOR("Abbe");
MODULE_DESCRIPTION("A machine with errors, for tests");
MODULE_LICENSE("Dual MIT/GPL");

/* Displacements in X, Y, Z and rotations about them: what a slide and a rotary axis do, and what each does beside it. */
enum { X, Y, Z, A, B, C, MOTIONS };

/* What an axis does beside what it was told, mm or rad: a curve and a wave of its position q, mm or rad. */
typedef struct {
    double curve[3]; /* of 1, q and q^2 */
    double amplitude, period, phase;
} Motion;

/* An axis, in the frame of the body that carries it. All directions are those of that frame. */
typedef struct {
    char letter;
    bool carries_part;
    int along, way; /* X to C, and +1 or -1: how its body moves when it is programmed forwards */
    double origin[3];
    double play;             /* mm, or rad */
    double expansion;        /* 1/K, from 20 degC */
    Motion motion[MOTIONS];  /* that of its own direction counts along its way */
    double aligned[MOTIONS]; /* of the line that a slide moves along, or of the axis that is turned about, and its zero */
} Link;

/* `links` from the bed outwards, and in the frames of the last bodies `tool`, the tip, and `part`, the origin. */
#include MACHINE

enum { LINKS = sizeof links / sizeof *links };

typedef struct {
    double row[3][3];
} Rotation;

typedef struct {
    Rotation rotation;
    double place[3];
} Body;

/* The tool as the part sees it. */
typedef struct {
    double tip[3], direction[3];
} Tool;

typedef struct {
    hal_float_t *position[LINKS]; /* in: what is wanted, in the units of the joint */
    hal_float_t *cmd[LINKS];      /* in: what the drive is told */
    hal_float_t *fb[LINKS];       /* out: what its encoder says */
    hal_float_t *tip[3];          /* out: mm */
    hal_float_t *nominal[3];      /* out: where the tip would be with all positions as wanted and no errors, mm */
    hal_float_t *error[3];        /* out: the tip from there, mm */
    hal_float_t *turned;          /* out: the angle from the direction of the tool to the one without errors, arcsec */
    hal_float_t *temperature;     /* in: degC */
} Pins;

static int component = -1;
static Pins *pins;
/* Where each axis stands behind its play: mm, or rad. */
static double axis[LINKS];

static Rotation product(const Rotation *a, const Rotation *b) {
    Rotation c;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c.row[i][j] = 0;
            for (int k = 0; k < 3; k++) c.row[i][j] += a->row[i][k] * b->row[k][j];
        }
    }
    return c;
}

/* Turned about X by a, then about Y by b, then about Z by c; rad, right-handed. */
static Rotation turned(double a, double b, double c) {
    const Rotation about_x = {{{1, 0, 0}, {0, cos(a), -sin(a)}, {0, sin(a), cos(a)}}};
    const Rotation about_y = {{{cos(b), 0, sin(b)}, {0, 1, 0}, {-sin(b), 0, cos(b)}}};
    const Rotation about_z = {{{cos(c), -sin(c), 0}, {sin(c), cos(c), 0}, {0, 0, 1}}};
    Rotation first = product(&about_y, &about_x);
    return product(&about_z, &first);
}

static void apply(const Rotation *rotation, const double *vector, double *to) {
    for (int i = 0; i < 3; i++) {
        to[i] = 0;
        for (int j = 0; j < 3; j++) to[i] += rotation->row[i][j] * vector[j];
    }
}

/* The other way. */
static void take_back(const Rotation *rotation, const double *vector, double *to) {
    for (int i = 0; i < 3; i++) {
        to[i] = 0;
        for (int j = 0; j < 3; j++) to[i] += rotation->row[j][i] * vector[j];
    }
}

/* A point of a body, in the frame that the body stands in. */
static void outside(const Body *body, const double *point, double *to) {
    apply(&body->rotation, point, to);
    for (int i = 0; i < 3; i++) to[i] += body->place[i];
}

static bool turns(const Link *link) {
    return link->along >= A;
}

static double at(const Motion *motion, double q) {
    double wave = motion->period == 0 ? 0 : motion->amplitude * sin(2 * M_PI * q / motion->period + motion->phase);
    return motion->curve[0] + motion->curve[1] * q + motion->curve[2] * q * q + wave;
}

/* The body of an axis at a position q, in the frame of the body that carries it. */
static Body moved(const Link *link, double q, double temperature, bool errs) {
    double motion[MOTIONS], aligned[MOTIONS], own[MOTIONS] = {0};
    for (int i = X; i < MOTIONS; i++) {
        motion[i] = errs ? at(&link->motion[i], q) : 0;
        aligned[i] = errs ? link->aligned[i] : 0;
    }
    double growth = errs ? link->expansion * (temperature - 20) * q : 0;
    own[link->along] = link->way * (q + motion[link->along] + aligned[link->along] + growth);
    motion[link->along] = aligned[link->along] = 0;
    Rotation line = turned(aligned[A], aligned[B], aligned[C]);
    Body body = {turned(motion[A], motion[B], motion[C]), {0, 0, 0}};
    apply(&line, own, body.place);
    if (turns(link)) {
        Rotation tilted = product(&line, &body.rotation), about = turned(own[A], own[B], own[C]);
        body.rotation = product(&tilted, &about);
    }
    for (int i = X; i <= Z; i++) body.place[i] += link->origin[i] + aligned[i] + motion[i];
    return body;
}

/* The last body of a branch, in the frame of the bed. */
static Body end(bool carries_part, const double *position, double temperature, bool errs) {
    Body body = {turned(0, 0, 0), {0, 0, 0}};
    for (int i = 0; i < LINKS; i++) {
        if (links[i].carries_part != carries_part) continue;
        Body next = moved(&links[i], position[i], temperature, errs);
        Body carried = {product(&body.rotation, &next.rotation), {0, 0, 0}};
        outside(&body, next.place, carried.place);
        body = carried;
    }
    return body;
}

static Tool seen(const double *position, double temperature, bool errs) {
    Body of_part = end(true, position, temperature, errs), of_tool = end(false, position, temperature, errs);
    const double up[3] = {0, 0, 1};
    double zero[3], tip[3], way[3], direction[3];
    outside(&of_part, part, zero);
    outside(&of_tool, tool, tip);
    for (int i = X; i <= Z; i++) way[i] = tip[i] - zero[i];
    apply(&of_tool.rotation, up, direction);
    Tool view;
    take_back(&of_part.rotation, way, view.tip);
    take_back(&of_part.rotation, direction, view.direction);
    return view;
}

/* The small angle between the directions of two tools, arcsec. */
static double between(const Tool *a, const Tool *b) {
    double square = 0;
    for (int i = X; i <= Z; i++) square += pow(a->direction[i] - b->direction[i], 2);
    return sqrt(square) * 180 / M_PI * 3600;
}

/* An axis follows its drive when that has gone through its play. */
static void take_along(int i, double drive) {
    double play = links[i].play / 2;
    axis[i] = fmin(fmax(axis[i], drive - play), drive + play);
}

static void update(void *unused, long period) {
    (void)unused;
    (void)period;
    double wanted[LINKS], temperature = *pins->temperature;
    for (int i = 0; i < LINKS; i++) {
        double unit = turns(&links[i]) ? M_PI / 180 : 1;
        wanted[i] = *pins->position[i] * unit;
        *pins->fb[i] = *pins->cmd[i];
        take_along(i, *pins->cmd[i] * unit);
    }
    Tool nominal = seen(wanted, temperature, false), actual = seen(axis, temperature, true);
    for (int i = X; i <= Z; i++) {
        *pins->tip[i] = actual.tip[i];
        *pins->nominal[i] = nominal.tip[i];
        *pins->error[i] = actual.tip[i] - nominal.tip[i];
    }
    *pins->turned = between(&actual, &nominal);
}

static int axis_pins(int i) {
    char letter = links[i].letter;
    /* As after a motion towards greater positions. */
    axis[i] = -links[i].play / 2;
    return hal_pin_float_newf(HAL_IN, &pins->position[i], component, "plant.%c.position", letter) ||
           hal_pin_float_newf(HAL_IN, &pins->cmd[i], component, "plant.%c.cmd", letter) ||
           hal_pin_float_newf(HAL_OUT, &pins->fb[i], component, "plant.%c.fb", letter);
}

static int direction_pins(int i) {
    char letter = "xyz"[i];
    return hal_pin_float_newf(HAL_OUT, &pins->tip[i], component, "plant.%c.tip", letter) ||
           hal_pin_float_newf(HAL_OUT, &pins->nominal[i], component, "plant.%c.nominal", letter) ||
           hal_pin_float_newf(HAL_OUT, &pins->error[i], component, "plant.%c.error", letter);
}

static int export_pins(void) {
    pins = hal_malloc(sizeof *pins);
    if (pins == NULL) return -1;
    memset(pins, 0, sizeof *pins);
    for (int i = 0; i < LINKS; i++) {
        if (axis_pins(i)) return -1;
    }
    for (int i = X; i <= Z; i++) {
        if (direction_pins(i)) return -1;
    }
    if (hal_pin_float_newf(HAL_OUT, &pins->turned, component, "plant.turned") ||
        hal_pin_float_newf(HAL_IN, &pins->temperature, component, "plant.temperature")) {
        return -1;
    }
    return hal_export_funct("plant.update", update, NULL, 1, 0, component);
}

void rtapi_app_exit(void) {
    hal_exit(component);
}

int rtapi_app_main(void) {
    component = hal_init("plant");
    if (component < 0) return component;
    if (export_pins()) {
        hal_exit(component);
        return -1;
    }
    return hal_ready(component);
}
