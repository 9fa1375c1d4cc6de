// The 34 functions of FMI 2.0 for Co-Simulation. What the model description does not offer returns an error with a
// message.
#include <cstdlib>
#include <cstring>
#include <memory>

#include "harness/fmi/fmi2.h"
#include "harness/fmi/fmu_instance.h"

namespace {

using namespace quayside::harness;

// An instance, and what FMI 2.0 asks for later.
struct Instance2 : FmuInstance {
  using FmuInstance::FmuInstance;
  double start = 0;  // [s]
  FmuInstance::Step last;
};

Instance2& of(fmi2Component instance) { return *static_cast<Instance2*>(instance); }
UnitState& state_of(fmi2FMUstate state) { return *static_cast<UnitState*>(state); }

template <typename Action>
fmi2Status guarded(fmi2Component instance, Action action) {
  if (!instance) return fmi2Error;
  Instance2& fmu = of(instance);
  return static_cast<fmi2Status>(fmu.guarded([&] { action(fmu); }));
}

fmi2Status unsupported(fmi2Component instance, const char* function) {
  if (!instance) return fmi2Error;
  return static_cast<fmi2Status>(
      of(instance).fail(std::string(function) + " is not supported, as the model description tells"));
}

fmi2Status nothing_of_type(fmi2Component instance, std::size_t count, const char* function) {
  return count == 0 ? fmi2OK : unsupported(instance, function);
}

// "file:///a%20folder/resources" to a path.
std::string path_of(const std::string& uri) {
  std::string rest = uri;
  for (const char* prefix : {"file://localhost/", "file:///", "file:/"}) {
    if (rest.rfind(prefix, 0) == 0) {
      rest = "/" + rest.substr(std::strlen(prefix));
      break;
    }
  }
  std::string path;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] == '%' && i + 2 < rest.size()) {
      path += static_cast<char>(std::strtol(rest.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      path += rest[i];
    }
  }
  return path;
}

}  // namespace

const char* fmi2GetTypesPlatform() { return "default"; }
const char* fmi2GetVersion() { return "2.0"; }

fmi2Status fmi2SetDebugLogging(fmi2Component instance, fmi2Boolean on, std::size_t, const fmi2String[]) {
  return guarded(instance, [&](Instance2& fmu) { fmu.set_logging(on != 0); });
}

// --- Life cycle
// -------------------------------------------------------------------------------------------------------

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean, fmi2Boolean logging) {
  const std::string instance_name = name ? name : "";
  const auto logger = functions ? functions->logger : nullptr;
  const fmi2ComponentEnvironment environment = functions ? functions->componentEnvironment : nullptr;
  const auto say = [=](FmiStatus status, const char* category, const std::string& message) {
    if (logger)
      logger(environment, instance_name.c_str(), static_cast<fmi2Status>(status), category, "%s", message.c_str());
  };
  try {
    if (type != fmi2CoSimulation) throw std::invalid_argument("this FMU is for Co-Simulation, not for Model Exchange");
    return new Instance2(instance_name, token ? token : "", path_of(resources ? resources : ""), say, logging != 0);
  } catch (const std::exception& error) {
    say(FmiStatus::error, "error", error.what());
    return nullptr;
  }
}

void fmi2FreeInstance(fmi2Component instance) {
  if (instance) delete &of(instance);
}

fmi2Status fmi2SetupExperiment(fmi2Component instance, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean, fmi2Real) {
  return guarded(instance, [&](Instance2& fmu) { fmu.start = start; });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component instance) {
  return guarded(instance, [](Instance2& fmu) { fmu.unit().enter_initialization_mode(nanoseconds(fmu.start)); });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component instance) {
  return guarded(instance, [](Instance2& fmu) {
    fmu.unit().exit_initialization_mode();
    fmu.unit().enter_step_mode();
  });
}

fmi2Status fmi2DoStep(fmi2Component instance, fmi2Real now, fmi2Real step, fmi2Boolean) {
  return guarded(instance, [&](Instance2& fmu) { fmu.step(now, step, fmu.last); });
}

fmi2Status fmi2Terminate(fmi2Component instance) {
  return guarded(instance, [](Instance2& fmu) { fmu.unit().terminate(); });
}

fmi2Status fmi2Reset(fmi2Component instance) {
  return guarded(instance, [](Instance2& fmu) { fmu.unit().reset(); });
}

// --- Values
// -----------------------------------------------------------------------------------------------------------

fmi2Status fmi2GetReal(QUAYSIDE_FMI2_VR, fmi2Real values[]) {
  return guarded(instance, [&](Instance2& fmu) {
    for (std::size_t i = 0; i < count; ++i) values[i] = fmu.get(references[i], Type::float64);
  });
}

fmi2Status fmi2SetReal(QUAYSIDE_FMI2_VR, const fmi2Real values[]) {
  return guarded(instance, [&](Instance2& fmu) {
    for (std::size_t i = 0; i < count; ++i) fmu.set(references[i], Type::float64, values[i]);
  });
}

fmi2Status fmi2GetBoolean(QUAYSIDE_FMI2_VR, fmi2Boolean values[]) {
  return guarded(instance, [&](Instance2& fmu) {
    for (std::size_t i = 0; i < count; ++i) values[i] = fmu.get(references[i], Type::boolean) != 0;
  });
}

fmi2Status fmi2SetBoolean(QUAYSIDE_FMI2_VR, const fmi2Boolean values[]) {
  return guarded(instance, [&](Instance2& fmu) {
    for (std::size_t i = 0; i < count; ++i) fmu.set(references[i], Type::boolean, values[i] != 0);
  });
}

fmi2Status fmi2GetInteger(QUAYSIDE_FMI2_VR, fmi2Integer[]) { return nothing_of_type(instance, count, __func__); }
fmi2Status fmi2SetInteger(QUAYSIDE_FMI2_VR, const fmi2Integer[]) { return nothing_of_type(instance, count, __func__); }
fmi2Status fmi2GetString(QUAYSIDE_FMI2_VR, fmi2String[]) { return nothing_of_type(instance, count, __func__); }
fmi2Status fmi2SetString(QUAYSIDE_FMI2_VR, const fmi2String[]) { return nothing_of_type(instance, count, __func__); }

// --- State
// ------------------------------------------------------------------------------------------------------------

fmi2Status fmi2GetFMUstate(fmi2Component instance, fmi2FMUstate* state) {
  return guarded(instance, [&](Instance2& fmu) {
    UnitState saved = fmu.save();
    if (*state) {
      state_of(*state) = std::move(saved);
    } else {
      *state = new UnitState(std::move(saved));
    }
  });
}

fmi2Status fmi2SetFMUstate(fmi2Component instance, fmi2FMUstate state) {
  return guarded(instance, [&](Instance2& fmu) { fmu.restore(state_of(state)); });
}

fmi2Status fmi2FreeFMUstate(fmi2Component instance, fmi2FMUstate* state) {
  return guarded(instance, [&](Instance2&) {
    if (*state) delete &state_of(*state);
    *state = nullptr;
  });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component instance, fmi2FMUstate state, std::size_t* size) {
  return guarded(instance, [&](Instance2&) { *size = state_of(state).size(); });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component instance, fmi2FMUstate state, fmi2Byte bytes[], std::size_t size) {
  return guarded(instance, [&](Instance2&) {
    if (size < state_of(state).size())
      throw std::invalid_argument("the state needs more bytes; ask for its size first");
    std::memcpy(bytes, state_of(state).data(), state_of(state).size());
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component instance, const fmi2Byte bytes[], std::size_t size,
                                   fmi2FMUstate* state) {
  return guarded(instance, [&](Instance2&) {
    const auto* first = reinterpret_cast<const std::byte*>(bytes);
    if (*state) {
      state_of(*state).assign(first, first + size);
    } else {
      *state = new UnitState(first, first + size);
    }
  });
}

// --- Status: steps are never pending
// ----------------------------------------------------------------------------------

fmi2Status fmi2GetRealStatus(fmi2Component instance, const fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  return guarded(instance, [&](Instance2& fmu) { *value = fmu.last_time(); });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component instance, const fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return fmi2Discard;
  return guarded(instance, [&](Instance2& fmu) { *value = fmu.last.terminate; });
}

fmi2Status fmi2GetStatus(fmi2Component, const fmi2StatusKind, fmi2Status*) { return fmi2Discard; }
fmi2Status fmi2GetIntegerStatus(fmi2Component, const fmi2StatusKind, fmi2Integer*) { return fmi2Discard; }
fmi2Status fmi2GetStringStatus(fmi2Component, const fmi2StatusKind, fmi2String*) { return fmi2Discard; }

// --- What this FMU does not offer
// -------------------------------------------------------------------------------------

fmi2Status fmi2CancelStep(fmi2Component instance) { return unsupported(instance, __func__); }
fmi2Status fmi2GetDirectionalDerivative(fmi2Component instance, const fmi2ValueReference[], std::size_t,
                                        const fmi2ValueReference[], std::size_t, const fmi2Real[], fmi2Real[]) {
  return unsupported(instance, __func__);
}
fmi2Status fmi2SetRealInputDerivatives(QUAYSIDE_FMI2_VR, const fmi2Integer[], const fmi2Real[]) {
  return unsupported(instance, __func__);
}
fmi2Status fmi2GetRealOutputDerivatives(QUAYSIDE_FMI2_VR, const fmi2Integer[], fmi2Real[]) {
  return unsupported(instance, __func__);
}
