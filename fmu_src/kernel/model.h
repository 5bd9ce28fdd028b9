/*
 * The cable as the kernel sees it: constants in `Model`, scratch in `Work`, the state outside both.
 *
 * State vector x = (q, q'): q = (y_m1, theta_1 ... theta_n), heave of floater 1 [m, positive down] and absolute link
 * angles [rad from the downward vertical, positive towards +x]; behind them x_m1, the surge [m], where floater 1 has one.
 * Where the top follows a given motion, y_m1 is no coordinate and zero: angles stand at the same place in every cable.
 * Link i has unit vector e = (sin th, cos th) and normal n = de/dth = (cos th, -sin th).
 * Brackets such as [5.4] are equations of Pouzada's dissertation (FURG, 2015); docs/model.md restates them.
 */
#ifndef CABLE_MODEL_H
#define CABLE_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "variant.h"

#define PARAMETER(name, unit, least, description) P_##name,
typedef enum {
#include "variables.def"
    PARAMETER_COUNT
} Parameter;

#define INPUT(name, unit, description) U_##name,
typedef enum {
#include "variables.def"
    INPUT_COUNT
} Input;

#define OUTPUT(name, unit, nominal, description) Y_##name,
typedef enum {
#include "variables.def"
    OUTPUT_COUNT
} Output;

#define SOLVER(name, unit, description) SOLVER_##name,
typedef enum {
#include "variables.def"
    SOLVER_COUNT
} SolverCounter;

#define STATICS(name, unit, description) STATICS_##name,
typedef enum {
#include "variables.def"
    STATICS_COUNT
} StaticsFigure;

/* What the cable hangs from at P_0; numbers as in the resource file. */
typedef enum {
    TOP_FLOATER, /* heaves */
    TOP_FREE,    /* heaves and surges */
    TOP_MOTION,  /* moves as the inputs say: an external vessel owns the mass */
    TOP_COUNT
} Top;

/* What hangs at P_n; numbers as in the resource file. */
typedef enum {
    TERMINAL_LOAD,
    TERMINAL_ANCHOR_MASS,
    TERMINAL_ANCHOR_SPRING,
    TERMINAL_FLOATER,
    TERMINAL_PIN,
    TERMINAL_MOTION, /* moves as the inputs say */
    TERMINAL_COUNT
} Terminal;

/* How the normal drag of a link is given. */
typedef enum { DRAG_NONE, DRAG_COEFFICIENT, DRAG_PER_LINK, DRAG_COUNT } Drag;

/* Given per link in the resource file, each of shape (n,), link 1 at the top first. */
typedef enum {
    LINK_LENGTH,          /* l_i [m] */
    LINK_MASS,            /* m_i [kg] */
    LINK_INERTIA,         /* I_Ri about the link's centre [kg m^2] */
    LINK_VOLUME,          /* displaced [m^3] */
    LINK_JOINT_STIFFNESS, /* k_i of the joint at the link's top [N m/rad] */
    LINK_JOINT_DAMPING,   /* c_i likewise [N m s/rad] */
    LINK_DRAG_AREA,       /* D_i l_i [m^2] */
    LINK_DRAG,            /* Cd_i [-] or c_v,i [N s^2/m^2], by Drag */
    LINK_COLUMNS
} LinkColumn;

/* How fast a drift away from the pin decays [1/s]: slow beside the cable, fast beside what a host's errors add up to. */
#define PIN_RATE 10.0

/* Of a port that moves as it is told: along x and y [m], [m/s], [m/s^2]. */
typedef struct {
    double position[2], velocity[2], acceleration[2];
} Motion;

/* Constant during a run. The upper half comes from the resource file and the parameters, the lower half
 * is derived of it by model_prepare(). */
typedef struct Model {
    int n; /* links */
    Top top;
    Terminal terminal;
    Drag drag;
    uint64_t present; /* bit P_x is set where the scene has parameter x */
    double parameter[PARAMETER_COUNT];
    double rest[2];                   /* (x_0, y_0) of the terminal's springs or of its pin [m] */
    const double *link[LINK_COLUMNS]; /* as given */

    bool has_stiffness, has_damping, has_drag, has_spring;
    bool end_is_heavy;           /* or a pin: more than 100 times the cable's mass, an unknown by itself [linear.c] */
    int middle;                  /* links that are eliminated from the top; n: all of them [chain.c] */
    const Variant *variant;      /* what the processor can do */
    double *stiffness, *damping; /* k_i, c_i [N m/rad], [N m s/rad] */
    double *weight;              /* submerged, m_i^w g [N] */
    double *drag_factor;         /* c in f = -c |v_n| v_n [N s^2/m^2] */
    /* with I = I_Ri (and I_Rc on the last link), J0 = I + m l^2/4, h = l/2: */
    double *reach, *swing, *skew;     /* l^2/J0 [1/kg], m I/J0 [kg], (I - m l^2/4)/J0: passing a link [ends.h] */
    double *per_rotary, *per_inertia; /* 1/J0, 1/I [1/(kg m^2)] */
    double *half_per_inertia, *lever; /* h/I [1/(kg m)], m h/I [1/m] */
    double *rest_share;               /* 1 - m h^2/I */
    double end_mass, end_weight;      /* m_c (or M_2) [kg], submerged weight [N] */
    double end_inertia;               /* I_Rc [kg m^2] */
    double spring[2], damper[2];      /* of the terminal, along x and y [N/m], [N s/m] */
    double preload[2];                /* constant force of the terminal's support along x, y [N] */
    Motion pin;                       /* where it is, at rest */
    int first_rate;                   /* of the links, in x */
} Model;

/* Links that the elimination takes at a time from each end [chain.c]; an odd one may come with the first. */
enum { STRIP = 32, STRIP_ROOM = 2 * STRIP + 1 };

/* Scratch of one evaluation. Nothing in it outlives the call that filled it, except that outputs read
 * what derivatives left there for the same (x, u). Arrays are per link or per node, their formulas in chain.c. */
typedef struct Work {
    double *sine, *cosine;             /* of every link angle */
    double *turn_sine, *turn_cosine;   /* of the angle from the link above to this one */
    double *joint, *torque;            /* T_i of joints, T_{i+1} - T_i on links [N m] */
    double *velocity_x, *velocity_y;   /* of the node above the link [m/s] */
    double *inward_x, *inward_y;       /* C_i of the nodes [m/s^2] */
    double *load_x, *load_y;           /* W: submerged weight and drag on the link [N] */
    double *drive_x, *drive_y;         /* H: the same and the known part of the mass forces [N] */
    double *m_xx, *m_xy, *m_yx, *m_yy; /* M of the recursions */
    double *constant_x, *constant_y;   /* of the bias, later of the answer */
    double *answer_x, *answer_y;       /* at the link's inner end: R [N] above, b [m/s^2] below; one ahead */
    double *u_x, *u_y;                 /* u of links below the middle */
    double *turning;                   /* s, then (s - l n.f)/J of links below */
    /* of one strip of links, those from the top first [chain.c]: */
    double nn[STRIP_ROOM], en[STRIP_ROOM], ee[STRIP_ROOM]; /* inertia at the link's outer end [ends.h] */
    double unit[STRIP_ROOM], det[STRIP_ROOM];
    double bias_x[STRIP_ROOM], bias_y[STRIP_ROOM];               /* there: c [m/s^2] above the middle, f [N] below */
    double k_ee[STRIP_ROOM], k_en[STRIP_ROOM], k_nn[STRIP_ROOM]; /* K of links above the middle */
    double per_pivot[STRIP_ROOM];                                /* 1/J of links below */
    Motion top;          /* of P_0; with an acceleration where that is given [top.c] */
    const Motion *guide; /* where a pin is, or what P_n is to follow, among the inputs [terminal.c] */
    double end_force[2]; /* all force on the terminal besides the cable's pull [N] */
    double end_position[2], end_velocity[2];
} Work;

/* Doubles that model_layout() and work_layout() carve out of one block each. */
size_t model_doubles(int n);
size_t work_doubles(int n);
void model_layout(Model *model, double *block);
void work_layout(Work *work, int n, double *block);

/* Derived constants from given ones; call after every change of a parameter. */
void model_prepare(Model *model);

static inline bool model_has(const Model *model, Parameter parameter)
{
    return (model->present >> parameter) & 1u;
}

/* I_R of link i (0 ...), the terminal's on the last [kg m^2]. */
static inline double link_inertia(const Model *model, int i)
{
    return model->link[LINK_INERTIA][i] + (i == model->n - 1 ? model->end_inertia : 0.0);
}

/* Whether what is fastened there moves as the inputs say. */
static inline bool top_is_given(const Model *model)
{
    return model->top == TOP_MOTION;
}

/* Or does not move at all. */
static inline bool end_is_given(const Model *model)
{
    return model->terminal == TERMINAL_PIN || model->terminal == TERMINAL_MOTION;
}

/* Entries of q. */
static inline int model_coordinates(const Model *model)
{
    return model->n + 1 + (model->top == TOP_FREE);
}

/* Whether an input is a motion. */
static inline bool motion_is_given(const Model *model)
{
    return top_is_given(model) || model->terminal == TERMINAL_MOTION;
}

/* The most that n links may have, with whatever ends. */
static inline int most_coordinates(int n)
{
    return n + 2;
}

/* Entries of x = (q, q'). */
static inline int model_states(const Model *model)
{
    return 2 * model_coordinates(model);
}

/* Of a state, or of its derivative: the links' angular velocities [rad/s], or accelerations [rad/s^2]. */
static inline const double *rates_in(const Model *model, const double *x)
{
    return x + model->first_rate;
}

#endif
