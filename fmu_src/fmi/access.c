#include <math.h>
#include <string.h>

#include "derivatives.h"
#include "instance.h"

enum { FIRST_CHOICE = 1 }; /* hosts count the items of an enumeration from 1 */

/* How a variable is read and set, for whoever takes it for one of another type. */
static const char IS_CHOICE[] = "it is an enumeration, read and set as an integer (fmi2GetInteger and "
                                "fmi2SetInteger, fmi3GetInt64 and fmi3SetInt64)";
static const char IS_LINKS[] = "it is a whole number, read and set as such (fmi3GetUInt64 and fmi3SetUInt64)";
static const char IS_REAL[] =
    "it is a real number, read and set as such (fmi2GetReal and fmi2SetReal, fmi3GetFloat64 and fmi3SetFloat64)";
static const char TOO_LATE[] = "parameters and start values are fixed once initialization has ended";

const Variable *instance_variable(Instance *instance, uint32_t reference)
{
    if (reference < instance->resource.variables) return &instance->resource.variable[reference];
    Text text;
    text_start(&text);
    text_add(&text, "value reference ");
    text_integer(&text, reference);
    text_add(&text, " does not exist; they end with ");
    text_integer(&text, instance->resource.variables - 1u);
    instance_fail(instance, &text);
    return NULL;
}

static const char *type_of(const Variable *variable)
{
    switch (variable->kind) {
    case VARIABLE_SOLVER_CHOICE: return IS_CHOICE;
    case VARIABLE_LINKS: return IS_LINKS;
    default: return IS_REAL;
    }
}

Span instance_span(const Instance *instance, const Variable *variable)
{
    const size_t index = variable->index;
    if (!instance->link || (variable->kind != VARIABLE_STATE && variable->kind != VARIABLE_DERIVATIVE))
        return (Span){index, 1};
    const size_t n = (size_t)instance->model.n;
    const size_t half = (size_t)model_coordinates(&instance->model);
    const Span span[ARRAY_COUNT] = {{0, 1}, {1, n}, {half, 1}, {half + 1, n}, {n + 1, 1}, {half + n + 1, 1}};
    return span[index];
}

double *instance_start(Instance *instance)
{
    return instance->guess ? instance->guess : instance->x;
}

/* Pulls and forces follow accelerations. */
static bool is_force(uint32_t output)
{
    return (output >= Y_tension_top && output <= Y_tension_max) || (output >= Y_F_1x && output <= Y_F_2y);
}

Status instance_refuse(Instance *instance, const Variable *variable, const Text *value, const char *expected)
{
    Text text;
    text_start(&text);
    text_variable(&text, instance, variable);
    if (value) {
        text_add(&text, " = ");
        text_add(&text, value->line);
    }
    text_at_time(&text, instance->time);
    text_add(&text, ": ");
    text_add(&text, expected);
    return instance_fail(instance, &text);
}

static Status refuse_value(Instance *instance, const Variable *variable, double value, const char *expected)
{
    Text number;
    text_start(&number);
    text_number(&number, value);
    return instance_refuse(instance, variable, &number, expected);
}

/* Counters as the solver left them; the energy of the present state is no business of its own. */
static bool get_health(Instance *instance, uint32_t index, double *value)
{
    *value = instance->solver.counter[index];
    if (index != SOLVER_energy_residual || !instance->solver.energy.has_start) return true;
    if (!refresh_outputs(instance, false)) return false;
    *value = solver_energy_residual(&instance->solver, instance->output[Y_energy]);
    return true;
}

/* value[1], or of an array as many as it has. */
static bool get_one(Instance *instance, const Variable *variable, Span span, double *value)
{
    switch (variable->kind) {
    case VARIABLE_TIME: *value = instance->time; return true;
    case VARIABLE_PARAMETER: *value = instance->model.parameter[variable->index]; return true;
    case VARIABLE_INPUT: *value = instance->u[variable->index]; return true;
    case VARIABLE_STATE:
        if (!refresh_start(instance)) return false;
        memcpy(value, instance->x + span.first, span.count * sizeof *value);
        return true;
    case VARIABLE_PRELOAD:
        if (!refresh_start(instance)) return false;
        *value = instance->model.parameter[variable->index];
        return true;
    case VARIABLE_STATICS:
        if (!refresh_start(instance)) return false;
        *value = instance->statics[variable->index];
        return true;
    case VARIABLE_SOLVER_CHOICE:
    case VARIABLE_LINKS: return instance_refuse(instance, variable, NULL, type_of(variable)) == STATUS_OK;
    case VARIABLE_WHOLE: *value = instance->whole[variable->index]; return true;
    case VARIABLE_SOLVER: return get_health(instance, variable->index, value);
    case VARIABLE_DERIVATIVE:
        if (!refresh_derivatives(instance)) return false;
        memcpy(value, instance->derivative + span.first, span.count * sizeof *value);
        return true;
    default:
        if (variable->index >= Y_m_1xx) return instance_effective_mass(instance, variable->index, value);
        if (!refresh_outputs(instance, is_force(variable->index))) return false;
        *value = instance->output[variable->index];
        return true;
    }
}

Status instance_get(Instance *instance, const uint32_t *references, size_t count, double *values)
{
    for (size_t k = 0; k < count; k++) {
        const Variable *variable = instance_variable(instance, references[k]);
        if (!variable) return STATUS_ERROR;
        const Span span = instance_span(instance, variable);
        if (!get_one(instance, variable, span, values)) return STATUS_ERROR;
        for (size_t i = 0; i < span.count; i++)
            if (!isfinite(values[i]))
                return refuse_value(instance, variable, values[i], "forces or rates are beyond the range of numbers");
        values += span.count;
    }
    return STATUS_OK;
}

Status instance_count(Instance *instance, const uint32_t *references, size_t count, size_t *values)
{
    *values = count;
    if (!instance->link) return STATUS_OK;
    for (size_t k = 0; k < count; k++) {
        const Variable *variable = instance_variable(instance, references[k]);
        if (!variable) return STATUS_ERROR;
        *values += instance_span(instance, variable).count - 1;
    }
    return STATUS_OK;
}

/* Of a cable that is divided anew, the states of links follow from its shape until the run begins. */
static bool is_settable(const Instance *instance, const Variable *variable)
{
    switch (variable->kind) {
    case VARIABLE_PARAMETER:
    case VARIABLE_INPUT:
    case VARIABLE_WHOLE: return true;
    case VARIABLE_STATE:
        return !instance->link || (variable->index != ARRAY_ANGLES && variable->index != ARRAY_RATES) ||
               !(instance->mode & MODE_SETUP);
    default: return false;
    }
}

/* Whether the variable may be set now, and to this value. */
static Status check(Instance *instance, const Variable *variable, double value)
{
    if (type_of(variable) != IS_REAL) return refuse_value(instance, variable, value, type_of(variable));
    if (!is_settable(instance, variable))
        return refuse_value(instance, variable, value, "it is calculated and cannot be set");
    if (!isfinite(value)) return refuse_value(instance, variable, value, "a finite number is expected");
    if (variable->kind == VARIABLE_INPUT) return STATUS_OK;
    /* Casadi's importer, for one, moves states of Model Exchange as variables. */
    const bool is_state = variable->kind == VARIABLE_STATE;
    const unsigned modes = is_state ? MODE_SETUP | MODE_EVENT | MODE_CONTINUOUS : MODE_SETUP;
    if (!(instance->mode & modes)) return refuse_value(instance, variable, value, TOO_LATE);
    if (is_state) return STATUS_OK;
    const char *least = least_of(variable);
    if (strcmp(least, "+0") == 0 && !(value > 0.0))
        return refuse_value(instance, variable, value, "a number above 0 is expected");
    if (strcmp(least, "0") == 0 && value < 0.0)
        return refuse_value(instance, variable, value, "a number of 0 or more is expected");
    return STATUS_OK;
}

static double *place_of(Instance *instance, VariableKind kind)
{
    switch (kind) {
    case VARIABLE_PARAMETER: return instance->model.parameter;
    case VARIABLE_WHOLE: return instance->whole;
    case VARIABLE_INPUT: return instance->u;
    default: return instance->mode & MODE_SETUP ? instance_start(instance) : instance->x;
    }
}

static Status check_all(Instance *instance, const uint32_t *references, size_t count, const double *values)
{
    for (size_t k = 0; k < count; k++) {
        const Variable *variable = instance_variable(instance, references[k]);
        if (!variable) return STATUS_ERROR;
        const Span span = instance_span(instance, variable);
        for (size_t i = 0; i < span.count; i++)
            if (check(instance, variable, values[i]) != STATUS_OK) return STATUS_ERROR;
        values += span.count;
    }
    return STATUS_OK;
}

Status instance_set(Instance *instance, const uint32_t *references, size_t count, const double *values)
{
    if (check_all(instance, references, count, values) != STATUS_OK) {
        /* Inside a step, going on with the force of an earlier time would be a wrong result. */
        if (instance->mode & (MODE_ASKED | MODE_ACCEPTED)) instance->mode = MODE_FAILED;
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < count; k++) {
        const Variable *variable = &instance->resource.variable[references[k]];
        const Span span = instance_span(instance, variable);
        double *place = place_of(instance, (VariableKind)variable->kind);
        memcpy(place + span.first, values, span.count * sizeof *values);
        values += span.count;
        if (variable->kind == VARIABLE_PARAMETER || variable->kind == VARIABLE_WHOLE)
            invalidate_model(instance);
        else
            invalidate_state(instance);
    }
    if (instance->mode & MODE_SETUP) instance->start_is_current = false;
    return STATUS_OK;
}

/* The variable of a reference that is read and set as this kind is; NULL after a message. */
static const Variable *lookup(Instance *instance, uint32_t reference, VariableKind kind, const Text *value)
{
    const Variable *variable = instance_variable(instance, reference);
    if (!variable || variable->kind == (uint32_t)kind) return variable;
    instance_refuse(instance, variable, value, type_of(variable));
    return NULL;
}

Status instance_get_links(Instance *instance, uint32_t reference, uint64_t *value)
{
    if (!lookup(instance, reference, VARIABLE_LINKS, NULL)) return STATUS_ERROR;
    *value = (uint64_t)instance->model.n;
    return STATUS_OK;
}

Status instance_check_links(Instance *instance, uint32_t reference, uint64_t value)
{
    Text number;
    text_start(&number);
    text_integer(&number, value);
    const Variable *variable = lookup(instance, reference, VARIABLE_LINKS, &number);
    if (!variable) return STATUS_ERROR;
    if (instance->mode != MODE_CONFIGURATION)
        return instance_refuse(instance, variable, &number,
                               "it is set in configuration mode (fmi3EnterConfigurationMode)");
    if (value < 1 || value > MOST_LINKS)
        return instance_refuse(instance, variable, &number, "a number of links from 1 to 10000 is expected");
    return STATUS_OK;
}

Status instance_get_choice(Instance *instance, uint32_t reference, int64_t *value)
{
    if (!lookup(instance, reference, VARIABLE_SOLVER_CHOICE, NULL)) return STATUS_ERROR;
    *value = (int64_t)instance->solver.choice + FIRST_CHOICE;
    return STATUS_OK;
}

Status instance_check_choice(Instance *instance, uint32_t reference, int64_t value)
{
    Text number;
    text_start(&number);
    if (value < 0) text_add(&number, "-");
    text_integer(&number, value < 0 ? 0u - (uint64_t)value : (uint64_t)value);
    const Variable *variable = lookup(instance, reference, VARIABLE_SOLVER_CHOICE, &number);
    if (!variable) return STATUS_ERROR;
    if (!(instance->mode & MODE_SETUP)) return instance_refuse(instance, variable, &number, TOO_LATE);
    if (value < FIRST_CHOICE || value >= FIRST_CHOICE + SOLVER_CHOICES)
        return instance_refuse(instance, variable, &number, "1 (automatic), 2 (explicit) or 3 (implicit) is expected");
    return STATUS_OK;
}

void instance_set_choice(Instance *instance, int64_t value)
{
    instance->solver.choice = (SolverChoice)(value - FIRST_CHOICE);
}

Status instance_set_input_derivative(Instance *instance, uint32_t reference, int order, double value)
{
    const Variable *variable = instance_variable(instance, reference);
    if (!variable) return STATUS_ERROR;
    if (variable->kind != VARIABLE_INPUT) return refuse_value(instance, variable, value, "it is not an input");
    if (order < 1 || order > INPUT_ORDERS)
        return refuse_value(instance, variable, value, "its derivatives of order 1 to 8 are taken");
    if (!isfinite(value)) return refuse_value(instance, variable, value, "its derivative must be a finite number");
    instance->u_derivative[order - 1][variable->index] = value;
    instance->u_given |= 1u << variable->index;
    if (order > instance->u_orders) instance->u_orders = order;
    return STATUS_OK;
}

void forget_input_derivatives(Instance *instance)
{
    memset(instance->u_derivative, 0, (size_t)instance->u_orders * sizeof *instance->u_derivative);
    instance->u_orders = 0;
    instance->u_given = 0;
}

Status instance_check_intermediate(Instance *instance, const uint32_t *references, size_t count, bool *any_input)
{
    *any_input = false;
    for (size_t k = 0; k < count; k++) {
        const Variable *variable = instance_variable(instance, references[k]);
        if (!variable) return STATUS_ERROR;
        if (variable->kind != VARIABLE_INPUT && variable->kind != VARIABLE_OUTPUT)
            return instance_refuse(instance, variable, NULL,
                                   "it is not set or read inside a step (intermediateUpdate = false)");
        *any_input |= variable->kind == VARIABLE_INPUT;
    }
    return STATUS_OK;
}

/* What hosts know of q: not the heave of a top whose motion is given, which comes first [model.h]. */
static size_t hidden(const Instance *instance)
{
    return top_is_given(&instance->model) ? 1 : 0;
}

size_t instance_states(const Instance *instance)
{
    return (size_t)model_states(&instance->model) - 2 * hidden(instance);
}

static Status wrong_size(Instance *instance, size_t count)
{
    Text text;
    text_start(&text);
    text_integer(&text, count);
    text_add(&text, " states were given or asked for; this cable has ");
    text_integer(&text, (uint64_t)instance_states(instance));
    return instance_fail(instance, &text);
}

static bool size_matches(const Instance *instance, size_t count)
{
    return count == instance_states(instance);
}

/* To the host from the kernel's states, or their derivatives. */
static void hand_out(const Instance *instance, const double *own, double *host)
{
    const size_t half = (size_t)model_coordinates(&instance->model), first = hidden(instance), count = half - first;
    for (size_t k = 0; k < 2; k++) memcpy(host + k * count, own + k * half + first, count * sizeof *host);
}

Status instance_set_time(Instance *instance, double time)
{
    if (!isfinite(time)) {
        Text text;
        text_start(&text);
        text_add(&text, "time = ");
        text_number(&text, time);
        text_add(&text, ": a finite number of seconds is expected");
        return instance_fail(instance, &text);
    }
    instance->time = time;
    return STATUS_OK;
}

Status instance_set_states(Instance *instance, const double *x, size_t count)
{
    if (!size_matches(instance, count)) return wrong_size(instance, count);
    const size_t half = (size_t)model_coordinates(&instance->model), first = hidden(instance), each = half - first;
    for (size_t k = 0; k < 2; k++) memcpy(instance->x + k * half + first, x + k * each, each * sizeof *x);
    invalidate_state(instance);
    return STATUS_OK;
}

Status instance_get_states(Instance *instance, double *x, size_t count)
{
    if (!size_matches(instance, count)) return wrong_size(instance, count);
    if (!refresh_start(instance)) return STATUS_ERROR;
    hand_out(instance, instance->x, x);
    return STATUS_OK;
}

Status instance_get_derivatives(Instance *instance, double *derivative, size_t count)
{
    if (!size_matches(instance, count)) return wrong_size(instance, count);
    if (!refresh_derivatives(instance)) return STATUS_ERROR;
    hand_out(instance, instance->derivative, derivative);
    return STATUS_OK;
}

Status instance_nominals(Instance *instance, double *nominals, size_t count)
{
    if (!size_matches(instance, count)) return wrong_size(instance, count);
    for (size_t k = 0; k < count; k++) nominals[k] = 1.0; /* m, rad, m/s, rad/s */
    return STATUS_OK;
}
