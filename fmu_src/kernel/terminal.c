#include "dynamics.h"

/* P_n = P_0 + sum l_i e_i and its velocity P_0' + sum l_i w_i n_i. */
void terminal_motion(const Model *model, const double *x, const Work *work, double position[2], double velocity[2])
{
    const int n = model->n;
    const double *length = model->link[LINK_LENGTH], *rate = rates_in(model, x);
    double px = work->top.position[0], py = work->top.position[1];
    double vx = work->top.velocity[0], vy = work->top.velocity[1];
    for (int i = 0; i < n; i++) {
        const double swing = length[i] * rate[i];
        px += length[i] * work->sine[i];
        py += length[i] * work->cosine[i];
        vx += swing * work->cosine[i];
        vy -= swing * work->sine[i];
    }
    position[0] = px, position[1] = py;
    velocity[0] = vx, velocity[1] = vy;
}

/* Where an end that is given has to be, how fast, and with which acceleration; a pin stays. */
const Motion *terminal_guide(const Model *model, const double *u)
{
    return model->terminal == TERMINAL_MOTION ? (const Motion *)(const void *)(u + U_x_2) : &model->pin;
}

/*
 * Everything that acts on P_n besides the cable: submerged weight, the inputs, and where the scene has a
 * support, its spring-dampers about (x_0, y_0) with the preload that makes the rest shape an equilibrium.
 * It enters by virtual work, as what the elimination starts from; [5.8]-[5.10] project it, which loses energy.
 */
void terminal_force(const Model *model, const double *x, const double *u, Work *work)
{
    double *force = work->end_force;
    force[0] = u[U_F_cx];
    force[1] = u[U_F_cy] + u[U_u_m2] + model->end_weight;
    double *position = work->end_position, *velocity = work->end_velocity;
    if (model->has_spring || end_is_given(model)) terminal_motion(model, x, work, position, velocity);
    if (end_is_given(model)) work->guide = terminal_guide(model, u);
    if (!model->has_spring) return;
    for (int k = 0; k < 2; k++)
        force[k] +=
            model->preload[k] - model->spring[k] * (position[k] - model->rest[k]) - model->damper[k] * velocity[k];
}

/*
 * P_n answers with R = m_c b - force: the mass in every direction. A pin, or a vessel whose motion is given, takes any R;
 * the acceleration of P_n is theirs, were it not for the drift of whoever integrates it, which decays with Baumgarte's
 * a = a_guide - 2 r (V - V_guide) - r^2 (P - P_guide) (Comput. Methods Appl. Mech. Eng. 1 (1972) 1-16).
 */
void terminal_port(const Model *model, const Work *work, Port *port)
{
    if (end_is_given(model)) {
        const Motion *guide = work->guide;
        double given[2];
        for (int k = 0; k < 2; k++) {
            const double drift = work->end_position[k] - guide->position[k];
            const double speed = work->end_velocity[k] - guide->velocity[k];
            given[k] = guide->acceleration[k] - PIN_RATE * (2.0 * speed + PIN_RATE * drift);
        }
        *port = (Port){.det = 1.0, .given_x = given[0], .given_y = given[1]};
        return;
    }
    const double mass = model->end_mass;
    *port = (Port){.xx = mass,
                   .yy = mass,
                   .unit = 1.0,
                   .det = mass * mass,
                   .bias_x = -work->end_force[0],
                   .bias_y = -work->end_force[1]};
}

/* Kinetic energy of m_c, its weight, and the support's springs with their preload. */
double terminal_energy(const Model *model, const double position[2], const double velocity[2])
{
    double energy = 0.5 * model->end_mass * (velocity[0] * velocity[0] + velocity[1] * velocity[1]) -
                    model->end_weight * position[1];
    if (!model->has_spring) return energy;
    for (int k = 0; k < 2; k++) {
        const double stretch = position[k] - model->rest[k];
        energy += (0.5 * model->spring[k] * stretch - model->preload[k]) * stretch;
    }
    return energy;
}
