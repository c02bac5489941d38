/* A room of two nodes, air and floor, by explicit steps; `trouble` makes it misbehave after the first hour. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

bool model_step(const double *inputs, double *outputs, const unsigned char *parameters, unsigned char *state, double t,
                char *message, size_t message_size) {
    double p[3], x[3]; /* start of air and floor, trouble; air, floor, whether they are set */
    memcpy(p, parameters, sizeof p);
    memcpy(x, state, sizeof x);
    if (x[2] == 0.0) x[0] = p[0], x[1] = p[1], x[2] = 1.0;
    double water_W_K = inputs[0] * 140.0, outdoor_C = inputs[2] - 273.15;
    double heat_W = 0.7 * water_W_K * (inputs[1] - x[1]), between_W = 110.0 * (x[1] - x[0]);
    double air = x[0] + STEP_S / 4e5 * (between_W - 12.0 * (x[0] - outdoor_C) + inputs[3] + 1.5 * inputs[4]);
    x[1] += STEP_S / 2e6 * (heat_W - between_W);
    x[0] = air;
    if (t >= 3600.0 && p[2] == 1.0) x[0] = NAN;
    if (t >= 3600.0 && p[2] == 2.0)
        for (volatile int forever = 1; forever;) continue;
    if (t >= 3600.0 && p[2] == 3.0) abort();
    memcpy(state, x, sizeof x);
    outputs[0] = x[0];
    outputs[1] = x[1];
    outputs[2] = inputs[1] - (water_W_K > 0.0 ? heat_W / water_W_K : 0.0);
    return true;
}
