/* Hosts of FMI 3.0, with their call-backs inside a step. */
#include <math.h>
#include <stdlib.h>

#include "fmi3Functions.h"
#include "host.h"

/* Outside a step the host itself frees the instance: here it is tried inside of one, where it must be refused. */
static int free_in_step(void *c);

#define CALL(name, expression)                                                                                         \
    static int name##_of(void *c, Arguments *a)                                                                        \
    {                                                                                                                  \
        (void)c, (void)a;                                                                                              \
        return (int)(expression);                                                                                      \
    }
#include "calls3.def"
#undef CALL
#define CALL(name, expression) {#name, name##_of},
const Function FUNCTIONS3[] = {
#include "calls3.def"
};
const size_t FUNCTIONS3_COUNT = sizeof FUNCTIONS3 / sizeof *FUNCTIONS3;

static Slot *slot_in_step; /* whose call-back runs */

static int free_in_step(void *c)
{
    if (!slot_in_step || slot_in_step->component != c) return fmi3OK;
    fmi3FreeInstance(c);
    return fmi3Error; /* which is to say that a message is expected */
}

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    note_message(environment, (int)status, category, message);
}

/* Inside a step: one call of any function, and a wish to return early. */
static void update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean asked, fmi3Boolean readable,
                   fmi3Boolean finished, fmi3Boolean may_return, fmi3Boolean *early, fmi3Float64 *early_time)
{
    Slot *slot = environment;
    if (!(time == time) || (finished != readable) || (may_return && !finished)) give_up("an impossible update", "fmi3");
    if (slot->callbacks++ >= MOST_CALLBACKS) return;
    Record record = slot->in_step;
    record.function = record.spare;
    slot_in_step = slot;
    if (record.flags & 16 ? finished : asked) checked_call(slot, &record);
    slot_in_step = NULL;
    *early = record.flags & 32;
    *early_time = record.value[0] == 255 ? NAN : record.flags & 64 ? time + 0.01 : record.value[0] * 0.1;
}

void open3(Slot *slot, const Record *record)
{
    const Scene *scene = slot->scene;
    slot->is_silent = record->flags & 1;
    slot->is_cosimulation = record->value[0] & 1;
    slot->listens = slot->is_cosimulation && record->value[1] & 4;
    const fmi3LogMessageCallback log = record->flags & 1 ? NULL : log_message;
    const char *token = record->flags & 8 ? "{another}" : record->flags & 16 ? NULL : scene->token;
    const char *location = record->flags & 32 ? "/no/such folder" : scene->location;
    Arguments a;
    make_arguments(&a, slot, record, false);
    if (record->flags & 4)
        slot->component =
            fmi3InstantiateScheduledExecution("fuzz", token, location, false, true, slot, log, NULL, NULL, NULL);
    else if (slot->is_cosimulation)
        slot->component = fmi3InstantiateCoSimulation("fuzz", token, location, false, true, record->value[1] & 1,
                                                      record->value[1] & 2, a.references, a.count, slot, log,
                                                      slot->listens ? update : NULL);
    else
        slot->component = fmi3InstantiateModelExchange("fuzz", token, location, false, true, slot, log);
    free_arguments(&a);
    if (slot->component && record->flags & (4 + 8 + 16 + 32))
        give_up("an instance for", "a wrong type, token or place");
    if (!slot->component && !slot->is_silent && !slot->messages)
        give_up("no instance and no message", "fmi3Instantiate");
}
