// The exported FMU, through the C interface alone: it runs as the case itself does, its state can be saved and
// restored, and its model description keeps the rules of the standard.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>

#include "cases/case.h"
#include "harness/fmi/export_fmu.h"
#include "harness/run.h"
#include "tests/acceptance/fmi/c_importer.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

const char* const kCase = "cases/land_on_stack.yaml";
constexpr double kInterval = 0.01;  // of the case's output [s]
constexpr int kSteps = 460;         // past the touchdown at 4.18 s, the hardest moment
const std::vector<std::string> kOverrides{"duration=4.6", "expect=[]"};

fs::path exported(FmiVersion version) {
  static const TemporaryFolder folder;
  const fs::path fmu = folder.path() / (version == FmiVersion::fmi2 ? "crane2.fmu" : "crane3.fmu");
  if (!fs::exists(fmu)) export_fmu(kCase, kOverrides, version, QUAYSIDE_FMU_LIBRARY, fmu);
  return fmu;
}

const ImportedFmu& crane() {
  static const ImportedFmu fmu(exported(FmiVersion::fmi3));
  return fmu;
}

const Recording& native() {
  static const Recording recording = [] {
    RunOptions options;
    options.engines = {"simbody"};
    options.full_scene = true;
    EngineRun run = std::move(run_case(cases::load_case(kCase, kOverrides), options).engines.front());
    EXPECT_FALSE(run.failure) << run.failure.value_or("");
    return run.trajectory;
  }();
  return recording;
}

// The same code takes the same steps: what differs is the way there. 1e-9 m is the promise; nothing here depends on
// more, so that energies of 1e6 J are compared relatively.
constexpr double kPromise = 1e-9;

void expect_native(const std::string& name, int row, double value) {
  for (std::size_t i = 0; i < native().names.size(); ++i) {
    if (native().names[i] != name) continue;
    const double expected = native().columns[i].at(row);
    EXPECT_NEAR(value, expected, kPromise * std::max(1.0, std::abs(expected))) << name << " in row " << row;
    return;
  }
  ADD_FAILURE() << name << " is no column of the native run";
}

TEST(ExportedFmu, RepeatsTheNativeRun) {
  Instance3 fmu(crane());
  fmu.initialize();
  ASSERT_EQ(crane().outputs.size() + crane().boolean_outputs.size(), native().names.size());
  for (int i = 0; i < kSteps; ++i) {
    fmu.step(i * kInterval, (i + 1) * kInterval);
    const std::vector<double> values = fmu.all();
    for (std::size_t k = 0; k < values.size(); ++k) expect_native(crane().outputs[k], i + 1, values[k]);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_NEAR(fmu.get("time"), 4.6, 1e-12);
}

void ignore(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...) {}

TEST(ExportedFmu, RepeatsTheNativeRunByFmi2) {
  const ImportedFmu fmu(exported(FmiVersion::fmi2));
  fmi2CallbackFunctions callbacks{};
  callbacks.logger = ignore;
  const fmi2Component crane = QUAYSIDE_CALL(fmu, fmi2Instantiate)(
      "crane", fmi2CoSimulation, fmu.token.c_str(), ("file://" + fmu.resources().string()).c_str(), &callbacks, 0, 0);
  ASSERT_TRUE(crane);
  ASSERT_EQ(QUAYSIDE_CALL(fmu, fmi2SetupExperiment)(crane, 0, 0, 0, 0, 0), fmi2OK);
  ASSERT_EQ(QUAYSIDE_CALL(fmu, fmi2EnterInitializationMode)(crane), fmi2OK);
  ASSERT_EQ(QUAYSIDE_CALL(fmu, fmi2ExitInitializationMode)(crane), fmi2OK);
  const auto get_all = [&] {
    std::vector<fmi2ValueReference> references;
    for (const std::string& name : fmu.outputs) references.push_back(fmu.at(name));
    std::vector<double> values(references.size());
    EXPECT_EQ(QUAYSIDE_CALL(fmu, fmi2GetReal)(crane, references.data(), references.size(), values.data()), fmi2OK);
    return values;
  };
  const auto advance = [&](int from, int to) {
    for (int i = from; i < to; ++i)
      ASSERT_EQ(QUAYSIDE_CALL(fmu, fmi2DoStep)(crane, i * kInterval, kInterval, 1), fmi2OK);
  };
  advance(0, 430);
  const std::vector<double> values = get_all();
  for (std::size_t k = 0; k < values.size(); ++k) expect_native(fmu.outputs[k], 430, values[k]);

  fmi2FMUstate state = nullptr;
  ASSERT_EQ(QUAYSIDE_CALL(fmu, fmi2GetFMUstate)(crane, &state), fmi2OK);
  advance(430, kSteps);
  const std::vector<double> end = get_all();
  ASSERT_EQ(QUAYSIDE_CALL(fmu, fmi2SetFMUstate)(crane, state), fmi2OK);
  advance(430, kSteps);
  EXPECT_EQ(get_all(), end);
  ASSERT_EQ(QUAYSIDE_CALL(fmu, fmi2FreeFMUstate)(crane, &state), fmi2OK);
  EXPECT_EQ(QUAYSIDE_CALL(fmu, fmi2Terminate)(crane), fmi2OK);
  QUAYSIDE_CALL(fmu, fmi2FreeInstance)(crane);
}

// Two instances of one library, step by step in turn, one behind the other.
TEST(ExportedFmu, TwoInstancesDoNotDisturbEachOther) {
  Instance3 alone(crane()), first(crane()), second(crane());
  for (Instance3* instance : {&alone, &first, &second}) instance->initialize();
  for (int i = 0; i < kSteps; ++i) alone.step(i * kInterval, (i + 1) * kInterval);
  constexpr int kBehind = 30;
  for (int i = 0; i < kSteps + kBehind; ++i) {
    if (i < kSteps) first.step(i * kInterval, (i + 1) * kInterval);
    if (i >= kBehind) second.step((i - kBehind) * kInterval, (i - kBehind + 1) * kInterval);
  }
  EXPECT_EQ(first.all(), alone.all());
  EXPECT_EQ(second.all(), alone.all());
}

TEST(ExportedFmu, BranchesFromASavedStateAreTheSameToTheBit) {
  constexpr int kSaved = 415;  // the load is 4 cm above the stack: the branches hold the impact
  Instance3 fmu(crane());
  fmu.initialize();
  for (int i = 0; i < kSaved; ++i) fmu.step(i * kInterval, (i + 1) * kInterval);
  const std::vector<fmi3Byte> state = fmu.save();
  const auto go_on = [&](Instance3& instance) {
    for (int i = kSaved; i < kSteps; ++i) instance.step(i * kInterval, (i + 1) * kInterval);
    return instance.all();
  };
  const std::vector<double> continued = go_on(fmu);
  fmu.restore(state);
  EXPECT_EQ(fmu.save(), state);
  EXPECT_EQ(go_on(fmu), continued);
  fmu.restore(state);
  EXPECT_EQ(go_on(fmu), continued) << "the second time";

  Instance3 other(crane());  // never initialized: the state is all it has
  other.restore(state);
  EXPECT_EQ(go_on(other), continued);

  const TemporaryFolder folder;
  const fs::path state_file = folder.path() / "state", values_file = folder.path() / "values";
  std::ofstream(state_file, std::ios::binary)
      .write(reinterpret_cast<const char*>(state.data()), static_cast<std::streamsize>(state.size()));
  const std::string command = std::string(QUAYSIDE_CONTINUE_STATE) + " " + exported(FmiVersion::fmi3).string() + " " +
                              state_file.string() + " " + std::to_string(kSaved) + " " + std::to_string(kSteps) +
                              " 0.01 " + values_file.string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::vector<double> values(continued.size());
  std::ifstream(values_file, std::ios::binary)
      .read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(double)));
  EXPECT_EQ(values, continued) << "in another process";
}

TEST(ExportedFmu, RefusesStatesThatAreNotItsOwn) {
  Instance3 fmu(crane());
  fmu.initialize();
  std::vector<fmi3Byte> state = fmu.save();
  EXPECT_THROW(fmu.restore({}), std::runtime_error);
  std::vector<fmi3Byte> foreign = state;
  foreign[3] ^= 1;  // of the token that it begins with
  EXPECT_THROW(fmu.restore(foreign), std::runtime_error);
  EXPECT_NE(fmu.message().find("another FMU"), std::string::npos) << fmu.message();
  state.pop_back();
  EXPECT_THROW(fmu.restore(state), std::runtime_error);
}

TEST(ExportedFmu, StartsAgainAfterReset) {
  Instance3 fmu(crane());
  const auto run = [&] {
    fmu.initialize();
    for (int i = 0; i < 100; ++i) fmu.step(i * kInterval, (i + 1) * kInterval);
    return fmu.all();
  };
  const std::vector<double> first = run();
  fmu.check(QUAYSIDE_CALL(crane(), fmi3Reset)(fmu.handle()));
  EXPECT_EQ(run(), first);
}

// With event mode and early return, steps of a second end at the events: the end of the ramp at 0.4 / 0.6 s is
// announced.
TEST(ExportedFmu, ReturnsEarlyAtEvents) {
  Instance3 fmu(crane(), true);
  fmu.initialize();
  double next = -1, time = 0;
  const auto event_mode = [&] {
    bool needs = true, terminate, nominals, states, defined;
    while (needs) {
      fmu.check(QUAYSIDE_CALL(crane(), fmi3UpdateDiscreteStates)(fmu.handle(), &needs, &terminate, &nominals, &states,
                                                                 &defined, &next));
    }
    if (!defined) next = -1;
    fmu.check(QUAYSIDE_CALL(crane(), fmi3EnterStepMode)(fmu.handle()));
  };
  event_mode();
  EXPECT_NEAR(next, 0.4 / 0.6, 1e-9);
  int events = 0;
  while (time < 1.0) {
    const Instance3::Step step = fmu.step(time, 1.0);
    EXPECT_EQ(step.early, step.reached < 1.0);
    if (events == 0) EXPECT_EQ(step.reached, next);
    EXPECT_GT(step.reached, time);
    time = step.reached;
    if (step.event) {
      ++events;
      fmu.check(QUAYSIDE_CALL(crane(), fmi3EnterEventMode)(fmu.handle()));
      event_mode();
    }
  }
  EXPECT_GE(events, 1);
  // At 1 s the same as in steps of 10 ms, within what the integration is accurate to [m].
  for (std::size_t i = 0; i < native().names.size(); ++i) {
    if (native().names[i] == "load.position.z") EXPECT_NEAR(fmu.get("load.position.z"), native().columns[i][100], 1e-6);
  }
}

// The trolley reaches the speed it is asked for exactly (0.5 m/s at some 0.6 m/s², within 2 s); the hoist, asked for a
// speed that no hoist has, goes to its limit; and the script, which would lower the load, rests.
TEST(ExportedFmu, ObeysItsInputsWhenTheScriptRests) {
  Instance3 fmu(crane());
  fmu.set("script", false);
  fmu.initialize();
  fmu.set("command.trolley", 0.5);
  for (int i = 0; i < 200; ++i) fmu.step(i * kInterval, (i + 1) * kInterval);
  EXPECT_NEAR(fmu.get("trolley.velocity.y"), 0.5, 1e-12);
  EXPECT_EQ(fmu.get("hoist.rate"), 0);
  fmu.set("command.trolley", 0.0);
  fmu.set("command.hoist", 100.0);
  for (int i = 200; i < 800; ++i) fmu.step(i * kInterval, (i + 1) * kInterval);
  EXPECT_NEAR(fmu.get("trolley.velocity.y"), 0, 1e-12);
  EXPECT_LT(fmu.get("hoist.rate"), -0.5) << "a positive speed shortens the ropes";
  EXPECT_GT(fmu.get("hoist.rate"), -10) << "but not at 100 m/s";
}

TEST(ExportedFmu, SaysWhatIsWrong) {
  const ImportedFmu& fmu = crane();
  std::string said;
  const auto log = [](fmi3InstanceEnvironment said, fmi3Status, fmi3String, fmi3String message) {
    *static_cast<std::string*>(said) = message;
  };
  const std::string resources = fmu.resources().string();
  EXPECT_FALSE(QUAYSIDE_CALL(fmu, fmi3InstantiateCoSimulation)("a", "{wrong}", resources.c_str(), false, false, false,
                                                               false, nullptr, 0, &said, log, nullptr));
  EXPECT_NE(said.find("token"), std::string::npos) << said;
  EXPECT_FALSE(QUAYSIDE_CALL(fmu, fmi3InstantiateCoSimulation)("a", fmu.token.c_str(), "/nowhere", false, false, false,
                                                               false, nullptr, 0, &said, log, nullptr));
  EXPECT_NE(said.find("/nowhere"), std::string::npos) << said;
  EXPECT_FALSE(QUAYSIDE_CALL(fmu, fmi3InstantiateModelExchange)("a", fmu.token.c_str(), resources.c_str(), false, false,
                                                                &said, log));

  Instance3 instance(fmu);
  EXPECT_THROW(instance.step(0, 0.01), std::runtime_error) << "not initialized";
  instance.initialize();
  EXPECT_THROW(instance.step(1, 1.01), std::runtime_error) << "from another time";
  EXPECT_THROW(instance.step(0, -0.01), std::runtime_error) << "backwards";
  EXPECT_THROW(instance.set("load.position.z", 1.0), std::runtime_error) << "an output";
  EXPECT_THROW(instance.set("command.hoist", std::nan("")), std::runtime_error);
  instance.step(0, 0.01);  // none of this did any harm
  EXPECT_EQ(QUAYSIDE_CALL(fmu, fmi3SetTime)(instance.handle(), 0), fmi3Error);
  EXPECT_NE(instance.message().find("fmi3SetTime"), std::string::npos);
}

TEST(ExportedFmu, HasAllFunctionsOfBothStandards) {
  int fmi3 = 0, fmi2 = 0;
#define QUAYSIDE_COUNT3(result, name, parameters) fmi3 += crane().symbol(#name) != nullptr;
#define QUAYSIDE_COUNT2(result, name, parameters) fmi2 += crane().symbol(#name) != nullptr;
  QUAYSIDE_FMI3_FUNCTIONS(QUAYSIDE_COUNT3)
  QUAYSIDE_FMI2_FUNCTIONS(QUAYSIDE_COUNT2)
  EXPECT_EQ(fmi3, 75);
  EXPECT_EQ(fmi2, 34);

  // What else the library holds stays inside: the SUNDIALS that is found from here is the one that Simbody brings
  // along.
  Dl_info found{};
  ASSERT_TRUE(crane().symbol("N_VClone") && dladdr(crane().symbol("N_VClone"), &found));
  EXPECT_NE(std::string(found.dli_fname).find("libSimTKmath"), std::string::npos) << found.dli_fname;
}

// Back again: the FMU as a unit of another case, whose own scene is a box that falls and meets nothing.
class ImportedBack : public testing::TestWithParam<FmiVersion> {};
INSTANTIATE_TEST_SUITE_P(BothVersions, ImportedBack, testing::Values(FmiVersion::fmi2, FmiVersion::fmi3),
                         [](const auto& info) { return info.param == FmiVersion::fmi2 ? "Fmi2" : "Fmi3"; });

TEST_P(ImportedBack, RunsAsTheNativeRun) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "case.yaml";
  std::ofstream(file) << "title: A crane beside a falling box\nduration: 4.6\nground: false\n"
                         "bodies: [{name: box, size: [1, 1, 1], mass: 10, position: [0, 0, 500]}]\n"
                         "units: [{name: crane, fmu: "
                      << exported(GetParam()).string() << "}]\n";
  RunOptions options;
  options.engines = {"simbody"};
  const EngineRun run = std::move(run_case(cases::load_case(file), options).engines.front());
  ASSERT_FALSE(run.failure) << *run.failure;
  const Recording& trajectory = run.trajectory;
  ASSERT_EQ(trajectory.times.size(), native().times.size());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < trajectory.names.size(); ++i) {
    if (trajectory.names[i].rfind("crane.", 0) != 0) continue;
    ++compared;
    for (int row = 0; row <= kSteps && !HasFailure(); ++row) {
      expect_native(trajectory.names[i].substr(6), row, trajectory.columns[i][row]);
    }
  }
  EXPECT_EQ(compared, native().names.size());
}

// --- modelDescription.xml ------------------------------------------------------------------------------------------

struct Described {
  std::string name, type, causality, variability, initial, unit;
  unsigned reference;
  bool start;
};

std::vector<Described> variables(const ImportedFmu& fmu) {
  std::vector<Described> result;
  const auto text = [](const tinyxml2::XMLElement* element, const char* attribute) {
    const char* value = element->Attribute(attribute);
    return std::string(value ? value : "");
  };
  const auto* list = fmu.description.RootElement()->FirstChildElement("ModelVariables");
  for (const auto* v = list->FirstChildElement(); v; v = v->NextSiblingElement()) {
    const auto* type = fmu.version == 2 ? v->FirstChildElement() : v;
    result.push_back({text(v, "name"), type->Name(), text(v, "causality"), text(v, "variability"), text(v, "initial"),
                      text(type, "unit"), v->UnsignedAttribute("valueReference"), type->Attribute("start") != nullptr});
  }
  return result;
}

class ModelDescription : public testing::TestWithParam<FmiVersion> {};
INSTANTIATE_TEST_SUITE_P(BothVersions, ModelDescription, testing::Values(FmiVersion::fmi2, FmiVersion::fmi3),
                         [](const auto& info) { return info.param == FmiVersion::fmi2 ? "Fmi2" : "Fmi3"; });

TEST_P(ModelDescription, KeepsTheRules) {
  const ImportedFmu fmu(exported(GetParam()));
  const auto* root = fmu.description.RootElement();
  EXPECT_STREQ(root->Attribute("variableNamingConvention"), "structured");
  EXPECT_STREQ(root->FirstChildElement("CoSimulation")->Attribute("modelIdentifier"), "quayside_fmu");

  std::set<std::string> units;
  for (const auto* u = root->FirstChildElement("UnitDefinitions")->FirstChildElement(); u;
       u = u->NextSiblingElement()) {
    EXPECT_TRUE(units.insert(u->Attribute("name")).second);
    EXPECT_EQ(u->FirstChildElement("BaseUnit")->DoubleAttribute("factor"), 1) << "SI";
  }

  // A structured name: identifiers or quoted names, with dots between.
  const std::regex well_formed(R"(([A-Za-z_]\w*|'[^']+')(\.([A-Za-z_]\w*|'[^']+'))*)");
  const auto list = variables(fmu);
  std::set<std::string> names;
  std::set<unsigned> references;
  std::set<std::string> outputs;
  int independent = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Described& v = list[i];
    EXPECT_TRUE(names.insert(v.name).second) << v.name;
    EXPECT_TRUE(references.insert(v.reference).second) << v.name;
    EXPECT_TRUE(std::regex_match(v.name, well_formed)) << v.name;
    const bool boolean = v.type == "Boolean";
    EXPECT_TRUE(boolean || units.count(v.unit)) << v.name << " has the unit " << v.unit;
    EXPECT_EQ(v.start, v.causality == "input" || v.causality == "parameter") << v.name;
    if (boolean) EXPECT_NE(v.variability, "continuous") << v.name;
    if (v.causality == "parameter") EXPECT_EQ(v.variability, "fixed");
    if (v.causality == "output") {
      EXPECT_EQ(v.initial, "calculated") << v.name;
      outputs.insert(GetParam() == FmiVersion::fmi2 ? std::to_string(i + 1) : std::to_string(v.reference));
    }
    independent += v.causality == "independent";
  }
  EXPECT_EQ(independent, 1);
  EXPECT_GT(outputs.size(), 50u);
  for (const std::string name :
       {"load.position.z", "command.hoist", "command.trolley", "command.twistlocks", "script"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }

  // The model structure has every output, and every unknown of the initialization, once.
  const auto* structure = root->FirstChildElement("ModelStructure");
  const bool two = GetParam() == FmiVersion::fmi2;
  for (const char* kind : {"Output", "InitialUnknown"}) {
    std::set<std::string> found;
    const auto* first =
        two ? structure->FirstChildElement((std::string(kind) + "s").c_str())->FirstChildElement("Unknown")
            : structure->FirstChildElement(kind);
    for (; first; first = first->NextSiblingElement(two ? "Unknown" : kind)) {
      EXPECT_TRUE(found.insert(first->Attribute(two ? "index" : "valueReference")).second);
    }
    EXPECT_EQ(found, outputs) << kind;
  }
}

TEST(Terminals, NameVariablesThatExist) {
  const ImportedFmu& fmu = crane();
  tinyxml2::XMLDocument xml;
  ASSERT_EQ(xml.LoadFile((fmu.resources().parent_path() / "terminalsAndIcons/terminalsAndIcons.xml").c_str()),
            tinyxml2::XML_SUCCESS);
  std::set<std::string> terminals;
  const auto* list = xml.RootElement()->FirstChildElement("Terminals");
  for (const auto* t = list->FirstChildElement(); t; t = t->NextSiblingElement()) {
    terminals.insert(t->Attribute("name"));
    for (const auto* m = t->FirstChildElement(); m; m = m->NextSiblingElement()) {
      EXPECT_TRUE(fmu.references.count(m->Attribute("variableName"))) << m->Attribute("variableName");
    }
  }
  EXPECT_TRUE(terminals.count("command"));
  EXPECT_TRUE(terminals.count("load.pose"));
}

// Every library that the FMU's library needs is beside it, but for those that every Debian has.
TEST(Binaries, AreComplete) {
  const fs::path folder = crane().resources().parent_path() / "binaries/x86_64-linux";
  int libraries = 0;
  for (const auto& file : fs::directory_iterator(folder)) libraries += file.path().filename() != "quayside_fmu.so";
  EXPECT_GT(libraries, 8);
  const std::string outside = "ldd " + (folder / "quayside_fmu.so").string() + " | grep '=>' | grep -v '" +
                              folder.string() + "' | grep -qvE 'lib(c|m|dl|pthread|rt|stdc\\+\\+|gcc_s)\\.so'";
  EXPECT_NE(std::system(outside.c_str()), 0) << "a library is taken from the system";
  EXPECT_TRUE(fs::exists(crane().resources().parent_path() / "documentation/index.html"));
  EXPECT_TRUE(fs::exists(crane().resources().parent_path() / "documentation/licenses/license.txt"));
}

}  // namespace
}  // namespace quayside::harness
