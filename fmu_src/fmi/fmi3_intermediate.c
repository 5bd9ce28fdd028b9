/*
 * Intermediate update of FMI 3.0 [section 4.2.2]: what a host is told and asked inside a step, and how it ends one early.
 *
 * At the stages of an internal step, which run ahead and back, inputs are asked for and nothing can be read. At its end,
 * once it is accepted, outputs can be read and then inputs set; there the host may end the communication step.
 */
#include <math.h>

#include "fmi3_component.h"

static bool ask(void *owner, double time)
{
    const Component *component = owner;
    fmi3Boolean early = fmi3False;
    fmi3Float64 early_time = time;
    component->intermediate_update(component->environment, time, fmi3True, fmi3False, fmi3False, fmi3False, &early,
                                   &early_time);
    return true;
}

static bool tell_host(void *owner, double time, double *end)
{
    const Component *component = owner;
    const bool may_return = component->may_return_early && time < *end;
    fmi3Boolean early = fmi3False;
    fmi3Float64 early_time = time;
    const bool sets = component->instance->host.intermediate;
    component->intermediate_update(component->environment, time, sets, fmi3True, fmi3True, may_return, &early,
                                   &early_time);
    if (!early || !may_return) return true;
    if (isnan(early_time)) {
        fmi3_refuse(owner, "the host asked to return early, but at no time (earlyReturnTime is not a number)");
        return false;
    }
    *end = fmin(*end, fmax(time, early_time));
    return true;
}

bool fmi3_listen(Component *component, const fmi3ValueReference references[], size_t count)
{
    Instance *instance = component->instance;
    if (!component->intermediate_update) return true;
    if (count && !references) {
        fmi3_refuse(component, "requiredIntermediateVariables: a null pointer was given");
        return false;
    }
    /* A host that names no input has none to give, and one that may end a step needs to name nothing. */
    bool any_input;
    if (instance_check_intermediate(instance, references, count, &any_input) != STATUS_OK) return false;
    if (any_input) instance->host.intermediate = ask;
    if (count || component->may_return_early) instance->host.accepted = tell_host;
    return true;
}
