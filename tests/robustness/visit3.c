/* Visits through FMI 3.0. */
#include "fmi3Functions.h"
#include "visit.h"

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)category;
    Visit *visit = environment;
    note_message(&visit->account, (int)status, message);
}

static void set(Visit *visit, uint32_t reference, double value)
{
    must_be_ok(visit, (int)fmi3SetFloat64(visit->component, &reference, 1, &value, 1), "fmi3SetFloat64");
}

/* Inside a step: a force that changes with time, and once what is forbidden there. */
static void ask(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean may_set, fmi3Boolean may_get,
                fmi3Boolean finished, fmi3Boolean may_return, fmi3Boolean *early, fmi3Float64 *early_time)
{
    (void)may_set, (void)may_get, (void)finished, (void)may_return, (void)early, (void)early_time;
    Visit *visit = environment;
    set(visit, visit->scene->force, 200.0 * time);
    if (++visit->asked != 3) return;
    const fmi3ValueReference reference = visit->scene->force;
    double value;
    must_be_refused(visit, (int)fmi3GetFloat64(visit->component, &reference, 1, &value, 1), "reading inside a step");
    must_be_refused(visit, (int)fmi3Reset(visit->component), "fmi3Reset inside a step");
    must_be_refused(visit, (int)fmi3GetFMUState(visit->component, &visit->state), "a state inside a step");
    must_be_refused(visit, (int)fmi3Terminate(visit->component), "fmi3Terminate inside a step");
    must_be_refused(visit, (int)fmi3DoStep(visit->component, time, STEP, true, NULL, NULL, NULL, NULL),
                    "a step inside a step");
}

static bool open_cosimulation(Visit *visit, fmi3IntermediateUpdateCallback update)
{
    const Scene *scene = visit->scene;
    visit->component = fmi3InstantiateCoSimulation("visitor", scene->token, scene->location, false, true, false, false,
                                                   &scene->force, update ? 1 : 0, visit, log_message, update);
    return visit->component != NULL;
}

static bool open_cs(Visit *visit)
{
    return open_cosimulation(visit, NULL);
}

static bool open_asked(Visit *visit)
{
    return open_cosimulation(visit, ask);
}

static bool open_me(Visit *visit)
{
    const Scene *scene = visit->scene;
    visit->component =
        fmi3InstantiateModelExchange("visitor", scene->token, scene->location, false, true, visit, log_message);
    return visit->component != NULL;
}

static void reset(Visit *visit)
{
    must_be_ok(visit, (int)fmi3Reset(visit->component), "fmi3Reset");
}

static void mistakes(Visit *visit)
{
    fmi3_every_call(&visit->account, NULL);
    fmi3_every_call(&visit->account, visit->component);
    reset(visit);
    fmi3_every_refusal(visit);
    reset(visit);
}

static void read_all(Visit *visit)
{
    fmi3ValueReference reference[MOST_VARIABLES];
    double value[MOST_VARIABLES];
    const size_t count = real_variables(visit->scene, reference);
    fmi3Int64 choice;
    must_be_ok(visit, (int)fmi3GetFloat64(visit->component, reference, count, value, count), "fmi3GetFloat64");
    note_values(&visit->account, value, count);
    must_be_ok(visit, (int)fmi3GetInt64(visit->component, &visit->scene->solver, 1, &choice, 1), "fmi3GetInt64");
    note_status(&visit->account, (int)choice);
}

static void start_cs(Visit *visit, double mass)
{
    fmi3Instance c = visit->component;
    const fmi3Int64 choice = choice_for(mass);
    set(visit, visit->scene->mass, mass);
    must_be_ok(visit, (int)fmi3SetInt64(c, &visit->scene->solver, 1, &choice, 1), "fmi3SetInt64");
    must_be_ok(visit, (int)fmi3EnterInitializationMode(c, true, 1e-4, 0.0, false, 0.0), "fmi3EnterInitializationMode");
    set(visit, visit->scene->force, force_at(0));
    read_all(visit);
    must_be_ok(visit, (int)fmi3ExitInitializationMode(c), "fmi3ExitInitializationMode");
}

static void enter_continuous_time(Visit *visit)
{
    bool flag[5];
    double time;
    must_be_ok(visit,
               (int)fmi3UpdateDiscreteStates(visit->component, &flag[0], &flag[1], &flag[2], &flag[3], &flag[4], &time),
               "fmi3UpdateDiscreteStates");
    must_be_ok(visit, (int)fmi3EnterContinuousTimeMode(visit->component), "fmi3EnterContinuousTimeMode");
}

static void start_me(Visit *visit, double mass)
{
    start_cs(visit, mass);
    enter_continuous_time(visit);
}

static void step_cs(Visit *visit, int k)
{
    bool event, stop, early;
    double last;
    set(visit, visit->scene->force, force_at(k));
    must_be_ok(visit, (int)fmi3DoStep(visit->component, k * STEP, STEP, true, &event, &stop, &early, &last),
               "fmi3DoStep");
    note_values(&visit->account, &last, 1);
    read_all(visit);
    note_step(&visit->account, k);
}

/* Euler's rule: enough to come by ever new states. */
static void step_me(Visit *visit, int k)
{
    fmi3Instance c = visit->component;
    const uint32_t states = visit->scene->states;
    double x[MOST_STATES], slope[MOST_STATES];
    bool event, stop;
    must_be_ok(visit, (int)fmi3SetTime(c, k * STEP), "fmi3SetTime");
    set(visit, visit->scene->force, force_at(k));
    must_be_ok(visit, (int)fmi3GetContinuousStates(c, x, states), "fmi3GetContinuousStates");
    must_be_ok(visit, (int)fmi3GetContinuousStateDerivatives(c, slope, states), "fmi3GetContinuousStateDerivatives");
    for (uint32_t i = 0; i < states; i++) x[i] += STEP / 8.0 * slope[i];
    must_be_ok(visit, (int)fmi3SetContinuousStates(c, x, states), "fmi3SetContinuousStates");
    must_be_ok(visit, (int)fmi3CompletedIntegratorStep(c, true, &event, &stop), "fmi3CompletedIntegratorStep");
    if (k % 10 == 9) {
        must_be_ok(visit, (int)fmi3EnterEventMode(c), "fmi3EnterEventMode");
        enter_continuous_time(visit);
    }
    read_all(visit);
    note_step(&visit->account, k);
}

static void close(Visit *visit)
{
    fmi3FreeInstance(visit->component);
}

const Api FMI3_CS = {"FMI 3 Co-Simulation", open_cs, mistakes, start_cs, step_cs, reset, close, &FMI3_STATES};
const Api FMI3_CS_ASKED = {"FMI 3 Co-Simulation with intermediate update",
                           open_asked,
                           mistakes,
                           start_cs,
                           step_cs,
                           reset,
                           close,
                           &FMI3_STATES};
const Api FMI3_ME = {"FMI 3 Model Exchange", open_me, mistakes, start_me, step_me, reset, close, &FMI3_STATES};
