// A foreign FMU in a process of its own: a crash, a call of exit or an endless loop there is an error here, in words, and
// what has been simulated up to then is not lost.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "harness/fmi/foreign_fmu.h"

namespace quayside::harness {

// As load_foreign_fmu, in a child of this process. Its functions throw std::runtime_error too when the FMU ends its process
// ("crashed in its step: Segmentation fault") or does not return within `patience` seconds; after that nothing but the
// destructor may follow. `description` must outlive the result.
//
// What is set travels with the next call, and the outputs come back with each step: a communication step costs two round
// trips, some 20 µs. What the FMU prints appears where this program prints.
std::unique_ptr<ForeignFmu> start_fmu_process(const std::filesystem::path& folder, const FmuDescription& description,
                                              const std::string& instance, double patience);

}  // namespace quayside::harness
