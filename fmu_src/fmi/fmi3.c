/* The FMI 3.0 interface over instance.h: argument checks, legal states, nothing else. */
#include <stdlib.h>
#include <string.h>

#include "fmi3_component.h"

fmi3Status fmi3_status(Status status)
{
    static const fmi3Status MEANING[] = {fmi3OK, fmi3Warning, fmi3Error, fmi3Discard};
    return MEANING[status];
}

static void log_message(void *owner, Status status, const char *message)
{
    const Component *component = owner;
    if (!component->log_message) return;
    char escaped[TEXT_DOUBLED_BYTES];
    text_doubled(message, "#", escaped); /* a single one begins a reference to a variable */
    component->log_message(component->environment, fmi3_status(status), log_category(status), escaped);
}

fmi3Status fmi3_refuse(fmi3Instance c, const char *message)
{
    if (c) log_message(c, STATUS_ERROR, message);
    return fmi3Error;
}

Instance *fmi3_legal(fmi3Instance c, Call call)
{
    Component *component = c;
    if (!component) return NULL;
    return instance_allows(component->instance, call) ? component->instance : NULL;
}

static Component *instantiate(Component blank, Interface interface, fmi3String token, fmi3String resource_path)
{
    Component *component = malloc(sizeof *component);
    if (!component) {
        log_message(&blank, STATUS_ERROR, "out of memory");
        return NULL;
    }
    *component = blank;
    const Host host = {component, log_message, NULL, NULL, true};
    component->instance = instance_new(interface, token, resource_path, host);
    if (component->instance) return component;
    free(component);
    return NULL;
}

const char *fmi3GetVersion(void)
{
    return "3.0";
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean loggingOn, size_t nCategories, const fmi3String categories[])
{
    (void)loggingOn; /* there is nothing to switch: only statuses other than OK are logged, and those always are */
    Instance *instance = fmi3_legal(c, CALL_fmi3SetDebugLogging);
    return instance ? fmi3_status(instance_check_categories(instance, categories, nCategories)) : fmi3Error;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    (void)instanceName, (void)visible, (void)loggingOn;
    const Component blank = {NULL, logMessage, instanceEnvironment, NULL, false};
    return instantiate(blank, MODEL_EXCHANGE, instantiationToken, resourcePath);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate)
{
    (void)instanceName, (void)visible, (void)loggingOn;
    Component blank = {NULL, logMessage, instanceEnvironment, intermediateUpdate, earlyReturnAllowed};
    if (eventModeUsed) {
        log_message(&blank, STATUS_ERROR, "eventModeUsed = true: there is no event mode (hasEventMode = false)");
        return NULL;
    }
    Component *component = instantiate(blank, CO_SIMULATION, instantiationToken, resourcePath);
    if (!component || fmi3_listen(component, requiredIntermediateVariables, nRequiredIntermediateVariables))
        return component;
    fmi3FreeInstance(component);
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken,
                                               fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment instanceEnvironment,
                                               fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instanceName, (void)instantiationToken, (void)resourcePath, (void)visible, (void)loggingOn;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    if (logMessage) logMessage(instanceEnvironment, fmi3Error, "logStatusError", "Scheduled Execution is not offered");
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c)
{
    Component *component = c;
    if (!fmi3_legal(c, CALL_fmi3FreeInstance)) return;
    instance_free(component->instance);
    free(component);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3EnterInitializationMode);
    if (!instance) return fmi3Error;
    const Status status =
        instance_setup(instance, startTime, toleranceDefined ? &tolerance : NULL, stopTimeDefined ? &stopTime : NULL);
    if (status == STATUS_OK) instance->mode = MODE_INITIALIZATION;
    return fmi3_status(status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3ExitInitializationMode);
    return instance ? fmi3_status(instance_exit_initialization(instance)) : fmi3Error;
}

fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3EnterEventMode);
    if (!instance) return fmi3Error;
    instance->mode = MODE_EVENT;
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3Terminate);
    if (!instance) return fmi3Error;
    instance->mode = MODE_TERMINATED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3Reset);
    return instance ? fmi3_status(instance_reset(instance)) : fmi3Error;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          fmi3Float64 values[], size_t nValues)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetFloat64);
    if (!instance) return fmi3Error;
    if (nValueReferences && (!valueReferences || !values))
        return fmi3_refuse(c, "fmi3GetFloat64: a null pointer was given");
    size_t expected;
    if (instance_count(instance, valueReferences, nValueReferences, &expected) != STATUS_OK) return fmi3Error;
    if (nValues != expected)
        return fmi3_refuse(c,
                           "fmi3GetFloat64: as many values as references are expected, of an array all its elements");
    return fmi3_status(instance_get(instance, valueReferences, nValueReferences, values));
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          const fmi3Float64 values[], size_t nValues)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3SetFloat64);
    if (!instance) return fmi3Error;
    if (nValueReferences && (!valueReferences || !values))
        return fmi3_refuse(c, "fmi3SetFloat64: a null pointer was given");
    size_t expected;
    if (instance_count(instance, valueReferences, nValueReferences, &expected) != STATUS_OK) return fmi3Error;
    if (nValues != expected)
        return fmi3_refuse(c,
                           "fmi3SetFloat64: as many values as references are expected, of an array all its elements");
    return fmi3_status(instance_set(instance, valueReferences, nValueReferences, values));
}

fmi3Status fmi3GetInt64(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        fmi3Int64 values[], size_t nValues)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetInt64);
    if (!instance) return fmi3Error;
    if (nValueReferences && (!valueReferences || !values))
        return fmi3_refuse(c, "fmi3GetInt64: a null pointer was given");
    if (nValues != nValueReferences) return fmi3_refuse(c, "fmi3GetInt64: as many values as references are expected");
    for (size_t k = 0; k < nValues; k++)
        if (instance_get_choice(instance, valueReferences[k], &values[k]) != STATUS_OK) return fmi3Error;
    return fmi3OK;
}

fmi3Status fmi3SetInt64(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        const fmi3Int64 values[], size_t nValues)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3SetInt64);
    if (!instance) return fmi3Error;
    if (nValueReferences && (!valueReferences || !values))
        return fmi3_refuse(c, "fmi3SetInt64: a null pointer was given");
    if (nValues != nValueReferences) return fmi3_refuse(c, "fmi3SetInt64: as many values as references are expected");
    for (size_t k = 0; k < nValues; k++)
        if (instance_check_choice(instance, valueReferences[k], values[k]) != STATUS_OK) return fmi3Error;
    for (size_t k = 0; k < nValues; k++) instance_set_choice(instance, values[k]);
    return fmi3OK;
}

fmi3Status fmi3_no_variables(fmi3Instance c, Call call, size_t count)
{
    if (!fmi3_legal(c, call)) return fmi3Error;
    return count ? fmi3_refuse(c, "the cable has no variables but those of type Float64, the Enumeration solver and, "
                                  "with arrays, the UInt64 n")
                 : fmi3OK;
}

#define TYPE_WITHOUT_VARIABLES(Type)                                                                                   \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count, fmi3##Type values[], \
                             size_t nValues)                                                                           \
    {                                                                                                                  \
        (void)references, (void)values, (void)nValues;                                                                 \
        return fmi3_no_variables(c, CALL_fmi3Get##Type, count);                                                        \
    }                                                                                                                  \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,                      \
                             const fmi3##Type values[], size_t nValues)                                                \
    {                                                                                                                  \
        (void)references, (void)values, (void)nValues;                                                                 \
        return fmi3_no_variables(c, CALL_fmi3Set##Type, count);                                                        \
    }

TYPE_WITHOUT_VARIABLES(Float32)
TYPE_WITHOUT_VARIABLES(Int8)
TYPE_WITHOUT_VARIABLES(UInt8)
TYPE_WITHOUT_VARIABLES(Int16)
TYPE_WITHOUT_VARIABLES(UInt16)
TYPE_WITHOUT_VARIABLES(Int32)
TYPE_WITHOUT_VARIABLES(UInt32)
TYPE_WITHOUT_VARIABLES(Boolean)
TYPE_WITHOUT_VARIABLES(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference references[], size_t count, size_t valueSizes[],
                         fmi3Binary values[], size_t nValues)
{
    (void)references, (void)valueSizes, (void)values, (void)nValues;
    return fmi3_no_variables(c, CALL_fmi3GetBinary, count);
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference references[], size_t count, const size_t valueSizes[],
                         const fmi3Binary values[], size_t nValues)
{
    (void)references, (void)valueSizes, (void)values, (void)nValues;
    return fmi3_no_variables(c, CALL_fmi3SetBinary, count);
}

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference references[], size_t count, fmi3Clock values[])
{
    (void)references, (void)values;
    return fmi3_no_variables(c, CALL_fmi3GetClock, count);
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference references[], size_t count, const fmi3Clock values[])
{
    (void)references, (void)values;
    return fmi3_no_variables(c, CALL_fmi3SetClock, count);
}

/* --- Model Exchange --- */

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                                    fmi3Float64 *nextEventTime)
{
    if (!fmi3_legal(c, CALL_fmi3UpdateDiscreteStates)) return fmi3Error;
    /* The cable has no events of its own. */
    fmi3Boolean *const answer[] = {discreteStatesNeedUpdate, terminateSimulation, nominalsOfContinuousStatesChanged,
                                   valuesOfContinuousStatesChanged, nextEventTimeDefined};
    for (size_t k = 0; k < sizeof answer / sizeof *answer; k++)
        if (answer[k]) *answer[k] = fmi3False;
    if (nextEventTime) *nextEventTime = 0.0;
    return fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c)
{
    return fmi3_legal(c, CALL_fmi3EvaluateDiscreteStates) ? fmi3OK : fmi3Error;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3EnterContinuousTimeMode);
    if (!instance) return fmi3Error;
    instance->mode = MODE_CONTINUOUS;
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!fmi3_legal(c, CALL_fmi3CompletedIntegratorStep)) return fmi3Error;
    if (enterEventMode) *enterEventMode = fmi3False;
    if (terminateSimulation) *terminateSimulation = fmi3False;
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3SetTime);
    return instance ? fmi3_status(instance_set_time(instance, time)) : fmi3Error;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3SetContinuousStates);
    if (!instance) return fmi3Error;
    if (!continuousStates) return fmi3_refuse(c, "fmi3SetContinuousStates: a null pointer was given");
    return fmi3_status(instance_set_states(instance, continuousStates, nContinuousStates));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t nContinuousStates)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetContinuousStateDerivatives);
    if (!instance) return fmi3Error;
    if (!derivatives) return fmi3_refuse(c, "fmi3GetContinuousStateDerivatives: a null pointer was given");
    return fmi3_status(instance_get_derivatives(instance, derivatives, nContinuousStates));
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 eventIndicators[], size_t nEventIndicators)
{
    (void)eventIndicators;
    if (!fmi3_legal(c, CALL_fmi3GetEventIndicators)) return fmi3Error;
    return nEventIndicators ? fmi3_refuse(c, "the cable has no event indicators") : fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetContinuousStates);
    if (!instance) return fmi3Error;
    if (!continuousStates) return fmi3_refuse(c, "fmi3GetContinuousStates: a null pointer was given");
    return fmi3_status(instance_get_states(instance, continuousStates, nContinuousStates));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t nContinuousStates)
{
    Instance *instance = fmi3_legal(c, CALL_fmi3GetNominalsOfContinuousStates);
    if (!instance) return fmi3Error;
    if (!nominals) return fmi3_refuse(c, "fmi3GetNominalsOfContinuousStates: a null pointer was given");
    return fmi3_status(instance_nominals(instance, nominals, nContinuousStates));
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *nEventIndicators)
{
    if (!fmi3_legal(c, CALL_fmi3GetNumberOfEventIndicators)) return fmi3Error;
    if (!nEventIndicators) return fmi3_refuse(c, "fmi3GetNumberOfEventIndicators: a null pointer was given");
    *nEventIndicators = 0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *nContinuousStates)
{
    const Instance *instance = fmi3_legal(c, CALL_fmi3GetNumberOfContinuousStates);
    if (!instance) return fmi3Error;
    if (!nContinuousStates) return fmi3_refuse(c, "fmi3GetNumberOfContinuousStates: a null pointer was given");
    *nContinuousStates = instance_states(instance);
    return fmi3OK;
}

/* --- Co-Simulation --- */

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    fmi3_legal(c, CALL_fmi3EnterStepMode); /* it never is: there is no event mode to leave */
    return fmi3Error;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    Instance *instance = fmi3_legal(c, CALL_fmi3DoStep);
    if (!instance) return fmi3Error;
    const Status status = instance_step(instance, currentCommunicationPoint, communicationStepSize);
    const bool early = status == STATUS_OK && instance->time < currentCommunicationPoint + communicationStepSize;
    if (eventHandlingNeeded) *eventHandlingNeeded = fmi3False;
    if (terminateSimulation) *terminateSimulation = fmi3False;
    if (earlyReturn) *earlyReturn = early;
    if (lastSuccessfulTime) *lastSuccessfulTime = instance->time;
    return fmi3_status(status);
}
