#include <algorithm>

#include <fmt/format.h>

#include "cases/case.h"
#include "cases/sections.h"

namespace quayside::cases {
namespace {

using namespace limits;

ContactSpec read_contact(const Value& value) {
  ContactSpec contact;
  const Mapping mapping =
      value.mapping({"model", "law", "stiffness", "restitution", "reference_speed", "friction", "network"});
  if (const auto model = mapping.find("model")) {
    contact.model = model->word({"committee", "exact"});
  }
  if (const auto law = mapping.find("law")) {
    contact.law = law->word({"potential", "points", "pads", "learned"});
  }
  mapping.number("stiffness", kStiffness, contact.stiffness);
  mapping.number("restitution", kRestitution, contact.restitution);
  mapping.number("reference_speed", kReferenceSpeed, contact.reference_speed);
  if (const auto friction = mapping.find("friction")) {
    if (friction->is_mapping()) {
      const Mapping law = friction->mapping({"coefficient", "law", "transition_speed"});
      contact.friction = law["coefficient"].number(kFriction);
      if (const auto name = law.find("law")) contact.friction_law = name->word({"regularised", "bristle"});
      law.number("transition_speed", kTransitionSpeed, contact.transition_speed);
    } else {
      contact.friction = friction->number(kFriction);
    }
  }
  if (const auto network = mapping.find("network")) contact.network = network->text();
  return contact;
}

SolverSpec read_solver(const Value& value) {
  SolverSpec solver;
  const Mapping mapping = value.mapping({"relative_tolerance", "max_step", "mujoco_step", "integrator", "mujoco_integrator", "free_bodies"});
  mapping.number("relative_tolerance", kRelativeTolerance, solver.relative_tolerance);
  mapping.number("max_step", kSolverStep, solver.max_step);
  mapping.number("mujoco_step", kSolverStep, solver.mujoco_step);
  if (const auto integrator = mapping.find("integrator")) {
    solver.integrator = integrator->word({"bdf", "adams", "erk", "dirk", "merson", "feldberg", "rk3", "cpodes"});
  }
  if (const auto integrator = mapping.find("mujoco_integrator")) {
    solver.mujoco_integrator = integrator->word({"rk4", "implicit", "euler"});
  }
  if (const auto free = mapping.find("free_bodies")) solver.free_bodies = free->word({"tree", "direct"});
  return solver;
}

UnitSpec read_unit(const Value& value) {
  UnitSpec unit;
  const Mapping mapping = value.mapping({"name", "fmu", "parameters", "timeout"});
  unit.name = mapping["name"].name();
  unit.fmu = mapping["fmu"].text();
  mapping.number("timeout", kTimeout, unit.timeout);
  if (const auto parameters = mapping.find("parameters")) {
    for (const Value& entry : parameters->list(kMaxEntries)) {
      const Mapping parameter = entry.mapping({"name", "value"});
      const Value number = parameter["value"];
      unit.parameters.emplace_back(parameter["name"].text(),
                                   number.is_number() ? number.number(kSignal) : number.boolean() ? 1.0 : 0.0);
    }
  }
  return unit;
}

MasterSpec read_master(const Value& value) {
  MasterSpec master;
  const Mapping mapping = value.mapping({"method", "tolerance", "relaxation"});
  master.method = mapping["method"].word({"jacobi", "gauss_seidel", "iterated", "error_controlled"});
  mapping.number("tolerance", kMasterTolerance, master.tolerance);
  mapping.number("relaxation", kRelaxation, master.relaxation);
  return master;
}

// A drive or command has one master: the script's line would be without effect.
void check_hand_over(const Value& line, const ScriptEntry& entry, const std::vector<ConnectionSpec>& connections) {
  const auto check = [&](const auto& orders) {
    for (const auto& order : orders) {
      for (const ConnectionSpec& connection : connections) {
        if (connection.to != "command." + order.first) continue;
        line.child(order.first.c_str()).refuse(fmt::format(
            "'{}' obeys the connection from '{}', expected no such key in the script, or no such connection", order.first,
            connection.from));
      }
    }
  };
  check(entry.speeds);
  check(entry.commands);
}

// Whether what is named exists only shows when the scene is built and the FMUs are loaded.
void read_units(const Mapping& root, Case& result) {
  if (const auto units = root.find("units")) {
    for (const Value& value : units->list(kMaxUnits)) {
      UnitSpec unit = read_unit(value);
      const auto taken = [&](const auto& other) { return other.name == unit.name; };
      if (unit.name == "command" || unit.name == "drives" || std::any_of(result.units.begin(), result.units.end(), taken) ||
          std::any_of(result.containers.begin(), result.containers.end(), taken) ||
          std::any_of(result.bodies.begin(), result.bodies.end(), taken)) {
        value.child("name").refuse(fmt::format("the name '{}' is taken, expected another name", unit.name));
      }
      result.units.push_back(std::move(unit));
    }
  }
  if (const auto connections = root.find("connections")) {
    for (const Value& value : connections->list(kMaxEntries)) {
      const Mapping mapping = value.mapping({"from", "to"});
      result.connections.push_back({mapping["from"].text(), mapping["to"].text()});
    }
  }
}

Case read_case(const Value& document) {
  Case result;
  const Mapping root =
      document.mapping({"title", "duration", "crane", "spreader", "mafi", "wind", "containers", "stacks", "bodies", "ground",
                        "gravity", "contact", "solver", "allow_overlap", "output", "units", "connections", "master",
                        "coupling", "script", "expect"});
  result.title = root["title"].text();
  result.duration = root["duration"].number(kDuration);
  if (const auto crane = root.find("crane")) result.crane = read_crane(*crane);
  if (const auto mafi = root.find("mafi")) result.mafi = read_mafi(*mafi);
  if (const auto wind = root.find("wind")) result.wind = read_wind(*wind);
  const Context context{result.crane.type != "none", result.mafi.has_value(), result.wind.has_value(), result.duration};

  if (const auto spreader = root.find("spreader")) result.spreader = read_spreader(*spreader, context);
  if (context.has_crane && !result.spreader)
    root["spreader"].expected("the spreader that hangs on the crane's ropes, e.g. {size: 40ft}");
  read_loads(root, context, result);
  const auto moves = [](const auto& object) { return !object.fixed; };
  if (!context.has_crane && !context.has_mafi && std::none_of(result.containers.begin(), result.containers.end(), moves) &&
      std::none_of(result.bodies.begin(), result.bodies.end(), moves)) {
    document.refuse("nothing in it can move, expected a crane, or a container or body that is not fixed");
  }

  root.boolean("ground", result.ground);
  root.vector<3>("gravity", kGravity, result.gravity);
  if (const auto contact = root.find("contact")) result.contact = read_contact(*contact);
  if (const auto solver = root.find("solver")) result.solver = read_solver(*solver);
  root.boolean("allow_overlap", result.allow_overlap);
  if (const auto output = root.find("output")) {
    const Value interval = output->mapping({"interval"})["interval"];
    result.output_interval = interval.number(kOutputInterval);
    if (result.output_interval > result.duration) {
      interval.refuse(fmt::format("longer than the run, expected at most the duration of {} s", result.duration));
    }
  }
  if (result.duration / result.output_interval > kMaxRows) {
    root["duration"].refuse(fmt::format(
        "{:.0f} rows of output at an interval of {} s, expected at most {:.0f}: set a longer output.interval",
        result.duration / result.output_interval, result.output_interval, kMaxRows));
  }
  read_units(root, result);
  if (const auto master = root.find("master")) result.master = read_master(*master);
  if (const auto coupling = root.find("coupling")) result.sampled_contact = coupling->word({"continuous", "sampled"}) == "sampled";
  if (const auto script = root.find("script")) {
    for (const Value& value : script->list(kMaxEntries)) {
      result.script.push_back(read_script_entry(value, context));
      check_hand_over(value, result.script.back(), result.connections);
    }
  }
  if (const auto expect = root.find("expect")) {
    for (const Value& value : expect->list(kMaxEntries))
      result.expectations.push_back(read_expectation(value, context));
  }
  return result;
}

Node effective_document(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  Node root = read_document(file);
  for (const std::string& text : overrides) apply_override(root, file, text);
  return root;
}

}  // namespace

std::string case_text(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return to_text(effective_document(file, overrides));
}

namespace {

Case case_of(const Node& root, const std::filesystem::path& file) {
  Case result = read_case(Value(file, root));
  for (UnitSpec& unit : result.units) unit.file = file.parent_path() / unit.fmu;
  result.file = file;
  result.text = to_text(root);
  result.name = file.stem().string();
  return result;
}

}  // namespace

Case load_case(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return case_of(effective_document(file, overrides), file);
}

Case parse_case(const std::string& text, const std::filesystem::path& file) { return case_of(read_document(text, file), file); }

}  // namespace quayside::cases
