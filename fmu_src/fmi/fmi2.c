/* The FMI 2.0 interface over instance.h: argument checks, legal states, nothing else. */
#include <stdlib.h>
#include <string.h>

#include "fmi2_component.h"

fmi2Status fmi2_status(Status status)
{
    static const fmi2Status MEANING[] = {fmi2OK, fmi2Warning, fmi2Error, fmi2Discard};
    return MEANING[status];
}

/*
 * The host takes the message as a format, so its percent signs are doubled; and # as the start of a reference, likewise.
 * The text must not come behind a "%s": hosts whose call-backs take no variable arguments, as in Python, would show that
 * alone.
 */
static void log_message(void *owner, Status status, const char *message)
{
    const Component *component = owner;
    if (!component->logger) return;
    char format[TEXT_DOUBLED_BYTES];
    text_doubled(message, "%#", format);
    component->logger(component->environment, component->name, fmi2_status(status), log_category(status), format);
}

fmi2Status fmi2_refuse(fmi2Component c, const char *message)
{
    if (c) log_message(c, STATUS_ERROR, message);
    return fmi2Error;
}

Instance *fmi2_legal(fmi2Component c, Call call)
{
    Component *component = c;
    if (!component) return NULL;
    return instance_allows(component->instance, call) ? component->instance : NULL;
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return "2.0";
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    (void)loggingOn; /* there is nothing to switch: only statuses other than OK are logged, and those always are */
    Instance *instance = fmi2_legal(c, CALL_fmi2SetDebugLogging);
    return instance ? fmi2_status(instance_check_categories(instance, categories, nCategories)) : fmi2Error;
}

/* What is known of the host before there is an instance; NULL, and the host told, without memory. */
static Component *component_new(const char *name, const fmi2CallbackFunctions *functions)
{
    const size_t length = strlen(name) + 1;
    Component *component = calloc(1, sizeof *component + length);
    if (component) {
        memcpy(component->name, name, length);
        if (!functions) return component;
        component->logger = functions->logger;
        component->environment = functions->componentEnvironment;
    } else if (functions && functions->logger) {
        functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError", "out of memory");
    }
    return component;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    (void)visible, (void)loggingOn;
    Component *component = component_new(instanceName ? instanceName : "", functions);
    if (!component) return NULL;
    const Host host = {component, log_message, NULL, NULL, false};
    const Interface interface = fmuType == fmi2CoSimulation ? CO_SIMULATION : MODEL_EXCHANGE;
    if (fmuType != fmi2CoSimulation && fmuType != fmi2ModelExchange)
        fmi2_refuse(component, "fmi2Instantiate: fmuType is neither fmi2ModelExchange nor fmi2CoSimulation");
    else
        component->instance = instance_new(interface, fmuGUID, fmuResourceLocation, host);
    if (component->instance) return component;
    free(component);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c)
{
    Component *component = c;
    if (!fmi2_legal(c, CALL_fmi2FreeInstance)) return;
    instance_free(component->instance);
    free(component);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SetupExperiment);
    if (!instance) return fmi2Error;
    return fmi2_status(
        instance_setup(instance, startTime, toleranceDefined ? &tolerance : NULL, stopTimeDefined ? &stopTime : NULL));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2EnterInitializationMode);
    if (!instance) return fmi2Error;
    instance->mode = MODE_INITIALIZATION;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2ExitInitializationMode);
    return instance ? fmi2_status(instance_exit_initialization(instance)) : fmi2Error;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2Terminate);
    if (!instance) return fmi2Error;
    instance->mode = MODE_TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2Reset);
    return instance ? fmi2_status(instance_reset(instance)) : fmi2Error;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetReal);
    if (!instance) return fmi2Error;
    if (nvr && (!vr || !value)) return fmi2_refuse(c, "fmi2GetReal: a null pointer was given");
    return fmi2_status(instance_get(instance, vr, nvr, value));
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SetReal);
    if (!instance) return fmi2Error;
    if (nvr && (!vr || !value)) return fmi2_refuse(c, "fmi2SetReal: a null pointer was given");
    return fmi2_status(instance_set(instance, vr, nvr, value));
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[])
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetInteger);
    if (!instance) return fmi2Error;
    if (nvr && (!vr || !value)) return fmi2_refuse(c, "fmi2GetInteger: a null pointer was given");
    for (size_t k = 0; k < nvr; k++) {
        int64_t choice;
        if (instance_get_choice(instance, vr[k], &choice) != STATUS_OK) return fmi2Error;
        value[k] = (fmi2Integer)choice;
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[])
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SetInteger);
    if (!instance) return fmi2Error;
    if (nvr && (!vr || !value)) return fmi2_refuse(c, "fmi2SetInteger: a null pointer was given");
    for (size_t k = 0; k < nvr; k++)
        if (instance_check_choice(instance, vr[k], value[k]) != STATUS_OK) return fmi2Error;
    for (size_t k = 0; k < nvr; k++) instance_set_choice(instance, value[k]);
    return fmi2OK;
}

/* Of other types the cable has no variables: an empty list is fine, anything else a mistake. */
static fmi2Status no_variables(fmi2Component c, Call call, size_t count)
{
    if (!fmi2_legal(c, call)) return fmi2Error;
    return count ? fmi2_refuse(c, "the cable has no variables but those of type Real and the Enumeration solver")
                 : fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    (void)vr, (void)value;
    return no_variables(c, CALL_fmi2GetBoolean, nvr);
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    (void)vr, (void)value;
    return no_variables(c, CALL_fmi2GetString, nvr);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[])
{
    (void)vr, (void)value;
    return no_variables(c, CALL_fmi2SetBoolean, nvr);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    (void)vr, (void)value;
    return no_variables(c, CALL_fmi2SetString, nvr);
}

/* --- Model Exchange --- */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2EnterEventMode);
    if (!instance) return fmi2Error;
    instance->mode = MODE_EVENT;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo)
{
    if (!fmi2_legal(c, CALL_fmi2NewDiscreteStates)) return fmi2Error;
    if (!eventInfo) return fmi2_refuse(c, "fmi2NewDiscreteStates: a null pointer was given");
    memset(eventInfo, 0, sizeof *eventInfo); /* the cable has no events of its own */
    return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2EnterContinuousTimeMode);
    if (!instance) return fmi2Error;
    instance->mode = MODE_CONTINUOUS;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!fmi2_legal(c, CALL_fmi2CompletedIntegratorStep)) return fmi2Error;
    if (!enterEventMode || !terminateSimulation)
        return fmi2_refuse(c, "fmi2CompletedIntegratorStep: a null pointer was given");
    *enterEventMode = *terminateSimulation = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SetTime);
    return instance ? fmi2_status(instance_set_time(instance, time)) : fmi2Error;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SetContinuousStates);
    if (!instance) return fmi2Error;
    if (!x) return fmi2_refuse(c, "fmi2SetContinuousStates: a null pointer was given");
    return fmi2_status(instance_set_states(instance, x, nx));
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetDerivatives);
    if (!instance) return fmi2Error;
    if (!derivatives) return fmi2_refuse(c, "fmi2GetDerivatives: a null pointer was given");
    return fmi2_status(instance_get_derivatives(instance, derivatives, nx));
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni)
{
    (void)eventIndicators;
    if (!fmi2_legal(c, CALL_fmi2GetEventIndicators)) return fmi2Error;
    return ni ? fmi2_refuse(c, "the cable has no event indicators") : fmi2OK;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetContinuousStates);
    if (!instance) return fmi2Error;
    if (!x) return fmi2_refuse(c, "fmi2GetContinuousStates: a null pointer was given");
    return fmi2_status(instance_get_states(instance, x, nx));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx)
{
    Instance *instance = fmi2_legal(c, CALL_fmi2GetNominalsOfContinuousStates);
    if (!instance) return fmi2Error;
    if (!x_nominal) return fmi2_refuse(c, "fmi2GetNominalsOfContinuousStates: a null pointer was given");
    return fmi2_status(instance_nominals(instance, x_nominal, nx));
}

/* --- Co-Simulation --- */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    Instance *instance = fmi2_legal(c, CALL_fmi2SetRealInputDerivatives);
    if (!instance) return fmi2Error;
    if (nvr && (!vr || !order || !value))
        return fmi2_refuse(c, "fmi2SetRealInputDerivatives: a null pointer was given");
    for (size_t k = 0; k < nvr; k++)
        if (instance_set_input_derivative(instance, vr[k], order[k], value[k]) != STATUS_OK) return fmi2Error;
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    Instance *instance = fmi2_legal(c, CALL_fmi2DoStep);
    if (!instance) return fmi2Error;
    return fmi2_status(instance_step(instance, currentCommunicationPoint, communicationStepSize));
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return fmi2_refuse(c, "fmi2CancelStep: steps are not asynchronous, there is none to cancel");
}

/* What cannot be told of the last step: that is no error [FMI 2.0.5, section 4.2.3]. */
static fmi2Status unknown_status(fmi2Component c, Call call, const char *message)
{
    if (!fmi2_legal(c, call)) return fmi2Error;
    log_message(c, STATUS_DISCARD, message);
    return fmi2Discard;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    (void)s, (void)value;
    return unknown_status(c, CALL_fmi2GetStatus,
                          "fmi2GetStatus: steps are not asynchronous, fmi2DoStep returns their status");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    if (s != fmi2LastSuccessfulTime)
        return unknown_status(c, CALL_fmi2GetRealStatus,
                              "fmi2GetRealStatus: only fmi2LastSuccessfulTime is a real number");
    const Instance *instance = fmi2_legal(c, CALL_fmi2GetRealStatus);
    if (!instance) return fmi2Error;
    if (!value) return fmi2_refuse(c, "fmi2GetRealStatus: a null pointer was given");
    *value = instance->time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    (void)s, (void)value;
    return unknown_status(c, CALL_fmi2GetIntegerStatus, "fmi2GetIntegerStatus: there is no status of this type");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    if (s != fmi2Terminated)
        return unknown_status(c, CALL_fmi2GetBooleanStatus,
                              "fmi2GetBooleanStatus: only fmi2Terminated is true or false");
    if (!fmi2_legal(c, CALL_fmi2GetBooleanStatus)) return fmi2Error;
    if (!value) return fmi2_refuse(c, "fmi2GetBooleanStatus: a null pointer was given");
    *value = fmi2False; /* the cable never asks for the end of a simulation */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    (void)s, (void)value;
    return unknown_status(c, CALL_fmi2GetStringStatus,
                          "fmi2GetStringStatus: steps are not asynchronous, none is pending");
}
