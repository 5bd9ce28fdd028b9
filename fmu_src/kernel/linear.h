/*
 * The equations of motion linearised about a state, in O(n) [docs/model.md, "The linearised chain"].
 *
 * With ID(q, v, a) the forces that are missing for the acceleration a (inverse dynamics), zero in every motion,
 *     L = w_q ID_q + w_v ID_v + w_a ID_a
 * is the inertia matrix for the weights (0, 0, 1), the tangent stiffness for (1, 0, 0), and what an implicit step
 * solves with for (1, 1/g, 1/g^2). Vectors are as long as q: heave [m], link angles [rad], and the surge [m] where there is one; forces likewise [N], [N m].
 */
#ifndef CABLE_LINEAR_H
#define CABLE_LINEAR_H

#include "model.h"

typedef struct {
    double q, v, a;
} Weights;

/* dA_n + damper dV_n + spring dP_n - per_mass dR_{n+1} = given: the relation at an end that cannot move, or hardly. Of a
 * mass on a spring-damper, divided by the mass; of a pin, whose 1/m is zero, Baumgarte's [terminal.c]. */
typedef struct {
    double damper[2], spring[2], per_mass;
} HeldEnd;

/* Columns of what a part of the cable below a node answers to: change of acceleration, velocity, position in x and y. */
enum { COLUMN_A, COLUMN_V = 2, COLUMN_P = 4, MOST_COLUMNS = 6 };

/* The state that it is linearised about, the factors of L, and scratch. Arrays are per link, or per coordinate. */
typedef struct Linear {
    /* of linear_point(): */
    double *sine, *cosine, *rate, *turn; /* of every link: sin th, cos th, w [rad/s], th'' [rad/s^2] */
    double *force_x, *force_y;           /* R through every node [N] */
    double *pull;                        /* e.(R_i + R_{i+1}) [N] */
    double *drag, *drag_gain;            /* f [N]; -df/dv_n = 2 c |v_n| [N s/m] */
    double *slip;                        /* e.V at the link's centre, relative to the water [m/s] */
    Motion p_0;                          /* of the top */
    /* of linear_factor(): */
    double *a_n, *a_e, *v_n, *v_e, *p_n; /* how a link's unknown moves its lower node along n and e */
    double *lift_x, *lift_y;             /* Y: force through the upper node that comes with the unknown */
    double *per_pivot, *bend;            /* 1/p, kappa */
    double *gain[MOST_COLUMNS];          /* G / p */
    double *unit_x, *unit_y;             /* held ends: answer to a unit force through P_n */
    /* scratch: */
    double *ahead;                              /* rho / p, or what a given motion takes */
    double *column;                             /* of forces, by one input [equilibrium_change.c] */
    double *known_ax, *known_ay;                /* known change of the acceleration of the link's centre [m/s^2] */
    double *known_vx, *known_vy;                /* and of its velocity [m/s] */
    double *react_x, *react_y;                  /* change of R that goes with them [N] */
    double *swing[2], *swing_x[2], *swing_y[2]; /* w, R of an end that accelerates along x, y [effective_mass.c] */
    double top[4]; /* xx, xy, yx, yy: how the top moves with a force on it; zeros where it cannot */
    int swinging;  /* that end, as the first input of its acceleration; -1: none */
    bool is_held;  /* at its lower end, as a pin or nearly [model.c] */
    HeldEnd held;
    double border[4];  /* xx, xy, yx, yy: force at a held end by what its relation is off by */
    double through[2]; /* what linear_solve() found to go through a held end */
    int columns;       /* that matter in this scene, for these weights */
    Weights weights;
} Linear;

size_t linear_doubles(int n);
void linear_layout(Linear *linear, int n, double *block);

/* Take the state x; `work` and `derivative` as cable_derivatives() left them for it. */
void linear_point(const Model *model, const double *x, const Work *work, const double *derivative, Linear *linear);

/* Take a state of rest instead: the angles whose sines are in `work`, and the forces R through the nodes. */
void linear_rest(const Model *model, const Work *work, const double *force_x, const double *force_y, Linear *linear);

/* The end is a pin from here on, whatever holds it. */
void linear_pin(Linear *linear);

/* How P_0 moves, z as its columns, with changes of the coordinates, or of a given motion; each may be NULL. */
void linear_top(const Model *model, const double *dq, const double *dv, const double *da, const double *du,
                double z[MOST_COLUMNS]);

/*
 * The factors of L at that state, or -1 where a pivot vanishes and there are none. Returns how many pivots are negative,
 * at a held end less the two that it brings: as many as L has negative eigenvalues where it is symmetric, that is for
 * (0, 0, 1), and for (1, 0, 0) in a state of rest; elsewhere odd or even as the sign of L's determinant tells.
 */
int linear_factor(const Model *model, Weights weights, Linear *linear);

/*
 * force = ID_q dq + ID_v dv + ID_a da; each may be NULL, for zeros. What the change means for the relation at a held end
 * goes to end[2], zeros for other ends.
 */
void linear_apply(const Model *model, Linear *linear, const double *dq, const double *dv, const double *da,
                  double *force, double end[2]);

/* L change = force, the relation at a held end being off by end[2]; both as linear_apply() makes them. */
void linear_solve(const Model *model, Linear *linear, const double *force, const double end[2], double *change);

/* The change of R through every node, linear->react_x and _y, that goes with a change of the motion and of the inputs;
 * at a held end, R_{n+1} as the last linear_solve() left it. */
void linear_reactions(const Model *model, Linear *linear, const double *dq, const double *dv, const double *da,
                      const double *du);

/* Adds to force and end what a change of the inputs du[INPUT_COUNT] brings [N]. A given motion loads all links. */
void linear_inputs(const Model *model, Linear *linear, const double *du, double *force, double end[2]);

#endif
