/*
 * The rest shape of a cable between two ports: n frictionless rigid links, each with its own weight, held at (0, 0) and
 * at `end` (the discrete catenary). With H and V the horizontal and vertical pull at the top joint [N], link i hangs at
 *     tan th_i = H / (V - weight above the middle of link i).
 */
#ifndef CABLE_CATENARY_H
#define CABLE_CATENARY_H

typedef enum {
    CATENARY_OK,
    CATENARY_TOO_SHORT,  /* the ports are as far apart as the cable is long, or further */
    CATENARY_WEIGHTLESS, /* nothing says where the links hang */
    CATENARY_NO_FIT      /* the ports are too close together for links this long, or nearly the cable's length apart */
} CatenaryStatus;

/* How close the last link must come to the port [m]. */
#define CATENARY_MISS 1e-9

/*
 * angle[n] [rad] and pull = (H, V) [N], V positive where the cable pulls the top port down, from length[n] [m], weight[n] [N]
 * (below 0 for links that float) and end = (x, y) [m]. On failure both hold nothing of use.
 */
CatenaryStatus catenary(int n, const double *length, const double *weight, const double end[2], double *angle,
                        double pull[2]);

#endif
