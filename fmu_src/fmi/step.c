#include <math.h>
#include <string.h>

#include "instance.h"

/* The inputs inside a step: from the host if it wants to be asked, else the polynomial that it gave. */
static bool inputs_at(void *source, double time, double *u)
{
    Instance *instance = source;
    if (instance->host.intermediate) {
        const Mode mode = instance->mode;
        instance->mode = MODE_ASKED;
        const bool given = instance->host.intermediate(instance->host.owner, time) && instance->mode != MODE_FAILED;
        instance->mode = mode;
        memcpy(u, instance->u, sizeof instance->u);
        return given;
    }
    if (instance->u_orders == 0) {
        memcpy(u, instance->u, sizeof instance->u);
        return true;
    }
    const double ahead = time - instance->step_start;
    for (int k = 0; k < INPUT_COUNT; k++) {
        /* u + u' s + u'' s^2/2 + ... by Horner: ((... + u3) s/3 + u2) s/2 + ... */
        double sum = 0.0;
        for (int order = instance->u_orders; order >= 1; order--)
            sum = (sum + instance->u_derivative[order - 1][k]) * ahead / order;
        u[k] = instance->u[k] + sum;
        if (!isfinite(u[k])) return false;
    }
    return true;
}

/*
 * Of a given motion x, v, a are one: for what the host says nothing of, the slope of x is v, and that of v is a, up to
 * whatever derivatives of a it gives. So with a alone, held for a step, v is linear and x quadratic.
 */
static void join_motion(Instance *instance, Input first)
{
    enum { AXES = 2 };
    double (*slope)[INPUT_COUNT] = instance->u_derivative;
    for (int axis = 0; axis < AXES; axis++) {
        for (int level = 1; level >= 0; level--) { /* v follows a, then x follows v */
            const int of = (int)first + AXES * level + axis, from = of + AXES;
            if (instance->u_given >> of & 1u) continue;
            slope[0][of] = instance->u[from];
            for (int order = 1; order < INPUT_ORDERS; order++) slope[order][of] = slope[order - 1][from];
        }
    }
}

/*
 * Of a host that knows no acceleration: the slope of its velocity if it gives that, else what the velocity did since the last
 * step; at the first step zero.
 */
static void derive_acceleration(Instance *instance, int end, Input first)
{
    enum { AXES = 2 };
    double *u = instance->u;
    const double since = instance->time - instance->time_before[end];
    for (int axis = 0; axis < AXES; axis++) {
        const int v = (int)first + AXES + axis, a = v + AXES;
        const bool given = instance->u_given >> v & 1u, known = instance->has_before[end] && since > 0.0;
        const double change = u[v] - instance->velocity_before[end][axis];
        u[a] = given ? instance->u_derivative[0][v] : known ? change / since : 0.0;
        instance->velocity_before[end][axis] = u[v];
    }
    instance->time_before[end] = instance->time;
    instance->has_before[end] = true;
}

/* Before a step, whose inputs the host gives as polynomials. */
static void join_motions(Instance *instance)
{
    const Model *model = &instance->model;
    if (!motion_is_given(model)) return;
    if (instance->derives[0]) derive_acceleration(instance, 0, U_x_1);
    if (instance->derives[1]) derive_acceleration(instance, 1, U_x_2);
    if (instance->host.intermediate) return;
    if (top_is_given(model)) join_motion(instance, U_x_1);
    if (model->terminal == TERMINAL_MOTION) join_motion(instance, U_x_2);
    instance->u_orders = instance->u_orders + 2 < INPUT_ORDERS ? instance->u_orders + 2 : INPUT_ORDERS;
}

static const char *reason(SolverStatus status)
{
    switch (status) {
    case SOLVER_TOO_MANY_STEPS:
        return "the step was given up after 1,000,000 attempts; the motion is too fast to be followed at this "
               "tolerance";
    case SOLVER_STEP_TOO_SMALL:
        return "the error asks for steps below the resolution of time; the motion is too violent or the tolerance too "
               "tight";
    case SOLVER_ANGLE_TOO_LARGE: return "a link has wound up beyond 1.6e6 rad";
    case SOLVER_INPUT_FAILED: return "an input is not a finite number, or the host gave none";
    case SOLVER_STOPPED: return "the host gave no time to return at";
    default: return "";
    }
}

static Status give_up(Instance *instance, SolverStatus status)
{
    Text text;
    text_start(&text);
    text_add(&text, "doStep ended");
    text_at_time(&text, instance->time);
    text_add(&text, ": ");
    text_add(&text, reason(status));
    instance->mode = MODE_FAILED;
    return instance_fail(instance, &text);
}

/* Hosts that add up their steps drift by rounding; anything more is a mistake. */
static double drift(const Instance *instance, double step)
{
    return 1e-9 * fmax(fmax(fabs(instance->time), step), 1e-3);
}

/* "doStep at t = ...: WHAT VALUE s WHY"; written only where there is something to refuse, as it takes longer than a step. */
static Status refuse_step(Instance *instance, const char *what, double value, const Text *why)
{
    Text text;
    text_start(&text);
    text_add(&text, "doStep");
    text_at_time(&text, instance->time);
    text_add(&text, what);
    text_number(&text, value);
    text_add(&text, " s");
    text_add(&text, why->line);
    return instance_fail(instance, &text);
}

static Status check_step(Instance *instance, double communication_point, double step)
{
    static const char STEP[] = ": communication step ", POINT[] = ": communication point ";
    const double slack = drift(instance, step);
    const bool is_long = isfinite(step) && step > 0.0;
    const bool is_next = fabs(communication_point - instance->time) <= slack;
    const bool is_within = !(communication_point + step - instance->stop_time > slack);
    if (is_long && is_next && is_within) return STATUS_OK;

    Text why;
    text_start(&why);
    if (!is_long) {
        text_add(&why, "; a number above 0 is expected");
        return refuse_step(instance, STEP, step, &why);
    }
    if (!is_next) {
        text_add(&why, " is not where the last step ended");
        return refuse_step(instance, POINT, communication_point, &why);
    }
    text_add(&why, " leads past the stop time, ");
    text_number(&why, instance->stop_time);
    text_add(&why, " s");
    return refuse_step(instance, STEP, step, &why);
}

/* The linearised chain that the solver counts on, if derivatives were asked for since; nothing of it is counted. */
static void take_linear_back(Instance *instance)
{
    if (instance->linear_is_lent && instance->solver.has_point) {
        cable_derivatives(&instance->model, instance->x, instance->solver.slope_u, &instance->work,
                          instance->derivative);
        linear_point(&instance->model, instance->x, &instance->work, instance->derivative, &instance->linear);
        invalidate_state(instance);
    }
    instance->linear_is_lent = false;
}

/* At the end of an internal step, where the solver has evaluated the inputs. */
static bool at_accepted(void *source, double time, double *end)
{
    Instance *instance = source;
    memcpy(instance->u, instance->solver.slope_u, sizeof instance->u);
    invalidate_state(instance);
    const Mode mode = instance->mode;
    instance->mode = MODE_ACCEPTED;
    const bool goes_on = instance->host.accepted(instance->host.owner, time, end) && instance->mode != MODE_FAILED;
    instance->mode = mode;
    take_linear_back(instance);
    return goes_on;
}

Status instance_step(Instance *instance, double communication_point, double step)
{
    if (check_step(instance, communication_point, step) != STATUS_OK) return STATUS_ERROR;
    refresh_model(instance);
    take_linear_back(instance);
    join_motions(instance);
    const bool inputs_rest = !instance->host.intermediate && instance->u_orders == 0;
    const System system = {&instance->model,
                           &instance->work,
                           &instance->linear,
                           inputs_at,
                           instance,
                           inputs_rest,
                           instance->host.accepted ? at_accepted : NULL};
    const double end = communication_point + step;
    instance->step_start = instance->time;
    const SolverStatus status =
        solver_advance(&system, &instance->solver, instance->solver_block, &instance->time, end, instance->x);
    invalidate_state(instance);
    if (status != SOLVER_OK) return give_up(instance, status);
    /* Outputs at the end see the inputs of the end; what the host said of their slopes is used up. */
    if (!inputs_at(instance, instance->time, instance->u)) return give_up(instance, SOLVER_INPUT_FAILED);
    forget_input_derivatives(instance);
    return STATUS_OK;
}
