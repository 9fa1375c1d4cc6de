#include <dlfcn.h>

#include <stdexcept>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {

void add_module(const char* file, Contenders& all) {
  void* module = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (!module) throw std::runtime_error(std::string("a module of the benchmark cannot be loaded: ") + dlerror());
  const auto add = reinterpret_cast<void (*)(Contenders&)>(dlsym(module, "add_contenders"));
  if (!add) throw std::runtime_error(std::string("not a module of the benchmark: ") + file);
  add(all);
}

}  // namespace quayside::peers
