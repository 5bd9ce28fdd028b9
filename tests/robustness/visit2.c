/* Visits through FMI 2.0. */
#include <stdlib.h>

#include "fmi2Functions.h"
#include "visit.h"

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    (void)name, (void)category;
    note_message(environment, (int)status, message);
}

static bool open(Visit *visit, fmi2Type type)
{
    /* On the stack: the host's struct need not outlive the call. */
    const fmi2CallbackFunctions functions = {log_message, calloc, free, NULL, &visit->account};
    const Scene *scene = visit->scene;
    visit->component = fmi2Instantiate("visitor", type, scene->token, scene->location, &functions, fmi2False, fmi2True);
    return visit->component != NULL;
}

static bool open_cs(Visit *visit)
{
    return open(visit, fmi2CoSimulation);
}

static bool open_me(Visit *visit)
{
    return open(visit, fmi2ModelExchange);
}

static void reset(Visit *visit)
{
    must_be_ok(visit, (int)fmi2Reset(visit->component), "fmi2Reset");
}

static void mistakes(Visit *visit)
{
    fmi2_every_call(&visit->account, NULL);
    fmi2_every_call(&visit->account, visit->component);
    reset(visit);
    fmi2_every_refusal(visit);
    reset(visit);
}

static void set(Visit *visit, uint32_t reference, double value)
{
    must_be_ok(visit, (int)fmi2SetReal(visit->component, &reference, 1, &value), "fmi2SetReal");
}

static void read_all(Visit *visit)
{
    fmi2ValueReference reference[MOST_VARIABLES];
    double value[MOST_VARIABLES];
    const size_t count = real_variables(visit->scene, reference);
    fmi2Integer choice;
    must_be_ok(visit, (int)fmi2GetReal(visit->component, reference, count, value), "fmi2GetReal");
    note_values(&visit->account, value, count);
    must_be_ok(visit, (int)fmi2GetInteger(visit->component, &visit->scene->solver, 1, &choice), "fmi2GetInteger");
    note_status(&visit->account, (int)choice);
}

static void start_cs(Visit *visit, double mass)
{
    fmi2Component c = visit->component;
    const fmi2Integer choice = choice_for(mass);
    set(visit, visit->scene->mass, mass);
    must_be_ok(visit, (int)fmi2SetInteger(c, &visit->scene->solver, 1, &choice), "fmi2SetInteger");
    must_be_ok(visit, (int)fmi2SetupExperiment(c, fmi2True, 1e-4, 0.0, fmi2False, 0.0), "fmi2SetupExperiment");
    must_be_ok(visit, (int)fmi2EnterInitializationMode(c), "fmi2EnterInitializationMode");
    set(visit, visit->scene->force, force_at(0));
    read_all(visit);
    must_be_ok(visit, (int)fmi2ExitInitializationMode(c), "fmi2ExitInitializationMode");
}

static void enter_continuous_time(Visit *visit)
{
    fmi2EventInfo info;
    must_be_ok(visit, (int)fmi2NewDiscreteStates(visit->component, &info), "fmi2NewDiscreteStates");
    must_be_ok(visit, (int)fmi2EnterContinuousTimeMode(visit->component), "fmi2EnterContinuousTimeMode");
}

static void start_me(Visit *visit, double mass)
{
    start_cs(visit, mass);
    enter_continuous_time(visit);
}

static void step_cs(Visit *visit, int k)
{
    const fmi2ValueReference force = visit->scene->force;
    const fmi2Integer order = 1;
    const double slope = (force_at(k + 1) - force_at(k)) / STEP;
    set(visit, force, force_at(k));
    must_be_ok(visit, (int)fmi2SetRealInputDerivatives(visit->component, &force, 1, &order, &slope),
               "fmi2SetRealInputDerivatives");
    must_be_ok(visit, (int)fmi2DoStep(visit->component, k * STEP, STEP, fmi2True), "fmi2DoStep");
    read_all(visit);
    note_step(&visit->account, k);
}

/* Euler's rule: enough to come by ever new states. */
static void step_me(Visit *visit, int k)
{
    fmi2Component c = visit->component;
    const uint32_t states = visit->scene->states;
    double x[MOST_STATES], slope[MOST_STATES];
    fmi2Boolean event, stop;
    must_be_ok(visit, (int)fmi2SetTime(c, k * STEP), "fmi2SetTime");
    set(visit, visit->scene->force, force_at(k));
    must_be_ok(visit, (int)fmi2GetContinuousStates(c, x, states), "fmi2GetContinuousStates");
    must_be_ok(visit, (int)fmi2GetDerivatives(c, slope, states), "fmi2GetDerivatives");
    for (uint32_t i = 0; i < states; i++) x[i] += STEP / 8.0 * slope[i];
    must_be_ok(visit, (int)fmi2SetContinuousStates(c, x, states), "fmi2SetContinuousStates");
    must_be_ok(visit, (int)fmi2CompletedIntegratorStep(c, fmi2True, &event, &stop), "fmi2CompletedIntegratorStep");
    if (k % 10 == 9) {
        must_be_ok(visit, (int)fmi2EnterEventMode(c), "fmi2EnterEventMode");
        enter_continuous_time(visit);
    }
    read_all(visit);
    note_step(&visit->account, k);
}

static void close(Visit *visit)
{
    fmi2FreeInstance(visit->component);
}

const Api FMI2_CS = {"FMI 2 Co-Simulation", open_cs, mistakes, start_cs, step_cs, reset, close, &FMI2_STATES};
const Api FMI2_ME = {"FMI 2 Model Exchange", open_me, mistakes, start_me, step_me, reset, close, &FMI2_STATES};
