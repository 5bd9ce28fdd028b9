#include <math.h>
#include <string.h>

#include "instance.h"
#include "structure.h"

void text_at_time(Text *text, double time)
{
    text_add(text, " at t = ");
    text_number(text, time);
    text_add(text, " s");
}

void invalidate_state(Instance *instance)
{
    instance->derivatives_are_current = instance->outputs_are_current = instance->tensions_are_current = false;
    instance->linear_is_current = instance->masses_are_current = false;
}

void invalidate_model(Instance *instance)
{
    instance->model_is_current = false;
    invalidate_state(instance);
}

void refresh_model(Instance *instance)
{
    if (!instance->model_is_current) {
        if (instance->link) structure_divide(instance);
        model_prepare(&instance->model);
    }
    instance->model_is_current = true;
}

/* A state that the kernel cannot take: not a number, or an angle beyond the range of sine and cosine. */
static bool state_is_usable(Instance *instance)
{
    Text text;
    text_start(&text);
    for (size_t k = 0; k < (size_t)model_states(&instance->model); k++) {
        if (isfinite(instance->x[k])) continue;
        text_state(&text, instance, k);
        text_add(&text, " is ");
        text_number(&text, instance->x[k]);
        text_at_time(&text, instance->time);
        text_add(&text, ": a finite number is expected");
        instance_fail(instance, &text);
        return false;
    }
    const int link = angle_out_of_range(&instance->model, instance->x);
    if (!link) return true;
    text_state(&text, instance, (size_t)link);
    text_add(&text, " is ");
    text_number(&text, instance->x[link]);
    text_add(&text, " rad");
    text_at_time(&text, instance->time);
    text_add(&text, ": the link has wound up beyond 1.6e6 rad");
    instance_fail(instance, &text);
    return false;
}

static bool refuse_start(Instance *instance, StaticsStatus status)
{
    Text text;
    text_start(&text);
    text_add(&text, "no stable equilibrium was found near the start shape");
    text_at_time(&text, instance->time);
    text_add(&text, status == STATICS_NOT_FINITE ? ": forces or angles went beyond the range of numbers"
                                                 : ": the forces could not be balanced");
    text_add(&text, "; the largest acceleration left is ");
    text_number(&text, instance->statics[STATICS_residual]);
    text_add(&text, " m/s2 or rad/s2 after ");
    text_integer(&text, (uint64_t)instance->statics[STATICS_iterations]);
    text_add(&text, " iterations. Other inputs, parameters or start angles are expected, or a scene without "
                    "initial = \"equilibrium\"");
    instance_fail(instance, &text);
    return false;
}

/*
 * A function of what was set alone: the search begins with the states as they were set, not with an equilibrium that
 * somebody looked at before.
 */
bool refresh_start(Instance *instance)
{
    if (instance->start_is_current || !(instance->guess || instance->link)) return true;
    if (instance->link && !structure_start(instance, instance_start(instance))) return false;
    if (!instance->guess) {
        invalidate_state(instance);
        instance->start_is_current = true;
        return true;
    }
    memcpy(instance->x, instance->guess, (size_t)model_states(&instance->model) * sizeof *instance->x);
    if (instance->mode == MODE_INSTANTIATED) return true; /* before initialization the start values are read back */
    invalidate_state(instance);
    refresh_model(instance);
    if (!state_is_usable(instance)) return false;
    const StaticsStatus status = statics_solve(&instance->model, instance->u, &instance->work, &instance->linear,
                                               instance->statics_block, instance->x, instance->statics);
    instance->start_is_current = status == STATICS_OK;
    return instance->start_is_current || refuse_start(instance, status);
}

bool refresh_derivatives(Instance *instance)
{
    if (!refresh_start(instance)) return false;
    if (instance->derivatives_are_current) return true;
    refresh_model(instance);
    if (!state_is_usable(instance)) return false;
    cable_derivatives(&instance->model, instance->x, instance->u, &instance->work, instance->derivative);
    const size_t states = (size_t)model_states(&instance->model);
    for (size_t k = 0; k < states; k++) {
        if (isfinite(instance->derivative[k])) continue;
        Text text;
        text_start(&text);
        text_add(&text, "the derivative of ");
        text_state(&text, instance, k);
        text_add(&text, " is not finite");
        text_at_time(&text, instance->time);
        text_add(&text, ": forces or rates are beyond the range of numbers");
        instance_fail(instance, &text);
        return false;
    }
    instance->derivatives_are_current = true;
    return true;
}

bool refresh_outputs(Instance *instance, bool with_tensions)
{
    if (!refresh_start(instance)) return false;
    if (with_tensions ? instance->tensions_are_current : instance->outputs_are_current) return true;
    if (with_tensions && !refresh_derivatives(instance)) return false;
    refresh_model(instance);
    if (!state_is_usable(instance)) return false;
    /* Work belongs to the present state only while the derivatives do. */
    const bool has_derivatives = with_tensions && instance->derivatives_are_current;
    cable_outputs(&instance->model, instance->x, instance->u, instance->derivative, &instance->work, instance->output,
                  has_derivatives);
    instance->outputs_are_current = true;
    instance->tensions_are_current = has_derivatives;
    return true;
}
