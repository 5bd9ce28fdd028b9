/* Wrong calls through FMI 3.0. */
#include "fmi3Functions.h"
#include "visit.h"

static void note(Account *account, const void *component, int status)
{
    note_status(account, status);
    if (!component && status != 3) give_up("not refused", "a call without an instance");
}

void fmi3_every_call(Account *a, void *c)
{
    note_message(a, 0, fmi3GetVersion());
    note(a, c, (int)fmi3SetDebugLogging(c, false, 0, NULL));
    note(a, c, (int)fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    note(a, c, (int)fmi3ExitInitializationMode(c));
    note(a, c, (int)fmi3EnterEventMode(c));
    note(a, c, (int)fmi3Terminate(c));
    note(a, c, (int)fmi3Reset(c));
    note(a, c, (int)fmi3GetFloat32(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetFloat64(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetInt8(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetUInt8(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetInt16(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetUInt16(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetInt32(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetUInt32(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetInt64(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetUInt64(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetBoolean(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetString(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetBinary(c, NULL, 0, NULL, NULL, 0));
    note(a, c, (int)fmi3GetClock(c, NULL, 0, NULL));
    note(a, c, (int)fmi3SetFloat32(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetFloat64(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetInt8(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetUInt8(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetInt16(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetUInt16(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetInt32(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetUInt32(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetInt64(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetUInt64(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetBoolean(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetString(c, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3SetBinary(c, NULL, 0, NULL, NULL, 0));
    note(a, c, (int)fmi3SetClock(c, NULL, 0, NULL));
    note(a, c, (int)fmi3GetNumberOfVariableDependencies(c, 0, NULL));
    note(a, c, (int)fmi3GetVariableDependencies(c, 0, NULL, NULL, NULL, NULL, 0));
    note(a, c, (int)fmi3GetFMUState(c, NULL));
    note(a, c, (int)fmi3SetFMUState(c, NULL));
    note_status(a, (int)fmi3FreeFMUState(c, NULL)); /* nothing to free is no mistake */
    note(a, c, (int)fmi3SerializedFMUStateSize(c, NULL, NULL));
    note(a, c, (int)fmi3SerializeFMUState(c, NULL, NULL, 0));
    note(a, c, (int)fmi3DeserializeFMUState(c, NULL, 0, NULL));
    note(a, c, (int)fmi3GetDirectionalDerivative(c, NULL, 0, NULL, 0, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3GetAdjointDerivative(c, NULL, 0, NULL, 0, NULL, 0, NULL, 0));
    note(a, c, (int)fmi3EnterConfigurationMode(c));
    note(a, c, (int)fmi3ExitConfigurationMode(c));
    note(a, c, (int)fmi3GetIntervalDecimal(c, NULL, 0, NULL, NULL));
    note(a, c, (int)fmi3GetIntervalFraction(c, NULL, 0, NULL, NULL, NULL));
    note(a, c, (int)fmi3GetShiftDecimal(c, NULL, 0, NULL));
    note(a, c, (int)fmi3GetShiftFraction(c, NULL, 0, NULL, NULL));
    note(a, c, (int)fmi3SetIntervalDecimal(c, NULL, 0, NULL));
    note(a, c, (int)fmi3SetIntervalFraction(c, NULL, 0, NULL, NULL));
    note(a, c, (int)fmi3SetShiftDecimal(c, NULL, 0, NULL));
    note(a, c, (int)fmi3SetShiftFraction(c, NULL, 0, NULL, NULL));
    note(a, c, (int)fmi3EvaluateDiscreteStates(c));
    note(a, c, (int)fmi3UpdateDiscreteStates(c, NULL, NULL, NULL, NULL, NULL, NULL));
    note(a, c, (int)fmi3EnterContinuousTimeMode(c));
    note(a, c, (int)fmi3CompletedIntegratorStep(c, false, NULL, NULL));
    note(a, c, (int)fmi3SetTime(c, 0.0));
    note(a, c, (int)fmi3SetContinuousStates(c, NULL, 0));
    note(a, c, (int)fmi3GetContinuousStateDerivatives(c, NULL, 0));
    note(a, c, (int)fmi3GetEventIndicators(c, NULL, 0));
    note(a, c, (int)fmi3GetContinuousStates(c, NULL, 0));
    note(a, c, (int)fmi3GetNominalsOfContinuousStates(c, NULL, 0));
    note(a, c, (int)fmi3GetNumberOfEventIndicators(c, NULL));
    note(a, c, (int)fmi3GetNumberOfContinuousStates(c, NULL));
    note(a, c, (int)fmi3EnterStepMode(c));
    note(a, c, (int)fmi3GetOutputDerivatives(c, NULL, 0, NULL, NULL, 0));
    note(a, c, (int)fmi3DoStep(c, 0.0, 0.0, false, NULL, NULL, NULL, NULL));
    note(a, c, (int)fmi3ActivateModelPartition(c, 0, 0.0));
}

void fmi3_every_refusal(Visit *visit)
{
    const Scene *scene = visit->scene;
    fmi3Instance c = visit->component;
    const double negative = -0.5, one = 1.0;
    const fmi3Int64 zero = 0, explicit_solver = 2, low = INT64_MIN, high = INT64_MAX;
    fmi3Int64 choice;
    double value[MOST_STATES + 1] = {0.0};
    const fmi3ValueReference beyond = scene->variables, far_beyond = UINT32_MAX, time = 0;
    must_be_refused(visit, (int)fmi3SetFloat64(c, &scene->mass, 1, &negative, 1), "a mass below 0");
    must_be_refused(visit, (int)fmi3SetFloat64(c, &time, 1, &one, 1), "setting the time as a variable");
    must_be_refused(visit, (int)fmi3GetFloat64(c, &beyond, 1, value, 1), "the reference behind the last");
    must_be_refused(visit, (int)fmi3SetFloat64(c, &beyond, 1, &one, 1), "the reference behind the last");
    must_be_refused(visit, (int)fmi3GetFloat64(c, &far_beyond, 1, value, 1), "the last number as a reference");
    must_be_refused(visit, (int)fmi3GetFloat64(c, NULL, 1, value, 1), "no references");
    must_be_refused(visit, (int)fmi3GetFloat64(c, &time, 1, value, 2), "more values than references");
    must_be_refused(visit, (int)fmi3GetFloat64(c, &time, SIZE_MAX, NULL, SIZE_MAX), "no values");
    must_be_refused(visit, (int)fmi3SetFloat64(c, NULL, 1, &one, 1), "no references");
    must_be_refused(visit, (int)fmi3SetFloat64(c, &scene->mass, 1, &one, 0), "fewer values than references");
    must_be_refused(visit, (int)fmi3GetContinuousStates(c, value, scene->states + 1), "a state too many");
    must_be_refused(visit, (int)fmi3GetContinuousStates(c, value, SIZE_MAX), "states without number");
    must_be_refused(visit, (int)fmi3GetNominalsOfContinuousStates(c, value, scene->states - 1), "a state too few");
    must_be_refused(visit, (int)fmi3GetInt64(c, &time, 1, &choice, 1), "the time as an integer");
    must_be_refused(visit, (int)fmi3GetInt64(c, &beyond, 1, &choice, 1), "the reference behind the last");
    must_be_refused(visit, (int)fmi3GetInt64(c, &scene->solver, 1, NULL, 1), "no integers");
    must_be_refused(visit, (int)fmi3GetInt64(c, &scene->solver, 1, &choice, 2), "more values than references");
    must_be_refused(visit, (int)fmi3GetFloat64(c, &scene->solver, 1, value, 1), "an enumeration as a real number");
    must_be_refused(visit, (int)fmi3SetFloat64(c, &scene->solver, 1, &one, 1), "an enumeration as a real number");
    must_be_refused(visit, (int)fmi3SetInt64(c, &scene->solver, 1, &zero, 1), "the item before the first");
    must_be_refused(visit, (int)fmi3SetInt64(c, &scene->solver, 1, &high, 1), "the largest integer");
    must_be_refused(visit, (int)fmi3SetInt64(c, &scene->solver, 1, &low, 1), "the least integer");
    must_be_refused(visit, (int)fmi3SetInt64(c, &scene->mass, 1, &explicit_solver, 1), "a real number as an integer");
    must_be_refused(visit, (int)fmi3GetInt32(c, &time, 1, NULL, 1), "an integer of 32 bits");
    must_be_refused(visit, (int)fmi3DoStep(c, 0.0, STEP, true, NULL, NULL, NULL, NULL), "a step before initialization");
    must_be_refused(visit, (int)fmi3EnterInitializationMode(c, true, -1e-3, 0.0, false, 0.0), "a tolerance below 0");
    if (fmi3InstantiateScheduledExecution("visitor", scene->token, scene->location, false, true, NULL, NULL, NULL, NULL,
                                          NULL))
        give_up("not refused", "Scheduled Execution");
}
