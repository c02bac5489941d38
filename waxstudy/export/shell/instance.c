#include "instance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double ROUNDING = 1e-6; /* of a step: what times that an importer adds up may be off */
static const double MOST_STEPS = 1e9; /* at once: about a minute */

static double *inputs(Memory *m) { return m->values; }
static double *held(Memory *m) { return inputs(m) + INPUT_COUNT; }
static double *outputs(Memory *m) { return held(m) + INPUT_COUNT; }
static unsigned char *parameters(Memory *m) { return (unsigned char *)(outputs(m) + OUTPUT_COUNT); }
static unsigned char *state(Memory *m) { return parameters(m) + PARAMETER_BYTES; }

static size_t memory_size(void) {
    return sizeof(Memory) + (2 * INPUT_COUNT + OUTPUT_COUNT) * sizeof(double) + PARAMETER_BYTES + STATE_BYTES;
}

bool instance_fail(Instance *it, const char *reason) {
    snprintf(it->message, MESSAGE_SIZE, "%s", reason);
    return false;
}

Instance *instance_new(const char *name) {
    Instance *it = calloc(1, sizeof(Instance));
    if (!it) return NULL;
    it->memory = calloc(1, memory_size());
    it->name = malloc(strlen(name) + 1);
    if (!it->memory || !it->name) {
        instance_free(it);
        return NULL;
    }
    strcpy(it->name, name);
    instance_reset(it);
    return it;
}

void instance_free(Instance *it) {
    if (!it) return;
    free(it->memory);
    free(it->name);
    free(it);
}

void instance_reset(Instance *it) {
    Memory *m = it->memory;
    memset(m, 0, memory_size());
    memcpy(inputs(m), INPUT_START, INPUT_COUNT * sizeof(double));
    memcpy(parameters(m), PARAMETER_START, PARAMETER_BYTES);
    memcpy(state(m), STATE_START, STATE_BYTES);
}

/* Before the first step the outputs are those of a trial step, of which nothing else is kept. */
static bool show_start(Instance *it) {
    Memory *m = it->memory;
    unsigned char *kept = malloc(STATE_BYTES);
    if (!kept) return instance_fail(it, "there is no memory left");
    memcpy(kept, state(m), STATE_BYTES);
    bool done = model_step(inputs(m), outputs(m), parameters(m), state(m), m->start, it->message, MESSAGE_SIZE);
    memcpy(state(m), kept, STATE_BYTES);
    free(kept);
    return done;
}

bool instance_enter(Instance *it, double start) {
    Memory *m = it->memory;
    if (m->phase != INSTANTIATED) return instance_fail(it, "initialization begins once, right after instantiation or reset");
    if (!isfinite(start)) return instance_fail(it, "the start time must be a finite number");
    m->start = m->time = start;
    m->phase = INITIALIZING;
    return true;
}

bool instance_exit(Instance *it) {
    if (it->memory->phase != INITIALIZING) return instance_fail(it, "initialization ends after it has begun");
    if (!show_start(it)) {
        it->memory->phase = FAILED;
        return false;
    }
    it->memory->phase = STEPPING;
    return true;
}

bool instance_terminate(Instance *it) {
    if (it->memory->phase != STEPPING) return instance_fail(it, "only what was initialized can be terminated");
    it->memory->phase = TERMINATED;
    return true;
}

static const char *type_name(char type) { return type == 'd' ? "a real" : type == 'q' ? "an integer" : "a boolean"; }

static const Variable *find(Instance *it, unsigned reference, char type) {
    if (reference >= VARIABLE_COUNT) {
        snprintf(it->message, MESSAGE_SIZE, "there is no variable with the value reference %u", reference);
        return NULL;
    }
    const Variable *found = &VARIABLES[reference];
    if (found->type == type) return found;
    snprintf(it->message, MESSAGE_SIZE, "%s is %s number, asked for as %s", found->name, type_name(found->type),
             type_name(type));
    return NULL;
}

bool instance_get(Instance *it, unsigned reference, char type, double *value) {
    const Variable *v = find(it, reference, type);
    Memory *m = it->memory;
    if (!v) return false;
    if (v->causality == OUTPUT && m->phase == INITIALIZING && !show_start(it)) return false;
    if (v->causality == TIME) *value = m->time;
    else if (v->causality == INPUT) *value = inputs(m)[v->place];
    else if (v->causality == OUTPUT) *value = outputs(m)[v->place];
    else if (type == 'd') memcpy(value, parameters(m) + v->place, sizeof(double));
    else if (type == 'q') {
        int64_t whole;
        memcpy(&whole, parameters(m) + v->place, sizeof whole);
        *value = (double)whole;
    } else *value = parameters(m)[v->place] != 0;
    return true;
}

static bool may_set(Instance *it, const Variable *v) {
    int64_t phase = it->memory->phase;
    if (v->causality == INPUT && phase <= STEPPING) return true;
    if (v->causality == PARAMETER && phase <= INITIALIZING) return true;
    const char *when = v->causality == PARAMETER ? "is a parameter, which is set before initialization ends"
                       : v->causality == INPUT   ? "cannot be set after the end or a failed step"
                                                 : "cannot be set";
    snprintf(it->message, MESSAGE_SIZE, "%s %s", v->name, when);
    return false;
}

static bool is_allowed(Instance *it, const Variable *v, double value) {
    bool above = v->above_low ? value > v->low : value >= v->low; /* false for NaN, as below */
    bool below = v->below_high ? value < v->high : value <= v->high;
    if (above && below) return true;
    snprintf(it->message, MESSAGE_SIZE, "%s cannot be %g: allowed is %s %g and %s %g", v->name, value,
             v->above_low ? "above" : "from", v->low, v->below_high ? "below" : "up to", v->high);
    return false;
}

bool instance_set(Instance *it, unsigned reference, char type, double value) {
    const Variable *v = find(it, reference, type);
    Memory *m = it->memory;
    if (!v || !may_set(it, v) || !is_allowed(it, v, value)) return false;
    if (v->causality == INPUT) inputs(m)[v->place] = value;
    else if (type == 'd') memcpy(parameters(m) + v->place, &value, sizeof value);
    else if (type == 'q') {
        int64_t whole = (int64_t)value;
        memcpy(parameters(m) + v->place, &whole, sizeof whole);
    } else parameters(m)[v->place] = value != 0.0;
    return true;
}

static bool can_step(Instance *it, double at, double length) {
    Memory *m = it->memory;
    if (m->phase != STEPPING) return instance_fail(it, "a step needs an instance that is initialized and has not ended or failed");
    if (!(length > 0.0) || !isfinite(length)) {
        snprintf(it->message, MESSAGE_SIZE, "a step of %g s: it must be above 0 and finite", length);
        return false;
    }
    if (!(fabs(at - m->time) <= ROUNDING * STEP_S + 1e-12 * fabs(m->time))) {
        snprintf(it->message, MESSAGE_SIZE, "the step begins at %.10g s, but the last one ended at %.10g s", at, m->time);
        return false;
    }
    if (length / STEP_S <= MOST_STEPS) return true;
    snprintf(it->message, MESSAGE_SIZE, "a step of %g s: at most %g s can be taken at once", length, MOST_STEPS * STEP_S);
    return false;
}

/* The model goes by its own step. Each of its steps holds the inputs that the importer has set when it begins, and
   its outputs show when it ends: what is left of the importer's step is carried to the next one. */
bool instance_step(Instance *it, double at, double length) {
    if (!can_step(it, at, length)) return false;
    Memory *m = it->memory;
    double passed = (at + length - m->start) / STEP_S + ROUNDING;
    for (;;) {
        if (!m->is_held && (double)m->steps + 2.0 * ROUNDING < passed) {
            memcpy(held(m), inputs(m), INPUT_COUNT * sizeof(double));
            m->is_held = 1;
        }
        if (!m->is_held || (double)(m->steps + 1) > passed) break;
        double t = m->start + (double)m->steps * STEP_S;
        if (!model_step(held(m), outputs(m), parameters(m), state(m), t, it->message, MESSAGE_SIZE)) {
            m->phase = FAILED;
            return false;
        }
        m->steps++;
        m->is_held = 0;
    }
    m->time = at + length;
    return true;
}

size_t state_size(void) { return strlen(TOKEN) + memory_size(); }

void state_save(const Instance *it, unsigned char *bytes) {
    memcpy(bytes, TOKEN, strlen(TOKEN));
    memcpy(bytes + strlen(TOKEN), it->memory, memory_size());
}

bool state_load(Instance *it, const unsigned char *bytes, size_t size) {
    if (size != state_size() || memcmp(bytes, TOKEN, strlen(TOKEN)) != 0)
        return instance_fail(it, "this is no state of this model");
    memcpy(it->memory, bytes + strlen(TOKEN), memory_size());
    return true;
}
