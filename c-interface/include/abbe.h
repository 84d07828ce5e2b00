/*
 * abbe.h: the compensation of one machine, for a controller in C.
 *
 * In: the calibration file of one specimen, and each servo cycle the state of its axes and sensors. Out: the correction of
 * each axis. The library that has these functions is compiled from a machine file; see docs/c-interface.md.
 * Units: mm, rad, s, degC. A correction is added to the commanded position.
 *
 * Generated from the crate abbe-c. Do not edit.
 */

#ifndef ABBE_H
#define ABBE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// How a call ended: 0 or more where it was carried out, less than 0 where it was wrong and nothing was done.
enum AbbeStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done, in every function but `abbe_update`.
  ABBE_STATUS_DONE = 0,
  // The correction is that of the model, or on its way to it.
  ABBE_STATUS_ACTIVE = 1,
  // The same, with the last reading of a sensor that is silent.
  ABBE_STATUS_HOLDING = 2,
  // A sensor has been silent for too long: the correction fades out, or has faded out.
  ABBE_STATUS_LOST = 3,
  // The sample was refused, see `refused` of the cycle: the correction fades out, or has faded out.
  ABBE_STATUS_REFUSED = 4,
  // Switched off: the correction fades out, or has faded out.
  ABBE_STATUS_OFF = 5,
  // A pointer that is needed is null.
  ABBE_STATUS_NULL_POINTER = -1,
  // As many positions as axes are needed, and as many temperatures as sensors.
  ABBE_STATUS_WRONG_LENGTH = -2,
  // A direction is neither +1, -1 nor 0; or an axis or a threshold is out of its range.
  ABBE_STATUS_OUT_OF_RANGE = -3,
  // The calibration cannot be used; the message says why.
  ABBE_STATUS_CALIBRATION = -4,
  // Another thread is in a call with this handle.
  ABBE_STATUS_BUSY = -5,
  // A fault of Abbe. It went no further than this call; the handle answers nothing else any more.
  ABBE_STATUS_FAULT = -6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AbbeStatus AbbeStatus;
#else
typedef int32_t AbbeStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why a sample was refused.
enum AbbeRefused
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It was not.
  ABBE_REFUSED_NO = 0,
  // A position, a temperature before its first reading, the time step or the error itself is not finite.
  ABBE_REFUSED_NOT_FINITE = 1,
  // The time step is below zero.
  ABBE_REFUSED_TIME_STEP = 2,
  // The search for the command does not settle: the error changes about as fast as the position.
  ABBE_REFUSED_NOT_CONVERGING = 3,
  // The correction is longer than the limit of the calibration, of slides or of rotary axes.
  ABBE_REFUSED_OVER_LIMIT = 4,
  // A length that does not fit: a fault of Abbe.
  ABBE_REFUSED_LENGTH = 5,
  // In this pose axes move the tip in nearly the same direction: they would have to move more than a hundred times as far as it.
  ABBE_REFUSED_NEAR_SINGULAR = 6,
  // A motor does not stand where its axes put it.
  ABBE_REFUSED_MOTOR = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AbbeRefused AbbeRefused;
#else
typedef int32_t AbbeRefused;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The compensation of one machine. C holds it by a pointer and knows nothing of its inside.
typedef struct Abbe Abbe;

// What a controller knows in one servo cycle.
typedef struct AbbeSample {
  // Position commanded for each axis: mm, rad for a rotary axis; machine coordinates.
  const double *position;
  // For each axis the direction of its last real motion: +1, -1, or 0: found from its commands, their
  // corrections included. Null: all are found.
  const double *direction;
  // How many axes `position`, `direction` and the correction have.
  size_t axes;
  // Temperature of each sensor in degC, NaN where it is silent. May be null where there are no sensors.
  const double *temperature;
  // How many sensors `temperature` has.
  size_t sensors;
  // Time since the cycle before this one, s.
  double time_step;
} AbbeSample;

// What was done in a cycle.
typedef struct AbbeCycle {
  // Error of the tool tip relative to the part that the model predicts at the position, before compensation: X, Y, Z of
  // the part's frame, actual minus commanded, mm; 0 where the sample was refused.
  double error[3];
  // What the correction leaves of it at its end, mm: what no axis reaches, or all of it where nothing is corrected.
  double remaining[3];
  // Length over all slides of the correction made, mm.
  double correction;
  // Why the sample was refused.
  AbbeRefused refused;
  // The sensor that has been silent longest, as an index of `abbe_sensor_name`; -1: none that matters.
  int32_t sensor;
  // Whether the correction is still on its way to what the status asks for.
  bool settling;
} AbbeCycle;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// One servo cycle: writes to `correction` what is to be added to the position of each axis, mm or rad.
//
// It reads and writes no file, allocates nothing and does not wait. After a negative status nothing is written and nothing
// goes on: the controller keeps its last correction, and an operator has to hear of it. `cycle` may be null.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed; `sample` is null or what it is said to be, with its pointers null or
// to as many numbers as it says; `correction` is null or room for `sample->axes` numbers, which may be those of the positions;
// `cycle` is null or room for one.
AbbeStatus abbe_update(const struct Abbe *handle,
                       const struct AbbeSample *sample,
                       double *correction,
                       struct AbbeCycle *cycle);

// Switches the compensation on or off, from the next cycle on and without a jump; from any thread. It begins switched off.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
AbbeStatus abbe_enable(const struct Abbe *handle,
                       bool enabled);

// Takes a tool of the calibration by its name, from the next cycle on and without a jump; null: the constants of the calibration
// itself. `12` is `T12` where no tool is called `12`. A name that no tool has is out of range, and nothing changes.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed; `name` is null or a string that ends in a zero byte.
AbbeStatus abbe_set_tool(const struct Abbe *handle,
                         const char *name);

// Takes these constants of the machine, in mm, in the order of `abbe_constant_name`, from the next cycle on and without a jump: the
// lengths of a tool that the controller itself knows.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed; `constants` is null or to `count` numbers.
AbbeStatus abbe_set_constants(const struct Abbe *handle,
                              const double *constants,
                              size_t count);

// Writes what the last cycle found of the direction of the tool, from its tip towards the spindle: its error without compensation, and
// what stays of it at the end of the correction; I, J, K in the part's frame, rad, NaN where there was no cycle yet or its sample was
// refused. Out of range on a machine whose rotary axes do not correct that direction; nothing is written then. Either may be null.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed; `error` and `remaining` are null or room for three numbers each.
AbbeStatus abbe_direction(const struct Abbe *handle,
                          double *error,
                          double *remaining);

// Forgets what terms, sensors and axes remember, as if the machine had just started: after homing, say. The correction made
// stays, and goes from there to what is wanted next.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
AbbeStatus abbe_restart(const struct Abbe *handle);

// How far an axis must move back before its direction counts as turned: mm, or rad for a rotary axis. Until it is called,
// 0.001 mm or 0.001 deg. The axis forgets its motion: its direction starts again as positive.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
AbbeStatus abbe_set_hysteresis(const struct Abbe *handle,
                               size_t axis,
                               double threshold);

// How many axes the machine has; 0 for a null pointer.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
size_t abbe_axes(const struct Abbe *handle);

// The letter of an axis, or the id of its link, in the order of positions; null where there is none. It lives as long as
// the handle.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
const char *abbe_axis_letter(const struct Abbe *handle,
                             size_t axis);

// Whether positions on an axis are angles in rad rather than lengths in mm.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
bool abbe_axis_is_rotary(const struct Abbe *handle, size_t axis);

// How many temperature sensors the calibration reads; 0 for a null pointer.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
size_t abbe_sensors(const struct Abbe *handle);

// The name of a temperature sensor, in the order of temperatures; null where there is none. It lives as long as the handle.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
const char *abbe_sensor_name(const struct Abbe *handle,
                             size_t sensor);

// How many tools the calibration has; 0 for a null pointer.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
size_t abbe_tools(const struct Abbe *handle);

// The name of a tool, in the order of the calibration; null where there is none. It lives as long as the handle.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
const char *abbe_tool_name(const struct Abbe *handle,
                           size_t tool);

// How many constants the machine has; 0 for a null pointer.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
size_t abbe_constants(const struct Abbe *handle);

// The name of a constant of the machine, such as `Zt`; null where there is none. It lives as long as the handle.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
const char *abbe_constant_name(const struct Abbe *handle,
                               size_t constant);

// The name of the machine that was compiled in; null for a null pointer. It lives as long as the handle.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed.
const char *abbe_machine(const struct Abbe *handle);

// Gives back what `abbe_open` took. A null pointer is nothing to give back.
//
// # Safety
// `handle` is null or from `abbe_open` and not closed, and no thread is in a call with it.
void abbe_close(struct Abbe *handle);

// A status in words, in English; for any number. It lives for ever.
const char *abbe_status_text(int32_t status);

// The version of Abbe, such as `0.1.0`. It lives for ever.
const char *abbe_version(void);

// Opens the compensation of this machine with the numbers of one specimen.
//
// It reads the calibration file, and the machine file where that names one: this belongs before the servo cycle. The
// compensation begins switched off. `message` takes warnings, or why there is no handle; it may be null.
//
// # Safety
// `calibration` is null or a string that ends in a zero byte, `handle` null or a place for a pointer, and `message` null
// or room for `size` bytes.
AbbeStatus abbe_open(const char *calibration,
                     struct Abbe **handle,
                     char *message,
                     size_t size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ABBE_H */
