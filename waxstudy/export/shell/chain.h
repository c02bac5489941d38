/* Blocks one after the other: each is the machine code of a block's `step`. */
#ifndef CHAIN_H
#define CHAIN_H

#include "model.h"

/* 0, or else the step raised an exception: its kind is in what `raised` points to, which only Python can read */
typedef int Step(double *result, void **raised, const void *parameters, void *state, double u, double t, double dt);

typedef struct {
    const char *label;
    Step *step; /* null where the chain leaves the block out: it passes on what it gets */
    size_t parameters, state;
    double low, high;
    bool subtracts; /* from the setpoint, the second input */
} Block;

extern const Block BLOCKS[]; /* OUTPUT_COUNT of them */

#endif
