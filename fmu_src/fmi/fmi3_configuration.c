/* Configuration mode of FMI 3.0, and the one structural parameter that a cable may have: n. */
#include "fmi3_component.h"
#include "structure.h"

static const char NO_CONFIGURATION[] = "there are no structural parameters to configure";

static bool is_configurable(const Component *component)
{
    return component && component->instance->link;
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    if (!is_configurable(c)) return fmi3_refuse(c, NO_CONFIGURATION);
    /* During a run only tunable structural parameters could be changed, and n is fixed. */
    Instance *instance = fmi3_legal(c, CALL_fmi3EnterConfigurationMode);
    if (!instance) return fmi3Error;
    instance->mode = MODE_CONFIGURATION;
    return fmi3OK;
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    if (!is_configurable(c)) return fmi3_refuse(c, NO_CONFIGURATION);
    Instance *instance = fmi3_legal(c, CALL_fmi3ExitConfigurationMode);
    if (!instance) return fmi3Error;
    instance->mode = MODE_INSTANTIATED;
    return fmi3OK;
}

/* The instance, or NULL after a message. */
static Instance *checked(fmi3Instance c, Call call, const void *references, const void *values, size_t count,
                         size_t nValues)
{
    Instance *instance = fmi3_legal(c, call);
    if (!instance) return NULL;
    if (count && (!references || !values)) {
        fmi3_refuse(c, "fmi3GetUInt64, fmi3SetUInt64: a null pointer was given");
        return NULL;
    }
    if (nValues == count) return instance;
    fmi3_refuse(c, "fmi3GetUInt64, fmi3SetUInt64: as many values as references are expected");
    return NULL;
}

fmi3Status fmi3GetUInt64(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         fmi3UInt64 values[], size_t nValues)
{
    if (!is_configurable(c)) return fmi3_no_variables(c, CALL_fmi3GetUInt64, nValueReferences);
    Instance *instance = checked(c, CALL_fmi3GetUInt64, valueReferences, values, nValueReferences, nValues);
    if (!instance) return fmi3Error;
    for (size_t k = 0; k < nValues; k++)
        if (instance_get_links(instance, valueReferences[k], &values[k]) != STATUS_OK) return fmi3Error;
    return fmi3OK;
}

fmi3Status fmi3SetUInt64(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const fmi3UInt64 values[], size_t nValues)
{
    if (!is_configurable(c)) return fmi3_no_variables(c, CALL_fmi3SetUInt64, nValueReferences);
    Instance *instance = checked(c, CALL_fmi3SetUInt64, valueReferences, values, nValueReferences, nValues);
    if (!instance) return fmi3Error;
    for (size_t k = 0; k < nValues; k++)
        if (instance_check_links(instance, valueReferences[k], values[k]) != STATUS_OK) return fmi3Error;
    /* All references are that of n: the last value counts. */
    return nValues ? fmi3_status(structure_set_links(instance, values[nValues - 1])) : fmi3OK;
}
