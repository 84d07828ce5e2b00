/*
 * A HAL component of LinuxCNC: the compensation of one machine, in the servo thread.
 *
 * In: the commanded position of each joint, what its drive is commanded and answers, temperatures. Out: the drive's command with
 * the correction of Abbe added, and the drive's answer with it taken out again, so that the motion controller sees the
 * position that it asked for. It exists to be loaded between `joint.N.motor-pos-cmd` and the drives:
 *
 *     loadrt abbe calibration=/home/me/mill-7.yaml
 *
 * All that is slow is done while it is loaded. A cycle reads no file, allocates nothing and does not wait.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rtapi.h"
#include "rtapi_app.h"
#include "hal.h"

#include "abbe.h"

MODULE_AUTHOR("Abbe");
MODULE_DESCRIPTION("Compensation of a machine's geometric and thermal errors");
MODULE_LICENSE("Dual MIT/GPL");

static char *calibration = "";
RTAPI_MP_STRING(calibration, "path of the calibration file, as the real-time process sees it");
static char *unit = "1";
RTAPI_MP_STRING(unit, "mm in one unit of the machine's linear joints: 25.4 for inches");

enum { MOST_AXES = 9, MOST_SENSORS = 32, MESSAGE = 4096 };

/* The pins of one axis. */
typedef struct {
    hal_float_t *position;   /* in: joint.N.pos-cmd, machine coordinates */
    hal_bit_t *homed;        /* in: joint.N.homed */
    hal_s32_t *direction;    /* in: +1, -1, or 0: found from the positions */
    hal_float_t *cmd_in;     /* in: joint.N.motor-pos-cmd */
    hal_float_t *cmd_out;    /* out: to the drive */
    hal_float_t *fb_in;      /* in: from the drive */
    hal_float_t *fb_out;     /* out: joint.N.motor-pos-fb */
    hal_float_t *correction; /* out: what is added */
} AxisPins;

/* The pins of one temperature sensor. */
typedef struct {
    hal_float_t *temperature; /* in: degC; a pin that nothing is wired to is a silent sensor */
    hal_bit_t *valid;         /* in: false: silent */
} SensorPins;

typedef struct {
    AxisPins axis[MOST_AXES];
    SensorPins sensor[MOST_SENSORS];
    hal_bit_t *enable;     /* in: what the operator wants */
    hal_bit_t *enabled;    /* out: wanted, and every axis is homed */
    hal_bit_t *active;     /* out: the model is sure of its correction */
    hal_bit_t *settling;   /* out: the correction is on its way to what the status asks for */
    hal_bit_t *fault;      /* out: wanted, and not to be had */
    hal_s32_t *status;     /* out: AbbeStatus */
    hal_s32_t *refused;    /* out: AbbeRefused */
    hal_float_t *error[3]; /* out: what the model says without compensation, X Y Z of the part, mm */
    hal_float_t *lean[3];  /* out: the same of the direction of the tool, I J K, rad; where rotary axes correct it */
    hal_s32_t *tool;       /* in: the number of the tool; 0: none */
    hal_bit_t *no_tool;    /* out: the calibration has no tool of that number, and its constants themselves count */
    hal_s32_t *time;       /* out: how long the last cycle took, ns */
    hal_s32_t *time_max;   /* in, out: the longest one, ns; 0 begins anew */
} Pins;

static int component = -1;
static Abbe *abbe;
static Pins *pins;
static size_t axes, sensors;
static bool aims; /* rotary axes correct the direction of the tool */
static double mm[MOST_AXES]; /* mm or rad in one unit of the joint */
static bool was_homed;
static int last_tool;

/* Before the motion controller: what the drives answer, without what was added to their commands. */
static void read_feedback(void *unused, long period) {
    (void)unused;
    (void)period;
    for (size_t i = 0; i < axes; i++) {
        AxisPins *axis = &pins->axis[i];
        *axis->fb_out = *axis->fb_in - *axis->correction;
    }
}

static bool all_homed(void) {
    for (size_t i = 0; i < axes; i++) {
        if (!*pins->axis[i].homed) return false;
    }
    return true;
}

/* The digits of a number above zero, which end with a zero byte. */
static void digits(int number, char *to, size_t size) {
    char reversed[16];
    size_t count = 0, i = 0;
    for (; number > 0 && count < sizeof reversed; number /= 10) reversed[count++] = '0' + number % 10;
    for (; count > 0 && i + 1 < size; i++) to[i] = reversed[--count];
    to[i] = 0;
}

/* Takes another tool when its number changes: that of the calibration's name, or none. */
static void change_tool(void) {
    int tool = *pins->tool;
    if (tool == last_tool) return;
    char name[16];
    digits(tool, name, sizeof name);
    AbbeStatus status = tool > 0 ? abbe_set_tool(abbe, name) : ABBE_STATUS_OUT_OF_RANGE;
    bool known = status == ABBE_STATUS_DONE;
    if (!known) status = abbe_set_tool(abbe, NULL);
    /* Another call was inside: it is tried again in the next cycle. */
    if (status != ABBE_STATUS_DONE) return;
    *pins->no_tool = tool != 0 && !known;
    last_tool = tool;
}

static void tell(AbbeStatus status, const AbbeCycle *cycle) {
    bool wanted = *pins->enable;
    *pins->status = status;
    *pins->active = status == ABBE_STATUS_ACTIVE || status == ABBE_STATUS_HOLDING;
    *pins->fault = wanted && status != ABBE_STATUS_ACTIVE && status != ABBE_STATUS_HOLDING;
    if (status < 0) return;
    *pins->refused = cycle->refused;
    *pins->settling = cycle->settling;
    for (int i = 0; i < 3; i++) *pins->error[i] = cycle->error[i];
    double lean[3];
    if (!aims || abbe_direction(abbe, lean, NULL) != ABBE_STATUS_DONE) return;
    for (int i = 0; i < 3; i++) *pins->lean[i] = lean[i];
}

/* One cycle of the model. After a fault of a call the last corrections stay. */
static void correct(long period) {
    double position[MOST_AXES], direction[MOST_AXES], correction[MOST_AXES], temperature[MOST_SENSORS];
    AbbeCycle cycle;
    for (size_t i = 0; i < axes; i++) {
        position[i] = *pins->axis[i].position * mm[i];
        direction[i] = *pins->axis[i].direction;
    }
    for (size_t i = 0; i < sensors; i++) {
        temperature[i] = *pins->sensor[i].valid ? *pins->sensor[i].temperature : NAN;
    }
    /* A machine is where it says only once it is homed; and what moved before that was not the machine's motion. */
    bool homed = all_homed();
    if (homed && !was_homed) abbe_restart(abbe);
    was_homed = homed;
    *pins->enabled = homed && *pins->enable;
    abbe_enable(abbe, *pins->enabled);
    change_tool();
    AbbeSample sample = {position, direction, axes, temperature, sensors, period * 1e-9};
    AbbeStatus status = abbe_update(abbe, &sample, correction, &cycle);
    if (status >= 0) {
        for (size_t i = 0; i < axes; i++) *pins->axis[i].correction = correction[i] / mm[i];
    }
    tell(status, &cycle);
}

/* After the motion controller: what the drives are commanded. */
static void update(void *unused, long period) {
    (void)unused;
    long long began = rtapi_get_time();
    correct(period);
    for (size_t i = 0; i < axes; i++) {
        AxisPins *axis = &pins->axis[i];
        *axis->cmd_out = *axis->cmd_in + *axis->correction;
    }
    *pins->time = (hal_s32_t)(rtapi_get_time() - began);
    if (*pins->time > *pins->time_max) *pins->time_max = *pins->time;
}

/* A letter or name as a part of a pin's name. */
static void pin_name(const char *name, char *to, size_t size) {
    size_t i = 0;
    for (; name[i] != 0 && i + 1 < size; i++) {
        char letter = name[i];
        if (letter >= 'A' && letter <= 'Z') letter += 'a' - 'A';
        bool fits = (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '-';
        to[i] = fits ? letter : '-';
    }
    to[i] = 0;
}

static int axis_pins(AxisPins *axis, const char *letter) {
    char name[16];
    pin_name(letter, name, sizeof name);
    return hal_pin_float_newf(HAL_IN, &axis->position, component, "abbe.%s.position", name) ||
           hal_pin_bit_newf(HAL_IN, &axis->homed, component, "abbe.%s.homed", name) ||
           hal_pin_s32_newf(HAL_IN, &axis->direction, component, "abbe.%s.direction", name) ||
           hal_pin_float_newf(HAL_IN, &axis->cmd_in, component, "abbe.%s.cmd-in", name) ||
           hal_pin_float_newf(HAL_OUT, &axis->cmd_out, component, "abbe.%s.cmd-out", name) ||
           hal_pin_float_newf(HAL_IN, &axis->fb_in, component, "abbe.%s.fb-in", name) ||
           hal_pin_float_newf(HAL_OUT, &axis->fb_out, component, "abbe.%s.fb-out", name) ||
           hal_pin_float_newf(HAL_OUT, &axis->correction, component, "abbe.%s.correction", name);
}

static int sensor_pins(SensorPins *sensor, const char *sensor_name) {
    char name[24];
    pin_name(sensor_name, name, sizeof name);
    if (hal_pin_float_newf(HAL_IN, &sensor->temperature, component, "abbe.sensor.%s.temperature", name) ||
        hal_pin_bit_newf(HAL_IN, &sensor->valid, component, "abbe.sensor.%s.valid", name)) {
        return -1;
    }
    *sensor->temperature = NAN;
    *sensor->valid = true;
    return 0;
}

static int machine_pins(void) {
    static const char directions[] = "xyz", leans[] = "ijk";
    aims = abbe_direction(abbe, NULL, NULL) == ABBE_STATUS_DONE;
    for (int i = 0; i < 3; i++) {
        if (hal_pin_float_newf(HAL_OUT, &pins->error[i], component, "abbe.error.%c", directions[i])) return -1;
        if (aims && hal_pin_float_newf(HAL_OUT, &pins->lean[i], component, "abbe.error.%c", leans[i])) return -1;
    }
    return hal_pin_bit_newf(HAL_IN, &pins->enable, component, "abbe.enable") ||
           hal_pin_bit_newf(HAL_OUT, &pins->enabled, component, "abbe.enabled") ||
           hal_pin_bit_newf(HAL_OUT, &pins->active, component, "abbe.active") ||
           hal_pin_bit_newf(HAL_OUT, &pins->settling, component, "abbe.settling") ||
           hal_pin_bit_newf(HAL_OUT, &pins->fault, component, "abbe.fault") ||
           hal_pin_s32_newf(HAL_OUT, &pins->status, component, "abbe.status") ||
           hal_pin_s32_newf(HAL_OUT, &pins->refused, component, "abbe.refused") ||
           hal_pin_s32_newf(HAL_IN, &pins->tool, component, "abbe.tool") ||
           hal_pin_bit_newf(HAL_OUT, &pins->no_tool, component, "abbe.no-tool") ||
           hal_pin_s32_newf(HAL_OUT, &pins->time, component, "abbe.time") ||
           hal_pin_s32_newf(HAL_IO, &pins->time_max, component, "abbe.time-max");
}

static int export_pins(void) {
    pins = hal_malloc(sizeof *pins);
    if (pins == NULL) return -ENOMEM;
    memset(pins, 0, sizeof *pins);
    for (size_t i = 0; i < axes; i++) {
        if (axis_pins(&pins->axis[i], abbe_axis_letter(abbe, i))) return -EINVAL;
    }
    for (size_t i = 0; i < sensors; i++) {
        if (sensor_pins(&pins->sensor[i], abbe_sensor_name(abbe, i))) return -EINVAL;
    }
    if (machine_pins()) return -EINVAL;
    return hal_export_funct("abbe.read", read_feedback, NULL, 1, 0, component) ||
           hal_export_funct("abbe.update", update, NULL, 1, 0, component);
}

/* A message has more lines than rtapi prints at once. */
static void print_lines(char *message) {
    for (char *line = strtok(message, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        rtapi_print_msg(RTAPI_MSG_ERR, "abbe: %s\n", line);
    }
}

static int read_unit(double *to) {
    char *end;
    *to = strtod(unit, &end);
    if (*end == 0 && isfinite(*to) && *to > 0) return 0;
    rtapi_print_msg(RTAPI_MSG_ERR, "abbe: unit=%s is not a number of mm, such as 1 or 25.4\n", unit);
    return -EINVAL;
}

static int open_calibration(void) {
    static char message[MESSAGE];
    double linear;
    if (read_unit(&linear)) return -EINVAL;
    AbbeStatus status = abbe_open(calibration, &abbe, message, sizeof message);
    print_lines(message);
    if (status != ABBE_STATUS_DONE) return -EINVAL;
    axes = abbe_axes(abbe);
    sensors = abbe_sensors(abbe);
    if (axes > MOST_AXES || sensors > MOST_SENSORS) {
        rtapi_print_msg(RTAPI_MSG_ERR, "abbe: at most %d axes and %d sensors\n", MOST_AXES, MOST_SENSORS);
        return -EINVAL;
    }
    for (size_t i = 0; i < axes; i++) mm[i] = abbe_axis_is_rotary(abbe, i) ? M_PI / 180 : linear;
    return 0;
}

void rtapi_app_exit(void) {
    if (component >= 0) hal_exit(component);
    abbe_close(abbe);
    abbe = NULL;
}

int rtapi_app_main(void) {
    component = hal_init("abbe");
    if (component < 0) return component;
    int failed = open_calibration();
    if (!failed) failed = export_pins();
    if (failed) {
        rtapi_app_exit();
        return failed < 0 ? failed : -EINVAL;
    }
    return hal_ready(component);
}
