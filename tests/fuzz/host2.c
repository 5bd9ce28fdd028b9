/* Hosts of FMI 2.0. */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "host.h"

#define CALL(name, expression)                                                                                         \
    static int name##_of(void *c, Arguments *a)                                                                        \
    {                                                                                                                  \
        (void)c, (void)a;                                                                                              \
        return (int)(expression);                                                                                      \
    }
#include "calls2.def"
#undef CALL
#define CALL(name, expression) {#name, name##_of},
const Function FUNCTIONS2[] = {
#include "calls2.def"
};
const size_t FUNCTIONS2_COUNT = sizeof FUNCTIONS2 / sizeof *FUNCTIONS2;

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    if (!name) give_up("a message of no instance", message);
    for (const char *at = message; (at = strchr(at, '%')); at += 2)
        if (at[1] != '%') give_up("a message that printf would trip over", message);
    note_message(environment, (int)status, category, message);
}

/* Flags: what is wrong with the host. */
void open2(Slot *slot, const Record *record)
{
    fmi2CallbackFunctions functions = {record->flags & 1 ? NULL : log_message, NULL, NULL, NULL, slot};
    slot->is_silent = record->flags & 3;
    slot->is_cosimulation = record->value[0] & 1;
    const fmi2Type type = record->flags & 4       ? (fmi2Type)7
                          : slot->is_cosimulation ? fmi2CoSimulation
                                                  : fmi2ModelExchange;
    const char *token = record->flags & 8 ? "{another}" : record->flags & 16 ? NULL : slot->scene->token;
    const char *location = record->flags & 32 ? "file:///no/such%20folder" : slot->scene->location;
    slot->component = fmi2Instantiate(record->flags & 64 ? NULL : "fuzz", type, token, location,
                                      record->flags & 2 ? NULL : &functions, fmi2False, fmi2True);
    if (slot->component && record->flags & (4 + 8 + 16 + 32))
        give_up("an instance for", "a wrong type, token or place");
    if (!slot->component && !slot->is_silent && !slot->messages)
        give_up("no instance and no message", "fmi2Instantiate");
}
