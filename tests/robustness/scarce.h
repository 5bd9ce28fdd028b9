/*
 * The FMU's own memory, counted. The sources are compiled with malloc, calloc, free and fopen renamed to these
 * (fopen takes memory too); host.c asks how much is in use and makes one of them fail.
 */
#ifndef SCARCE_H
#define SCARCE_H

/* Fail the k-th request from now (1, 2, ...); 0: none. */
void scarce_fail(long k);
/* Blocks and files that were got and not given back. */
long scarce_in_use(void);

#endif
