/*
 * As much of LinuxCNC's hal.h as abbe.c uses: pins that are numbers in this process, found by their names.
 *
 * In: what a component asks for. Out: the same places for who drives it. It exists so that the component runs where no LinuxCNC is.
 */
#ifndef HAL_H
#define HAL_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef double hal_float_t;
typedef bool hal_bit_t;
typedef int hal_s32_t;

enum { HAL_IN, HAL_OUT, HAL_IO, MOST_PINS = 512, PIN_NAME = 64 };

static struct {
    char name[PIN_NAME];
    void *place;
} hal_pins[MOST_PINS];
static int hal_pin_count;

/* A new pin of this size, which is zero. */
static int hal_pin_new(void **place, size_t size, const char *format, va_list words) {
    if (hal_pin_count == MOST_PINS) return -1;
    char *name = hal_pins[hal_pin_count].name;
    int length = vsnprintf(name, PIN_NAME, format, words);
    for (int other = 0; other < hal_pin_count; other++) {
        if (strcmp(hal_pins[other].name, name) == 0) return -1;
    }
    *place = calloc(1, size);
    hal_pins[hal_pin_count++].place = *place;
    return length < PIN_NAME && *place != NULL ? 0 : -1;
}

#define HAL_PIN_NEW(type)                                                                                   \
    static int hal_pin_##type##_newf(int direction, hal_##type##_t **pin, int component, const char *format, ...) { \
        va_list words;                                                                                              \
        void *place = NULL;                                                                                         \
        (void)direction, (void)component;                                                                           \
        va_start(words, format);                                                                                    \
        int failed = hal_pin_new(&place, sizeof **pin, format, words);                                              \
        va_end(words);                                                                                              \
        *pin = place;                                                                                               \
        return failed;                                                                                              \
    }
HAL_PIN_NEW(float)
HAL_PIN_NEW(bit)
HAL_PIN_NEW(s32)

/* The place of the pin with this name; the program ends where there is none. */
static void *hal_pin(const char *format, ...) {
    char name[PIN_NAME];
    va_list words;
    va_start(words, format);
    vsnprintf(name, sizeof name, format, words);
    va_end(words);
    for (int pin = 0; pin < hal_pin_count; pin++) {
        if (strcmp(hal_pins[pin].name, name) == 0) return hal_pins[pin].place;
    }
    fprintf(stderr, "no pin %s\n", name);
    exit(1);
}

static void *hal_memory;
static void *hal_malloc(size_t size) { return hal_memory = malloc(size); }
static int hal_init(const char *name) { return name[0]; }
static int hal_ready(int component) { return component > 0 ? 0 : -1; }
static int hal_export_funct(const char *name, void (*of)(void *, long), void *what, int floating, int reentrant, int component) {
    (void)name, (void)of, (void)what, (void)floating, (void)reentrant;
    return component > 0 ? 0 : -1;
}
static int hal_exit(int component) {
    for (int pin = 0; pin < hal_pin_count; pin++) free(hal_pins[pin].place);
    free(hal_memory);
    hal_pin_count = 0;
    return component > 0 ? 0 : -1;
}

#endif
