/* As much of LinuxCNC's rtapi.h as abbe.c uses, for a process without LinuxCNC. Time stands still. */
#ifndef RTAPI_H
#define RTAPI_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

#define RTAPI_MSG_ERR 1
#define RTAPI_MP_STRING(name, text) extern int hal_nothing

static inline void rtapi_print_msg(int level, const char *format, ...) {
    va_list words;
    (void)level;
    va_start(words, format);
    vfprintf(stderr, format, words);
    va_end(words);
}

static inline long long rtapi_get_time(void) { return 0; }

#endif
