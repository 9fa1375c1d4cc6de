// The 75 functions of FMI 3.0. What the model description does not offer returns an error with a message.
#include <cstring>
#include <memory>

#include "harness/fmi/fmi3.h"
#include "harness/fmi/fmu_instance.h"

namespace {

using namespace quayside::harness;

FmuInstance& of(fmi3Instance instance) { return *static_cast<FmuInstance*>(instance); }
UnitState& state_of(fmi3FMUState state) { return *static_cast<UnitState*>(state); }

template <typename Action>
fmi3Status guarded(fmi3Instance instance, Action action) {
  if (!instance) return fmi3Error;
  FmuInstance& fmu = of(instance);
  return static_cast<fmi3Status>(fmu.guarded([&] { action(fmu); }));
}

fmi3Status unsupported(fmi3Instance instance, const char* function) {
  if (!instance) return fmi3Error;
  return static_cast<fmi3Status>(
      of(instance).fail(std::string(function) + " is not supported, as the model description tells"));
}

// For types that no variable has: nothing is right, something is not.
fmi3Status nothing_of_type(fmi3Instance instance, std::size_t count, const char* function) {
  return count == 0 ? fmi3OK : unsupported(instance, function);
}

void check_counts(std::size_t references, std::size_t values) {
  if (references != values)
    throw std::invalid_argument("all variables are scalar: as many values as references, please");
}

}  // namespace

const char* fmi3GetVersion() { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, std::size_t, const fmi3String[]) {
  return guarded(instance, [&](FmuInstance& fmu) { fmu.set_logging(on); });
}

// --- Instances
// --------------------------------------------------------------------------------------------------------

fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  if (log) log(environment, fmi3Error, "error", "this FMU is for Co-Simulation, not for Model Exchange");
  return nullptr;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback, fmi3LockPreemptionCallback,
                                               fmi3UnlockPreemptionCallback) {
  if (log) log(environment, fmi3Error, "error", "this FMU is for Co-Simulation, not for Scheduled Execution");
  return nullptr;
}

namespace {

// An instance that knows how it was instantiated.
struct Instance3 : FmuInstance {
  Instance3(const std::string& name, const std::string& token, const std::string& resources, Log log, bool logging,
            bool event_mode_used)
      : FmuInstance(name, token, resources, std::move(log), logging), event_mode_used(event_mode_used) {}
  bool event_mode_used;
};

}  // namespace

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean,
                                         fmi3Boolean logging, fmi3Boolean event_mode_used,
                                         fmi3Boolean early_return_allowed, const fmi3ValueReference[], std::size_t,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback) {
  const auto say = [environment, log](FmiStatus status, const char* category, const std::string& message) {
    if (log) log(environment, static_cast<fmi3Status>(status), category, message.c_str());
  };
  try {
    auto instance = std::make_unique<Instance3>(name ? name : "", token ? token : "", resources ? resources : "", say,
                                                logging, event_mode_used);
    instance->unit().set_stop_at_events(event_mode_used && early_return_allowed);
    return static_cast<FmuInstance*>(instance.release());
  } catch (const std::exception& error) {
    say(FmiStatus::error, "error", error.what());
    return nullptr;
  }
}

void fmi3FreeInstance(fmi3Instance instance) {
  if (instance) delete static_cast<Instance3*>(&of(instance));
}

// --- Life cycle
// -------------------------------------------------------------------------------------------------------

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean,
                                       fmi3Float64) {
  return guarded(instance, [&](FmuInstance& fmu) { fmu.unit().enter_initialization_mode(nanoseconds(start)); });
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  return guarded(instance, [&](FmuInstance& fmu) {
    fmu.unit().exit_initialization_mode();
    if (!static_cast<Instance3&>(fmu).event_mode_used) fmu.unit().enter_step_mode();
  });
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  return guarded(instance, [](FmuInstance& fmu) { fmu.unit().enter_event_mode(); });
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* needs_update, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* states_changed,
                                    fmi3Boolean* next_event_defined, fmi3Float64* next_event) {
  return guarded(instance, [&](FmuInstance& fmu) {
    const std::optional<Time> next = fmu.unit().update_discrete_states();
    *needs_update = *terminate = *nominals_changed = *states_changed = false;
    *next_event_defined = next.has_value();
    *next_event = next ? seconds(*next) : 0;
  });
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  return guarded(instance, [](FmuInstance& fmu) { fmu.unit().enter_step_mode(); });
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 now, fmi3Float64 step, fmi3Boolean, fmi3Boolean* event,
                      fmi3Boolean* terminate, fmi3Boolean* early_return, fmi3Float64* reached) {
  FmuInstance::Step result;
  const fmi3Status status = guarded(instance, [&](FmuInstance& fmu) { fmu.step(now, step, result); });
  *event = result.event;
  *terminate = result.terminate;
  *early_return = result.early;
  *reached = result.reached;
  return status;
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  return guarded(instance, [](FmuInstance& fmu) { fmu.unit().terminate(); });
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  return guarded(instance, [](FmuInstance& fmu) { fmu.unit().reset(); });
}

// --- Values
// -----------------------------------------------------------------------------------------------------------

fmi3Status fmi3GetFloat64(QUAYSIDE_FMI3_VR, fmi3Float64 values[], std::size_t value_count) {
  return guarded(instance, [&](FmuInstance& fmu) {
    check_counts(count, value_count);
    for (std::size_t i = 0; i < count; ++i) values[i] = fmu.get(references[i], Type::float64);
  });
}

fmi3Status fmi3SetFloat64(QUAYSIDE_FMI3_VR, const fmi3Float64 values[], std::size_t value_count) {
  return guarded(instance, [&](FmuInstance& fmu) {
    check_counts(count, value_count);
    for (std::size_t i = 0; i < count; ++i) fmu.set(references[i], Type::float64, values[i]);
  });
}

fmi3Status fmi3GetBoolean(QUAYSIDE_FMI3_VR, fmi3Boolean values[], std::size_t value_count) {
  return guarded(instance, [&](FmuInstance& fmu) {
    check_counts(count, value_count);
    for (std::size_t i = 0; i < count; ++i) values[i] = fmu.get(references[i], Type::boolean) != 0;
  });
}

fmi3Status fmi3SetBoolean(QUAYSIDE_FMI3_VR, const fmi3Boolean values[], std::size_t value_count) {
  return guarded(instance, [&](FmuInstance& fmu) {
    check_counts(count, value_count);
    for (std::size_t i = 0; i < count; ++i) fmu.set(references[i], Type::boolean, values[i]);
  });
}

#define QUAYSIDE_NO_SUCH_TYPE(type)                                             \
  fmi3Status fmi3Get##type(QUAYSIDE_FMI3_VR, fmi3##type[], std::size_t) {       \
    return nothing_of_type(instance, count, __func__);                          \
  }                                                                             \
  fmi3Status fmi3Set##type(QUAYSIDE_FMI3_VR, const fmi3##type[], std::size_t) { \
    return nothing_of_type(instance, count, __func__);                          \
  }
QUAYSIDE_NO_SUCH_TYPE(Float32)
QUAYSIDE_NO_SUCH_TYPE(Int8)
QUAYSIDE_NO_SUCH_TYPE(UInt8)
QUAYSIDE_NO_SUCH_TYPE(Int16)
QUAYSIDE_NO_SUCH_TYPE(UInt16)
QUAYSIDE_NO_SUCH_TYPE(Int32)
QUAYSIDE_NO_SUCH_TYPE(UInt32)
QUAYSIDE_NO_SUCH_TYPE(Int64)
QUAYSIDE_NO_SUCH_TYPE(UInt64)
QUAYSIDE_NO_SUCH_TYPE(String)

fmi3Status fmi3GetBinary(QUAYSIDE_FMI3_VR, std::size_t[], fmi3Binary[], std::size_t) {
  return nothing_of_type(instance, count, __func__);
}
fmi3Status fmi3SetBinary(QUAYSIDE_FMI3_VR, const std::size_t[], const fmi3Binary[], std::size_t) {
  return nothing_of_type(instance, count, __func__);
}
fmi3Status fmi3GetClock(QUAYSIDE_FMI3_VR, fmi3Clock[]) { return nothing_of_type(instance, count, __func__); }
fmi3Status fmi3SetClock(QUAYSIDE_FMI3_VR, const fmi3Clock[]) { return nothing_of_type(instance, count, __func__); }

// --- State
// ------------------------------------------------------------------------------------------------------------

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return guarded(instance, [&](FmuInstance& fmu) {
    UnitState saved = fmu.save();
    if (*state) {
      state_of(*state) = std::move(saved);
    } else {
      *state = new UnitState(std::move(saved));
    }
  });
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  return guarded(instance, [&](FmuInstance& fmu) { fmu.restore(state_of(state)); });
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return guarded(instance, [&](FmuInstance&) {
    if (*state) delete &state_of(*state);
    *state = nullptr;
  });
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, std::size_t* size) {
  return guarded(instance, [&](FmuInstance&) { *size = state_of(state).size(); });
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], std::size_t size) {
  return guarded(instance, [&](FmuInstance&) {
    if (size < state_of(state).size())
      throw std::invalid_argument("the state needs more bytes; ask for its size first");
    std::memcpy(bytes, state_of(state).data(), state_of(state).size());
  });
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], std::size_t size,
                                   fmi3FMUState* state) {
  return guarded(instance, [&](FmuInstance&) {
    const auto* first = reinterpret_cast<const std::byte*>(bytes);
    if (*state) {
      state_of(*state).assign(first, first + size);
    } else {
      *state = new UnitState(first, first + size);
    }
  });
}

// --- What this FMU does not offer
// -------------------------------------------------------------------------------------

#define QUAYSIDE_UNSUPPORTED(name, ...) \
  fmi3Status name(fmi3Instance instance, ##__VA_ARGS__) { return unsupported(instance, __func__); }
#define QUAYSIDE_UNSUPPORTED_VR(name, ...) \
  fmi3Status name(QUAYSIDE_FMI3_VR, ##__VA_ARGS__) { return unsupported(instance, __func__); }

QUAYSIDE_UNSUPPORTED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference, std::size_t*)
QUAYSIDE_UNSUPPORTED(fmi3GetVariableDependencies, fmi3ValueReference, std::size_t[], fmi3ValueReference[],
                     std::size_t[], fmi3DependencyKind[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3GetDirectionalDerivative, const fmi3ValueReference[], std::size_t, const fmi3ValueReference[],
                     std::size_t, const fmi3Float64[], std::size_t, fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3GetAdjointDerivative, const fmi3ValueReference[], std::size_t, const fmi3ValueReference[],
                     std::size_t, const fmi3Float64[], std::size_t, fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3EnterConfigurationMode)
QUAYSIDE_UNSUPPORTED(fmi3ExitConfigurationMode)
QUAYSIDE_UNSUPPORTED_VR(fmi3GetIntervalDecimal, fmi3Float64[], fmi3IntervalQualifier[])
QUAYSIDE_UNSUPPORTED_VR(fmi3GetIntervalFraction, fmi3UInt64[], fmi3UInt64[], fmi3IntervalQualifier[])
QUAYSIDE_UNSUPPORTED_VR(fmi3GetShiftDecimal, fmi3Float64[])
QUAYSIDE_UNSUPPORTED_VR(fmi3GetShiftFraction, fmi3UInt64[], fmi3UInt64[])
QUAYSIDE_UNSUPPORTED_VR(fmi3SetIntervalDecimal, const fmi3Float64[])
QUAYSIDE_UNSUPPORTED_VR(fmi3SetIntervalFraction, const fmi3UInt64[], const fmi3UInt64[])
QUAYSIDE_UNSUPPORTED_VR(fmi3SetShiftDecimal, const fmi3Float64[])
QUAYSIDE_UNSUPPORTED_VR(fmi3SetShiftFraction, const fmi3UInt64[], const fmi3UInt64[])
QUAYSIDE_UNSUPPORTED(fmi3EvaluateDiscreteStates)
QUAYSIDE_UNSUPPORTED(fmi3EnterContinuousTimeMode)
QUAYSIDE_UNSUPPORTED(fmi3CompletedIntegratorStep, fmi3Boolean, fmi3Boolean*, fmi3Boolean*)
QUAYSIDE_UNSUPPORTED(fmi3SetTime, fmi3Float64)
QUAYSIDE_UNSUPPORTED(fmi3SetContinuousStates, const fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3GetContinuousStateDerivatives, fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3GetEventIndicators, fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3GetContinuousStates, fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3GetNominalsOfContinuousStates, fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3GetNumberOfEventIndicators, std::size_t*)
QUAYSIDE_UNSUPPORTED(fmi3GetNumberOfContinuousStates, std::size_t*)
QUAYSIDE_UNSUPPORTED_VR(fmi3GetOutputDerivatives, const fmi3Int32[], fmi3Float64[], std::size_t)
QUAYSIDE_UNSUPPORTED(fmi3ActivateModelPartition, fmi3ValueReference, fmi3Float64)
