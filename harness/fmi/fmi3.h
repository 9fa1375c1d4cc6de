// The C interface of FMI 3.0 for Co-Simulation and the rest of its 75 functions, declared from the standard
// (https://fmi-standard.org/docs/3.0/, sections 2.2 to 5.2): the types, and one table of the functions.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" {

using fmi3Instance = void*;
using fmi3InstanceEnvironment = void*;
using fmi3FMUState = void*;
using fmi3ValueReference = std::uint32_t;
using fmi3Float32 = float;
using fmi3Float64 = double;
using fmi3Int8 = std::int8_t;
using fmi3UInt8 = std::uint8_t;
using fmi3Int16 = std::int16_t;
using fmi3UInt16 = std::uint16_t;
using fmi3Int32 = std::int32_t;
using fmi3UInt32 = std::uint32_t;
using fmi3Int64 = std::int64_t;
using fmi3UInt64 = std::uint64_t;
using fmi3Boolean = bool;
using fmi3String = const char*;
using fmi3Byte = std::uint8_t;
using fmi3Binary = const fmi3Byte*;
using fmi3Clock = bool;

enum fmi3Status { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal };
enum fmi3DependencyKind { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent };
enum fmi3IntervalQualifier { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged };

using fmi3LogMessageCallback = void (*)(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                                        fmi3String message);
using fmi3ClockUpdateCallback = void (*)(fmi3InstanceEnvironment environment);
using fmi3IntermediateUpdateCallback = void (*)(fmi3InstanceEnvironment environment, fmi3Float64 time,
                                                fmi3Boolean set_requested, fmi3Boolean get_allowed,
                                                fmi3Boolean step_finished, fmi3Boolean can_return_early,
                                                fmi3Boolean* return_early, fmi3Float64* return_time);
using fmi3LockPreemptionCallback = void (*)();
using fmi3UnlockPreemptionCallback = void (*)();

}  // extern "C"

// FUNCTION(result, name, parameters) for every function, in the order of the standard. References and their number:
#define QUAYSIDE_FMI3_VR fmi3Instance instance, const fmi3ValueReference references[], std::size_t count
#define QUAYSIDE_FMI3_DERIVATIVE                                                                                     \
  (fmi3Instance instance, const fmi3ValueReference unknowns[], std::size_t unknown_count,                            \
   const fmi3ValueReference knowns[], std::size_t known_count, const fmi3Float64 seed[], std::size_t seed_count,     \
   fmi3Float64 sensitivity[], std::size_t sensitivity_count)

#define QUAYSIDE_FMI3_FUNCTIONS(FUNCTION)                                                                            \
  FUNCTION(const char*, fmi3GetVersion, ())                                                                          \
  FUNCTION(fmi3Status, fmi3SetDebugLogging, (fmi3Instance instance, fmi3Boolean on, std::size_t count, const         \
      fmi3String categories[]))                                                                                      \
  FUNCTION(fmi3Instance, fmi3InstantiateModelExchange, (fmi3String name, fmi3String token, fmi3String                \
      resources, fmi3Boolean visible, fmi3Boolean logging, fmi3InstanceEnvironment environment,                      \
      fmi3LogMessageCallback log))                                                                                   \
  FUNCTION(fmi3Instance, fmi3InstantiateCoSimulation, (fmi3String name, fmi3String token, fmi3String                 \
      resources, fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode_used, fmi3Boolean                  \
      early_return_allowed, const fmi3ValueReference intermediate[], std::size_t intermediate_count,                 \
      fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update))       \
  FUNCTION(fmi3Instance, fmi3InstantiateScheduledExecution, (fmi3String name, fmi3String token, fmi3String           \
      resources, fmi3Boolean visible, fmi3Boolean logging, fmi3InstanceEnvironment environment,                      \
      fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock_update, fmi3LockPreemptionCallback lock,             \
      fmi3UnlockPreemptionCallback unlock))                                                                          \
  FUNCTION(void, fmi3FreeInstance, (fmi3Instance instance))                                                          \
  FUNCTION(fmi3Status, fmi3EnterInitializationMode, (fmi3Instance instance, fmi3Boolean tolerance_defined,           \
      fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop))                         \
  FUNCTION(fmi3Status, fmi3ExitInitializationMode, (fmi3Instance instance))                                          \
  FUNCTION(fmi3Status, fmi3EnterEventMode, (fmi3Instance instance))                                                  \
  FUNCTION(fmi3Status, fmi3Terminate, (fmi3Instance instance))                                                       \
  FUNCTION(fmi3Status, fmi3Reset, (fmi3Instance instance))                                                           \
  FUNCTION(fmi3Status, fmi3GetFloat32, (QUAYSIDE_FMI3_VR, fmi3Float32 values[], std::size_t value_count))            \
  FUNCTION(fmi3Status, fmi3GetFloat64, (QUAYSIDE_FMI3_VR, fmi3Float64 values[], std::size_t value_count))            \
  FUNCTION(fmi3Status, fmi3GetInt8, (QUAYSIDE_FMI3_VR, fmi3Int8 values[], std::size_t value_count))                  \
  FUNCTION(fmi3Status, fmi3GetUInt8, (QUAYSIDE_FMI3_VR, fmi3UInt8 values[], std::size_t value_count))                \
  FUNCTION(fmi3Status, fmi3GetInt16, (QUAYSIDE_FMI3_VR, fmi3Int16 values[], std::size_t value_count))                \
  FUNCTION(fmi3Status, fmi3GetUInt16, (QUAYSIDE_FMI3_VR, fmi3UInt16 values[], std::size_t value_count))              \
  FUNCTION(fmi3Status, fmi3GetInt32, (QUAYSIDE_FMI3_VR, fmi3Int32 values[], std::size_t value_count))                \
  FUNCTION(fmi3Status, fmi3GetUInt32, (QUAYSIDE_FMI3_VR, fmi3UInt32 values[], std::size_t value_count))              \
  FUNCTION(fmi3Status, fmi3GetInt64, (QUAYSIDE_FMI3_VR, fmi3Int64 values[], std::size_t value_count))                \
  FUNCTION(fmi3Status, fmi3GetUInt64, (QUAYSIDE_FMI3_VR, fmi3UInt64 values[], std::size_t value_count))              \
  FUNCTION(fmi3Status, fmi3GetBoolean, (QUAYSIDE_FMI3_VR, fmi3Boolean values[], std::size_t value_count))            \
  FUNCTION(fmi3Status, fmi3GetString, (QUAYSIDE_FMI3_VR, fmi3String values[], std::size_t value_count))              \
  FUNCTION(fmi3Status, fmi3GetBinary, (QUAYSIDE_FMI3_VR, std::size_t sizes[], fmi3Binary values[], std::size_t       \
      value_count))                                                                                                  \
  FUNCTION(fmi3Status, fmi3GetClock, (QUAYSIDE_FMI3_VR, fmi3Clock values[]))                                         \
  FUNCTION(fmi3Status, fmi3SetFloat32, (QUAYSIDE_FMI3_VR, const fmi3Float32 values[], std::size_t                    \
      value_count))                                                                                                  \
  FUNCTION(fmi3Status, fmi3SetFloat64, (QUAYSIDE_FMI3_VR, const fmi3Float64 values[], std::size_t                    \
      value_count))                                                                                                  \
  FUNCTION(fmi3Status, fmi3SetInt8, (QUAYSIDE_FMI3_VR, const fmi3Int8 values[], std::size_t value_count))            \
  FUNCTION(fmi3Status, fmi3SetUInt8, (QUAYSIDE_FMI3_VR, const fmi3UInt8 values[], std::size_t value_count))          \
  FUNCTION(fmi3Status, fmi3SetInt16, (QUAYSIDE_FMI3_VR, const fmi3Int16 values[], std::size_t value_count))          \
  FUNCTION(fmi3Status, fmi3SetUInt16, (QUAYSIDE_FMI3_VR, const fmi3UInt16 values[], std::size_t value_count))        \
  FUNCTION(fmi3Status, fmi3SetInt32, (QUAYSIDE_FMI3_VR, const fmi3Int32 values[], std::size_t value_count))          \
  FUNCTION(fmi3Status, fmi3SetUInt32, (QUAYSIDE_FMI3_VR, const fmi3UInt32 values[], std::size_t value_count))        \
  FUNCTION(fmi3Status, fmi3SetInt64, (QUAYSIDE_FMI3_VR, const fmi3Int64 values[], std::size_t value_count))          \
  FUNCTION(fmi3Status, fmi3SetUInt64, (QUAYSIDE_FMI3_VR, const fmi3UInt64 values[], std::size_t value_count))        \
  FUNCTION(fmi3Status, fmi3SetBoolean, (QUAYSIDE_FMI3_VR, const fmi3Boolean values[], std::size_t                    \
      value_count))                                                                                                  \
  FUNCTION(fmi3Status, fmi3SetString, (QUAYSIDE_FMI3_VR, const fmi3String values[], std::size_t value_count))        \
  FUNCTION(fmi3Status, fmi3SetBinary, (QUAYSIDE_FMI3_VR, const std::size_t sizes[], const fmi3Binary values[],       \
      std::size_t value_count))                                                                                      \
  FUNCTION(fmi3Status, fmi3SetClock, (QUAYSIDE_FMI3_VR, const fmi3Clock values[]))                                   \
  FUNCTION(fmi3Status, fmi3GetNumberOfVariableDependencies, (fmi3Instance instance, fmi3ValueReference               \
      reference, std::size_t* count))                                                                                \
  FUNCTION(fmi3Status, fmi3GetVariableDependencies, (fmi3Instance instance, fmi3ValueReference dependent,            \
      std::size_t dependent_elements[], fmi3ValueReference independents[], std::size_t independent_elements[],       \
      fmi3DependencyKind kinds[], std::size_t count))                                                                \
  FUNCTION(fmi3Status, fmi3GetFMUState, (fmi3Instance instance, fmi3FMUState* state))                                \
  FUNCTION(fmi3Status, fmi3SetFMUState, (fmi3Instance instance, fmi3FMUState state))                                 \
  FUNCTION(fmi3Status, fmi3FreeFMUState, (fmi3Instance instance, fmi3FMUState* state))                               \
  FUNCTION(fmi3Status, fmi3SerializedFMUStateSize, (fmi3Instance instance, fmi3FMUState state, std::size_t*          \
      size))                                                                                                         \
  FUNCTION(fmi3Status, fmi3SerializeFMUState, (fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],          \
      std::size_t size))                                                                                             \
  FUNCTION(fmi3Status, fmi3DeserializeFMUState, (fmi3Instance instance, const fmi3Byte bytes[], std::size_t          \
      size, fmi3FMUState* state))                                                                                    \
  FUNCTION(fmi3Status, fmi3GetDirectionalDerivative, QUAYSIDE_FMI3_DERIVATIVE)                                       \
  FUNCTION(fmi3Status, fmi3GetAdjointDerivative, QUAYSIDE_FMI3_DERIVATIVE)                                           \
  FUNCTION(fmi3Status, fmi3EnterConfigurationMode, (fmi3Instance instance))                                          \
  FUNCTION(fmi3Status, fmi3ExitConfigurationMode, (fmi3Instance instance))                                           \
  FUNCTION(fmi3Status, fmi3GetIntervalDecimal, (QUAYSIDE_FMI3_VR, fmi3Float64 intervals[],                           \
      fmi3IntervalQualifier qualifiers[]))                                                                           \
  FUNCTION(fmi3Status, fmi3GetIntervalFraction, (QUAYSIDE_FMI3_VR, fmi3UInt64 counters[], fmi3UInt64                 \
      resolutions[], fmi3IntervalQualifier qualifiers[]))                                                            \
  FUNCTION(fmi3Status, fmi3GetShiftDecimal, (QUAYSIDE_FMI3_VR, fmi3Float64 shifts[]))                                \
  FUNCTION(fmi3Status, fmi3GetShiftFraction, (QUAYSIDE_FMI3_VR, fmi3UInt64 counters[], fmi3UInt64                    \
      resolutions[]))                                                                                                \
  FUNCTION(fmi3Status, fmi3SetIntervalDecimal, (QUAYSIDE_FMI3_VR, const fmi3Float64 intervals[]))                    \
  FUNCTION(fmi3Status, fmi3SetIntervalFraction, (QUAYSIDE_FMI3_VR, const fmi3UInt64 counters[], const                \
      fmi3UInt64 resolutions[]))                                                                                     \
  FUNCTION(fmi3Status, fmi3SetShiftDecimal, (QUAYSIDE_FMI3_VR, const fmi3Float64 shifts[]))                          \
  FUNCTION(fmi3Status, fmi3SetShiftFraction, (QUAYSIDE_FMI3_VR, const fmi3UInt64 counters[], const fmi3UInt64        \
      resolutions[]))                                                                                                \
  FUNCTION(fmi3Status, fmi3EvaluateDiscreteStates, (fmi3Instance instance))                                          \
  FUNCTION(fmi3Status, fmi3UpdateDiscreteStates, (fmi3Instance instance, fmi3Boolean* needs_update,                  \
      fmi3Boolean* terminate, fmi3Boolean* nominals_changed, fmi3Boolean* states_changed, fmi3Boolean*               \
      next_event_defined, fmi3Float64* next_event))                                                                  \
  FUNCTION(fmi3Status, fmi3EnterContinuousTimeMode, (fmi3Instance instance))                                         \
  FUNCTION(fmi3Status, fmi3CompletedIntegratorStep, (fmi3Instance instance, fmi3Boolean no_set_state,                \
      fmi3Boolean* enter_event_mode, fmi3Boolean* terminate))                                                        \
  FUNCTION(fmi3Status, fmi3SetTime, (fmi3Instance instance, fmi3Float64 time))                                       \
  FUNCTION(fmi3Status, fmi3SetContinuousStates, (fmi3Instance instance, const fmi3Float64 states[],                  \
      std::size_t count))                                                                                            \
  FUNCTION(fmi3Status, fmi3GetContinuousStateDerivatives, (fmi3Instance instance, fmi3Float64 values[],              \
      std::size_t count))                                                                                            \
  FUNCTION(fmi3Status, fmi3GetEventIndicators, (fmi3Instance instance, fmi3Float64 values[], std::size_t             \
      count))                                                                                                        \
  FUNCTION(fmi3Status, fmi3GetContinuousStates, (fmi3Instance instance, fmi3Float64 values[], std::size_t            \
      count))                                                                                                        \
  FUNCTION(fmi3Status, fmi3GetNominalsOfContinuousStates, (fmi3Instance instance, fmi3Float64 values[],              \
      std::size_t count))                                                                                            \
  FUNCTION(fmi3Status, fmi3GetNumberOfEventIndicators, (fmi3Instance instance, std::size_t* count))                  \
  FUNCTION(fmi3Status, fmi3GetNumberOfContinuousStates, (fmi3Instance instance, std::size_t* count))                 \
  FUNCTION(fmi3Status, fmi3EnterStepMode, (fmi3Instance instance))                                                   \
  FUNCTION(fmi3Status, fmi3GetOutputDerivatives, (QUAYSIDE_FMI3_VR, const fmi3Int32 orders[], fmi3Float64            \
      values[], std::size_t value_count))                                                                            \
  FUNCTION(fmi3Status, fmi3DoStep, (fmi3Instance instance, fmi3Float64 now, fmi3Float64 step, fmi3Boolean            \
      no_set_state, fmi3Boolean* event, fmi3Boolean* terminate, fmi3Boolean* early_return, fmi3Float64*              \
      reached))                                                                                                      \
  FUNCTION(fmi3Status, fmi3ActivateModelPartition, (fmi3Instance instance, fmi3ValueReference clock,                 \
      fmi3Float64 time))

#define QUAYSIDE_DECLARE(result, name, parameters) \
  extern "C" result name parameters;               \
  using name##TYPE = result parameters;
QUAYSIDE_FMI3_FUNCTIONS(QUAYSIDE_DECLARE)
#undef QUAYSIDE_DECLARE
