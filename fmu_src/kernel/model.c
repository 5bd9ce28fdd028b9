#include "model.h"
#include "processor.h"

/* Every derived or scratch array gets this many doubles beyond n: nodes are one more than links, and a lane that waits
 * may look one further. */
enum { SPARE = 2 };

/* Addresses of the array pointers in a structure, in the order in which they lie in its block. */
#define MODEL_ARRAYS(m)                                                                                                \
    &(m)->stiffness, &(m)->damping, &(m)->weight, &(m)->drag_factor, &(m)->reach, &(m)->swing, &(m)->skew,             \
        &(m)->per_rotary, &(m)->per_inertia, &(m)->half_per_inertia, &(m)->lever, &(m)->rest_share
#define WORK_ARRAYS(w)                                                                                                 \
    &(w)->sine, &(w)->cosine, &(w)->turn_sine, &(w)->turn_cosine, &(w)->joint, &(w)->torque, &(w)->velocity_x,         \
        &(w)->velocity_y, &(w)->inward_x, &(w)->inward_y, &(w)->load_x, &(w)->load_y, &(w)->drive_x, &(w)->drive_y,    \
        &(w)->m_xx, &(w)->m_xy, &(w)->m_yx, &(w)->m_yy, &(w)->constant_x, &(w)->constant_y, &(w)->answer_x,            \
        &(w)->answer_y, &(w)->u_x, &(w)->u_y, &(w)->turning

static size_t array_doubles(int n)
{
    return (size_t)n + SPARE;
}

static void lay_out(double **const array[], size_t arrays, int n, double *block)
{
    for (size_t k = 0; k < arrays; k++) *array[k] = block + k * array_doubles(n);
}

size_t model_doubles(int n)
{
    Model model;
    double **const array[] = {MODEL_ARRAYS(&model)};
    return sizeof array / sizeof *array * array_doubles(n);
}

size_t work_doubles(int n)
{
    Work work;
    double **const array[] = {WORK_ARRAYS(&work)};
    return sizeof array / sizeof *array * array_doubles(n);
}

void model_layout(Model *model, double *block)
{
    double **const array[] = {MODEL_ARRAYS(model)};
    lay_out(array, sizeof array / sizeof *array, model->n, block);
}

void work_layout(Work *work, int n, double *block)
{
    double **const array[] = {WORK_ARRAYS(work)};
    lay_out(array, sizeof array / sizeof *array, n, block);
}

/* A scalar parameter overrides the array of the same meaning where the scene has it. */
static double per_link(const Model *model, Parameter parameter, LinkColumn column, int i)
{
    return model_has(model, parameter) ? model->parameter[parameter] : model->link[column][i];
}

static void prepare_links(Model *model)
{
    const double *p = model->parameter;
    model->has_stiffness = model->has_damping = model->has_drag = false;
    for (int i = 0; i < model->n; i++) {
        const double mass = model->link[LINK_MASS][i];
        model->weight[i] = (mass - p[P_rho_w] * model->link[LINK_VOLUME][i]) * p[P_g];
        model->stiffness[i] = per_link(model, P_k_joint, LINK_JOINT_STIFFNESS, i);
        model->damping[i] = per_link(model, P_c_joint, LINK_JOINT_DAMPING, i);
        if (model->drag == DRAG_COEFFICIENT) {
            const double coefficient = per_link(model, P_Cd, LINK_DRAG, i);
            model->drag_factor[i] = 0.5 * p[P_rho_w] * coefficient * model->link[LINK_DRAG_AREA][i];
        } else {
            model->drag_factor[i] = model->drag == DRAG_PER_LINK ? model->link[LINK_DRAG][i] : 0.0;
        }
        model->has_stiffness |= model->stiffness[i] != 0.0;
        model->has_damping |= model->damping[i] != 0.0;
        model->has_drag |= model->drag_factor[i] != 0.0;
    }
}

/* What passing a link takes, with the terminal's rotary inertia on the last one. */
static void prepare_inertia(Model *model)
{
    model->end_inertia = model->parameter[P_I_Rc];
    for (int i = 0; i < model->n; i++) {
        const double length = model->link[LINK_LENGTH][i], mass = model->link[LINK_MASS][i], half = length / 2.0;
        const double inertia = link_inertia(model, i);
        const double rotary = inertia + mass * half * half;
        model->reach[i] = length * length / rotary;
        model->swing[i] = mass * inertia / rotary;
        model->skew[i] = (inertia - mass * half * half) / rotary;
        model->per_rotary[i] = 1.0 / rotary;
        model->per_inertia[i] = 1.0 / inertia;
        model->half_per_inertia[i] = half / inertia;
        model->lever[i] = mass * half / inertia;
        model->rest_share[i] = 1.0 - mass * half * half / inertia;
    }
}

/* Submerged mass of the terminal: a load and a spring anchor's clump weigh, floater and anchor mass float. */
static double submerged_end_mass(const Model *model)
{
    const double *p = model->parameter;
    if (model->terminal == TERMINAL_ANCHOR_MASS || model->terminal == TERMINAL_FLOATER) return 0.0;
    if (model_has(model, P_rho_c)) return p[P_m_c] * (1.0 - p[P_rho_w] / p[P_rho_c]);
    return p[P_m_c] - p[P_rho_w] * p[P_V_c];
}

static void prepare_terminal(Model *model)
{
    const double *p = model->parameter;
    const bool floater = model->terminal == TERMINAL_FLOATER;
    model->end_mass = floater ? p[P_M_2] : p[P_m_c];
    model->end_weight = submerged_end_mass(model) * p[P_g];
    model->has_spring = floater || model->terminal == TERMINAL_ANCHOR_SPRING;
    model->spring[0] = floater ? p[P_k_m2H] : p[P_k_cH];
    model->spring[1] = floater ? p[P_k_m2V] : p[P_k_cV];
    model->damper[0] = floater ? p[P_c_m2H] : p[P_c_cH];
    model->damper[1] = floater ? p[P_c_m2V] : p[P_c_cV];
    model->preload[0] = p[P_static_pull_2];
    model->preload[1] = -p[P_static_load_2];
}

/* From both ends, but where the terminal is a pin or next to one: from 1e7 times the cable's mass on. The elimination
 * from a lighter end keeps eight digits whatever the shape [docs/numerics.md] and takes half the time. */
static void prepare_elimination(Model *model)
{
    double mass = 0.0;
    for (int i = 0; i < model->n; i++) mass += model->link[LINK_MASS][i];
    const bool is_pin = end_is_given(model);
    model->end_is_heavy = is_pin || model->end_mass > 1e2 * mass;
    model->middle = is_pin || model->end_mass > 1e7 * mass ? model->n : model->n / 2;
}

void model_prepare(Model *model)
{
    model->first_rate = model_coordinates(model) + 1;
    model->pin = (Motion){.position = {model->rest[0], model->rest[1]}};
    prepare_links(model);
    prepare_inertia(model);
    prepare_terminal(model);
    prepare_elimination(model);
    model->variant = processor_has_avx2() ? &AVX2 : &PORTABLE;
}
