/*
 * One instance of a cable FMU, whatever the version of FMI: the adapters fmi2.c and fmi3.c translate.
 *
 * Model and parameters, state, inputs and solver memory are apart. What is derived (model constants,
 * derivatives, outputs) is recomputed only when something it depends on was set. No function here
 * keeps data outside its instance, and none allocates but instance_new(), what makes a state [state.h] and, where the
 * number of links is a parameter, what changes it [structure.h].
 */
#ifndef CABLE_INSTANCE_H
#define CABLE_INSTANCE_H

#include "../kernel/dynamics.h"
#include "../kernel/solver.h"
#include "../kernel/statics.h"
#include "resource.h"
#include "text.h"

/* Time derivatives of an input that a host may give for a communication step (FMI 2), orders 1 ... */
enum { INPUT_ORDERS = 8 };

typedef enum { STATUS_OK, STATUS_WARNING, STATUS_ERROR, STATUS_DISCARD } Status;
typedef enum { MODEL_EXCHANGE, CO_SIMULATION } Interface;

/* States of the FMI state machines, as bits for the masks of legal calls [legal.def]. */
typedef enum {
    MODE_INSTANTIATED = 1,
    MODE_INITIALIZATION = 2,
    MODE_EVENT = 4,      /* Model Exchange */
    MODE_CONTINUOUS = 8, /* Model Exchange */
    MODE_STEP = 16,      /* Co-Simulation, between communication steps */
    MODE_ASKED = 32,     /* Co-Simulation, inside a step: the host is asked for inputs */
    MODE_TERMINATED = 64,
    MODE_FAILED = 128,        /* after an error that ended a step: read, reset or free */
    MODE_CONFIGURATION = 256, /* the number of links may be set */
    MODE_ACCEPTED = 512,      /* Co-Simulation, inside a step: the host may read at the end of an internal one */
    MODE_SETUP = MODE_INSTANTIATED | MODE_INITIALIZATION
} Mode;

typedef struct Instance Instance;
typedef struct State State; /* of an instance, taken for its host [state.h] */

/* How the adapter talks to its host. `owner` is the adapter's own record. */
typedef struct {
    void *owner;
    void (*log)(void *owner, Status status, const char *message);
    /* FMI 3: ask the host for the inputs at `time` inside a step; false to give up. NULL: not used. */
    bool (*intermediate)(void *owner, double time);
    /* FMI 3: an internal step was accepted at `time` and can be read; `end` of this step may be lowered. As before. */
    bool (*accepted)(void *owner, double time, double *end);
    bool takes_arrays; /* FMI 3: a value reference may stand for many values */
} Host;

struct Instance {
    Host host;
    Interface interface;
    Mode mode;
    Resource resource;
    char token[40]; /* of the FMU, filled up with zeros */
    State *states;  /* that the host has not freed yet */
    double *block;  /* all arrays below */

    Model model;
    Work work;
    Linear linear;
    double time, step_start, stop_time;
    double *x, *derivative, *solver_block;
    double *guess, *statics_block; /* the start states as set, for an equilibrium near them; NULL: they are the start */
    double *link;                  /* [LINK_COLUMNS][n] where n is a parameter, divided from `whole`; else NULL */
    double whole[WHOLE_COUNT];
    double u[INPUT_COUNT], u_derivative[INPUT_ORDERS][INPUT_COUNT], output[OUTPUT_COUNT];
    int u_orders; /* derivatives of inputs that were given for the step to come; zeros beyond */
    /* Of given motions without an acceleration [step.c], by ends: whether, and what was given last. */
    bool derives[2], has_before[2];
    double velocity_before[2][2], time_before[2]; /* along x, y [m/s]; [s] */
    uint32_t u_given;                             /* the inputs that have some, as bits */
    double statics[STATICS_COUNT];
    double *changes;         /* three times the states, scratch [derivatives.c] */
    bool linear_is_current;  /* for derivatives at the present state */
    bool masses_are_current; /* those outputs that are derivatives */
    bool linear_is_lent;     /* to derivatives, or another state came: the solver's linearised chain is gone [step.c] */
    bool model_is_current, start_is_current, derivatives_are_current, outputs_are_current, tensions_are_current;
    SolverMemory solver;
};

/* NULL, after a message through the host, if the resource file is missing, damaged or not of this token. */
Instance *instance_new(Interface interface, const char *token, const char *resource_directory, Host host);
void instance_free(Instance *instance);
Status instance_reset(Instance *instance);

/* Lays all arrays out anew for n links, zero; false without memory, and then nothing has changed. */
bool instance_size(Instance *instance, int n);

Status instance_fail(Instance *instance, const Text *message);

/* What the description calls messages of a status, and whether these are such names (a warning if one is not). */
const char *log_category(Status status);
Status instance_check_categories(Instance *instance, const char *const *categories, size_t count);

/* Experiment: start time [s] and, if they are defined, tolerance and stop time [s]. */
Status instance_setup(Instance *instance, double start_time, const double *tolerance, const double *stop_time);
Status instance_exit_initialization(Instance *instance);

/* Values by reference; nothing is changed by a call that fails. */
Status instance_get(Instance *instance, const uint32_t *references, size_t count, double *values);
Status instance_set(Instance *instance, const uint32_t *references, size_t count, const double *values);
/* How many values these variables have in all: n for an array, else one each. */
Status instance_count(Instance *instance, const uint32_t *references, size_t count, size_t *values);
/* The number of links, where it is a parameter. */
Status instance_get_links(Instance *instance, uint32_t reference, uint64_t *value);
Status instance_check_links(Instance *instance, uint32_t reference, uint64_t value);
/* The one enumeration, `solver`: automatic = 1, explicit = 2, implicit = 3. */
Status instance_get_choice(Instance *instance, uint32_t reference, int64_t *value);
Status instance_check_choice(Instance *instance, uint32_t reference, int64_t value);
void instance_set_choice(Instance *instance, int64_t value); /* after instance_check_choice() said OK */

Status instance_set_input_derivative(Instance *instance, uint32_t reference, int order, double value);
void forget_input_derivatives(Instance *instance);

/* Whether these can be set or read inside a step; is any of them an input? */
Status instance_check_intermediate(Instance *instance, const uint32_t *references, size_t count, bool *any_input);

/* Model Exchange. The number of states that hosts know of. */
size_t instance_states(const Instance *instance);
Status instance_set_time(Instance *instance, double time);
Status instance_set_states(Instance *instance, const double *x, size_t count);
Status instance_get_states(Instance *instance, double *x, size_t count);
Status instance_get_derivatives(Instance *instance, double *derivative, size_t count);
Status instance_nominals(Instance *instance, double *nominals, size_t count);

/* Co-Simulation: from the present time to communication_point + step. */
Status instance_step(Instance *instance, double communication_point, double step);

/* Which of the states (or of their derivatives) a variable of that kind is. */
typedef struct {
    size_t first, count;
} Span;
Span instance_span(const Instance *instance, const Variable *variable);
/* What states are set to before a run: the guess if there is one. */
double *instance_start(Instance *instance);

/* Bring what is derived up to date (refresh.c); false after a message. */
void refresh_model(Instance *instance);
bool refresh_start(Instance *instance); /* the states, until initialization ends */
bool refresh_derivatives(Instance *instance);
bool refresh_outputs(Instance *instance, bool with_tensions);
void invalidate_state(Instance *instance);
void invalidate_model(Instance *instance);

/* The variable of a reference; NULL after a message. */
const Variable *instance_variable(Instance *instance, uint32_t reference);
/* "NAME = VALUE at t = TIME s: what is expected"; without a value where none was given. */
Status instance_refuse(Instance *instance, const Variable *variable, const Text *value, const char *expected);
void text_variable(Text *text, const Instance *instance, const Variable *variable);

/* Name of state k for messages: y_m1, theta[1], ..., v_m1, omega[1], ... */
void text_state(Text *text, const Instance *instance, size_t k);
void text_at_time(Text *text, double time);
/* The smallest value of a parameter: "-inf", "0", or "+0" for above zero. */
const char *least_of(const Variable *variable);

#endif
