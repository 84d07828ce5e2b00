/*
 * A controller in C that tests what abbe.h says.
 *
 * In: `numbers CALIBRATION TABLE`, a table of `abbe compensate` for the same calibration; `statuses CALIBRATION`; or `hostile
 * CALIBRATION`. Out: status 0 and a line, or the place of the first thing that does not hold. It exists to be run under
 * sanitizers and valgrind, and counts what is allocated in a cycle.
 */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "abbe.h"

enum { AXES = 3, SENSORS = 2 };

#define HOLDS(what) ((what) ? (void)0 : broken(__LINE__, #what))

static void broken(int line, const char *what) {
    fprintf(stderr, "controller.c:%d: does not hold: %s\n", line, what);
    exit(1);
}

/* The linker sends every allocation here, those of the library too (-Wl,--wrap). */
static long allocations;
#ifdef COUNTED
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
int __real_posix_memalign(void **to, size_t alignment, size_t size);
void *__wrap_malloc(size_t size) { allocations++; return __real_malloc(size); }
void *__wrap_calloc(size_t count, size_t size) { allocations++; return __real_calloc(count, size); }
void *__wrap_realloc(void *old, size_t size) { allocations++; return __real_realloc(old, size); }
int __wrap_posix_memalign(void **to, size_t alignment, size_t size) {
    allocations++;
    return __real_posix_memalign(to, alignment, size);
}
#endif

static Abbe *opened(const char *calibration) {
    char message[4096];
    Abbe *abbe = NULL;
    AbbeStatus status = abbe_open(calibration, &abbe, message, sizeof message);
    if (status != ABBE_STATUS_DONE) {
        fprintf(stderr, "%s\n%s\n", abbe_status_text(status), message);
        exit(1);
    }
    HOLDS(abbe != NULL);
    return abbe;
}

/* Each row of the table is a cycle; the correction must be the one in the table, which has eight digits of a mm or more. */
static void numbers(const char *calibration, const char *table) {
    Abbe *abbe = opened(calibration);
    abbe_enable(abbe, true);
    FILE *rows = fopen(table, "r");
    HOLDS(rows != NULL);
    char line[1024];
    HOLDS(fgets(line, sizeof line, rows) != NULL);
    HOLDS(strcmp(line, "t,x,y,z,dir_x,dir_y,dir_z,T_column,T_table,error_x,error_y,error_z,x_comp,y_comp,z_comp\n") == 0);
    double before = 0, worst = 0, largest = 0;
    long count = 0, taken = 0;
    while (fgets(line, sizeof line, rows) != NULL) {
        double row[15];
        char *at = line;
        for (int column = 0; column < 15; column++) {
            row[column] = strtod(at, &at);
            at++;
        }
        double correction[AXES];
        AbbeSample sample = {row + 1, row + 4, AXES, row + 7, SENSORS, count == 0 ? 0 : row[0] - before};
        AbbeCycle cycle;
        long allocated = allocations;
        HOLDS(abbe_update(abbe, &sample, correction, &cycle) == ABBE_STATUS_ACTIVE);
        taken += allocations - allocated;
        before = row[0];
        /* No time has passed before the first row, and nothing has faded in. */
        if (count++ == 0) continue;
        for (int axis = 0; axis < AXES; axis++) {
            double expected = row[12 + axis] - row[1 + axis];
            worst = fmax(worst, fabs(correction[axis] - expected));
            worst = fmax(worst, fabs(cycle.error[axis] - row[9 + axis]));
            largest = fmax(largest, fabs(correction[axis]));
        }
        HOLDS(!cycle.settling && cycle.refused == ABBE_REFUSED_NO && cycle.sensor == -1);
    }
    fclose(rows);
    abbe_close(abbe);
    HOLDS(count > 1000 && largest > 0.02);
    HOLDS(worst < 1e-9);
    HOLDS(taken == 0);
#ifdef COUNTED
    HOLDS(allocations > 0);
    printf("no allocation in a cycle, of %ld altogether\n", allocations);
#endif
    printf("%ld cycles as `abbe compensate` has them, to %.1e mm of up to %.3f mm\n", count, worst, largest);
}

/* One cycle of 1 ms at a place. The directions are given: a correction that fades would turn a screw too. */
static AbbeStatus at(Abbe *abbe, double x, const double *temperature, double *correction, AbbeCycle *cycle) {
    const double position[AXES] = {x, 100, -50}, onward[AXES] = {1, 1, 1};
    AbbeSample sample = {position, onward, AXES, temperature, SENSORS, 0.001};
    return abbe_update(abbe, &sample, correction, cycle);
}

static double length(const double *vector) {
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

/* So many cycles at one place. All answer the same, and no step is longer than it may be while something fades. */
static void stay(Abbe *abbe, int cycles, double x, const double *temperature, AbbeStatus status, double *made) {
    double largest = 0;
    for (int cycle = 0; cycle < cycles; cycle++) {
        double correction[AXES], step[AXES];
        HOLDS(at(abbe, x, temperature, correction, NULL) == status);
        for (int axis = 0; axis < AXES; axis++) {
            step[axis] = correction[axis] - made[axis];
            made[axis] = correction[axis];
        }
        largest = fmax(largest, length(step));
    }
    /* Less than 0.3 mm, which is the limit, over the 500 cycles of a fade. */
    HOLDS(largest <= 0.3 / 500 * 1.001);
}

/* Every status that a machine can bring about. */
static void statuses(const char *calibration) {
    Abbe *abbe = opened(calibration);
    const double warm[SENSORS] = {22, 24}, silent[SENSORS] = {22, NAN};
    double made[AXES] = {0, 0, 0}, active[AXES];
    AbbeCycle cycle;

    stay(abbe, 10, 400, warm, ABBE_STATUS_OFF, made);
    HOLDS(length(made) == 0);
    HOLDS(abbe_enable(abbe, true) == ABBE_STATUS_DONE);
    stay(abbe, 600, 400, warm, ABBE_STATUS_ACTIVE, made);
    HOLDS(length(made) > 0.02);
    memcpy(active, made, sizeof active);

    /* A silent sensor is held for 0.1 s, then the correction fades out, and in again once it speaks. */
    HOLDS(at(abbe, 400, silent, made, &cycle) == ABBE_STATUS_HOLDING);
    HOLDS(cycle.sensor == 1 && strcmp(abbe_sensor_name(abbe, 1), "table") == 0);
    stay(abbe, 98, 400, silent, ABBE_STATUS_HOLDING, made);
    for (int more = 0; more < 3; more++) at(abbe, 400, silent, made, &cycle);
    HOLDS(at(abbe, 400, silent, made, &cycle) == ABBE_STATUS_LOST && cycle.sensor == 1 && cycle.settling);
    stay(abbe, 600, 400, silent, ABBE_STATUS_LOST, made);
    HOLDS(length(made) == 0);
    stay(abbe, 600, 400, warm, ABBE_STATUS_ACTIVE, made);
    HOLDS(fabs(length(made) - length(active)) < 1e-3);

    /* A position that is no number, a correction beyond the limit, a time that goes back. */
    HOLDS(at(abbe, NAN, warm, made, &cycle) == ABBE_STATUS_REFUSED && cycle.refused == ABBE_REFUSED_NOT_FINITE);
    HOLDS(isfinite(made[0]) && isfinite(made[1]) && isfinite(made[2]));
    HOLDS(at(abbe, INFINITY, warm, made, &cycle) == ABBE_STATUS_REFUSED);
    const double fire[SENSORS] = {22, 2000};
    HOLDS(at(abbe, 400, fire, made, &cycle) == ABBE_STATUS_REFUSED && cycle.refused == ABBE_REFUSED_OVER_LIMIT);
    double position[AXES] = {400, 100, -50};
    AbbeSample backwards = {position, NULL, AXES, warm, SENSORS, -0.001};
    HOLDS(abbe_update(abbe, &backwards, made, &cycle) == ABBE_STATUS_REFUSED && cycle.refused == ABBE_REFUSED_TIME_STEP);
    stay(abbe, 600, 400, warm, ABBE_STATUS_ACTIVE, made);

    /* The direction that is given is taken: half of 8 um of lost motion to either side, X first. */
    double forward[AXES], backward[AXES];
    const double up[AXES] = {1, 1, 1}, down[AXES] = {-1, 1, 1};
    AbbeSample directed = {position, up, AXES, warm, SENSORS, 0.001};
    abbe_update(abbe, &directed, forward, NULL);
    directed.direction = down;
    for (int cycles = 0; cycles < 10; cycles++) abbe_update(abbe, &directed, backward, NULL);
    HOLDS(fabs(forward[0] - backward[0] - 0.008) < 1e-5);

    /* Switched off it fades out; a restart leaves what is made. */
    memcpy(made, backward, sizeof made);
    HOLDS(abbe_restart(abbe) == ABBE_STATUS_DONE);
    stay(abbe, 1, 400, warm, ABBE_STATUS_ACTIVE, made);
    HOLDS(abbe_enable(abbe, false) == ABBE_STATUS_DONE);
    stay(abbe, 600, 400, warm, ABBE_STATUS_OFF, made);
    HOLDS(length(made) == 0);
    abbe_close(abbe);
    printf("every status, and no step of more than the fade allows\n");
}

/* What a program in C can get wrong and a library can see. Nothing may be written then. */
static void hostile(const char *calibration) {
    char message[8] = "1234567";
    Abbe *abbe = (Abbe *)message;
    HOLDS(abbe_open(NULL, &abbe, message, sizeof message) == ABBE_STATUS_NULL_POINTER);
    HOLDS(abbe_open(calibration, NULL, message, sizeof message) == ABBE_STATUS_NULL_POINTER);
    HOLDS(strcmp(message, "1234567") == 0);
    HOLDS(abbe_open("no such file", &abbe, message, sizeof message) == ABBE_STATUS_CALIBRATION && abbe == NULL);
    HOLDS(strcmp(message, "error: ") == 0);
    HOLDS(abbe_open("/", &abbe, message, 1) == ABBE_STATUS_CALIBRATION && message[0] == 0);
    HOLDS(abbe_open("\xff\xfe", &abbe, message, 0) == ABBE_STATUS_CALIBRATION && message[0] == 0);
    HOLDS(abbe_open("/dev/null", &abbe, NULL, 100) == ABBE_STATUS_CALIBRATION && abbe == NULL);

    const double place[AXES] = {1, 2, 3}, warm[SENSORS] = {20, 20}, sideways[AXES] = {1, 0.5, -1}, none[AXES] = {NAN, 1, 1};
    double correction[AXES] = {7, 8, 9};
    AbbeSample sample = {place, NULL, AXES, warm, SENSORS, 0.001}, wrong;
    HOLDS(abbe_update(NULL, &sample, correction, NULL) == ABBE_STATUS_NULL_POINTER);
    HOLDS(abbe_enable(NULL, true) == ABBE_STATUS_NULL_POINTER && abbe_restart(NULL) == ABBE_STATUS_NULL_POINTER);
    HOLDS(abbe_set_hysteresis(NULL, 0, 1) == ABBE_STATUS_NULL_POINTER);
    HOLDS(abbe_axes(NULL) == 0 && abbe_sensors(NULL) == 0 && abbe_machine(NULL) == NULL);
    HOLDS(abbe_axis_letter(NULL, 0) == NULL && abbe_sensor_name(NULL, 0) == NULL && !abbe_axis_is_rotary(NULL, 0));
    abbe_close(NULL);

    abbe = opened(calibration);
    HOLDS(abbe_axes(abbe) == AXES && abbe_sensors(abbe) == SENSORS && strcmp(abbe_machine(abbe), "small-mill") == 0);
    HOLDS(strcmp(abbe_axis_letter(abbe, 2), "Z") == 0 && abbe_axis_letter(abbe, AXES) == NULL);
    HOLDS(abbe_axis_letter(abbe, SIZE_MAX) == NULL && abbe_sensor_name(abbe, SENSORS) == NULL);
    HOLDS(!abbe_axis_is_rotary(abbe, 0) && !abbe_axis_is_rotary(abbe, SIZE_MAX));
    HOLDS(abbe_set_hysteresis(abbe, AXES, 0.001) == ABBE_STATUS_OUT_OF_RANGE);
    HOLDS(abbe_set_hysteresis(abbe, 0, -1) == ABBE_STATUS_OUT_OF_RANGE);
    HOLDS(abbe_set_hysteresis(abbe, 0, NAN) == ABBE_STATUS_OUT_OF_RANGE);
    HOLDS(abbe_set_hysteresis(abbe, 0, 0.002) == ABBE_STATUS_DONE);
    HOLDS(abbe_update(abbe, NULL, correction, NULL) == ABBE_STATUS_NULL_POINTER);
    HOLDS(abbe_update(abbe, &sample, NULL, NULL) == ABBE_STATUS_NULL_POINTER);
    wrong = sample, wrong.position = NULL;
    HOLDS(abbe_update(abbe, &wrong, correction, NULL) == ABBE_STATUS_NULL_POINTER);
    wrong = sample, wrong.temperature = NULL;
    HOLDS(abbe_update(abbe, &wrong, correction, NULL) == ABBE_STATUS_NULL_POINTER);
    const size_t lengths[] = {0, 1, AXES - 1, AXES + 1, SIZE_MAX / 8, SIZE_MAX};
    for (size_t length = 0; length < sizeof lengths / sizeof *lengths; length++) {
        wrong = sample, wrong.axes = lengths[length];
        HOLDS(abbe_update(abbe, &wrong, correction, NULL) == ABBE_STATUS_WRONG_LENGTH);
        wrong = sample, wrong.sensors = lengths[length] == 2 ? 4 : lengths[length];
        HOLDS(abbe_update(abbe, &wrong, correction, NULL) == ABBE_STATUS_WRONG_LENGTH);
    }
    wrong = sample, wrong.direction = sideways;
    HOLDS(abbe_update(abbe, &wrong, correction, NULL) == ABBE_STATUS_OUT_OF_RANGE);
    wrong.direction = none;
    HOLDS(abbe_update(abbe, &wrong, correction, NULL) == ABBE_STATUS_OUT_OF_RANGE);
    HOLDS(correction[0] == 7 && correction[1] == 8 && correction[2] == 9);

    /* The correction may take the place of the positions. */
    double both[AXES] = {1, 2, 3};
    sample.position = both;
    HOLDS(abbe_update(abbe, &sample, both, NULL) == ABBE_STATUS_OFF && length(both) == 0);
    for (int32_t status = -10; status < 10; status++) HOLDS(strlen(abbe_status_text(status)) > 3);
    HOLDS(strcmp(abbe_status_text(INT32_MIN), "not a status of Abbe") == 0);
    HOLDS(strchr(abbe_version(), '.') != NULL);
    abbe_close(abbe);
    printf("null pointers, wrong lengths, wrong numbers: each has its status, and nothing is written\n");
}

static void *switching(void *handle) {
    for (int switches = 0; switches < 20000; switches++) {
        HOLDS(abbe_enable(handle, switches % 2 == 0) == ABBE_STATUS_DONE);
        AbbeStatus status = abbe_restart(handle);
        HOLDS(status == ABBE_STATUS_DONE || status == ABBE_STATUS_BUSY);
    }
    return NULL;
}

/* An operator's thread beside the servo thread: a call may be told that the other is inside, and nothing else happens. */
static void threads(const char *calibration) {
    Abbe *abbe = opened(calibration);
    const double warm[SENSORS] = {20, 20};
    pthread_t operator;
    HOLDS(pthread_create(&operator, NULL, switching, abbe) == 0);
    for (int cycle = 0; cycle < 20000; cycle++) {
        double correction[AXES] = {0, 0, 0};
        AbbeStatus status = at(abbe, cycle * 0.01, warm, correction, NULL);
        HOLDS(status == ABBE_STATUS_ACTIVE || status == ABBE_STATUS_OFF || status == ABBE_STATUS_BUSY);
        HOLDS(length(correction) <= 0.3);
    }
    HOLDS(pthread_join(operator, NULL) == 0);
    abbe_close(abbe);
    printf("two threads in one handle: one of them is told so\n");
}

int main(int count, char **words) {
    if (count == 4 && strcmp(words[1], "numbers") == 0) numbers(words[2], words[3]);
    else if (count == 3 && strcmp(words[1], "statuses") == 0) statuses(words[2]);
    else if (count == 3 && strcmp(words[1], "hostile") == 0) hostile(words[2]);
    else if (count == 3 && strcmp(words[1], "threads") == 0) threads(words[2]);
    else return 2;
    return 0;
}
