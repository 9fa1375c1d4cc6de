#include "harness/fmi/write_description.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "harness/fmi/exported_case.h"
#include "harness/fmi/unit_of_measure.h"

namespace quayside::harness {

namespace {

constexpr double kDegreesPerRadian = 57.295779513082323;
constexpr double kStandardTolerance = 1e-6;

// An XML document that is written from its beginning to its end.
class Writer {
 public:
  Writer() { printer_.PushHeader(false, true); }
  Writer& open(const char* element) {
    printer_.OpenElement(element);
    return *this;
  }
  Writer& with(const char* attribute, const std::string& value) {
    printer_.PushAttribute(attribute, value.c_str());
    return *this;
  }
  Writer& with(const char* attribute, const char* value) {
    printer_.PushAttribute(attribute, value);
    return *this;
  }
  Writer& with(const char* attribute, double value) { return with(attribute, fmt::format("{}", value)); }
  Writer& with(const char* attribute, bool value) { return with(attribute, value ? "true" : "false"); }
  void close() { printer_.CloseElement(); }
  std::string text() const { return printer_.CStr(); }

 private:
  tinyxml2::XMLPrinter printer_;
};

const char* causality(const Variable& variable) {
  switch (variable.causality) {
    case Causality::parameter:
      return "parameter";
    case Causality::input:
      return "input";
    case Causality::output:
      return "output";
    case Causality::local:
      return "local";
  }
  return "";
}

const char* variability(const Variable& variable) {
  if (variable.causality == Causality::parameter) return "fixed";
  return variable.type == Type::boolean ? "discrete" : "continuous";
}

bool has_start(const Variable& variable) {
  return variable.causality == Causality::parameter || variable.causality == Causality::input;
}

void write_units(Writer& xml, const std::vector<Variable>& variables) {
  std::set<std::string> names{"s"};
  for (const Variable& variable : variables) {
    if (variable.type == Type::float64) names.insert(variable.unit);
  }
  xml.open("UnitDefinitions");
  for (const std::string& name : names) {
    const auto unit = unit_of_measure(name);
    if (!unit) throw std::logic_error(fmt::format("the unit '{}' has no entry in unit_of_measure.cpp", name));
    xml.open("Unit").with("name", name);
    xml.open("BaseUnit");
    for (std::size_t i = 0; i < unit->exponents.size(); ++i) {
      if (unit->exponents[i] != 0) xml.with(UnitOfMeasure::kBase[i], std::to_string(unit->exponents[i]));
    }
    xml.with("factor", unit->factor);
    xml.close();
    if (name == "rad") {
      xml.open("DisplayUnit").with("name", "deg").with("factor", kDegreesPerRadian);
      xml.close();
    }
    xml.close();
  }
  xml.close();
}

void write_experiment(Writer& xml, const cases::Case& description) {
  xml.open("LogCategories");
  for (const auto& [name, meaning] : {std::pair("error", "what went wrong, and what to change"),
                                      std::pair("events", "contacts, ropes and locks, with their times")}) {
    xml.open("Category").with("name", name).with("description", meaning);
    xml.close();
  }
  xml.close();
  xml.open("DefaultExperiment").with("startTime", 0.0).with("stopTime", description.duration);
  xml.with("tolerance", kStandardTolerance).with("stepSize", description.output_interval);
  xml.close();
}

std::string model_description_3(const DescriptionContents& contents) {
  Writer xml;
  xml.open("fmiModelDescription").with("fmiVersion", "3.0");
  xml.with("modelName", contents.description.title).with("instantiationToken", contents.token);
  xml.with("description", "Exported from a Quayside case").with("generationTool", "Quayside " QUAYSIDE_VERSION);
  xml.with("variableNamingConvention", "structured");
  xml.open("CoSimulation").with("modelIdentifier", kModelIdentifier);
  xml.with("canGetAndSetFMUState", true).with("canSerializeFMUState", true);
  xml.with("canHandleVariableCommunicationStepSize", true);
  xml.with("hasEventMode", true).with("mightReturnEarlyFromDoStep", true);
  xml.close();
  write_units(xml, contents.variables);
  write_experiment(xml, contents.description);

  xml.open("ModelVariables");
  xml.open("Float64").with("name", "time").with("valueReference", std::to_string(kTimeReference));
  xml.with("causality", "independent").with("variability", "continuous").with("unit", "s");
  xml.close();
  for (std::size_t i = 0; i < contents.variables.size(); ++i) {
    const Variable& variable = contents.variables[i];
    const bool number = variable.type == Type::float64;
    xml.open(number ? "Float64" : "Boolean").with("name", structured_name(variable.name));
    xml.with("valueReference", std::to_string(kFirstReference + i)).with("description", variable.description);
    xml.with("causality", causality(variable)).with("variability", variability(variable));
    if (variable.causality == Causality::output) xml.with("initial", "calculated");
    if (number) xml.with("unit", variable.unit);
    if (has_start(variable)) number ? xml.with("start", variable.start) : xml.with("start", variable.start != 0);
    xml.close();
  }
  xml.close();

  xml.open("ModelStructure");
  for (const char* kind : {"Output", "InitialUnknown"}) {
    for (std::size_t i = 0; i < contents.variables.size(); ++i) {
      if (contents.variables[i].causality != Causality::output) continue;
      xml.open(kind).with("valueReference", std::to_string(kFirstReference + i));
      xml.close();
    }
  }
  xml.close();
  xml.close();
  return xml.text();
}

std::string model_description_2(const DescriptionContents& contents) {
  Writer xml;
  xml.open("fmiModelDescription").with("fmiVersion", "2.0");
  xml.with("modelName", contents.description.title).with("guid", contents.token);
  xml.with("description", "Exported from a Quayside case").with("generationTool", "Quayside " QUAYSIDE_VERSION);
  xml.with("variableNamingConvention", "structured");
  xml.open("CoSimulation").with("modelIdentifier", kModelIdentifier);
  xml.with("canHandleVariableCommunicationStepSize", true).with("canNotUseMemoryManagementFunctions", true);
  xml.with("canGetAndSetFMUstate", true).with("canSerializeFMUstate", true);
  xml.close();
  write_units(xml, contents.variables);
  write_experiment(xml, contents.description);

  xml.open("ModelVariables");
  xml.open("ScalarVariable").with("name", "time").with("valueReference", std::to_string(kTimeReference));
  xml.with("causality", "independent").with("variability", "continuous");
  xml.open("Real").with("unit", "s");
  xml.close();
  xml.close();
  for (std::size_t i = 0; i < contents.variables.size(); ++i) {
    const Variable& variable = contents.variables[i];
    const bool number = variable.type == Type::float64;
    xml.open("ScalarVariable").with("name", structured_name(variable.name));
    xml.with("valueReference", std::to_string(kFirstReference + i)).with("description", variable.description);
    xml.with("causality", causality(variable)).with("variability", variability(variable));
    if (variable.causality == Causality::output) xml.with("initial", "calculated");
    xml.open(number ? "Real" : "Boolean");
    if (number) xml.with("unit", variable.unit);
    if (has_start(variable)) number ? xml.with("start", variable.start) : xml.with("start", variable.start != 0);
    xml.close();
    xml.close();
  }
  xml.close();

  xml.open("ModelStructure");
  for (const char* kind : {"Outputs", "InitialUnknowns"}) {
    xml.open(kind);
    for (std::size_t i = 0; i < contents.variables.size(); ++i) {
      if (contents.variables[i].causality != Causality::output) continue;
      constexpr std::size_t kBefore = 2;  // the index counts from 1, and time is the first
      xml.open("Unknown").with("index", std::to_string(i + kBefore));
      xml.close();
    }
    xml.close();
  }
  xml.close();
  xml.close();
  return xml.text();
}

std::string html(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return result;
}

}  // namespace

std::string structured_name(const std::string& name) {
  std::istringstream parts(name);
  std::string result;
  for (std::string part; std::getline(parts, part, '.');) {
    const auto inner = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
    const bool plain = !part.empty() && std::all_of(part.begin(), part.end(), inner) &&
                       !std::isdigit(static_cast<unsigned char>(part[0]));
    result += (result.empty() ? "" : ".") + (plain ? part : "'" + part + "'");
  }
  return result;
}

std::string model_description(FmiVersion version, const DescriptionContents& contents) {
  return version == FmiVersion::fmi2 ? model_description_2(contents) : model_description_3(contents);
}

std::string terminals(const std::vector<Variable>& variables) {
  // Name of the terminal; its members' names and variables.
  std::map<std::string, std::vector<std::pair<std::string, const Variable*>>> terminals;
  for (const Variable& variable : variables) {
    const std::string& name = variable.name;
    if (variable.causality == Causality::input) {
      terminals["command"].emplace_back(name.substr(name.find('.') + 1), &variable);
    }
    for (const char* part : {".position.", ".orientation."}) {
      const std::size_t at = name.find(part);
      if (at != std::string::npos) terminals[name.substr(0, at) + ".pose"].emplace_back(name.substr(at + 1), &variable);
    }
  }
  Writer xml;
  xml.open("fmiTerminalsAndIcons").with("fmiVersion", "3.0");
  xml.open("Terminals");
  for (const auto& [name, members] : terminals) {
    xml.open("Terminal").with("name", name).with("matchingRule", "plug");
    xml.with("description", name == "command" ? "what the operator asks of drives and locks; used while script is false"
                                              : "pose in the world: position and quaternion");
    for (const auto& [member, variable] : members) {
      xml.open("TerminalMemberVariable").with("variableName", structured_name(variable->name));
      xml.with("memberName", member).with("variableKind", "signal");
      xml.close();
    }
    xml.close();
  }
  xml.close();
  xml.close();
  return xml.text();
}

std::string documentation(const DescriptionContents& contents) {
  std::string rows;
  for (const Variable& variable : contents.variables) {
    rows += fmt::format("<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        html(structured_name(variable.name)), causality(variable),
                        variable.type == Type::boolean ? "boolean" : html(variable.unit), html(variable.description));
  }
  return fmt::format(R"(<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>{0}</title>
<style>body {{ font-family: sans-serif; max-width: 60em; margin: 2em auto; }} td {{ padding: 0.1em 1em 0.1em 0; }}</style></head>
<body>
<h1>{0}</h1>
<p>A case of Quayside {1} as a unit for Co-Simulation: the scene with its ropes, locks and contacts, integrated with error
control by an implicit method of variable order, and the drives of the crane with their limits of speed and acceleration.
The case is in <code>resources/{2}</code>. World: x along the quay, y along the boom towards the water, z up; SI units.</p>
<h2>Who commands</h2>
<p>While the parameter <code>script</code> is true, the case's own script moves the drives and locks, and inputs have no
effect. Set to false before the simulation begins, the script rests and the inputs <code>command.*</code> count: a drive
approaches the speed it is given within its limits of speed and acceleration; a lock closes and opens at once.</p>
<h2>Steps and events</h2>
<p>Communication steps may have any length; their ends are rounded to nanoseconds. The integration takes steps of its own, so
that a longer or shorter communication step costs little either way. With event mode and early return (FMI 3.0), a
step ends where a drive's ramp, a line of the script or a switch of the scene has an event; without, such events are dealt with
inside the step. Getting the state restarts the integration, so that the run that goes on and the run that is restored
later, also by another process, are the same to the last bit.</p>
<p>Run until {3} s in steps of {4} s, it repeats the run of the case with its full scene.</p>
<h2>Variables</h2>
<table>
<tr><th>name</th><th>causality</th><th>unit</th><th>meaning</th></tr>
{5}</table>
</body>
</html>
)",
                     html(contents.description.title), QUAYSIDE_VERSION, kCaseResource, contents.description.duration,
                     contents.description.output_interval, rows);
}

}  // namespace quayside::harness
