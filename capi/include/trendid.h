/*
 * trendid: recursive identification of servo drives in continuous time, and an adaptive position loop.
 *
 * Made by cbindgen from the Rust sources (`cargo xtask capi --write`); do not edit. MIT or Apache-2.0.
 *
 * The contract of every function:
 *   - No heap, no global state, no callback. The caller owns every object; two objects have nothing in common, so each may
 *     live in its own interrupt or thread. One object must not be used by two at a time.
 *   - An object is the memory of its type, static or automatic, aligned as the type says. `_init` makes it usable; it may be
 *     copied with memcpy or `=` and dropped at any time. A handle points into the object that it was given for. Memory for
 *     which `_init` was refused holds no object, whatever it held before.
 *   - A pointer is NULL, or points to memory of its type that stays valid for the call. NULL, a wrong alignment and an object
 *     that was never initialised are answered by an error, and nothing is written then.
 *   - Floats are IEEE 754 single precision. A number that is not finite never enters an object.
 *   - 0 in a setting stands for the default where the field says so.
 *   - `_update` executes a bounded number of instructions and is made for the interrupt of a sample; everything else is for
 *     the main loop, except where it says otherwise.
 */


#ifndef TRENDID_H
#define TRENDID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The sizes must mean the same to this compiler and to the library. */
#if defined(__cplusplus)
#define TRENDID_STATIC_ASSERT(condition, text) static_assert(condition, text)
#else
#define TRENDID_STATIC_ASSERT(condition, text) _Static_assert(condition, text)
#endif


// Version of this interface: another number, another layout of the types.
#define TRENDID_ABI_VERSION 2

// Number of candidates: delays of 0 to 7 samples.
#define TRENDID_DELAY_CANDIDATES (TRENDID_DELAY_MAX + 1)

// Words of 8 bytes of a `trendid_delay_bank`.
#define TRENDID_DELAY_BANK_WORDS 1552

// Words of 8 bytes of a `trendid_friction`.
#define TRENDID_FRICTION_WORDS 4

// Longest delay of an input in samples.
#define TRENDID_DELAY_MAX 7

// Longest delay of an input of a `trendid_any` in samples.
#define TRENDID_ANY_DELAY_MAX 64

// Most parameters of a `trendid_any`.
#define TRENDID_ANY_PARAMETERS_MAX 6

// Words of 8 bytes of a `trendid_any`.
#define TRENDID_ANY_WORDS 300

// Words of 8 bytes of a `trendid_instrumented2`.
#define TRENDID_INSTRUMENTED2_WORDS 424

// Words of 8 bytes of a `trendid_instrumented3`.
#define TRENDID_INSTRUMENTED3_WORDS 548

// Words of 8 bytes of a `trendid_servo2`.
#define TRENDID_SERVO2_WORDS 168

// Words of 8 bytes of a `trendid_servo3`.
#define TRENDID_SERVO3_WORDS 196

// Words of 8 bytes of a `trendid_coulomb2`.
#define TRENDID_COULOMB2_WORDS 192

// Words of 8 bytes of a `trendid_coulomb3`.
#define TRENDID_COULOMB3_WORDS 228

// Words of 8 bytes of a `trendid_valve2`.
#define TRENDID_VALVE2_WORDS 216

// Words of 8 bytes of a `trendid_valve3`.
#define TRENDID_VALVE3_WORDS 248

// Words of 8 bytes of a `trendid_valve_coulomb2`.
#define TRENDID_VALVE_COULOMB2_WORDS 244

// Words of 8 bytes of a `trendid_valve_coulomb3`.
#define TRENDID_VALVE_COULOMB3_WORDS 276

// Most parameters of a model.
#define TRENDID_PARAMETERS_MAX 8

// Highest order of a model.
#define TRENDID_ORDER_MAX 4

// Most inputs of a model: those of the caller, and the sign of a command with a dead zone.
#define TRENDID_MODEL_INPUTS_MAX 3

// Bytes of a stored model.
#define TRENDID_RECORD_BYTES 96

// Words of 8 bytes of a `trendid_loop`.
#define TRENDID_LOOP_WORDS 1936

// Most inputs that the caller may give.
#define TRENDID_INPUTS_MAX 2

// What a function answers; 0 is success. Otherwise nothing was done, and an `_init` leaves no
// object.
enum trendid_error
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
  // Done.
  TRENDID_ERROR_OK = 0,
  // A pointer is NULL.
  TRENDID_ERROR_NULL = 1,
  // A pointer is not aligned for its type.
  TRENDID_ERROR_MISALIGNED = 2,
  // The object was never initialised, or its memory was overwritten.
  TRENDID_ERROR_NOT_INITIALISED = 3,
  // The number of inputs, parameters or bytes is not that of the object.
  TRENDID_ERROR_LENGTH = 4,
  // A setting or an argument is NaN or infinite.
  TRENDID_ERROR_NOT_FINITE = 5,
  // A setting is not above zero.
  TRENDID_ERROR_NOT_POSITIVE = 6,
  // A setting is outside its limits.
  TRENDID_ERROR_OUT_OF_RANGE = 7,
  // A filter has a pole that is not stable.
  TRENDID_ERROR_UNSTABLE = 8,
  // A filter has a pole too fast for the sample time.
  TRENDID_ERROR_TOO_FAST = 9,
  // The structure has more parameters or inputs than the object holds.
  TRENDID_ERROR_PARAMETER_COUNT = 10,
  // The structure has a term a_i or b_i with i not below the order.
  TRENDID_ERROR_TERM = 11,
  // No input of the structure has a term.
  TRENDID_ERROR_NO_INPUT = 12,
  // The unit of the position is too small for the accelerations of the axis: use mm, not um.
  TRENDID_ERROR_UNIT = 13,
  // The model may not control the axis; the reason is beside.
  TRENDID_ERROR_MODEL_REFUSED = 14,
  // There is no value yet: too few samples, or no verified model.
  TRENDID_ERROR_NOT_YET = 15,
  // The record is erased memory.
  TRENDID_ERROR_RECORD_EMPTY = 16,
  // The record does not pass its CRC.
  TRENDID_ERROR_RECORD_DAMAGED = 17,
  // The record has another version.
  TRENDID_ERROR_RECORD_VERSION = 18,
  // The record belongs to another machine.
  TRENDID_ERROR_RECORD_PLANT = 19,
  // The record was made under another sample time, delay or travel.
  TRENDID_ERROR_RECORD_SETTINGS = 20,
  // The object has no dead zone.
  TRENDID_ERROR_NO_DEAD_ZONE = 21,
  // An error that this version of the interface does not name.
  TRENDID_ERROR_OTHER = 22,
  // A motion was requested while the controller does not have the axis, or has not seen it yet.
  TRENDID_ERROR_NOT_CONTROLLING = 23,
  // The kind of the object does not offer this call.
  TRENDID_ERROR_NOT_OFFERED = 24,
};
#ifndef __cplusplus
typedef int32_t trendid_error;
#endif // __cplusplus

// Course of an input between two samples.
enum trendid_hold
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
  // Held until the next sample: a command that this controller gives.
  TRENDID_HOLD_ZERO = 0,
  // Straight from sample to sample: a measured quantity.
  TRENDID_HOLD_FIRST = 1,
  // The mean since the sample before: what is known only when it is over, as that of
  // `trendid_friction_update`.
  TRENDID_HOLD_MEAN = 2,
};
#ifndef __cplusplus
typedef int32_t trendid_hold;
#endif // __cplusplus

// State of a loop.
enum trendid_loop_state
#ifdef __cplusplus
  : uint8_t
#endif // __cplusplus
 {
  // Nothing controls: before a commissioning, and behind an abort. The valve is in its middle,
  // as far as that is known.
  TRENDID_LOOP_STATE_IDLE = 0,
  // The axis is moved; too early for a model.
  TRENDID_LOOP_STATE_EXCITING = 1,
  // The axis is moved, and models are validated.
  TRENDID_LOOP_STATE_IDENTIFYING = 2,
  // A model passed; the controller takes the axis over.
  TRENDID_LOOP_STATE_VERIFIED = 3,
  // The controller runs, the model follows the drive.
  TRENDID_LOOP_STATE_ADAPTING = 4,
  // The controller runs, nothing moves enough to learn from: gains stay.
  TRENDID_LOOP_STATE_FROZEN = 5,
  // A model was rejected, the last verified model is in force.
  TRENDID_LOOP_STATE_REJECTED = 6,
  // There is no usable model, or the machine has a fault: the axis stops, then the valve is in
  // its middle.
  TRENDID_LOOP_STATE_FAILED = 7,
};
#ifndef __cplusplus
typedef uint8_t trendid_loop_state;
#endif // __cplusplus

// The types of memory.
enum trendid_object_kind
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
  // `trendid_servo2`
  TRENDID_OBJECT_KIND_SERVO2 = 0,
  // `trendid_servo3`
  TRENDID_OBJECT_KIND_SERVO3 = 1,
  // `trendid_valve2`
  TRENDID_OBJECT_KIND_VALVE2 = 2,
  // `trendid_valve3`
  TRENDID_OBJECT_KIND_VALVE3 = 3,
  // `trendid_coulomb2`
  TRENDID_OBJECT_KIND_COULOMB2 = 4,
  // `trendid_coulomb3`
  TRENDID_OBJECT_KIND_COULOMB3 = 5,
  // `trendid_valve_coulomb2`
  TRENDID_OBJECT_KIND_VALVE_COULOMB2 = 6,
  // `trendid_valve_coulomb3`
  TRENDID_OBJECT_KIND_VALVE_COULOMB3 = 7,
  // `trendid_any`
  TRENDID_OBJECT_KIND_ANY = 8,
  // `trendid_delay_bank`
  TRENDID_OBJECT_KIND_DELAY_BANK = 9,
  // `trendid_loop`
  TRENDID_OBJECT_KIND_LOOP = 10,
  // `trendid_instrumented2`
  TRENDID_OBJECT_KIND_INSTRUMENTED2 = 11,
  // `trendid_instrumented3`
  TRENDID_OBJECT_KIND_INSTRUMENTED3 = 12,
  // `trendid_friction`
  TRENDID_OBJECT_KIND_FRICTION = 13,
};
#ifndef __cplusplus
typedef int32_t trendid_object_kind;
#endif // __cplusplus

// What a parameter means.
enum trendid_parameter_kind
#ifdef __cplusplus
  : uint8_t
#endif // __cplusplus
 {
  // a_power, of y.
  TRENDID_PARAMETER_KIND_A = 0,
  // b_power of an input.
  TRENDID_PARAMETER_KIND_B = 1,
  // The contribution of a constant input 1.
  TRENDID_PARAMETER_KIND_CONSTANT = 2,
  // Minus the error of the first position, in the unit of y.
  TRENDID_PARAMETER_KIND_INITIAL_STATE = 3,
};
#ifndef __cplusplus
typedef uint8_t trendid_parameter_kind;
#endif // __cplusplus

// Why a model was refused, or the axis was stopped. New reasons come last.
enum trendid_reason
#ifdef __cplusplus
  : uint8_t
#endif // __cplusplus
 {
  // No reason.
  TRENDID_REASON_NONE = 0,
  // A parameter is not finite.
  TRENDID_REASON_NOT_FINITE = 1,
  // The drive moves against the command.
  TRENDID_REASON_WRONG_SIGN = 2,
  // Gain, natural frequency or damping is out of range.
  TRENDID_REASON_OUT_OF_RANGE = 3,
  // The model without its integrator is unstable.
  TRENDID_REASON_UNSTABLE = 4,
  // The standard deviations of the parameters are too large.
  TRENDID_REASON_UNCERTAIN = 5,
  // In a free simulation the model does not follow: wrong order, structure or delay.
  TRENDID_REASON_POOR_FIT = 6,
  // The model in use follows better.
  TRENDID_REASON_NOT_BETTER = 7,
  // The axis does not move although the valve is commanded.
  TRENDID_REASON_BLOCKED = 8,
  // The axis moves, but not with the command.
  TRENDID_REASON_VALVE_STUCK = 9,
  // The position code does not change at all.
  TRENDID_REASON_SENSOR_STUCK = 10,
  // The sensor failed.
  TRENDID_REASON_SENSOR_FAULT = 11,
  // The valve reported an error.
  TRENDID_REASON_VALVE_FAULT = 12,
  // The axis came to the end of its travel.
  TRENDID_REASON_TRAVEL_END = 13,
  // The user stopped it.
  TRENDID_REASON_ABORTED = 14,
  // The measured position jumped to where the axis cannot be.
  TRENDID_REASON_IMPLAUSIBLE = 15,
  // The axis stayed behind its reference.
  TRENDID_REASON_FOLLOWING_ERROR = 16,
  // The command was full for longer than the travel explains.
  TRENDID_REASON_SATURATED = 17,
};
#ifndef __cplusplus
typedef uint8_t trendid_reason;
#endif // __cplusplus

// What one sample did.
enum trendid_sample_kind
#ifdef __cplusplus
  : uint8_t
#endif // __cplusplus
 {
  // The trends are settling.
  TRENDID_SAMPLE_KIND_WARMING_UP = 0,
  // An input was not finite or far beyond its range: the sample was refused, its time passed.
  TRENDID_SAMPLE_KIND_INPUT_REFUSED = 1,
  // The position was not finite or far beyond its range: the sample was refused, its time
  // passed.
  TRENDID_SAMPLE_KIND_OUTPUT_REFUSED = 2,
  // The position was implausible (a spike) and replaced by its prediction.
  TRENDID_SAMPLE_KIND_REPLACED = 3,
  // The sample was predicted; the estimate is held, by the caller or because the drive does not
  // move.
  TRENDID_SAMPLE_KIND_HELD = 4,
  // The sample was predicted and the estimate updated.
  TRENDID_SAMPLE_KIND_ESTIMATED = 5,
};
#ifndef __cplusplus
typedef uint8_t trendid_sample_kind;
#endif // __cplusplus

// What an estimate rests on.
enum trendid_way
#ifdef __cplusplus
  : uint8_t
#endif // __cplusplus
 {
  // The recursion.
  TRENDID_WAY_RECURSION = 0,
  // Instruments, with standard deviations from blocks of time.
  TRENDID_WAY_INSTRUMENTS = 1,
  // The recursion: there are too few blocks for instruments yet.
  TRENDID_WAY_TOO_FEW_BLOCKS = 2,
  // The recursion: the instruments are weak, they hardly move with what the position does.
  TRENDID_WAY_WEAK_INSTRUMENTS = 3,
};
#ifndef __cplusplus
typedef uint8_t trendid_way;
#endif // __cplusplus

// An identifier of any kind: the handle that the `_init` of its memory gives.
typedef struct trendid_identifier trendid_identifier;

// Identifiers of the kind `trendid_servo3` with the delays 0 to 7 side by side; the one that
// predicts best has the delay.
//
// For commissioning: eight times an identifier in time and memory.
typedef struct trendid_delay_bank {
  uint64_t words[TRENDID_DELAY_BANK_WORDS];
} trendid_delay_bank;

// Settings of an identifier, made by `trendid_settings_init`.
//
// A setting that means nothing for a kind must be as `trendid_settings_init` left it: that of an
// input or a parameter that the kind does not have, a dead zone of a kind without one, a delay of
// a bank that looks for it, a change to be followed without a memory, a significance without a
// constant.
typedef struct trendid_settings {
  // Sample time in s.
  float sample_time;
  // Rough bandwidth of the drive in rad/s, within a factor of three.
  float bandwidth;
  // Typical size of each input, in its unit; default 1 of the second one.
  float input_range[TRENDID_INPUTS_MAX];
  // Typical movement of the output, in its unit.
  float output_range;
  // Expected standard deviation of the noise of the output, in its unit; 0: a thousandth of
  // `output_range`.
  float output_noise;
  // Memory in s; 0: nothing is forgotten. With a dead zone about two blocks of it.
  float memory;
  // With a memory: 1 makes it short where the drive changes, until the new drive is known; so
  // long the deviations are infinite. 0 (default) forgets as fast as always. A drive with a
  // friction or a dead zone that the model does not have shows itself as a change now and then.
  int32_t follow_changes;
  // Time without estimation after the first sample, in s; default 0, for a drive at rest.
  float settling;
  // Standard deviations below which the constant is insignificant and withdrawn; default 2, 0
  // always keeps it.
  float offset_significance;
  // Course of each input between samples, a `trendid_hold`; default `TRENDID_HOLD_ZERO`.
  int32_t hold[TRENDID_INPUTS_MAX];
  // Delay of each input in samples, also between two of them, at most `TRENDID_DELAY_MAX`
  // (`TRENDID_ANY_DELAY_MAX` for a `trendid_any`); default 0.
  float delay[TRENDID_INPUTS_MAX];
  // Each input in equilibrium before the first sample, in its unit; default 0.
  float initial_input[TRENDID_INPUTS_MAX];
  // The input that is the sign of the velocity, counted from 0: while it is 0 the axis may
  // stick, and the estimate is held. 1 for the kinds with Coulomb friction; -1 (default): none.
  int32_t friction_input;
  // The parameters before the first sample, in the order and the units of `theta` of
  // `trendid_estimate`; default 0.
  float initial[TRENDID_PARAMETERS_MAX];
  // Standard deviations of `initial`, in the same units: all 0 (default) for those that follow
  // from the ranges, or each above 0 but for known parameters.
  float prior_std[TRENDID_PARAMETERS_MAX];
  // Bit i: parameter i is known to be `initial[i]`; default 0.
  uint32_t known;
  // Half width of the dead zone to begin with, in the unit of the first input, at most
  // `dead_zone_max`; default 0. Too small is good, too large may confirm itself.
  float dead_zone;
  // Largest half width of the dead zone, in the unit of the first input; 0 (default): a quarter
  // of `input_range[0]`. Commands below it tell no deviation until they are known to lie
  // outside.
  float dead_zone_max;
  // Samples between corrections of the dead zone; 0 (default): 300.
  uint32_t dead_zone_block;
} trendid_settings;

// Which setting was refused, and what was expected.
typedef struct trendid_detail {
  // The error, again.
  trendid_error error;
  // Position in a list of values, -1 for a single value.
  int32_t index;
  // The value.
  float value;
  // The smallest value; an infinite limit allows every finite value.
  float low;
  // The largest value.
  float high;
  // Why a model may not control, a `trendid_reason`; 0 otherwise.
  uint8_t reason;
  // Name of the setting, ends with 0; empty where it is none.
  char setting[35];
} trendid_detail;

// What one sample did.
typedef struct trendid_outcome {
  // What happened.
  trendid_sample_kind kind;
  // Position of the refused input among those of the caller; else 0.
  uint8_t input;
  // Samples until the first estimate, while warming up; else 0.
  uint32_t remaining;
  // Measured minus predicted position, in the unit of y, where there was a prediction; else 0.
  float innovation;
} trendid_outcome;

// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1))`.
//
// theta = (a1, a2, b0, constant, initial state); inputs: u.
typedef struct trendid_servo3 {
  uint64_t words[TRENDID_SERVO3_WORDS];
} trendid_servo3;

// The mean sign of the velocity from sample to sample, for the input of Coulomb friction: a drive
// that turns in between has neither sign.
//
// That input has the hold `TRENDID_HOLD_MEAN`.
typedef struct trendid_friction {
  uint64_t words[TRENDID_FRICTION_WORDS];
} trendid_friction;

// Memory of an identifier of any structure: order 1 to 4, one or two inputs, up to
// `TRENDID_ANY_PARAMETERS_MAX` parameters.
//
// For hosts: a program that initialises one links the code of every structure. Archives for
// microcontrollers are built without `trendid_any_init`.
typedef struct trendid_any {
  uint64_t words[TRENDID_ANY_WORDS];
} trendid_any;

// Any structure `(b_{m-1} s^{m-1} + .. + b0) / (s^m + a_{m-1} s^{m-1} + .. + a0)` for a
// `trendid_any`.
//
// The parameters stand in this order: a_i with i ascending, b_i of each input, the constant, the
// initial state.
typedef struct trendid_structure {
  // Order m, 1 to 4.
  uint8_t order;
  // Number of inputs, 1 or 2.
  uint8_t inputs;
  // Bit i: a_i exists; an integrator has no a_0.
  uint8_t output_terms;
  // Bit i: b_i of this input exists.
  uint8_t input_terms[TRENDID_INPUTS_MAX];
  // Not 0: there is a constant input, for the offset of a valve.
  uint8_t constant;
  // Not 0: the error of the first position is a parameter.
  uint8_t initial_state;
} trendid_structure;

// The model found, with its uncertainty; entries beyond the sizes of the model are 0.
//
// A standard deviation is never NaN; it is infinite where nothing is known.
typedef struct trendid_estimate {
  // Order m.
  uint8_t order;
  // Number of inputs of the model.
  uint8_t inputs;
  // Number of parameters.
  uint8_t parameters;
  // Whether every pole behind the integrators is stable.
  bool stable;
  // Whether `gain` exists.
  bool has_gain;
  // Whether `omega0` and `damping` exist.
  bool has_pair;
  // Whether the standard deviations of gain, omega0 and damping exist.
  bool has_physical_std;
  // The parameters: a_i in s^(i-m), b_i in the unit of y per unit of u per s^(m-i).
  float theta[TRENDID_PARAMETERS_MAX];
  // Their standard deviations.
  float std[TRENDID_PARAMETERS_MAX];
  // a_0 .. a_(m-1) of the transfer function.
  float a[TRENDID_ORDER_MAX];
  // b_0 .. b_(m-1) of each input.
  float b[TRENDID_MODEL_INPUTS_MAX][TRENDID_ORDER_MAX];
  // The contribution of the constant input, in units of y per s^m.
  float constant;
  // Static gain, or velocity gain C behind an integrator, of the first input: y or y/s per unit
  // of u.
  float gain;
  // Natural frequency in rad/s.
  float omega0;
  // Damping ratio.
  float damping;
  // Standard deviation of `gain`.
  float gain_std;
  // Standard deviation of `omega0`, in rad/s.
  float omega0_std;
  // Standard deviation of `damping`.
  float damping_std;
  // Time constants of the real poles, longest first, in s; 0 where there is none.
  float time_constants[TRENDID_ORDER_MAX];
} trendid_estimate;

// The meaning of one entry of theta.
typedef struct trendid_parameter {
  // Of y, of an input, or neither.
  trendid_parameter_kind kind;
  // Which input of the model; with a dead zone 0 is the command, 1 its sign.
  uint8_t input;
  // The power of s.
  uint8_t power;
} trendid_parameter;

// A pole of the model.
typedef struct trendid_pole {
  // Real part in rad/s.
  float re;
  // Imaginary part in rad/s.
  float im;
} trendid_pole;

// What is known beside the model.
typedef struct trendid_status {
  // Prediction of the newest position from the samples before it, in the unit of y.
  float prediction;
  // Standard deviation of the innovation, in the unit of y; 0 while `has_noise_std` is false.
  float noise_std;
  // Sum of the squared innovations, in the unit of y squared.
  float ise;
  // Sum of the absolute innovations, in the unit of y.
  float iae;
  // Number of innovations in the sums.
  uint32_t samples;
  // How many samples of the position were replaced by their prediction.
  uint32_t replaced;
  // How many changes of the drive were found and followed; 0 without `follow_changes`.
  uint32_t changes;
  // Half width of the dead zone, in the unit of u; 0 for a kind without one.
  float dead_zone;
  // Standard deviation of `dead_zone`, infinite before the first correction; 0 for a kind
  // without one.
  float dead_zone_std;
  // Blocks of time that carry the standard deviations by instruments, 16 at most; 0 for those of
  // the recursion.
  float blocks;
  // Whether there are more samples than parameters.
  bool has_noise_std;
  // What the estimate rests on: the recursion, but for the kinds with instruments.
  trendid_way way;
} trendid_status;

// Memory of an identifier as `trendid_servo2` with instruments beside its recursion: without the
// bias that drift and coloured noise of the position make, and with standard deviations that
// assume no noise model.
//
// theta = (a1, b0, constant, initial state); inputs: u. Every read-out costs as much as
// `trendid_identifier_estimate`; a warm start, a retune and a nominal estimate are not offered.
typedef struct trendid_instrumented2 {
  uint64_t words[TRENDID_INSTRUMENTED2_WORDS];
} trendid_instrumented2;

// Memory of an identifier as `trendid_servo3` with instruments, as `trendid_instrumented2`.
//
// theta = (a1, a2, b0, constant, initial state); inputs: u.
typedef struct trendid_instrumented3 {
  uint64_t words[TRENDID_INSTRUMENTED3_WORDS];
} trendid_instrumented3;

// Memory of an identifier of `b0 / (s (s + a1))`.
//
// theta = (a1, b0, constant, initial state); inputs: u.
typedef struct trendid_servo2 {
  uint64_t words[TRENDID_SERVO2_WORDS];
} trendid_servo2;

// Memory of an identifier of `b0 / (s (s + a1)) with Coulomb friction`.
//
// theta = (a1, b0, b0 of the sign of v, constant, initial state); inputs: u, sign of v.
typedef struct trendid_coulomb2 {
  uint64_t words[TRENDID_COULOMB2_WORDS];
} trendid_coulomb2;

// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1)) with Coulomb friction`.
//
// theta = (a1, a2, b0, b1 of the sign of v, constant, initial state); inputs: u, sign of v.
typedef struct trendid_coulomb3 {
  uint64_t words[TRENDID_COULOMB3_WORDS];
} trendid_coulomb3;

// Memory of an identifier of `b0 / (s (s + a1)) behind a valve with a dead zone`.
//
// theta = (a1, b0, b0 of the sign of u, constant, initial state); inputs: u.
typedef struct trendid_valve2 {
  uint64_t words[TRENDID_VALVE2_WORDS];
} trendid_valve2;

// Memory of an identifier of `b0 / (s (s^2 + a2 s + a1)) behind a valve with a dead zone`.
//
// theta = (a1, a2, b0, b0 of the sign of u, constant, initial state); inputs: u.
typedef struct trendid_valve3 {
  uint64_t words[TRENDID_VALVE3_WORDS];
} trendid_valve3;

// Memory of an identifier of
// `b0 / (s (s + a1)) with Coulomb friction, behind a valve with a dead zone`.
//
// theta = (a1, b0, b0 of the sign of u, b0 of the sign of v, constant, initial state); inputs: u,
// sign of v.
typedef struct trendid_valve_coulomb2 {
  uint64_t words[TRENDID_VALVE_COULOMB2_WORDS];
} trendid_valve_coulomb2;

// Memory of an identifier of
// `b0 / (s (s^2 + a2 s + a1)) with Coulomb friction, behind a valve with a dead zone`.
//
// theta = (a1, a2, b0, b0 of the sign of u, b1 of the sign of v, constant, initial state); inputs:
// u, sign of v.
typedef struct trendid_valve_coulomb3 {
  uint64_t words[TRENDID_VALVE_COULOMB3_WORDS];
} trendid_valve_coulomb3;

// Memory of an adaptive position loop.
typedef struct trendid_loop {
  uint64_t words[TRENDID_LOOP_WORDS];
} trendid_loop;

// Requested dynamics of a closed loop.
typedef struct trendid_loop_controller {
  // Largest bandwidth in rad/s; 0 (default) for what the margins allow.
  float bandwidth;
  // Half width of the flow over which the inverse of the dead zone changes sign; default 0.01.
  float blend;
  // Least position error within which the valve rests at standstill, in units of y; 0 (default)
  // for one code and two standard deviations of the noise.
  float rest_window;
  // Dead volume of a chamber over that of the stroke: how much stiffer the axis gets towards its
  // ends. Infinite for a drive that is as stiff everywhere; 0 (default) for what the
  // commissioning finds. With a model that is installed it is to be stated: a stiff drive that
  // is taken for a cylinder may swing near its ends.
  float dead_volume;
  // Share by which the axis is slower towards larger y, and faster towards smaller ones, within
  // -0.5..=0.5; default 0. What the commissioning finds replaces it; with a model that is
  // installed it is to be stated. A rod that leaves the share r of the area makes
  // (1 - sqrt(r)) / (1 + sqrt(r)) with oil and (1 - r) / (1 + r) with air, negative where the
  // axis extends towards larger y.
  float imbalance;
  // Time in s in which the offset of a bumpless change of gains fades; default 0.01.
  float transition;
} trendid_loop_controller;

// Settings of a position loop, made by `trendid_loop_settings_init`; a setting of 0 follows from
// the others unless said.
typedef struct trendid_loop_settings {
  // Sample time in s.
  float sample_time;
  // Lowest position, in the unit of y (mm).
  float travel_min;
  // Highest position, in the unit of y.
  float travel_max;
  // Unit of y per count of the sensor; negative when the sensor counts against the axis.
  float units_per_count;
  // Code of the sensor at position zero.
  int32_t reference_code;
  // Rough bandwidth of the drive in rad/s, if it is known.
  float bandwidth;
  // 1 or -1: a positive command moves towards larger or smaller positions; 0: not known, the
  // commissioning finds it.
  int32_t direction;
  // Standard deviation of the position noise, in the unit of y.
  float noise;
  // Largest command, within 0..=1; default 1.
  float range;
  // Largest rate of the command per s; default 400.
  float rate;
  // Steps of the output between zero and full command, e.g. 2047 of a DAC with 12 bits; 0: the
  // output has no steps.
  uint32_t command_steps;
  // Delay of the valve in s; default 0.002. What the commissioning finds replaces it.
  float delay;
  // Memory of the identifier in s; default 1.5.
  float memory;
  // Whether the model follows the drive after the commissioning: 1 (default) or 0.
  int32_t adaptive;
  // Largest velocity of a move, in units of y per s; 0 with the next two for the defaults of all
  // three.
  float velocity;
  // Largest acceleration of a move, in units of y per s^2.
  float acceleration;
  // Largest jerk of a move, in units of y per s^3.
  float jerk;
  // Requested dynamics.
  struct trendid_loop_controller controller;
  // Largest command of the commissioning, within 0..=1; default 0.5.
  float excitation;
  // Longest commissioning in s; default 6.
  float time_limit;
} trendid_loop_settings;

// What one sample of a loop did.
typedef struct trendid_report {
  // State after the sample, a `trendid_loop_state`.
  trendid_loop_state state;
  // Why a model was rejected or the loop failed: a `trendid_reason`, 0 for none.
  uint8_t reason;
  // Whether a model reached the controller in this sample.
  bool retuned;
  // Whether there is an innovation.
  bool has_innovation;
  // The command for the valve, -1 to 1, on a step of the output: write it now.
  float command;
  // Measured position, in the unit of y; where the axis should be when the sensor failed.
  float position;
  // The reference, in the unit of y; the position outside of control.
  float reference;
  // Velocity of the reference, in units of y per s.
  float reference_velocity;
  // Innovation of the identifier, in the unit of y; 0 where there is none.
  float innovation;
  // Readings that failed, since the start.
  uint32_t failed_readings;
  // Readings that the axis cannot have reached; each was replaced by the expected position.
  uint32_t implausible_readings;
  // Samples at the full command.
  uint32_t saturated_samples;
  // Oscillations at rest that were noticed.
  uint32_t oscillations;
  // Faults that stopped the axis; a commissioning that gives up is none.
  uint32_t stops;
  // Factor on the bandwidth of the controller; 1 unless an oscillation was noticed.
  float derating;
  // Departures from where the axis was while its reference rests: slips, creep and every half
  // wave of a cycle.
  uint32_t moves_at_rest;
} trendid_report;

// A position drive of order 3 behind a valve: `x''' = - a1 x' - a2 x'' + b0 (q(u) + offset)`.
typedef struct trendid_model {
  // Square of the natural frequency, in 1/s^2.
  float a1;
  // Twice damping times natural frequency, in 1/s.
  float a2;
  // Gain of the command, in units of y per s^3.
  float b0;
  // Half width of the dead zone of the valve, in the unit of u.
  float dead_zone;
  // Effective command at a command of zero.
  float offset;
  // Coulomb friction, as the acceleration that it takes away, in units of y per s^2.
  float friction;
} trendid_model;

// How good a loop is, and how well its drive is known: for who puts an axis into operation.
typedef struct trendid_quality {
  // Delay of the valve in s, as the commissioning found it.
  float delay;
  // 1 or -1: a positive command moves towards larger or smaller positions, as the commissioning
  // found it.
  int32_t direction;
  // Bandwidth of the closed loop in rad/s.
  float bandwidth;
  // Largest sensitivity of the closed loop; with the next three 0 while `has_margins` is false.
  float sensitivity;
  // Phase margin in rad.
  float phase_margin;
  // The delay in s that may come on top, infinite where any may.
  float delay_margin;
  // Factor of the gain up to which the loop is stable, infinite where every one may be.
  float gain_margin;
  // Standard deviation of `a1` of the verified model; with the next two infinite for a model of
  // the commissioning or of the caller.
  float a1_std;
  // Standard deviation of `a2`.
  float a2_std;
  // Standard deviation of `b0`.
  float b0_std;
  // Share of the movement that the last validated model explains in free simulation; negative
  // where it is worse than a constant, minus infinity before there was one.
  float r_squared;
  // Models that were accepted.
  uint32_t accepted;
  // Models that were refused.
  uint32_t refused;
  // Whether there are margins: not before there are gains, nor where the slowest ones have less
  // than what is wanted.
  bool has_margins;
} trendid_quality;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the interface that the library was built with, to be compared with
// `TRENDID_ABI_VERSION`.
uint32_t trendid_abi_version(void);

// The version of the library, in static memory.
const char *trendid_version(void);

// Named by the tables of the precompiled core library on hosts; without unwinding nothing calls
// it.
void rust_eh_personality(void);

// Makes a bank; `delay` of the settings, which is looked for, must be 0. `detail`, if not NULL,
// says which setting was refused.
trendid_error trendid_delay_bank_init(struct trendid_delay_bank *memory,
                                      const struct trendid_settings *settings,
                                      struct trendid_detail *detail);

// Takes command and position, as `trendid_identifier_update`; `outcome` is that of the candidate
// without delay, or NULL.
trendid_error trendid_delay_bank_update(struct trendid_delay_bank *bank,
                                        float u,
                                        float y,
                                        struct trendid_outcome *outcome);

// The delay with the smallest prediction error, in samples, and how clear the choice is: the error
// of the second best over that of the best, at least 1. Either may be NULL.
// `TRENDID_ERROR_NOT_YET` until all can be compared.
trendid_error trendid_delay_bank_best(const struct trendid_delay_bank *bank, uint32_t *delay, float *margin);

// The delay between the samples, half a sample from the one of `trendid_delay_bank_best` at most,
// as a `delay` of the settings. `TRENDID_ERROR_NOT_YET` until all can be compared.
trendid_error trendid_delay_bank_refined(const struct trendid_delay_bank *bank, float *delay);

// The prediction error of each delay in the unit of y, infinite while unknown; `count` is
// `TRENDID_DELAY_CANDIDATES`.
trendid_error trendid_delay_bank_errors(const struct trendid_delay_bank *bank, float *errors, size_t count);

// Copies the identifier with the best delay into memory of its own, to go on with it.
trendid_error trendid_delay_bank_chosen(const struct trendid_delay_bank *bank,
                                        struct trendid_servo3 *memory,
                                        struct trendid_identifier **identifier);

// One sentence on a code, in static memory; of another number that it is none.
const char *trendid_error_text(int32_t error);

// Makes one of a drive at rest; velocities within `rest` of zero, in the unit of the velocity, are
// zero.
trendid_error trendid_friction_init(struct trendid_friction *memory, float rest, struct trendid_detail *detail);

// Takes the velocity of a sample, NaN as zero; `sign` is the mean sign since the sample before,
// within -1 and 1.
//
// For the interrupt of the sample.
trendid_error trendid_friction_update(struct trendid_friction *friction, float velocity, float *sign);

// Makes an identifier of this structure; `detail`, if not NULL, says which setting was refused.
trendid_error trendid_any_init(struct trendid_any *memory,
                               const struct trendid_settings *settings,
                               const struct trendid_structure *structure,
                               struct trendid_identifier **identifier,
                               struct trendid_detail *detail);

// Takes the command u, in force from now until the next sample, and the position y, for a kind
// with one input.
//
// For the interrupt of the sample. `outcome` may be NULL. A number that is not finite is refused
// by `outcome`, not by the code.
trendid_error trendid_identifier_update(struct trendid_identifier *identifier,
                                        float u,
                                        float y,
                                        struct trendid_outcome *outcome);

// As `trendid_identifier_update` for a kind with several inputs: `u` has `count` of them.
trendid_error trendid_identifier_update_inputs(struct trendid_identifier *identifier,
                                               const float *u,
                                               size_t count,
                                               float y,
                                               struct trendid_outcome *outcome);

// Lets `samples` sample times pass without a measurement; a short gap is bridged by what the model
// predicts.
//
// For the interrupt; its time grows with `samples` up to the longest gap that is bridged, 5 /
// bandwidth.
trendid_error trendid_identifier_skip(struct trendid_identifier *identifier, uint32_t samples);

// Back to the identifier as initialised.
trendid_error trendid_identifier_reset(struct trendid_identifier *identifier);

// Forgets the signals, after a long gap in the samples, and keeps the estimate.
trendid_error trendid_identifier_restart_trends(struct trendid_identifier *identifier);

// Makes the current estimate the one to which it returns where nothing excites it; only with a
// memory.
trendid_error trendid_identifier_set_nominal(struct trendid_identifier *identifier);

// Adapts (`true`, as initialised) or holds the estimate; predictions go on.
trendid_error trendid_identifier_adapt(struct trendid_identifier *identifier, bool on);

// Goes on with the default filter for a drive of the bandwidth `omega0` (rad/s); the estimate
// stays.
//
// Not for the 1 ms path: some 13000 instructions for order 3, see the table of the core.
trendid_error trendid_identifier_retune(struct trendid_identifier *identifier,
                                        float omega0,
                                        struct trendid_detail *detail);

// Begins again from an estimate with its standard deviations, 0 for a known parameter; both lists
// have `count` numbers, one per parameter, in the units of `trendid_estimate`.
trendid_error trendid_identifier_warm_start(struct trendid_identifier *identifier,
                                            const float *theta,
                                            const float *std,
                                            size_t count,
                                            struct trendid_detail *detail);

// The parameters alone, at about a sixth of the cost of `trendid_identifier_estimate`; `count` is
// their number.
trendid_error trendid_identifier_theta(const struct trendid_identifier *identifier, float *theta, size_t count);

// The model found, with its uncertainty.
trendid_error trendid_identifier_estimate(const struct trendid_identifier *identifier,
                                          struct trendid_estimate *estimate);

// The covariance of the parameters, row by row; `count` is the square of their number.
trendid_error trendid_identifier_covariance(const struct trendid_identifier *identifier,
                                            float *covariance,
                                            size_t count);

// The meaning of each entry of theta; `count` is their number.
trendid_error trendid_identifier_parameters(const struct trendid_identifier *identifier,
                                            struct trendid_parameter *parameters,
                                            size_t count);

// The poles of the model, integrators first, then by rising distance from zero; `count` is the
// order. `TRENDID_ERROR_NOT_YET` where they are not found.
trendid_error trendid_identifier_poles(const struct trendid_identifier *identifier,
                                       struct trendid_pole *poles,
                                       size_t count);

// Prediction, noise, sums of errors, changes, dead zone, and what the estimate rests on.
trendid_error trendid_identifier_status(const struct trendid_identifier *identifier, struct trendid_status *status);

// The input of Coulomb friction: the sign of the velocity, 0 within `rest` of zero and for NaN.
float trendid_sign_of_velocity(float velocity, float rest);

// Makes an identifier of the kind `trendid_instrumented2`; `detail`, if not NULL, says which
// setting was refused.
trendid_error trendid_instrumented2_init(struct trendid_instrumented2 *memory,
                                         const struct trendid_settings *settings,
                                         struct trendid_identifier **identifier,
                                         struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_instrumented3`; `detail`, if not NULL, says which
// setting was refused.
trendid_error trendid_instrumented3_init(struct trendid_instrumented3 *memory,
                                         const struct trendid_settings *settings,
                                         struct trendid_identifier **identifier,
                                         struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_servo2`; `detail`, if not NULL, says which setting was
// refused.
trendid_error trendid_servo2_init(struct trendid_servo2 *memory,
                                  const struct trendid_settings *settings,
                                  struct trendid_identifier **identifier,
                                  struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_servo3`; `detail`, if not NULL, says which setting was
// refused.
trendid_error trendid_servo3_init(struct trendid_servo3 *memory,
                                  const struct trendid_settings *settings,
                                  struct trendid_identifier **identifier,
                                  struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_coulomb2`; `detail`, if not NULL, says which setting
// was refused.
trendid_error trendid_coulomb2_init(struct trendid_coulomb2 *memory,
                                    const struct trendid_settings *settings,
                                    struct trendid_identifier **identifier,
                                    struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_coulomb3`; `detail`, if not NULL, says which setting
// was refused.
trendid_error trendid_coulomb3_init(struct trendid_coulomb3 *memory,
                                    const struct trendid_settings *settings,
                                    struct trendid_identifier **identifier,
                                    struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_valve2`; `detail`, if not NULL, says which setting was
// refused.
trendid_error trendid_valve2_init(struct trendid_valve2 *memory,
                                  const struct trendid_settings *settings,
                                  struct trendid_identifier **identifier,
                                  struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_valve3`; `detail`, if not NULL, says which setting was
// refused.
trendid_error trendid_valve3_init(struct trendid_valve3 *memory,
                                  const struct trendid_settings *settings,
                                  struct trendid_identifier **identifier,
                                  struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_valve_coulomb2`; `detail`, if not NULL, says which
// setting was refused.
trendid_error trendid_valve_coulomb2_init(struct trendid_valve_coulomb2 *memory,
                                          const struct trendid_settings *settings,
                                          struct trendid_identifier **identifier,
                                          struct trendid_detail *detail);

// Makes an identifier of the kind `trendid_valve_coulomb3`; `detail`, if not NULL, says which
// setting was refused.
trendid_error trendid_valve_coulomb3_init(struct trendid_valve_coulomb3 *memory,
                                          const struct trendid_settings *settings,
                                          struct trendid_identifier **identifier,
                                          struct trendid_detail *detail);

// Makes a loop that is idle; `detail`, if not NULL, says which setting was refused.
trendid_error trendid_loop_init(struct trendid_loop *memory,
                                const struct trendid_loop_settings *settings,
                                struct trendid_detail *detail);

// One sample: takes the code of the sensor, gives the command for the valve in `report`.
//
// For the interrupt of the sample. The loop counts on the command being in force until the next
// sample.
trendid_error trendid_loop_update(struct trendid_loop *servo, int32_t code, struct trendid_report *report);

// One sample without a reading: the sensor reported an error. Short gaps are bridged, longer ones
// stop the axis.
trendid_error trendid_loop_update_blind(struct trendid_loop *servo, struct trendid_report *report);

// Says that the valve did not take the last command: the next sample stops the axis.
trendid_error trendid_loop_valve_fault(struct trendid_loop *servo);

// Commissions the axis with the next sample, around the position it then has. The axis moves. One
// in motion first comes to rest: in control within the limits of motion, at a place with room to
// both ends, else behind the closed valve.
trendid_error trendid_loop_commission(struct trendid_loop *servo);

// Stops commissioning or control: the valve closes at its rate limit, the verified model is kept.
trendid_error trendid_loop_abort(struct trendid_loop *servo);

// Moves to `target`, in the unit of y, limited to the travel, as fast as the limits of motion
// allow; in any sample.
trendid_error trendid_loop_move_to(struct trendid_loop *servo, float target, struct trendid_detail *detail);

// Oscillates with `amplitude` (unit of y) and `frequency` (Hz) about the present reference.
trendid_error trendid_loop_oscillate(struct trendid_loop *servo,
                                     float amplitude,
                                     float frequency,
                                     struct trendid_detail *detail);

// Takes a model that is known to be good: control begins with the next sample, with the motion
// that the axis then has, and lets it run out. Before the first position the valve is in its
// middle until the readings show that motion.
//
// `TRENDID_ERROR_OUT_OF_RANGE` with the position where the axis stands beyond its travel by more
// than a hundredth of it; where that is seen with the next sample, the state is failed with
// `TRENDID_REASON_IMPLAUSIBLE`.
trendid_error trendid_loop_install(struct trendid_loop *servo,
                                   const struct trendid_model *model,
                                   struct trendid_detail *detail);

// The verified model; `TRENDID_ERROR_NOT_YET` before there is one.
trendid_error trendid_loop_model(const struct trendid_loop *servo, struct trendid_model *model);

// The verified model as bytes that end in their CRC-32, to be stored; `count` is
// `TRENDID_RECORD_BYTES`.
//
// `plant` is the machine, for instance its serial number; `sequence` counts the records, so that
// the newest can be told.
trendid_error trendid_loop_store(const struct trendid_loop *servo,
                                 uint32_t plant,
                                 uint32_t sequence,
                                 uint8_t *bytes,
                                 size_t count);

// Control from the next sample on with a stored model, in the motion that the axis then has, as
// the record of this machine and these settings; refused for the place of the axis as by
// `trendid_loop_install`.
//
// `sequence`, if not NULL, gets the number of the record; `detail`, if not NULL, says what was
// refused.
trendid_error trendid_loop_load(struct trendid_loop *servo,
                                uint32_t plant,
                                const uint8_t *bytes,
                                size_t count,
                                uint32_t *sequence,
                                struct trendid_detail *detail);

// How good the loop is, and how well its drive is known.
trendid_error trendid_loop_quality(const struct trendid_loop *servo, struct trendid_quality *quality);

// Why a model was refused or the axis stopped, in static memory: a `trendid_reason`, 0 for none.
const char *trendid_reason_text(uint8_t reason);

// The defaults for an axis of which sample time (s), travel, scale and reference of the sensor are
// known.
trendid_error trendid_loop_settings_init(struct trendid_loop_settings *settings,
                                         float sample_time,
                                         float travel_min,
                                         float travel_max,
                                         float units_per_count,
                                         int32_t reference_code);

// The defaults for a drive sampled every `sample_time` (s), of rough `bandwidth` (rad/s), with the
// typical sizes of command and position. The values are checked where an identifier is made of
// them.
trendid_error trendid_settings_init(struct trendid_settings *settings,
                                    float sample_time,
                                    float bandwidth,
                                    float input_range,
                                    float output_range);

// Bytes of a type of memory, a `trendid_object_kind`, as the library was built: `sizeof` must say
// the same. 0 of another number.
size_t trendid_object_size(int32_t kind);

// Bytes of a type of memory that this build of the library uses; the rest is room for later
// versions.
size_t trendid_object_used(int32_t kind);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* TRENDID_H */

/* The other half of these stands in the library, for the Rust compiler. */
TRENDID_STATIC_ASSERT(sizeof(trendid_detail) == 56, "trendid_detail has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_settings) == 148, "trendid_settings has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_structure) == 7, "trendid_structure has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_outcome) == 12, "trendid_outcome has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_parameter) == 3, "trendid_parameter has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_pole) == 8, "trendid_pole has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_estimate) == 180, "trendid_estimate has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_status) == 44, "trendid_status has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_loop_settings) == 96, "trendid_loop_settings has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_quality) == 56, "trendid_quality has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_report) == 52, "trendid_report has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_model) == 24, "trendid_model has another layout");
TRENDID_STATIC_ASSERT(sizeof(trendid_servo2) == 8u * TRENDID_SERVO2_WORDS, "trendid_servo2 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_servo3) == 8u * TRENDID_SERVO3_WORDS, "trendid_servo3 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_valve2) == 8u * TRENDID_VALVE2_WORDS, "trendid_valve2 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_valve3) == 8u * TRENDID_VALVE3_WORDS, "trendid_valve3 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_coulomb2) == 8u * TRENDID_COULOMB2_WORDS, "trendid_coulomb2 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_coulomb3) == 8u * TRENDID_COULOMB3_WORDS, "trendid_coulomb3 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_valve_coulomb2) == 8u * TRENDID_VALVE_COULOMB2_WORDS, "trendid_valve_coulomb2 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_valve_coulomb3) == 8u * TRENDID_VALVE_COULOMB3_WORDS, "trendid_valve_coulomb3 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_instrumented2) == 8u * TRENDID_INSTRUMENTED2_WORDS, "trendid_instrumented2 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_instrumented3) == 8u * TRENDID_INSTRUMENTED3_WORDS, "trendid_instrumented3 has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_friction) == 8u * TRENDID_FRICTION_WORDS, "trendid_friction has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_any) == 8u * TRENDID_ANY_WORDS, "trendid_any has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_delay_bank) == 8u * TRENDID_DELAY_BANK_WORDS, "trendid_delay_bank has another size");
TRENDID_STATIC_ASSERT(sizeof(trendid_loop) == 8u * TRENDID_LOOP_WORDS, "trendid_loop has another size");
