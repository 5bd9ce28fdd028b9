#include "derivatives.h"

#include <math.h>
#include <string.h>

#include "../kernel/adjoint.h"
#include "../kernel/directional.h"
#include "../kernel/effective_mass.h"
#include "../kernel/equilibrium_change.h"

/*
 * Of unknowns y(x, u), states x and inputs u being the knowns. Parameters are none: they are fixed when derivatives are
 * asked for. In initialization mode an equilibrium is sought, where the scene says so: then x follows u, and what was set
 * for x is where the search begins. Nothing is differenced.
 */

static bool starts_at_equilibrium(const Instance *instance)
{
    return instance->guess && instance->mode == MODE_INITIALIZATION;
}

static Status refuse_singular(Instance *instance)
{
    Text text;
    text_start(&text);
    text_add(&text, "the accelerations have no derivatives");
    text_at_time(&text, instance->time);
    text_add(&text, ": the cable is straight and taut between two ends that cannot give");
    return instance_fail(instance, &text);
}

/* The linearised cable at the present state. It stays until something is set, so that a host's dense Jacobian costs one
 * factorisation. */
static bool refresh_linear(Instance *instance)
{
    if (!refresh_derivatives(instance)) return false;
    if (instance->linear_is_current) return true;
    instance->linear_is_lent = true;
    instance->linear_is_current =
        directional_point(&instance->model, instance->x, &instance->work, instance->derivative, &instance->linear);
    return instance->linear_is_current || refuse_singular(instance) == STATUS_OK;
}

bool instance_effective_mass(Instance *instance, uint32_t output, double *value)
{
    if (!refresh_linear(instance)) return false;
    if (!instance->masses_are_current) effective_masses(&instance->model, &instance->linear, instance->output);
    instance->masses_are_current = true;
    *value = instance->output[output];
    return true;
}

/* The same as an equilibrium; only in initialization mode, and so nothing is kept of it. */
static bool take_equilibrium(Instance *instance)
{
    instance->linear_is_lent = true, instance->linear_is_current = false;
    if (!refresh_derivatives(instance)) return false;
    double still[INPUT_COUNT];
    statics_inputs(instance->u, still);
    cable_derivatives(&instance->model, instance->x, still, &instance->work, instance->derivative);
    invalidate_state(instance);
    return equilibrium_point(&instance->model, instance->x, &instance->work, instance->derivative, &instance->linear) ||
           refuse_singular(instance) == STATUS_OK;
}

static bool check_knowns(Instance *instance, References knowns)
{
    for (size_t k = 0; k < knowns.count; k++) {
        const Variable *variable = instance_variable(instance, knowns.reference[k]);
        if (!variable) return false;
        if (variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_INPUT || variable->kind == VARIABLE_TIME)
            continue;
        instance_refuse(instance, variable, NULL, "derivatives are by states, inputs and time; this is none of them");
        return false;
    }
    return true;
}

static bool check_unknowns(Instance *instance, References unknowns)
{
    for (size_t k = 0; k < unknowns.count; k++) {
        const Variable *variable = instance_variable(instance, unknowns.reference[k]);
        if (!variable) return false;
        switch (variable->kind) {
        case VARIABLE_STATE:
        case VARIABLE_DERIVATIVE:
        case VARIABLE_OUTPUT:
        case VARIABLE_SOLVER:
        case VARIABLE_STATICS: continue;
        default:
            instance_refuse(instance, variable, NULL,
                            "derivatives are of state derivatives and outputs; this is none of them");
        }
        return false;
    }
    return true;
}

static bool check_seeds(Instance *instance, References references, const double *seed)
{
    for (size_t k = 0; k < references.count; k++) {
        const Variable *variable = &instance->resource.variable[references.reference[k]];
        for (size_t left = instance_span(instance, variable).count; left > 0; left--) {
            if (isfinite(*seed++)) continue;
            instance_refuse(instance, variable, NULL, "its seed must be a finite number");
            return false;
        }
    }
    return true;
}

/* What states and inputs, or derivatives and outputs, change by or weigh; the arrays are scratch of the instance. The health of the solver and of the search follow nothing. */
typedef struct {
    double *of_states, *of_derivatives, *spare;
    double of_inputs[INPUT_COUNT], of_outputs[OUTPUT_COUNT];
} Changes;

static Changes no_changes(const Instance *instance)
{
    const size_t states = (size_t)model_states(&instance->model);
    Changes changes = {.of_states = instance->changes,
                       .of_derivatives = instance->changes + states,
                       .spare = instance->changes + 2 * states};
    memset(instance->changes, 0, 2 * states * sizeof *instance->changes);
    return changes;
}

/* NULL for what has none. */
static double *entry_of(Changes *changes, const Variable *variable, Span span)
{
    switch (variable->kind) {
    case VARIABLE_STATE: return &changes->of_states[span.first];
    case VARIABLE_DERIVATIVE: return &changes->of_derivatives[span.first];
    case VARIABLE_INPUT: return &changes->of_inputs[variable->index];
    case VARIABLE_OUTPUT: return &changes->of_outputs[variable->index];
    default: return NULL;
    }
}

static bool has_output(const Instance *instance, References references)
{
    for (size_t k = 0; k < references.count; k++)
        if (instance->resource.variable[references.reference[k]].kind == VARIABLE_OUTPUT) return true;
    return false;
}

static void add_seeds(const Instance *instance, Changes *changes, References references, const double *seed)
{
    for (size_t k = 0; k < references.count; k++) {
        const Variable *variable = &instance->resource.variable[references.reference[k]];
        const Span span = instance_span(instance, variable);
        double *place = entry_of(changes, variable, span);
        for (size_t i = 0; place && i < span.count; i++) place[i] += seed[i];
        seed += span.count;
    }
}

static Status take_results(Instance *instance, Changes *changes, References references, double *result)
{
    for (size_t k = 0; k < references.count; k++) {
        const Variable *variable = &instance->resource.variable[references.reference[k]];
        const Span span = instance_span(instance, variable);
        const double *place = entry_of(changes, variable, span);
        for (size_t i = 0; i < span.count; i++) {
            if (place && !isfinite(place[i]))
                return instance_refuse(instance, variable, NULL, "its derivative is beyond the range of numbers");
            *result++ = place ? place[i] : 0.0;
        }
    }
    return STATUS_OK;
}

/* From the changes of states and inputs to those of derivatives and, where asked for, outputs. */
static bool carry_forward(Instance *instance, Changes *changes, bool with_outputs)
{
    const size_t half = (size_t)model_coordinates(&instance->model);
    if (starts_at_equilibrium(instance)) {
        if (!take_equilibrium(instance)) return false;
        equilibrium_change(&instance->model, &instance->linear, changes->of_inputs, changes->of_derivatives,
                           changes->of_states);
        memset(changes->of_states + half, 0, half * sizeof *changes->of_states);
    }
    if (!refresh_linear(instance)) return false;
    directional_derivatives(&instance->model, instance->x, &instance->linear, changes->of_states, changes->of_inputs,
                            changes->of_derivatives, with_outputs ? changes->of_outputs : NULL);
    return true;
}

/* From the weights of states, derivatives and outputs to those of states and inputs. */
static bool carry_back(Instance *instance, Changes *changes, bool with_outputs)
{
    const size_t states = (size_t)model_states(&instance->model);
    if (!refresh_linear(instance)) return false;
    memcpy(changes->spare, changes->of_states, states * sizeof *changes->spare);
    adjoint_derivatives(&instance->model, instance->x, &instance->linear, changes->of_derivatives,
                        with_outputs ? changes->of_outputs : NULL, changes->of_states, changes->of_inputs);
    for (size_t k = 0; k < states; k++) changes->of_states[k] += changes->spare[k];
    if (!starts_at_equilibrium(instance)) return true;
    if (!take_equilibrium(instance)) return false;
    equilibrium_adjoint(&instance->model, &instance->linear, changes->of_states, changes->spare, changes->of_inputs);
    memset(changes->of_states, 0, states * sizeof *changes->of_states);
    return true;
}

Status instance_directional(Instance *instance, References unknowns, References knowns, const double *seed,
                            double *sensitivity)
{
    if (!check_unknowns(instance, unknowns) || !check_knowns(instance, knowns) || !check_seeds(instance, knowns, seed))
        return STATUS_ERROR;
    Changes changes = no_changes(instance);
    add_seeds(instance, &changes, knowns, seed);
    if (!carry_forward(instance, &changes, has_output(instance, unknowns))) return STATUS_ERROR;
    return take_results(instance, &changes, unknowns, sensitivity);
}

Status instance_adjoint(Instance *instance, References unknowns, References knowns, const double *seed,
                        double *sensitivity)
{
    if (!check_unknowns(instance, unknowns) || !check_knowns(instance, knowns) ||
        !check_seeds(instance, unknowns, seed))
        return STATUS_ERROR;
    Changes changes = no_changes(instance);
    add_seeds(instance, &changes, unknowns, seed);
    if (!carry_back(instance, &changes, has_output(instance, unknowns))) return STATUS_ERROR;
    return take_results(instance, &changes, knowns, sensitivity);
}

Status instance_output_derivatives(Instance *instance, References outputs, const int32_t *orders, double *values)
{
    if (!check_unknowns(instance, outputs)) return STATUS_ERROR;
    for (size_t k = 0; k < outputs.count; k++) {
        const Variable *variable = &instance->resource.variable[outputs.reference[k]];
        if (variable->kind == VARIABLE_DERIVATIVE)
            return instance_refuse(instance, variable, NULL, "it is not an output");
        if (orders[k] != 1)
            return instance_refuse(instance, variable, NULL, "its derivative of order 1 is known, no other");
    }
    if (!refresh_derivatives(instance)) return STATUS_ERROR;
    Changes changes = no_changes(instance);
    memcpy(changes.of_states, instance->derivative, (size_t)model_states(&instance->model) * sizeof(double));
    memcpy(changes.of_inputs, instance->u_derivative[0], sizeof changes.of_inputs);
    if (!carry_forward(instance, &changes, true)) return STATUS_ERROR;
    return take_results(instance, &changes, outputs, values);
}
