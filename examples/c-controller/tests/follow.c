/*
 * Follows a table of `abbe compensate` with any machine: motors, axes that lean, rotary axes and all.
 *
 * In: `follow CALIBRATION TABLE`; the table has positions and directions of all axes, those of motors too, and temperatures. Out: status 0
 * and a line where each cycle answers what its row has, or the place of the first thing that does not hold. Compiled with HAL, the cycles
 * go through the component of LinuxCNC, pin by pin, without LinuxCNC; without it, through abbe.h alone.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef HAL
#include "../../linuxcnc/abbe.c"
#else
#include "abbe.h"
#endif

enum { MOST_COLUMNS = 64, MOST = 16 };

#define HOLDS(what) ((what) ? (void)0 : broken(__LINE__, #what))

static void broken(int line, const char *what) {
    fprintf(stderr, "follow.c:%d: does not hold: %s\n", line, what);
    exit(1);
}

static char header[4096];
static char *names[MOST_COLUMNS];
static int columns;

/* The number of the column with this name. */
static int column(const char *before, const char *name, const char *behind) {
    char wanted[64];
    snprintf(wanted, sizeof wanted, "%s%s%s", before, name, behind);
    for (int number = 0; number < columns; number++) {
        if (strcmp(names[number], wanted) == 0) return number;
    }
    fprintf(stderr, "the table has no column %s\n", wanted);
    exit(1);
}

static void read_header(FILE *rows) {
    HOLDS(fgets(header, sizeof header, rows) != NULL);
    for (char *name = strtok(header, ",\n"); name != NULL; name = strtok(NULL, ",\n")) {
        HOLDS(columns < MOST_COLUMNS);
        names[columns++] = name;
    }
}

static bool read_row(FILE *rows, double *row) {
    char line[4096], *at = line;
    if (fgets(line, sizeof line, rows) == NULL) return false;
    for (int number = 0; number < columns; number++) {
        row[number] = strtod(at, &at);
        at++;
    }
    return true;
}

/* An axis of the machine, or a motor: its name in small letters, its columns, and how many mm or rad one of the table is. */
typedef struct {
    char name[16];
    int position, direction, command;
    double unit;
} Axis;

static Axis axis_of[MOST];
static int sensor_of[MOST];
static size_t axis_count, sensor_count;

static void find_columns(const Abbe *of) {
    axis_count = abbe_axes(of), sensor_count = abbe_sensors(of);
    HOLDS(axis_count <= MOST && sensor_count <= MOST);
    for (size_t number = 0; number < axis_count; number++) {
        Axis *axis = &axis_of[number];
        const char *letter = abbe_axis_letter(of, number);
        for (size_t at = 0; letter[at] != 0 && at + 1 < sizeof axis->name; at++) {
            axis->name[at] = letter[at] >= 'A' && letter[at] <= 'Z' ? letter[at] + 'a' - 'A' : letter[at];
        }
        axis->position = column("", axis->name, "");
        axis->direction = column("dir_", axis->name, "");
        axis->command = column("", axis->name, "_comp");
        axis->unit = abbe_axis_is_rotary(of, number) ? acos(-1) / 180 : 1;
    }
    for (size_t number = 0; number < sensor_count; number++) {
        sensor_of[number] = column("T_", abbe_sensor_name(of, number), "");
    }
}

/* One cycle; the commands in the units of the table. */
#ifdef HAL
static void cycle(const double *row, double time_step, double *commands) {
    *(hal_bit_t *)hal_pin("abbe.enable") = true;
    for (size_t number = 0; number < axis_count; number++) {
        const Axis *axis = &axis_of[number];
        *(hal_bit_t *)hal_pin("abbe.%s.homed", axis->name) = true;
        *(hal_float_t *)hal_pin("abbe.%s.position", axis->name) = row[axis->position];
        *(hal_float_t *)hal_pin("abbe.%s.cmd-in", axis->name) = row[axis->position];
        *(hal_s32_t *)hal_pin("abbe.%s.direction", axis->name) = (hal_s32_t)row[axis->direction];
    }
    for (size_t number = 0; number < sensor_count; number++) {
        *(hal_float_t *)hal_pin("abbe.sensor.%s.temperature", abbe_sensor_name(abbe, number)) = row[sensor_of[number]];
    }
    update(NULL, lround(time_step * 1e9));
    HOLDS(*(hal_s32_t *)hal_pin("abbe.status") == ABBE_STATUS_ACTIVE && !*(hal_bit_t *)hal_pin("abbe.fault"));
    for (size_t number = 0; number < axis_count; number++) {
        const char *name = axis_of[number].name;
        commands[number] = *(hal_float_t *)hal_pin("abbe.%s.cmd-out", name);
        /* A drive that is where it was told to be looks to LinuxCNC as if it were where it was asked to be. */
        *(hal_float_t *)hal_pin("abbe.%s.fb-in", name) = commands[number];
    }
    read_feedback(NULL, 0);
    for (size_t number = 0; number < axis_count; number++) {
        const Axis *axis = &axis_of[number];
        HOLDS(fabs(*(hal_float_t *)hal_pin("abbe.%s.fb-out", axis->name) - row[axis->position]) < 1e-12);
    }
}
#else
static Abbe *abbe;

static void cycle(const double *row, double time_step, double *commands) {
    double position[MOST], direction[MOST], temperature[MOST], correction[MOST];
    for (size_t number = 0; number < axis_count; number++) {
        position[number] = row[axis_of[number].position] * axis_of[number].unit;
        direction[number] = row[axis_of[number].direction];
    }
    for (size_t number = 0; number < sensor_count; number++) temperature[number] = row[sensor_of[number]];
    AbbeSample sample = {position, direction, axis_count, temperature, sensor_count, time_step};
    AbbeCycle told;
    HOLDS(abbe_update(abbe, &sample, correction, &told) == ABBE_STATUS_ACTIVE);
    HOLDS(told.refused == ABBE_REFUSED_NO);
    for (size_t number = 0; number < axis_count; number++) {
        commands[number] = (position[number] + correction[number]) / axis_of[number].unit;
    }
}

/* Motors that do not stand where their axes put them are a mistake of the controller, and told as one. */
static void refuses_a_motor(const double *row) {
    double position[MOST], temperature[MOST], correction[MOST];
    for (size_t number = 0; number < axis_count; number++) {
        position[number] = row[axis_of[number].position] * axis_of[number].unit;
    }
    for (size_t number = 0; number < sensor_count; number++) temperature[number] = row[sensor_of[number]];
    position[axis_count - 1] += 0.001;
    AbbeSample sample = {position, NULL, axis_count, temperature, sensor_count, 0.001};
    AbbeCycle told;
    HOLDS(abbe_update(abbe, &sample, correction, &told) == ABBE_STATUS_REFUSED);
    HOLDS(told.refused == ABBE_REFUSED_MOTOR);
}
#endif

int main(int count, char **words) {
    if (count != 4) return 2;
    char *file = words[1];
#ifdef HAL
    calibration = file;
    HOLDS(rtapi_app_main() == 0);
#else
    char message[4096];
    if (abbe_open(file, &abbe, message, sizeof message) != ABBE_STATUS_DONE) {
        fputs(message, stderr);
        return 1;
    }
    abbe_enable(abbe, true);
#endif
    FILE *rows = fopen(words[2], "r");
    HOLDS(rows != NULL);
    read_header(rows);
    find_columns(abbe);
    int time = column("", "t", "");
    double row[MOST_COLUMNS], commands[MOST], before = 0, worst = 0, largest[MOST] = {0};
    long cycles = 0;
    while (read_row(rows, row)) {
        cycle(row, cycles == 0 ? 0 : row[time] - before, commands);
        before = row[time];
        /* No time has passed before the first row, and nothing has faded in. */
        if (cycles++ == 0) continue;
        for (size_t number = 0; number < axis_count; number++) {
            worst = fmax(worst, fabs(commands[number] - row[axis_of[number].command]));
            largest[number] = fmax(largest[number], fabs(commands[number] - row[axis_of[number].position]));
        }
    }
    fclose(rows);
    HOLDS(cycles > 1000);
    /* The table has nine digits behind the point. */
    HOLDS(worst < 1e-9);
    printf("%ld cycles as `abbe compensate` has them, to %.1e; greatest corrections", cycles, worst);
    for (size_t number = 0; number < axis_count; number++) {
        HOLDS(largest[number] > 0.001);
        printf(" %s %.3f%s", axis_of[number].name, largest[number], axis_of[number].unit == 1 ? " mm" : " deg");
    }
    printf("\n");
#ifdef HAL
    rtapi_app_exit();
#else
    if (strcmp(words[3], "motors") == 0) refuses_a_motor(row);
    abbe_close(abbe);
#endif
    return 0;
}
