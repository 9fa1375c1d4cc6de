// The sections of a case file, each read and checked by a function of its own.
#pragma once

#include "cases/case.h"
#include "cases/reader.h"

namespace quayside::cases {

// What one section has to know of the others.
struct Context {
  bool has_crane = false;
  bool has_mafi = false;
  bool has_wind = false;
  double duration = 0;  // [s]
};

CraneSpec read_crane(const Value& value);
SpreaderSpec read_spreader(const Value& value, const Context& context);
MafiSpec read_mafi(const Value& value);
WindSpec read_wind(const Value& value);
// Reads the containers and bodies of a case that has its crane and spreader already.
void read_loads(const Mapping& root, const Context& context, Case& result);
ScriptEntry read_script_entry(const Value& value, const Context& context);
Expectation read_expectation(const Value& value, const Context& context);

}  // namespace quayside::cases
