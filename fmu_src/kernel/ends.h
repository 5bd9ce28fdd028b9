/*
 * How two parts of the cable answer at a node: the part above it, from the top, and the part below it, from the
 * tip. Both are worked on at once, in two lanes: neither has to wait for the other's result.
 *
 * A part needs the force R = A a + f to follow the acceleration a, A symmetric 2x2, its inertia at the node. A is
 * kept in homogeneous coordinates, A = N / unit, together with det = det(N) / unit. In these five numbers
 * passing a link and turning the axes are linear, so that
 *   - nothing is divided on the way, and the coefficients of passing a link are all positive but one: digits
 *     cancel behind a heavy end only where links almost line up [docs/numerics.md];
 *   - what cannot move is no special case: free in y with mass M and fixed in x is N = diag(1, 0), unit = 0,
 *     det = M; a pin is det = 1 and zeros.
 * Axes are (n, e) of a link. Those of the world, (x, y), are a link's that hangs straight down.
 */
#ifndef CABLE_ENDS_H
#define CABLE_ENDS_H

#include "dynamics.h"

enum { FROM_TOP, FROM_TIP, ENDS };

typedef double Lanes __attribute__((vector_size(16)));
typedef uint64_t LaneBits __attribute__((vector_size(16)));

typedef struct {
    Lanes nn, en, ee; /* N along n, across, along e [kg, times unit] */
    Lanes unit;       /* the common denominator */
    Lanes det;        /* det(N) / unit [kg^2, times unit] */
} Inertia;

/* Constants of a link, with J0 = I + m l^2 / 4: m [kg], l^2 / J0 [1/kg], m I / J0 [kg], (I - m l^2 / 4) / J0. */
typedef struct {
    Lanes mass, reach, swing, skew;
} LinkInertia;

/* In axes turned by the angle of cosine c and sine s: e' = c e + s n, n' = c n - s e. */
static inline Inertia turned(Inertia a, Lanes c, Lanes s)
{
    const Lanes cc = c * c, ss = s * s, cs = c * s, twice = cs + cs;
    return (Inertia){(ss * a.ee + cc * a.nn) - twice * a.en, cs * (a.nn - a.ee) + (cc - ss) * a.en,
                     (cc * a.ee + ss * a.nn) + twice * a.en, a.unit, a.det};
}

/*
 * The part with one more link, at the link's other end, in the link's axes. With the pivot of the link's turning
 * J = J0 + l^2 A_nn [chain.c], multiplied by unit and divided by J0:
 *     unit' = unit + (l^2/J0) N_nn             N_nn' = N_nn + (m I/J0) unit      N_en' = (I - m l^2/4)/J0 N_en
 *     N_ee' = N_ee + m unit' + (l^2/J0) det    det' = det + m N_nn + (m I/J0) (N_ee + m unit)
 */
static inline Inertia past_link(Inertia a, LinkInertia link)
{
    const Lanes m = link.mass, r = link.reach, q = link.swing;
    return (Inertia){a.nn + q * a.unit, link.skew * a.en, (a.ee + m * a.unit) + ((m * r) * a.nn + r * a.det),
                     a.unit + r * a.nn, (a.det + m * a.nn) + (q * a.ee + (q * m) * a.unit)};
}

/* Times a power of two near 1 / (unit + det): changes no digit, keeps products along a long chain in range. */
static inline Inertia rescaled(Inertia a)
{
    const LaneBits exponent = (LaneBits)(a.unit + a.det) & 0x7ff0000000000000u;
    const Lanes scale = (Lanes)(0x7fe0000000000000u - exponent);
    return (Inertia){a.nn * scale, a.en * scale, a.ee * scale, a.unit * scale, a.det * scale};
}

/* A pair of vectors, one for each end. */
typedef struct {
    Lanes x, y;
} Planar;

static inline Inertia inertia_of(const Port port[ENDS])
{
    const Port *top = &port[FROM_TOP], *tip = &port[FROM_TIP];
    return (Inertia){
        {top->xx, tip->xx}, {top->xy, tip->xy}, {top->yy, tip->yy}, {top->unit, tip->unit}, {top->det, tip->det}};
}

static inline Planar bias_of(const Port port[ENDS])
{
    const Port *top = &port[FROM_TOP], *tip = &port[FROM_TIP];
    return (Planar){{top->bias_x, tip->bias_x}, {top->bias_y, tip->bias_y}};
}

#endif
