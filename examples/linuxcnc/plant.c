/*
 * A mill with errors, for tests: a HAL component of LinuxCNC between commands and feedback.
 *
 * In: the command of each drive, and a temperature. Out: what each drive's encoder says, and where the tip of the tool truly
 * stands relative to the part. It exists as an oracle that shares nothing with Abbe: rigid bodies with finite
 * rotations, a play that is a play, and its own numbers, which mill-12.yaml states as a calibration would.
 *
 *     bed -> Y saddle -> X table -> part        bed -> Z head -> tool
 *
 * The drives follow their commands at once: what they would lag behind is no error of the geometry.
 */
#include <math.h>
#include <string.h>

#include "rtapi.h"
#include "rtapi_app.h"
#include "hal.h"

MODULE_AUTHOR("Abbe");
MODULE_DESCRIPTION("A mill with errors, for tests");
MODULE_LICENSE("Dual MIT/GPL");

enum { X, Y, Z, AXES };

/* Lost motion of each axis, mm. */
static const double LOST_MOTION[AXES] = {0.009, 0.012, 0.005};
/* From the origin of the head to the tip of the tool, mm. */
static const double TOOL = 120;

typedef struct {
    double row[3][3];
} Rotation;

typedef struct {
    Rotation rotation;
    double place[3];
} Body;

typedef struct {
    hal_float_t *cmd[AXES];
    hal_float_t *fb[AXES];
    hal_float_t *tip[AXES];
    hal_float_t *temperature;
} Pins;

static int component = -1;
static Pins *pins;
/* Where each slide stands behind its play, mm. */
static double slide[AXES];

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

/* A point of a body, in the frame that the body stands in. */
static void outside(const Body *body, const double *point, double *to) {
    apply(&body->rotation, point, to);
    for (int i = 0; i < 3; i++) to[i] += body->place[i];
}

/* The other way. */
static void inside(const Body *body, const double *point, double *to) {
    double from[3];
    for (int i = 0; i < 3; i++) from[i] = point[i] - body->place[i];
    for (int i = 0; i < 3; i++) {
        to[i] = 0;
        for (int j = 0; j < 3; j++) to[i] += body->rotation.row[j][i] * from[j];
    }
}

/* The table moves towards -X for +X. It is long, and grows with its temperature. */
static Body table(double x, double temperature) {
    double scale = 60e-6 * x - 9e-8 * x * x + 11e-6 * (temperature - 20) * x;
    double roll = 0.12e-6 * x, pitch = 30e-6 - 0.35e-6 * x, yaw = 0.2e-6 * x;
    return (Body){turned(roll, pitch, yaw), {-(x + scale), 8e-5 * x - 3e-7 * x * x, 5e-5 * x}};
}

/* The saddle moves towards -Y for +Y, along a line that is not square to X. */
static Body saddle(double y) {
    const double not_square = 140e-6;
    double scale = -90e-6 * y;
    double pitch = 0.25e-6 * y, roll = -0.1e-6 * y, yaw = 0.15e-6 * y;
    Rotation line = turned(0, 0, not_square);
    double along[3] = {0, -y, 0};
    Body body = {turned(pitch, roll, yaw), {0, 0, 0}};
    apply(&line, along, body.place);
    body.place[X] += 4e-5 * y - 2e-7 * y * y;
    body.place[Y] -= scale;
    return body;
}

/* The head moves towards +Z for +Z, along a line that is square to neither X nor Y. */
static Body head(double z) {
    const double not_square_to_y = -80e-6, not_square_to_x = 70e-6;
    double scale = 110e-6 * z;
    double pitch = 0.3e-6 * z, yaw = -0.2e-6 * z;
    Rotation line = turned(not_square_to_y, not_square_to_x, 0);
    double along[3] = {0, 0, z};
    Body body = {turned(pitch, yaw, 0), {0, 0, 0}};
    apply(&line, along, body.place);
    body.place[X] += 3e-5 * z;
    body.place[Z] += scale;
    return body;
}

/* A slide follows its screw when that has gone through its play. */
static void take_along(int axis, double screw) {
    double play = LOST_MOTION[axis] / 2;
    slide[axis] = fmin(fmax(slide[axis], screw - play), screw + play);
}

static void update(void *unused, long period) {
    (void)unused;
    (void)period;
    for (int axis = X; axis < AXES; axis++) {
        double screw = *pins->cmd[axis];
        *pins->fb[axis] = screw;
        take_along(axis, screw);
    }
    Body of_table = table(slide[X], *pins->temperature), of_saddle = saddle(slide[Y]), of_head = head(slide[Z]);
    const double tool[3] = {0, 0, TOOL};
    double tip[3], on_saddle[3], on_part[3];
    outside(&of_head, tool, tip);
    inside(&of_saddle, tip, on_saddle);
    inside(&of_table, on_saddle, on_part);
    for (int axis = X; axis < AXES; axis++) *pins->tip[axis] = on_part[axis];
}

static int export_pins(void) {
    static const char letters[] = "xyz";
    pins = hal_malloc(sizeof *pins);
    if (pins == NULL) return -1;
    memset(pins, 0, sizeof *pins);
    for (int axis = X; axis < AXES; axis++) {
        if (hal_pin_float_newf(HAL_IN, &pins->cmd[axis], component, "plant.%c.cmd", letters[axis]) ||
            hal_pin_float_newf(HAL_OUT, &pins->fb[axis], component, "plant.%c.fb", letters[axis]) ||
            hal_pin_float_newf(HAL_OUT, &pins->tip[axis], component, "plant.%c.tip", letters[axis])) {
            return -1;
        }
        /* As after a motion towards greater positions. */
        slide[axis] = -LOST_MOTION[axis] / 2;
    }
    if (hal_pin_float_newf(HAL_IN, &pins->temperature, component, "plant.temperature")) return -1;
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
