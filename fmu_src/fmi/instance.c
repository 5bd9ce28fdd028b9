#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "state.h"
#include "structure.h"

static const double DEFAULT_TOLERANCE = 1e-6, LEAST_TOLERANCE = 1e-13, MOST_TOLERANCE = 1e-1;

Status instance_fail(Instance *instance, const Text *message)
{
    instance->host.log(instance->host.owner, STATUS_ERROR, message->line);
    return STATUS_ERROR;
}

static const char *const CATEGORY[] = {
    [STATUS_WARNING] = "logStatusWarning", [STATUS_ERROR] = "logStatusError", [STATUS_DISCARD] = "logStatusDiscard"};

const char *log_category(Status status)
{
    return CATEGORY[status];
}

static bool is_category(const char *name)
{
    for (int status = STATUS_WARNING; status <= STATUS_DISCARD; status++)
        if (strcmp(name, CATEGORY[status]) == 0) return true;
    return false;
}

Status instance_check_categories(Instance *instance, const char *const *categories, size_t count)
{
    Text text;
    text_start(&text);
    for (size_t k = 0; k < count; k++) {
        if (!categories || !categories[k]) {
            text_add(&text, "the name of a log category is a null pointer");
            return instance_fail(instance, &text);
        }
        if (is_category(categories[k])) continue;
        text_add(&text, "there is no log category ");
        text_add(&text, categories[k]);
        instance->host.log(instance->host.owner, STATUS_WARNING, text.line);
        return STATUS_WARNING;
    }
    return STATUS_OK;
}

static bool offers_energy_residual(const Resource *resource)
{
    for (uint32_t k = 0; k < resource->variables; k++) {
        const Variable *variable = &resource->variable[k];
        if (variable->kind == VARIABLE_SOLVER && variable->index == SOLVER_energy_residual) return true;
    }
    return false;
}

/* Which given motions come without an acceleration, as the variables have it. */
static void find_derived(Instance *instance)
{
    static const Input first[] = {U_x_1, U_x_2}, last[] = {U_ay_1, U_ay_2};
    const Resource *resource = &instance->resource;
    for (int end = 0; end < 2; end++) {
        bool moves = false, accelerates = false;
        for (uint32_t k = 0; k < resource->variables; k++) {
            const Variable *variable = &resource->variable[k];
            if (variable->kind != VARIABLE_INPUT) continue;
            moves |= variable->index == (uint32_t)first[end];
            accelerates |= variable->index == (uint32_t)last[end];
        }
        instance->derives[end] = moves && !accelerates;
    }
}

/* Nothing of an earlier run is left in the solver's memory. */
static void start_solver(Instance *instance, SolverChoice choice, double tolerance)
{
    instance->solver = (SolverMemory){.choice = choice, .tolerance = tolerance};
    instance->solver.energy.is_kept =
        instance->interface == CO_SIMULATION && offers_energy_residual(&instance->resource);
    solver_restart(&instance->solver);
}

/* State, inputs, parameters and solver as after instantiation; the arrays stay where they are. */
static void start_over(Instance *instance)
{
    const Resource *resource = &instance->resource;
    Model *model = &instance->model;
    const size_t half = (size_t)model_coordinates(model);
    memcpy(model->parameter, resource->parameter, sizeof model->parameter);
    if (resource->whole) {
        memcpy(instance->whole, resource->whole, sizeof instance->whole);
        memset(instance->x, 0, 2 * half * sizeof *instance->x);
    } else {
        memcpy(instance->x, resource->position, half * sizeof *instance->x);
        memcpy(instance->x + half, resource->velocity, half * sizeof *instance->x);
    }
    if (instance->guess) memcpy(instance->guess, instance->x, 2 * half * sizeof *instance->x);
    memcpy(instance->u, resource->input_start, sizeof instance->u);
    forget_input_derivatives(instance);
    memset(instance->has_before, 0, sizeof instance->has_before);
    memset(instance->statics, 0, sizeof instance->statics);
    start_solver(instance, (SolverChoice)resource->solver, DEFAULT_TOLERANCE);
    instance->time = instance->step_start = 0.0;
    instance->stop_time = INFINITY;
    instance->mode = MODE_INSTANTIATED;
    instance->start_is_current = instance->linear_is_lent = false;
    invalidate_model(instance);
}

static size_t doubles_of(const Resource *resource, int n)
{
    const size_t states = 2u * (size_t)most_coordinates(n);
    const size_t for_start = resource->initial == INITIAL_EQUILIBRIUM ? states + statics_doubles(n) : 0;
    const size_t for_changes = 3 * states;
    const size_t for_links = resource->whole ? LINK_COLUMNS * (size_t)n : 0;
    return 2 * states + for_changes + model_doubles(n) + work_doubles(n) + linear_doubles(n) + solver_doubles(n) +
           for_start + for_links;
}

/* The constants that the resource file gives, and where every array lives in the one block. */
static void lay_out_instance(Instance *instance, int n)
{
    const Resource *resource = &instance->resource;
    Model *model = &instance->model;
    model->n = n;
    model->top = (Top)resource->top;
    model->terminal = (Terminal)resource->terminal;
    model->drag = (Drag)resource->drag;
    model->present = resource->present;
    memcpy(model->rest, resource->rest, sizeof model->rest);

    double *next = instance->block;
    if (resource->whole) instance->link = next, next += LINK_COLUMNS * (size_t)n;
    const double *link = resource->whole ? instance->link : resource->link;
    for (size_t column = 0; column < LINK_COLUMNS; column++) model->link[column] = link + column * (size_t)n;
    const size_t states = (size_t)model_states(model);
    instance->x = next, next += states;
    instance->derivative = next, next += states;
    instance->changes = next, next += 3 * states;
    model_layout(model, next), next += model_doubles(n);
    work_layout(&instance->work, n, next), next += work_doubles(n);
    linear_layout(&instance->linear, n, next), next += linear_doubles(n);
    instance->solver_block = next, next += solver_doubles(n);
    if (resource->initial != INITIAL_EQUILIBRIUM) return;
    instance->guess = next, next += states;
    instance->statics_block = next;
}

bool instance_size(Instance *instance, int n)
{
    double *block = calloc(doubles_of(&instance->resource, n), sizeof *block);
    if (!block) return false;
    free(instance->block);
    instance->block = block;
    lay_out_instance(instance, n);
    return true;
}

static Instance *abandon(Instance *instance, const Text *why)
{
    instance_fail(instance, why);
    instance_free(instance);
    return NULL;
}

Instance *instance_new(Interface interface, const char *token, const char *resource_directory, Host host)
{
    Text why;
    text_start(&why);
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance) {
        host.log(host.owner, STATUS_ERROR, "out of memory");
        return NULL;
    }
    instance->host = host;
    instance->interface = interface;
    if (!resource_read(&instance->resource, resource_directory, &why)) return abandon(instance, &why);

    resource_token(&instance->resource, instance->token);
    if (!token || strcmp(token, instance->token) != 0) {
        text_add(&why, "the guid or instantiation token ");
        text_add(&why, token ? token : "(none)");
        text_add(&why, " does not belong to " RESOURCE_NAME ", whose token is ");
        text_add(&why, instance->token);
        return abandon(instance, &why);
    }
    if (instance->resource.whole && !host.takes_arrays) {
        text_add(&why, RESOURCE_NAME " is that of a cable with arrays, which FMI 2 does not have");
        return abandon(instance, &why);
    }
    find_derived(instance);
    if (interface == MODEL_EXCHANGE && (instance->derives[0] || instance->derives[1])) {
        text_add(&why, "Model Exchange needs the accelerations of given motions, which this cable does without");
        return abandon(instance, &why);
    }
    if (!instance_size(instance, (int)instance->resource.n)) {
        text_add(&why, "out of memory");
        return abandon(instance, &why);
    }
    start_over(instance);
    return instance;
}

void instance_free(Instance *instance)
{
    if (!instance) return;
    states_free(instance);
    resource_free(&instance->resource);
    free(instance->block);
    free(instance);
}

Status instance_reset(Instance *instance)
{
    if (structure_set_links(instance, instance->resource.n) != STATUS_OK) return STATUS_ERROR;
    start_over(instance);
    return STATUS_OK;
}

static Status refuse_setup(Instance *instance, const char *what, double value, const char *expected)
{
    Text text;
    text_start(&text);
    text_add(&text, what);
    text_number(&text, value);
    text_add(&text, expected);
    return instance_fail(instance, &text);
}

Status instance_setup(Instance *instance, double start_time, const double *tolerance, const double *stop_time)
{
    if (!isfinite(start_time))
        return refuse_setup(instance, "start time ", start_time, ": a finite number of seconds is expected");
    if (tolerance && !(*tolerance > 0.0 && isfinite(*tolerance)))
        return refuse_setup(instance, "tolerance ", *tolerance, ": a number above 0 is expected");
    if (stop_time && !(*stop_time >= start_time))
        return refuse_setup(instance, "stop time ", *stop_time, ": a time not before the start time is expected");
    instance->time = instance->step_start = start_time;
    instance->stop_time = stop_time ? *stop_time : INFINITY;
    if (tolerance) instance->solver.tolerance = fmin(fmax(*tolerance, LEAST_TOLERANCE), MOST_TOLERANCE);
    return STATUS_OK;
}

Status instance_exit_initialization(Instance *instance)
{
    if (!refresh_derivatives(instance)) return STATUS_ERROR;
    start_solver(instance, instance->solver.choice, instance->solver.tolerance);
    instance->mode = instance->interface == CO_SIMULATION ? MODE_STEP : MODE_EVENT;
    return STATUS_OK;
}
