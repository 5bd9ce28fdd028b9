/*
 * What fmi2DoStep costs beyond the integration: N communication steps through it, the same N by solver_advance() alone on an
 * instance of the same FMU, and on from there by turns, many times. argv: resources folder, token, N, step [s]. Prints
 * nanoseconds per step of each, in the fastest round, and whether both ended on the same bits.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../../fmu_src/fmi/fmi2_component.h"

enum { ROUNDS = 100 };

static double seconds(void)
{
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool rest(void *source, double time, double *u)
{
    (void)time;
    memcpy(u, source, INPUT_COUNT * sizeof *u);
    return true;
}

static Component *begin(const char *token, const char *resources)
{
    static const fmi2CallbackFunctions none = {0};
    Component *c = fmi2Instantiate("a", fmi2CoSimulation, token, resources, &none, fmi2False, fmi2False);
    if (!c) exit(2);
    fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0);
    fmi2EnterInitializationMode(c);
    fmi2ExitInitializationMode(c);
    return c;
}

static double through_fmi(Component *c, int first, int count, double step)
{
    const double begun = seconds();
    for (int k = first; k < first + count; k++)
        if (fmi2DoStep(c, k * step, step, fmi2True) != fmi2OK) exit(3);
    return seconds() - begun;
}

static double alone(Instance *instance, int first, int count, double step)
{
    const System system = {&instance->model, &instance->work, &instance->linear, rest, instance->u, true, NULL};
    const double begun = seconds();
    for (int k = first; k < first + count; k++)
        if (solver_advance(&system, &instance->solver, instance->solver_block, &instance->time, k * step + step,
                           instance->x) != SOLVER_OK)
            exit(3);
    return seconds() - begun;
}

int main(int argc, char **argv)
{
    if (argc != 5) return 2;
    const int count = atoi(argv[3]);
    const double step = atof(argv[4]);
    double fastest[2] = {1e9, 1e9};
    Component *one = begin(argv[2], argv[1]), *other = begin(argv[2], argv[1]);
    for (int round = 0; round < ROUNDS; round++) { /* by turns: the machine is shared */
        const double by_fmi = through_fmi(one, round * count, count, step);
        const double bare = alone(other->instance, round * count, count, step);
        fastest[0] = by_fmi < fastest[0] ? by_fmi : fastest[0];
        fastest[1] = bare < fastest[1] ? bare : fastest[1];
    }
    const size_t states = (size_t)model_states(&one->instance->model);
    const bool same = memcmp(one->instance->x, other->instance->x, states * sizeof(double)) == 0;
    fmi2FreeInstance(one);
    fmi2FreeInstance(other);
    printf("{\"through_fmi\": %.2f, \"alone\": %.2f, \"same\": %s}\n", 1e9 * fastest[0] / count,
           1e9 * fastest[1] / count, same ? "true" : "false");
    return 0;
}
