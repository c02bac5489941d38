/* One instance of the model: its values, its time, and what an importer may do with it when. No FMI version is known here. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "model.h"

#define MESSAGE_SIZE 400

enum Phase { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED, FAILED };

typedef struct {
    double start, time; /* s, of the importer */
    int64_t steps;      /* of the model since the start */
    int64_t is_held;    /* 1: the inputs of the step that has begun are taken */
    int64_t phase;
    double values[]; /* inputs, held inputs, outputs, parameters, state */
} Memory;

typedef struct {
    void *log, *environment; /* the importer's */
    char *name;
    char message[MESSAGE_SIZE];
    Memory *memory;
} Instance;

/* All return whether it was done; if not, the reason is in `message`. */
Instance *instance_new(const char *name);
void instance_free(Instance *it);
void instance_reset(Instance *it);
bool instance_enter(Instance *it, double start);
bool instance_exit(Instance *it);
bool instance_terminate(Instance *it);
bool instance_get(Instance *it, unsigned reference, char type, double *value);
bool instance_set(Instance *it, unsigned reference, char type, double value);
bool instance_step(Instance *it, double at, double length);
bool instance_fail(Instance *it, const char *reason);

/* State as bytes: a copy of the memory, behind the token of the model that it belongs to. */
size_t state_size(void);
void state_save(const Instance *it, unsigned char *bytes);
bool state_load(Instance *it, const unsigned char *bytes, size_t size);

#endif
