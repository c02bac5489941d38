/* What an FMU carries: the shell steps it and knows no more of it than this. The tables are written by the exporter. */
#ifndef MODEL_H
#define MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum Causality { TIME, INPUT, OUTPUT, PARAMETER, CONSTANT };

typedef struct {
    const char *name;
    enum Causality causality;
    char type;    /* d: double, q: 64-bit integer, ?: one byte, 0 or 1 */
    size_t place; /* of an input or output its number, of a parameter or constant its first byte */
    double low, high;
    bool above_low, below_high; /* the bound itself is not allowed */
} Variable;

extern const char TOKEN[];
extern const double STEP_S;
extern const Variable VARIABLES[];
extern const unsigned VARIABLE_COUNT;
extern const size_t INPUT_COUNT, OUTPUT_COUNT, PARAMETER_BYTES, STATE_BYTES; /* bytes in whole doubles */
extern const double INPUT_START[];
extern const unsigned char PARAMETER_START[], STATE_START[];

/* Advance by STEP_S from `t` with inputs held; false with the reason in `message`. */
bool model_step(const double *inputs, double *outputs, const unsigned char *parameters, unsigned char *state, double t,
                char *message, size_t message_size);

#endif
