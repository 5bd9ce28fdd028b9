#include "legal.h"

enum {
    I = MODE_INSTANTIATED,
    N = MODE_INITIALIZATION,
    K = MODE_CONFIGURATION,
    E = MODE_EVENT,
    C = MODE_CONTINUOUS,
    S = MODE_STEP,
    Q = MODE_ASKED,
    A = MODE_ACCEPTED,
    T = MODE_TERMINATED,
    F = MODE_FAILED
};

#define CALL(function, model_exchange, co_simulation) {#function, {model_exchange, co_simulation}},
static const struct {
    const char *name;
    uint16_t modes[2]; /* by Interface */
} TABLE[] = {
#include "legal.def"
};

static const struct {
    Mode mode;
    const char *name;
} NAMES[] = {{MODE_INSTANTIATED, "before initialization"},
             {MODE_INITIALIZATION, "in initialization mode"},
             {MODE_CONFIGURATION, "in configuration mode"},
             {MODE_EVENT, "in event mode"},
             {MODE_CONTINUOUS, "in continuous-time mode"},
             {MODE_STEP, "between communication steps"},
             {MODE_ASKED, "inside a communication step, where inputs are asked for"},
             {MODE_ACCEPTED, "inside a communication step, at the end of an internal step"},
             {MODE_TERMINATED, "after termination"},
             {MODE_FAILED, "after an error"}};

bool instance_allows(Instance *instance, Call call)
{
    if (instance->mode & TABLE[call].modes[instance->interface]) return true;
    Text text;
    text_start(&text);
    text_add(&text, TABLE[call].name);
    text_add(&text, " is not allowed ");
    for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++)
        if (NAMES[k].mode == instance->mode) text_add(&text, NAMES[k].name);
    text_add(&text, instance->interface == CO_SIMULATION ? " (Co-Simulation)" : " (Model Exchange)");
    instance_fail(instance, &text);
    return false;
}
