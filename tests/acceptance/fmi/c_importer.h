// A small importer that knows of an FMU what the standard says and nothing else: its archive, its model description,
// its C functions.
#pragma once

#include <dlfcn.h>
#include <tinyxml2.h>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "harness/fmi/archive.h"
#include "harness/fmi/fmi2.h"
#include "harness/fmi/fmi3.h"

namespace quayside::harness {

// An FMU, unpacked and loaded.
class ImportedFmu {
 public:
  explicit ImportedFmu(const std::filesystem::path& fmu) {
    unpack_archive(fmu, folder_.path());
    description.LoadFile((folder_.path() / "modelDescription.xml").c_str());
    const auto* root = description.RootElement();
    version = root->Attribute("fmiVersion")[0] - '0';
    token = root->Attribute(version == 2 ? "guid" : "instantiationToken");
    for (const auto* v = root->FirstChildElement("ModelVariables")->FirstChildElement(); v;
         v = v->NextSiblingElement()) {
      references[v->Attribute("name")] = v->UnsignedAttribute("valueReference");
      if (std::string(v->Attribute("causality")) != "output") continue;
      const char* type = version == 2 ? v->FirstChildElement()->Name() : v->Name();
      (std::string(type) == "Boolean" ? boolean_outputs : outputs).push_back(v->Attribute("name"));
    }
    const auto library = folder_.path() / "binaries" / (version == 2 ? "linux64" : "x86_64-linux") / "quayside_fmu.so";
    library_ = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library_) throw std::runtime_error(dlerror());
  }
  // The library stays: unloading what has thread-local and static parts of others is the loader's business.

  std::filesystem::path resources() const { return folder_.path() / "resources"; }
  void* symbol(const char* name) const { return dlsym(library_, name); }
  template <typename Function>
  Function* function(const char* name) const {
    void* found = symbol(name);
    if (!found) throw std::runtime_error(std::string("no function ") + name);
    return reinterpret_cast<Function*>(found);
  }
  unsigned at(const std::string& name) const { return references.at(name); }

  int version = 0;
  std::string token;
  tinyxml2::XMLDocument description;
  std::map<std::string, unsigned> references;
  std::vector<std::string> outputs, boolean_outputs;

 private:
  TemporaryFolder folder_;
  void* library_;
};

#define QUAYSIDE_CALL(fmu, name) (fmu).function<name##TYPE>(#name)

// An instance of an FMI 3.0 FMU; every status but OK throws with the last message.
class Instance3 {
 public:
  explicit Instance3(const ImportedFmu& fmu, bool event_mode = false) : fmu_(fmu) {
    instance_ = QUAYSIDE_CALL(fmu, fmi3InstantiateCoSimulation)("crane", fmu.token.c_str(),
                                                                (fmu.resources().string() + "/").c_str(), false, false,
                                                                event_mode, event_mode, nullptr, 0, this, log, nullptr);
    if (!instance_) throw std::runtime_error(message_);
    get_ = QUAYSIDE_CALL(fmu, fmi3GetFloat64);
    step_ = QUAYSIDE_CALL(fmu, fmi3DoStep);
  }
  ~Instance3() { QUAYSIDE_CALL(fmu_, fmi3FreeInstance)(instance_); }
  Instance3(const Instance3&) = delete;
  Instance3& operator=(const Instance3&) = delete;

  fmi3Instance handle() const { return instance_; }
  const std::string& message() const { return message_; }
  void check(fmi3Status status) const {
    if (status != fmi3OK) throw std::runtime_error(message_);
  }
  void initialize(double start = 0) {
    check(QUAYSIDE_CALL(fmu_, fmi3EnterInitializationMode)(instance_, false, 0, start, false, 0));
    check(QUAYSIDE_CALL(fmu_, fmi3ExitInitializationMode)(instance_));
  }
  struct Step {
    bool event, terminate, early;
    double reached;
  };
  Step step(double from, double to) {
    Step result{};
    check(step_(instance_, from, to - from, true, &result.event, &result.terminate, &result.early, &result.reached));
    return result;
  }
  double get(const std::string& name) const {
    const fmi3ValueReference reference = fmu_.at(name);
    double value = 0;
    check(get_(instance_, &reference, 1, &value, 1));
    return value;
  }
  std::vector<double> all() const {
    std::vector<fmi3ValueReference> references;
    for (const std::string& name : fmu_.outputs) references.push_back(fmu_.at(name));
    std::vector<double> values(references.size());
    check(get_(instance_, references.data(), references.size(), values.data(), values.size()));
    return values;
  }
  void set(const std::string& name, double value) {
    const fmi3ValueReference reference = fmu_.at(name);
    check(QUAYSIDE_CALL(fmu_, fmi3SetFloat64)(instance_, &reference, 1, &value, 1));
  }
  void set(const std::string& name, bool value) {
    const fmi3ValueReference reference = fmu_.at(name);
    check(QUAYSIDE_CALL(fmu_, fmi3SetBoolean)(instance_, &reference, 1, &value, 1));
  }
  std::vector<fmi3Byte> save() {
    fmi3FMUState state = nullptr;
    check(QUAYSIDE_CALL(fmu_, fmi3GetFMUState)(instance_, &state));
    std::size_t size = 0;
    check(QUAYSIDE_CALL(fmu_, fmi3SerializedFMUStateSize)(instance_, state, &size));
    std::vector<fmi3Byte> bytes(size);
    check(QUAYSIDE_CALL(fmu_, fmi3SerializeFMUState)(instance_, state, bytes.data(), size));
    check(QUAYSIDE_CALL(fmu_, fmi3FreeFMUState)(instance_, &state));
    return bytes;
  }
  void restore(const std::vector<fmi3Byte>& bytes) {
    fmi3FMUState state = nullptr;
    check(QUAYSIDE_CALL(fmu_, fmi3DeserializeFMUState)(instance_, bytes.data(), bytes.size(), &state));
    const fmi3Status status = QUAYSIDE_CALL(fmu_, fmi3SetFMUState)(instance_, state);
    check(QUAYSIDE_CALL(fmu_, fmi3FreeFMUState)(instance_, &state));
    check(status);
  }

 private:
  static void log(fmi3InstanceEnvironment self, fmi3Status, fmi3String, fmi3String message) {
    static_cast<Instance3*>(self)->message_ = message;
  }

  const ImportedFmu& fmu_;
  fmi3Instance instance_;
  std::string message_;
  fmi3GetFloat64TYPE* get_;
  fmi3DoStepTYPE* step_;
};

}  // namespace quayside::harness
