// A small FMU of FMI 3.0 for tests: y follows dy/dt = gain · u in degrees per second, and from 0.5 s on it can
// misbehave: 1: an error with words, 2: an output that is not finite, 3: a wish to end, 4: an early return nobody
// allowed, 5: a write to address 0, 6: an abort, 7: an exit, 8: an endless loop, 9: an exception, 10: a stack without end.
// 11 crashes when it is freed, an instance called "crash_at_load" when it is made.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <thread>

#include "harness/fmi/fmi3.h"

namespace {

enum Reference : fmi3ValueReference { kInput = 1, kOutput = 2, kGain = 3, kMisbehave = 4, kHolding = 5 };

struct Integrator {
  double input = 0, output = 0, gain = 1;
  std::int32_t misbehave = 0;
  bool holding = false;
  void* environment;
  fmi3LogMessageCallback log;
};

volatile int* volatile nowhere = nullptr;

double fall(double x) {
  volatile double deep[1000];
  deep[0] = x;
  return x < 0 ? 0 : fall(deep[0] + 1) + deep[0];
}

Integrator& of(fmi3Instance instance) { return *static_cast<Integrator*>(instance); }

}  // namespace

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, fmi3Boolean, const fmi3ValueReference[], std::size_t,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback) {
  if (std::strcmp(token, "{integrator}") != 0) {
    log(environment, fmi3Error, "error", "what a token");
    return nullptr;
  }
  if (std::strcmp(name, "crash_at_load") == 0) *nowhere = 1;
  auto* instance = new Integrator;
  instance->environment = environment;
  instance->log = log;
  return instance;
}
void fmi3FreeInstance(fmi3Instance instance) {
  if (of(instance).misbehave == 11) *nowhere = 1;
  delete &of(instance);
}
fmi3Status fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Float64) {
  return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance) { return fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance) { return fmi3OK; }
fmi3Status fmi3Reset(fmi3Instance instance) {
  of(instance).output = 0;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 now, fmi3Float64 step, fmi3Boolean, fmi3Boolean* event,
                      fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached) {
  Integrator& self = of(instance);
  *event = *terminate = *early = false;
  *reached = now + step;
  if (!self.holding) self.output += self.gain * self.input * step;
  if (now + step < 0.5) return fmi3OK;
  switch (self.misbehave) {
    case 1:
      self.log(self.environment, fmi3Error, "error", "the valve is stuck");
      return fmi3Error;
    case 2:
      self.output = std::numeric_limits<double>::quiet_NaN();
      break;
    case 3:
      *terminate = true;
      break;
    case 4:
      *early = true;
      *reached = now + step / 2;
      break;
    case 5:
      *nowhere = 1;
      break;
    case 6:
      std::abort();
    case 7:
      std::exit(0);
    case 8:
      while (true) std::this_thread::sleep_for(std::chrono::seconds(1));
    case 9:
      throw std::runtime_error("nobody catches this");
    case 10:
      self.output += fall(now);
      break;
  }
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(QUAYSIDE_FMI3_VR, fmi3Float64 values[], std::size_t) {
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = references[i] == kInput    ? of(instance).input
                : references[i] == kOutput ? of(instance).output
                                           : of(instance).gain;
  }
  return fmi3OK;
}
fmi3Status fmi3SetFloat64(QUAYSIDE_FMI3_VR, const fmi3Float64 values[], std::size_t) {
  for (std::size_t i = 0; i < count; ++i)
    (references[i] == kInput ? of(instance).input : of(instance).gain) = values[i];
  return fmi3OK;
}
fmi3Status fmi3GetBoolean(QUAYSIDE_FMI3_VR, fmi3Boolean values[], std::size_t) {
  *values = of(instance).holding;
  return fmi3OK;
}
fmi3Status fmi3SetBoolean(QUAYSIDE_FMI3_VR, const fmi3Boolean values[], std::size_t) {
  of(instance).holding = *values;
  return fmi3OK;
}
fmi3Status fmi3GetInt32(QUAYSIDE_FMI3_VR, fmi3Int32 values[], std::size_t) {
  *values = of(instance).misbehave;
  return fmi3OK;
}
fmi3Status fmi3SetInt32(QUAYSIDE_FMI3_VR, const fmi3Int32 values[], std::size_t) {
  of(instance).misbehave = *values;
  return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  *state = new double(of(instance).output);
  return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  of(instance).output = *static_cast<double*>(state);
  return fmi3OK;
}
fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState* state) {
  delete static_cast<double*>(*state);
  return fmi3OK;
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, std::size_t* size) {
  *size = sizeof(double);
  return fmi3OK;
}
fmi3Status fmi3SerializeFMUState(fmi3Instance, fmi3FMUState state, fmi3Byte bytes[], std::size_t) {
  std::memcpy(bytes, state, sizeof(double));
  return fmi3OK;
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance, const fmi3Byte bytes[], std::size_t, fmi3FMUState* state) {
  *state = new double;
  std::memcpy(*state, bytes, sizeof(double));
  return fmi3OK;
}
