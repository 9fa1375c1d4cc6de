// A foreign FMU as a unit: what is loaded, what is refused and why, and what becomes of an FMU's errors.
#include <gtest/gtest.h>
#include <zip.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "cases/case.h"
#include "harness/fmi/fmu_unit.h"
#include "harness/run.h"

namespace quayside::harness {
namespace {

namespace fs = std::filesystem;

constexpr Time kStep = 100'000'000;  // 0.1 s
constexpr double kDegree = M_PI / 180;

const char* const kDescription = R"(<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="integrator" instantiationToken="{integrator}">
  <CoSimulation modelIdentifier="integrator" canGetAndSetFMUState="true" canSerializeFMUState="true"/>
  <UnitDefinitions>
    <Unit name="deg"><BaseUnit rad="1" factor="0.017453292519943295"/></Unit>
    <Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>
  </UnitDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="u" valueReference="1" causality="input" start="0" unit="m/s"/>
    <Float64 name="y" valueReference="2" causality="output" unit="deg"/>
    <Float64 name="gain" valueReference="3" causality="parameter" variability="fixed" start="1"/>
    <Int32 name="misbehave" valueReference="4" causality="parameter" variability="fixed" start="0"/>
    <Boolean name="holding" valueReference="5" causality="input" start="false"/>
    <String name="label" valueReference="6" causality="parameter" variability="fixed"><Start value="x"/></String>
  </ModelVariables>
  <ModelStructure><Output valueReference="2"/><InitialUnknown valueReference="2"/></ModelStructure>
</fmiModelDescription>
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

class Import : public testing::Test {
 protected:
  fs::path fmu(const std::string& description = kDescription, const fs::path& library = QUAYSIDE_TEST_FMU,
               std::vector<ArchiveEntry> more = {}) {
    const fs::path file = folder_.path() / ("test" + std::to_string(++files_) + ".fmu");
    more.push_back({"modelDescription.xml", description, {}});
    if (!library.empty()) more.push_back({"binaries/x86_64-linux/integrator.so", "", library});
    write_archive(file, more);
    return file;
  }
  std::string refusal(const fs::path& file, const std::vector<std::pair<std::string, double>>& parameters = {}) {
    try {
      FmuUnit("valve", file, parameters);
      return "";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).rfind("unit valve: " + file.string() + ": ", 0), 0u) << error.what();
      return error.what();
    }
  }
  void expect_refused(const fs::path& file, const std::string& reason) {
    const std::string message = refusal(file);
    EXPECT_NE(message.find(reason), std::string::npos) << "'" << message << "' should say: " << reason;
  }
  static ValueReference find(const Unit& unit, const std::string& name) {
    for (ValueReference i = 0; i < unit.variables().size(); ++i) {
      if (unit.variables()[i].name == name) return i;
    }
    throw std::invalid_argument(name);
  }
  static void initialize(Unit& unit) {
    unit.enter_initialization_mode(0);
    unit.exit_initialization_mode();
    unit.enter_step_mode();
  }

  TemporaryFolder folder_;
  int files_ = 0;
};

// y = gain · u · t degrees = 2 · 3 · 0.4; the unit shows radians, and hides what is no signal of numbers or booleans.
TEST_F(Import, RunsAnFmuInSiUnits) {
  FmuUnit unit("valve", fmu(), {{"gain", 2}});
  ASSERT_EQ(unit.variables().size(), 5u);
  EXPECT_EQ(unit.variables()[find(unit, "y")].unit, "rad");
  EXPECT_EQ(unit.variables()[find(unit, "u")].unit, "m/s");
  EXPECT_EQ(unit.variables()[find(unit, "holding")].type, Type::boolean);
  initialize(unit);
  unit.set(find(unit, "u"), 3);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(unit.do_step(i * kStep, kStep).time, (i + 1) * kStep);
  EXPECT_NEAR(unit.get(find(unit, "y")), 2.4 * kDegree, 1e-15);
  const UnitState saved = unit.save();
  unit.do_step(4 * kStep, kStep);
  unit.set(find(unit, "holding"), 1);
  unit.do_step(5 * kStep, kStep);
  EXPECT_NEAR(unit.get(find(unit, "y")), 3.0 * kDegree, 1e-15);
  unit.restore(saved);
  EXPECT_NEAR(unit.get(find(unit, "y")), 2.4 * kDegree, 1e-15);
  EXPECT_EQ(unit.do_step(4 * kStep, kStep).time, 5 * kStep);
}

TEST_F(Import, RefusesBadFmusWithTheReason) {
  const std::string good = kDescription;
  EXPECT_EQ(refusal(fmu()), "");
  expect_refused(folder_.path() / "none.fmu", "no such file");
  const fs::path text = folder_.path() / "text.fmu";
  std::ofstream(text) << "no archive at all";
  expect_refused(text, "no zip archive");
  expect_refused(fmu(good, ""), "integrator.so is missing");
  expect_refused(fmu(good, text), "cannot be loaded");
  expect_refused(fmu(good, "/lib/x86_64-linux-gnu/libz.so.1"), "no function fmi3InstantiateCoSimulation");
  expect_refused(fmu(replaced(good, "{integrator}", "{other}")), "what a token");
  expect_refused(fmu(good.substr(0, 300)), "modelDescription.xml");
  expect_refused(fmu(replaced(good, "fmiModelDescription fmi", "somethingElse fmi")), "modelDescription.xml");
  expect_refused(fmu(replaced(good, "\"3.0\"", "\"1.0\"")), "fmiVersion is '1.0'");
  expect_refused(fmu(replaced(good, "<CoSimulation ", "<ModelExchange ")), "no CoSimulation");
  expect_refused(fmu(replaced(good, "modelIdentifier=\"integrator\"", "modelIdentifier=\"../../integrator\"")),
                 "modelIdentifier");
  expect_refused(fmu(replaced(good, "name=\"gain\"", "name=\"y\"")), "two variables are called 'y'");
  EXPECT_NE(refusal(fmu(), {{"gian", 1}}).find("gain"), std::string::npos) << "the nearest name";
}

TEST_F(Import, LetsNothingOutOfItsFolder) {
  for (const std::string name : {"../evil", "a/../../evil", "/tmp/evil", "..\\evil", "C:evil"}) {
    expect_refused(fmu(kDescription, QUAYSIDE_TEST_FMU, {{name, "evil", {}}}), "would leave the folder");
  }
  const fs::path link = fmu();
  zip_t* archive = zip_open(link.c_str(), 0, nullptr);
  const zip_int64_t index = zip_file_add(archive, "resources", zip_source_buffer(archive, "/etc", 4, 0), 0);
  zip_file_set_external_attributes(archive, index, 0, ZIP_OPSYS_UNIX, 0120777u << 16);
  ASSERT_EQ(zip_close(archive), 0);
  expect_refused(link, "is a link");
}

TEST_F(Import, ErrorsCarryUnitAndTime) {
  const auto failure = [&](double misbehave) {
    FmuUnit unit("valve", fmu(), {{"misbehave", misbehave}});
    initialize(unit);
    for (int i = 0; i < 4; ++i) unit.do_step(i * kStep, kStep);
    try {
      const StepResult result = unit.do_step(4 * kStep, kStep);
      EXPECT_TRUE(result.terminate);
      return std::string("terminated");
    } catch (const StepFailed& error) {
      EXPECT_NE(std::string(error.what()).find("valve stopped at 0.4"), std::string::npos) << error.what();
      return std::string(error.what());
    }
  };
  EXPECT_NE(failure(1).find("fmi3DoStep returned error: the valve is stuck"), std::string::npos);
  EXPECT_NE(failure(2).find("its output y is nan"), std::string::npos);
  EXPECT_EQ(failure(3), "terminated");
  EXPECT_NE(failure(4).find("not allowed"), std::string::npos);
}

// Whatever the FMU does to its process, the harness lives, says who, when, in which call and what, and goes on working.
TEST_F(Import, CrashesAreErrorsWithUnitAndTime) {
  constexpr double kPatience = 2;  // [s]; every other step takes microseconds, on a busy machine perhaps a tenth of a second
  const auto failure = [&](double misbehave) {
    FmuUnit unit("valve", fmu(), {{"misbehave", misbehave}}, misbehave == 8 ? kPatience : FmuUnit::kPatience);
    initialize(unit);
    for (int i = 0; i < 4; ++i) unit.do_step(i * kStep, kStep);
    std::string words;
    try {
      unit.do_step(4 * kStep, kStep);
      ADD_FAILURE() << misbehave << " was no failure";
    } catch (const StepFailed& error) {
      words = error.what();
    }
    EXPECT_NE(words.find("valve stopped at 0.4"), std::string::npos) << words;
    const bool alive = misbehave == 9;  // what it throws arrives as an error
    if (!alive) EXPECT_THROW(unit.get(find(unit, "gain")), StepFailed) << "nothing is left to be read";
    return words;
  };
  EXPECT_NE(failure(5).find("it crashed in its step: Segmentation fault"), std::string::npos);
  EXPECT_NE(failure(6).find("it crashed in its step: Aborted"), std::string::npos);
  EXPECT_NE(failure(7).find("it ended its process in its step, with exit code 0"), std::string::npos);
  EXPECT_NE(failure(8).find("it did not come back from its step within 2 s"), std::string::npos);
  EXPECT_NE(failure(9).find("nobody catches this"), std::string::npos);
  EXPECT_NE(failure(10).find("it crashed in its step: Segmentation fault"), std::string::npos);

  { FmuUnit unit("valve", fmu(), {{"misbehave", 11}}); }  // crashes when it is freed: nobody waits for anything more
  try {
    FmuUnit("crash_at_load", fmu());
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("it crashed in being loaded: Segmentation fault"), std::string::npos) << error.what();
  }
}

TEST_F(Import, InstancesAreIndependent) {
  const fs::path file = fmu();
  FmuUnit first("first", file), second("second", file);
  for (FmuUnit* unit : {&first, &second}) initialize(*unit);
  first.set(find(first, "u"), 1);
  second.set(find(second, "u"), 2);
  for (int i = 0; i < 3; ++i) {
    for (FmuUnit* unit : {&first, &second}) unit->do_step(i * kStep, kStep);
  }
  EXPECT_NEAR(first.get(find(first, "y")), 0.3 * kDegree, 1e-15);
  EXPECT_NEAR(second.get(find(second, "y")), 0.6 * kDegree, 1e-15);
}

// --- As part of a case
// ------------------------------------------------------------------------------------------------

class InACase : public Import {
 protected:
  fs::path write_case(const std::string& text) {
    const fs::path file = folder_.path() / "case.yaml";
    std::ofstream(file) << text;
    return file;
  }
  static EngineRun run(const cases::Case& description) {
    RunOptions options;
    options.engines = {"simbody"};
    return std::move(run_case(description, options).engines.front());
  }
  static double value(const EngineRun& run, const std::string& name, std::size_t row) {
    for (std::size_t i = 0; i < run.trajectory.names.size(); ++i) {
      if (run.trajectory.names[i] == name) return run.trajectory.columns[i].at(row);
    }
    throw std::invalid_argument(name);
  }
};

const char* const kFall = R"(
title: A falling box drives an FMU
duration: 1
ground: false
bodies: [{name: box, size: [1, 1, 1], mass: 10, position: [0, 0, 50]}]
output: {interval: 0.1}
)";

// The FMU follows the box and sees its speed at the end of each step: y = Σ −g t_i h degrees, an Euler sum.
TEST_F(InACase, AnFmuGetsItsInputs) {
  const auto file = write_case(std::string(kFall) + "units: [{name: valve, fmu: " + fmu().filename().string() +
                               "}]\nconnections: [{from: box.velocity.z, to: valve.u}]\n");
  const EngineRun result = run(cases::load_case(file));
  ASSERT_FALSE(result.failure) << *result.failure;
  double expected = 0;
  for (int i = 1; i <= 10; ++i) {
    expected += -9.81 * (i * 0.1) * 0.1 * kDegree;
    EXPECT_NEAR(value(result, "valve.y", i), expected, 1e-6);  // the engine's own accuracy
  }
}

TEST_F(InACase, AnErrorEndsTheRunWithUnitAndTime) {
  const auto file = write_case(std::string(kFall) + "units: [{name: valve, fmu: " + fmu().filename().string() +
                               ", parameters: [{name: misbehave, value: 1}]}]\n");
  const EngineRun result = run(cases::load_case(file));
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->find("valve stopped at 0.4"), std::string::npos) << *result.failure;
  EXPECT_NE(result.failure->find("the valve is stuck"), std::string::npos) << *result.failure;
  EXPECT_EQ(result.trajectory.times.size(), 5u) << "what was simulated before is there";
}

TEST_F(InACase, ACrashEndsTheRunWithUnitAndTime) {
  const auto file = write_case(std::string(kFall) + "units: [{name: valve, fmu: " + fmu().filename().string() +
                               ", parameters: [{name: misbehave, value: 5}]}]\n");
  const EngineRun result = run(cases::load_case(file));
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->find("valve stopped at 0.4"), std::string::npos) << *result.failure;
  EXPECT_NE(result.failure->find("Segmentation fault"), std::string::npos) << *result.failure;
  EXPECT_EQ(result.trajectory.times.size(), 5u) << "what was simulated before is there";
}

// Masters that go back save and restore the FMU too. It holds its input over a step, at the mean of both ends with an
// iteration: then y is the integral of the speed of the fall to rounding, −½ g t² degrees.
TEST_F(InACase, AnFmuIsSteppedByTheMasterOfTheCase) {
  const auto text = [&](const std::string& method) {
    return std::string(kFall) + "units: [{name: valve, fmu: " + fmu().filename().string() +
           "}]\nconnections: [{from: box.velocity.z, to: valve.u}]\nmaster: {method: " + method + "}\n";
  };
  const EngineRun iterated = run(cases::load_case(write_case(text("iterated"))));
  ASSERT_FALSE(iterated.failure) << *iterated.failure;
  EXPECT_NEAR(value(iterated, "valve.y", 10), -0.5 * 9.81 * kDegree, 1e-6);
  const EngineRun jacobi = run(cases::load_case(write_case(text("jacobi"))));
  double expected = 0;
  for (int i = 0; i < 10; ++i) expected += -9.81 * (i * 0.1) * 0.1 * kDegree;
  EXPECT_NEAR(value(jacobi, "valve.y", 10), expected, 1e-6);
}

TEST_F(InACase, MastersThatGoBackRefuseAnFmuThatCannot) {
  const fs::path file = fmu(replaced(replaced(kDescription, "canGetAndSetFMUState=\"true\"", ""),
                                     "canSerializeFMUState=\"true\"", ""));
  const EngineRun result = run(cases::load_case(write_case(
      std::string(kFall) + "units: [{name: valve, fmu: " + file.filename().string() + "}]\nmaster: {method: iterated}\n")));
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->find("valve"), std::string::npos) << *result.failure;
  EXPECT_NE(result.failure->find("cannot serialize its state"), std::string::npos) << *result.failure;
  EXPECT_NE(result.failure->find("gauss_seidel"), std::string::npos) << *result.failure;
}

TEST_F(InACase, WrongConnectionsAreRefused) {
  const std::string unit = "units: [{name: valve, fmu: " + fmu().filename().string() + "}]\n";
  const auto refused = [&](const std::string& connection) {
    try {
      run(cases::load_case(write_case(std::string(kFall) + unit + "connections: [" + connection + "]\n")));
      return std::string();
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
  };
  EXPECT_NE(refused("{from: box.velocity.y, to: valve.uu}").find("no variable \"uu\""), std::string::npos);
  EXPECT_NE(refused("{from: box.position.y, to: valve.u}").find("units differ"), std::string::npos);
  EXPECT_NE(refused("{from: valve.u, to: valve.u}").find("not an output"), std::string::npos);
  EXPECT_NE(refused("{from: box.velocity.y, to: command.trolley}").find("trolley"), std::string::npos);
}

}  // namespace
}  // namespace quayside::harness
