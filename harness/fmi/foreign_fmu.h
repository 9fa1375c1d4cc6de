// The C functions of a foreign FMU of either version, loaded and called through one face.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "harness/fmi/read_description.h"

namespace quayside::harness {

// Every function but the destructor throws std::runtime_error with the function's name, the status and the FMU's own
// words for what is worse than a warning.
class ForeignFmu {
 public:
  struct Step {
    double reached = 0;  // [s]
    bool terminate = false;
  };

  virtual ~ForeignFmu() = default;
  virtual void enter_initialization_mode(double start) = 0;
  virtual void exit_initialization_mode() = 0;
  virtual Step step(double now, double step) = 0;
  virtual double get(const FmuVariable& variable) = 0;  // in the FMU's unit
  virtual void set(const FmuVariable& variable, double value) = 0;
  virtual UnitState save() = 0;
  virtual void restore(const UnitState& state) = 0;
  virtual void terminate() = 0;
  virtual void reset() = 0;
};

// Loads the library of an unpacked FMU and instantiates it. Throws std::invalid_argument for a library or function that
// is missing or cannot be loaded, and when the FMU refuses to be instantiated.
std::unique_ptr<ForeignFmu> load_foreign_fmu(const std::filesystem::path& folder, const FmuDescription& description,
                                             const std::string& instance);

}  // namespace quayside::harness
