#include "model.h"

enum { MODEL_ARRAYS = 5, WORK_ARRAYS = 9 };

size_t model_doubles(int n)
{
    return (size_t)MODEL_ARRAYS * (size_t)n;
}

size_t work_doubles(int n)
{
    return (size_t)WORK_ARRAYS * (size_t)n;
}

void model_layout(Model *model, double *block)
{
    double **const array[MODEL_ARRAYS] = {&model->stiffness, &model->damping, &model->weight, &model->drag_factor,
                                          &model->rotary};
    for (int k = 0; k < MODEL_ARRAYS; k++) *array[k] = block + (size_t)k * (size_t)model->n;
}

void work_layout(Work *work, int n, double *block)
{
    double **const array[WORK_ARRAYS] = {&work->sine,   &work->cosine, &work->torque, &work->load_x, &work->load_y,
                                         &work->gain_x, &work->gain_y, &work->moment, &work->inverse};
    for (int k = 0; k < WORK_ARRAYS; k++) *array[k] = block + (size_t)k * (size_t)n;
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
        const double length = model->link[LINK_LENGTH][i], mass = model->link[LINK_MASS][i];
        model->weight[i] = (mass - p[P_rho_w] * model->link[LINK_VOLUME][i]) * p[P_g];
        model->rotary[i] = model->link[LINK_INERTIA][i] + mass * length * length / 4.0;
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
    model->end_inertia = p[P_I_Rc];
    model->rotary[model->n - 1] += model->end_inertia;
    model->has_spring = floater || model->terminal == TERMINAL_ANCHOR_SPRING;
    model->spring[0] = floater ? p[P_k_m2H] : p[P_k_cH];
    model->spring[1] = floater ? p[P_k_m2V] : p[P_k_cV];
    model->damper[0] = floater ? p[P_c_m2H] : p[P_c_cH];
    model->damper[1] = floater ? p[P_c_m2V] : p[P_c_cV];
    model->preload[0] = p[P_static_pull_2];
    model->preload[1] = -p[P_static_load_2];
}

void model_prepare(Model *model)
{
    prepare_links(model);
    prepare_terminal(model);
}
