#include "harness/fmi/foreign_fmu.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "harness/fmi/fmi2.h"
#include "harness/fmi/fmi3.h"

namespace quayside::harness {

namespace fs = std::filesystem;

namespace {

// A shared library with symbols of its own. RTLD_LOCAL hides its symbols from others; RTLD_DEEPBIND makes it and its
// own libraries prefer theirs to those of this program, whose libraries define functions that an FMU may well bring
// along in another version (SUNDIALS' for one). It stays loaded: destructors of an FMU that is gone are called by
// nobody.
class Library {
 public:
  explicit Library(const fs::path& file) {
    if (!fs::exists(file)) {
      throw std::invalid_argument(fmt::format("it has no binary for this platform: {} is missing",
                                              (file.parent_path().filename() / file.filename()).string()));
    }
    handle_ = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
    if (!handle_) throw std::invalid_argument(fmt::format("its library cannot be loaded: {}", dlerror()));
  }
  template <typename Function>
  void find(const char* name, Function*& function) const {
    function = reinterpret_cast<Function*>(dlsym(handle_, name));
    if (!function) throw std::invalid_argument(fmt::format("its library has no function {}", name));
  }

 private:
  void* handle_;
};

// What an FMU said last that was not good news.
struct Message {
  std::string text;
  std::string take() { return text.empty() ? "without a word" : std::exchange(text, {}); }
};

const char* status_name(int status) {
  constexpr std::array<const char*, 6> kNames{"ok", "warning", "discard", "error", "fatal", "pending"};
  return status >= 0 && status < static_cast<int>(kNames.size()) ? kNames[status] : "an unknown status";
}

constexpr int kWorstGoodStatus = 1;  // a warning

void check_status(int status, const char* function, Message& message) {
  if (status > kWorstGoodStatus || status < 0) {
    throw std::runtime_error(fmt::format("{} returned {}: {}", function, status_name(status), message.take()));
  }
}

#define QUAYSIDE_FUNCTION(name) name##TYPE* name = nullptr;
#define QUAYSIDE_FIND(name) library.find(#name, name);
#define QUAYSIDE_CHECK(function, ...) check_status(function(instance_, ##__VA_ARGS__), #function, message_)

// --- FMI 3.0
// ----------------------------------------------------------------------------------------------------------

#define QUAYSIDE_NEEDED3(X)                                                                                       \
  X(fmi3InstantiateCoSimulation)                                                                                  \
  X(fmi3FreeInstance) X(fmi3EnterInitializationMode) X(fmi3ExitInitializationMode) X(fmi3DoStep) X(fmi3Terminate) \
      X(fmi3Reset) X(fmi3GetFloat64) X(fmi3SetFloat64) X(fmi3GetBoolean) X(fmi3SetBoolean) X(fmi3GetInt32)        \
          X(fmi3SetInt32) X(fmi3GetFMUState) X(fmi3SetFMUState) X(fmi3FreeFMUState) X(fmi3SerializedFMUStateSize) \
              X(fmi3SerializeFMUState) X(fmi3DeserializeFMUState)

class ForeignFmu3 final : public ForeignFmu {
 public:
  ForeignFmu3(const Library& library, const fs::path& folder, const FmuDescription& description,
              const std::string& name) {
    QUAYSIDE_NEEDED3(QUAYSIDE_FIND)
    const std::string resources = (folder / "resources").string() + "/";
    // Without event mode the FMU deals with its events itself, and without early return it goes all the way.
    instance_ = fmi3InstantiateCoSimulation(name.c_str(), description.token.c_str(), resources.c_str(), false, false,
                                            false, false, nullptr, 0, &message_, log, nullptr);
    if (!instance_) throw std::invalid_argument("it refuses to be instantiated: " + message_.take());
  }
  ~ForeignFmu3() override { fmi3FreeInstance(instance_); }

  void enter_initialization_mode(double start) override {
    QUAYSIDE_CHECK(fmi3EnterInitializationMode, false, 0, start, false, 0);
  }
  void exit_initialization_mode() override { QUAYSIDE_CHECK(fmi3ExitInitializationMode); }
  Step step(double now, double step) override {
    bool event = false, terminate = false, early = false;
    double reached = now + step;
    QUAYSIDE_CHECK(fmi3DoStep, now, step, false, &event, &terminate, &early, &reached);
    return {early || terminate ? reached : now + step, terminate};
  }
  double get(const FmuVariable& variable) override {
    const fmi3ValueReference at = variable.reference;
    double number = 0;
    bool boolean = false;
    std::int32_t integer = 0;
    switch (variable.kind) {
      case FmuVariable::Kind::real:
        QUAYSIDE_CHECK(fmi3GetFloat64, &at, 1, &number, 1);
        return number;
      case FmuVariable::Kind::boolean:
        QUAYSIDE_CHECK(fmi3GetBoolean, &at, 1, &boolean, 1);
        return boolean;
      case FmuVariable::Kind::integer:
        QUAYSIDE_CHECK(fmi3GetInt32, &at, 1, &integer, 1);
        return integer;
    }
    return 0;
  }
  void set(const FmuVariable& variable, double value) override {
    const fmi3ValueReference at = variable.reference;
    const bool boolean = value != 0;
    const auto integer = static_cast<std::int32_t>(std::lround(value));
    switch (variable.kind) {
      case FmuVariable::Kind::real:
        QUAYSIDE_CHECK(fmi3SetFloat64, &at, 1, &value, 1);
        break;
      case FmuVariable::Kind::boolean:
        QUAYSIDE_CHECK(fmi3SetBoolean, &at, 1, &boolean, 1);
        break;
      case FmuVariable::Kind::integer:
        QUAYSIDE_CHECK(fmi3SetInt32, &at, 1, &integer, 1);
        break;
    }
  }
  UnitState save() override {
    fmi3FMUState state = nullptr;
    QUAYSIDE_CHECK(fmi3GetFMUState, &state);
    std::size_t size = 0;
    QUAYSIDE_CHECK(fmi3SerializedFMUStateSize, state, &size);
    UnitState bytes(size);
    QUAYSIDE_CHECK(fmi3SerializeFMUState, state, reinterpret_cast<fmi3Byte*>(bytes.data()), size);
    QUAYSIDE_CHECK(fmi3FreeFMUState, &state);
    return bytes;
  }
  void restore(const UnitState& bytes) override {
    fmi3FMUState state = nullptr;
    QUAYSIDE_CHECK(fmi3DeserializeFMUState, reinterpret_cast<const fmi3Byte*>(bytes.data()), bytes.size(), &state);
    QUAYSIDE_CHECK(fmi3SetFMUState, state);
    QUAYSIDE_CHECK(fmi3FreeFMUState, &state);
  }
  void terminate() override { QUAYSIDE_CHECK(fmi3Terminate); }
  void reset() override { QUAYSIDE_CHECK(fmi3Reset); }

 private:
  static void log(fmi3InstanceEnvironment message, fmi3Status status, fmi3String, fmi3String text) {
    if (status != fmi3OK && text) static_cast<Message*>(message)->text = text;
  }

  QUAYSIDE_NEEDED3(QUAYSIDE_FUNCTION)
  Message message_;
  fmi3Instance instance_ = nullptr;
};

// --- FMI 2.0
// ----------------------------------------------------------------------------------------------------------

#define QUAYSIDE_NEEDED2(X)                                                                                          \
  X(fmi2Instantiate)                                                                                                 \
  X(fmi2FreeInstance) X(fmi2SetupExperiment) X(fmi2EnterInitializationMode) X(fmi2ExitInitializationMode)            \
      X(fmi2DoStep) X(fmi2Terminate) X(fmi2Reset) X(fmi2GetReal) X(fmi2SetReal) X(fmi2GetBoolean) X(fmi2SetBoolean)  \
          X(fmi2GetInteger) X(fmi2SetInteger) X(fmi2GetFMUstate) X(fmi2SetFMUstate) X(fmi2FreeFMUstate)              \
              X(fmi2SerializedFMUstateSize) X(fmi2SerializeFMUstate) X(fmi2DeSerializeFMUstate) X(fmi2GetRealStatus) \
                  X(fmi2GetBooleanStatus)

std::string uri_of(const fs::path& folder) {
  std::string uri = "file://";
  for (const unsigned char c : folder.string()) {
    const bool plain = std::isalnum(c) || std::strchr("/._-~", c);
    uri += plain ? std::string(1, static_cast<char>(c)) : fmt::format("%{:02X}", c);
  }
  return uri;
}

class ForeignFmu2 final : public ForeignFmu {
 public:
  ForeignFmu2(const Library& library, const fs::path& folder, const FmuDescription& description,
              const std::string& name)
      : name_(name) {
    QUAYSIDE_NEEDED2(QUAYSIDE_FIND)
    callbacks_ = {log, std::calloc, std::free, nullptr, &message_};
    instance_ = fmi2Instantiate(name_.c_str(), fmi2CoSimulation, description.token.c_str(),
                                uri_of(folder / "resources").c_str(), &callbacks_, 0, 0);
    if (!instance_) throw std::invalid_argument("it refuses to be instantiated: " + message_.take());
  }
  ~ForeignFmu2() override { fmi2FreeInstance(instance_); }

  void enter_initialization_mode(double start) override {
    QUAYSIDE_CHECK(fmi2SetupExperiment, 0, 0, start, 0, 0);
    QUAYSIDE_CHECK(fmi2EnterInitializationMode);
  }
  void exit_initialization_mode() override { QUAYSIDE_CHECK(fmi2ExitInitializationMode); }
  Step step(double now, double step) override {
    const fmi2Status status = fmi2DoStep(instance_, now, step, 0);
    fmi2Boolean terminated = 0;
    if (status == fmi2Discard && fmi2GetBooleanStatus(instance_, fmi2Terminated, &terminated) == fmi2OK && terminated) {
      double reached = now;
      fmi2GetRealStatus(instance_, fmi2LastSuccessfulTime, &reached);
      return {reached, true};
    }
    check_status(status, "fmi2DoStep", message_);
    return {now + step, false};
  }
  double get(const FmuVariable& variable) override {
    const fmi2ValueReference at = variable.reference;
    double number = 0;
    int integer = 0;
    switch (variable.kind) {
      case FmuVariable::Kind::real:
        QUAYSIDE_CHECK(fmi2GetReal, &at, 1, &number);
        return number;
      case FmuVariable::Kind::boolean:
        QUAYSIDE_CHECK(fmi2GetBoolean, &at, 1, &integer);
        return integer != 0;
      case FmuVariable::Kind::integer:
        QUAYSIDE_CHECK(fmi2GetInteger, &at, 1, &integer);
        return integer;
    }
    return 0;
  }
  void set(const FmuVariable& variable, double value) override {
    const fmi2ValueReference at = variable.reference;
    const int boolean = value != 0, integer = static_cast<int>(std::lround(value));
    switch (variable.kind) {
      case FmuVariable::Kind::real:
        QUAYSIDE_CHECK(fmi2SetReal, &at, 1, &value);
        break;
      case FmuVariable::Kind::boolean:
        QUAYSIDE_CHECK(fmi2SetBoolean, &at, 1, &boolean);
        break;
      case FmuVariable::Kind::integer:
        QUAYSIDE_CHECK(fmi2SetInteger, &at, 1, &integer);
        break;
    }
  }
  UnitState save() override {
    fmi2FMUstate state = nullptr;
    QUAYSIDE_CHECK(fmi2GetFMUstate, &state);
    std::size_t size = 0;
    QUAYSIDE_CHECK(fmi2SerializedFMUstateSize, state, &size);
    UnitState bytes(size);
    QUAYSIDE_CHECK(fmi2SerializeFMUstate, state, reinterpret_cast<fmi2Byte*>(bytes.data()), size);
    QUAYSIDE_CHECK(fmi2FreeFMUstate, &state);
    return bytes;
  }
  void restore(const UnitState& bytes) override {
    fmi2FMUstate state = nullptr;
    QUAYSIDE_CHECK(fmi2DeSerializeFMUstate, reinterpret_cast<const fmi2Byte*>(bytes.data()), bytes.size(), &state);
    QUAYSIDE_CHECK(fmi2SetFMUstate, state);
    QUAYSIDE_CHECK(fmi2FreeFMUstate, &state);
  }
  void terminate() override { QUAYSIDE_CHECK(fmi2Terminate); }
  void reset() override { QUAYSIDE_CHECK(fmi2Reset); }

 private:
  static void log(fmi2ComponentEnvironment message, fmi2String, fmi2Status status, fmi2String, fmi2String format, ...) {
    if (status == fmi2OK || !format) return;
    std::array<char, 1000> text{};
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text.data(), text.size(), format, arguments);
    va_end(arguments);
    static_cast<Message*>(message)->text = text.data();
  }

  QUAYSIDE_NEEDED2(QUAYSIDE_FUNCTION)
  std::string name_;
  Message message_;
  fmi2CallbackFunctions callbacks_{};
  fmi2Component instance_ = nullptr;
};

}  // namespace

std::unique_ptr<ForeignFmu> load_foreign_fmu(const fs::path& folder, const FmuDescription& description,
                                             const std::string& instance) {
  const bool two = description.version == 2;
  const Library library(folder / "binaries" / (two ? "linux64" : "x86_64-linux") / (description.identifier + ".so"));
  if (two) return std::make_unique<ForeignFmu2>(library, folder, description, instance);
  return std::make_unique<ForeignFmu3>(library, folder, description, instance);
}

}  // namespace quayside::harness
