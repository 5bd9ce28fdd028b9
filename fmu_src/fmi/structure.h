/*
 * The number of links n as a parameter of the FMU (FMI 3 with arrays). The cable is uniform: given as a whole, divided
 * evenly into any number of links. Its start shape and, where something holds its end, the preloads with which that
 * shape rests are a function of what is given. Every number that follows from n comes out to the bit as in a scene that
 * is written with as many links [models/cablefmu/assembly.py].
 */
#ifndef CABLE_STRUCTURE_H
#define CABLE_STRUCTURE_H

#include "instance.h"

/* As many links as that from now on, 1 ... MOST_LINKS; where there is no memory for them, a message and as before. What
 * was set stays, but for the states of the links, which follow from the shape. */
Status structure_set_links(Instance *instance, uint64_t n);

/* Fills instance->link from instance->whole. */
void structure_divide(Instance *instance);

/* Fills the states of the links, at rest, and what of the preloads is no parameter of the scene; the floater's states
 * stay. False after a message where no rest shape joins the ports. */
bool structure_start(Instance *instance, double *states);

#endif
