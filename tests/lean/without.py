"""The kernel with one feature's code deleted: what a scene without it would cost if nobody had ever written it."""

from __future__ import annotations

from tests.sources import Change

__all__ = ["INTERFACES", "WITHOUT"]

_DRAG = (
    Change(
        "motion.c",
        """    if (model->has_drag)
        sum_along(model, x, work, true);
    else
        sum_along(model, x, work, false);
""",
        "    sum_along(model, x, work, false);\n",
    ),
    Change("water.c", "    if (!model->has_drag) {\n", "    {\n"),
    Change(
        "water.c",
        """    LINKS_ARE_INDEPENDENT
    for (int i = 0; i < n; i++) {
        const double across = (cosine[i] * velocity_x[i] - sine[i] * velocity_y[i]) + 0.5 * length[i] * rate[i];
        const double drag = -factor[i] * (fabs(across) * across);
        load_x[i] = drag * cosine[i];
        load_y[i] = weight[i] - drag * sine[i];
    }
""",
        "",
    ),
)
_SIDEWAYS = (
    *_DRAG,
    Change("water.c", "            load_x[i] = 0.0;\n", ""),
    Change("chain.c", "drive_x[i] = load_x[i] + mass[i]", "drive_x[i] = mass[i]"),
)
_SPRING = (
    Change("terminal.c", "if (model->has_spring || end_is_given(model)) terminal", "if (end_is_given(model)) terminal"),
    Change(
        "terminal.c",
        """    if (!model->has_spring) return;
    for (int k = 0; k < 2; k++)
        force[k] +=
            model->preload[k] - model->spring[k] * (position[k] - model->rest[k]) - model->damper[k] * velocity[k];
""",
        "",
    ),
)
_STIFFNESS = (
    Change("joints.c", "stiffness[0] * angle[0] + ", ""),
    Change(
        "joints.c",
        """    if (model->has_stiffness && model->has_damping) {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++)
            joint[i] = stiffness[i] * (angle[i] - angle[i - 1]) + damping[i] * (rate[i] - rate[i - 1]);
    } else if (model->has_stiffness) {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++) joint[i] = stiffness[i] * (angle[i] - angle[i - 1]);
    } else if""",
        "    if",
    ),
)
_DAMPING = (
    Change(
        "joints.c", "joint[0] = stiffness[0] * angle[0] + damping[0] * rate[0];", "joint[0] = stiffness[0] * angle[0];"
    ),
    Change(
        "joints.c",
        """    if (model->has_stiffness && model->has_damping) {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++)
            joint[i] = stiffness[i] * (angle[i] - angle[i - 1]) + damping[i] * (rate[i] - rate[i - 1]);
    } else if""",
        "    if",
    ),
    Change(
        "joints.c",
        """ else if (model->has_damping) {
        LINKS_ARE_INDEPENDENT
        for (int i = 1; i < n; i++) joint[i] = damping[i] * (rate[i] - rate[i - 1]);
    }""",
        "",
    ),
)
_PIN = (
    Change("terminal.c", "model->has_spring || end_is_given(model)", "model->has_spring"),
    Change("terminal.c", "    if (end_is_given(model)) work->guide = terminal_guide(model, u);\n", ""),
    Change(
        "terminal.c",
        """    if (end_is_given(model)) {
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
""",
        "",
    ),
    Change(
        "chain.c",
        """    if (model->middle == model->n)
        accelerations(model, x, u, work, true, acceleration);
    else
        accelerations""",
        "    accelerations",
    ),
    Change("chain.c", "where.bias.x - (sum_x + port[FROM_TIP].given_x)", "where.bias.x - sum_x"),
    Change("chain.c", "where.bias.y - (sum_y + port[FROM_TIP].given_y)", "where.bias.y - sum_y"),
)
_TORQUE = (
    Change("derivatives.c", "    VARIANT(joint_torques)(model, x, work);\n", ""),
    Change("chain.c", "const double push = lever[i] * torque[i];", "const double push = 0.0;"),
    Change("chain.c", "push = lever[i] * torque[i];", "push = 0.0;"),
    Change("chain.c", "const double s = torque[i] + 0.5", "const double s = 0.5"),
    Change("chain.c", "per_inertia[i] * torque[i] - half_per_inertia", "-half_per_inertia"),
)

WITHOUT = {
    "drag": _DRAG,
    "terminal spring": _SPRING,
    "joint stiffness": _STIFFNESS,
    "joint damping": _DAMPING,
    "pin": _PIN,
}
"""What each feature's code is: the branches that ask for it, and what they enclose."""

INTERFACES = {
    "horizontal loads on links": _SIDEWAYS,
    "torques on links": _TORQUE,
}
"""Not a feature's own code but the chain's: where forces reach the links. Zeros go that way where there are none."""
