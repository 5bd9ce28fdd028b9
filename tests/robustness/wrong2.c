/* Wrong calls through FMI 2.0. */
#include "fmi2Functions.h"
#include "visit.h"

static void note(Account *account, const void *component, int status)
{
    note_status(account, status);
    if (!component && status != 3) give_up("not refused", "a call without an instance");
}

void fmi2_every_call(Account *a, void *c)
{
    note_message(a, 0, fmi2GetVersion());
    note_message(a, 0, fmi2GetTypesPlatform());
    note(a, c, (int)fmi2SetDebugLogging(c, fmi2False, 0, NULL));
    note(a, c, (int)fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    note(a, c, (int)fmi2EnterInitializationMode(c));
    note(a, c, (int)fmi2ExitInitializationMode(c));
    note(a, c, (int)fmi2Terminate(c));
    note(a, c, (int)fmi2Reset(c));
    note(a, c, (int)fmi2GetReal(c, NULL, 0, NULL));
    note(a, c, (int)fmi2GetInteger(c, NULL, 0, NULL));
    note(a, c, (int)fmi2GetBoolean(c, NULL, 0, NULL));
    note(a, c, (int)fmi2GetString(c, NULL, 0, NULL));
    note(a, c, (int)fmi2SetReal(c, NULL, 0, NULL));
    note(a, c, (int)fmi2SetInteger(c, NULL, 0, NULL));
    note(a, c, (int)fmi2SetBoolean(c, NULL, 0, NULL));
    note(a, c, (int)fmi2SetString(c, NULL, 0, NULL));
    note(a, c, (int)fmi2GetFMUstate(c, NULL));
    note(a, c, (int)fmi2SetFMUstate(c, NULL));
    note_status(a, (int)fmi2FreeFMUstate(c, NULL)); /* nothing to free is no mistake */
    note(a, c, (int)fmi2SerializedFMUstateSize(c, NULL, NULL));
    note(a, c, (int)fmi2SerializeFMUstate(c, NULL, NULL, 0));
    note(a, c, (int)fmi2DeSerializeFMUstate(c, NULL, 0, NULL));
    note(a, c, (int)fmi2GetDirectionalDerivative(c, NULL, 0, NULL, 0, NULL, NULL));
    note(a, c, (int)fmi2EnterEventMode(c));
    note(a, c, (int)fmi2NewDiscreteStates(c, NULL));
    note(a, c, (int)fmi2EnterContinuousTimeMode(c));
    note(a, c, (int)fmi2CompletedIntegratorStep(c, fmi2False, NULL, NULL));
    note(a, c, (int)fmi2SetTime(c, 0.0));
    note(a, c, (int)fmi2SetContinuousStates(c, NULL, 0));
    note(a, c, (int)fmi2GetDerivatives(c, NULL, 0));
    note(a, c, (int)fmi2GetEventIndicators(c, NULL, 0));
    note(a, c, (int)fmi2GetContinuousStates(c, NULL, 0));
    note(a, c, (int)fmi2GetNominalsOfContinuousStates(c, NULL, 0));
    note(a, c, (int)fmi2SetRealInputDerivatives(c, NULL, 0, NULL, NULL));
    note(a, c, (int)fmi2GetRealOutputDerivatives(c, NULL, 0, NULL, NULL));
    note(a, c, (int)fmi2DoStep(c, 0.0, 0.0, fmi2False));
    note(a, c, (int)fmi2CancelStep(c));
    note(a, c, (int)fmi2GetStatus(c, fmi2DoStepStatus, NULL));
    note(a, c, (int)fmi2GetRealStatus(c, fmi2DoStepStatus, NULL));
    note(a, c, (int)fmi2GetIntegerStatus(c, fmi2DoStepStatus, NULL));
    note(a, c, (int)fmi2GetBooleanStatus(c, fmi2DoStepStatus, NULL));
    note(a, c, (int)fmi2GetStringStatus(c, fmi2DoStepStatus, NULL));
}

void fmi2_every_refusal(Visit *visit)
{
    const Scene *scene = visit->scene;
    fmi2Component c = visit->component;
    const double negative = -0.5, one = 1.0;
    double value[MOST_STATES + 1] = {0.0};
    const fmi2ValueReference beyond = scene->variables, far_beyond = UINT32_MAX, time = 0;
    const fmi2Integer zero = 0, nine = 9, low = INT32_MIN, explicit_solver = 2;
    fmi2Integer choice;
    must_be_refused(visit, (int)fmi2SetReal(c, &scene->mass, 1, &negative), "a mass below 0");
    must_be_refused(visit, (int)fmi2SetReal(c, &time, 1, &one), "setting the time as a variable");
    must_be_refused(visit, (int)fmi2GetReal(c, &beyond, 1, value), "the reference behind the last");
    must_be_refused(visit, (int)fmi2SetReal(c, &beyond, 1, &one), "the reference behind the last");
    must_be_refused(visit, (int)fmi2GetReal(c, &far_beyond, 1, value), "the last number as a reference");
    must_be_refused(visit, (int)fmi2GetReal(c, NULL, 1, value), "no references");
    must_be_refused(visit, (int)fmi2GetReal(c, &time, SIZE_MAX, NULL), "no values");
    must_be_refused(visit, (int)fmi2SetReal(c, NULL, 1, &one), "no references");
    must_be_refused(visit, (int)fmi2SetReal(c, &time, 1, NULL), "no values");
    must_be_refused(visit, (int)fmi2SetRealInputDerivatives(c, &scene->force, 1, &zero, &one), "order 0");
    must_be_refused(visit, (int)fmi2SetRealInputDerivatives(c, &scene->force, 1, &nine, &one), "order 9");
    must_be_refused(visit, (int)fmi2SetRealInputDerivatives(c, &scene->force, 1, &low, &one), "the least order");
    must_be_refused(visit, (int)fmi2SetRealInputDerivatives(c, &scene->mass, 1, &zero, &one), "not an input");
    must_be_refused(visit, (int)fmi2SetRealInputDerivatives(c, &scene->force, 1, NULL, &one), "no orders");
    must_be_refused(visit, (int)fmi2GetContinuousStates(c, value, scene->states + 1), "a state too many");
    must_be_refused(visit, (int)fmi2GetContinuousStates(c, value, SIZE_MAX), "states without number");
    must_be_refused(visit, (int)fmi2GetNominalsOfContinuousStates(c, value, scene->states - 1), "a state too few");
    must_be_refused(visit, (int)fmi2GetInteger(c, &time, 1, &choice), "the time as an integer");
    must_be_refused(visit, (int)fmi2GetInteger(c, &beyond, 1, &choice), "the reference behind the last");
    must_be_refused(visit, (int)fmi2GetInteger(c, &scene->solver, 1, NULL), "no integers");
    must_be_refused(visit, (int)fmi2GetReal(c, &scene->solver, 1, value), "an enumeration as a real number");
    must_be_refused(visit, (int)fmi2SetReal(c, &scene->solver, 1, &one), "an enumeration as a real number");
    must_be_refused(visit, (int)fmi2SetInteger(c, &scene->solver, 1, &zero), "the item before the first");
    must_be_refused(visit, (int)fmi2SetInteger(c, &scene->solver, 1, &nine), "an item behind the last");
    must_be_refused(visit, (int)fmi2SetInteger(c, &scene->solver, 1, &low), "the least integer");
    must_be_refused(visit, (int)fmi2SetInteger(c, &scene->mass, 1, &explicit_solver), "a real number as an integer");
    must_be_refused(visit, (int)fmi2GetBoolean(c, &time, 1, NULL), "a Boolean");
    must_be_refused(visit, (int)fmi2DoStep(c, 0.0, STEP, fmi2True), "a step before initialization");
    must_be_refused(visit, (int)fmi2NewDiscreteStates(c, NULL), "an event before initialization");
    must_be_refused(visit, (int)fmi2SetupExperiment(c, fmi2True, -1e-3, 0.0, fmi2False, 0.0), "a tolerance below 0");
}
