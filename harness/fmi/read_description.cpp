#include "harness/fmi/read_description.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <map>
#include <set>
#include <stdexcept>

#include "harness/fmi/unit_of_measure.h"

namespace quayside::harness {

namespace {

using tinyxml2::XMLElement;

std::string text(const XMLElement* element, const char* attribute) {
  const char* value = element ? element->Attribute(attribute) : nullptr;
  return value ? value : "";
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {
    if (document_.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) refuse(document_.ErrorStr());
    root_ = document_.RootElement();
    if (!root_ || std::string(root_->Name()) != "fmiModelDescription") refuse("its root is not fmiModelDescription");
  }

  FmuDescription read() {
    FmuDescription result;
    const std::string version = text(root_, "fmiVersion");
    if (version.rfind("2.0", 0) != 0 && version.rfind("3.0", 0) != 0) {
      refuse(fmt::format("fmiVersion is '{}', expected 2.0 or 3.0", version));
    }
    result.version = version[0] - '0';
    result.token = text(root_, result.version == 2 ? "guid" : "instantiationToken");
    const XMLElement* simulation = root_->FirstChildElement("CoSimulation");
    if (!simulation) refuse("it has no CoSimulation; FMUs for Model Exchange cannot be units");
    result.identifier = text(simulation, "modelIdentifier");
    if (result.identifier.empty() || result.identifier.find('/') != std::string::npos)
      refuse("CoSimulation has no modelIdentifier");
    result.can_save = simulation->BoolAttribute(result.version == 2 ? "canSerializeFMUstate" : "canSerializeFMUState");
    read_units();
    const XMLElement* list = root_->FirstChildElement("ModelVariables");
    if (!list) refuse("it has no ModelVariables");
    for (const XMLElement* v = list->FirstChildElement(); v; v = v->NextSiblingElement()) {
      read_variable(v, result);
    }
    return result;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw std::invalid_argument(fmt::format("{}: {}", file_.filename().string(), why));
  }

  void read_units() {
    const XMLElement* definitions = root_->FirstChildElement("UnitDefinitions");
    if (!definitions) return;
    for (const XMLElement* u = definitions->FirstChildElement("Unit"); u; u = u->NextSiblingElement("Unit")) {
      const XMLElement* base = u->FirstChildElement("BaseUnit");
      if (!base) continue;
      UnitOfMeasure unit;
      for (std::size_t i = 0; i < unit.exponents.size(); ++i)
        unit.exponents[i] = base->IntAttribute(UnitOfMeasure::kBase[i]);
      unit.factor = base->DoubleAttribute("factor", 1);
      unit.offset = base->DoubleAttribute("offset", 0);
      units_[text(u, "name")] = unit;
    }
  }

  void read_variable(const XMLElement* element, FmuDescription& result) {
    const XMLElement* typed = result.version == 2 ? element->FirstChildElement() : element;
    FmuVariable v;
    v.variable.name = text(element, "name");
    if (v.variable.name.empty() || !element->Attribute("valueReference"))
      refuse("a variable without name or valueReference");
    if (!names_.insert(v.variable.name).second) refuse(fmt::format("two variables are called '{}'", v.variable.name));
    v.reference = element->UnsignedAttribute("valueReference");
    v.variable.description = text(element, "description");
    const std::string causality = text(element, "causality"), type = typed ? typed->Name() : "";
    if (causality == "input") {
      v.variable.causality = Causality::input;
    } else if (causality == "output") {
      v.variable.causality = Causality::output;
    } else if (causality == "parameter") {
      v.variable.causality = Causality::parameter;
    } else {
      return;
    }
    if (element->FirstChildElement("Dimension")) return;  // arrays have no place among scalar signals
    if (type == "Real" || type == "Float64") {
      v.kind = FmuVariable::Kind::real;
      read_unit(typed, v);
      v.variable.start = v.factor * typed->DoubleAttribute("start") + v.offset;
    } else if (type == "Boolean") {
      v.kind = FmuVariable::Kind::boolean;
      v.variable.type = Type::boolean;
      v.variable.start = typed->BoolAttribute("start");
    } else if ((type == "Integer" || type == "Int32") && v.variable.causality == Causality::parameter) {
      v.kind = FmuVariable::Kind::integer;
      v.variable.start = typed->IntAttribute("start");
    } else {
      return;
    }
    result.variables.push_back(std::move(v));
  }

  void read_unit(const XMLElement* typed, FmuVariable& v) {
    std::string name = text(typed, "unit");
    if (name.empty()) name = text(declared_type(text(typed, "declaredType")), "unit");
    if (name.empty()) return;
    const auto defined = units_.find(name);
    if (defined != units_.end()) {
      v.variable.unit = si_name(defined->second);
      v.factor = defined->second.factor;
      v.offset = defined->second.offset;
      if (v.variable.unit.empty()) v.variable.unit = "1";
    } else {
      v.variable.unit = name;
    }
  }

  const XMLElement* declared_type(const std::string& name) const {
    const XMLElement* types = root_->FirstChildElement("TypeDefinitions");
    for (const XMLElement* t = types ? types->FirstChildElement() : nullptr; t; t = t->NextSiblingElement()) {
      if (text(t, "name") == name) return t->FirstChildElement() ? t->FirstChildElement() : t;
    }
    return nullptr;
  }

  std::filesystem::path file_;
  tinyxml2::XMLDocument document_;
  const XMLElement* root_ = nullptr;
  std::map<std::string, UnitOfMeasure> units_;
  std::set<std::string> names_;
};

}  // namespace

FmuDescription read_description(const std::filesystem::path& file) { return Reader(file).read(); }

}  // namespace quayside::harness
