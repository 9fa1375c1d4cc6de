#include "harness/commands/case_options.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/build_scene.h"
#include "harness/drive_unit.h"
#include "harness/expectations.h"
#include "harness/fmi/fmu_unit.h"

namespace quayside::harness {

void CaseOptions::add_to(CLI::App& command) {
  command.add_option("--engine", engines, "Engines to run, separated by commas: simbody (Simbody with SUNDIALS), "
                                          "mujoco_same_law (our laws in MuJoCo), mujoco (its own tendons and contacts); default: all three")
      ->delimiter(',')
      ->check(CLI::IsMember(RunOptions().engines).description(""))
      ->type_name("NAME,...");
  command.add_option("--contact", contact_model, "Who finds where boxes touch, in place of the case's contact.model: "
                                                 "committee or exact")
      ->type_name("MODEL");
  command.add_option("--law", contact_law, "Which force follows, in place of the case's contact.law: potential, points, pads or learned")
      ->type_name("LAW");
  command.add_option("--integrator", integrator, "Of Simbody, in place of the case's solver.integrator: bdf (default) or adams "
                                                 "(CVODES), erk or dirk (ARKODE), merson, feldberg, rk3 or cpodes (its own)")
      ->type_name("NAME");
  command.add_option_function<std::string>(
             "--scene", [this](const std::string& scene) { full_scene = scene == "full"; },
             "reduced: model only what the script can move (default); full: everything")
      ->check(CLI::IsMember({"reduced", "full"}).description(""))
      ->type_name("reduced|full");
  command.add_option("--set", overrides, "Changes one value of the case, e.g. solver.relative_tolerance=1e-8 or "
                                         "containers.load.mass=20000; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY.PATH=VALUE");
}

cases::Case CaseOptions::load(const std::filesystem::path& file) const {
  for (const std::string& engine : engines)
    if (std::count(engines.begin(), engines.end(), engine) > 1)
      throw std::invalid_argument(fmt::format("--engine: {} is named twice, expected every engine once", engine));
  std::vector<std::string> all = overrides;
  if (!contact_model.empty()) all.push_back("contact.model=" + contact_model);
  if (!contact_law.empty()) all.push_back("contact.law=" + contact_law);
  if (!integrator.empty()) all.push_back("solver.integrator=" + integrator);
  cases::Case description = cases::load_case(file, all);
  std::vector<std::string> signals;
  for (const Variable& output : case_variables(description).outputs) signals.push_back(output.name);
  check_expectations(description, signals);
  return description;
}

RunOptions CaseOptions::run_options() const {
  RunOptions options;
  options.engines = engines;
  options.full_scene = full_scene;
  return options;
}

std::vector<std::filesystem::path> case_files(const std::vector<std::string>& paths) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (const std::string& path : paths) {
    std::error_code ignored;  // what is no directory is for the loader to judge
    if (!fs::is_directory(path, ignored)) {
      files.emplace_back(path);
      continue;
    }
    std::vector<fs::path> inside;
    for (const auto& entry : fs::directory_iterator(path))
      if (entry.path().extension() == ".yaml") inside.push_back(entry.path());
    if (inside.empty()) throw cases::CaseError(path + ": holds no case, expected files *.yaml");
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

CaseVariables case_variables(const cases::Case& description) {
  LeftOut left_out;  // of a large yard, which is never built as a whole
  const crane_models::Scene scene = build_scene(description, left_out);
  CaseVariables variables;
  for (const Variable& variable : engine_variables(scene)) {
    if (variable.causality == Causality::input) variables.inputs.push_back(variable);
    if (variable.causality == Causality::output) variables.outputs.push_back(variable);
  }
  const DriveUnit drives("drives", description, scene);
  for (const Variable& variable : drives.variables())
    if (variable.causality == Causality::output) variables.outputs.push_back(variable);
  for (const cases::UnitSpec& spec : description.units) {
    const FmuUnit unit(spec.name, spec.file, spec.parameters);
    for (Variable variable : unit.variables()) {
      if (variable.causality != Causality::output) continue;
      variable.name = spec.name + "." + variable.name;
      variables.outputs.push_back(variable);
    }
  }
  return variables;
}

}  // namespace quayside::harness
