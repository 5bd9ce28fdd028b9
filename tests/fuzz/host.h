/*
 * A host out of bytes: every record of a file is one call of the API or one deed of the host, on one of three instances.
 *
 * The functions stand in calls2.def and calls3.def, a line each; what records mean is in arguments.c, what hosts do
 * beyond single calls in deeds.c. After every call it is checked [fuzz_calls.c] that
 *   - the status is one of FMI's, and a message came if and only if it is not OK,
 *   - after OK nothing was written that is not a finite number.
 */
#ifndef HOST_H
#define HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SLOTS = 3, STATES_KEPT = 2, MOST_CALLBACKS = 40, FIRST_FUNCTION = 16 };

/* Files are cut into these. */
typedef struct {
    uint8_t function; /* below FIRST_FUNCTION a deed, above a line of the table; beyond its end nothing */
    uint8_t slot, count, nulls, flags;
    uint8_t reference[3], value[3];
    uint8_t spare; /* which function a call-back calls */
} Record;

typedef struct {
    const char *location;
    uint8_t *bytes;
    size_t size;
    char token[39];
    uint32_t variables;
    size_t states;
    uint64_t journey[2][2]; /* what a new instance does, by version and interface; 0: not known yet */
} Scene;

typedef struct {
    int fmi; /* 2, 3; 0: empty */
    bool is_cosimulation, is_silent, listens;
    void *component;
    Scene *scene;
    void *state[STATES_KEPT];
    Record in_step; /* what a call-back does */
    unsigned callbacks;
    unsigned long messages;
} Slot;

/* What calls are made of, in blocks of exactly their size so that no step beyond goes unseen; some are NULL. */
typedef struct {
    uint32_t *references, *others;
    double *in, *out, *states;
    int32_t *orders;
    void *single; /* where one answer of any type goes */
    const char **names;
    uint8_t *bytes;
    size_t count, values, state_count, byte_count;
    double real[3], point, step; /* the latter two: where the next communication step begins, and its length */
    bool flag[3];
    int small; /* for enumerations */
    void *state, **state_place;
} Arguments;

typedef struct {
    const char *name;
    int (*call)(void *component, Arguments *a);
} Function;

extern const Function FUNCTIONS2[], FUNCTIONS3[];
extern const size_t FUNCTIONS2_COUNT, FUNCTIONS3_COUNT;

/* A serialized state, perhaps damaged; of any instance, for any other. */
typedef struct {
    uint8_t *bytes;
    size_t size;
} Image;
extern Image image;

extern Scene scenes[];
extern size_t scene_count;
void read_scenes(const char *folder);
bool learn_scene(Scene *scene); /* its facts, by the FMU's own reader; false if it refuses */
const char *location_of(size_t which);

/* `sets`: states are given, not asked for. */
void make_arguments(Arguments *a, const Slot *slot, const Record *record, bool sets);
void check_written(const Arguments *a, bool sets, const char *name);
void free_arguments(Arguments *a);

/* The call of one line of the table, with every check. */
int checked_call(Slot *slot, const Record *record);
void deed(Slot *slot, const Record *record);

/* Of either version. */
void open2(Slot *slot, const Record *record);
void open3(Slot *slot, const Record *record);
void close_slot(Slot *slot);
bool real_at(Slot *slot, uint32_t reference, double *value);
void shorten(Slot *slot);                 /* of an FMU with arrays, to few links */
int run_up(Slot *slot, double tolerance); /* to the end of initialization, from reset */
int do_step(Slot *slot, double point, double step);
void note_message(Slot *slot, int status, const char *category, const char *message);
int call_by_name(Slot *slot, const char *name, Arguments *a);
double now(Slot *slot);

_Noreturn void give_up(const char *what, const char *detail);

#endif
