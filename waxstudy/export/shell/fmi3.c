/* FMI 3.0 for co-simulation, the functions of its interface as the standard declares them. */
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
typedef void Logger(void *environment, Status status, const char *category, const char *message);
typedef uint32_t Reference;

static Status said(Instance *it, bool done) {
    if (done) return OK;
    if (it && it->log) ((Logger *)it->log)(it->environment, ERROR, "logStatusError", it->message);
    return ERROR;
}

static Status refuse(Instance *it, const char *reason) { return said(it, it && instance_fail(it, reason)); }

FMI const char *fmi3GetVersion(void) { return "3.0"; }
FMI Status fmi3SetDebugLogging(Instance *it, bool on, size_t count, const char *const categories[]) { return OK; }

FMI Instance *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                          bool logging, bool has_events, bool may_return_early,
                                          const Reference intermediate[], size_t intermediates, void *environment,
                                          Logger *log, void *update) {
    const char *wrong = !name || !*name                      ? "an instance needs a name"
                        : !token || strcmp(token, TOKEN) != 0 ? "the instantiation token is not that of this FMU"
                                                             : NULL;
    if (wrong) {
        if (log) log(environment, ERROR, "logStatusError", wrong);
        return NULL;
    }
    Instance *it = instance_new(name);
    if (it) it->log = (void *)log, it->environment = environment;
    return it;
}

static const char *ONLY = "this FMU is for co-simulation only";
FMI Instance *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool visible,
                                           bool logging, void *environment, Logger *log) {
    if (log) log(environment, ERROR, "logStatusError", ONLY);
    return NULL;
}
FMI Instance *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *resources, bool visible,
                                                bool logging, void *environment, Logger *log, void *update, void *lock,
                                                void *unlock) {
    if (log) log(environment, ERROR, "logStatusError", ONLY);
    return NULL;
}

FMI void fmi3FreeInstance(Instance *it) { instance_free(it); }
FMI Status fmi3EnterInitializationMode(Instance *it, bool has_tolerance, double tolerance, double start, bool has_stop,
                                       double stop) {
    return said(it, instance_enter(it, start));
}
FMI Status fmi3ExitInitializationMode(Instance *it) { return said(it, instance_exit(it)); }
FMI Status fmi3Terminate(Instance *it) { return said(it, instance_terminate(it)); }
FMI Status fmi3Reset(Instance *it) {
    instance_reset(it);
    return OK;
}

static Status too_few(Instance *it, size_t references, size_t values) {
    return references == values ? OK : refuse(it, "there must be one value for each variable");
}

#define ACCESS(NAME, TYPE, LETTER)                                                                                  \
    FMI Status fmi3Get##NAME(Instance *it, const Reference references[], size_t count, TYPE values[], size_t n) {   \
        if (too_few(it, count, n)) return ERROR;                                                                    \
        for (size_t i = 0; i < count; i++) {                                                                        \
            double value = 0.0;                                                                                     \
            if (!instance_get(it, references[i], LETTER, &value)) return said(it, false);                           \
            values[i] = (TYPE)value;                                                                                \
        }                                                                                                           \
        return OK;                                                                                                  \
    }                                                                                                               \
    FMI Status fmi3Set##NAME(Instance *it, const Reference references[], size_t count, const TYPE values[],         \
                             size_t n) {                                                                            \
        if (too_few(it, count, n)) return ERROR;                                                                    \
        for (size_t i = 0; i < count; i++)                                                                          \
            if (!instance_set(it, references[i], LETTER, (double)values[i])) return said(it, false);                \
        return OK;                                                                                                  \
    }

ACCESS(Float64, double, 'd')
ACCESS(Int64, int64_t, 'q')
ACCESS(Boolean, bool, '?')

#define NO_ACCESS(NAME, TYPE)                                                                                       \
    FMI Status fmi3Get##NAME(Instance *it, const Reference references[], size_t count, TYPE values[], size_t n) {   \
        return count ? refuse(it, "this FMU has no variables of this type") : OK;                                   \
    }                                                                                                               \
    FMI Status fmi3Set##NAME(Instance *it, const Reference references[], size_t count, const TYPE values[],         \
                             size_t n) {                                                                            \
        return count ? refuse(it, "this FMU has no variables of this type") : OK;                                   \
    }

NO_ACCESS(Float32, float)
NO_ACCESS(Int8, int8_t)
NO_ACCESS(UInt8, uint8_t)
NO_ACCESS(Int16, int16_t)
NO_ACCESS(UInt16, uint16_t)
NO_ACCESS(Int32, int32_t)
NO_ACCESS(UInt32, uint32_t)
NO_ACCESS(UInt64, uint64_t)
NO_ACCESS(String, char *)
FMI Status fmi3GetBinary(Instance *it, const Reference references[], size_t count, size_t sizes[], const uint8_t *values[],
                         size_t n) {
    return count ? refuse(it, "this FMU has no variables of this type") : OK;
}
FMI Status fmi3SetBinary(Instance *it, const Reference references[], size_t count, const size_t sizes[],
                         const uint8_t *const values[], size_t n) {
    return count ? refuse(it, "this FMU has no variables of this type") : OK;
}
FMI Status fmi3GetClock(Instance *it, const Reference references[], size_t count, bool values[]) {
    return count ? refuse(it, "this FMU has no clocks") : OK;
}
FMI Status fmi3SetClock(Instance *it, const Reference references[], size_t count, const bool values[]) {
    return count ? refuse(it, "this FMU has no clocks") : OK;
}

FMI Status fmi3DoStep(Instance *it, double at, double length, bool forgets, bool *needs_event, bool *ends, bool *is_early,
                      double *last) {
    if (needs_event) *needs_event = false;
    if (ends) *ends = false;
    if (is_early) *is_early = false;
    bool done = instance_step(it, at, length);
    if (last) *last = it->memory->time;
    return said(it, done);
}

FMI Status fmi3GetFMUState(Instance *it, void **state) {
    if (!*state && !(*state = malloc(state_size()))) return refuse(it, "there is no memory left");
    state_save(it, *state);
    return OK;
}
FMI Status fmi3SetFMUState(Instance *it, void *state) {
    return state ? said(it, state_load(it, state, state_size())) : refuse(it, "there is no state to set");
}
FMI Status fmi3FreeFMUState(Instance *it, void **state) {
    free(*state);
    *state = NULL;
    return OK;
}
FMI Status fmi3SerializedFMUStateSize(Instance *it, void *state, size_t *size) {
    *size = state_size();
    return OK;
}
FMI Status fmi3SerializeFMUState(Instance *it, void *state, uint8_t bytes[], size_t size) {
    if (!state || size < state_size()) return refuse(it, "the serialized state needs more room");
    memcpy(bytes, state, state_size());
    return OK;
}
FMI Status fmi3DeserializeFMUState(Instance *it, const uint8_t bytes[], size_t size, void **state) {
    if (size < state_size() || memcmp(bytes, TOKEN, strlen(TOKEN)) != 0)
        return refuse(it, "this is no state of this model");
    if (!*state && !(*state = malloc(state_size()))) return refuse(it, "there is no memory left");
    memcpy(*state, bytes, state_size());
    return OK;
}

/* What the model description says that this FMU cannot do; the interface wants a function for each. */
#define REFUSED(NAME, ...)                                                               \
    FMI Status fmi3##NAME(Instance *it, ##__VA_ARGS__) {                                 \
        return refuse(it, "fmi3" #NAME " is not offered, as the model description says"); \
    }

REFUSED(EnterEventMode)
REFUSED(EnterStepMode)
REFUSED(EnterConfigurationMode)
REFUSED(ExitConfigurationMode)
REFUSED(GetNumberOfVariableDependencies, Reference of, size_t *count)
REFUSED(GetVariableDependencies, Reference of, size_t elements[], Reference on[], size_t on_elements[], int kinds[], size_t n)
REFUSED(GetDirectionalDerivative, const Reference unknown[], size_t unknowns, const Reference known[], size_t knowns,
        const double seed[], size_t seeds, double result[], size_t results)
REFUSED(GetAdjointDerivative, const Reference unknown[], size_t unknowns, const Reference known[], size_t knowns,
        const double seed[], size_t seeds, double result[], size_t results)
REFUSED(GetIntervalDecimal, const Reference of[], size_t count, double intervals[], int qualifiers[])
REFUSED(GetIntervalFraction, const Reference of[], size_t count, uint64_t counters[], uint64_t resolutions[], int qualifiers[])
REFUSED(GetShiftDecimal, const Reference of[], size_t count, double shifts[])
REFUSED(GetShiftFraction, const Reference of[], size_t count, uint64_t counters[], uint64_t resolutions[])
REFUSED(SetIntervalDecimal, const Reference of[], size_t count, const double intervals[])
REFUSED(SetIntervalFraction, const Reference of[], size_t count, const uint64_t counters[], const uint64_t resolutions[])
REFUSED(SetShiftDecimal, const Reference of[], size_t count, const double shifts[])
REFUSED(SetShiftFraction, const Reference of[], size_t count, const uint64_t counters[], const uint64_t resolutions[])
REFUSED(EvaluateDiscreteStates)
REFUSED(UpdateDiscreteStates, bool *again, bool *ends, bool *nominals, bool *values, bool *is_defined, double *next)
REFUSED(EnterContinuousTimeMode)
REFUSED(CompletedIntegratorStep, bool forgets, bool *enters, bool *ends)
REFUSED(SetTime, double time)
REFUSED(SetContinuousStates, const double states[], size_t count)
REFUSED(GetContinuousStateDerivatives, double derivatives[], size_t count)
REFUSED(GetEventIndicators, double indicators[], size_t count)
REFUSED(GetContinuousStates, double states[], size_t count)
REFUSED(GetNominalsOfContinuousStates, double nominals[], size_t count)
REFUSED(GetNumberOfEventIndicators, size_t *count)
REFUSED(GetNumberOfContinuousStates, size_t *count)
REFUSED(GetOutputDerivatives, const Reference of[], size_t count, const int orders[], double values[], size_t n)
REFUSED(ActivateModelPartition, Reference clock, double time)
