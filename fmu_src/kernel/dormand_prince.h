/* An embedded explicit Runge-Kutta pair whose last stage is the next step's first. Its tables are data. */
#ifndef CABLE_DORMAND_PRINCE_H
#define CABLE_DORMAND_PRINCE_H

typedef struct {
    const char *name;
    int stages, order;
    const double *a; /* strictly lower triangle by rows, stages (stages - 1) / 2 entries */
    const double *b, *b_embedded, *c;
} Tableau;

extern const Tableau DORMAND_PRINCE_54;

#endif
