// The C interface of FMI 2.0 for Co-Simulation, declared from the standard (https://fmi-standard.org/, FMI 2.0.4, sections
// 2.1 and 4.2): the types, and one table of the 34 functions.
#pragma once

#include <cstddef>

extern "C" {

using fmi2Component = void*;
using fmi2ComponentEnvironment = void*;
using fmi2FMUstate = void*;
using fmi2ValueReference = unsigned int;
using fmi2Real = double;
using fmi2Integer = int;
using fmi2Boolean = int;
using fmi2Char = char;
using fmi2String = const char*;
using fmi2Byte = char;

enum fmi2Status { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending };
enum fmi2Type { fmi2ModelExchange, fmi2CoSimulation };
enum fmi2StatusKind { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated };

struct fmi2CallbackFunctions {
  void (*logger)(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                 fmi2String message, ...);
  void* (*allocateMemory)(std::size_t count, std::size_t size);
  void (*freeMemory)(void* memory);
  void (*stepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);
  fmi2ComponentEnvironment componentEnvironment;
};

}  // extern "C"

// FUNCTION(result, name, parameters) for every function, in the order of the standard. References and their number:
#define QUAYSIDE_FMI2_VR fmi2Component instance, const fmi2ValueReference references[], std::size_t count

#define QUAYSIDE_FMI2_FUNCTIONS(FUNCTION)                                                                            \
  FUNCTION(const char*, fmi2GetTypesPlatform, ())                                                                    \
  FUNCTION(const char*, fmi2GetVersion, ())                                                                          \
  FUNCTION(fmi2Status, fmi2SetDebugLogging, (fmi2Component instance, fmi2Boolean on, std::size_t count, const        \
      fmi2String categories[]))                                                                                      \
  FUNCTION(fmi2Component, fmi2Instantiate, (fmi2String name, fmi2Type type, fmi2String token, fmi2String             \
      resources, const fmi2CallbackFunctions* functions, fmi2Boolean visible, fmi2Boolean logging))                  \
  FUNCTION(void, fmi2FreeInstance, (fmi2Component instance))                                                         \
  FUNCTION(fmi2Status, fmi2SetupExperiment, (fmi2Component instance, fmi2Boolean tolerance_defined, fmi2Real         \
      tolerance, fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop))                                           \
  FUNCTION(fmi2Status, fmi2EnterInitializationMode, (fmi2Component instance))                                        \
  FUNCTION(fmi2Status, fmi2ExitInitializationMode, (fmi2Component instance))                                         \
  FUNCTION(fmi2Status, fmi2Terminate, (fmi2Component instance))                                                      \
  FUNCTION(fmi2Status, fmi2Reset, (fmi2Component instance))                                                          \
  FUNCTION(fmi2Status, fmi2GetReal, (QUAYSIDE_FMI2_VR, fmi2Real values[]))                                           \
  FUNCTION(fmi2Status, fmi2GetInteger, (QUAYSIDE_FMI2_VR, fmi2Integer values[]))                                     \
  FUNCTION(fmi2Status, fmi2GetBoolean, (QUAYSIDE_FMI2_VR, fmi2Boolean values[]))                                     \
  FUNCTION(fmi2Status, fmi2GetString, (QUAYSIDE_FMI2_VR, fmi2String values[]))                                       \
  FUNCTION(fmi2Status, fmi2SetReal, (QUAYSIDE_FMI2_VR, const fmi2Real values[]))                                     \
  FUNCTION(fmi2Status, fmi2SetInteger, (QUAYSIDE_FMI2_VR, const fmi2Integer values[]))                               \
  FUNCTION(fmi2Status, fmi2SetBoolean, (QUAYSIDE_FMI2_VR, const fmi2Boolean values[]))                               \
  FUNCTION(fmi2Status, fmi2SetString, (QUAYSIDE_FMI2_VR, const fmi2String values[]))                                 \
  FUNCTION(fmi2Status, fmi2GetFMUstate, (fmi2Component instance, fmi2FMUstate* state))                               \
  FUNCTION(fmi2Status, fmi2SetFMUstate, (fmi2Component instance, fmi2FMUstate state))                                \
  FUNCTION(fmi2Status, fmi2FreeFMUstate, (fmi2Component instance, fmi2FMUstate* state))                              \
  FUNCTION(fmi2Status, fmi2SerializedFMUstateSize, (fmi2Component instance, fmi2FMUstate state, std::size_t*         \
      size))                                                                                                         \
  FUNCTION(fmi2Status, fmi2SerializeFMUstate, (fmi2Component instance, fmi2FMUstate state, fmi2Byte bytes[],         \
      std::size_t size))                                                                                             \
  FUNCTION(fmi2Status, fmi2DeSerializeFMUstate, (fmi2Component instance, const fmi2Byte bytes[], std::size_t         \
      size, fmi2FMUstate* state))                                                                                    \
  FUNCTION(fmi2Status, fmi2GetDirectionalDerivative, (fmi2Component instance, const fmi2ValueReference               \
      unknowns[], std::size_t unknown_count, const fmi2ValueReference knowns[], std::size_t known_count, const       \
      fmi2Real seed[], fmi2Real sensitivity[]))                                                                      \
  FUNCTION(fmi2Status, fmi2SetRealInputDerivatives, (QUAYSIDE_FMI2_VR, const fmi2Integer orders[], const             \
      fmi2Real values[]))                                                                                            \
  FUNCTION(fmi2Status, fmi2GetRealOutputDerivatives, (QUAYSIDE_FMI2_VR, const fmi2Integer orders[], fmi2Real         \
      values[]))                                                                                                     \
  FUNCTION(fmi2Status, fmi2DoStep, (fmi2Component instance, fmi2Real now, fmi2Real step, fmi2Boolean                 \
      no_set_state))                                                                                                 \
  FUNCTION(fmi2Status, fmi2CancelStep, (fmi2Component instance))                                                     \
  FUNCTION(fmi2Status, fmi2GetStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Status* value))        \
  FUNCTION(fmi2Status, fmi2GetRealStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Real*              \
      value))                                                                                                        \
  FUNCTION(fmi2Status, fmi2GetIntegerStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Integer*        \
      value))                                                                                                        \
  FUNCTION(fmi2Status, fmi2GetBooleanStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2Boolean*        \
      value))                                                                                                        \
  FUNCTION(fmi2Status, fmi2GetStringStatus, (fmi2Component instance, const fmi2StatusKind kind, fmi2String*          \
      value))

#define QUAYSIDE_DECLARE(result, name, parameters) \
  extern "C" result name parameters;               \
  using name##TYPE = result parameters;
QUAYSIDE_FMI2_FUNCTIONS(QUAYSIDE_DECLARE)
#undef QUAYSIDE_DECLARE
