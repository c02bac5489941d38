#include <stdio.h>

#include "chain.h"

bool model_step(const double *inputs, double *outputs, const unsigned char *parameters, unsigned char *state, double t,
                char *message, size_t message_size) {
    double u = inputs[0];
    for (size_t k = 0; k < OUTPUT_COUNT; k++) {
        const Block *block = &BLOCKS[k];
        if (block->subtracts) u = inputs[1] - u;
        if (block->step) {
            double result = 0.0;
            void *raised = NULL;
            if (block->step(&result, &raised, parameters + block->parameters, state + block->state, u, t, STEP_S)) {
                snprintf(message, message_size, "%s failed at %g s with input %g: its step raised an exception",
                         block->label, t, u);
                return false;
            }
            if (!(block->low <= result && result <= block->high)) { /* false for NaN too */
                snprintf(message, message_size, "%s failed at %g s with input %g: it gave %g, allowed is %g to %g",
                         block->label, t, u, result, block->low, block->high);
                return false;
            }
            u = result;
        }
        outputs[k] = u;
    }
    return true;
}
