/* FMI 2.0 for co-simulation, the functions of its interface as the standard declares them. */
#include <stdlib.h>
#include <string.h>

#include "instance.h"

#ifdef _WIN32
#define FMI __declspec(dllexport)
#else
#define FMI __attribute__((visibility("default")))
#endif

typedef int Status;
enum { OK, WARNING, DISCARD, ERROR, FATAL };
typedef void Logger(void *environment, const char *name, Status status, const char *category, const char *message, ...);
typedef struct {
    Logger *logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, Status);
    void *environment;
} Callbacks;

/* No message of ours has a '%', so that it can be given as the format that it is taken for. */
static Status said(Instance *it, bool done) {
    if (done) return OK;
    if (!it) return ERROR;
    for (char *c = it->message; *c; c++)
        if (*c == '%') *c = '_';
    if (it->log) ((Logger *)it->log)(it->environment, it->name, ERROR, "logStatusError", it->message);
    return ERROR;
}

static Status refuse(Instance *it, const char *reason) { return said(it, it && instance_fail(it, reason)); }

FMI const char *fmi2GetTypesPlatform(void) { return "default"; }
FMI const char *fmi2GetVersion(void) { return "2.0"; }
FMI Status fmi2SetDebugLogging(Instance *it, int on, size_t count, const char *const categories[]) { return OK; }

FMI Instance *fmi2Instantiate(const char *name, int kind, const char *token, const char *resources,
                              const Callbacks *callbacks, int visible, int logging) {
    Logger *log = callbacks ? callbacks->logger : NULL;
    void *environment = callbacks ? callbacks->environment : NULL;
    const char *wrong = !name || !*name                      ? "an instance needs a name"
                        : kind != 1                          ? "this FMU is for co-simulation only"
                        : !token || strcmp(token, TOKEN) != 0 ? "the GUID is not that of this FMU"
                                                             : NULL;
    if (wrong) {
        if (log) log(environment, name ? name : "", ERROR, "logStatusError", wrong);
        return NULL;
    }
    Instance *it = instance_new(name);
    if (it) it->log = (void *)log, it->environment = environment;
    return it;
}

FMI void fmi2FreeInstance(Instance *it) { instance_free(it); }
FMI Status fmi2SetupExperiment(Instance *it, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    if (it->memory->phase != INSTANTIATED) return refuse(it, "the experiment is set up before initialization");
    it->memory->start = start;
    return OK;
}
FMI Status fmi2EnterInitializationMode(Instance *it) { return said(it, instance_enter(it, it->memory->start)); }
FMI Status fmi2ExitInitializationMode(Instance *it) { return said(it, instance_exit(it)); }
FMI Status fmi2Terminate(Instance *it) { return said(it, instance_terminate(it)); }
FMI Status fmi2Reset(Instance *it) {
    instance_reset(it);
    return OK;
}

#define ACCESS(NAME, TYPE, LETTER)                                                                        \
    FMI Status fmi2Get##NAME(Instance *it, const unsigned references[], size_t count, TYPE values[]) {    \
        for (size_t i = 0; i < count; i++) {                                                              \
            double value = 0.0;                                                                           \
            if (!instance_get(it, references[i], LETTER, &value)) return said(it, false);                 \
            values[i] = (TYPE)value;                                                                      \
        }                                                                                                 \
        return OK;                                                                                        \
    }                                                                                                     \
    FMI Status fmi2Set##NAME(Instance *it, const unsigned references[], size_t count, const TYPE values[]) { \
        for (size_t i = 0; i < count; i++)                                                                \
            if (!instance_set(it, references[i], LETTER, (double)values[i])) return said(it, false);      \
        return OK;                                                                                        \
    }

ACCESS(Real, double, 'd')
ACCESS(Integer, int, 'q')
ACCESS(Boolean, int, '?')

FMI Status fmi2GetString(Instance *it, const unsigned references[], size_t count, const char *values[]) {
    return count ? refuse(it, "this FMU has no texts") : OK;
}
FMI Status fmi2SetString(Instance *it, const unsigned references[], size_t count, const char *const values[]) {
    return count ? refuse(it, "this FMU has no texts") : OK;
}

FMI Status fmi2DoStep(Instance *it, double at, double length, int forgets) { return said(it, instance_step(it, at, length)); }
FMI Status fmi2CancelStep(Instance *it) { return refuse(it, "no step of this FMU is pending"); }

FMI Status fmi2GetFMUstate(Instance *it, void **state) {
    if (!*state && !(*state = malloc(state_size()))) return refuse(it, "there is no memory left");
    state_save(it, *state);
    return OK;
}
FMI Status fmi2SetFMUstate(Instance *it, void *state) {
    return state ? said(it, state_load(it, state, state_size())) : refuse(it, "there is no state to set");
}
FMI Status fmi2FreeFMUstate(Instance *it, void **state) {
    free(*state);
    *state = NULL;
    return OK;
}
FMI Status fmi2SerializedFMUstateSize(Instance *it, void *state, size_t *size) {
    *size = state_size();
    return OK;
}
FMI Status fmi2SerializeFMUstate(Instance *it, void *state, unsigned char bytes[], size_t size) {
    if (!state || size < state_size()) return refuse(it, "the serialized state needs more room");
    memcpy(bytes, state, state_size());
    return OK;
}
FMI Status fmi2DeSerializeFMUstate(Instance *it, const unsigned char bytes[], size_t size, void **state) {
    if (size < state_size() || memcmp(bytes, TOKEN, strlen(TOKEN)) != 0)
        return refuse(it, "this is no state of this model");
    if (!*state && !(*state = malloc(state_size()))) return refuse(it, "there is no memory left");
    memcpy(*state, bytes, state_size());
    return OK;
}

static const char *NO_DERIVATIVES = "this FMU gives no derivatives";
FMI Status fmi2GetDirectionalDerivative(Instance *it, const unsigned unknown[], size_t unknowns, const unsigned known[],
                                        size_t knowns, const double seed[], double result[]) {
    return refuse(it, NO_DERIVATIVES);
}
FMI Status fmi2SetRealInputDerivatives(Instance *it, const unsigned references[], size_t count, const int order[],
                                       const double values[]) {
    return refuse(it, "inputs are held over a step: they have no derivatives");
}
FMI Status fmi2GetRealOutputDerivatives(Instance *it, const unsigned references[], size_t count, const int order[],
                                        double values[]) {
    return refuse(it, NO_DERIVATIVES);
}

#define STATUS(NAME, TYPE)                                                                    \
    FMI Status fmi2Get##NAME(Instance *it, int kind, TYPE *value) {                           \
        return refuse(it, "steps of this FMU are done when they return: there is no status"); \
    }
STATUS(Status, Status)
STATUS(IntegerStatus, int)
STATUS(BooleanStatus, int)
STATUS(StringStatus, const char *)

FMI Status fmi2GetRealStatus(Instance *it, int kind, double *value) {
    if (kind != 2) return refuse(it, "of the status only the time of the last step is known");
    *value = it->memory->time;
    return OK;
}
