#include "structure.h"

#include <math.h>
#include <string.h>

#include "../kernel/catenary.h"

static const double PI = 3.14159265358979323846;

/* Of so much of the cable [m^3]. */
static double volume_of(const Instance *instance, double length)
{
    const double diameter = instance->whole[WHOLE_D];
    return PI / 4.0 * (diameter * diameter) * length;
}

/* Operation by operation what assembly.py does with every link. */
void structure_divide(Instance *instance)
{
    const double *whole = instance->whole;
    const size_t n = (size_t)instance->model.n;
    const double length = whole[WHOLE_L] / (double)n;
    const double volume = volume_of(instance, length);
    const double mass = whole[WHOLE_rho_cable] * volume;
    /* Damping and drag coefficient are parameters of the model and override their columns. */
    const double of_link[LINK_COLUMNS] = {[LINK_LENGTH] = length,
                                          [LINK_MASS] = mass,
                                          [LINK_INERTIA] = mass * (length * length) / 12.0,
                                          [LINK_VOLUME] = volume,
                                          [LINK_JOINT_STIFFNESS] = whole[WHOLE_EI] / length,
                                          [LINK_DRAG_AREA] = whole[WHOLE_D] * length};
    for (size_t column = 0; column < LINK_COLUMNS; column++)
        for (size_t i = 0; i < n; i++) instance->link[column * n + i] = of_link[column];
}

/* The lower port as seen from the upper one, where the inputs have them if their motion is given [m]. */
static void lower_port(const Instance *instance, double place[2])
{
    const Model *model = &instance->model;
    const double *lower = model->terminal == TERMINAL_MOTION ? instance->u + U_x_2 : model->rest;
    for (int k = 0; k < 2; k++) place[k] = lower[k] - (top_is_given(model) ? instance->u[U_x_1 + k] : 0.0);
}

static bool refuse_rest(Instance *instance, const double place[2], CatenaryStatus status)
{
    Text text;
    text_start(&text);
    text_add(&text, "n = ");
    text_integer(&text, (uint64_t)instance->model.n);
    text_add(&text, ": no rest shape joins the ports; ");
    if (status == CATENARY_WEIGHTLESS) {
        text_add(&text, "the cable has no weight (in water: it is as dense as the water)");
    } else {
        text_add(&text, "they are ");
        text_number(&text, sqrt(place[0] * place[0] + place[1] * place[1]));
        text_add(&text, " m apart, and the cable is ");
        text_number(&text, instance->whole[WHOLE_L]);
        text_add(&text, status == CATENARY_TOO_SHORT ? " m long; it must be longer"
                                                     : " m long: nearly the same, or too long for so few links");
    }
    instance_fail(instance, &text);
    return false;
}

/* Weight-carrying mass of what hangs on a terminal spring [kg], less its buoyancy; floaters carry themselves. */
static double submerged_clump(const Model *model)
{
    const double *p = model->parameter;
    if (model->terminal != TERMINAL_ANCHOR_SPRING) return 0.0;
    const double volume = model_has(model, P_rho_c) ? p[P_m_c] / p[P_rho_c] : p[P_V_c];
    return p[P_m_c] - p[P_rho_w] * volume;
}

/* What carries the rest shape with this pull at its top joint. */
static void preload(Instance *instance, const double pull[2])
{
    Model *model = &instance->model;
    double *p = model->parameter;
    const double volume = volume_of(instance, instance->whole[WHOLE_L]);
    const double weight = (instance->whole[WHOLE_rho_cable] * volume - p[P_rho_w] * volume) * p[P_g];
    if (model->top != TOP_MOTION && !model_has(model, P_static_load)) p[P_static_load] = pull[1];
    if (model->top == TOP_FREE && !model_has(model, P_static_pull)) p[P_static_pull] = pull[0];
    if (!model->has_spring) return;
    p[P_static_load_2] = submerged_clump(model) * p[P_g] - (pull[1] - weight);
    p[P_static_pull_2] = pull[0];
}

bool structure_start(Instance *instance, double *states)
{
    const Model *model = &instance->model;
    const size_t n = (size_t)model->n;
    const bool is_straight = instance->resource.shape == SHAPE_STRAIGHT;
    memset(states + model_coordinates(model) + 1, 0, n * sizeof *states);
    for (size_t i = 1; is_straight && i <= n; i++) states[i] = instance->whole[WHOLE_theta_start];
    if (model->terminal == TERMINAL_LOAD) return true;

    refresh_model(instance);
    double place[2], pull[2];
    lower_port(instance, place);
    const CatenaryStatus status = catenary(model->n, model->link[LINK_LENGTH], model->weight, place,
                                           is_straight ? instance->work.turning : states + 1, pull);
    if (status != CATENARY_OK) return refuse_rest(instance, place, status);
    preload(instance, pull);
    invalidate_model(instance);
    return true;
}

static Status no_memory(Instance *instance, uint64_t n)
{
    Text text;
    text_start(&text);
    text_add(&text, "n = ");
    text_integer(&text, n);
    text_add(&text, ": there is no memory for so many links; the cable keeps its ");
    text_integer(&text, (uint64_t)instance->model.n);
    return instance_fail(instance, &text);
}

/* The states of the top, heave and surge with their rates, from x or back to it. */
static void top_states(const Model *model, double *x, double kept[4], bool back)
{
    const int half = model_coordinates(model), surge = model->n + 1;
    double *const place[] = {x, x + half, x + surge, x + half + surge};
    for (int k = 0; k < (model->top == TOP_FREE ? 4 : 2); k++)
        *(back ? place[k] : &kept[k]) = back ? kept[k] : *place[k];
}

Status structure_set_links(Instance *instance, uint64_t n)
{
    const Model *model = &instance->model;
    if (n == (uint64_t)model->n) return STATUS_OK;
    double kept[4];
    top_states(model, instance_start(instance), kept, false);
    if (!instance_size(instance, (int)n)) return no_memory(instance, n);
    top_states(model, instance_start(instance), kept, true);
    instance->start_is_current = false;
    invalidate_model(instance);
    return STATUS_OK;
}
